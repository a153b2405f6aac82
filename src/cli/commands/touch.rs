//! `taxel figure` and `taxel picture`: touches a shape once and prints the imprint and its descriptors. `--save`
//! stores the shape too, and `--export` writes it to a file.

use std::ffi::OsStr;

use crate::cli::arguments::export::Export;
use crate::cli::arguments::form::Form;
use crate::cli::arguments::kept::Kept;
use crate::cli::arguments::parameters::Given;
use crate::cli::error::CliError;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::Charset;
use crate::cli::output::report;
use crate::formats::Content;
use crate::formats::StoredShape;
use crate::picture::Picture;
use crate::sensor::Sensor;
use crate::source::Source;
use crate::touch::Plane;

pub(crate) struct Touched {
    /// For standard output: the imprint with its descriptors, or with `--export -` the exported file instead.
    pub(crate) answer: Vec<u8>,
    /// For standard error: what the sensor cuts off, and what else was done, one line each. A table contains these
    /// lines itself.
    pub(crate) notes: Vec<String>,
}

pub(crate) fn touch(
    source: &Source,
    sensor: Sensor,
    form: Form,
    kept: &Kept,
    shelf: &Shelf,
    charset: Charset,
) -> Result<Touched, CliError> {
    let imprint = Plane::new(sensor).touch(source);
    let (Form::Json(pitch) | Form::Table(pitch)) = form;
    let pitch = pitch.of(Some(&sensor));
    let mut made = vec![source.to_string()];
    let beyond = report::beyond(source, &sensor);
    let mut done = Vec::new();
    let shape = |name| StoredShape {
        name,
        sensor,
        imprint,
        source: Some(source.clone()),
    };
    let begin = |export: &Export| export.begin(&imprint, Some(source), &made[0], pitch);
    let instead = kept.keep(begin, shape, shelf, &mut done)?;
    let answer = match (instead, form) {
        (Some(content), _) => content,
        (None, Form::Json(_)) => report::json(&imprint).into_bytes(),
        (None, Form::Table(_)) => {
            made.extend(beyond);
            made.push(report::size(&imprint, Some(&sensor), pitch));
            made.extend(done);
            return Ok(Touched {
                answer: report::table(&imprint, &made, pitch, charset).into_bytes(),
                notes: Vec::new(),
            });
        }
    };
    let notes = beyond.into_iter().chain(done).collect();
    Ok(Touched { answer, notes })
}

/// Looks up a shape and returns it as a picture with the given values, with its sensor.
///
/// The sensor is that of the stored shape. An imprint alone gets the default sensor, or a larger one if it needs
/// that.
pub(crate) fn picture(
    what: &OsStr,
    given: &Given,
    shelf: &Shelf,
) -> Result<(Source, Sensor), CliError> {
    let (picture, sensor) = match shelf.find(what)? {
        Content::Shape(shape) => {
            let picture = Picture::at_home(shape.imprint);
            (picture.named(shape.name.as_str()), shape.sensor)
        }
        Content::Imprint(imprint) => {
            let paper = Sensor::default();
            let sensor = Sensor::of_size(imprint.size().union(paper.size()));
            (Picture::at_home(imprint), sensor)
        }
    };
    let sensor = given.sensor(sensor)?;
    let picture = given.picture(picture, &sensor)?;
    Ok((Source::Picture(picture), sensor))
}
