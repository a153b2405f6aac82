//! `taxel model` and `taxel recognise`: their flags, and what these ask for.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Command, value_parser};

use crate::cli::arguments::flags::{
    anchor, jobs, json, parse_name, quiet, range, replace, sensor_of_imprints, shard, what,
};
use crate::cli::arguments::help::{
    MODEL_CONFUSION_EXAMPLES, MODEL_DELETE_EXAMPLES, MODEL_EXAMPLES, MODEL_LIST_EXAMPLES,
    MODEL_SHOW_EXAMPLES, MODEL_TRAIN_EXAMPLES, RECOGNISE_EXAMPLES,
};
use crate::cli::arguments::parameters::{self, Given};
use crate::cli::error::CliError;
use crate::formats::Name;
use crate::parameter::Parameter;
use crate::pose::{Anchor, Axis, GivenRanges};
use crate::recognition::{GivenDescriptors, GivenError, Peer, PeerSettings, Rounding};
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
}

/// A set of shapes, how to train it, and where the model goes.
#[derive(Clone, Debug)]
pub(crate) struct TrainArguments {
    /// Files of JSON lines, or names of the library.
    pub(crate) what: Vec<OsString>,
    /// Shapes in words.
    pub(crate) shapes: Vec<String>,
    /// Whether all shapes of the library belong to the set.
    pub(crate) library_all: bool,
    pub(crate) anchor: Option<Anchor>,
    pub(crate) ranges: GivenRanges,
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
}

/// How an evaluation is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EvaluationForm {
    Text,
    Csv,
    Json,
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
    pub(crate) json: bool,
}

/// `taxel model` with its own subcommands.
pub(super) fn model() -> Command {
    let command = |name: &'static str, about: &'static str, examples: &'static str| {
        Command::new(name).about(about).after_help(examples)
    };
    Command::new("model")
        .about("Train models of shapes, and see how well one touch tells these apart")
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
}

/// `taxel model train`.
fn train() -> Command {
    let what = Arg::new("set")
        .value_name("FILE.jsonl|NAME")
        .num_args(0..)
        .value_parser(value_parser!(OsString))
        .help("Shapes as lines of JSON, '-' for standard input; or names of the\nlibrary");
    let shape = Arg::new("shape")
        .long("shape")
        .value_name("NAME=KIND KEY=NUMBER...")
        .action(ArgAction::Append)
        .help("A shape more: 'disc=ellipse radius_x=3 radius_y=3'");
    let library_all = Arg::new("library-all")
        .long("library-all")
        .action(ArgAction::SetTrue)
        .help("All shapes of the library");
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
        .about("Learn every imprint of a set of shapes")
        .after_help(MODEL_TRAIN_EXAMPLES)
        .args([what, shape, library_all, out, name])
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
        .arg(anchor().help("What x0 and y0 place: corner or centre; default corner\nwhere one of them is given, otherwise centre"))
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
        .help("Measure a descriptor in steps: cg_cd=0.01");
    let classifier = Arg::new("classifier")
        .long("classifier")
        .value_name("NAME")
        .value_parser(clap::builder::PossibleValuesParser::new(
            Peer::ALL.map(Peer::name).into_iter().chain(["all"]),
        ))
        .hide_possible_values(true)
        .help("Another way to name shapes: z, diagonal, lda, qda, knn,\ntemplate, or all of them in a table");
    let number = |name: &'static str, help: &'static str| {
        Arg::new(name)
            .long(name)
            .value_name("N")
            .value_parser(value_parser!(u32).range(1..))
            .help(help)
    };
    let seed = Arg::new("seed")
        .long("seed")
        .value_name("N")
        .value_parser(value_parser!(u64))
        .help("Seed of the poses that knn draws; default 0");
    let export = Arg::new("export")
        .long("export")
        .value_name("FILE")
        .value_parser(value_parser!(PathBuf))
        .help("Write the matrix as .csv, .svg or .png");
    Command::new("confusion")
        .about("Show which shapes one touch confuses, and the limit of any method")
        .after_help(MODEL_CONFUSION_EXAMPLES)
        .args([
            which_model(),
            given,
            flag(
                "greedy",
                "Choose descriptors one by one until none adds anything",
            ),
            flag("pairs", "The error for each pair of shapes alone"),
            classifier,
        ])
        .group(ArgGroup::new("of").args(["given", "greedy", "pairs", "classifier"]))
        .args([
            round,
            number("neighbours", "Neighbours that vote in knn; default 1"),
            number("sample", "Poses of each shape that knn draws; default 2000"),
            number(
                "templates",
                "Imprints of each shape for template; default 100",
            ),
            seed,
            export,
            replace(),
            json(),
            flag("csv", "Print a table of commas").conflicts_with("json"),
        ])
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
    Command::new("recognise")
        .alias("recognize")
        .about("Name the shape that left an imprint")
        .after_help(RECOGNISE_EXAMPLES)
        .arg(what(
            "Imprint: shape of the library, or file; '-' for standard input",
        ))
        .args([model, top, reject, expect, json()])
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

/// A number from 0 to 1.
fn parse_probability(text: &str) -> Result<f64, &'static str> {
    let number = text.trim().parse().ok();
    number
        .filter(|number| (0.0..=1.0).contains(number))
        .ok_or("expected a number from 0 to 1")
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
        "confusion" => ModelRequest::Confusion(Box::new(confusion_arguments(own, model()))),
        _ => ModelRequest::List(own.get_flag("json")),
    })
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
    let all = |id: &str| matches.get_many::<OsString>(id).into_iter().flatten();
    let shapes = matches.get_many::<String>("shape").into_iter().flatten();
    Ok(TrainArguments {
        what: all("set").cloned().collect(),
        shapes: shapes.cloned().collect(),
        library_all: matches.get_flag("library-all"),
        anchor: matches.get_one::<Anchor>("anchor").copied(),
        ranges: GivenRanges::from_fn(|axis| {
            let range = matches.get_one(&format!("range_{}", axis.name()));
            range.copied()
        }),
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
    let of = match (given, peer) {
        (_, Some(Some(peer))) => Evaluated::Peer(peer),
        (_, Some(None)) => Evaluated::AllPeers,
        (Some(given), None) => Evaluated::Given(given.clone()),
        _ if matches.get_flag("greedy") => Evaluated::Greedy,
        _ if matches.get_flag("pairs") => Evaluated::Pairs,
        _ => Evaluated::Imprints,
    };
    let mut peers = PeerSettings::default();
    let number = |id: &str| {
        matches
            .get_one::<u32>(id)
            .map(|&number| crate::index::wide(number))
    };
    peers.neighbours = number("neighbours").unwrap_or(peers.neighbours);
    peers.sample = number("sample").unwrap_or(peers.sample);
    peers.templates = number("templates").unwrap_or(peers.templates);
    peers.seed = matches.get_one("seed").copied().unwrap_or(peers.seed);
    let roundings = matches.get_many::<Rounding>("round").into_iter().flatten();
    ConfusionArguments {
        model,
        of,
        roundings: roundings.copied().collect(),
        peers,
        form: if matches.get_flag("json") {
            EvaluationForm::Json
        } else if matches.get_flag("csv") {
            EvaluationForm::Csv
        } else {
            EvaluationForm::Text
        },
        export: matches.get_one::<PathBuf>("export").cloned(),
        existing: parameters::existing(matches),
    }
}

/// What the arguments of `taxel recognise` ask for.
pub(super) fn recognise_arguments(matches: &ArgMatches) -> RecogniseArguments {
    let text = |id: &str| matches.get_one::<OsString>(id).cloned().unwrap_or_default();
    RecogniseArguments {
        what: text("what"),
        model: text("model"),
        top: matches
            .get_one::<u32>("top")
            .map(|&top| crate::index::wide(top)),
        reject: matches.get_one("reject").copied(),
        expect: matches.get_one::<String>("expect").cloned(),
        json: matches.get_flag("json"),
    }
}
