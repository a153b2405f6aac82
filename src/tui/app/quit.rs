//! Quitting the program: at once, or after a question if work would be lost.

use crate::source::Source;
use crate::tui::app::dialog::{Dialog, Question};
use crate::tui::app::document::Document;
use crate::tui::app::message::Message;
use crate::tui::app::state::{App, RunState};
use crate::tui::keys::action;
use crate::tui::live::update::recording;

/// Quits, after a question if work would be lost.
/// The imprint on the matrix can be saved from the question; an earlier shape must be brought back first, so there is
/// no key for it, and the question names the key of the history. A shape that is being saved needs no question: the
/// end waits for it, and reports a failure.
pub(in crate::tui) fn quit(app: &mut App) {
    let kind = |document: &Document| {
        document
            .source
            .as_ref()
            .map_or("drawing", Source::kind_name)
    };
    let earlier = app.history.left_unsaved().map(kind);
    let history = app.key_of(&action::HISTORY);
    let (what, lost) = match (app.unsaved() && !app.is_being_saved(), earlier) {
        (true, Some(kind)) => (
            format!(
                "The imprint and an earlier {kind} are not saved; the history ({history}) has the {kind}"
            ),
            "lose them",
        ),
        (true, None) => ("The imprint is not saved".to_owned(), "lose it"),
        (false, Some(kind)) => (
            format!("An earlier {kind} is not saved; the history ({history}) has it"),
            "lose it",
        ),
        (false, None) => {
            app.run_state = RunState::Quit;
            return;
        }
    };
    let ends = recording(app).map_or(String::new(), |name| {
        format!("; the recording in {name} ends")
    });
    let about = format!("{what}{ends}.");
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
