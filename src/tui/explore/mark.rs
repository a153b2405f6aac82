//! The prompt for the letter of a mark: the next letter marks what is selected, or goes to what it marks.
//!
//! ```text
//! Mark imprint 12 by a letter:                  after m
//! Go to the mark: a imprint 12, b imprint 60    after ', with the marks that there are
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::page::{Page, Slot};
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::number::narrow;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// What a letter is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkPurpose {
    /// To mark what is selected.
    Set,
    /// To go to what is marked.
    Jump,
}

/// The prompt.
#[derive(Clone, Debug)]
pub struct MarkDialog {
    /// What the letter is for.
    pub purpose: MarkPurpose,
    /// What stands before the cursor.
    text: String,
}

impl MarkDialog {
    /// A prompt with a text of what the letter does.
    pub fn new(purpose: MarkPurpose, text: String) -> Self {
        Self { purpose, text }
    }
}

impl Page for MarkDialog {
    fn context(&self) -> Context {
        Context::Mark
    }

    fn slot(&self) -> Slot {
        Slot::Prompt
    }

    fn draw(
        &self,
        theme: &Theme,
        _keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        write::clear(buffer, area);
        write::line(buffer, area, theme, [(self.text.as_str(), Role::Text)]);
        let end = narrow(write::width(&self.text)).saturating_add(1);
        let last = area.width.saturating_sub(1);
        Some(Position::new(area.x + end.min(last), area.y))
    }
}
