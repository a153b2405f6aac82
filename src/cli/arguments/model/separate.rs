//! The flags of `taxel model separate`, and how they are read.
//!
//! The command computes the error of a set for sizes of the shapes on the matrix and for thresholds of a taxel. Sizes
//! are given by `--scale` (all lengths times a factor, in cells) or by `--pitch` (lengths are in mm, cells have this
//! side in mm), thresholds by `--threshold`. Each is a range, `START:END:STEP`, or a single number:
//! ```text
//! taxel model separate figures --scale 0.5:1.5:0.1 --want 0.01
//! taxel model separate shapes.jsonl --pitch 1:4:0.5 --threshold 0.3:0.7:0.2
//! ```

use std::path::PathBuf;

use clap::{Arg, ArgGroup, ArgMatches, Command};

use crate::cli::arguments::flags::{
    self, EvaluationForm, jobs, json, option, parse_probability, parse_range, quiet, range,
    replace, report, switch,
};
use crate::cli::arguments::help::MODEL_SEPARATE_EXAMPLES;
use crate::cli::arguments::model::shape_set::{self, SetArguments};
use crate::cli::error::CliError;
use crate::parameter::number::short;
use crate::pose::{Axis, DecimalRange};
use crate::recognition::{CellPositions, SizeAxis};
use crate::storage::Existing;

#[derive(Clone, Debug)]
pub(crate) struct SeparateArguments {
    pub(crate) set: SetArguments,
    pub(crate) axis: SizeAxis,
    /// Scales, or pitches in mm; a scale of 1 if neither is given.
    pub(crate) sizes: DecimalRange,
    /// The coverages from which a taxel is active; None for the threshold of the model, or else of the default
    /// sensor.
    pub(crate) thresholds: Option<DecimalRange>,
    /// The angles in degrees; None for those of the model, or else a whole turn in steps of 1.
    pub(crate) angles: Option<DecimalRange>,
    /// Positions per cell along x and y; None for those of the model, or else 100.
    pub(crate) positions: Option<CellPositions>,
    pub(crate) wanted: Option<f64>,
    pub(crate) jobs: usize,
    pub(crate) form: EvaluationForm,
    pub(crate) export: Option<PathBuf>,
    pub(crate) existing: Existing,
    pub(crate) quiet: bool,
}

pub(super) fn command() -> Command {
    let want = option(
        "want",
        "ERROR",
        "Find the smallest scale, or the coarsest pitch,\nwith at most this error (0 to 1)",
    )
    .value_parser(parse_probability);
    let export = option(
        "export",
        "FILE",
        "Write the numbers (.csv) or the curves\n(.svg)",
    )
    .value_parser(report());
    let csv = switch("csv", "Print comma-separated values").conflicts_with("json");
    let axes = ["range_scale", "range_pitch", "range_threshold"];
    Command::new("separate")
        .about("Find how fine a sensor must be to tell the shapes apart")
        .override_usage("taxel model separate [OPTIONS] <--scale|--pitch|--threshold> [MODEL]...")
        .after_help(MODEL_SEPARATE_EXAMPLES)
        .args(shape_set::args(
            "MODEL|FILE.jsonl|NAME",
            "A model, or shapes as for 'taxel model train'",
        ))
        .group(shape_set::group())
        .args(sizes())
        .args([
            range(Axis::Angle, "that of the model, or 0:359:1"),
            shape_set::positions()
                .help("Positions per cell along x and y;\ndefault those of the model, or 100"),
            want,
        ])
        .group(
            ArgGroup::new("axes")
                .args(axes)
                .multiple(true)
                .required(true),
        )
        .args([
            export,
            replace().requires("export"),
            jobs(),
            json(),
            csv,
            quiet(),
        ])
}

/// Defines `--scale`, `--pitch` and `--threshold`. Their ids differ from those of the sensor's own flags, which take
/// a number.
fn sizes() -> [Arg; 3] {
    let flag = |id: &'static str, long: &'static str, help: &'static str| {
        Arg::new(id)
            .long(long)
            .value_name("RANGE")
            .value_parser(parse_range)
            .help(help)
    };
    [
        flag(
            "range_scale",
            "scale",
            "Multiply all lengths by this; one of --scale,\n--pitch and --threshold is required",
        ),
        flag(
            "range_pitch",
            "pitch",
            "Pitch in mm; lengths are in mm, too",
        )
        .conflicts_with("range_scale"),
        flag(
            "range_threshold",
            "threshold",
            "Threshold; default the model's, or 0.5",
        ),
    ]
}

impl SeparateArguments {
    pub(super) fn of(matches: &ArgMatches) -> Result<Self, CliError> {
        let range = |id: &str| matches.get_one::<DecimalRange>(id).copied();
        for (id, flag, most, allowed) in [
            ("range_scale", "scale", f64::MAX, "above 0"),
            ("range_pitch", "pitch", 1000.0, "above 0, up to 1000"),
            ("range_threshold", "threshold", 1.0, "above 0, up to 1"),
        ] {
            let ends = range(id).map(|range| [range.value(0), range.last()]);
            let wrong = |value: &f64| *value <= 0.0 || *value > most;
            if let Some(value) = ends.into_iter().flatten().find(wrong) {
                return Err(CliError::Range {
                    flag: flag.to_owned(),
                    text: short(value),
                    complaint: format!("is out of range (allowed: {allowed})"),
                });
            }
        }
        let (axis, sizes) = match range("range_pitch") {
            Some(pitch) => (SizeAxis::Pitch, Some(pitch)),
            None => (SizeAxis::Scale, range("range_scale")),
        };
        Ok(Self {
            set: SetArguments::of(matches),
            axis,
            sizes: sizes.unwrap_or(DecimalRange::whole(1)),
            thresholds: range("range_threshold"),
            angles: range("range_angle"),
            positions: matches.get_one::<CellPositions>("positions").copied(),
            wanted: matches.get_one("want").copied(),
            jobs: flags::jobs_of(matches),
            form: EvaluationForm::of(matches),
            export: matches.get_one::<PathBuf>("export").cloned(),
            existing: flags::existing(matches),
            quiet: matches.get_flag("quiet"),
        })
    }
}
