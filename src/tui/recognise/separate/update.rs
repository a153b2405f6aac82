//! The effects of messages on the page of sizes.

use crate::formats::separation::size_label;
use crate::tui::app::change::{begin_drawn, inform, refuse, write_file};
use crate::tui::app::dialog::{Dialog, topmost};
use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::explore::export::{ExportDialog, ExportKind};
use crate::tui::explore::message::ExploreMessage;
use crate::tui::recognise::message::{RecogniseMessage, SizesFound};
use crate::tui::recognise::quiz::onto;
use crate::tui::recognise::separate::request::SeparationRequest;
use crate::tui::recognise::separate::state::Separate;
use crate::tui::runtime::effect::{Effect, Work};

/// Opens the page. It still has its earlier results if the sizes are the same.
pub(in crate::tui::recognise) fn open(app: &mut App, request: SeparationRequest) {
    let page = match app.recognition.separate.take() {
        Some(mut page) if **page.request() == request => {
            page.want_as(request);
            page.go_on();
            page
        }
        _ => Box::new(Separate::new(request)),
    };
    app.dialogs.push(Dialog::Separate(page));
}

/// Returns the remaining work of the open page, unless it was begun.
pub(in crate::tui::recognise) fn next_work(app: &mut App) -> Option<Effect> {
    let number = app.works + 1;
    let (request, known) = page(app)?.begin(number)?;
    app.works = number;
    Some(Effect::Work(Work::Separate(number, request, known)))
}

/// Handles a message over the page. During the work, Cancel and Quit first stop it and leave the page open; a second
/// time they close it.
pub(in crate::tui) fn in_separate(
    app: &mut App,
    mut page: Box<Separate>,
    message: &Message,
) -> Option<Effect> {
    let mut effect = None;
    match message {
        Message::Cancel | Message::Quit => {
            if page.stop() {
                inform(app, "stopping");
                effect = Some(Effect::Work(Work::StopSeparating));
            } else {
                page.leave();
                app.recognition.separate = Some(page);
                return None;
            }
        }
        Message::Accept => {
            if put_example(app, &page) {
                app.recognition.separate = Some(page);
                return None;
            }
        }
        Message::Recognise(RecogniseMessage::Want(by)) => page.want(*by),
        Message::Recognise(RecogniseMessage::Separate(_)) => {
            if !page.go_on() && page.work().is_none() {
                refuse(app, "all sizes are done");
            }
        }
        Message::Explore(ExploreMessage::Export) if page.found().is_empty() => {
            refuse(app, "there is nothing to export yet");
        }
        Message::Explore(ExploreMessage::Export) => {
            let name = format!("{}.svg", page.request().trained.choice.name());
            app.dialogs.push(Dialog::Separate(page));
            let dialog = ExportDialog::proposing(&name, ExportKind::Curve);
            app.dialogs.push(Dialog::Export(dialog));
            return None;
        }
        message => page.take(message),
    }
    app.dialogs.push(Dialog::Separate(page));
    effect
}

/// Puts the imprint at the cursor onto the matrix. Returns false if there is none, or while work is in progress.
fn put_example(app: &mut App, page: &Separate) -> bool {
    if page.work().is_some() {
        refuse(app, "the sizes are still being computed");
        return false;
    }
    let found = page.selected().and_then(|size| {
        let worst = size.worst.as_ref()?;
        let example = worst.example.as_ref()?;
        let name = |shape| page.request().trained.name(shape);
        let (touched, named) = (name(worst.touched), name(worst.named));
        let (axis, value) = (page.request().axis, size.point.value);
        let size = size_label(axis, value);
        let about = format!("imprint of {touched}, named {named}, at {size}");
        // The model names it as if it were of its own size, mostly otherwise than the page of sizes does.
        let own = size_label(axis, 1.0);
        let note =
            (size != own).then(|| format!("the model is of {own}; this imprint is of {size}"));
        Some((about, note, example.imprint?))
    });
    let Some((about, note, imprint)) = found else {
        refuse(app, "no shapes are confused at this size");
        return false;
    };
    let own = *page.request().trained.model.sensor();
    let (sensor, imprint) = onto(&imprint, app.history.present().sensor, own);
    begin_drawn(app, sensor, &imprint, &about);
    if let Some(note) = note {
        inform(app, note);
    }
    true
}

/// Returns the page, if it is open.
fn page(app: &mut App) -> Option<&mut Separate> {
    let page = topmost!(&mut app.dialogs, Separate)?;
    Some(page)
}

/// Takes over results.
pub(in crate::tui::recognise) fn on_found(app: &mut App, found: SizesFound) {
    if let Some(reason) = page(app).and_then(|page| page.take_found(found)) {
        refuse(app, reason);
    }
}

/// Handles an unexpected failure of the work with this number.
pub(in crate::tui::recognise) fn on_failure(app: &mut App, number: u64, reason: &str) {
    let found = SizesFound {
        number,
        sizes: Vec::new(),
        end: Some(Err(reason.to_owned())),
    };
    on_found(app, found);
}

/// Records the progress of the work with this number.
pub(in crate::tui::recognise) fn on_progress(app: &mut App, number: u64, done: u64) {
    if let Some(page) = page(app) {
        page.take_progress(number, done);
    }
}

/// Writes the sizes into a file, unless a file with this name exists.
pub(in crate::tui::recognise) fn write(app: &mut App, name: String) -> Option<Effect> {
    let content = page(app)?.file(&name);
    write_file(app, name, content)
}
