//! Handles messages in the prompts over the results: the filter of the list, and the letters of marks.

use crate::tui::app::change::{inform, refuse};
use crate::tui::app::dialog::Dialog;
use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::explore::filter::FilterDialog;
use crate::tui::explore::results::Results;
use crate::tui::runtime::effect::Effect;

fn results(app: &mut App) -> Option<&mut Results> {
    match app.dialogs.last_mut() {
        Some(Dialog::Results(results)) => Some(results),
        _ => None,
    }
}

/// Handles a message in the prompt for a filter, which stays open until the filter can be read.
pub(in crate::tui) fn in_filter(
    app: &mut App,
    mut dialog: FilterDialog,
    message: &Message,
) -> Option<Effect> {
    let results = results(app)?;
    match message {
        Message::Cancel | Message::Quit => {
            dialog.restore(results);
            return None;
        }
        Message::Accept => {
            dialog.apply(results);
            let Some(error) = dialog.error() else {
                let kept = results.kept_of_all();
                inform(app, format!("{kept} imprints"));
                return None;
            };
            let error = error.to_string();
            refuse(app, error);
        }
        message => {
            if dialog.field.take(message) {
                dialog.apply(results);
            }
        }
    }
    app.dialogs.push(Dialog::Filter(dialog));
    None
}
