//! The effects of messages in help.

use crate::tui::app::change::refuse;
use crate::tui::app::dialog::Dialog;
use crate::tui::app::message::{Endpoint, Message};
use crate::tui::app::state::App;
use crate::tui::help::page::Help;
use crate::tui::keys::binding::Context;
use crate::tui::runtime::effect::Effect;
use crate::tui::search::page::SearchDialog;
use crate::tui::search::update::no_search;

/// Cancel leaves the search; without a search, help closes before Cancel and Quit come here.
pub(in crate::tui) fn in_help(app: &mut App, mut help: Help, message: &Message) -> Option<Effect> {
    let (keymap, room) = (app.keymap(), app.body_size());
    let mut refused = None;
    match *message {
        Message::Scroll(lines) => help.scroll(lines, keymap, room),
        Message::ScrollScreen(by) => {
            // One line of the screenful before stays visible, for the reader's orientation.
            let page = room.1.saturating_sub(1).max(1).cast_signed();
            help.scroll(page.saturating_mul(by.into()), keymap, room);
        }
        Message::ScrollTo(Endpoint::First) => help.scroll(i16::MIN, keymap, room),
        Message::ScrollTo(Endpoint::Last) => help.scroll(i16::MAX, keymap, room),
        Message::Match(by) if !help.go_to_match(by, keymap, room) => {
            refused = Some(no_search(keymap, Context::Help));
        }
        Message::Search => {
            let dialog = SearchDialog::new(help.clone());
            app.dialogs
                .extend([Dialog::Help(help), Dialog::Search(dialog)]);
            return None;
        }
        Message::Cancel => help.search.end(),
        Message::Quit => return None,
        _ => {}
    }
    app.dialogs.push(Dialog::Help(help));
    if let Some(text) = refused {
        refuse(app, text);
    }
    None
}
