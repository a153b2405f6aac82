//! Acts on the library: load, save, delete, restore. Each is a closure that the disk's worker runs, and its answer.

use taxel_files::formats::{Name, StoredShape};
use taxel_files::storage::{Expected, Library, LibraryError, LoadedShape, ShapeOrigin};

use crate::tui::app::change::{begin, compare_with, inform, refuse};
use crate::tui::app::document::Document;
use crate::tui::app::history::{DocumentOrigin, StoredName};
use crate::tui::app::message::Purpose;
use crate::tui::app::question::Question;
use crate::tui::app::state::{App, Saving};
use crate::tui::app::unsaved::quit;
use crate::tui::form::FormDialog;
use crate::tui::jobs::{answer, caught};
use crate::tui::keys::action;
use crate::tui::{live, recognise};

/// Does with the shape of that name what it was chosen for.
pub(crate) fn named(app: &mut App, purpose: Purpose, name: String) {
    match purpose {
        Purpose::Delete => ask_to_delete(app, name),
        purpose => load(app, purpose, name),
    }
}

fn load(app: &mut App, purpose: Purpose, name: String) {
    app.jobs.read(format!("Loading {name}"), move |library| {
        let loaded = library.load(&name);
        let loaded = loaded.map_err(|error| sentence(library, &error));
        answer(move |app| match (loaded, purpose) {
            (Ok(loaded), Purpose::Picture) => {
                let name = loaded.shape.name.to_string();
                let before = app.history.present();
                match Document::placed(before.sensor, loaded.shape.touched_again()) {
                    Ok(placed) => app.open(FormDialog::picture(before, placed, name)),
                    Err(error) => {
                        let change = app.key_of(&action::SENSOR);
                        refuse(app, format!("{name}: {error}; {change} changes the sensor"));
                    }
                }
            }
            (Ok(loaded), Purpose::Compare) => {
                compare_with(app, loaded.shape.name.as_str(), &loaded.shape.imprint);
            }
            (Ok(loaded), Purpose::Load | Purpose::Delete) => put_on_matrix(app, &loaded),
            (Err(reason), _) => refuse(app, reason),
        })
    });
}

/// Brings a shape onto the matrix: with its sensor and source if that sensor has the same number of columns and rows,
/// otherwise its imprint alone, if all active taxels fit.
fn put_on_matrix(app: &mut App, loaded: &LoadedShape) {
    let (shape, sensor) = (&loaded.shape, app.history.present().sensor);
    let (own, here) = (shape.sensor.size(), sensor.size());
    let document = if own == here {
        Document::of_shape(shape)
    } else {
        let imprint = shape.imprint.resized(here);
        if imprint.count() < shape.imprint.count() {
            let change = app.key_of(&action::SENSOR);
            let name = &shape.name;
            let text = format!(
                "{name} is {own} and does not fit on {here} taxels; {change} changes the sensor"
            );
            return refuse(app, text);
        }
        Document::drawn(sensor, imprint)
    };
    // A shape for a sensor of another size becomes another shape: it is not stored under that name.
    let mut origin = DocumentOrigin::of(&document);
    if own == here {
        origin = origin.called(format!("{} loaded", shape.name));
        origin.name = Some(StoredName {
            name: shape.name.to_string(),
            stamp: loaded.stamp,
            owner: loaded.origin,
        });
    }
    begin(app, origin, document);
    app.history.choose(None);
    inform(app, format!("{} loaded", shape.name));
}

fn ask_to_delete(app: &mut App, name: String) {
    app.jobs
        .read(format!("Looking for {name}"), move |library| {
            let found = library.deletable(&name);
            let found = found.map_err(|error| sentence(library, &error));
            answer(|app| match found {
                Ok(name) => {
                    let text = format!("Delete {name:?}?");
                    app.open(Question::new("", text, |app| delete(app, name)));
                }
                Err(reason) => refuse(app, reason),
            })
        });
}

fn delete(app: &mut App, name: String) {
    app.jobs.disk(format!("Deleting {name}"), move |library| {
        let deleted = library.delete(&name);
        let deleted = deleted.map_err(|error| sentence(library, &error));
        answer(|app| match deleted {
            Ok(name) => {
                // The matrix may show the only copy that is left.
                app.history.removed(&name);
                changed(app);
                let text = format!("{name} deleted; :restore {name} brings it back");
                inform(app, text);
            }
            Err(reason) => refuse(app, reason),
        })
    });
}

pub(crate) fn restore(app: &mut App, name: Option<String>) {
    let what = name.as_deref().unwrap_or("a shape");
    app.jobs.disk(format!("Restoring {what}"), move |library| {
        let restored = library.restore(name.as_deref());
        let restored = restored.map_err(|error| sentence(library, &error));
        answer(|app| match restored {
            Ok(name) => {
                changed(app);
                inform(app, format!("{name} is back"));
            }
            Err(reason) => refuse(app, reason),
        })
    });
}

/// The pages that name shapes have to know others from now on.
fn changed(app: &mut App) {
    recognise::page::library_changed(app);
    live::names::library_changed(app);
}

/// Saves what is on the matrix. It replaces no file, not even the one that the document came from: if there is one, the
/// library says what it holds now, and the user is asked.
pub(crate) fn save(app: &mut App, name: Name, quits: bool) {
    if is_saving(app) {
        return;
    }
    let document = app.history.present().clone();
    let shape = document.to_shape(name);
    let saving = Saving {
        shape: Box::new(shape),
        origin: app.history.origin_index(),
        document,
        quits,
    };
    store(app, saving, Expected::Nothing);
}

/// Whether a shape is being saved still, which a notice says then.
pub(crate) fn is_saving(app: &mut App) -> bool {
    let Some(saving) = &app.saving else {
        return false;
    };
    let text = format!("{} is still being saved", saving.shape.name);
    refuse(app, text);
    true
}

enum Stored {
    /// With the stamp of the file.
    As(u64),
    /// The file holds something else: the stamp of that, and the reason in words.
    Differs(u64, String),
    Not(String),
}

fn store(app: &mut App, saving: Saving, expected: Expected) {
    let (shape, what) = (
        saving.shape.clone(),
        format!("Saving {}", saving.shape.name),
    );
    app.saving = Some(saving);
    app.jobs.disk(what, move |library| {
        let stored = caught(|| stored(library, &shape, expected));
        let stored = stored.unwrap_or_else(Stored::Not);
        answer(|app| on_stored(app, stored))
    });
}

fn stored(library: &Library, shape: &StoredShape, expected: Expected) -> Stored {
    let error = match library.save(shape, expected) {
        Ok(stamp) => return Stored::As(stamp),
        Err(error) => error,
    };
    let reason = error.to_string();
    match error {
        LibraryError::Exists { stamp, .. } | LibraryError::Changed { stamp, .. } => {
            Stored::Differs(stamp, reason)
        }
        LibraryError::Shipped(name) => Stored::Not(format!(
            "{name} is the name of a shipped shape; choose another"
        )),
        _ => Stored::Not(reason),
    }
}

fn on_stored(app: &mut App, stored: Stored) {
    let Some(saving) = app.saving.take() else {
        return;
    };
    match stored {
        Stored::As(stamp) => {
            let name = saving.shape.name.to_string();
            changed(app);
            inform(app, format!("saved as {name}"));
            let name = StoredName {
                name,
                stamp,
                owner: ShapeOrigin::Own,
            };
            app.history.stored(saving.origin, saving.document, name);
            if saving.quits {
                // Asks once more if an earlier drawing is not saved.
                quit(app);
            }
        }
        Stored::Differs(stamp, reason) => ask_to_replace(app, saving, stamp, reason),
        Stored::Not(reason) => not_saved(app, saving, reason),
    }
}

/// At the end of the program nobody sees a notice: the shape goes to the journal, and the end says why.
fn not_saved(app: &mut App, saving: Saving, reason: String) {
    if app.ended() {
        app.saving = Some(saving);
        return refuse(app, format!("not saved: {reason}"));
    }
    refuse(app, reason);
}

/// If the document came from that file, the question says whether another program has changed it since.
fn ask_to_replace(app: &mut App, saving: Saving, stamp: u64, reason: String) {
    let own = app.history.origins.get(saving.origin);
    let own = own.and_then(|origin| origin.name.as_ref());
    let own = own.filter(|own| own.is_own() && saving.shape.name.same(&own.name));
    let reason = match own.filter(|own| own.stamp != stamp) {
        Some(own) => {
            let name = own.name.clone();
            LibraryError::Changed { name, stamp }.to_string()
        }
        None => reason,
    };
    if app.ended() {
        return not_saved(app, saving, reason);
    }
    let yes = move |app: &mut App| store(app, saving, Expected::Stamp(stamp));
    app.open(Question::new(format!("{reason}."), "Replace it?", yes));
}

pub(crate) fn sentence(library: &Library, error: &LibraryError) -> String {
    format!("{error}{}", library.suggestion(error))
}
