//! Handles messages in the prompts over the results: the filter of the list, and the letters of marks.

use crate::quote::quoted_character;
use crate::tui::app::change::{inform, refuse};
use crate::tui::app::dialog::Dialog;
use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::explore::filter::FilterDialog;
use crate::tui::explore::mark::{MarkDialog, MarkPurpose};
use crate::tui::explore::message::ExploreTab;
use crate::tui::explore::results::Results;
use crate::tui::keys::action;
use crate::tui::keys::binding::Context;
use crate::tui::runtime::effect::Effect;

/// Returns the results that a prompt lies over.
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

/// Returns the prompt for a letter. Shows a notice and returns None if there is nothing to mark or to go to. A mark
/// belongs to a pose, so that it holds on every tab and under every filter.
pub(in crate::tui) fn mark_dialog(
    app: &mut App,
    results: &Results,
    purpose: MarkPurpose,
) -> Option<MarkDialog> {
    let text = match purpose {
        MarkPurpose::Set => {
            let Some(pose) = results.pose() else {
                refuse(app, "nothing is selected here");
                return None;
            };
            format!("Mark {} by a letter:", what_lies_at(results, pose))
        }
        MarkPurpose::Jump if results.marks().is_empty() => {
            let key = app.keymap().label(Context::Explore, &action::MARK);
            refuse(app, format!("no marks yet: {key} and a letter set one"));
            return None;
        }
        MarkPurpose::Jump => {
            let marks = results.marks().iter();
            let marks =
                marks.map(|(letter, &pose)| format!("{letter} {}", what_lies_at(results, pose)));
            format!("Go to the mark: {}", marks.collect::<Vec<_>>().join(", "))
        }
    };
    Some(MarkDialog::new(purpose, text))
}

/// Names the imprint of a pose by its number, or describes the pose if it was not swept.
fn what_lies_at(results: &Results, pose: u64) -> String {
    match results.id_at(pose) {
        Some(id) => format!("imprint {id}"),
        None => results.pose_text(&results.sweep().grid.pose(pose)),
    }
}

/// Handles a message in the prompt for a letter: a letter sets a mark or goes to it; another character is refused,
/// and any other message closes the prompt.
pub(in crate::tui) fn in_mark(
    app: &mut App,
    dialog: MarkDialog,
    message: &Message,
) -> Option<Effect> {
    let Message::Type(letter) = *message else {
        return None;
    };
    let results = results(app)?;
    if !letter.is_alphabetic() {
        app.dialogs.push(Dialog::Mark(dialog));
        refuse(
            app,
            format!("{}: expected a letter", quoted_character(letter)),
        );
        return None;
    }
    match dialog.purpose {
        MarkPurpose::Set => {
            results.mark(letter);
            let key = app.keymap().label(Context::Explore, &action::JUMP);
            inform(
                app,
                format!("marked as {letter}; press {key} then {letter} to return"),
            );
        }
        MarkPurpose::Jump => {
            let Some(&pose) = results.marks().get(&letter) else {
                refuse(app, format!("no mark {letter}"));
                return None;
            };
            if let Err(error) = go_to(results, pose) {
                refuse(app, error);
            }
        }
    }
    None
}

/// Goes to a marked pose: on the map and at the angles to the pose itself, elsewhere to its imprint, in the list or
/// among the points. The map has all poses; the list has only imprints that pass the filter, so a mark may be out of
/// reach there.
fn go_to(results: &mut Results, pose: u64) -> Result<(), String> {
    if matches!(results.tab(), ExploreTab::Map | ExploreTab::Angles) {
        results.go_to_pose(pose);
        return Ok(());
    }
    results.go_to_imprint_at(pose)?;
    if results.tab() != ExploreTab::Scatter {
        results.open_tab(ExploreTab::Imprints);
    }
    Ok(())
}
