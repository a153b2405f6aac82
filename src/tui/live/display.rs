//! How the live page lays out a frame: what keys choose, and no frame changes.

/// How a frame is laid out.
#[derive(Clone, Copy, Debug, Default)]
pub struct LiveDisplay {
    /// Whether values are numbers and not shades.
    pub numbers: bool,
    /// A taxel that stays in sight where not all are; None for one of the contact.
    pub looked_at: Option<(u8, u8)>,
    /// Whether the numbers beside the taxels have the whole page.
    pub only_panel: bool,
}
