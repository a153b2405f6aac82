//! `taxel model confusion --noise`: how often noisy touches are named right.
//!
//! Noise flips each taxel independently with the same probability. Dead taxels are inactive; they are drawn anew for
//! each touch, but are the same at every noise, so that rows can be compared. The classifier knows the noise and which
//! taxels are dead. The same seed gives the same numbers with any number of threads.

use serde_json::json;
use taxel_core::index::narrow;
use taxel_core::parameter::number::share;
use taxel_core::pose::DecimalRange;
use taxel_core::recognition::{Model, Noise, NoisyTouches, RecognitionRate};
use taxel_core::sensor::{MatrixSize, Sensor};
use taxel_files::formats::value::{counted, percent};
use taxel_files::formats::{Plot, json};

use crate::cli::Context;
use crate::cli::arguments::flags::whole;
use crate::cli::arguments::parameters::parse_range;
use crate::cli::commands::model::confusion::Confusion;
use crate::cli::commands::model::{Table, watched};
use crate::cli::failure::Failure;
use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::{Count, WEIGHTED};
use crate::cli::output::plot;
use crate::cli::output::table::{bar, row, table};

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Noise")]
pub(super) struct NoiseFlags {
    /// Test touches whose taxels flip with this probability
    #[arg(
        long,
        value_name = "START:END:STEP",
        value_parser = parse_noise_range,
        group = "with_noise"
    )]
    pub(super) noise: Option<DecimalRange>,
    /// Also test with N dead taxels, drawn anew for each touch; default 0
    #[arg(
        long,
        value_name = "N,...",
        value_delimiter = ',',
        value_parser = whole::<u32>(0..=4095),
        requires = "with_noise"
    )]
    dead: Vec<u32>,
    /// Noisy touches of each shape; default 1000
    #[arg(
        long,
        value_name = "N",
        value_parser = whole::<u64>(1..=1_000_000_000),
        requires = "with_noise"
    )]
    touches: Option<u64>,
    /// Columns and rows of the sensor for noisy touches; default those of the model
    #[arg(long, value_name = "CxR", value_parser = parse_matrix, requires = "with_noise")]
    matrix: Option<MatrixSize>,
}

/// Parses probabilities that a taxel flips, such as `0:0.1:0.02`. Both ends must be valid for [`Noise::new`].
fn parse_noise_range(text: &str) -> Result<DecimalRange, String> {
    let range = parse_range(text)?;
    for value in [range.value(0), range.last()] {
        Noise::new(value).map_err(|error| error.to_string())?;
    }
    Ok(range)
}

fn parse_matrix(text: &str) -> Result<MatrixSize, &'static str> {
    let side = |text: &str| text.trim().parse::<u8>().ok();
    let size = text
        .split_once('x')
        .and_then(|(columns, rows)| MatrixSize::new(side(columns)?, side(rows)?).ok());
    size.ok_or("expected columns and rows from 1 to 64, such as 16x16")
}

impl NoiseFlags {
    fn size(&self, of_model: &Sensor) -> MatrixSize {
        self.matrix.unwrap_or(of_model.size())
    }

    pub(super) fn check(&self, of_model: &Sensor) -> Result<(), Failure> {
        let cells = narrow(self.size(of_model).cells());
        match self.dead.iter().find(|&&dead| dead > cells) {
            None => Ok(()),
            Some(dead) => Err(Failure::new(format!(
                "--dead {dead} is above {cells} (allowed: 0 to {cells}, the taxels of the matrix)"
            ))),
        }
    }

    pub(super) fn table(
        &self,
        noise: DecimalRange,
        model: &Model,
        asked: &Confusion,
        cx: &Context,
    ) -> Result<NoisyRates, Failure> {
        let size = self.size(model.sensor());
        if let Some(shape) = model.first_too_large(size) {
            let name = &model.shapes()[shape].name;
            let text = format!("{name}: none of its imprints fits on {size} taxels");
            return Err(Failure::new(text));
        }
        if let Some(text) = left_out(model, size).filter(|_| !asked.table.quiet) {
            cx.note(&text);
        }
        let dead = if self.dead.is_empty() {
            &[0][..]
        } else {
            &self.dead
        };
        let (each, seed) = (self.touches.unwrap_or(1000), asked.seed.unwrap_or_default());
        let given = asked.known();
        let noises: Vec<f64> = noise.values().collect();
        let rows = (noises.len() * dead.len()) as u64;
        let all = each * model.shapes().len() as u64 * rows;
        let mut rates = NoisyRates {
            rows: Vec::new(),
            size,
            seed,
            is_given: given.is_some(),
            is_weighted: model.shapes().iter().any(|shape| shape.weight > 1),
        };
        watched((all, "touches"), asked.table.quiet, cx, |progress| {
            for (dead, value) in dead
                .iter()
                .flat_map(|dead| noises.iter().map(move |own| (*dead, *own)))
            {
                let noise = Noise::new(value).ok()?;
                let mut touches = NoisyTouches::new(size, noise, each, seed);
                touches.random_dead = dead;
                let rate = match &given {
                    None => model.recognition_rate(&touches, &noise, progress),
                    Some(given) => given.rate(model, &touches, progress),
                };
                rates.rows.push(NoiseRow {
                    noise: value,
                    dead,
                    rate: rate?,
                });
            }
            Some(rates)
        })
    }
}

/// A note about the shapes whose imprints do not all fit on the matrix, with the share of their poses; None if all fit.
fn left_out(model: &Model, size: MatrixSize) -> Option<String> {
    let too_large = model.poses_too_large(size);
    let shapes = model.shapes().iter().zip(too_large);
    let parts = shapes
        .filter(|(_, poses)| *poses > 0)
        .map(|(shape, poses)| {
            let part = percent(share(poses.into(), model.poses().into()));
            format!("{part} of the poses of {}", shape.name)
        });
    let parts: Vec<String> = parts.collect();
    let text = || {
        format!(
            "left out, because they do not fit on {size}: {}",
            parts.join(", ")
        )
    };
    (!parts.is_empty()).then(text)
}

pub(super) struct NoisyRates {
    rows: Vec<NoiseRow>,
    size: MatrixSize,
    seed: u64,
    is_given: bool,
    is_weighted: bool,
}

struct NoiseRow {
    noise: f64,
    dead: u32,
    rate: RecognitionRate,
}

impl NoisyRates {
    /// A curve of the touches that are named right, for each number of dead taxels.
    fn curves(&self) -> Vec<(u32, Vec<(f64, f64)>)> {
        let groups = self.rows.chunk_by(|one, other| one.dead == other.dead);
        let points = |rows: &[NoiseRow]| {
            let points = rows.iter().map(|row| (row.noise, row.rate.accuracy));
            (rows[0].dead, points.collect())
        };
        groups.map(points).collect()
    }
}

impl Table for NoisyRates {
    fn text(&self, charset: Charset) -> String {
        const BAR: usize = 30;
        let mut rows = vec![row(["noise", "dead", "right", "held", "claimed"])];
        for NoiseRow { noise, dead, rate } in &self.rows {
            let error = 100.0 * rate.standard_error;
            rows.push(vec![
                noise.to_string(),
                dead.to_string(),
                format!("{} ± {error:.1}", percent(rate.accuracy)),
                percent(rate.held_share),
                percent(rate.mean_confidence),
                bar(rate.accuracy, BAR, charset),
            ]);
        }
        let touches = self.rows.first().map_or(0, |row| row.rate.touches);
        let held = match self.is_given {
            true => "values some shape has",
            false => "imprint some shape leaves",
        };
        let mut text = table(&rows, &[5], charset);
        text += &format!(
            "{} a row, seed {}\nheld: touches whose {held} without noise, too\n\
             claimed: the mean probability of the answers\n{}",
            counted(touches, "touch"),
            self.seed,
            if self.is_weighted { WEIGHTED } else { "" },
        );
        for (dead, points) in self.curves() {
            let curve = plot::lines("right", "noise", &points, charset);
            text += &match (curve.is_empty(), dead) {
                (true, _) => continue,
                (false, 0) => format!("\n{curve}"),
                (false, dead) => format!("\n{}\n{curve}", counted(dead, "dead taxel")),
            };
        }
        text
    }

    fn csv(&self) -> String {
        let mut text =
            String::from("noise,dead,touches,right,accuracy,standard_error,claimed,held\n");
        for NoiseRow { noise, dead, rate } in &self.rows {
            let (touches, right) = (rate.weighted_touches, rate.weighted_right);
            let (accuracy, error) = (rate.accuracy, rate.standard_error);
            let (claimed, held) = (rate.mean_confidence, rate.held_share);
            text +=
                &format!("{noise},{dead},{touches},{right},{accuracy},{error},{claimed},{held}\n");
        }
        text
    }

    fn json(&self) -> String {
        let rows = self.rows.iter().map(|NoiseRow { noise, dead, rate }| {
            json!({
                "noise": noise,
                "dead": dead,
                "touches": Count(rate.weighted_touches),
                "right": Count(rate.weighted_right),
                "accuracy": rate.accuracy,
                "standard_error": rate.standard_error,
                "claimed": rate.mean_confidence,
                "held": rate.held_share,
            })
        });
        let answer = json!({
            "columns": self.size.columns(),
            "rows": self.size.rows(),
            "seed": self.seed,
            "degradation": rows.collect::<Vec<_>>(),
        });
        json::text(&answer) + "\n"
    }

    fn svg(&self) -> Option<String> {
        let mut plot = Plot::from_zero("noise", "right");
        for (dead, points) in self.curves() {
            plot = plot.with_curve(&counted(dead, "dead taxel"), &points);
        }
        Some(plot.svg())
    }
}
