//! `taxel model confusion`: how well one touch tells the shapes of a model apart.

use std::path::Path;

use serde_json::json;

use crate::cli::arguments::flags::EvaluationForm;
use crate::cli::arguments::model::confusion::{ConfusionArguments, Evaluated};
use crate::cli::commands::export::put;
use crate::cli::commands::model;
use crate::cli::commands::noise;
use crate::cli::error::CliError;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::{self, EvaluationJson};
use crate::cli::output::report;
use crate::formats::{ConfusionMap, json};
use crate::recognition::{Evaluation, Peer, greedy};

/// Evaluates a model.
pub(crate) fn confusion(
    asked: &ConfusionArguments,
    shelf: &Shelf,
    charset: Charset,
) -> Result<String, CliError> {
    let model = model::find(&asked.model, shelf)?;
    let text = match &asked.of {
        Evaluated::Imprints => shown(asked, &Evaluation::of(&model), charset)?,
        Evaluated::Given(given) => {
            let given = given.clone().rounded(asked.roundings.clone());
            shown(asked, &given.evaluate(&model), charset)?
        }
        Evaluated::Greedy => {
            let (chosen, limit) = (greedy(&model, &asked.roundings), Evaluation::of(&model));
            match asked.form {
                EvaluationForm::Json => {
                    let steps = chosen.iter().map(|(descriptor, reached)| {
                        json!({
                            "descriptor": descriptor.key(),
                            "right": evaluation::number(reached.right),
                            "error": reached.error(),
                            "values": reached.keys,
                        })
                    });
                    let steps: Vec<_> = steps.collect();
                    json!({"chosen": steps, "limit": limit.error()}).to_string() + "\n"
                }
                _ => evaluation::greedy(&chosen, &limit, charset),
            }
        }
        Evaluated::Pairs => {
            let errors = model.pair_errors();
            let names = model.shapes().iter().map(|shape| shape.name.clone());
            let labels: Vec<String> = names.collect();
            match asked.form {
                EvaluationForm::Json => {
                    let line = json!({"labels": labels, "errors": errors}).to_string();
                    report::ascii_json(&line) + "\n"
                }
                _ => evaluation::pairs(&labels, &errors, charset),
            }
        }
        Evaluated::Peer(peer) => {
            let reached = peer.evaluate(&model, &asked.peers);
            if asked.form == EvaluationForm::Json {
                let line = json::text(&EvaluationJson {
                    evaluation: &reached.evaluation,
                    peer: Some(&reached),
                });
                report::ascii_json(&line) + "\n"
            } else {
                let text = shown(asked, &reached.evaluation, charset)?;
                text + &charset.lines(&evaluation::features(Some(&reached)))
            }
        }
        Evaluated::Noise(noise) => noise::degradation(&model, noise, asked.form, charset)?,
        Evaluated::HalfStep => {
            noise::half_step(&model, asked.form == EvaluationForm::Json, charset)?
        }
        Evaluated::AllPeers => {
            let all = Peer::ALL.map(|peer| peer.evaluate(&model, &asked.peers));
            let limit = Evaluation::of(&model);
            match asked.form {
                EvaluationForm::Json => {
                    let mut table = serde_json::Map::new();
                    for reached in &all {
                        let error = json!(reached.evaluation.error());
                        table.insert(reached.peer.name().to_owned(), error);
                    }
                    table.insert("limit".to_owned(), json!(limit.error()));
                    json::text(&table) + "\n"
                }
                _ => evaluation::peers(&all, &limit, charset),
            }
        }
    };
    Ok(text)
}

/// One evaluation, in the form that is asked for.
fn shown(
    asked: &ConfusionArguments,
    own: &Evaluation,
    charset: Charset,
) -> Result<String, CliError> {
    if let Some(path) = &asked.export {
        put(path, &file(path, own)?, asked.existing)?;
    }
    Ok(match asked.form {
        EvaluationForm::Json => {
            let line = json::text(&EvaluationJson {
                evaluation: own,
                peer: None,
            });
            report::ascii_json(&line) + "\n"
        }
        EvaluationForm::Csv => evaluation::csv(own),
        EvaluationForm::Text => {
            let matrix = evaluation::matrix(own, charset);
            let worst = evaluation::worst_pairs(own, charset);
            format!("{}\n{matrix}{worst}", evaluation::summary(own, charset))
        }
    })
}

/// The matrix as the file that an ending asks for.
fn file(path: &Path, own: &Evaluation) -> Result<Vec<u8>, CliError> {
    let map = || {
        let map = ConfusionMap::new(&own.labels, &own.confusion);
        map.ok_or_else(|| CliError::TooManyShapes {
            name: path.to_string_lossy().into_owned(),
            shapes: own.labels.len(),
        })
    };
    let title = format!(
        "error {}, certain {}",
        evaluation::percent(own.error()),
        evaluation::percent(evaluation::ratio(own.certain, own.touches))
    );
    Ok(match ending(path).as_str() {
        "svg" => map()?.with_title(&title).svg().into_bytes(),
        "png" => map()?.with_title(&title).png().map_err(CliError::Write)?,
        _ => evaluation::csv(own).into_bytes(),
    })
}

/// The ending of a file's name in small letters; empty without one.
pub(crate) fn ending(path: &Path) -> String {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.map_or_else(String::new, str::to_ascii_lowercase)
}
