//! Simulated touches. `taxel model confusion --noise`: how often noisy ones are named right; `taxel model touches`: how
//! many it takes until one shape is probable enough.
//!
//! Noise flips each taxel independently with the same probability. Dead taxels are inactive; they are drawn anew for
//! each touch, but are the same at every noise, so that rows can be compared. The classifier knows the noise and which
//! taxels are dead. The same seed gives the same numbers with any number of threads.

use std::ffi::OsString;

use serde_json::json;
use taxel_core::index::narrow;
use taxel_core::parameter::number::share;
use taxel_core::pose::DecimalRange;
use taxel_core::recognition::{
    MOST_TOUCHES, Model, Noise, NoisyTouches, RecognitionRate, TouchesUntil,
};
use taxel_core::sensor::{MatrixSize, Sensor};
use taxel_files::formats::value::{counted, grouped, percent};
use taxel_files::formats::{Plot, json};

use crate::cli::Context;
use crate::cli::arguments::flags::{name_or_path, parse_probability, whole};
use crate::cli::arguments::parameters::parse_range;
use crate::cli::commands::model::confusion::Confusion;
use crate::cli::commands::model::{Table, find, ready, watched};
use crate::cli::failure::{Failure, Named};
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
    /// Also test with N dead taxels, drawn anew for each touch; default 0
    #[arg(long, value_name = "N,...", value_delimiter = ',')]
    #[arg(requires = "with_noise")]
    #[arg(value_parser = whole::<u32>(0..=4095), default_value = "0", hide_default_value = true)]
    dead: Vec<u32>,
    /// Noisy touches of each shape; default 1000
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST), requires = "with_noise")]
    touches: Option<u64>,
    /// Columns and rows of the sensor for noisy touches; default those of the model
    #[arg(long, value_name = "CxR", value_parser = matrix, requires = "with_noise")]
    matrix: Option<MatrixSize>,
}

/// Both ends must be valid for [`Noise::new`].
fn noise_range(text: &str) -> Result<DecimalRange, String> {
    let range = parse_range(text)?;
    let checked = Noise::new(range.value(0)).and(Noise::new(range.last()));
    checked.map(|_| range).map_err(|error| error.to_string())
}

fn matrix(text: &str) -> Result<MatrixSize, &'static str> {
    let side = |text: &str| text.trim().parse::<u8>().ok();
    let size = || {
        let (columns, rows) = text.split_once('x')?;
        MatrixSize::new(side(columns)?, side(rows)?).ok()
    };
    size().ok_or("expected columns and rows from 1 to 64, such as 16x16")
}

impl NoiseFlags {
    fn size(&self, of_model: &Sensor) -> MatrixSize {
        self.matrix.unwrap_or(of_model.size())
    }

    pub(super) fn check(&self, of_model: &Sensor) -> Result<(), Failure> {
        let cells = narrow(self.size(of_model).cells());
        let dead = self.dead.iter().find(|&&dead| dead > cells);
        dead.map_or(Ok(()), |dead| {
            let allowed = format!("(allowed: 0 to {cells}, the taxels of the matrix)");
            Err(Failure::new(format!(
                "--dead {dead} is above {cells} {allowed}"
            )))
        })
    }

    pub(super) fn rates(
        &self,
        noise: DecimalRange,
        model: &Model,
        asked: &Confusion,
        cx: &Context,
    ) -> Result<NoisyRates, Failure> {
        let size = self.size(model.sensor());
        let too_large = model.poses_too_large(size);
        if let Some(shape) = too_large.iter().position(|&own| own == model.poses()) {
            let text = format!("none of its imprints fits on {size} taxels");
            return Err(Failure::new(text)).named(&model.shapes()[shape].name);
        }
        if !asked.table.quiet {
            note_left_out(model, size, &too_large, cx);
        }
        let (each, seed) = (self.touches.unwrap_or(1000), asked.seed.unwrap_or_default());
        let given = asked.known();
        let rows = noise.count() * self.dead.len() as u64;
        let all = each * model.shapes().len() as u64 * rows;
        let rows = watched((all, "touches"), asked.table.quiet, |progress| {
            let mut rows = Vec::new();
            for &dead in &self.dead {
                for value in noise.values() {
                    let noise = Noise::new(value).ok()?;
                    let mut touches = NoisyTouches::new(size, noise, each, seed);
                    touches.random_dead = dead;
                    let rate = match &given {
                        None => model.recognition_rate(&touches, &noise, progress),
                        Some(given) => given.rate(model, &touches, progress),
                    };
                    rows.push((value, dead, rate?));
                }
            }
            Some(rows)
        });
        let held = match given {
            Some(_) => "values some shape has",
            None => "imprint some shape leaves",
        };
        let is_weighted = model.shapes().iter().any(|shape| shape.weight > 1);
        Ok(NoisyRates {
            rows: rows?,
            size,
            seed,
            note: format!(
                "held: touches whose {held} without noise, too\n\
                 claimed: the mean probability of the answers\n{}",
                if is_weighted { WEIGHTED } else { "" }
            ),
        })
    }
}

/// Names the shapes whose imprints do not all fit on the matrix.
fn note_left_out(model: &Model, size: MatrixSize, too_large: &[u64], cx: &Context) {
    let shapes = model.shapes().iter().zip(too_large);
    let shapes = shapes.filter(|(_, poses)| **poses > 0);
    let shapes = shapes.map(|(shape, &poses)| {
        let part = percent(share(poses.into(), model.poses().into()));
        format!("{part} of the poses of {}", shape.name)
    });
    let shapes = shapes.collect::<Vec<_>>().join(", ");
    if !shapes.is_empty() {
        let reason = format!("because they do not fit on {size}");
        cx.note(&format!("left out, {reason}: {shapes}"));
    }
}

pub(super) struct NoisyRates {
    /// The noise, the number of dead taxels, and how often a touch is named right.
    rows: Vec<(f64, u32, RecognitionRate)>,
    size: MatrixSize,
    seed: u64,
    /// Below the table: what `held` means, and whether touches have weights.
    note: String,
}

impl NoisyRates {
    /// A curve of the touches that are named right, for each number of dead taxels.
    fn curves(&self) -> Vec<(u32, Vec<(f64, f64)>)> {
        let groups = self.rows.chunk_by(|one, other| one.1 == other.1);
        let curves = groups.map(|rows| {
            let points = rows.iter().map(|(noise, _, rate)| (*noise, rate.accuracy));
            (rows[0].1, points.collect())
        });
        curves.collect()
    }
}

impl Table for NoisyRates {
    fn text(&self) -> String {
        const BAR: usize = 30;
        let mut rows = vec![row(["noise", "dead", "right", "held", "claimed"])];
        for (noise, dead, rate) in &self.rows {
            let (right, error) = (percent(rate.accuracy), 100.0 * rate.standard_error);
            rows.push(row([
                &noise.to_string(),
                &dead.to_string(),
                &format!("{right} ± {error:.1}"),
                &percent(rate.held_share),
                &percent(rate.mean_confidence),
                &bar(rate.accuracy, BAR),
            ]));
        }
        let touches = self.rows.first().map_or(0, |(_, _, rate)| rate.touches);
        let (touches, seed) = (counted(touches, "touch"), self.seed);
        table(&rows, &[5]) + &format!("{touches} a row, seed {seed}\n{}", self.note)
    }

    fn records(&self) -> Vec<Record<'static>> {
        let record = |(noise, dead, rate): &(f64, u32, RecognitionRate)| {
            Record(vec![
                ("noise", json!(noise)),
                ("dead", json!(dead)),
                ("touches", count(rate.weighted_touches)),
                ("right", count(rate.weighted_right)),
                ("accuracy", json!(rate.accuracy)),
                ("standard_error", json!(rate.standard_error)),
                ("claimed", json!(rate.mean_confidence)),
                ("held", json!(rate.held_share)),
            ])
        };
        self.rows.iter().map(record).collect()
    }

    fn json(&self) -> String {
        let answer = json!({
            "columns": self.size.columns(),
            "rows": self.size.rows(),
            "seed": self.seed,
            "degradation": self.records(),
        });
        json::text(&answer) + "\n"
    }

    fn svg(&self) -> Option<String> {
        let curves = self.curves().into_iter();
        let plot = curves.fold(Plot::new("noise", "right"), |plot, (dead, points)| {
            plot.with_curve(&counted(dead, "dead taxel"), &points)
        });
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
