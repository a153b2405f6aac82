//! Prompts: pages that are one line of text with a label, in the line of notices.
//!
//! ```text
//! Save as: my shape█                     a label, the field, and what is wrong with it above the line
//! Filter: na>=40 holes=0   312 of 4,102  with a word behind the field
//! ```
//! A text that is too long scrolls with its cursor.

use std::borrow::Cow;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::page::{Page, Slot};
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// Every type with this trait is a [`Page`].
pub trait LinePrompt {
    const CONTEXT: Context;

    /// Whether Cancel and Quit go to its own update, because the page below has to be restored.
    const RESTORES: bool = false;

    fn label(&self) -> &str;

    fn field(&self) -> &TextField;

    fn behind(&self, columns: u16) -> Cow<'_, str>;

    fn wrong(&self) -> Option<String> {
        None
    }

    /// Does nothing by default.
    fn draw_offers(&self, _theme: &Theme, _buffer: &mut Buffer, _body: Rect) {}
}

impl<Prompt: LinePrompt> Page for Prompt {
    fn context(&self) -> Context {
        Prompt::CONTEXT
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
        let (label, behind) = (self.label(), self.behind(area.width));
        let cursor = write::prompt(buffer, area, theme, label, self.field(), &behind);
        Some(cursor)
    }

    fn draw_over(&self, theme: &Theme, buffer: &mut Buffer, body: Rect) {
        self.draw_offers(theme, buffer, body);
    }

    fn cancels_itself(&self) -> bool {
        Prompt::RESTORES
    }

    fn remark(&self, _keymap: &Keymap, _body: Rect) -> Option<(String, Role)> {
        Some((format!("! {}", self.wrong()?), Role::Error))
    }
}
