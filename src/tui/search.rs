//! The search in help and in the history: a prompt at the bottom of the list, which follows with every character
//! typed.
//!
//! ```text
//! Search: undo   1 of 3          which match is in sight, of how many
//! Search: unod   no match        the list stays where it was
//! ```

use std::borrow::Cow;

use crate::tui::app::change::refuse;
use crate::tui::app::dialog::Dialog;
use crate::tui::app::message::Message;
use crate::tui::app::page::LinePrompt;
use crate::tui::app::state::App;
use crate::tui::help::Help;
use crate::tui::keys::action;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::runtime::effect::Effect;
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

pub(in crate::tui) fn in_search(
    app: &mut App,
    mut dialog: SearchDialog,
    message: &Message,
) -> Option<Effect> {
    let list = match message {
        Message::Cancel | Message::Quit => dialog.before.clone(),
        _ => {
            dialog.edit(message);
            dialog.searched(app.keymap(), app.body_size())
        }
    };
    if let Some(below) = app.dialogs.last_mut() {
        *below = Dialog::Help(list);
    }
    match message {
        Message::Cancel | Message::Quit => {}
        Message::Accept => {
            if let Some(text) = dialog.unfound() {
                refuse(app, format!("no match for {text:?}"));
            }
        }
        _ => app.dialogs.push(Dialog::Search(dialog)),
    }
    None
}

pub(in crate::tui) fn no_search(keymap: &Keymap, context: Context) -> String {
    let key = keymap.label(context, &action::SEARCH);
    format!("nothing to go to: {key} searches")
}
