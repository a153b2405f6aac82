//! The prompts in the line of notices.
//!
//! ```text
//! Save as: my shape█                                  the name to save under; a broken rule stands above
//! :figure hex█   hexagon heptagon … 2 more            a command, and what the last word could become
//! ```
//! A text that is too long scrolls with its cursor. Candidates that do not fit are counted.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::formats::NameError;
use crate::tui::app::page::{Page, Slot};
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::prompt::state::{CommandDialog, NameDialog};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// The label of the name to save under.
const NAME_LABEL: &str = "Save as: ";

impl Page for NameDialog {
    fn context(&self) -> Context {
        Context::Name
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
        Some(write::prompt(
            buffer,
            area,
            theme,
            NAME_LABEL,
            &self.field,
            "",
        ))
    }

    /// The rule that the name breaks.
    fn remark(&self, _keymap: &Keymap, _body: Rect) -> Option<(String, Role)> {
        let error = self.name().err();
        let error = error.filter(|error| *error != NameError::Empty)?;
        Some((format!("! {error}"), Role::Error))
    }
}

impl Page for CommandDialog {
    fn context(&self) -> Context {
        Context::Command
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
        let used = 1 + write::width(self.field.text());
        let room = usize::from(area.width).saturating_sub(used);
        let candidates = as_many_as_fit(&self.candidates, room);
        Some(write::prompt(
            buffer,
            area,
            theme,
            ":",
            &self.field,
            &candidates,
        ))
    }
}

/// Words after a gap, and the number of those that do not fit.
fn as_many_as_fit(words: &[String], room: usize) -> String {
    let mut text = String::new();
    for (index, word) in words.iter().enumerate() {
        let gap = if index == 0 { "   " } else { " " };
        let left = words.len() - index;
        // The last one needs no room behind it for what is left then.
        let behind = match left {
            1 => String::new(),
            _ => format!(" … {} more", left - 1),
        };
        let used = text.chars().count() + gap.len() + word.chars().count();
        if used + behind.chars().count() > room {
            return text + &format!("{gap}… {left} more");
        }
        text += gap;
        text += word;
    }
    text
}
