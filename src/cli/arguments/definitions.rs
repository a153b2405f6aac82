//! The commands and their flags as clap takes them, with the texts of their help.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgAction, ArgGroup, Command, value_parser};

use crate::cli::arguments::help::{
    ABOUT, BATCH_EXAMPLES, CHECK_EXAMPLES, DELETE_EXAMPLES, DESCRIBE_EXAMPLES, EXAMPLES,
    EXPORT_EXAMPLES, FIGURE_EXAMPLES, LIBRARY_EXAMPLES, LIST_EXAMPLES, MERGE_EXAMPLES,
    PATH_EXAMPLES, PICTURE_EXAMPLES, RESTORE_EXAMPLES, SAVE_EXAMPLES, SHOW_EXAMPLES,
    SWEEP_EXAMPLES,
};
use crate::cli::arguments::parameters;
use crate::cli::arguments::program::{
    ascii, completions, config, config_file, look, man, record, script, size,
};
use crate::cli::commands::export;
use crate::figure::FigureKind;
use crate::formats::{Name, NameError};
use crate::parameter::Parameter;
use crate::picture::PICTURE_PARAMETERS;
use crate::pose::{Anchor, Axis, DecimalRange, RangeError, Ranges};
use crate::sensor::SENSOR_PARAMETERS;
use crate::storage::{AtlasFile, is_poses};
use crate::sweep::{Shard, ShardError};

/// All commands.
pub(crate) fn all() -> Command {
    Command::new("taxel")
        .version(env!("TAXEL_VERSION"))
        .about(ABOUT)
        .after_help(EXAMPLES)
        .args(sensor())
        .args(look())
        .args([size(), record()].map(|arg| arg.help_heading("Terminal")))
        .args([folder(), config_file(), ascii()].map(|arg| arg.global(true)))
        .subcommand(figure())
        .subcommand(picture())
        .subcommand(describe())
        .subcommand(export())
        .subcommand(batch())
        .subcommand(sweep())
        .subcommand(merge())
        .subcommand(library())
        .subcommand(script())
        .subcommand(config().args(sensor()))
        .subcommand(completions())
        .subcommand(man())
}

fn figure() -> Command {
    let kinds = FigureKind::ALL
        .into_iter()
        .map(|kind| kind.name().to_owned());
    let kind = Arg::new("kind")
        .value_name("KIND")
        .required(true)
        .value_parser(parameters::one_of(
            FigureKind::ALL.map(FigureKind::name),
            FigureKind::from_name,
        ))
        .hide_possible_values(true)
        .help(parameters::wrapped(&list(kinds, "or"), 64));
    let own = parameters::figure_parameters();
    Command::new("figure")
        .about("Touch a figure and describe its imprint")
        .after_help(FIGURE_EXAMPLES)
        .arg(kind)
        .args(own.map(|parameter| parameters::arg(parameter).help_heading("Figure")))
        .args(sensor())
        .args(keeping())
        .group(kept())
        .arg(json())
}

fn picture() -> Command {
    let own = |parameter: Parameter| parameters::arg_with_own(parameter);
    Command::new("picture")
        .about("Move, zoom and turn a stored shape and describe its imprint")
        .after_help(PICTURE_EXAMPLES)
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .args(PICTURE_PARAMETERS.map(|parameter| own(parameter).help_heading("Picture")))
        .args(SENSOR_PARAMETERS.map(|parameter| own(parameter).help_heading("Sensor")))
        .args(keeping())
        .group(kept())
        .arg(json())
}

fn describe() -> Command {
    Command::new("describe")
        .about("Describe an imprint or a stored shape")
        .after_help(DESCRIBE_EXAMPLES)
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .args(of_sensor(&[Parameter::Pitch]))
        .arg(json())
}

fn export() -> Command {
    let to = Arg::new("to")
        .value_name("TO")
        .required(true)
        .value_parser(value_parser!(PathBuf))
        .help("File to write; '-' for standard output");
    Command::new("export")
        .about("Write a shape for other programs, or draw it")
        .after_help(EXPORT_EXAMPLES)
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .arg(to)
        .args(of_sensor(&[Parameter::Pitch]))
        .arg(format())
        .arg(replace())
}

fn format() -> Arg {
    let names = export::names();
    let help = format!(
        "Its form, where its ending does not tell: {}",
        names.join(", ")
    );
    Arg::new("format")
        .long("format")
        .value_name("FORMAT")
        .value_parser(PossibleValuesParser::new(names))
        .hide_possible_values(true)
        .help(parameters::wrapped(&help, 52))
}

fn batch() -> Command {
    Command::new("batch")
        .about("Answer poses, one JSON object a line, on standard input")
        .after_help(BATCH_EXAMPLES)
        .args(sensor_of_imprints())
}

fn sweep() -> Command {
    let kind = Arg::new("kind")
        .value_name("KIND")
        .required_unless_present("picture")
        .conflicts_with("picture")
        .value_parser(parameters::one_of(
            FigureKind::ALL.map(FigureKind::name),
            FigureKind::from_name,
        ))
        .hide_possible_values(true)
        .help("Kind of figure, as of 'taxel figure'");
    let picture = Arg::new("picture")
        .long("picture")
        .value_name("NAME|FILE")
        .value_parser(value_parser!(OsString))
        .help("Sweep a stored shape instead");
    let sizes = parameters::figure_parameters()
        .filter(|&parameter| Axis::ALL.iter().all(|axis| axis.parameter() != parameter));
    let anchor = Arg::new("anchor")
        .long("anchor")
        .value_name("POINT")
        .value_parser(parameters::one_of(Anchor::NAMES, Anchor::from_name))
        .hide_possible_values(true)
        .help_heading("Grid")
        .help("What x0 and y0 place: corner or centre");
    let poses = Arg::new("poses")
        .long("poses")
        .value_name("FILE.npy")
        .value_parser(parse_poses)
        .conflicts_with("shard")
        .help("Write the number of each pose's imprint");
    let jobs = Arg::new("jobs")
        .long("jobs")
        .value_name("N")
        .value_parser(value_parser!(u16).range(1..=1024))
        .help("Threads; default all cores");
    let shard = Arg::new("shard")
        .long("shard")
        .value_name("K/N")
        .value_parser(parse_shard)
        .help("Sweep this piece of the grid only");
    Command::new("sweep")
        .about("Find every imprint that a shape can leave")
        .after_help(SWEEP_EXAMPLES)
        .arg(kind)
        .arg(picture)
        .args(sizes.map(|parameter| parameters::arg(parameter).help_heading("Figure")))
        .args(Axis::ALL.map(range))
        .arg(anchor)
        .args(sensor_of_imprints())
        .args([atlas(), poses, replace(), jobs, shard, json(), quiet()])
}

/// The flag of an axis of the grid, which takes a range.
fn range(axis: Axis) -> Arg {
    let (row, flag) = (axis.parameter().row(), axis.parameter().flag());
    let default = match axis {
        Axis::X0 | Axis::Y0 => "one cell that suits the shape".to_owned(),
        _ => Ranges::default()[axis].to_string(),
    };
    let help = format!(
        "{}; default {default}",
        parameters::capitalised(row.meaning)
    );
    Arg::new(format!("range_{}", row.key))
        .long(flag)
        .value_name("START:END:STEP")
        .allow_hyphen_values(true)
        .value_parser(parse_range)
        .help_heading("Grid")
        .help(parameters::wrapped(&help, 46))
}

fn merge() -> Command {
    let files = Arg::new("files")
        .value_name("FILE.npz")
        .required(true)
        .num_args(1..)
        .value_parser(value_parser!(PathBuf))
        .help("Atlases of all shards, in any order");
    Command::new("merge")
        .about("Put the shards of a sweep together")
        .after_help(MERGE_EXAMPLES)
        .args([files, atlas().required(true), replace(), json(), quiet()])
}

fn atlas() -> Arg {
    Arg::new("atlas")
        .long("atlas")
        .value_name("FILE")
        .value_parser(parse_atlas)
        .help("Write the atlas, as .csv, .jsonl or .npz")
}

/// As [`force`], of files.
fn replace() -> Arg {
    force().help("Replace a file that is there already")
}

fn quiet() -> Arg {
    Arg::new("quiet")
        .long("quiet")
        .action(ArgAction::SetTrue)
        .help("Show no progress")
}

fn parse_atlas(text: &str) -> Result<AtlasFile, &'static str> {
    AtlasFile::new(text)
}

fn parse_poses(text: &str) -> Result<PathBuf, &'static str> {
    let path = PathBuf::from(text);
    let fits = is_poses(&path);
    fits.then_some(path)
        .ok_or("expected a name that ends in .npy")
}

fn parse_range(text: &str) -> Result<DecimalRange, RangeError> {
    text.parse()
}

fn parse_shard(text: &str) -> Result<Shard, ShardError> {
    text.parse()
}

fn library() -> Command {
    let command = |name: &'static str, about: &'static str, examples: &'static str| {
        Command::new(name).about(about).after_help(examples)
    };
    let list = command("list", "List all shapes", LIST_EXAMPLES).arg(json());
    let show = command("show", "Show a shape and describe it", SHOW_EXAMPLES)
        .arg(name("Which shape"))
        .args(of_sensor(&[Parameter::Pitch]))
        .arg(json());
    let save = command("save", "Store a shape under a name", SAVE_EXAMPLES)
        .arg(name("Its name from now on"))
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .arg(force());
    let delete = command("delete", "Move a shape into the trash", DELETE_EXAMPLES);
    let restore = command("restore", "Bring a deleted shape back", RESTORE_EXAMPLES);
    Command::new("library")
        .about("List, show, save, delete and check stored shapes")
        .after_help(LIBRARY_EXAMPLES)
        .subcommand_required(true)
        .subcommand(list)
        .subcommand(show)
        .subcommand(save)
        .subcommand(delete.arg(name("Which shape")))
        .subcommand(restore.arg(name("Which shape")))
        .subcommand(command("path", "Print the library's folder", PATH_EXAMPLES))
        .subcommand(command("check", "Check every file", CHECK_EXAMPLES))
}

fn sensor() -> Vec<Arg> {
    of_sensor(&SENSOR_PARAMETERS)
}

/// Without the pitch, where no length is shown.
fn sensor_of_imprints() -> Vec<Arg> {
    let own = SENSOR_PARAMETERS.into_iter();
    let own = own.filter(|&parameter| parameter != Parameter::Pitch);
    of_sensor(&own.collect::<Vec<_>>())
}

fn of_sensor(parameters: &[Parameter]) -> Vec<Arg> {
    let flag = |&parameter: &Parameter| parameters::arg(parameter).help_heading("Sensor");
    parameters.iter().map(flag).collect()
}

/// What may be kept of a touch.
fn kept() -> ArgGroup {
    ArgGroup::new("kept")
        .args(["save", "export"])
        .multiple(true)
}

fn keeping() -> [Arg; 4] {
    let save = Arg::new("save")
        .long("save")
        .value_name("NAME")
        .value_parser(parse_name)
        .help_heading("Library")
        .help("Store the shape in the library too");
    let export = Arg::new("export")
        .long("export")
        .value_name("FILE")
        .value_parser(value_parser!(PathBuf))
        .help_heading("Export")
        .help(parameters::wrapped(
            "Write the imprint, or a drawing of it; '-' for standard output, in place of the table",
            52,
        ));
    let force = force().help("Replace a shape or a file that is there already");
    [
        save,
        export,
        format().help_heading("Export").requires("export"),
        force.requires("kept"),
    ]
}

fn force() -> Arg {
    Arg::new("force")
        .long("force")
        .action(ArgAction::SetTrue)
        .help("Replace a shape that has the name already")
}

fn folder() -> Arg {
    Arg::new("library")
        .long("library")
        .value_name("DIR")
        .value_parser(value_parser!(PathBuf))
        .help_heading("Library")
        .help("The library's folder")
}

fn name(help: &'static str) -> Arg {
    Arg::new("name")
        .value_name("NAME")
        .required(true)
        .value_parser(parse_name)
        .help(help)
}

fn parse_name(text: &str) -> Result<Name, NameError> {
    Name::new(text)
}

fn what(help: &'static str) -> Arg {
    Arg::new("what")
        .value_name("NAME|FILE")
        .required(true)
        .value_parser(value_parser!(OsString))
        .help(help)
}

fn json() -> Arg {
    Arg::new("json")
        .long("json")
        .action(ArgAction::SetTrue)
        .help("Answer in one line of JSON")
}

/// "a, b or c", and the like with another word.
pub(crate) fn list(names: impl Iterator<Item = String>, word: &str) -> String {
    let names: Vec<String> = names.collect();
    match names.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} {word} {last}", others.join(", ")),
        None => String::new(),
    }
}
