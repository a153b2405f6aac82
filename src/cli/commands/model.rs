//! `taxel model`: trains, shows, lists and deletes models of shapes.
//!
//! A model is the file of a training: every imprint that some shapes leave on a grid of poses, and how often each shape
//! leaves it. Its hash is that of the content: two trainings of one set on one grid have the same hash on any machine.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use serde_json::json;
use taxel_core::pose::{
    Anchor, Axis, DecimalRange, GivenRanges, Ranges, Reach, SensorSides, check_given,
};
use taxel_core::quote::did_you_mean;
use taxel_core::recognition::{
    CellPositions, Evaluation, LEAST_SIDE, Model, NamedShape, Training, TrainingError,
};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::sweep::Shard;
use taxel_files::formats::value::{counted, grouped, percent};
use taxel_files::formats::{Name, json};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{
    FoundModel, ModelCache, ModelChoice, ModelFolder, Models, check_writable, load_model,
    model_hash, save_model,
};

use crate::cli::arguments::flags::TOO_LITTLE_MEMORY;
use crate::cli::arguments::model::{ModelTarget, TrainArguments};
use crate::cli::commands::Summary;
use crate::cli::error::CliError;
use crate::cli::input::shapes::{self, Shelf};
use crate::cli::output::charset::{Charset, note};
use crate::cli::output::evaluation::{self, NamedBy};
use crate::cli::output::progress::ProgressDisplay;
use crate::cli::output::sweep_summary::ranges_in_words;
use crate::cli::signals::{self, Signals};

/// Trains a model and writes it. Returns the text to print, with the error if there is no file. The path is tried
/// before the work begins. A signal stops the training and leaves no file.
pub(crate) fn train(
    asked: &TrainArguments,
    shelf: &Shelf,
    charset: Charset,
) -> Result<Summary, CliError> {
    if let ModelTarget::Named(name) = &asked.to
        && !ModelChoice::from_name(name.clone()).is_read()
    {
        return Err(CliError::BuiltInSet { name: name.clone() });
    }
    let shapes = shapes::read_set(&asked.set, shelf)?;
    let grid = TrainingGrid::of(asked, &shapes)?;
    let (sensor, anchor, ranges) = (grid.sensor, grid.anchor, grid.ranges);
    let signals = Signals::catch()?;
    let training = Training::new(shapes, sensor, anchor, ranges)?
        .with_shard(asked.shard)
        .allow_cut(asked.allow_cut);
    match &asked.to {
        ModelTarget::File(path) => check_writable(path, asked.existing)?,
        ModelTarget::Named(name) => folder(shelf)?.check(name, asked.existing)?,
    }
    if !asked.quiet {
        note(&grid_text(&sensor, anchor, &ranges), charset);
    }
    let model = run(training, asked, grid.remedy, &signals, charset)?;
    let saved = match &asked.to {
        ModelTarget::File(path) => save_model(&model, path, asked.existing).map(|()| path.clone()),
        ModelTarget::Named(name) => folder(shelf)?.save(&model, name, asked.existing),
    };
    let written = saved.map_err(CliError::from);
    let text = trained(&model, written.as_deref().ok(), asked, charset);
    let written = written.map(drop);
    Ok(Summary { text, written })
}

fn run(
    training: Training<'_>,
    asked: &TrainArguments,
    remedy: &'static str,
    signals: &Signals,
    charset: Charset,
) -> Result<Model, CliError> {
    let memory = MemoryGuard::new(asked.memory, TOO_LITTLE_MEMORY);
    let pool = signals::pool(asked.jobs)?;
    let display = ProgressDisplay::new(training.poses(), asked.quiet, charset);
    let model = memory.limit(&signals.progress(&display), |progress| {
        pool.install(|| training.with_progress(progress).run())
    });
    drop(display);
    model
        .map_err(CliError::Memory)?
        .map_err(|error| match error {
            error @ TrainingError::Cut { .. } => CliError::Cut { error, remedy },
            error => signals.training_failure(error),
        })
}

fn trained(
    model: &Model,
    written: Option<&Path>,
    asked: &TrainArguments,
    charset: Charset,
) -> String {
    let limit = Evaluation::of(model);
    let name = written.map(Path::to_string_lossy);
    if asked.json {
        let mut text = card_json(model, &limit);
        if let Some(name) = name {
            text.insert("file".to_owned(), json!(name));
        }
        json::ascii(&text) + "\n"
    } else {
        let mut text = evaluation::summary(&limit, NamedBy::Imprint);
        if let Some(name) = name.filter(|_| !asked.quiet) {
            let said = charset.line(&format!("written: {name}")).into_owned();
            text.insert_str(0, &(said + "\n"));
        }
        text
    }
}

/// Describes the grid of a training in a line, such as `16 × 16 sensor, threshold 0.5, centre at x0 7:7.8:0.2 cells,
/// y0 7:7.8:0.2 cells, angle 0:355:5°`. A zoom of 1 is left out.
fn grid_text(sensor: &Sensor, anchor: Anchor, ranges: &Ranges) -> String {
    let is_unzoomed = |axis: Axis| axis.is_zoom() && ranges[axis] == DecimalRange::whole(1);
    let axes = Axis::ALL.into_iter().filter(|&axis| !is_unzoomed(axis));
    format!(
        "{} × {} sensor, threshold {}, {} at {}",
        sensor.columns(),
        sensor.rows(),
        sensor.threshold(),
        anchor.name(),
        ranges_in_words(axes, ranges)
    )
}

fn folder(shelf: &Shelf) -> Result<ModelFolder, CliError> {
    Ok(ModelFolder::of(shelf.library()?.folder()))
}

fn stored(shelf: &Shelf) -> Result<Vec<(Name, PathBuf)>, CliError> {
    let Ok(models) = folder(shelf) else {
        return Ok(Vec::new());
    };
    Ok(models.list()?)
}

/// The models that a command may name.
pub(crate) fn models(shelf: &Shelf) -> Models {
    Models {
        folder: folder(shelf).ok(),
        cache: ModelCache::of_user(),
    }
}

pub(crate) fn find(which: &OsStr, shelf: &Shelf) -> Result<FoundModel, CliError> {
    let found = models(shelf).find(ModelChoice::from_text(which));
    found.map_err(CliError::Archive)
}

/// Returns a model that was found. A built-in set that is not in the cache is trained, which takes some seconds;
/// `display` makes the display of its progress. Signals are not caught meanwhile: nothing would have to be removed.
pub(crate) fn ready(
    found: FoundModel,
    display: &dyn Fn(u64) -> ProgressDisplay,
) -> Result<Model, CliError> {
    found.ready(|training| {
        let memory = MemoryGuard::new(
            None,
            "train a model of fewer shapes or coarser steps (taxel model train)",
        );
        let display = display(training.poses());
        let model = memory.limit(&display, |progress| training.with_progress(progress).run());
        Ok(model.map_err(CliError::Memory)??)
    })
}

/// Shows the card of a model, in words or as a JSON object. Both include the evaluation of one touch
/// ([`evaluation::summary`]).
pub(crate) fn show(
    which: &OsStr,
    json: bool,
    shelf: &Shelf,
    charset: Charset,
) -> Result<String, CliError> {
    let models = models(shelf);
    let choice = models.locate(ModelChoice::from_text(which));
    let choice = choice.map_err(CliError::Archive)?;
    let model = match models.file(&choice) {
        Some(path) => load_model(&path).map_err(CliError::Archive)?,
        None => ready(find(which, shelf)?, &|poses| {
            ProgressDisplay::new(poses, false, charset)
        })?,
    };
    let limit = Evaluation::of(&model);
    if json {
        return Ok(json::ascii(&card_json(&model, &limit)) + "\n");
    }
    let mut text = format!(
        "{}\n",
        grid_text(model.sensor(), model.anchor(), model.ranges())
    );
    for (index, shape) in model.shapes().iter().enumerate() {
        let weight = match shape.weight {
            1 => String::new(),
            weight => format!(", weight {weight}"),
        };
        text += &format!("  {}: {}{weight}", shape.name, described(shape));
        if let Some(recall) = limit.recall(index) {
            text += &format!(", named right in {} of its touches", percent(recall));
        }
        text.push('\n');
    }
    let first = model.shapes().first().map(|shape| shape.weight);
    let is_even = |shape: &NamedShape| Some(shape.weight) == first;
    text += if model.shapes().iter().all(is_even) {
        "prior: all shapes are equally likely\n"
    } else {
        "prior: shapes are as likely as their weights say\n"
    };
    text += &format!("{} each", counted(model.poses(), "pose"));
    if model.shard() != Shard::WHOLE {
        text += &format!(", shard {}", model.shard());
    }
    let cut: u64 = model.cut().iter().sum();
    if cut > 0 {
        text += &format!(", {} of all cut off by the sensor", grouped(cut));
    }
    text.push('\n');
    // In an empty shard there is nothing to say about touches.
    if model.poses() > 0 {
        text += &evaluation::summary(&limit, NamedBy::Imprint);
        text += &never_certain(&model);
    }
    text += &format!("hash {}\n", model_hash(&model));
    Ok(charset.lines(&text))
}

fn never_certain(model: &Model) -> String {
    let never = model.never_certain();
    let names = never.iter().map(|&shape| &*model.shapes()[shape].name);
    match names.collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => "every shape leaves imprints that no other leaves\n".to_owned(),
        names => {
            let whose = if never.len() == 1 { "its" } else { "their" };
            format!("never certain: {names}; other shapes leave all {whose} imprints, too\n")
        }
    }
}

/// Describes a shape in a few words: `rectangle length 4.50, width 4.30` for a figure, without its pose, which the
/// grid sets; `picture of 36 taxels`.
fn described(shape: &NamedShape) -> String {
    match (&shape.source.kind(), &shape.source) {
        (Some(kind), source) => {
            let sizes = kind
                .parameters()
                .iter()
                .filter(|parameter| Axis::ALL.iter().all(|axis| axis.parameter() != **parameter));
            let sizes = sizes.filter_map(|&parameter| {
                let value = source.get(parameter)?;
                Some(format!(
                    "{} {}",
                    parameter.row().key,
                    parameter.format(value)
                ))
            });
            format!("{} {}", kind.name(), sizes.collect::<Vec<_>>().join(", "))
        }
        (None, Source::Picture(picture)) => {
            let taxels = counted(picture.imprint().count(), "taxel");
            format!("picture of {taxels}")
        }
        (None, _) => shape.source.noun().to_owned(),
    }
}

/// Returns the card of a model as JSON: what was trained, and its evaluation. Keys are sorted by name. Ranges are
/// `START:END:STEP` texts, as in flags; counts beyond 64 bits are texts.
fn card_json(model: &Model, limit: &Evaluation) -> serde_json::Map<String, serde_json::Value> {
    let mut card = serde_json::Map::new();
    let shapes = model.shapes().iter().enumerate().map(|(index, shape)| {
        json!({
            "name": shape.name,
            "source": shape.source,
            "weight": shape.weight,
            "cut": model.cut()[index],
            "recall": limit.recall(index),
            "precision": limit.precision(index),
        })
    });
    let ranges: serde_json::Map<_, _> = Axis::ALL
        .into_iter()
        .map(|axis| {
            (
                axis.name().to_owned(),
                json!(model.ranges()[axis].to_string()),
            )
        })
        .collect();
    let never = model.never_certain();
    let never = never
        .iter()
        .map(|&shape| model.shapes()[shape].name.as_str());
    card.insert("shapes".into(), shapes.collect());
    card.insert("sensor".into(), json!(model.sensor()));
    card.insert("anchor".into(), json!(model.anchor().name()));
    card.insert("ranges".into(), ranges.into());
    card.insert("shard".into(), json!(model.shard().to_string()));
    card.insert("poses".into(), json!(model.poses()));
    card.insert("keys".into(), json!(limit.keys));
    card.insert("touches".into(), evaluation::number(limit.touches));
    card.insert("right".into(), evaluation::number(limit.right));
    card.insert("error".into(), json!(limit.error()));
    let certain = limit.certainty.map(|own| evaluation::number(own.touches));
    card.insert("certain".into(), json!(certain));
    card.insert("information_bits".into(), json!(limit.information_bits));
    card.insert("never_certain".into(), never.collect());
    card.insert("hash".into(), json!(model_hash(model)));
    card
}

/// Lists the built-in models, which are trained when they are first used, and those of the library, sorted by name.
/// If a model cannot be read, the reason takes the place of the numbers. The JSON lists only models in files.
/// ```text
/// figures: built in
/// parts: 3 shapes, 845 keys, error 1.6 %
/// ```
pub(crate) fn list(json: bool, shelf: &Shelf, charset: Charset) -> Result<String, CliError> {
    let mut text = String::new();
    if !json {
        for set in ModelChoice::BUILT_IN {
            text += &format!("{}: built in\n", set.name());
        }
    }
    for (name, path) in stored(shelf)? {
        let model = load_model(&path);
        if json {
            let line = match &model {
                Ok(model) => json!({
                    "name": name.as_str(),
                    "file": path.to_string_lossy(),
                    "shapes": model.shapes().iter().map(|shape| &shape.name).collect::<Vec<_>>(),
                    "keys": model.keys().len(),
                    "shard": model.shard().to_string(),
                }),
                Err(error) => json!({"name": name.as_str(), "error": error.to_string()}),
            };
            text += &json::ascii(&line);
            text.push('\n');
            continue;
        }
        let said = match &model {
            Ok(model) => {
                let shapes = counted(model.shapes().len() as u64, "shape");
                let keys = counted(model.keys().len() as u64, "distinct imprint");
                match model.shard() {
                    Shard::WHOLE => {
                        let error = percent(Evaluation::of(model).error());
                        format!("{shapes}, {keys}, error {error}")
                    }
                    // Its error would be that of a part of the touches.
                    shard => format!("{shapes}, {keys}, shard {shard} of a model"),
                }
            }
            Err(error) => error.to_string(),
        };
        text += &charset.lines(&format!("{name}: {said}\n"));
    }
    Ok(text)
}

/// Deletes a model. Unlike a shape of the library, it does not go to the trash: it can be trained again.
pub(crate) fn delete(name: &Name, shelf: &Shelf) -> Result<String, CliError> {
    let models = folder(shelf)?;
    if let Some(deleted) = models.delete(name)? {
        return Ok(format!("deleted {deleted}\n"));
    }
    let name = name.clone();
    if !ModelChoice::from_name(name.clone()).is_read() {
        return Err(CliError::BuiltInModel { name });
    }
    let near = did_you_mean(name.as_str(), models.names().iter().map(Name::as_str));
    let name = name.to_string();
    Err(CliError::NoModel { name, near })
}

pub(super) struct TrainingGrid {
    pub(super) sensor: Sensor,
    pub(super) anchor: Anchor,
    pub(super) ranges: Ranges,
    pub(super) remedy: &'static str,
}

impl TrainingGrid {
    /// Returns the grid for some shapes. If neither x0 nor y0 is given, the anchor is the centre, since a shape's
    /// centre stays in place when it turns: one cell is then enough for all positions.
    pub(super) fn of(asked: &TrainArguments, shapes: &[NamedShape]) -> Result<Self, CliError> {
        let given = &asked.ranges;
        let placed = given[Axis::X0].is_some() || given[Axis::Y0].is_some();
        let usual = if placed {
            Anchor::Corner
        } else {
            Anchor::Centre
        };
        let anchor = asked.anchor.unwrap_or(usual);
        check_given(given, &asked.sides.largest())?;
        let sources: Vec<&Source> = shapes.iter().map(|shape| &shape.source).collect();
        let reach = Reach::of_all(sources.iter().copied(), anchor, given)?;
        let step = asked.positions.unwrap_or(CellPositions::FINE).step();
        let (sensor, ranges) = reach.best_sensor(&sources, given, asked.sides, step);
        let holds = |sides: SensorSides, given: &GivenRanges| {
            let sensor = reach.smallest_sensor(&sources, given, sides, step);
            sensor.is_some()
        };
        Ok(Self {
            sensor: asked.given.sensor(sensor)?,
            anchor,
            ranges,
            remedy: remedy(asked, holds),
        })
    }
}

/// Returns advice in case the sensor cuts off poses. `holds` tells whether some sensor with these sides holds the
/// shapes at these positions.
fn remedy(
    asked: &TrainArguments,
    holds: impl Fn(SensorSides, &GivenRanges) -> bool,
) -> &'static str {
    let any = SensorSides::at_least(LEAST_SIDE);
    let elsewhere = asked.ranges.with(Axis::X0, None).with(Axis::Y0, None);
    match (holds(any, &asked.ranges), holds(asked.sides, &elsewhere)) {
        (true, true) => "use a larger sensor or other positions",
        (true, false) => "use a larger sensor",
        (false, true) => "use other positions",
        (false, false) if holds(any, &elsewhere) => "use a larger sensor and other positions",
        (false, false) => "use smaller shapes",
    }
}
