//! How the live page lays out a frame. Keys set these choices; frames do not change them.

#[derive(Clone, Copy, Debug, Default)]
pub struct LiveDisplay {
    pub numbers: bool,
    /// The taxel that stays in sight if not all taxels are visible; None keeps the contact in sight.
    pub looked_at: Option<(u8, u8)>,
    pub only_panel: bool,
}
