//! The flags of `taxel model` and its subcommands.
//!
//! A model is named as in `taxel recognise --model`: a built-in set such as `figures` ([`DEFAULT_MODEL`]) takes
//! precedence over a model of the library, and that over a file.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Command, value_parser};
use taxel_core::index::wide;
use taxel_core::parameter::Parameter;
use taxel_core::parameter::number::short;
use taxel_core::pose::{Anchor, Axis, DecimalRange, GivenRanges, SensorSides};
use taxel_core::recognition::{
    CellPositions, Classifier, ClassifierSettings, GivenDescriptors, LEAST_SIDE, Noise, Rounding,
    SizeAxis,
};
use taxel_core::sensor::{MatrixSize, Sensor};
use taxel_core::sweep::Shard;
use taxel_files::formats::Name;
use taxel_files::formats::file::has_ending;
use taxel_files::memory::MemorySize;
use taxel_files::storage::Existing;

use crate::cli::arguments::flags::{
    self, EvaluationForm, Given, anchor, jobs, json, memory, name_or_path, number_of, of_sensor,
    option, parse_probability, parse_range, quiet, range, replace, report, required, seed, shard,
    switch, unhandled_subcommand, which_model, whole,
};
use crate::cli::arguments::help::{
    MODEL_CONFUSION_EXAMPLES, MODEL_DELETE_EXAMPLES, MODEL_EXAMPLES, MODEL_LIST_EXAMPLES,
    MODEL_SEPARATE_EXAMPLES, MODEL_SHOW_EXAMPLES, MODEL_TOUCHES_EXAMPLES, MODEL_TRAIN_EXAMPLES,
};
use crate::cli::error::CliError;

/// The model that is used if none is named: the seven figures at their default sizes.
pub(crate) const DEFAULT_MODEL: &str = "figures";

#[derive(Clone, Debug)]
pub(crate) enum ModelRequest {
    Train(Box<TrainArguments>),
    Show(OsString, bool),
    List(bool),
    Delete(Name),
    Confusion(Box<ConfusionArguments>),
    Touches(TouchesArguments),
    Separate(Box<SeparateArguments>),
}

impl ModelRequest {
    pub(super) fn of(matches: &ArgMatches) -> Result<Self, CliError> {
        let Some((command, own)) = matches.subcommand() else {
            // clap requires a subcommand, so there is always one.
            return Err(unhandled_subcommand("model"));
        };
        Ok(match command {
            "train" => Self::Train(Box::new(TrainArguments::of(own)?)),
            "show" => Self::Show(flags::word(own, "model"), own.get_flag("json")),
            "delete" => Self::Delete(required(own, "name")?),
            "touches" => Self::Touches(TouchesArguments::of(own)),
            "confusion" => Self::Confusion(Box::new(ConfusionArguments::of(own)?)),
            "separate" => Self::Separate(Box::new(SeparateArguments::of(own)?)),
            "list" => Self::List(own.get_flag("json")),
            other => return Err(unhandled_subcommand(other)),
        })
    }
}

pub(super) fn command() -> Command {
    let show = Command::new("show")
        .about("Show what a model was trained on, and its error")
        .after_help(MODEL_SHOW_EXAMPLES)
        .args([which_model(), json()]);
    let list = Command::new("list")
        .about("List the models")
        .after_help(MODEL_LIST_EXAMPLES)
        .arg(json());
    let delete = Command::new("delete")
        .about("Delete a model")
        .after_help(MODEL_DELETE_EXAMPLES)
        .arg(flags::name("Name of the model"));
    Command::new("model")
        .about("Train models, and measure how well one touch tells shapes apart")
        .after_help(MODEL_EXAMPLES)
        .subcommand_required(true)
        .subcommand(train())
        .subcommand(show)
        .subcommand(list)
        .subcommand(delete)
        .subcommand(confusion())
        .subcommand(touches())
        .subcommand(separate())
}

#[derive(Clone, Debug)]
pub(crate) struct SetArguments {
    pub(crate) what: Vec<OsString>,
    pub(crate) library_all: bool,
}

impl SetArguments {
    fn of(matches: &ArgMatches) -> Self {
        let what = matches.get_many::<OsString>("set").into_iter().flatten();
        Self {
            what: what.cloned().collect(),
            library_all: matches.get_flag("library-all"),
        }
    }
}

fn set_flags(value: &'static str, help: &'static str) -> [Arg; 2] {
    let what = Arg::new("set")
        .value_name(value)
        .num_args(0..)
        .value_parser(name_or_path())
        .help(help);
    let all = switch("library-all", "All shapes of the library");
    [what, all]
}

fn set_group() -> ArgGroup {
    ArgGroup::new("shapes")
        .args(["set", "library-all"])
        .multiple(true)
        .required(true)
}

fn positions() -> Arg {
    option(
        "positions",
        "N",
        "Positions per cell along x and y; default 100",
    )
    .value_parser(parse_positions)
    .help_heading("Grid")
}

/// Parses a number of positions per cell. Their distance must be a whole number of hundredths of a cell, since ranges
/// are exact in hundredths. Angles have ranges of their own.
fn parse_positions(text: &str) -> Result<CellPositions, &'static str> {
    let number = text.trim().parse::<u8>().ok();
    number
        .and_then(CellPositions::new)
        .ok_or("expected 1, 2, 4, 5, 10, 20, 25, 50 or 100")
}

#[derive(Clone, Debug)]
pub(crate) struct TrainArguments {
    pub(crate) set: SetArguments,
    /// The point of a shape that x0 and y0 place; None for the corner if x0 or y0 is given, else the centre.
    pub(crate) anchor: Option<Anchor>,
    /// The axes of the grid that are given. The others are chosen so that the sensor does not cut off any shape.
    pub(crate) ranges: GivenRanges,
    pub(crate) positions: Option<CellPositions>,
    /// The sides of the sensor that are given. The others are chosen so that it does not cut off any shape.
    pub(crate) sides: SensorSides,
    pub(crate) given: Given,
    pub(crate) shard: Shard,
    pub(crate) jobs: usize,
    /// The most memory that the training may use, if given.
    pub(crate) memory: Option<MemorySize>,
    /// Whether poses at which the sensor cuts a shape off are learned too; otherwise they are an error.
    pub(crate) allow_cut: bool,
    pub(crate) to: ModelTarget,
    pub(crate) existing: Existing,
    pub(crate) json: bool,
    pub(crate) quiet: bool,
}

#[derive(Clone, Debug)]
pub(crate) enum ModelTarget {
    File(PathBuf),
    Named(Name),
}

fn train() -> Command {
    let out = option("out", "FILE.npz", "Write the model to this file")
        .value_parser(value_parser!(PathBuf));
    let name = option(
        "name",
        "NAME",
        "Keep the model under this name, in the library",
    )
    .value_parser(Name::new);
    let allow_cut = switch("allow-cut", "Also take poses that the sensor cuts off");
    let anchor = anchor().help(
        "Point that x0 and y0 place: corner or centre;\n\
         default corner with --x0 or --y0, else centre",
    );
    Command::new("train")
        .about("Learn every imprint of a set of shapes")
        .override_usage("taxel model train [OPTIONS] <--out FILE|--name NAME> [FILE|NAME]...")
        .after_help(MODEL_TRAIN_EXAMPLES)
        .args(set_flags(
            "FILE.jsonl|NAME",
            "Shapes: files of JSON lines, '-' for standard input,\nor names of the library",
        ))
        .args([out, name])
        .group(set_group())
        .group(ArgGroup::new("target").args(["out", "name"]).required(true))
        .args(Axis::ALL.map(|axis| match axis {
            Axis::X0 | Axis::Y0 => range(axis, "one cell in which no shape is cut off"),
            _ => range(axis, ""),
        }))
        .arg(positions())
        .arg(anchor)
        .args([Parameter::Columns, Parameter::Rows].map(fitting))
        .args(of_sensor(&[Parameter::Threshold]))
        .args([
            allow_cut,
            jobs(),
            memory(),
            shard(),
            replace(),
            json(),
            quiet(),
        ])
}

fn fitting(side: Parameter) -> Arg {
    flags::arg_fitting(side).help_heading("Sensor")
}

impl TrainArguments {
    fn of(matches: &ArgMatches) -> Result<Self, CliError> {
        let given = Given::of(matches);
        let sensor = given.sensor(Sensor::default())?;
        let sides = SensorSides {
            columns: given.has(Parameter::Columns).then(|| sensor.columns()),
            rows: given.has(Parameter::Rows).then(|| sensor.rows()),
            ..SensorSides::at_least(LEAST_SIDE)
        };
        let to = match matches.get_one::<Name>("name") {
            Some(name) => ModelTarget::Named(name.clone()),
            None => ModelTarget::File(matches.get_one("out").cloned().unwrap_or_default()),
        };
        if let ModelTarget::File(path) = &to {
            model_file(path)?;
        }
        let ranges = flags::ranges_of(matches);
        let positions = matches.get_one::<CellPositions>("positions").copied();
        if positions.is_some() && ranges[Axis::X0].is_some() && ranges[Axis::Y0].is_some() {
            let (flag, reason) = ("positions", "with both --x0 and --y0".to_owned());
            return Err(CliError::Unused { flag, reason });
        }
        Ok(Self {
            set: SetArguments::of(matches),
            anchor: matches.get_one::<Anchor>("anchor").copied(),
            ranges,
            positions,
            sides,
            given,
            shard: flags::shard_of(matches),
            jobs: flags::jobs_of(matches),
            memory: flags::memory_of(matches),
            allow_cut: matches.get_flag("allow-cut"),
            to,
            existing: flags::existing(matches),
            json: matches.get_flag("json"),
            quiet: matches.get_flag("quiet"),
        })
    }
}

/// Refuses a file name without the extension of a model: such a file would be taken for something else when it is
/// read.
pub(crate) fn model_file(path: &Path) -> Result<(), CliError> {
    if has_ending(path, "npz") {
        return Ok(());
    }
    Err(CliError::Ending {
        name: path.to_string_lossy().into_owned(),
        what: "a model",
        expected: ".npz",
    })
}

#[derive(Clone, Debug)]
pub(crate) struct TouchesArguments {
    pub(crate) model: OsString,
    pub(crate) until: f64,
    pub(crate) runs: u64,
    pub(crate) seed: u64,
    pub(crate) json: bool,
    pub(crate) quiet: bool,
}

fn touches() -> Command {
    let until = option(
        "until",
        "P",
        "How probable one shape must be (0 to 1); default 0.99",
    )
    .value_parser(parse_probability)
    .default_value("0.99")
    .hide_default_value(true);
    // The length of each run is kept until the mean is known: up to 120 MB.
    let runs = option("runs", "N", "Runs of each shape; default 10000")
        .value_parser(whole::<u64>(1..=10_000_000))
        .default_value("10000")
        .hide_default_value(true);
    Command::new("touches")
        .about("Simulate how many touches it takes to name a shape")
        .after_help(MODEL_TOUCHES_EXAMPLES)
        .args([which_model(), until, runs, seed(), json(), quiet()])
}

impl TouchesArguments {
    fn of(matches: &ArgMatches) -> Self {
        Self {
            model: flags::word(matches, "model"),
            until: number_of(matches, "until", 0.99),
            runs: number_of(matches, "runs", 10_000),
            seed: number_of(matches, "seed", 0),
            json: matches.get_flag("json"),
            quiet: matches.get_flag("quiet"),
        }
    }
}

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

fn separate() -> Command {
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
        .args(set_flags(
            "MODEL|FILE.jsonl|NAME",
            "A model, or shapes as for 'taxel model train'",
        ))
        .group(set_group())
        .args(sizes())
        .args([
            range(Axis::Angle, "that of the model, or 0:359:1"),
            positions()
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
    fn of(matches: &ArgMatches) -> Result<Self, CliError> {
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

#[derive(Clone, Debug)]
pub(crate) struct ConfusionArguments {
    pub(crate) model: OsString,
    pub(crate) of: Evaluated,
    pub(crate) roundings: Vec<Rounding>,
    pub(crate) classifiers: ClassifierSettings,
    pub(crate) form: EvaluationForm,
    pub(crate) export: Option<PathBuf>,
    pub(crate) existing: Existing,
    pub(crate) quiet: bool,
}

#[derive(Clone, Debug)]
pub(crate) enum Evaluated {
    Imprints,
    Given(GivenDescriptors),
    Greedy,
    Pairs,
    Classifier(Classifier),
    AllClassifiers,
    Noise(NoiseArguments),
}

#[derive(Clone, Debug)]
pub(crate) struct NoiseArguments {
    pub(crate) noise: DecimalRange,
    pub(crate) dead: Vec<u32>,
    /// The descriptors that are known in place of the imprint.
    pub(crate) given: Option<GivenDescriptors>,
    pub(crate) touches: u64,
    pub(crate) seed: u64,
    /// Columns and rows of the matrix; None for those of the model's sensor.
    pub(crate) size: Option<MatrixSize>,
}

fn confusion() -> Command {
    Command::new("confusion")
        .about("Show which shapes one touch confuses, and the limit of any method")
        .after_help(MODEL_CONFUSION_EXAMPLES)
        .arg(which_model())
        .args(questions())
        .group(ArgGroup::new("descriptors").args(["given", "greedy"]))
        .group(ArgGroup::new("of").args(["greedy", "pairs", "classifier", "noise"]))
        .groups([
            flags::alone("with_classifier", "classifier"),
            flags::alone("with_noise", "noise"),
            flags::alone("with_export", "export"),
        ])
        .group(
            ArgGroup::new("not_given")
                .args(["greedy", "pairs"])
                .conflicts_with("given"),
        )
        .arg(
            option(
                "round",
                "KEY=STEP",
                "Round a descriptor to steps, such as cg_cd=0.01",
            )
            .action(ArgAction::Append)
            .value_parser(str::parse::<Rounding>)
            .requires("descriptors")
            .conflicts_with("classifier"),
        )
        .args(of_classifiers())
        .arg(seed())
        .args(output())
        .args(noisy())
}

fn questions() -> [Arg; 4] {
    let classifiers = Classifier::ALL.iter().map(|own| own.name()).chain(["all"]);
    [
        option(
            "given",
            "KEY,...",
            "Use only these descriptors, such as na,p",
        )
        .value_parser(str::parse::<GivenDescriptors>),
        switch("greedy", "Choose descriptors one by one until none helps"),
        switch(
            "pairs",
            "Print the error for each pair of shapes, by itself",
        ),
        option(
            "classifier",
            "NAME",
            "Another way to name shapes: z, knn, template, or\nall of them in a table",
        )
        .value_parser(PossibleValuesParser::new(classifiers))
        .hide_possible_values(true),
    ]
}

fn of_classifiers() -> [Arg; 3] {
    [
        ("neighbours", "Neighbours that vote in knn; default 1"),
        ("sample", "Poses of each shape that knn draws; default 2000"),
        (
            "templates",
            "Imprints of each shape for template; default 100",
        ),
    ]
    .map(|(name, help)| {
        option(name, "N", help)
            .value_parser(whole::<u32>(1..))
            .requires("with_classifier")
    })
}

fn output() -> [Arg; 5] {
    let export = option("export", "FILE", "Write the matrix as .csv or .svg")
        .value_parser(report())
        .conflicts_with_all(["greedy", "pairs"]);
    let csv = switch("csv", "Print comma-separated values")
        .conflicts_with_all(["json", "greedy", "pairs"]);
    let force = replace().requires("with_export");
    [export, force, json(), quiet(), csv]
}

fn noisy() -> [Arg; 4] {
    let noise = option(
        "noise",
        "START:END:STEP",
        "Test touches whose taxels flip with this\nprobability",
    )
    .value_parser(parse_noise_range);
    let dead = option(
        "dead",
        "N,...",
        "Also test with N dead taxels, drawn anew for\neach touch; default 0",
    )
    .value_delimiter(',')
    .value_parser(whole::<u32>(0..=4095));
    let touches = option("touches", "N", "Noisy touches of each shape; default 1000")
        .value_parser(whole::<u64>(1..=1_000_000_000));
    let matrix = option(
        "matrix",
        "CxR",
        "Columns and rows of the sensor for noisy\ntouches; default those of the model",
    )
    .value_parser(parse_matrix);
    let [dead, touches, matrix] = [dead, touches, matrix].map(|arg| arg.requires("with_noise"));
    [noise, dead, touches, matrix].map(|arg| arg.help_heading("Noise"))
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
    let expected = "expected columns and rows from 1 to 64, such as 16x16";
    let (columns, rows) = text.split_once('x').ok_or(expected)?;
    let side = |text: &str| text.trim().parse().map_err(|_| expected);
    MatrixSize::new(side(columns)?, side(rows)?).map_err(|_| expected)
}

impl ConfusionArguments {
    fn of(matches: &ArgMatches) -> Result<Self, CliError> {
        check_classifier(matches)?;
        check_roundings(matches)?;
        let roundings = matches.get_many::<Rounding>("round").into_iter().flatten();
        let (of, export) = (Evaluated::of(matches), matches.get_one::<PathBuf>("export"));
        if let (Evaluated::AllClassifiers, Some(path)) = (&of, export)
            && !has_ending(path, "csv")
        {
            return Err(CliError::Ending {
                name: path.to_string_lossy().into_owned(),
                what: "the table of all classifiers",
                expected: ".csv",
            });
        }
        Ok(Self {
            model: flags::word(matches, "model"),
            of,
            roundings: roundings.copied().collect(),
            classifiers: classifiers(matches),
            form: EvaluationForm::of(matches),
            export: export.cloned(),
            existing: flags::existing(matches),
            quiet: matches.get_flag("quiet"),
        })
    }
}

fn check_classifier(matches: &ArgMatches) -> Result<(), CliError> {
    let name = matches.get_one::<String>("classifier").map(String::as_str);
    let is = |one: &str| name.is_some_and(|name| name == one || name == "all");
    let is_drawn = is("knn") || matches.contains_id("noise");
    let given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
    let unused = |flag, reason: String| Err(CliError::Unused { flag, reason });
    for (flag, has_effect) in [
        ("neighbours", is("knn")),
        ("sample", is("knn")),
        ("templates", is("template")),
        ("given", name != Some("template")),
    ] {
        if let Some(name) = name.filter(|_| given(flag) && !has_effect) {
            return unused(flag, format!("with --classifier {name}"));
        }
    }
    if given("seed") && !is_drawn {
        let reason = "without --noise or --classifier knn, which draw touches".to_owned();
        return unused("seed", reason);
    }
    Ok(())
}

fn check_roundings(matches: &ArgMatches) -> Result<(), CliError> {
    let roundings = matches.get_many::<Rounding>("round").into_iter().flatten();
    let keys: Vec<_> = roundings.map(|rounding| rounding.descriptor).collect();
    let given = matches.get_one::<GivenDescriptors>("given");
    for (index, key) in keys.iter().enumerate() {
        let name = key.key();
        let reason = if keys[..index].contains(key) {
            format!("for {name}, which has a step already")
        } else if given.is_some_and(|given| !given.descriptors.contains(key)) {
            format!("for {name}, which --given does not name")
        } else {
            continue;
        };
        let flag = "round";
        return Err(CliError::Unused { flag, reason });
    }
    Ok(())
}

impl Evaluated {
    /// Returns the question of the flags; without one, it is about whole imprints. clap makes sure that there is at
    /// most one.
    fn of(matches: &ArgMatches) -> Self {
        if let Some(name) = matches.get_one::<String>("classifier") {
            return name.parse().map_or(Self::AllClassifiers, Self::Classifier);
        }
        if let Some(&noise) = matches.get_one::<DecimalRange>("noise") {
            return Self::Noise(NoiseArguments::of(matches, noise));
        }
        if let Some(given) = matches.get_one::<GivenDescriptors>("given") {
            return Self::Given(given.clone());
        }
        match (matches.get_flag("greedy"), matches.get_flag("pairs")) {
            (true, _) => Self::Greedy,
            (false, true) => Self::Pairs,
            (false, false) => Self::Imprints,
        }
    }
}

impl NoiseArguments {
    fn of(matches: &ArgMatches, noise: DecimalRange) -> Self {
        let dead = matches.get_many::<u32>("dead");
        Self {
            noise,
            dead: dead.map_or_else(|| vec![0], |dead| dead.copied().collect()),
            given: matches.get_one("given").cloned(),
            touches: number_of(matches, "touches", 1000),
            seed: number_of(matches, "seed", 0),
            size: matches.get_one("matrix").copied(),
        }
    }
}

fn classifiers(matches: &ArgMatches) -> ClassifierSettings {
    let mut classifiers = ClassifierSettings::default();
    let limit = |id: &str, usual: usize| {
        let own = matches.get_one::<u32>(id);
        own.map_or(usual, |&number| wide(number))
    };
    classifiers.neighbours = limit("neighbours", classifiers.neighbours);
    classifiers.sample = limit("sample", classifiers.sample);
    classifiers.templates = limit("templates", classifiers.templates);
    classifiers.seed = number_of(matches, "seed", classifiers.seed);
    let given = matches.get_one::<GivenDescriptors>("given");
    classifiers.descriptors = given.map(|given| given.descriptors.clone());
    classifiers
}
