//! Unsaved work: what the question before quitting warns of, and what the journal keeps. Both come from the same list,
//! so nothing that is asked about is missing in the journal.

use taxel_core::source::Source;
use taxel_files::formats::Name;
use taxel_files::formats::value::counted;
use taxel_files::storage::{Library, LibraryError, Orphan, UNNAMED, shipped};

use crate::tui::app::{App, Document, DocumentOrigin, Question, RunState, inform, refuse, resume};
use crate::tui::explore::ranges::about;
use crate::tui::jobs::{Jobs, answer};
use crate::tui::keys::action;
use crate::tui::live::update::recording;
use crate::tui::live::{Live, source};
use crate::tui::matrix::update::name_of_copy;

/// A document that would be lost if the program died now, and its name.
pub type UnsavedWork = (Name, Document);

impl App {
    /// Whether there is work on the matrix that would be lost.
    pub fn unsaved(&self) -> bool {
        self.history.origin().would_lose(self.history.present())
    }

    fn is_being_saved(&self, document: &Document) -> bool {
        let saving = self.saving.as_ref();
        saving.is_some_and(|saving| saving.document == *document)
    }

    /// Returns the work to keep in the journal: all unsaved documents, the one on the matrix last; what an open form
    /// shows, because it may be accepted; the shape that is being saved, because this may fail. After Quit, only the
    /// latter: everything else has been given up.
    pub fn unsaved_work(&self) -> Vec<UnsavedWork> {
        let (origin, shown) = (self.history.origin(), self.shown());
        let previewed = origin.would_lose(shown).then_some((shown, origin));
        let kept = self.history.unsaved().chain(previewed);
        let kept = kept.filter(|_| self.run_state != RunState::Quit);
        let kept = kept.map(|(document, origin)| (origin_name(origin), document));
        // First, because the user has given it a name.
        let saving = self.saving.iter();
        let saving = saving.map(|save| (Some(save.shape.name.clone()), &save.document));
        let mut works: Vec<UnsavedWork> = Vec::new();
        for (name, document) in saving.chain(kept) {
            if let Some(name) = name
                && !works.iter().any(|(_, own)| own == document)
            {
                works.push((name, document.clone()));
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

/// Quits, after a question if work would be lost. A shape that is being saved needs no question: the end waits for it,
/// and reports a failure.
pub(in crate::tui) fn quit(app: &mut App) {
    let Some((what, lost)) = losses(app) else {
        app.run_state = RunState::Quit;
        return;
    };
    let ends = recording(app).map_or(String::new(), |name| {
        format!("; the recording in {name} ends")
    });
    let quit = |app: &mut App| app.run_state = RunState::Quit;
    let question = Question {
        saves_first: app.unsaved()
            && !app.is_being_saved(app.history.present())
            && !app.reading().imprint.is_empty(),
        meanings: Some([lost, "stay"]),
        ..Question::new(format!("{what}{ends}."), "Quit anyway?", quit)
    };
    app.open(question);
}

/// Returns what would be lost, in words, and the word for losing it; None if nothing would be.
fn losses(app: &App) -> Option<(String, &'static str)> {
    let lost = app.history.unsaved().map(|(document, _)| document);
    let lost = lost.filter(|document| !app.is_being_saved(document));
    let (present, earlier): (Vec<_>, Vec<_>) =
        lost.partition(|document| *document == app.history.present());
    let shapes = counted(earlier.len() as u64, "earlier shape");
    let (what, lose) = match (present.is_empty(), earlier.len()) {
        (true, 0) => return None,
        (false, 0) => return Some(("The imprint is not saved".to_owned(), "lose it")),
        (true, 1) => (format!("{shapes} is"), "lose it"),
        (true, _) => (format!("{shapes} are"), "lose them"),
        (false, _) => (format!("The imprint and {shapes} are"), "lose them"),
    };
    let undo = app.key_of(&action::UNDO);
    Some((format!("{what} not saved; {undo} goes back"), lose))
}

/// Offers the last unsaved work of programs that crashed, if there is any. No answer keeps it for the next start. While
/// a sensor is watched the question waits below that page.
pub fn offer(app: &mut App) {
    let Some(orphan) = app.jobs.orphans.last() else {
        return;
    };
    let of = match app.jobs.orphans.len() {
        1 => String::new(),
        all => format!(" (1 of {all})"),
    };
    let what = described(orphan);
    let text = format!("There is unsaved work from last time{of}: {what}.");
    let question = Question {
        no: Some(Box::new(give_up)),
        meanings: Some(["yes", "to the trash"]),
        left: Some("ask next time"),
        ..Question::new(text.clone(), "Restore it?", recover)
    };
    match app.pages.iter().position(|page| page.is::<Live>()) {
        // A user who watches a sensor wants the keys of that page now, not those of a question.
        Some(below) => {
            app.pages.insert(below, Box::new(question));
            let text = format!("{text} It is offered when this page is closed.");
            inform(app, text);
        }
        None => app.open(question),
    }
}

/// Puts unsaved work of an earlier run onto the matrix. It keeps the name that it had, or was to be saved under.
fn recover(app: &mut App) {
    let Some(orphan) = app.jobs.orphans.pop() else {
        return;
    };
    let shape = orphan.shape.clone();
    app.jobs.adopted.push(orphan);
    let document = Document::of_shape(&shape);
    let mut origin = DocumentOrigin::unsaved(&document);
    origin.brought_by = Some(match shape.name.as_str() {
        UNNAMED => format!("{} restored", counted(shape.imprint.count(), "taxel")),
        name => {
            let is_shipped = shipped::get(name).is_some();
            origin.proposed = Some(if is_shipped {
                name_of_copy(name)
            } else {
                name.to_owned()
            });
            format!("{name} restored")
        }
    });
    resume(app, origin, document);
    let save = app.key_of(&action::SAVE);
    inform(app, format!("restored; {save} saves it"));
    offer(app);
}

fn give_up(app: &mut App) {
    let Some(orphan) = app.jobs.orphans.pop() else {
        return;
    };
    app.jobs.disk("Moving it to the trash", |library| {
        let thrown = throw_away(library, orphan);
        answer(|app| match thrown {
            Ok(name) => {
                let text = format!("{name} is in the trash; :restore {name} brings it back");
                inform(app, text);
                offer(app);
            }
            Err(reason) => {
                // The rest is offered again at the next start, too.
                app.jobs.orphans.clear();
                let text = "the unsaved work cannot be moved to the trash, and is offered again at the next start";
                refuse(app, format!("{text}: {reason}"));
            }
        })
    });
}

fn throw_away(library: &Library, orphan: Orphan) -> Result<String, LibraryError> {
    let mut shape = orphan.shape.clone();
    if let Ok(name) = Name::new(UNNAMED) {
        shape = shape.renamed(name);
    }
    let thrown = library.throw_away(&shape)?;
    orphan.discard();
    Ok(thrown)
}

/// Returns the name, the size and the age of the work: `hexagon side 4.00, 40 taxels, about 12 minutes ago`.
fn described(orphan: &Orphan) -> String {
    let shape = &orphan.shape;
    let called = match (shape.name.as_str(), &shape.source) {
        (UNNAMED, Some(Source::Figure(figure))) => Some(figure.kind_and_sizes()),
        (UNNAMED, Some(source)) => source.stored_name().map(str::to_owned),
        (UNNAMED, None) => None,
        (name, _) => Some(name.to_owned()),
    };
    let taxels = counted(shape.imprint.count(), "taxel");
    // Within the first minute, seconds would say nothing useful.
    let age = orphan.age().map(|age| match age.as_secs() {
        ..60 => "less than a minute ago".to_owned(),
        _ => format!("{} ago", about(age)),
    });
    let pieces = [called, Some(taxels), age].into_iter().flatten();
    pieces.collect::<Vec<_>>().join(", ")
}

/// Finishes changes and recordings and writes unsaved work at once, because the program is about to end. Returns lines
/// about everything that is not on the disk.
pub(crate) fn end(app: &mut App) -> Vec<String> {
    source::stop(app);
    let mut lines = Jobs::finish(app);
    if !lines.is_empty() && !app.unsaved_work().is_empty() {
        lines.push("the next start offers it as unsaved work\n".to_owned());
    }
    lines
}

/// Writes everything out because the program is about to be stopped, perhaps for ever. Everything goes on when it is
/// continued.
pub(crate) fn flush(app: &mut App) -> Vec<String> {
    source::flush(app);
    Jobs::finish(app)
}
