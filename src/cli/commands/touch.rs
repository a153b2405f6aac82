//! `taxel figure` and `taxel picture`: touches a shape once and prints the imprint and its descriptors. `--save`
//! stores the shape too, and `--export` writes it to a file.

use std::ffi::OsStr;
use std::io::Write;

use taxel_core::imprint::Imprint;
use taxel_core::picture::Picture;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::touch::Plane;
use taxel_files::formats::{Content, DescribedImprint, Job, StoredShape};

use crate::cli::arguments::flags::{Form, Given};
use crate::cli::arguments::touch::{Export, Kept};
use crate::cli::error::CliError;
use crate::cli::input::lines::{self, LineInput};
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::Charset;
use crate::cli::output::report;

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

/// Returns the answer: one line of JSON, or the matrix and a table of its regions. For a stored shape, its name,
/// source and sensor come before the table.
pub(crate) fn content(content: &Content, form: Form, charset: Charset) -> String {
    let imprint = content.imprint();
    let Form::Table(pitch) = form else {
        return report::json(imprint);
    };
    let sensor = match content {
        Content::Imprint(_) => None,
        Content::Shape(shape) => Some(&shape.sensor),
    };
    let pitch = pitch.of(sensor);
    let mut made = Vec::new();
    match content {
        Content::Imprint(_) => made.push(report::size(imprint, None, pitch)),
        Content::Shape(shape) => {
            made.push(shape.name.to_string());
            if let Some(source) = &shape.source {
                made.push(source.to_string());
                made.extend(report::beyond(source, &shape.sensor));
            }
            made.push(report::size(imprint, sensor, pitch));
        }
    }
    report::table(imprint, &made, pitch, charset)
}

pub(crate) fn answer_lines(
    sensor: Sensor,
    jobs: usize,
    lookup: &(dyn Fn(&str) -> Result<Imprint, String> + Sync),
    input: LineInput,
    output: impl Write,
) -> Result<(), CliError> {
    lines::answer_all(jobs, input, output, "pose", || {
        let (mut plane, mut other) = (Plane::new(sensor), Plane::new(sensor));
        move |line: &[u8], answer: &mut Vec<u8>| {
            let job = Job::read(line, sensor, lookup).map_err(|error| error.to_string())?;
            let plane = match &job {
                // A line with a sensor of its own does not replace the plane of the others.
                Job::Touch(own, _) if *own != sensor => &mut other,
                _ => &mut plane,
            };
            let imprint = job.imprint(plane);
            serde_json::to_writer(answer, &DescribedImprint(&imprint))
                .map_err(|error| error.to_string())
        }
    })
}
