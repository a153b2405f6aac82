//! `taxel model separate`: its flags, and what these ask for.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Command, value_parser};

use crate::cli::arguments::flags::{
    EvaluationForm, form_of, jobs, json, parse_probability, parse_range, parse_report, quiet,
    range, replace,
};
use crate::cli::arguments::help::MODEL_SEPARATE_EXAMPLES;
use crate::cli::arguments::parameters;
use crate::cli::arguments::shape_set::{
    SetArguments, library_all, positions, set_arguments, shape,
};
use crate::pose::{Axis, DecimalRange};
use crate::recognition::SizeAxis;
use crate::storage::Existing;

/// A set of shapes, and the sizes and thresholds to look at.
#[derive(Clone, Debug)]
pub(crate) struct SeparateArguments {
    /// A model, or shapes as for training.
    pub(crate) set: SetArguments,
    pub(crate) axis: SizeAxis,
    /// Scales or pitches.
    pub(crate) sizes: DecimalRange,
    /// None for the threshold of the model, else of the default sensor.
    pub(crate) thresholds: Option<DecimalRange>,
    pub(crate) angles: Option<DecimalRange>,
    pub(crate) positions: Option<u8>,
    /// The error to reach.
    pub(crate) wanted: Option<f64>,
    /// Threads; 0 for as many as there are cores.
    pub(crate) jobs: usize,
    pub(crate) form: EvaluationForm,
    pub(crate) export: Option<PathBuf>,
    pub(crate) existing: Existing,
    pub(crate) quiet: bool,
}

/// `taxel model separate`.
pub(super) fn separate() -> Command {
    let what = Arg::new("set")
        .value_name("MODEL|FILE.jsonl|NAME")
        .num_args(0..)
        .value_parser(value_parser!(OsString))
        .help("A model, or shapes as for 'taxel model train'");
    // Their names are not those of the sensor's own flags, which take a number.
    let of_sizes = |name: &'static str, long: &'static str, help: &'static str| {
        Arg::new(name)
            .long(long)
            .value_name("RANGE")
            .value_parser(parse_range)
            .help(help)
    };
    let want = Arg::new("want")
        .long("want")
        .value_name("ERROR")
        .value_parser(parse_probability)
        .help("Find the smallest size with this error");
    let export = Arg::new("export")
        .long("export")
        .value_name("FILE")
        .value_parser(parse_report)
        .help("Write the numbers (.csv) or the curves\n(.svg, .png)");
    let csv = Arg::new("csv")
        .long("csv")
        .action(ArgAction::SetTrue)
        .conflicts_with("json")
        .help("Print a table of commas");
    Command::new("separate")
        .about("Find the sensor that tells the shapes apart")
        .override_usage("taxel model separate [OPTIONS] [MODEL|FILE.jsonl|NAME]...")
        .after_help(MODEL_SEPARATE_EXAMPLES)
        .args([what, shape(), library_all()])
        .group(
            ArgGroup::new("shapes")
                .args(["set", "shape", "library-all"])
                .multiple(true)
                .required(true),
        )
        .args([
            of_sizes(
                "range_scale",
                "scale",
                "Multiply all lengths by this; default 1",
            ),
            of_sizes(
                "range_pitch",
                "pitch",
                "Pitch in mm; lengths are in mm, too",
            )
            .conflicts_with("range_scale"),
            of_sizes(
                "range_threshold",
                "threshold",
                "Threshold; default the model's, or 0.5",
            ),
            range(Axis::Angle, "that of the model, or 0:359:1"),
            positions(),
            want,
        ])
        .group(
            ArgGroup::new("axes")
                .args(["range_scale", "range_pitch", "range_threshold"])
                .multiple(true)
                .required(true),
        )
        .args([export, replace(), jobs(), json(), csv, quiet()])
}

/// What the arguments of `taxel model separate` ask for.
pub(super) fn separate_arguments(matches: &ArgMatches) -> SeparateArguments {
    let range = |id: &str| matches.get_one::<DecimalRange>(id).copied();
    let (axis, sizes) = match range("range_pitch") {
        Some(pitch) => (SizeAxis::Pitch, Some(pitch)),
        None => (SizeAxis::Scale, range("range_scale")),
    };
    SeparateArguments {
        set: set_arguments(matches),
        axis,
        sizes: sizes.unwrap_or(DecimalRange::whole(1)),
        thresholds: range("range_threshold"),
        angles: range("range_angle"),
        positions: matches.get_one::<u8>("positions").copied(),
        wanted: matches.get_one("want").copied(),
        jobs: matches
            .get_one::<u16>("jobs")
            .map_or(0, |&jobs| jobs.into()),
        form: form_of(matches),
        export: matches.get_one::<PathBuf>("export").cloned(),
        existing: parameters::existing(matches),
        quiet: matches.get_flag("quiet"),
    }
}
