//! Changes of the document: touching, moving, turning, zooming, undo and redo.
//!
//! Each change calls `change`, `begin`, `resume` or `travel`, which bring everything that depends on the
//! document back into range, such as the chosen region. All but `change` let a held shape go and end a drag: both
//! belong to the document that they began on. The cursor stays where it was put; [`App::cursor`] keeps it on the
//! sensor.

use std::path::Path;
use std::sync::Arc;

use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::parameter::number::to_decimals;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_files::formats::value::counted;
use taxel_files::storage::{Existing, FileError};

use crate::tui::app::{App, Document, DocumentOrigin, History, MoveKind, Notice, Page, Question};
use crate::tui::compare::{Comparison, heading};
use crate::tui::files;
use crate::tui::jobs::answer;
use crate::tui::keys::action;

pub(in crate::tui) fn inform(app: &mut App, text: impl Into<String>) {
    app.notice = Some(Notice {
        text: text.into(),
        is_refusal: false,
        stays: false,
    });
}

/// The matrix comes second: it is the later one, or is being made from the other.
pub(in crate::tui) fn compare_with(app: &mut App, name: &str, other: &Imprint) {
    let own = ("the matrix".to_owned(), &app.reading().imprint);
    let comparison = Comparison::new((heading(name), other), own);
    app.open(comparison);
}

/// Shows a notice that says why something was not done, whatever the reason: an `!` stands before it.
pub(in crate::tui) fn refuse(app: &mut App, text: impl Into<String>) {
    inform(app, text);
    if let Some(notice) = &mut app.notice {
        notice.is_refusal = true;
    }
}

/// The chosen region stays chosen if there still is a region of that number.
pub(in crate::tui) fn change(app: &mut App, document: Document) {
    app.history.push(document);
    settle(app);
}

pub(in crate::tui) fn begin(app: &mut App, origin: DocumentOrigin, document: Document) {
    app.history.begin(document, origin);
    settle_elsewhere(app);
}

/// `brought_by` is the name of the step, for undo.
pub(in crate::tui) fn begin_drawn(
    app: &mut App,
    sensor: Sensor,
    imprint: &Imprint,
    brought_by: &str,
) {
    let document = Document::drawn(sensor, *imprint);
    let origin = DocumentOrigin::of(&document).called(brought_by);
    begin(app, origin, document);
}

pub(in crate::tui) fn resume(app: &mut App, origin: DocumentOrigin, document: Document) {
    app.history.resume(document, origin);
    settle_elsewhere(app);
}

fn settle_elsewhere(app: &mut App) {
    app.held = None;
    app.pen = None;
    app.paint = None;
    settle(app);
}

pub(in crate::tui) fn settle(app: &mut App) {
    app.moves = None;
    if app.history.present().source.is_none() {
        app.held = None;
    }
    app.read();
    let regions = app.reading().regions.len();
    let chosen = app.chosen().filter(|&index| index < regions);
    app.history.choose(chosen);
}

/// Goes back or forward by one change, which a notice names: `done` is "undone" or "redone". `otherwise` is the
/// notice if there is no change.
pub(in crate::tui) fn travel(
    app: &mut App,
    step: impl FnOnce(&mut History) -> Option<String>,
    done: &str,
    otherwise: &str,
) {
    match step(&mut app.history) {
        Some(what) => {
            settle_elsewhere(app);
            inform(app, format!("{done}: {what}"));
        }
        None => refuse(app, otherwise),
    }
}

pub(in crate::tui) fn hold(app: &mut App) {
    if movable(app).is_some() {
        app.held = Some(Box::new(app.history.present().clone()));
    }
}

pub(in crate::tui) fn put_back(app: &mut App) {
    let Some(before) = app.held.take() else {
        return refuse(app, "nothing is held");
    };
    if *before == *app.history.present() {
        return;
    }
    inform(app, "put back");
    // If the shape was only moved, no trace is left. Other changes made meanwhile can still be undone.
    let only_moved = app.moves.take() == Some(MoveKind::Held);
    if only_moved && app.history.before() == Some(&*before) {
        app.history.amend(*before);
        settle(app);
    } else {
        change_shape(app, *before);
    }
}

fn change_shape(app: &mut App, document: Document) {
    let dropped = dropped(app, &document);
    change(app, document);
    say_dropped(app, dropped);
}

pub(in crate::tui) fn is_other(app: &App, document: &Document) -> bool {
    let present = app.history.present().source.as_ref();
    app.stored().is_some_and(|stored| match &document.source {
        Some(Source::Figure(figure)) => present.and_then(Source::kind) != Some(figure.kind()),
        Some(source) if present.is_some_and(|present| present.is_alike(source)) => false,
        Some(source) => source.stored_name() != Some(stored.name.as_str()),
        None => false,
    })
}

/// Replaces the document with one from a form or a command. A figure of another kind, or a picture or an outline of
/// another shape, is a new document, and the name stays with the old one. A notice says how many taxels set by hand
/// were dropped. A held shape is let go.
pub(in crate::tui) fn replace(app: &mut App, document: Document) {
    app.held = None;
    app.pen = None;
    let present = app.history.present();
    if *present == document {
        return;
    }
    let dropped = dropped(app, &document);
    let lost = match (&present.source, &document.source) {
        (Some(lost), None) => Some(lost.kind_name()),
        _ => None,
    };
    if is_other(app, &document) {
        let origin = DocumentOrigin::unsaved(&document);
        begin(app, origin, document);
    } else {
        change(app, document);
    }
    match lost {
        Some(what) => {
            let undo = app.key_of(&action::UNDO);
            let text = format!("the {what} does not fit this sensor and became a drawing");
            inform(app, format!("{text}; {undo} undoes it"));
        }
        None => say_dropped(app, dropped),
    }
}

/// An imprint that was loaded, or taken from a frame, was not set by hand; a picture of the whole drawing loses
/// nothing.
fn dropped(app: &App, document: &Document) -> u32 {
    let (present, begun) = (app.history.present(), app.history.begun());
    if let (None, Some(Source::Picture(picture))) = (&present.source, &document.source)
        && *picture.imprint() == present.edits
    {
        return 0;
    }
    let by_hand = |document: &Document| match (&document.source, &begun.source) {
        (None, None) => document.edits.differing(&begun.edits).count(),
        _ => document.edits.count(),
    };
    by_hand(present).saturating_sub(by_hand(document))
}

fn say_dropped(app: &mut App, dropped: u32) {
    let (were, them) = match dropped {
        0 => return,
        1 => ("was", "it"),
        _ => ("were", "them"),
    };
    let (taxels, undo) = (counted(dropped, "taxel"), app.key_of(&action::UNDO));
    let text = format!("{taxels} set by hand {were} dropped; {undo} restores {them}");
    inform(app, text);
}

/// Returns the source on the matrix. If there is none, a notice says that only a shape can be moved, and how there is
/// one.
pub(in crate::tui) fn movable(app: &mut App) -> Option<Source> {
    let source = app.history.present().source.clone();
    if source.is_none() {
        let (figure, picture) = (app.key_of(&action::FIGURE), app.key_of(&action::PICTURE));
        let text = if app.reading().imprint.is_empty() {
            format!("nothing to move: {figure} places a figure, {picture} a stored shape")
        } else {
            format!("a drawing has no position; {picture} places a saved one")
        };
        refuse(app, text);
    }
    source
}

pub(in crate::tui) fn shift(app: &mut App, dx: f64, dy: f64) {
    let Some(source) = movable(app) else { return };
    let ways = [(Parameter::X0, dx), (Parameter::Y0, dy)];
    let ways = ways.into_iter().filter(|(_, by)| *by != 0.0);
    let moved = ways.filter_map(|(way, by)| Some((way, rounded(source.get(way)? + by))));
    let moved: Vec<_> = moved.collect();
    set(app, source, MoveKind::Along, &moved);
}

/// Turns the shape clockwise as seen, by degrees.
pub(in crate::tui) fn turn(app: &mut App, clockwise: f64) {
    let Some(source) = movable(app) else { return };
    if let Some(angle) = source.get(Parameter::Angle) {
        let turned = angle + clockwise % 360.0 * source.sense();
        // An angle that rounds up to 360° is 0°.
        let angle = rounded(turned.rem_euclid(360.0)) % 360.0;
        set(app, source, MoveKind::Turn, &[(Parameter::Angle, angle)]);
    }
}

pub(in crate::tui) fn zoom(app: &mut App, direction: i8) {
    let Some(source) = movable(app) else { return };
    let by = f64::from(direction) * app.step;
    let (Some(x), Some(y)) = (source.get(Parameter::ZoomX), source.get(Parameter::ZoomY)) else {
        let figure = app.key_of(&action::FIGURE);
        let text = format!("a figure has no zoom; {figure} changes its size");
        return refuse(app, text);
    };
    let zoomed = [(Parameter::ZoomX, x), (Parameter::ZoomY, y)];
    let zoomed = zoomed.map(|(way, zoom)| (way, rounded(zoom + by)));
    set(app, source, MoveKind::Zoom, &zoomed);
}

/// Writes a file. If one of that name exists, asks whether to replace it.
pub(crate) fn write_file(
    app: &mut App,
    name: String,
    existing: Existing,
    write: impl Fn(&Path, Existing) -> Result<(), FileError> + Send + 'static,
) {
    let access = Arc::clone(&app.jobs.access);
    app.jobs.disk(format!("Writing {name}"), move |_| {
        let written = files::write(&access, &name, existing, &write);
        answer(move |app| match written {
            Ok(Some(path)) => inform(app, format!("written: {path}")),
            Ok(None) => {
                app.open(Question::replaces(name, |app, name| {
                    write_file(app, name, Existing::Replaced, write);
                }));
            }
            Err(reason) => refuse(app, reason),
        })
    });
}

/// Carries out the request of a prompt. The prompt stays open if the request is refused and no other page opens. If
/// the answer comes later, or if there is a question first, the prompt opens again if that is a refusal.
pub(crate) fn from_prompt(app: &mut App, prompt: Box<dyn Page>, act: impl FnOnce(&mut App)) {
    let pages = app.pages.len();
    act(app);
    let is_refused = app.notice.as_ref().is_some_and(|said| said.is_refusal);
    if is_refused && app.pages.len() == pages {
        app.pages.push(prompt);
    } else {
        app.prompt = Some(prompt);
        give_prompt(app);
    }
}

pub(crate) fn give_prompt(app: &mut App) {
    if let Some(prompt) = app.prompt.take() {
        match app.top_mut::<Question>() {
            Some(question) => question.prompt = Some(prompt),
            None => app.prompt = Some(prompt),
        }
    }
}

/// Rounds to the six decimals that a moved value keeps, so that steps of a hundredth do not drift.
fn rounded(value: f64) -> f64 {
    to_decimals(value, 6)
}

/// Gives the source new values and touches the matrix again. If the last message moved in the same way, both are one
/// step of the history. A value out of range is refused, and nothing changes.
fn set(app: &mut App, source: Source, way: MoveKind, values: &[(Parameter, f64)]) {
    let sensor = app.history.present().sensor;
    let mut values = values.iter();
    match values.try_fold(source, |source, &(own, value)| {
        source.with(own, value, &sensor)
    }) {
        // If nothing moves, the taxels set by hand stay.
        Ok(source) if app.history.present().source.as_ref() == Some(&source) => {}
        Ok(source) => {
            let document = Document::touched(sensor, source);
            let way = app.held.as_ref().map_or(way, |_| MoveKind::Held);
            if app.moves == Some(way) {
                app.history.amend(document);
                settle(app);
            } else {
                change_shape(app, document);
            }
            app.moves = Some(way);
        }
        Err(error) => refuse(app, error.labelled()),
    }
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn steps_lead_to_zero_and_not_to_minus_zero() {
        let there = [0.3, -0.1, -0.1, -0.1].iter().sum::<f64>();
        assert!(there < 0.0);
        assert_eq!(rounded(there).to_string(), "0");
        assert_eq!(rounded(0.1 + 0.2).to_string(), "0.3");
    }
}
