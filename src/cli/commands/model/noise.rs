//! Simulated touches. `taxel model confusion --noise`: how often noisy ones are named right; `taxel model touches`: how
//! many it takes until one shape is probable enough.
//!
//! Noise flips each taxel independently with the same probability, which the classifier knows. The same seed gives the
//! same numbers with any number of threads.

use std::ffi::OsString;

use serde_json::json;
use taxel_core::pose::DecimalRange;
use taxel_core::recognition::{MOST_TOUCHES, Model, Noise, RecognitionRate, TouchesUntil};
use taxel_files::formats::value::{counted, grouped, percent};
use taxel_files::formats::{Plot, json};

use crate::cli::Context;
use crate::cli::arguments::flags::{name_or_path, parse_probability, whole};
use crate::cli::arguments::parameters::parse_range;
use crate::cli::commands::model::confusion::Confusion;
use crate::cli::commands::model::{Table, find, ready, watched};
use crate::cli::failure::Failure;
use crate::cli::output::evaluation::{WEIGHTED, count};
use crate::cli::output::table::{Record, bar, row, table};

/// The most noisy touches of a shape.
const MOST: u64 = 1_000_000_000;

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Noise")]
pub(super) struct NoiseFlags {
    /// Test touches whose taxels flip with this probability; with --test, answers assume it
    #[arg(long, value_name = "START:END:STEP", value_parser = noise_range, group = "with_noise")]
    pub(super) noise: Option<DecimalRange>,
    /// Noisy touches of each shape; default 1000
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST), requires = "with_noise")]
    touches: Option<u64>,
}

/// Both ends must be valid for [`Noise::new`].
fn noise_range(text: &str) -> Result<DecimalRange, String> {
    let range = parse_range(text)?;
    let checked = Noise::new(range.value(0)).and(Noise::new(range.last()));
    checked.map(|_| range).map_err(|error| error.to_string())
}

impl NoiseFlags {
    pub(super) fn rates(
        &self,
        noise: DecimalRange,
        model: &Model,
        asked: &Confusion,
    ) -> Result<NoisyRates, Failure> {
        let (each, seed) = (self.touches.unwrap_or(1000), asked.seed.unwrap_or_default());
        let all = each * model.shapes().len() as u64 * noise.count();
        let rows = watched((all, "touches"), asked.table.quiet, |progress| {
            let rate = |value| {
                let noise = Noise::new(value).ok()?;
                let size = model.sensor().size();
                let rate = model.recognition_rate(size, &noise, each, seed, progress)?;
                Some((value, rate))
            };
            noise.values().map(rate).collect()
        });
        let is_weighted = model.shapes().iter().any(|shape| shape.weight > 1);
        Ok(NoisyRates {
            rows: rows?,
            seed,
            is_weighted,
        })
    }
}

pub(super) struct NoisyRates {
    /// The noise, and how often a touch is named right.
    rows: Vec<(f64, RecognitionRate)>,
    seed: u64,
    is_weighted: bool,
}

impl Table for NoisyRates {
    fn text(&self) -> String {
        const BAR: usize = 30;
        let mut rows = vec![row(["noise", "right", "held", "claimed"])];
        for (noise, rate) in &self.rows {
            let (right, error) = (percent(rate.accuracy), 100.0 * rate.standard_error);
            rows.push(row([
                &noise.to_string(),
                &format!("{right} ± {error:.1}"),
                &percent(rate.held_share),
                &percent(rate.mean_confidence),
                &bar(rate.accuracy, BAR),
            ]));
        }
        let touches = self.rows.first().map_or(0, |(_, rate)| rate.touches);
        let (touches, seed) = (counted(touches, "touch"), self.seed);
        let weighted = if self.is_weighted { WEIGHTED } else { "" };
        table(&rows, &[4])
            + &format!(
                "{touches} a row, seed {seed}\n\
                 held: touches whose imprint some shape leaves without noise, too\n\
                 claimed: the mean probability of the answers\n{weighted}"
            )
    }

    fn json(&self) -> String {
        let record = |(noise, rate): &(f64, RecognitionRate)| {
            Record(vec![
                ("noise", json!(noise)),
                ("touches", count(rate.weighted_touches)),
                ("right", count(rate.weighted_right)),
                ("accuracy", json!(rate.accuracy)),
                ("standard_error", json!(rate.standard_error)),
                ("claimed", json!(rate.mean_confidence)),
                ("held", json!(rate.held_share)),
            ])
        };
        let rows: Vec<_> = self.rows.iter().map(record).collect();
        let answer = json!({"seed": self.seed, "degradation": rows});
        json::text(&answer) + "\n"
    }

    fn svg(&self) -> Option<String> {
        let points = self
            .rows
            .iter()
            .map(|(noise, rate)| (*noise, rate.accuracy));
        let points: Vec<(f64, f64)> = points.collect();
        let plot = Plot::new("noise", "right").with_curve("named right", &points);
        Some(plot.svg())
    }
}

/// The length of each run is kept until the mean is known: up to 120 MB.
const MOST_RUNS: u64 = 10_000_000;

const EXAMPLES: &str = "\
Touches each shape again and again in random poses, and multiplies the
probabilities until one shape reaches that of --until. Prints the mean number of
touches and its standard error; the same seed gives the same numbers. If a run
does not get there in 10,000 touches, it ends, and its shape has no mean.

Examples:
  taxel model touches parts
  taxel model touches parts --until 0.999 --runs 200 --seed 7 --json";

/// Simulate how many touches it takes to name a shape
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Touches {
    /// Name of a model, or its file
    #[arg(value_name = "MODEL", value_parser = name_or_path())]
    model: OsString,
    /// How probable one shape must be (0 to 1); default 0.99
    #[arg(long, value_name = "P", value_parser = parse_probability)]
    until: Option<f64>,
    /// Runs of each shape; default 10000
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST_RUNS))]
    runs: Option<u64>,
    /// Seed of the random numbers; default 0
    #[arg(long, value_name = "N", value_parser = whole::<u64>(0..))]
    seed: Option<u64>,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
    /// Show no progress and no notes
    #[arg(long)]
    quiet: bool,
}

impl Touches {
    pub(super) fn run(self, cx: &Context) -> Result<(), Failure> {
        let (until, runs) = (self.until.unwrap_or(0.99), self.runs.unwrap_or(10_000));
        let seed = self.seed.unwrap_or_default();
        let model = ready(find(&self.model, &cx.shelf)?, self.quiet)?;
        let shapes = model.shapes();
        let all = (runs * shapes.len() as u64, "runs");
        let results = watched(all, self.quiet, |progress| {
            model.touches_until(until, runs, seed, progress)
        })?;
        let weights: Vec<u32> = shapes.iter().map(|shape| shape.weight).collect();
        let (mean, error) = mean(&weights, &results);
        let named = shapes.iter().map(|shape| &*shape.name).zip(&results);
        if self.json {
            let answer = json!({
                "until": until,
                "seed": seed,
                "mean": mean,
                "standard_error": error,
                "shapes": named.map(record).collect::<Vec<_>>(),
            });
            return cx.print(&(json::ascii(&answer) + "\n"));
        }
        let shape = |(name, own): (&str, &TouchesUntil)| {
            cells(name, (own.mean, own.standard_error), own.runs - own.reached)
        };
        let mut rows: Vec<_> = named.map(shape).collect();
        rows.push(cells("all shapes", (mean, error), 0));
        let (until, runs) = (percent(until), counted(runs, "run"));
        let title =
            format!("touches until a shape is {until} probable; {runs} each, seed {seed}\n");
        cx.print(&(title + &table(&rows, &[0, 2, 3])))
    }
}

fn record((name, own): (&str, &TouchesUntil)) -> Record<'static> {
    Record(vec![
        ("name", json!(name)),
        ("mean", json!(own.mean)),
        ("standard_error", json!(own.standard_error)),
        ("reached", json!(own.reached)),
        ("runs", json!(own.runs)),
        ("right", json!(own.right)),
    ])
}

/// The mean, its standard error and the number of runs given up.
fn cells(name: &str, (mean, error): Mean, given_up: u64) -> Vec<String> {
    let mean = mean.map_or("–".to_owned(), |mean| format!("{mean:.2}"));
    let error = error.map_or(String::new(), |error| format!("± {error:.2}"));
    let most = grouped(MOST_TOUCHES);
    let note = match given_up {
        0 => String::new(),
        runs => format!("{} took more than {most} touches", counted(runs, "run")),
    };
    row([&format!("  {name}"), &mean, &error, &note])
}

/// A mean and its standard error.
type Mean = (Option<f64>, Option<f64>);

/// The mean of the shapes' means by their weights. Their runs are independent, so the variances add up. None if a shape
/// has no mean.
fn mean(weights: &[u32], results: &[TouchesUntil]) -> Mean {
    let sum: f64 = weights.iter().copied().map(f64::from).sum();
    let shapes = || weights.iter().copied().map(f64::from).zip(results);
    let means = shapes().map(|(weight, own)| Some(weight * own.mean?));
    let variances = shapes().map(|(weight, own)| Some((weight * own.standard_error?).powi(2)));
    let mean = means.sum::<Option<f64>>().map(|all| all / sum);
    let error = variances.sum::<Option<f64>>().map(|all| all.sqrt() / sum);
    (mean, error)
}
