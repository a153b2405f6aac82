//! `taxel model separate`: how the error of a set depends on the size of its shapes and on the threshold of the
//! sensor.
//!
//! For each threshold, sizes are tried from the smallest on. Each is a training of its own, so the work grows with
//! the product of their numbers. With `--want ERROR`, the first size that reaches the error is then refined: sizes
//! between it and the last one that does not are tried. Sizes at which no sensor holds the shapes are left out, and
//! standard error names them. Errors are reported before the first training where possible: a set that fits at no
//! size, a file that exists.

use std::ffi::{OsStr, OsString};

use taxel_core::pose::{Axis, DecimalRange};
use taxel_core::progress::Progress;
use taxel_core::quote::shortened_message;
use taxel_core::recognition::{CellPositions, GridSteps, Model, Separation, TrainingError};
use taxel_core::sensor::Sensor;
use taxel_files::formats::file::has_ending;
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{ModelChoice, check_writable};

use crate::cli::arguments::flags::EvaluationForm;
use crate::cli::arguments::model::SeparateArguments;
use crate::cli::commands::export::{put, written};
use crate::cli::commands::model;
use crate::cli::error::CliError;
use crate::cli::input::shapes::{self, Shelf};
use crate::cli::output::charset::{Charset, note};
use crate::cli::output::progress::ProgressDisplay;
use crate::cli::output::separation::{self, SeparationCurve, csv, drawing};
use crate::cli::signals::{self, Signals};

const REFINED: u64 = 9;

pub(crate) fn separate(
    asked: &SeparateArguments,
    shelf: &Shelf,
    charset: Charset,
) -> Result<String, CliError> {
    let (separation, usual) = set(asked, shelf, charset)?;
    let thresholds: Vec<f64> = match &asked.thresholds {
        Some(range) => range.values().collect(),
        None => vec![usual],
    };
    let sizes = fitting(asked, &separation, &thresholds)?;
    let signals = Signals::catch()?;
    if let Some(path) = &asked.export {
        check_writable(path, asked.existing)?;
    }
    // An answer without all its sizes says so, even with --quiet.
    if let Some(text) = left_out(asked, &sizes) {
        note(&text, charset);
    }
    let more = asked.wanted.map_or(0, |_| REFINED);
    let points = (sizes.len() as u64 + more) * thresholds.len() as u64;
    let display = ProgressDisplay::new(separation.touches() * points, asked.quiet, charset);
    let memory = MemoryGuard::new(None, "take fewer shapes, smaller sizes or coarser steps");
    let pool = signals::pool(asked.jobs)?;
    let curves = memory.limit(&signals.progress(&display), |progress| {
        pool.install(|| curves(asked, &separation, (&sizes, &thresholds), progress))
    });
    drop(display);
    let curves = curves
        .map_err(CliError::Memory)?
        .map_err(|error| signals.training_failure(error))?;
    if let Some(path) = &asked.export {
        let content = if has_ending(path, "svg") {
            drawing(asked.axis, &curves, asked.wanted).svg()
        } else {
            csv(asked.axis, &curves)
        };
        put(path, content.as_bytes(), asked.existing)?;
        if !asked.quiet {
            note(&written(path), charset);
        }
    }
    if let (EvaluationForm::Csv, Some(wanted)) = (asked.form, asked.wanted) {
        // The table has no place for the result of --want. It is an answer, not a note, so --quiet does not suppress
        // it.
        let found = separation::all_found(asked.axis, &asked.sizes, &curves, wanted);
        for line in found.lines() {
            note(line, charset);
        }
    }
    Ok(match asked.form {
        EvaluationForm::Json => separation::json_text(asked.axis, &curves, asked.wanted),
        EvaluationForm::Csv => csv(asked.axis, &curves),
        EvaluationForm::Text => {
            separation::text(asked.axis, &asked.sizes, &curves, asked.wanted, charset)
        }
    })
}

fn curves(
    asked: &SeparateArguments,
    separation: &Separation,
    (sizes, thresholds): (&[f64], &[f64]),
    progress: &dyn Progress,
) -> Result<Vec<SeparationCurve>, TrainingError> {
    let mut curves = Vec::with_capacity(thresholds.len());
    for &threshold in thresholds {
        let points = sizes.iter();
        let points = points.map(|&size| separation.at(asked.axis, size, threshold, progress));
        let points = points.collect::<Result<Vec<_>, _>>()?;
        let smallest = match asked.wanted {
            Some(error) => separation.smallest(asked.axis, &points, error, progress)?,
            None => None,
        };
        curves.push(SeparationCurve {
            threshold,
            points,
            smallest,
        });
    }
    Ok(curves)
}

fn fitting(
    asked: &SeparateArguments,
    separation: &Separation,
    thresholds: &[f64],
) -> Result<Vec<f64>, CliError> {
    let mut fitting = Vec::new();
    let mut too_large = None;
    for size in asked.axis.smallest_first(&asked.sizes) {
        let fits = thresholds.iter().try_for_each(|&threshold| {
            let training = separation.training(asked.axis.scale(size), threshold);
            let name = asked.axis.name();
            training.map(drop).map_err(|error| CliError::Separation {
                place: format!("{name} {size}, threshold {threshold}"),
                error,
            })
        });
        match fits {
            Ok(()) => fitting.push(size),
            // A pitch of 0 makes every shape too large, but it is not a valid pitch.
            Err(CliError::Separation {
                place,
                error: error @ TrainingError::Large,
            }) if size > 0.0 => {
                too_large.get_or_insert(CliError::Separation { place, error });
            }
            Err(error) => return Err(error),
        }
    }
    match too_large {
        Some(error) if fitting.is_empty() => Err(error),
        _ => Ok(fitting),
    }
}

/// Returns a note about the sizes that are left out because they do not fit; None if all fit.
fn left_out(asked: &SeparateArguments, fitting: &[f64]) -> Option<String> {
    let all = asked.axis.smallest_first(&asked.sizes);
    let left_out: Vec<f64> = (all.into_iter())
        .filter(|size| !fitting.contains(size))
        .collect();
    let sizes = match left_out[..] {
        [] => return None,
        [only] => only.to_string(),
        [first, .., last] => format!("{first} to {last}"),
    };
    let (name, reason) = (asked.axis.name(), TrainingError::Large);
    Some(format!("left out: {name} {sizes}: {reason}"))
}

fn set(
    asked: &SeparateArguments,
    shelf: &Shelf,
    charset: Charset,
) -> Result<(Separation, f64), CliError> {
    if let ([what], false) = (&asked.set.what[..], asked.set.library_all)
        && is_model(what, shelf)
    {
        let model = model::find(what, shelf)?;
        let model = model::ready(model, &|poses| {
            ProgressDisplay::new(poses, asked.quiet, charset)
        })?;
        let positions = asked.positions.or_else(|| positions_of(&model));
        let positions = positions.unwrap_or(CellPositions::FINE);
        for text in departures(&model, asked) {
            note(&text, charset);
        }
        let mut separation = Separation::new(model.shapes().to_vec())?;
        let angles = asked.angles.unwrap_or(model.ranges()[Axis::Angle]);
        separation.steps = GridSteps { positions, angles };
        return Ok((separation, model.sensor().threshold()));
    }
    let no_shape = |name: &str| shelf.imprint(name).is_err();
    let is_only_model =
        |what: &&OsString| is_model(what, shelf) && what.to_str().is_none_or(no_shape);
    if let Some(model) = asked.set.what.iter().find(is_only_model) {
        return Err(CliError::Set {
            place: shortened_message(&model.to_string_lossy()),
            error: "a model; give one model or several shapes, not both".to_owned(),
        });
    }
    let mut separation = Separation::new(shapes::read_set(&asked.set, shelf)?)?;
    let steps = &mut separation.steps;
    steps.angles = asked.angles.unwrap_or(steps.angles);
    steps.positions = asked.positions.unwrap_or(steps.positions);
    Ok((separation, Sensor::default().threshold()))
}

/// Returns true if an argument is a model, rather than a shape or a file of shapes. A kept model takes precedence
/// over a shape of the library of the same name, and the shape over a built-in set; a file is a model if it ends in
/// `.npz`.
fn is_model(what: &OsStr, shelf: &Shelf) -> bool {
    match model::models(shelf).locate(ModelChoice::from_text(what)) {
        Ok(ModelChoice::Stored(_)) => true,
        Ok(ModelChoice::File(_)) | Err(_) => has_ending(what, "npz"),
        Ok(built_in) => shelf.imprint(built_in.name()).is_err(),
    }
}

fn departures(model: &Model, asked: &SeparateArguments) -> Vec<String> {
    let mut notes = Vec::new();
    if asked.quiet {
        return notes;
    }
    let unzoomed = DecimalRange::whole(1);
    let zooms = [Axis::ZoomX, Axis::ZoomY].map(|axis| model.ranges()[axis]);
    if zooms != [unzoomed; 2] {
        notes.push("the zooms of the model are left out".to_owned());
    }
    if model.cut().iter().any(|&cut| cut > 0) {
        notes.push(
            "the model's sensor cuts poses off; each size here has a sensor that does not"
                .to_owned(),
        );
    }
    if asked.positions.is_none() && positions_of(model).is_none() {
        notes.push(
            "the positions of the model are not one cell; here they are 100 × 100 in a cell"
                .to_owned(),
        );
    }
    notes
}

fn positions_of(model: &Model) -> Option<CellPositions> {
    let of = |range: &DecimalRange| {
        let count = u8::try_from(range.count()).ok()?;
        let whole = (range.step() * f64::from(count) - 1.0).abs() < 1e-9;
        let positions = CellPositions::new(count);
        positions.filter(|_| whole)
    };
    let ranges = model.ranges();
    let (x, y) = (of(&ranges[Axis::X0])?, of(&ranges[Axis::Y0])?);
    (x == y).then_some(x)
}
