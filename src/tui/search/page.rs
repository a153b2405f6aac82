//! The prompt of the search.

use std::borrow::Cow;

use crate::tui::app::line_prompt::LinePrompt;
use crate::tui::app::message::Message;
use crate::tui::help::page::Help;
use crate::tui::history::page::HistoryDialog;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::text_field::TextField;

/// Nobody searches for more.
const LONGEST: usize = 60;

/// A list that can be searched.
#[derive(Clone, Debug)]
pub enum Searched {
    /// The keys of a place.
    Help(Help),
    /// The steps of the history.
    History(HistoryDialog),
}

/// The field, and the list as it was before.
#[derive(Clone, Debug)]
pub struct SearchDialog {
    /// What was typed.
    field: TextField,
    /// The list as the search found it.
    before: Searched,
    /// Which match is in sight, counted from 1, and of how many; (0, 0) for none.
    found: (usize, usize),
}

impl SearchDialog {
    /// An empty field over a list.
    pub fn new(before: Searched) -> Self {
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
    pub fn before(&self) -> &Searched {
        &self.before
    }

    /// What was typed if nothing has it, None otherwise.
    pub fn unfound(&self) -> Option<&str> {
        let text = self.field.text();
        (self.found.1 == 0 && !text.is_empty()).then_some(text)
    }

    /// The list with what was typed searched for, from where it stood; as it stood where nothing is found. `room` has the
    /// columns and lines of the list.
    pub fn searched(&mut self, keymap: &Keymap, room: (u16, u16)) -> Searched {
        let (wanted, mut list) = (self.field.text(), self.before.clone());
        self.found = match &mut list {
            Searched::Help(help) => {
                help.leave_search();
                help.search(wanted, keymap, room)
            }
            Searched::History(history) => {
                history.leave_search();
                history.search(wanted)
            }
        };
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

    /// Which match is in sight; behind an empty field, what can be searched for.
    fn behind(&self, _columns: u16) -> Cow<'_, str> {
        match (self.found, &self.before) {
            (_, Searched::Help(_)) if self.field.text().is_empty() => {
                "   a key, or a word of what it does".into()
            }
            (_, Searched::History(_)) if self.field.text().is_empty() => {
                "   a word in a step".into()
            }
            ((_, 0), _) => "   no match".into(),
            ((number, all), _) => format!("   {number} of {all}").into(),
        }
    }
}
