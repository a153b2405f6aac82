//! The effects of messages in the list of shapes, and of the library's answers.
//!
//! Requests to the library are effects ([`LibraryRequest`]); its answers come back as messages, perhaps after the
//! page that asked was closed. An answer for a closed page changes nothing.

use taxel_core::imprint::Imprint;
use taxel_core::picture::Picture;
use taxel_files::formats::StoredShape;
use taxel_files::formats::value::counted;
use taxel_files::storage::{
    Expected, LibraryEntry, LibraryError, LoadedShape, ModelChoice, ShapeOrigin, UNNAMED, shipped,
};

use crate::tui::app::change::{begin, compare_with, from_prompt, inform, refuse, resume};
use crate::tui::app::dialog::{Dialog, Question};
use crate::tui::app::document::Document;
use crate::tui::app::history::{DocumentOrigin, StoredName};
use crate::tui::app::message::{Leftover, LibraryEvent, LibraryRequest, Message, Purpose};
use crate::tui::app::state::{App, UnfinishedSave};
use crate::tui::app::unsaved::quit;
use crate::tui::form::state::FormDialog;
use crate::tui::keys::action::{self, Arguments};
use crate::tui::live;
use crate::tui::matrix::update::name_of_copy;
use crate::tui::prompt::commands::wants_names;
use crate::tui::runtime::effect::Effect;
use crate::tui::shapes::state::{ListDialog, ListPurpose};
use crate::tui::widget::rows::moved;

/// Handles a message. The list goes back onto the stack unless a shape is taken.
pub(in crate::tui) fn update(
    app: &mut App,
    mut list: ListDialog,
    message: Message,
) -> Option<Effect> {
    list.accept(false);
    match message {
        Message::Accept => return choose(app, list),
        other => match moved(list.selected(), &other) {
            Some(row) => list.select(row),
            None => list.edit(&other),
        },
    }
    app.dialogs.push(Dialog::List(list));
    read_visible(app)
}

pub(in crate::tui) fn on_library(app: &mut App, answer: LibraryEvent) -> Option<Effect> {
    match answer {
        LibraryEvent::List(Ok(entries)) => return on_list(app, entries),
        LibraryEvent::List(Err(reason)) => {
            app.dialogs
                .pop_if(|dialog| matches!(dialog, Dialog::List(_)));
            refuse(app, reason);
        }
        LibraryEvent::Models(names) => return on_models(app, &names),
        LibraryEvent::Trash(Ok(names)) => on_trash(app, &names),
        LibraryEvent::Read(read) => {
            if let Some(Dialog::List(list)) = app.dialogs.last_mut() {
                list.take(read);
            }
            return choose_accepted(app);
        }
        LibraryEvent::Named(purpose, Ok(loaded)) => on_named(app, purpose, &loaded),
        LibraryEvent::Deletable(Ok(name)) => ask_removal(app, name),
        LibraryEvent::Stored(name, stamp) => on_stored(app, name, stamp),
        LibraryEvent::NotStored(reason) => {
            let save = app.saving.pop_front();
            not_saved(app, save, reason);
        }
        LibraryEvent::Differs(shape, stamp, reason) => {
            ask_replacement(app, shape, stamp, reason);
        }
        LibraryEvent::Removed(name) => on_removed(app, name),
        LibraryEvent::Restored(name) => {
            app.removed.retain(|removed| *removed != name);
            app.history.restored(&name);
            inform(app, format!("{name} is back"));
        }
        LibraryEvent::Found(left) => offer(app, &left),
        LibraryEvent::Recovered(shape) => on_recovered(app, &shape),
        LibraryEvent::GivenUp(name, left) => on_given_up(app, &name, left),
        LibraryEvent::NotGivenUp(reason) => {
            let text = "the unsaved work cannot be moved to the trash, and is offered again at the next start";
            refuse(app, format!("{text}: {reason}"));
        }
        LibraryEvent::Named(_, Err(reason))
        | LibraryEvent::Deletable(Err(reason))
        | LibraryEvent::Trash(Err(reason))
        | LibraryEvent::Failed(reason) => refuse(app, reason),
    }
    None
}

fn on_models(app: &mut App, names: &[String]) -> Option<Effect> {
    match app.dialogs.last_mut() {
        Some(Dialog::Command(command)) => {
            let sets = ModelChoice::BUILT_IN.iter();
            let sets: Vec<String> = sets.map(|set| set.name().to_owned()).collect();
            command.complete_asked(&[&sets[..], names].concat());
            None
        }
        Some(Dialog::Live(_)) => live::update::name_by_next(app, names),
        _ => None,
    }
}

fn on_trash(app: &mut App, names: &[String]) {
    if names.is_empty() {
        refuse(app, "nothing has been deleted");
    }
    if let Some(Dialog::Command(command)) = app.dialogs.last_mut() {
        command.complete_asked(names);
    }
}

fn on_named(app: &mut App, purpose: Purpose, loaded: &LoadedShape) {
    let shape = &loaded.shape;
    match purpose {
        Purpose::Picture => open_picture(app, &shape.imprint, shape.name.to_string()),
        Purpose::Compare => compare_with(app, shape.name.as_str(), &shape.imprint),
        Purpose::Load | Purpose::Delete => {
            if let Err(reason) = put_on_matrix(app, loaded) {
                refuse(app, reason);
            }
        }
    }
}

/// After a command that deletes or replaces, only shapes of the user's own are offered: shipped ones are read-only.
fn on_list(app: &mut App, mut entries: Vec<LibraryEntry>) -> Option<Effect> {
    match app.dialogs.last_mut() {
        Some(Dialog::List(list)) => {
            list.fill(entries);
            choose_accepted(app).or_else(|| read_visible(app))
        }
        Some(Dialog::Command(command)) => {
            match wants_names(command.field.text()) {
                Some(Arguments::Shape(Purpose::Load | Purpose::Picture | Purpose::Compare)) => {}
                _ => entries.retain(|entry| entry.origin == ShapeOrigin::Own),
            }
            let names: Vec<String> = entries.into_iter().map(|entry| entry.name).collect();
            command.complete_asked(&names);
            None
        }
        _ => None,
    }
}

/// Earlier states in the history may bear its name.
fn on_removed(app: &mut App, name: String) {
    // The matrix may show the only copy that is left.
    app.history.removed(&name);
    let how = how_to_restore(app, &name);
    inform(app, format!("{name} deleted; {how}"));
    app.removed.push(name);
}

/// Puts unsaved work of an earlier run onto the matrix. It keeps the name that it had, or was to be saved under.
fn on_recovered(app: &mut App, shape: &StoredShape) {
    let document = Document::of_shape(shape);
    let origin = DocumentOrigin::unsaved(&document);
    let origin = match shape.name.as_str() {
        UNNAMED => {
            let taxels = counted(shape.imprint.count(), "taxel");
            origin.called(format!("{taxels} restored"))
        }
        name => {
            let is_shipped = shipped::get(name).is_some();
            let proposed = is_shipped.then(|| name_of_copy(name));
            let proposed = proposed.unwrap_or_else(|| name.to_owned());
            origin
                .called(format!("{name} restored"))
                .proposing(proposed)
        }
    };
    resume(app, origin, document);
    let save = app.key_of(&action::SAVE);
    inform(app, format!("restored; {save} saves it"));
}

fn on_given_up(app: &mut App, name: &str, left: Option<Leftover>) {
    app.removed.push(name.to_owned());
    if let Some(left) = left {
        inform(app, format!("{name} is in the trash"));
        offer(app, &left);
    } else {
        let how = how_to_restore(app, name);
        let text = "the unsaved work is in the trash as";
        inform(app, format!("{text} {name}; {how}"));
    }
}

fn how_to_restore(app: &App, name: &str) -> String {
    let undo = app.key_of(&action::UNDO);
    format!("{undo} restores it now, :restore {name} later")
}

fn on_stored(app: &mut App, name: String, stamp: u64) {
    inform(app, format!("saved as {name}"));
    if let Some(save) = app.saving.pop_front() {
        let name = StoredName {
            name,
            stamp,
            owner: ShapeOrigin::Own,
        };
        app.history.stored(save.origin, save.document, name);
    }
    if std::mem::take(&mut app.quits_when_saved) {
        // Asks once more if an earlier drawing is not saved.
        quit(app);
    }
}

/// At the end of the program nobody sees a notice: the shape goes to the journal, and the end says why.
fn not_saved(app: &mut App, save: Option<UnfinishedSave>, reason: String) {
    match save.filter(|_| app.ended()) {
        Some(save) => app.refused_at_end.push((save, reason)),
        None => refuse(app, reason),
    }
}

/// Asks whether to restore the unsaved work of a program that crashed.
/// Work of several crashes is offered one after the other; no answer keeps it for the next start. While a sensor is
/// watched the question waits below that page.
fn offer(app: &mut App, left: &Leftover) {
    let of = match left.waiting {
        0 | 1 => String::new(),
        all => format!(" (1 of {all})"),
    };
    let text = format!("There is unsaved work from last time{of}: {}.", left.what);
    let question = Question {
        no: Some(Message::GiveUp),
        meanings: Some(["yes", "to the trash"]),
        left: Some("ask next time"),
        ..Question::new(text.clone(), "Restore it?", Message::Recover)
    };
    let live = |dialog: &Dialog| matches!(dialog, Dialog::Live(_));
    match app.dialogs.iter().position(live) {
        // A user who watches a sensor wants the keys of that page now, not those of a question.
        Some(below) => {
            app.dialogs.insert(below, Dialog::Question(question));
            inform(
                app,
                format!("{text} It is offered when this page is closed."),
            );
        }
        None => app.dialogs.push(Dialog::Question(question)),
    }
}

/// A library may be large, and only rows in sight need their size and preview.
fn read_visible(app: &mut App) -> Option<Effect> {
    let Some(Dialog::List(list)) = app.dialogs.last_mut() else {
        return None;
    };
    let unread = list.ask();
    (!unread.is_empty()).then_some(Effect::Library(LibraryRequest::Read(unread)))
}

fn choose_accepted(app: &mut App) -> Option<Effect> {
    let accepted = |dialog: &mut Dialog| matches!(dialog, Dialog::List(list) if list.is_accepted());
    match app.dialogs.pop_if(accepted) {
        Some(Dialog::List(mut list)) => {
            list.accept(false);
            choose(app, list)
        }
        _ => None,
    }
}

/// Takes the selected shape of a list, for the purpose of the list.
/// A shape that cannot be read, or that does not fit, leaves the list open for another choice. Only deleting needs no
/// reading: a broken file can be deleted, too.
fn choose(app: &mut App, mut list: ListDialog) -> Option<Effect> {
    let purpose = list.purpose;
    let chosen = list
        .choice()
        .map(|(entry, read)| (entry.name.clone(), read.cloned()));
    match (chosen, purpose) {
        (None, _) => {
            let listed = list.listed;
            list.accept(!listed);
            app.dialogs.push(Dialog::List(list));
            if listed {
                refuse(app, "there is no shape to choose");
            }
        }
        (Some((name, _)), ListPurpose::Delete) => {
            let request = Effect::Library(LibraryRequest::Deletable(name));
            return from_prompt(app, Dialog::List(list), |_| Some(request));
        }
        (Some((_, Some(Ok(loaded)))), ListPurpose::Load) => {
            if let Err(text) = put_on_matrix(app, &loaded) {
                app.dialogs.push(Dialog::List(list));
                refuse(app, text);
            }
        }
        (Some((name, Some(Ok(loaded)))), ListPurpose::Picture) => {
            open_picture(app, &loaded.shape.imprint, name);
        }
        (Some((_, None)), _) => {
            list.accept(true);
            app.dialogs.push(Dialog::List(list));
        }
        (Some((name, Some(Err(reason)))), _) => {
            app.dialogs.push(Dialog::List(list));
            refuse(app, format!("{name}: {reason}"));
        }
    }
    None
}

/// Asks whether to replace the file, with content of this stamp, that has kept a shape from being stored. If the
/// document came from that file, the question says whether another program has changed it since.
fn ask_replacement(app: &mut App, shape: Box<StoredShape>, stamp: u64, reason: String) {
    let save = app.saving.pop_front();
    let origin = save.as_ref();
    let origin = origin.and_then(|save| app.history.origins.get(save.origin));
    let own = origin.and_then(|origin| origin.name.as_ref());
    let own = own.filter(|own| own.owner == ShapeOrigin::Own && shape.name.same(&own.name));
    let reason = match own.filter(|own| own.stamp != stamp) {
        Some(own) => {
            let name = own.name.clone();
            LibraryError::Changed { name, stamp }.to_string()
        }
        None => reason,
    };
    if app.ended() {
        return not_saved(app, save, reason);
    }
    let store = LibraryRequest::Store(shape, Expected::Stamp(stamp));
    let question = Question::new(format!("{reason}."), "Replace it?", Message::Request(store));
    app.dialogs.push(Dialog::Question(question));
}

fn ask_removal(app: &mut App, name: String) {
    let text = format!("Delete {name:?}?");
    let question = Question::new("", text, Message::Request(LibraryRequest::Remove(name)));
    app.dialogs.push(Dialog::Question(question));
}

fn open_picture(app: &mut App, imprint: &Imprint, name: String) {
    let picture = Picture::at_home(*imprint).named(&name);
    let form = FormDialog::picture(app.history.present(), picture, name);
    app.dialogs.push(Dialog::Form(Box::new(form)));
}

/// Brings a shape onto the matrix: with its sensor and source if that sensor has the same number of columns and rows,
/// otherwise its imprint alone, if all active taxels fit. Returns an error if they do not.
fn put_on_matrix(app: &mut App, loaded: &LoadedShape) -> Result<(), String> {
    let (shape, sensor) = (&loaded.shape, app.history.present().sensor);
    let (own, here) = (shape.sensor.size(), sensor.size());
    let document = if own == here {
        Document::of_shape(shape)
    } else {
        let imprint = shape.imprint.resized(here);
        if imprint.count() < shape.imprint.count() {
            let change = app.key_of(&action::SENSOR);
            return Err(format!(
                "{} is {own} and does not fit on {here} taxels; {change} changes the sensor",
                shape.name
            ));
        }
        Document::drawn(sensor, imprint)
    };
    // A shape for a sensor of another size becomes another shape: it is not stored under that name.
    let mut origin = DocumentOrigin::of(&document);
    if own == here {
        origin = origin.loaded(StoredName {
            name: shape.name.to_string(),
            stamp: loaded.stamp,
            owner: loaded.origin,
        });
    }
    begin(app, origin, document);
    app.history.choose(None);
    inform(app, format!("{} loaded", shape.name));
    Ok(())
}
