//! The search in help: a prompt at its foot. Help follows as one types.
//!
//! ```text
//! Search: undo   1 of 3          which match is in sight, of how many
//! Search: unod   no match        help stays where it was
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot};
use crate::tui::help::Help;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::Theme;
use crate::tui::widget::write;

/// Nobody searches for more.
const LONGEST: usize = 60;

/// The label of the field.
const LABEL: &str = "Search: ";

/// What stands behind an empty field.
const EXAMPLE: &str = "   a key, or a word of what it does";

/// The field, and the list as it was before.
#[derive(Clone, Debug)]
pub struct SearchDialog {
    /// What was typed.
    field: TextField,
    /// The list as the search found it.
    before: Help,
    /// Which match is in sight, counted from 1, and of how many; (0, 0) for none.
    found: (usize, usize),
}

impl SearchDialog {
    /// An empty field over a list.
    pub fn new(before: Help) -> Self {
        Self {
            field: TextField::new("", LONGEST),
            before,
            found: (0, 0),
        }
    }

    /// Types or deletes in the field, where that is what a message means.
    pub fn edit(&mut self, message: &Message) {
        self.field.take(message);
    }

    /// The list as the search found it.
    pub fn before(&self) -> &Help {
        &self.before
    }

    /// What was typed if nothing has it, None otherwise.
    pub fn unfound(&self) -> Option<&str> {
        let text = self.field.text();
        (self.found.1 == 0 && !text.is_empty()).then_some(text)
    }

    /// The list with what was typed searched for, from where it stood; as it stood where nothing is found.
    pub fn searched(&mut self, keymap: &Keymap, room: (u16, u16)) -> Help {
        let mut help = self.before.clone();
        help.leave_search();
        self.found = help.search(self.field.text(), keymap, room);
        help
    }
}

impl Page for SearchDialog {
    fn context(&self) -> Context {
        Context::Search
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
        let remark = match self.found {
            _ if self.field.text().is_empty() => EXAMPLE.to_owned(),
            (_, 0) => "   no match".to_owned(),
            (number, all) => format!("   {number} of {all}"),
        };
        let cursor = write::prompt(buffer, area, theme, LABEL, &self.field, &remark);
        Some(cursor)
    }

    /// Its update takes the list back to where it was.
    fn cancels_itself(&self) -> bool {
        true
    }
}
