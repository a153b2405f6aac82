//! `taxel model touches`: how many touches it takes until one shape is probable enough.

use std::ffi::OsString;

use serde_json::json;
use taxel_core::recognition::{MOST_TOUCHES, TouchesUntil};
use taxel_files::formats::json;
use taxel_files::formats::value::{counted, grouped, percent};

use crate::cli::Context;
use crate::cli::arguments::flags::{name_or_path, parse_probability, whole};
use crate::cli::commands::model::{find, ready, watched};
use crate::cli::failure::Failure;
use crate::cli::output::table::table;

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
pub(super) struct Touches {
    /// Name of a model, or its file
    #[arg(value_name = "MODEL", value_parser = name_or_path())]
    model: OsString,
    /// How probable one shape must be (0 to 1); default 0.99
    #[arg(
        long,
        value_name = "P",
        value_parser = parse_probability,
        default_value = "0.99",
        hide_default_value = true
    )]
    until: f64,
    /// Runs of each shape; default 10000
    // The length of each run is kept until the mean is known: up to 120 MB.
    #[arg(
        long,
        value_name = "N",
        value_parser = whole::<u64>(1..=10_000_000),
        default_value = "10000",
        hide_default_value = true
    )]
    runs: u64,
    /// Seed of the random numbers; default 0
    #[arg(
        long,
        value_name = "N",
        value_parser = whole::<u64>(0..),
        default_value = "0",
        hide_default_value = true
    )]
    seed: u64,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
    /// Show no progress and no notes
    #[arg(long)]
    quiet: bool,
}

impl Touches {
    pub(super) fn run(self, cx: &Context) -> Result<(), Failure> {
        let model = ready(find(&self.model, &cx.shelf)?, self.quiet, cx.charset)?;
        let shapes = model.shapes();
        let all = (self.runs * shapes.len() as u64, "runs");
        let results = watched(all, self.quiet, cx, |progress| {
            model.touches_until(self.until, self.runs, self.seed, progress)
        })?;
        let weights = shapes.iter().map(|shape| f64::from(shape.weight));
        let all = mean(&weights.collect::<Vec<_>>(), &results);
        let named = shapes.iter().map(|shape| &*shape.name).zip(&results);
        cx.print(&match self.json {
            true => self.json(named, all),
            false => self.text(named, all, cx),
        })
    }

    fn json<'a>(
        &self,
        shapes: impl Iterator<Item = (&'a str, &'a TouchesUntil)>,
        (mean, error): Mean,
    ) -> String {
        let shapes = shapes.map(|(name, own)| {
            json!({
                "name": name,
                "mean": own.mean,
                "standard_error": own.standard_error,
                "reached": own.reached,
                "runs": own.runs,
                "right": own.right,
            })
        });
        let answer = json!({
            "until": self.until,
            "seed": self.seed,
            "mean": mean,
            "standard_error": error,
            "shapes": shapes.collect::<Vec<_>>(),
        });
        json::ascii(&answer) + "\n"
    }

    /// A line for each shape, with the mean, its standard error and the number of runs given up; and one for all.
    fn text<'a>(
        &self,
        shapes: impl Iterator<Item = (&'a str, &'a TouchesUntil)>,
        all: Mean,
        cx: &Context,
    ) -> String {
        let row = |name: &str, (mean, error): Mean, note: String| {
            let mean = mean.map_or("–".to_owned(), |mean| format!("{mean:.2}"));
            let error = error.map_or(String::new(), |error| format!("± {error:.2}"));
            vec![format!("  {name}"), mean, error, note]
        };
        let shapes = shapes.map(|(name, own)| {
            let note = match own.runs - own.reached {
                0 => String::new(),
                more => format!(
                    "{} of {} took more than {} touches",
                    grouped(more),
                    counted(own.runs, "run"),
                    grouped(MOST_TOUCHES)
                ),
            };
            row(name, (own.mean, own.standard_error), note)
        });
        let mut rows: Vec<_> = shapes.collect();
        rows.push(row("all shapes", all, String::new()));
        let (until, runs) = (percent(self.until), counted(self.runs, "run"));
        format!(
            "touches until a shape is {until} probable; {runs} each, seed {}\n{}",
            self.seed,
            table(&rows, &[0, 2, 3], cx.charset)
        )
    }
}

/// A mean and its standard error.
type Mean = (Option<f64>, Option<f64>);

/// The mean of the shapes' means by their weights. Their runs are independent, so the variances add up. None if a shape
/// has no mean.
fn mean(weights: &[f64], results: &[TouchesUntil]) -> Mean {
    let sum: f64 = weights.iter().sum();
    let shapes = || weights.iter().zip(results);
    let means = shapes().map(|(weight, own)| Some(weight * own.mean?));
    let variances = shapes().map(|(weight, own)| Some((weight * own.standard_error?).powi(2)));
    (
        means.sum::<Option<f64>>().map(|all| all / sum),
        variances.sum::<Option<f64>>().map(|all| all.sqrt() / sum),
    )
}
