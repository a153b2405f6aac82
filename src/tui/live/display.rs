//! How the live page lays out a frame. Keys set these choices; frames do not change them.

/// How a frame is laid out.
#[derive(Clone, Copy, Debug, Default)]
pub struct LiveDisplay {
    /// Whether values are shown as numbers instead of shades.
    pub numbers: bool,
    /// The taxel that stays in sight if not all taxels are visible; None keeps the contact in sight.
    pub looked_at: Option<(u8, u8)>,
    /// Whether the taxels are hidden, and the numbers beside them fill the whole page.
    pub only_panel: bool,
}
