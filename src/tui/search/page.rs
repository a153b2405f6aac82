//! The prompt of the search.

use std::borrow::Cow;

use crate::tui::app::line_prompt::LinePrompt;
use crate::tui::app::message::Message;
use crate::tui::help::page::Help;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::text_field::TextField;

const LONGEST: usize = 60;

#[derive(Clone, Debug)]
pub struct SearchDialog {
    field: TextField,
    before: Help,
    found: Option<(usize, usize)>,
}

impl SearchDialog {
    pub fn new(before: Help) -> Self {
        Self {
            field: TextField::new("", LONGEST),
            before,
            found: None,
        }
    }

    pub fn edit(&mut self, message: &Message) {
        self.field.take(message);
    }

    pub fn before(&self) -> &Help {
        &self.before
    }

    /// Returns the wanted text if it was not found; None otherwise.
    pub fn unfound(&self) -> Option<&str> {
        let text = self.field.text();
        (self.found.is_none() && !text.is_empty()).then_some(text)
    }

    /// `room` is the size of the list in columns and lines.
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

    fn behind(&self, _columns: u16) -> Cow<'_, str> {
        match self.found {
            _ if self.field.text().is_empty() => "   a key, or a word of what it does".into(),
            None => "   no match".into(),
            Some((number, all)) => format!("   {number} of {all}").into(),
        }
    }
}
