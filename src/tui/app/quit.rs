//! Quitting the program: at once, or after a question if work would be lost.

use crate::source::Source;
use crate::tui::app::dialog::{Dialog, Question};
use crate::tui::app::history::{StatePlace, UnsavedState};
use crate::tui::app::message::Message;
use crate::tui::app::state::{App, RunState};
use crate::tui::keys::action;
use crate::tui::live::update::recording;

/// Quits, after a question if work would be lost.
/// The imprint on the matrix can be saved from the question; another shape must be brought back first, so there is no
/// key for it, and the question names the key of the history. A shape that is being saved needs no question: the end
/// waits for it, and reports a failure.
pub(in crate::tui) fn quit(app: &mut App) {
    let Some((what, lost)) = losses(app) else {
        app.run_state = RunState::Quit;
        return;
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

/// Returns what would be lost, in words, and the word for losing it; None if nothing would be.
fn losses(app: &App) -> Option<(String, &'static str)> {
    let is_present = |state: &UnsavedState| state.place == StatePlace::Present;
    let (present, others): (Vec<_>, Vec<_>) = app.lost_at_end().partition(is_present);
    let history = app.key_of(&action::HISTORY);
    let what = match &others[..] {
        [] if present.is_empty() => return None,
        [] => "The imprint is not saved".to_owned(),
        [one] => {
            let kind = one.document.source.as_ref();
            let kind = kind.map_or("drawing", Source::kind_name);
            let place = match one.place {
                StatePlace::Later => "a later",
                StatePlace::Earlier | StatePlace::Present => "an earlier",
            };
            if present.is_empty() {
                let place = place.replacen('a', "A", 1);
                format!("{place} {kind} is not saved; the history ({history}) has it")
            } else {
                let what = format!("The imprint and {place} {kind} are not saved");
                format!("{what}; the history ({history}) has the {kind}")
            }
        }
        many => {
            let count = many.len();
            let what = if present.is_empty() {
                format!("{count} shapes")
            } else {
                format!("The imprint and {count} other shapes")
            };
            format!("{what} are not saved; the history ({history}) has them")
        }
    };
    let lost = if present.len() + others.len() > 1 {
        "lose them"
    } else {
        "lose it"
    };
    Some((what, lost))
}

fn can_save_first(app: &App) -> bool {
    let present = app.history.present();
    app.unsaved() && !app.is_being_saved(present) && !app.reading().imprint.is_empty()
}
