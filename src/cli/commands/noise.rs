//! The cost of noise: `taxel model confusion --noise` and `taxel model touches`.
//!
//! Noise flips each taxel independently with the same probability. Dead taxels are inactive; they are drawn anew for
//! each touch. The tables look like this:
//! ```text
//!   noise  dead     right            held   claimed
//!    0.05     0    89.3 % ± 2.5     0.0 %    90.9 %  ███████████████████████████
//!
//! touches until a shape is 99.0 % probable; 20 runs each, seed 0
//!   disc           1.40 ± 0.11
//!   all shapes     1.15 ± 0.04
//! ```
//! `held` are noisy imprints that some shape leaves without noise; `claimed` is the mean probability of the names
//! given, which is close to `right` if the probabilities can be trusted. Both are simulated, with the standard error
//! after `±`. The same seed gives the same numbers with any number of threads.

use std::fmt::Write;
use std::iter;

use serde_json::json;
use taxel_core::index::narrow;
use taxel_core::parameter::number::share;
use taxel_core::recognition::{
    GivenDescriptors, MOST_TOUCHES, Model, Noise, NoisyTouches, RecognitionRate, TouchesUntil,
};
use taxel_core::sensor::Sensor;
use taxel_files::formats::file::has_ending;
use taxel_files::formats::value::{counted, grouped, percent};
use taxel_files::formats::{Plot, json};

use crate::cli::arguments::flags::EvaluationForm;
use crate::cli::arguments::model::{ConfusionArguments, NoiseArguments, TouchesArguments};
use crate::cli::commands::export::put;
use crate::cli::commands::model;
use crate::cli::error::CliError;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::{Charset, note};
use crate::cli::output::evaluation::{self, bar};
use crate::cli::output::plot;
use crate::cli::output::progress::ProgressDisplay;
use crate::cli::signals::Signals;

struct NoiseRow {
    noise: f64,
    dead: u32,
    rate: RecognitionRate,
}

/// Returns how often noisy touches are named right, for each noise and each number of dead taxels. The dead taxels
/// are drawn anew for each touch, but are the same at every noise, so that rows can be compared. The classifier knows
/// the noise and which taxels are dead.
pub(crate) fn degradation(
    model: &Model,
    asked: &NoiseArguments,
    all_asked: &ConfusionArguments,
    charset: Charset,
) -> Result<String, CliError> {
    let given = given_of(asked, all_asked);
    let signals = Signals::catch()?;
    let sensor = sensor(asked, model.sensor());
    check_fits(model, &sensor)?;
    if let Some(text) = left_out(model, &sensor).filter(|_| !all_asked.quiet) {
        note(&text, charset);
    }
    let values: Vec<f64> = asked.noise.values().collect();
    let each = asked.touches * model.shapes().len() as u64;
    let all = each * values.len() as u64 * asked.dead.len() as u64;
    let display = ProgressDisplay::counting("touches", all, all_asked.quiet, charset);
    let progress = signals.progress(&display);
    let mut table = Vec::new();
    for &dead in &asked.dead {
        for &value in &values {
            let noise = Noise::new(value)?;
            let mut touches = NoisyTouches::new(sensor.size(), noise, asked.touches, asked.seed);
            touches.random_dead = dead;
            let rate = match &given {
                None => model.recognition_rate(&touches, &noise, &progress),
                Some(given) => given.rate(model, &touches, &progress),
            };
            let rate = rate.ok_or_else(|| signals.failure())?;
            table.push(NoiseRow {
                noise: value,
                dead,
                rate,
            });
        }
    }
    write_noise(&table, all_asked)?;
    Ok(match all_asked.form {
        EvaluationForm::Json => noise_json(&table, &sensor, asked.seed),
        EvaluationForm::Csv => noise_csv(&table),
        EvaluationForm::Text => {
            let text = noise_text(&table, asked.seed, given.is_some(), charset);
            let weighted = weighted(model);
            charset.lines(&(text + weighted + &noise_curves(&table, charset)))
        }
    })
}

fn weighted(model: &Model) -> &'static str {
    let has_weights = model.shapes().iter().any(|shape| shape.weight > 1);
    if has_weights {
        evaluation::WEIGHTED
    } else {
        ""
    }
}

pub(crate) fn check_dead(dead: &[u32], sensor: &Sensor) -> Result<(), CliError> {
    let cells = narrow(sensor.size().cells());
    match dead.iter().find(|&&dead| dead > cells) {
        None => Ok(()),
        Some(dead) => Err(CliError::Range {
            flag: "dead".to_owned(),
            text: dead.to_string(),
            complaint: format!(
                "is above {cells} (allowed: 0 to {cells}, the taxels of the matrix)"
            ),
        }),
    }
}

fn write_noise(table: &[NoiseRow], asked: &ConfusionArguments) -> Result<(), CliError> {
    let Some(path) = asked.export.as_deref() else {
        return Ok(());
    };
    let content = if has_ending(path, "svg") {
        noise_plot(table).svg()
    } else {
        noise_csv(table)
    };
    put(path, content.as_bytes(), asked.existing)
}

pub(crate) fn sensor(asked: &NoiseArguments, of_model: &Sensor) -> Sensor {
    asked.size.map_or(*of_model, Sensor::of_size)
}

fn check_fits(model: &Model, sensor: &Sensor) -> Result<(), CliError> {
    match model.first_too_large(sensor.size()) {
        None => Ok(()),
        Some(shape) => Err(CliError::NoTouch {
            name: model.shapes()[shape].name.clone(),
            size: sensor.size(),
        }),
    }
}

/// Returns a note about the shapes whose imprints do not all fit on the matrix, with the share of their poses; None
/// if all fit.
fn left_out(model: &Model, sensor: &Sensor) -> Option<String> {
    const NAMED: usize = 3;
    let size = sensor.size();
    let too_large = model.poses_too_large(size);
    let all = model.poses();
    let shapes = model.shapes().iter().zip(too_large);
    let mut shapes: Vec<_> = shapes.filter(|(_, poses)| *poses > 0).collect();
    shapes.sort_by_key(|(_, poses)| std::cmp::Reverse(*poses));
    let named = shapes.iter().take(NAMED).map(|(shape, poses)| {
        let part = percent(share((*poses).into(), all.into()));
        format!("{part} of the poses of {}", shape.name)
    });
    let named = named.collect::<Vec<_>>().join(", ");
    let more = match shapes.len().saturating_sub(NAMED) {
        0 => String::new(),
        1 => " and some of another shape".to_owned(),
        more => format!(" and some of {more} other shapes"),
    };
    (!shapes.is_empty())
        .then(|| format!("left out, because they do not fit on {size}: {named}{more}"))
}

fn given_of(asked: &NoiseArguments, all_asked: &ConfusionArguments) -> Option<GivenDescriptors> {
    let descriptors = asked.given.clone()?.descriptors;
    let roundings = all_asked.roundings.clone();
    Some(GivenDescriptors {
        descriptors,
        roundings,
    })
}

fn noise_points(table: &[NoiseRow]) -> Vec<(u32, Vec<(f64, f64)>)> {
    let groups = table.chunk_by(|one, other| one.dead == other.dead);
    let points = |rows: &[NoiseRow]| {
        let points = rows.iter().map(|row| (row.noise, row.rate.accuracy));
        (rows[0].dead, points.collect())
    };
    groups.map(points).collect()
}

fn noise_plot(table: &[NoiseRow]) -> Plot {
    let plot = Plot::from_zero("noise", "right");
    let curves = noise_points(table).into_iter();
    curves.fold(plot, |plot, (dead, points)| {
        plot.with_curve(&counted(dead, "dead taxel"), &points)
    })
}

fn noise_curves(table: &[NoiseRow], charset: Charset) -> String {
    let curves = noise_points(table).into_iter();
    let curves = curves.map(|(dead, points)| {
        let curve = plot::lines("right", "noise", &points, charset);
        match (curve.is_empty(), dead) {
            (true, _) => String::new(),
            (false, 0) => format!("\n{curve}"),
            (false, dead) => format!("\n{}\n{curve}", counted(dead, "dead taxel")),
        }
    });
    curves.collect()
}

fn noise_json(table: &[NoiseRow], sensor: &Sensor, seed: u64) -> String {
    let rows_json: Vec<_> = table
        .iter()
        .map(|row| {
            json!({
                "noise": row.noise,
                "dead": row.dead,
                "touches": evaluation::number(row.rate.weighted_touches),
                "right": evaluation::number(row.rate.weighted_right),
                "accuracy": row.rate.accuracy,
                "standard_error": row.rate.standard_error,
                "claimed": row.rate.mean_confidence,
                "held": row.rate.held_share,
            })
        })
        .collect();
    let answer = json!({
        "columns": sensor.columns(),
        "rows": sensor.rows(),
        "seed": seed,
        "degradation": rows_json,
    });
    json::text(&answer) + "\n"
}

fn noise_csv(table: &[NoiseRow]) -> String {
    let mut text = String::from("noise,dead,touches,right,accuracy,standard_error,claimed,held\n");
    for row in table {
        let rate = &row.rate;
        // Cannot fail: the text is kept in memory.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{}",
            row.noise,
            row.dead,
            rate.weighted_touches,
            rate.weighted_right,
            rate.accuracy,
            rate.standard_error,
            rate.mean_confidence,
            rate.held_share
        );
    }
    text
}

fn noise_text(table: &[NoiseRow], seed: u64, given: bool, charset: Charset) -> String {
    /// The length of a bar for 100 %, in characters.
    const BAR: usize = 30;
    let mut text = String::from("  noise  dead     right            held   claimed\n");
    for row in table {
        let rate = &row.rate;
        let bar = bar(rate.accuracy, BAR, charset);
        let _ = writeln!(
            text,
            "{:>7}  {:>4}  {:>8} ± {:<4}  {:>7}  {:>8}  {bar}",
            row.noise,
            row.dead,
            percent(rate.accuracy),
            format!("{:.1}", 100.0 * rate.standard_error),
            percent(rate.held_share),
            percent(rate.mean_confidence),
        );
    }
    let touches = table.first().map_or(0, |row| row.rate.touches);
    let _ = writeln!(
        text,
        "{} a row, seed {seed}\nheld: touches whose {} without noise, too\n\
         claimed: the mean probability of the answers",
        counted(touches, "touch"),
        if given {
            "values some shape has"
        } else {
            "imprint some shape leaves"
        }
    );
    text
}

pub(crate) fn touches(
    asked: &TouchesArguments,
    shelf: &Shelf,
    charset: Charset,
) -> Result<String, CliError> {
    let model = model::find(&asked.model, shelf)?;
    let model = model::ready(model, &|poses| {
        ProgressDisplay::new(poses, asked.quiet, charset)
    })?;
    let signals = Signals::catch()?;
    let all = asked.runs * model.shapes().len() as u64;
    let display = ProgressDisplay::counting("runs", all, asked.quiet, charset);
    let progress = signals.progress(&display);
    let results = model.touches_until(asked.until, asked.runs, asked.seed, &progress);
    let results = results.ok_or_else(|| signals.failure())?;
    let names = model.shapes().iter().map(|shape| shape.name.as_str());
    let shapes: Vec<_> = names.zip(&results).collect();
    let weights = model.shapes().iter().map(|shape| f64::from(shape.weight));
    let all = mean(&weights.collect::<Vec<_>>(), &results);
    Ok(if asked.json {
        touches_json(asked, &shapes, all) + "\n"
    } else {
        touches_text(asked, &shapes, all, charset)
    })
}

/// Returns the mean of the shapes' means by their weights, and its standard error. Their runs are independent, so the
/// variances add up. None if a shape has no mean.
fn mean(weights: &[f64], results: &[TouchesUntil]) -> (Option<f64>, Option<f64>) {
    let sum: f64 = weights.iter().sum();
    let shapes = || weights.iter().zip(results);
    let means = shapes().map(|(weight, own)| Some(weight * own.mean?));
    let variances = shapes().map(|(weight, own)| Some((weight * own.standard_error?).powi(2)));
    (
        means.sum::<Option<f64>>().map(|all| all / sum),
        variances.sum::<Option<f64>>().map(|all| all.sqrt() / sum),
    )
}

fn touches_json(
    asked: &TouchesArguments,
    shapes: &[(&str, &TouchesUntil)],
    (mean, error): (Option<f64>, Option<f64>),
) -> String {
    let shapes: Vec<_> = shapes
        .iter()
        .map(|(name, own)| {
            json!({
                "name": name,
                "mean": own.mean,
                "standard_error": own.standard_error,
                "reached": own.reached,
                "runs": own.runs,
                "right": own.right,
            })
        })
        .collect();
    let answer = json!({
        "until": asked.until,
        "seed": asked.seed,
        "mean": mean,
        "standard_error": error,
        "shapes": shapes,
    });
    json::ascii(&answer)
}

/// Returns a line for each shape, with the mean, its standard error and the number of runs given up; and a line for
/// all shapes.
fn touches_text(
    asked: &TouchesArguments,
    shapes: &[(&str, &TouchesUntil)],
    (mean, error): (Option<f64>, Option<f64>),
    charset: Charset,
) -> String {
    let names = shapes.iter().map(|(name, _)| *name);
    let column = charset.column(iter::once("all shapes").chain(names));
    let mut text = format!(
        "touches until a shape is {} probable; {} each, seed {}\n",
        percent(asked.until),
        counted(asked.runs, "run"),
        asked.seed
    );
    for ((_, own), name) in shapes.iter().zip(&column[1..]) {
        let left = match own.runs - own.reached {
            0 => String::new(),
            more => {
                let (more, runs) = (grouped(more), counted(own.runs, "run"));
                let most = grouped(MOST_TOUCHES);
                format!("  {more} of {runs} took more than {most} touches")
            }
        };
        let value = with_error(own.mean, own.standard_error);
        // Cannot fail: the text is kept in memory.
        let _ = writeln!(text, "  {name}  {value}{left}");
    }
    let _ = writeln!(text, "  {}  {}", column[0], with_error(mean, error));
    charset.lines(&text)
}

fn with_error(mean: Option<f64>, error: Option<f64>) -> String {
    let mean = mean.map_or("–".to_owned(), |mean| format!("{mean:.2}"));
    let error = error.map_or(String::new(), |error| format!(" ± {error:.2}"));
    format!("{mean:>7}{error}")
}
