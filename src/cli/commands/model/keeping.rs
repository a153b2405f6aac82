//! `taxel model show`, `list` and `delete`: the models that are kept.

use std::collections::BTreeMap;
use std::ffi::OsStr;

use serde_json::{Value, json};
use taxel_core::parameter::Parameter;
use taxel_core::parameter::number::short;
use taxel_core::pose::Axis;
use taxel_core::quote::did_you_mean;
use taxel_core::recognition::{Evaluation, Model, NamedShape};
use taxel_core::source::Source;
use taxel_core::sweep::Shard;
use taxel_files::formats::value::{counted, decimal, grouped, percent};
use taxel_files::formats::{Name, json};
use taxel_files::storage::{ModelChoice, load_model, model_hash};

use crate::cli::Context;
use crate::cli::commands::model::train::grid_text;
use crate::cli::commands::model::{find, folder, models, ready};
use crate::cli::failure::Failure;
use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::{self, NamedBy, count};

pub(super) const SHOW_EXAMPLES: &str = "\
Examples:
  taxel model show parts
  taxel model show ./parts.npz --json";

pub(super) fn show(model: &OsStr, json: bool, cx: &Context) -> Result<(), Failure> {
    let models = models(&cx.shelf);
    let choice = models.locate(ModelChoice::from_text(model))?;
    let model = match models.file(&choice) {
        // A shard, too, which answers no touches.
        Some(path) => load_model(&path)?,
        None => ready(find(model, &cx.shelf)?, false)?,
    };
    let limit = Evaluation::of(&model);
    cx.print(&if json {
        json::ascii(&card(&model, &limit)) + "\n"
    } else {
        text(&model, &limit)
    })
}

fn text(model: &Model, limit: &Evaluation) -> String {
    let grid = grid_text(model.sensor(), model.anchor(), model.ranges());
    let mut text = grid + "\n";
    for (index, shape) in model.shapes().iter().enumerate() {
        text += &format!("  {}: {}", shape.name, described(shape));
        if shape.weight > 1 {
            text += &format!(", weight {}", shape.weight);
        }
        if let Some(recall) = limit.recall(index) {
            text += &format!(", named right in {} of its touches", percent(recall));
        }
        text.push('\n');
    }
    let cut: u64 = model.cut().iter().sum();
    text += &format!("{} each", counted(model.poses(), "pose"));
    if model.shard() != Shard::WHOLE {
        text += &format!(", shard {}", model.shard());
    }
    if cut > 0 {
        text += &format!(", {} of all cut off by the sensor", grouped(cut));
    }
    text.push('\n');
    // In an empty shard there is nothing to say about touches.
    if model.poses() > 0 {
        text += &evaluation::summary(limit, NamedBy::Imprint);
        text += &match never_certain(model).join(", ") {
            none if none.is_empty() => "every shape leaves imprints that no other leaves\n".into(),
            names => format!("never certain, since other shapes leave the same: {names}\n"),
        };
    }
    text + &format!("hash {}\n", model_hash(model))
}

/// Describes a shape in a few words, without its pose, which the grid sets: `rectangle l 4.50 w 4.30`.
fn described(shape: &NamedShape) -> String {
    match &shape.source {
        Source::Figure(figure) => {
            let thickness = figure.get(Parameter::Thickness);
            let thickness = thickness.map(|own| format!(" thickness {}", short(own)));
            figure.kind_and_sizes() + &thickness.unwrap_or_default()
        }
        Source::Picture(picture) => {
            format!("picture of {}", counted(picture.imprint().count(), "taxel"))
        }
        Source::Outline(outline) => {
            let [width, height] = outline.size().map(|side| decimal(side, 2));
            format!("outline of {width} × {height} cells")
        }
    }
}

fn never_certain(model: &Model) -> Vec<&str> {
    let never = model.never_certain().into_iter();
    never.map(|shape| &*model.shapes()[shape].name).collect()
}

/// What was trained, and its evaluation, as a JSON object. Ranges are `START:END:STEP` texts, as in flags.
pub(super) fn card(model: &Model, limit: &Evaluation) -> Value {
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
    let ranges = Axis::ALL.map(|axis| (axis.name(), model.ranges()[axis].to_string()));
    json!({
        "shapes": shapes.collect::<Vec<_>>(),
        "sensor": model.sensor(),
        "anchor": model.anchor().name(),
        "ranges": BTreeMap::from(ranges),
        "shard": model.shard().to_string(),
        "poses": model.poses(),
        "keys": limit.keys,
        "touches": count(limit.touches),
        "right": count(limit.right),
        "error": limit.error(),
        "certain": limit.certainty.map(|own| count(own.touches)),
        "information_bits": limit.information_bits,
        "never_certain": never_certain(model),
        "hash": model_hash(model),
    })
}

pub(super) const LIST_EXAMPLES: &str = "\
Your models are files in the folder 'models' of the library. The built-in ones
are trained when first used.

Examples:
  taxel model list";

/// If a model cannot be read, the reason takes the place of the numbers.
pub(super) fn list(cx: &Context) -> Result<(), Failure> {
    for own in ModelChoice::BUILT_IN {
        cx.print(&format!("{}: built in\n", own.name()))?;
    }
    let models = folder(&cx.shelf).map_or(Ok(Vec::new()), |folder| folder.list())?;
    for (name, path) in models {
        let model = load_model(&path);
        let said = model.map_or_else(|error| error.to_string(), |model| in_short(&model));
        let line = format!("{name}: {said}");
        cx.print(&format!("{}\n", Charset::current().line(&line)))?;
    }
    Ok(())
}

fn in_short(model: &Model) -> String {
    let shapes = counted(model.shapes().len() as u64, "shape");
    let keys = counted(model.keys().len() as u64, "distinct imprint");
    // The error of a shard would be that of a part of the touches.
    let rest = match model.shard() {
        Shard::WHOLE => format!("error {}", percent(Evaluation::of(model).error())),
        shard => format!("shard {shard} of a model"),
    };
    format!("{shapes}, {keys}, {rest}")
}

pub(super) const DELETE_EXAMPLES: &str = "\
The file is removed for good, but the model can be trained again.

Examples:
  taxel model delete parts";

/// Unlike a shape of the library, a model does not go to the trash: it can be trained again.
pub(super) fn delete(name: &Name, cx: &Context) -> Result<(), Failure> {
    let models = folder(&cx.shelf)?;
    if let Some(deleted) = models.delete(name)? {
        return cx.print(&format!("deleted {deleted}\n"));
    }
    let near = did_you_mean(name.as_str(), models.names().iter().map(Name::as_str));
    Err(Failure::new(match ModelChoice::from_name(name.clone()) {
        ModelChoice::Stored(_) => {
            let name = name.as_str();
            format!("no model named {name:?}; 'taxel model list' shows all{near}")
        }
        _ => format!("{name} is built in and cannot be deleted"),
    }))
}
