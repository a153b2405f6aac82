//! Reading the matrix from a file, and writing it to one: `:open`, `:write` and `:export`.
//!
//! The content of a file decides how it is read, its extension how it is written: an imprint as text, table, bitmap
//! or array, a shape with its source as JSON, a drawing as SVG.

use std::path::Path;

use crate::formats::file::has_ending;
use crate::formats::{Drawing, ImprintFormat, Name};
use crate::imprint::Imprint;
use crate::parameter::Parameter;
use crate::quote::shortened;
use crate::storage::{Existing, UNNAMED};
use crate::tui::app::change::{begin, inform, refuse, write_file};
use crate::tui::app::dialog::{Dialog, Question};
use crate::tui::app::document::Document;
use crate::tui::app::history::DocumentOrigin;
use crate::tui::app::message::{FileEvent, Message, OpenedFile};
use crate::tui::app::state::App;
use crate::tui::runtime::effect::{Effect, FileRequest};

const ENDINGS: &str = ".txt .csv .npy .pbm .json .svg";

/// Shows a notice and returns None if there is nothing to write, or if no format has that extension.
pub(in crate::tui) fn write(app: &mut App, name: String) -> Option<Effect> {
    if app.reading().imprint.is_empty() {
        refuse(app, "nothing to write: the matrix is empty");
        return None;
    }
    let content = content(app, &name);
    write_file(app, name, content)
}

pub(in crate::tui) fn overwrite(name: String, content: Vec<u8>) -> Effect {
    Effect::File(FileRequest::Write(name, content, Existing::Replaced))
}

fn content(app: &App, name: &str) -> Result<Vec<u8>, String> {
    let reading = app.reading();
    if let Some(format) = ImprintFormat::of_path(name) {
        return Ok(format.write(&reading.imprint));
    }
    if has_ending(name, "svg") {
        return Ok(drawing(app).svg().into_bytes());
    }
    if !has_ending(name, "json") {
        return Err(format!(
            "{:?}: expected a name that ends in one of {ENDINGS}",
            shortened(name)
        ));
    }
    let own = Path::new(name).file_stem().and_then(|stem| stem.to_str());
    let own = app.stored_name().or(own).map(Name::new);
    let name = own
        .and_then(Result::ok)
        .map_or_else(|| Name::new(UNNAMED), Ok);
    let name = name.map_err(|error| error.to_string())?;
    Ok(app.shown().to_shape(name, reading).write().into_bytes())
}

fn drawing(app: &App) -> Drawing {
    let document = app.shown();
    let mut drawing = Drawing::new(&app.reading().imprint);
    if let Some(source) = &document.source {
        drawing = drawing.with_outline(source);
    }
    if document.sensor.pitch_mm() != 1.0 {
        drawing = drawing.with_pitch(document.sensor.pitch_mm());
    }
    match app.chosen() {
        Some(index) => drawing.with_region(index),
        None => drawing,
    }
}

pub(in crate::tui) fn on_file(app: &mut App, answer: FileEvent) -> Option<Effect> {
    match answer {
        FileEvent::Opened(name, file) => match opened(app, file) {
            Ok(document) => {
                let opened = format!("{name} opened");
                let origin = DocumentOrigin::of(&document).called(&opened);
                begin(app, origin, document);
                app.history.choose(None);
                inform(app, opened);
            }
            Err(reason) => refuse(app, format!("{name}: {reason}")),
        },
        FileEvent::Written(path) => inform(app, format!("written: {path}")),
        FileEvent::Exists(name, content) => {
            let question = Question::replaces(&name, Message::Overwrite(name.clone(), content));
            app.dialogs.push(Dialog::Question(question));
        }
        FileEvent::Failed(reason) => refuse(app, reason),
        // Handled by the live page.
        FileEvent::Source(_) => {}
        FileEvent::Paths(paths) => {
            if let Some(Dialog::Command(command)) = app.dialogs.last_mut() {
                command.complete_asked(&paths);
            }
        }
    }
    None
}

fn opened(app: &App, file: OpenedFile) -> Result<Document, String> {
    match file {
        OpenedFile::Shape(shape) => Ok(Document::of_shape(&shape)),
        OpenedFile::Imprint(imprint) => of_imprint(app, &imprint),
    }
}

/// What an imprint file does not say, such as pitch and threshold, is taken from the sensor in use.
fn of_imprint(app: &App, imprint: &Imprint) -> Result<Document, String> {
    let sensor = app.history.present().sensor;
    let sensor = sensor
        .with(Parameter::Columns, imprint.columns().into())
        .and_then(|sensor| sensor.with(Parameter::Rows, imprint.rows().into()))
        .map_err(|error| error.labelled())?;
    Ok(Document::drawn(sensor, *imprint))
}
