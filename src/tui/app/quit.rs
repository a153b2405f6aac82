//! Quitting the program: at once, or after a question if work would be lost.

use crate::tui::app::dialog::{Dialog, Question};
use crate::tui::app::message::Message;
use crate::tui::app::state::{App, RunState};
use crate::tui::live::update::recording;

/// Quits, after a question if work would be lost.
/// The imprint on the matrix can be saved from the question; an earlier drawing must be brought back first, so there
/// is no key for it. A shape that is being saved needs no question: the end waits for it, and reports a failure.
pub(in crate::tui) fn quit(app: &mut App) {
    let (what, lost) = match (
        app.unsaved() && !app.is_being_saved(),
        app.history.left_unsaved(),
    ) {
        (true, true) => ("The imprint and an earlier one are", "lose them"),
        (true, false) => ("The imprint is", "lose it"),
        (false, true) => ("An earlier drawing is", "lose it"),
        (false, false) => {
            app.run_state = RunState::Quit;
            return;
        }
    };
    let ends = recording(app).map_or(String::new(), |name| {
        format!("; the recording in {name} ends")
    });
    let about = format!("{what} not saved{ends}.");
    let question = Question {
        saves_first: can_save_first(app),
        meanings: Some([lost, "stay"]),
        ..Question::new(about, "Quit anyway?", Message::QuitNow)
    };
    app.dialogs.push(Dialog::Question(question));
}

/// Returns true if something on the matrix can be saved before the end.
fn can_save_first(app: &App) -> bool {
    app.unsaved() && !app.is_being_saved() && !app.reading().imprint.is_empty()
}
