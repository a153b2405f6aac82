//! The prompt of the search.

use std::borrow::Cow;

use crate::tui::app::line_prompt::LinePrompt;
use crate::tui::app::message::Message;
use crate::tui::help::page::Help;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::text_field::TextField;

/// The greatest number of characters of a search.
const LONGEST: usize = 60;

/// The prompt, with the list as it was before the search.
#[derive(Clone, Debug)]
pub struct SearchDialog {
    /// The field for the wanted text.
    field: TextField,
    /// The list before the search.
    before: Help,
    /// The number of the present match, from 1, and the number of all matches; None if there is none.
    found: Option<(usize, usize)>,
}

impl SearchDialog {
    /// Creates an empty prompt over a list.
    pub fn new(before: Help) -> Self {
        Self {
            field: TextField::new("", LONGEST),
            before,
            found: None,
        }
    }

    /// Edits the field, if the message is an edit.
    pub fn edit(&mut self, message: &Message) {
        self.field.take(message);
    }

    /// Returns the list before the search.
    pub fn before(&self) -> &Help {
        &self.before
    }

    /// Returns the wanted text if it was not found; None otherwise.
    pub fn unfound(&self) -> Option<&str> {
        let text = self.field.text();
        (self.found.is_none() && !text.is_empty()).then_some(text)
    }

    /// Returns the list after a search for the typed text, which starts where the list was; if nothing is found, the
    /// list as it was. `room` is the size of the list in columns and lines.
    pub fn searched(&mut self, keymap: &Keymap, room: (u16, u16)) -> Help {
        let (wanted, mut list) = (self.field.text(), self.before.clone());
        self.found = list.search_for(wanted, keymap, room);
        list
    }
}

impl LinePrompt for SearchDialog {
    const CONTEXT: Context = Context::Search;
    const RESTORES: bool = true;

    fn label(&self) -> &'static str {
        "Search: "
    }

    fn field(&self) -> &TextField {
        &self.field
    }

    /// Returns the number of the match; while the field is empty, what can be searched for.
    fn behind(&self, _columns: u16) -> Cow<'_, str> {
        match self.found {
            _ if self.field.text().is_empty() => "   a key, or a word of what it does".into(),
            None => "   no match".into(),
            Some((number, all)) => format!("   {number} of {all}").into(),
        }
    }
}
