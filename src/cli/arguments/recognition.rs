//! `taxel model` and `taxel recognise`: their flags, and what these ask for. Longer than most files, so that a flag and
//! the field that it fills stand together.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Command, value_parser};

use crate::cli::arguments::flags::{
    EvaluationForm, anchor, form_of, jobs, json, of_sensor, parse_name, parse_probability,
    parse_report, quiet, range, replace, sensor_of_imprints, shard, what,
};
use crate::cli::arguments::help::{
    MODEL_CONFUSION_EXAMPLES, MODEL_DELETE_EXAMPLES, MODEL_EXAMPLES, MODEL_LIST_EXAMPLES,
    MODEL_SHOW_EXAMPLES, MODEL_TOUCHES_EXAMPLES, MODEL_TRAIN_EXAMPLES, RECOGNISE_EXAMPLES,
};
use crate::cli::arguments::parameters::{self, Given};
use crate::cli::arguments::separation::{SeparateArguments, separate, separate_arguments};
use crate::cli::arguments::shape_set::{
    SetArguments, library_all, positions, set_arguments, shape,
};
use crate::cli::error::CliError;
use crate::formats::Name;
use crate::parameter::Parameter;
use crate::pose::{Anchor, Axis, DecimalRange, GivenRanges, RangeError};
use crate::recognition::{
    GivenDescriptors, GivenError, Noise, NoiseError, Peer, PeerSettings, Rounding,
};
use crate::sensor::Sensor;
use crate::storage::Existing;
use crate::sweep::Shard;

/// The model that is used if none is named: the seven figures at their default sizes.
pub(crate) const DEFAULT_MODEL: &str = "figures";

/// What is asked of models.
#[derive(Clone, Debug)]
pub(crate) enum ModelRequest {
    /// To train one.
    Train(Box<TrainArguments>),
    /// To show its card; as JSON or not.
    Show(OsString, bool),
    /// To list those beside the library; as JSON or not.
    List(bool),
    /// To delete one of these.
    Delete(Name),
    /// To evaluate it.
    Confusion(Box<ConfusionArguments>),
    /// To simulate how many touches it takes.
    Touches(TouchesArguments),
    /// To look at its error against size and threshold.
    Separate(Box<SeparateArguments>),
}

/// A set of shapes, how to train it, and where the model goes.
#[derive(Clone, Debug)]
pub(crate) struct TrainArguments {
    pub(crate) set: SetArguments,
    pub(crate) anchor: Option<Anchor>,
    pub(crate) ranges: GivenRanges,
    /// Positions of a cell in each direction, where its range is not given.
    pub(crate) positions: Option<u8>,
    /// The sensor, if its columns or rows are given; otherwise the smallest one, changed by the other values.
    pub(crate) sensor: Option<Sensor>,
    /// The values of the sensor's flags.
    pub(crate) given: Given,
    pub(crate) shard: Shard,
    /// Threads; 0 for as many as there are cores.
    pub(crate) jobs: usize,
    pub(crate) allow_cut: bool,
    pub(crate) to: ModelTarget,
    pub(crate) existing: Existing,
    pub(crate) json: bool,
    pub(crate) quiet: bool,
}

/// Where a model goes.
#[derive(Clone, Debug)]
pub(crate) enum ModelTarget {
    /// Into a file.
    File(PathBuf),
    /// Beside the library, under a name.
    Named(Name),
}

/// What is evaluated of a model, and how it is shown.
#[derive(Clone, Debug)]
pub(crate) struct ConfusionArguments {
    pub(crate) model: OsString,
    pub(crate) of: Evaluated,
    pub(crate) roundings: Vec<Rounding>,
    pub(crate) peers: PeerSettings,
    pub(crate) form: EvaluationForm,
    pub(crate) export: Option<PathBuf>,
    pub(crate) existing: Existing,
}

/// Noisy touches to simulate.
#[derive(Clone, Debug)]
pub(crate) struct NoiseArguments {
    pub(crate) noise: DecimalRange,
    /// Numbers of dead taxels.
    pub(crate) dead: Vec<u32>,
    /// Touches of each shape.
    pub(crate) touches: u64,
    pub(crate) seed: u64,
    /// Columns and rows of the matrix; those of the model's sensor if not given.
    pub(crate) size: Option<(u8, u8)>,
    pub(crate) quiet: bool,
}

/// How many touches it takes until a shape is probable enough.
#[derive(Clone, Debug)]
pub(crate) struct TouchesArguments {
    pub(crate) model: OsString,
    pub(crate) until: f64,
    /// Runs of each shape.
    pub(crate) runs: u64,
    pub(crate) seed: u64,
    pub(crate) json: bool,
    pub(crate) quiet: bool,
}

/// Who names the shapes.
#[derive(Clone, Debug)]
pub(crate) enum Evaluated {
    /// The best classifier, from the whole imprint.
    Imprints,
    /// The best one from some descriptors.
    Given(GivenDescriptors),
    /// The same, with descriptors chosen one by one.
    Greedy,
    /// The best one, for each pair of shapes.
    Pairs,
    /// A peer.
    Peer(Peer),
    /// All peers, in a table.
    AllPeers,
    /// The best one, from noisy touches.
    Noise(NoiseArguments),
    /// The best one, from touches between the poses of the model.
    HalfStep,
}

/// What is to be recognised, and how.
#[derive(Clone, Debug)]
pub(crate) struct RecogniseArguments {
    pub(crate) what: OsString,
    pub(crate) model: OsString,
    /// How many shapes of the ranking are shown.
    pub(crate) top: Option<usize>,
    /// The least probability of an answer.
    pub(crate) reject: Option<f64>,
    /// The answer that is expected.
    pub(crate) expect: Option<String>,
    /// The probability that a taxel flips.
    pub(crate) noise: Option<Noise>,
    /// An imprint of the dead taxels.
    pub(crate) mask: Option<OsString>,
    /// Whether to say where the shape lies.
    pub(crate) pose: bool,
    /// In mm, for that.
    pub(crate) pitch_mm: Option<f64>,
    pub(crate) json: bool,
}

/// `taxel model` with its own subcommands.
pub(super) fn model() -> Command {
    let command = |name: &'static str, about: &'static str, examples: &'static str| {
        Command::new(name).about(about).after_help(examples)
    };
    Command::new("model")
        .about("Train models of shapes, and see what one touch can tell")
        .after_help(MODEL_EXAMPLES)
        .subcommand_required(true)
        .subcommand(train())
        .subcommand(
            command("show", "Show the card of a model", MODEL_SHOW_EXAMPLES)
                .args([which_model(), json()]),
        )
        .subcommand(command("list", "List the models", MODEL_LIST_EXAMPLES).arg(json()))
        .subcommand(
            command("delete", "Delete a model", MODEL_DELETE_EXAMPLES).arg(
                Arg::new("name")
                    .value_name("NAME")
                    .required(true)
                    .value_parser(parse_name)
                    .help("Which model"),
            ),
        )
        .subcommand(confusion())
        .subcommand(touches())
        .subcommand(separate())
}

/// `taxel model train`.
fn train() -> Command {
    let what = Arg::new("set")
        .value_name("FILE.jsonl|NAME")
        .num_args(0..)
        .value_parser(value_parser!(OsString))
        .help("Shapes: lines of JSON, '-' for standard input, or names\nof the library");
    let out = Arg::new("out")
        .long("out")
        .value_name("FILE.npz")
        .value_parser(value_parser!(PathBuf))
        .help("Write the model to this file");
    let name = Arg::new("name")
        .long("name")
        .value_name("NAME")
        .value_parser(parse_name)
        .help("Keep the model under this name, beside the library");
    let allow_cut = Arg::new("allow-cut")
        .long("allow-cut")
        .action(ArgAction::SetTrue)
        .help("Take poses that the sensor cuts off, too");
    Command::new("train")
        .override_usage(
            "taxel model train [OPTIONS] <--out FILE.npz|--name NAME> [FILE.jsonl|NAME]...",
        )
        .about("Learn every imprint of a set of shapes")
        .override_usage("taxel model train [OPTIONS] <--out FILE|--name NAME> [FILE|NAME]...")
        .after_help(MODEL_TRAIN_EXAMPLES)
        .args([what, shape(), library_all(), out, name])
        .group(
            ArgGroup::new("shapes")
                .args(["set", "shape", "library-all"])
                .multiple(true)
                .required(true),
        )
        .group(ArgGroup::new("target").args(["out", "name"]).required(true))
        .args(Axis::ALL.map(|axis| match axis {
            Axis::X0 | Axis::Y0 => range(axis, "one cell in which no shape is cut off"),
            _ => range(axis, ""),
        }))
        .arg(positions())
        .arg(anchor().help("What x0 and y0 place: corner or centre; default\ncorner where one of them is given, else centre"))
        .args(sensor_of_imprints())
        .args([allow_cut, jobs(), shard(), replace(), json(), quiet()])
}

/// `taxel model confusion`.
fn confusion() -> Command {
    let given = Arg::new("given")
        .long("given")
        .value_name("KEY,...")
        .value_parser(parse_given)
        .help("As if only these descriptors were known: na,p");
    let flag = |name: &'static str, help: &'static str| {
        Arg::new(name)
            .long(name)
            .action(ArgAction::SetTrue)
            .help(help)
    };
    let round = Arg::new("round")
        .long("round")
        .value_name("KEY=STEP")
        .action(ArgAction::Append)
        .value_parser(parse_rounding)
        .requires("descriptors")
        .help("Measure a descriptor in steps: cg_cd=0.01");
    let classifier = Arg::new("classifier")
        .long("classifier")
        .value_name("NAME")
        .value_parser(clap::builder::PossibleValuesParser::new(
            Peer::ALL.map(Peer::name).into_iter().chain(["all"]),
        ))
        .hide_possible_values(true)
        .help("Another way to name shapes: z, diagonal, lda, qda,\nknn, template, or all of them in a table");
    let number = |name: &'static str, help: &'static str| {
        Arg::new(name)
            .long(name)
            .value_name("N")
            .value_parser(value_parser!(u32).range(1..))
            .requires("classifier")
            .help(help)
    };
    let export = Arg::new("export")
        .long("export")
        .value_name("FILE")
        .value_parser(parse_report)
        .conflicts_with_all(["greedy", "pairs", "noise", "test"])
        .help("Write the matrix as .csv, .svg or .png");
    Command::new("confusion")
        .about("Show which shapes one touch confuses, and the limit of any method")
        .after_help(MODEL_CONFUSION_EXAMPLES)
        .args([
            which_model(),
            given,
            flag("greedy", "Choose descriptors one by one until none helps"),
            flag("pairs", "The error for each pair of shapes alone"),
            classifier,
        ])
        .group(ArgGroup::new("descriptors").args(["given", "greedy"]))
        .group(ArgGroup::new("of").args([
            "given",
            "greedy",
            "pairs",
            "classifier",
            "noise",
            "test",
        ]))
        .args([
            round,
            number("neighbours", "Neighbours that vote in knn; default 1"),
            number("sample", "Poses of each shape that knn draws; default 2000"),
            number(
                "templates",
                "Imprints of each shape for template; default 100",
            ),
            seed(),
            export,
            replace(),
            json(),
            quiet(),
            flag("csv", "Print a table of commas").conflicts_with_all(["json", "greedy", "pairs"]),
        ])
        .args(noisy())
}

/// `taxel model touches`.
fn touches() -> Command {
    let until = Arg::new("until")
        .long("until")
        .value_name("P")
        .value_parser(parse_probability)
        .default_value("0.99")
        .help("How probable one shape must be (0 to 1)");
    let runs = Arg::new("runs")
        .long("runs")
        .value_name("N")
        .value_parser(value_parser!(u64).range(1..=1_000_000_000))
        .default_value("1000")
        .help("Runs of each shape");
    Command::new("touches")
        .about("Simulate how many touches it takes to name a shape")
        .after_help(MODEL_TOUCHES_EXAMPLES)
        .args([which_model(), until, runs, seed(), json(), quiet()])
}

/// `--seed`.
fn seed() -> Arg {
    Arg::new("seed")
        .long("seed")
        .value_name("N")
        .value_parser(value_parser!(u64))
        .default_value("0")
        .hide_default_value(true)
        .help("Seed of what is drawn at random; default 0")
}

/// The flags of noisy touches.
fn noisy() -> [Arg; 5] {
    let noise = Arg::new("noise")
        .long("noise")
        .value_name("START:END:STEP")
        .value_parser(parse_noise_range)
        .help_heading("Noise")
        .help("Touches whose taxels flip this often");
    let dead = Arg::new("dead")
        .long("dead")
        .value_name("N,...")
        .value_delimiter(',')
        .value_parser(value_parser!(u32).range(..4096))
        .requires("noise")
        .help_heading("Noise")
        .help("With so many dead taxels; default 0");
    let touches = Arg::new("touches")
        .long("touches")
        .value_name("N")
        .value_parser(value_parser!(u64).range(1..=1_000_000_000))
        .default_value("1000")
        .hide_default_value(true)
        .help_heading("Noise")
        .help("Noisy touches of each shape; default 1000");
    let matrix = Arg::new("matrix")
        .long("matrix")
        .value_name("CxR")
        .value_parser(parse_matrix)
        .requires("noise")
        .help_heading("Noise")
        .help("Size of the matrix; default the model's");
    let test = Arg::new("test")
        .long("test")
        .value_name("half-step")
        .value_parser(["half-step"])
        .hide_possible_values(true)
        .help_heading("Noise")
        .help("Touches between the poses of the model");
    [noise, dead, touches, matrix, test]
}

/// Probabilities that a taxel flips.
fn parse_noise_range(text: &str) -> Result<DecimalRange, String> {
    let range: DecimalRange = text
        .parse()
        .map_err(|error: RangeError| error.to_string())?;
    for value in [range.value(0), range.last()] {
        Noise::new(value).map_err(|error| error.to_string())?;
    }
    Ok(range)
}

/// The probability that a taxel flips.
fn parse_noise(text: &str) -> Result<Noise, String> {
    let number = text
        .trim()
        .parse()
        .map_err(|_| "expected a number".to_owned())?;
    Noise::new(number).map_err(|error: NoiseError| error.to_string())
}

/// Columns and rows, such as `16x16`.
fn parse_matrix(text: &str) -> Result<(u8, u8), &'static str> {
    let expected = "expected columns and rows from 1 to 64, such as 16x16";
    let (columns, rows) = text.split_once('x').ok_or(expected)?;
    let side = |text: &str| {
        let side = text.trim().parse::<u8>().ok();
        side.filter(|side| (1..=64).contains(side)).ok_or(expected)
    };
    Ok((side(columns)?, side(rows)?))
}

/// `taxel recognise NAME|FILE`.
pub(super) fn recognise() -> Command {
    let model = Arg::new("model")
        .long("model")
        .value_name("MODEL")
        .value_parser(value_parser!(OsString))
        .default_value(DEFAULT_MODEL)
        .hide_default_value(true)
        .help("Name or file of a model; default the seven figures");
    let top = Arg::new("top")
        .long("top")
        .value_name("K")
        .value_parser(value_parser!(u32).range(1..))
        .help("Show the K likeliest shapes only");
    let reject = Arg::new("reject")
        .long("reject")
        .value_name("P")
        .value_parser(parse_probability)
        .help("Give no answer that is less probable (0 to 1)");
    let expect = Arg::new("expect")
        .long("expect")
        .value_name("NAME")
        .help("Exit with status 3 if this is not the answer");
    let noise = Arg::new("noise")
        .long("noise")
        .value_name("E")
        .value_parser(parse_noise)
        .help("Each taxel flips with this probability (below 0.5)");
    let mask = Arg::new("mask")
        .long("mask")
        .value_name("NAME|FILE")
        .value_parser(value_parser!(OsString))
        .requires("noise")
        .help("Imprint whose active taxels are dead, stuck on or off");
    let pose = Arg::new("pose")
        .long("pose")
        .action(ArgAction::SetTrue)
        .help("Say where the shape lies and how it is turned");
    Command::new("recognise")
        .alias("recognize")
        .about("Name the shape that left an imprint")
        .after_help(RECOGNISE_EXAMPLES)
        .arg(what(
            "Imprint: shape of the library, or file; '-' for standard input",
        ))
        .args([model, top, reject, expect, noise, mask, pose])
        .args(of_sensor(&[Parameter::Pitch]))
        .arg(json())
}

/// `MODEL`: a name or a file.
fn which_model() -> Arg {
    Arg::new("model")
        .value_name("MODEL")
        .required(true)
        .value_parser(value_parser!(OsString))
        .help("Name of a model, or its file")
}

/// A list of descriptors, such as `na,p`.
fn parse_given(text: &str) -> Result<GivenDescriptors, GivenError> {
    text.parse()
}

/// A descriptor and a step, such as `cg_cd=0.01`.
fn parse_rounding(text: &str) -> Result<Rounding, GivenError> {
    text.parse()
}

/// What the arguments of `taxel model` ask for.
pub(super) fn model_request(matches: &ArgMatches) -> Result<ModelRequest, CliError> {
    let Some((command, own)) = matches.subcommand() else {
        // Required: there is always one.
        return Ok(ModelRequest::List(false));
    };
    let model = || {
        let model = own.try_get_one::<OsString>("model").ok().flatten();
        model.cloned().unwrap_or_default()
    };
    Ok(match command {
        "train" => ModelRequest::Train(Box::new(train_arguments(own)?)),
        "show" => ModelRequest::Show(model(), own.get_flag("json")),
        "delete" => match own.get_one::<Name>("name") {
            Some(name) => ModelRequest::Delete(name.clone()),
            None => ModelRequest::List(false),
        },
        "touches" => ModelRequest::Touches(TouchesArguments {
            model: model(),
            until: number(own, "until", 0.99),
            runs: number(own, "runs", 1000),
            seed: number(own, "seed", 0),
            json: own.get_flag("json"),
            quiet: own.get_flag("quiet"),
        }),
        "confusion" => ModelRequest::Confusion(Box::new(confusion_arguments(own, model()))),
        "separate" => ModelRequest::Separate(Box::new(separate_arguments(own))),
        _ => ModelRequest::List(own.get_flag("json")),
    })
}

/// The value of a flag that has a default.
fn number<T: Copy + Send + Sync + 'static>(matches: &ArgMatches, id: &str, default: T) -> T {
    matches.get_one(id).copied().unwrap_or(default)
}

/// What the arguments of `taxel model train` ask for.
fn train_arguments(matches: &ArgMatches) -> Result<TrainArguments, CliError> {
    let given = Given::of(matches);
    let sensor = given.sensor(Sensor::default())?;
    let sized = given.has(Parameter::Columns) || given.has(Parameter::Rows);
    let to = match matches.get_one::<Name>("name") {
        Some(name) => ModelTarget::Named(name.clone()),
        None => ModelTarget::File(matches.get_one("out").cloned().unwrap_or_default()),
    };
    Ok(TrainArguments {
        set: set_arguments(matches),
        anchor: matches.get_one::<Anchor>("anchor").copied(),
        ranges: GivenRanges::from_fn(|axis| {
            let range = matches.get_one(&format!("range_{}", axis.name()));
            range.copied()
        }),
        positions: matches.get_one::<u8>("positions").copied(),
        sensor: sized.then_some(sensor),
        given,
        shard: matches.get_one("shard").copied().unwrap_or(Shard::WHOLE),
        jobs: matches
            .get_one::<u16>("jobs")
            .map_or(0, |&jobs| jobs.into()),
        allow_cut: matches.get_flag("allow-cut"),
        to,
        existing: parameters::existing(matches),
        json: matches.get_flag("json"),
        quiet: matches.get_flag("quiet"),
    })
}

/// What the arguments of `taxel model confusion` ask for.
fn confusion_arguments(matches: &ArgMatches, model: OsString) -> ConfusionArguments {
    let given = matches.get_one::<GivenDescriptors>("given");
    let peer = matches
        .get_one::<String>("classifier")
        .map(|name| Peer::from_name(name));
    let noise = matches.get_one::<DecimalRange>("noise").map(|&noise| {
        let dead = matches.get_many::<u32>("dead");
        NoiseArguments {
            noise,
            dead: dead.map_or_else(|| vec![0], |dead| dead.copied().collect()),
            touches: number(matches, "touches", 1000),
            seed: number(matches, "seed", 0),
            size: matches.get_one("matrix").copied(),
            quiet: matches.get_flag("quiet"),
        }
    });
    let of = match (given, peer) {
        _ if matches.contains_id("test") => Evaluated::HalfStep,
        (_, Some(Some(peer))) => Evaluated::Peer(peer),
        (_, Some(None)) => Evaluated::AllPeers,
        (Some(given), None) => Evaluated::Given(given.clone()),
        _ if noise.is_some() => noise.map_or(Evaluated::Imprints, Evaluated::Noise),
        _ if matches.get_flag("greedy") => Evaluated::Greedy,
        _ if matches.get_flag("pairs") => Evaluated::Pairs,
        _ => Evaluated::Imprints,
    };
    let mut peers = PeerSettings::default();
    let limit = |id: &str| {
        matches
            .get_one::<u32>(id)
            .map(|&number| crate::index::wide(number))
    };
    peers.neighbours = limit("neighbours").unwrap_or(peers.neighbours);
    peers.sample = limit("sample").unwrap_or(peers.sample);
    peers.templates = limit("templates").unwrap_or(peers.templates);
    peers.seed = number(matches, "seed", peers.seed);
    let roundings = matches.get_many::<Rounding>("round").into_iter().flatten();
    ConfusionArguments {
        model,
        of,
        roundings: roundings.copied().collect(),
        peers,
        form: form_of(matches),
        export: matches.get_one::<PathBuf>("export").cloned(),
        existing: parameters::existing(matches),
    }
}

/// What the arguments of `taxel recognise` ask for.
pub(super) fn recognise_arguments(
    matches: &ArgMatches,
    pitch_mm: Option<f64>,
) -> RecogniseArguments {
    let text = |id: &str| matches.get_one::<OsString>(id).cloned().unwrap_or_default();
    RecogniseArguments {
        what: text("what"),
        model: text("model"),
        top: matches
            .get_one::<u32>("top")
            .map(|&top| crate::index::wide(top)),
        reject: matches.get_one("reject").copied(),
        expect: matches.get_one::<String>("expect").cloned(),
        noise: matches.get_one::<Noise>("noise").copied(),
        mask: matches.get_one::<OsString>("mask").cloned(),
        pose: matches.get_flag("pose"),
        pitch_mm,
        json: matches.get_flag("json"),
    }
}
