//! The effects of messages over the list of steps.

use crate::tui::app::change::{compare_with, go_to};
use crate::tui::app::dialog::Dialog;
use crate::tui::app::document::Reading;
use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::history::page::HistoryDialog;
use crate::tui::runtime::effect::Effect;
use crate::tui::widget::rows::moved;

/// Comparing leaves the list open below.
pub(in crate::tui) fn in_history(
    app: &mut App,
    mut list: HistoryDialog,
    message: &Message,
) -> Option<Effect> {
    match *message {
        Message::Compare => {
            let step = list.selected();
            let state = app
                .history
                .after(step)
                .map(|state| Reading::of(state).imprint);
            app.dialogs.push(Dialog::History(list));
            if let Some(imprint) = state {
                compare_with(app, &format!("the state after step {step}"), &imprint);
            }
            return None;
        }
        Message::Quit => return None,
        Message::Accept => {
            go_to(app, list.selected());
            return None;
        }
        _ => {
            if let Some(row) = moved(list.selected(), message) {
                list.select(row);
            }
        }
    }
    app.dialogs.push(Dialog::History(list));
    None
}
