//! `taxel model confusion`: how well one touch tells the shapes of a model apart.
//!
//! The best classifier is counted from all touches of the model, so its error is the limit of every method that sees
//! one touch. Each question of `Evaluated` has a function here; `output/evaluation` makes the output.

use std::iter;
use std::path::Path;

use serde_json::json;
use taxel_core::parameter::number::share;
use taxel_core::recognition::{Classifier, ClassifierEvaluation, Evaluation, Model};
use taxel_files::formats::file::has_ending;
use taxel_files::formats::value::percent;
use taxel_files::formats::{ConfusionMap, json};
use taxel_files::storage::{FoundModel, check_writable};

use crate::cli::arguments::flags::EvaluationForm;
use crate::cli::arguments::model::{ConfusionArguments, Evaluated};
use crate::cli::commands::export::{put, written};
use crate::cli::commands::model;
use crate::cli::commands::noise;
use crate::cli::error::{CliError, MOST_PAIRED};
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::{Charset, note};
use crate::cli::output::evaluation::{self, EvaluationJson, NamedBy};
use crate::cli::output::progress::ProgressDisplay;
use crate::cli::signals::Signals;

pub(crate) fn confusion(
    asked: &ConfusionArguments,
    shelf: &Shelf,
    charset: Charset,
) -> Result<String, CliError> {
    let model = model::find(&asked.model, shelf)?;
    check(asked, &model)?;
    let model = model::ready(model, &|poses| {
        ProgressDisplay::new(poses, asked.quiet, charset)
    })?;
    let as_json = asked.form == EvaluationForm::Json;
    let text = match &asked.of {
        Evaluated::Imprints => shown(asked, &Evaluation::of(&model), None, charset),
        Evaluated::Given(given) => {
            let mut given = given.clone();
            given.roundings.clone_from(&asked.roundings);
            shown(asked, &given.evaluate(&model), None, charset)
        }
        Evaluated::Classifier(classifier) => {
            let signals = Signals::catch()?;
            let reached = reached(*classifier, &model, asked, charset, &signals)?;
            shown(asked, &reached.evaluation, Some(&reached), charset)
        }
        Evaluated::Greedy => Ok(chosen(&model, asked, charset)),
        Evaluated::Pairs => Ok(pairs(&model, as_json, charset)),
        Evaluated::AllClassifiers => all_classifiers(&model, asked, charset),
        Evaluated::Noise(noise) => noise::degradation(&model, noise, asked, charset),
    }?;
    if let Some(path) = asked.export.as_ref().filter(|_| !asked.quiet) {
        note(&written(path), charset);
    }
    Ok(text)
}

/// Refuses what the shapes and the sensor of a model do not allow, and a file that cannot be written: before the work,
/// not after it.
fn check(asked: &ConfusionArguments, model: &FoundModel) -> Result<(), CliError> {
    let table = table_of_pairs(&asked.of);
    if let Some(table) = table {
        fits_in_table(table, model.shapes().len())?;
    }
    if let Evaluated::Noise(noise) = &asked.of {
        noise::check_dead(&noise.dead, &noise::sensor(noise, &model.sensor()))?;
    }
    let Some(path) = &asked.export else {
        return Ok(());
    };
    if table.is_some() && has_ending(path, "svg") {
        let names = model.shapes().iter().map(|shape| shape.name.clone());
        drawing(path, &names.collect::<Vec<_>>(), iter::empty())?;
    }
    Ok(check_writable(path, asked.existing)?)
}

/// Returns the table of all pairs of shapes that a question is answered with, as messages call it; None if there is
/// no such table in the answer.
fn table_of_pairs(of: &Evaluated) -> Option<&'static str> {
    match of {
        Evaluated::Imprints | Evaluated::Given(_) | Evaluated::Classifier(_) => {
            Some("confusion matrix")
        }
        Evaluated::Pairs => Some("--pairs"),
        Evaluated::Greedy | Evaluated::AllClassifiers | Evaluated::Noise(_) => None,
    }
}

/// Refuses a table of all pairs of shapes that would take gigabytes.
pub(crate) fn fits_in_table(table: &'static str, shapes: usize) -> Result<(), CliError> {
    if shapes > MOST_PAIRED {
        return Err(CliError::TooManyPairs { table, shapes });
    }
    Ok(())
}

fn chosen(model: &Model, asked: &ConfusionArguments, charset: Charset) -> String {
    let chosen = model.choose_descriptors(&asked.roundings);
    let limit = Evaluation::of(model);
    if asked.form != EvaluationForm::Json {
        return evaluation::greedy(&chosen, &limit, charset);
    }
    let steps = chosen.iter().map(|step| {
        json!({
            "descriptor": step.descriptor.key(),
            "right": evaluation::number(step.evaluation.right),
            "error": step.evaluation.error(),
            "values": step.evaluation.keys,
        })
    });
    let steps: Vec<_> = steps.collect();
    json!({"chosen": steps, "limit": limit.error()}).to_string() + "\n"
}

fn pairs(model: &Model, as_json: bool, charset: Charset) -> String {
    let errors = model.pair_errors();
    let names = model.shapes().iter().map(|shape| shape.name.clone());
    let labels: Vec<String> = names.collect();
    if !as_json {
        return evaluation::pairs(&labels, &errors, charset);
    }
    json::ascii(&json!({"labels": labels, "errors": errors})) + "\n"
}

fn reached(
    classifier: Classifier,
    model: &Model,
    asked: &ConfusionArguments,
    charset: Charset,
    signals: &Signals,
) -> Result<ClassifierEvaluation, CliError> {
    let keys = model.keys().len() as u64;
    let display = ProgressDisplay::counting("imprints", keys, asked.quiet, charset);
    let progress = signals.progress(&display);
    let reached = classifier.evaluate(model, &asked.classifiers, &progress);
    reached.ok_or_else(|| signals.failure())
}

fn all_classifiers(
    model: &Model,
    asked: &ConfusionArguments,
    charset: Charset,
) -> Result<String, CliError> {
    let signals = Signals::catch()?;
    let all = Classifier::ALL.iter().copied();
    let all = all.map(|classifier| reached(classifier, model, asked, charset, &signals));
    let all: Vec<ClassifierEvaluation> = all.collect::<Result<_, _>>()?;
    let limit = Evaluation::of(model);
    if let Some(path) = &asked.export {
        let table = evaluation::classifiers_csv(&all, &limit);
        put(path, table.as_bytes(), asked.existing)?;
    }
    match asked.form {
        EvaluationForm::Json => {}
        EvaluationForm::Csv => return Ok(evaluation::classifiers_csv(&all, &limit)),
        EvaluationForm::Text => return Ok(evaluation::classifiers(&all, &limit, charset)),
    }
    let errors = all.iter().map(|reached| {
        let error = json!(reached.evaluation.error());
        (reached.classifier.name().to_owned(), error)
    });
    let limit = ("limit".to_owned(), json!(limit.error()));
    let table: serde_json::Map<_, _> = errors.chain([limit]).collect();
    Ok(json::text(&table) + "\n")
}

fn shown(
    asked: &ConfusionArguments,
    own: &Evaluation,
    classifier: Option<&ClassifierEvaluation>,
    charset: Charset,
) -> Result<String, CliError> {
    if let Some(path) = &asked.export {
        put(path, file(path, own)?.as_bytes(), asked.existing)?;
    }
    Ok(match asked.form {
        EvaluationForm::Json => {
            json::ascii(&EvaluationJson {
                evaluation: own,
                classifier,
            }) + "\n"
        }
        EvaluationForm::Csv => evaluation::csv(own),
        EvaluationForm::Text => {
            let matrix = evaluation::matrix(own, charset);
            let worst = evaluation::worst_pairs(own, charset);
            let features = charset.lines(&evaluation::features(classifier));
            let drawn: String = classifier.map(evaluation::sampled).into_iter().collect();
            let advice = advice(asked);
            let named = match (&asked.of, classifier) {
                (_, Some(_)) => NamedBy::Classifier,
                (Evaluated::Given(_), None) => NamedBy::Descriptors,
                _ => NamedBy::Imprint,
            };
            let summary = evaluation::summary(own, named);
            format!("{summary}\n{matrix}{worst}{features}{drawn}{advice}")
        }
    })
}

fn advice(asked: &ConfusionArguments) -> String {
    let Evaluated::Given(given) = &asked.of else {
        return String::new();
    };
    let is_rounded = |key: &str| {
        asked
            .roundings
            .iter()
            .any(|own| own.descriptor.key() == key)
    };
    let mut keys = given.descriptors.iter().map(|own| own.key());
    let fine = keys.find(|key| key.starts_with("cg_cd") && !is_rounded(key));
    fine.map_or_else(String::new, |key| {
        let step = if key == "cg_cd" { "0.01" } else { "1" };
        format!(
            "{key} at full precision is more of a fingerprint than a measurement; try --round {key}={step}\n"
        )
    })
}

fn file(path: &Path, own: &Evaluation) -> Result<String, CliError> {
    if !has_ending(path, "svg") {
        return Ok(evaluation::csv(own));
    }
    let mut map = drawing(path, &own.labels, own.confusion.rows())?;
    map.title = format!("error {}", percent(own.error()));
    if let Some(certainty) = own.certainty {
        let certain = share(certainty.touches, own.touches);
        map.title += &format!(", certain {}", percent(certain));
    }
    Ok(map.svg())
}

fn drawing(
    path: &Path,
    labels: &[String],
    counts: impl IntoIterator<Item = Vec<u128>>,
) -> Result<ConfusionMap, CliError> {
    ConfusionMap::new(labels, counts).ok_or_else(|| CliError::TooManyShapes {
        name: path.to_string_lossy().into_owned(),
        shapes: labels.len(),
    })
}
