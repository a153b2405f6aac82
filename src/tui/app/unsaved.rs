//! Unsaved work: what the question before quitting warns of, and what the journal keeps. Both come from the same list,
//! so nothing that is asked about is missing in the journal.

use taxel_core::source::Source;
use taxel_files::formats::{Name, StoredShape};
use taxel_files::storage::UNNAMED;

use crate::tui::app::dialog::{Dialog, Question};
use crate::tui::app::document::{Document, Reading};
use crate::tui::app::history::{DocumentOrigin, StatePlace, UnsavedState};
use crate::tui::app::message::Message;
use crate::tui::app::state::{App, RunState};
use crate::tui::keys::action;
use crate::tui::live::update::recording;

/// A document that would be lost if the program died now.
#[derive(Clone, Debug, PartialEq)]
pub struct UnsavedWork {
    name: Name,
    document: Document,
}

impl UnsavedWork {
    /// Returns the work as a shape. This touches the matrix, so it is not done for every key.
    pub fn to_shape(&self) -> StoredShape {
        let reading = Reading::of(&self.document);
        self.document.to_shape(self.name.clone(), &reading)
    }
}

impl From<&StoredShape> for UnsavedWork {
    fn from(shape: &StoredShape) -> Self {
        Self {
            name: shape.name.clone(),
            document: Document::of_shape(shape),
        }
    }
}

impl App {
    /// Returns true if there is work on the matrix that would be lost.
    pub fn unsaved(&self) -> bool {
        self.history.origin().would_lose(self.history.present())
    }

    pub(in crate::tui) fn is_being_saved(&self, document: &Document) -> bool {
        self.saving.iter().any(|save| save.document == *document)
    }

    /// Returns the documents that are lost at the end unless the user stays, in the order of the history. A document
    /// that is being saved is not: the end waits for it, and reports a failure.
    pub(in crate::tui) fn lost_at_end(&self) -> impl Iterator<Item = UnsavedState<'_>> {
        let unsaved = self.history.unsaved();
        unsaved.filter(|state| !self.is_being_saved(state.document))
    }

    /// Returns the work to keep in the journal: all unsaved documents, the one on the matrix last; what an open form
    /// shows, because it may be accepted; the shapes that are being saved, because this may fail. After Quit, only the
    /// latter, and those that could not be saved: everything else has been given up.
    pub fn unsaved_work(&self) -> Vec<UnsavedWork> {
        let (origin, shown) = (self.history.origin(), self.shown());
        let (present, others): (Vec<_>, Vec<_>) =
            (self.history.unsaved()).partition(|state| state.place == StatePlace::Present);
        // The last one is written last, and so offered first.
        let unsaved = others.into_iter().chain(present);
        let own = unsaved.map(|state| (origin_name(state.origin), state.document));
        let shown = origin.would_lose(shown).then_some(shown);
        let previewed = shown.map(|shown| (origin_name(origin), shown));
        let kept = own
            .chain(previewed)
            .filter(|_| self.run_state != RunState::Quit);
        let refused = self.refused_at_end.iter().map(|(save, _)| save);
        let saving = self.saving.iter().chain(refused);
        let saving = saving.map(|save| (Some(save.shape.name.clone()), &save.document));
        let mut works: Vec<UnsavedWork> = Vec::new();
        // First, because the user has given these a name.
        for (name, document) in saving.chain(kept) {
            if let Some(name) = name
                && !works.iter().any(|work| work.document == *document)
            {
                let document = document.clone();
                works.push(UnsavedWork { name, document });
            }
        }
        works
    }
}

/// Returns the name to keep a document of this origin under: its own if it has one, otherwise the one that would be
/// proposed for it.
fn origin_name(origin: &DocumentOrigin) -> Option<Name> {
    let stored = origin.name.as_ref().map(|stored| &stored.name);
    let name = stored.or(origin.proposed.as_ref());
    Name::new(name.map_or(UNNAMED, String::as_str))
        .or_else(|_| Name::new(UNNAMED))
        .ok()
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::app::message::{LibraryEvent, LibraryRequest};
    use crate::tui::app::state::Options;
    use crate::tui::app::update::update;
    use crate::tui::runtime::effect::Effect;

    fn saving(app: &mut App) -> Box<StoredShape> {
        let _ = update(app, Message::Toggle);
        let message = app.storing(Name::new("mine").expect("a name"));
        match update(app, message) {
            Some(Effect::Library(LibraryRequest::Store(shape, _))) => shape,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_save_that_is_refused_after_the_end_is_kept() {
        let differs = |shape| LibraryEvent::Differs(shape, 7, "mine already exists".to_owned());
        let not_stored = |_| LibraryEvent::NotStored("the disk is full".to_owned());
        let answers: [&dyn Fn(Box<StoredShape>) -> LibraryEvent; 2] = [&differs, &not_stored];
        for answer in answers {
            for end in [Message::Quit, Message::Terminate] {
                let mut app = App::new(&Options::plain(true));
                let shape = saving(&mut app);
                let kept = app.unsaved_work();
                assert!(kept.len() == 1 && kept[0].name == shape.name);
                let _ = update(&mut app, end);
                assert!(app.ended(), "a shape that is being saved needs no question");
                let _ = update(&mut app, Message::Library(answer(shape.clone())));
                let kept: Vec<StoredShape> = app
                    .unsaved_work()
                    .iter()
                    .map(UnsavedWork::to_shape)
                    .collect();
                assert_eq!(kept, [*shape], "under the name that it was to have");
                assert_eq!(app.refused_at_end.len(), 1);
            }
        }
    }
}
