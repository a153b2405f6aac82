//! The effects of messages at the prompt of a search.

use crate::tui::app::change::refuse;
use crate::tui::app::dialog::Dialog;
use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::keys::action;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::runtime::effect::Effect;
use crate::tui::search::page::SearchDialog;

pub(in crate::tui) fn in_search(
    app: &mut App,
    mut dialog: SearchDialog,
    message: &Message,
) -> Option<Effect> {
    let list = match message {
        Message::Cancel | Message::Quit => dialog.before().clone(),
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
