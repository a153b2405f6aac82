//! The commands and their flags, for clap, with the short texts of their help.
//!
//! There is a function for each command, in the order of the help, then for the flags that several commands share.
//! Flags of parameters are made from the table of parameters ([`parameters`]), so their ranges and defaults are
//! written nowhere else. Values are parsed here into their types: a file name that is not an atlas, or a range that
//! goes backwards, is a usage error.
//!
//! A command with few flags is defined here, larger ones in files of their own; see the list of this folder. The
//! order of the calls is the order in the help. Headings (`Figure`, `Sensor`, `Grid`, …) divide longer lists of
//! flags.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgGroup, Command, value_parser};

use crate::cli::arguments::flags::{
    alone, anchor, force, jobs, json, memory, name, name_or_path, npy, of_sensor, option, quiet,
    range, replace, resume, sensor, sensor_of_imprints, shard, switch, what,
};
use crate::cli::arguments::help::{
    ABOUT, BATCH_EXAMPLES, CHECK_EXAMPLES, DELETE_EXAMPLES, DESCRIBE_EXAMPLES, EXAMPLES,
    EXPORT_EXAMPLES, FIGURE_EXAMPLES, LIBRARY_EXAMPLES, LIST_EXAMPLES, MERGE_EXAMPLES,
    PATH_EXAMPLES, PICTURE_EXAMPLES, RESTORE_EXAMPLES, SAVE_EXAMPLES, SHOW_EXAMPLES,
    SWEEP_EXAMPLES,
};
use crate::cli::arguments::program::{
    ascii, completions, config, config_file, look, man, record, script, size,
};
use crate::cli::arguments::{export, frames, model, parameters, recognise, watch};
use crate::figure::FigureKind;
use crate::formats::Name;
use crate::parameter::Parameter;
use crate::picture::PICTURE_PARAMETERS;
use crate::pose::Axis;
use crate::quote::joined;
use crate::sensor::SENSOR_PARAMETERS;
use crate::storage::AtlasFile;

/// Defines the program with all its commands. Completions and manual pages are made from this too, so a new command
/// appears in them by itself.
pub(crate) fn all() -> Command {
    let program = Command::new("taxel")
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
        .subcommand(model::command())
        .subcommand(recognise::command())
        .subcommand(frames())
        .subcommand(watch::command())
        .subcommand(library())
        .subcommand(script())
        .subcommand(config().args(sensor()))
        .subcommand(completions())
        .subcommand(man());
    // These commands get a hidden flag of their own in place of the one that every command has.
    let program = WITHOUT_LIBRARY.into_iter().fold(program, |program, name| {
        program.mut_subcommand(name, |command| command.arg(folder().hide(true)))
    });
    in_order(with_negative_numbers(program))
}

/// Flags that several commands have. The help of a command lists them in this order, after the command's own flags.
const SHARED: [&str; 18] = [
    "out", "name", "atlas", "poses", "write", "export", "svg", "format", "force", "shard",
    "resume", "jobs", "memory", "json", "csv", "quiet", "config", "ascii",
];

/// Lists the flags of [`SHARED`] in one order in the help of a command and of its subcommands. Flags under a heading
/// of their own keep their place there.
fn in_order(command: Command) -> Command {
    command
        .mut_args(|arg| {
            let flag = arg.get_long().filter(|_| arg.get_help_heading().is_none());
            match flag.and_then(|flag| SHARED.iter().position(|shared| *shared == flag)) {
                // After flags that are ordered only by their place in the command, before --help and --version.
                Some(position) => arg.display_order(500 + position),
                None => arg,
            }
        })
        .mut_subcommands(in_order)
}

/// Lets every argument of a command and its subcommands take `-1`, so that the argument's own parser tells what it
/// expects. Otherwise clap would take `-1` for a flag and advise `-- -1`, which no flag accepts.
fn with_negative_numbers(command: Command) -> Command {
    command
        .mut_args(|arg| {
            let takes = arg.get_action().takes_values();
            arg.allow_negative_numbers(takes)
        })
        .mut_subcommands(with_negative_numbers)
}

/// Defines `taxel figure KIND`, such as `taxel figure ellipse --x0 1.99 --radius-x 4`. There is a flag for each
/// parameter of any kind; [`Given::foreign`](parameters::Given::foreign) refuses those that the given kind does not
/// have. Angles are degrees clockwise as seen, lengths are in cell sides.
fn figure() -> Command {
    let kinds = FigureKind::ALL.map(FigureKind::name);
    let kind = Arg::new("kind")
        .value_name("KIND")
        .required(true)
        .value_parser(parameters::one_of(kinds, FigureKind::from_name))
        .hide_possible_values(true)
        .help(parameters::wrapped(&joined(kinds, "or"), 64));
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

/// Defines `taxel picture NAME|FILE`, such as `taxel picture washer --x0 6 --angle 30`. Without a flag, the picture
/// keeps the value it was stored with.
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

/// Defines `taxel describe NAME|FILE`, such as `taxel describe imprint.txt --pitch 2.5`.
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

/// Defines `taxel export NAME|FILE TO`, such as `taxel export washer washer.svg`. Standard output is `-` with
/// `--format`.
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

/// Defines `--format`, for file names whose extension does not tell the format.
fn format() -> Arg {
    let names = export::names();
    let help = format!(
        "Format, if not given by the extension: {}",
        names.join(", ")
    );
    Arg::new("format")
        .long("format")
        .value_name("FORMAT")
        .value_parser(PossibleValuesParser::new(names))
        .hide_possible_values(true)
        .help(parameters::wrapped(&help, 52))
}

/// Defines `taxel batch`, such as `taxel batch < poses.jsonl > answers.jsonl`. Lines may set a sensor; the flags are
/// for lines that do not.
fn batch() -> Command {
    Command::new("batch")
        .about("Describe poses, one JSON object per line")
        .after_help(BATCH_EXAMPLES)
        .arg(
            Arg::new("file")
                .value_name("FILE")
                .value_parser(value_parser!(PathBuf))
                .help("Lines of JSON; nothing or '-' for standard input"),
        )
        .args(sensor_of_imprints())
        .arg(jobs())
}

/// Defines `taxel sweep KIND` and `taxel sweep --picture NAME|FILE`. Axes are ranges here, not numbers:
/// `--x0 5:5.99:0.01`. Their flags have the names of parameters, so these parameters are left out of the flags of
/// sizes.
fn sweep() -> Command {
    let kind = Arg::new("kind")
        .value_name("KIND")
        .value_parser(parameters::one_of(
            FigureKind::ALL.map(FigureKind::name),
            FigureKind::from_name,
        ))
        .hide_possible_values(true)
        .help("Kind of figure, as in 'taxel figure'; or --picture");
    let picture =
        option("picture", "NAME|FILE", "Sweep a stored shape instead").value_parser(name_or_path());
    let sizes = parameters::figure_parameters()
        .filter(|&parameter| Axis::ALL.iter().all(|axis| axis.parameter() != parameter));
    let poses = option("poses", "FILE.npy", "Write which imprint each pose leaves")
        .value_parser(npy())
        .conflicts_with("shard");
    Command::new("sweep")
        .about("Find every imprint that a shape can leave")
        .after_help(SWEEP_EXAMPLES)
        .arg(kind)
        .arg(picture)
        .group(
            ArgGroup::new("shape")
                .args(["kind", "picture"])
                .required(true),
        )
        .args(sizes.map(|parameter| parameters::arg(parameter).help_heading("Figure")))
        .args(Axis::ALL.map(|axis| match axis {
            Axis::X0 | Axis::Y0 => range(axis, "one cell that suits the shape"),
            _ => range(axis, ""),
        }))
        .arg(anchor())
        .args(sensor_of_imprints())
        .args([
            atlas(),
            poses,
            replace().requires("files"),
            jobs(),
            memory(),
            shard(),
            resume().requires("atlas").conflicts_with("poses"),
            json(),
            quiet(),
        ])
        .group(
            ArgGroup::new("files")
                .args(["atlas", "poses"])
                .multiple(true),
        )
}

/// Defines `taxel merge FILE.npz…`. Shards of a training are merged by the same command, such as
/// `taxel merge part-*.npz --out whole.npz`; the content of the files decides.
fn merge() -> Command {
    let files = Arg::new("files")
        .value_name("FILE.npz")
        .required(true)
        .num_args(1..)
        .value_parser(value_parser!(PathBuf))
        .help("Atlases or models of all shards, in any order");
    Command::new("merge")
        .about("Merge the shards of a sweep or a training")
        .after_help(MERGE_EXAMPLES)
        .args([
            files,
            atlas()
                .long("out")
                .alias("atlas")
                .help("Write the atlas (.csv, .jsonl, .npz) or the model\n(.npz); --atlas means the same")
                .required(true),
            replace(),
            memory(),
            json(),
            quiet(),
        ])
}

/// Defines `--atlas`, the file that a sweep or a merge writes. Its extension decides the format, so there is no flag
/// for this; only `.npz` can be read again.
fn atlas() -> Arg {
    option("atlas", "FILE", "Write the atlas, as .csv, .jsonl or .npz")
        .value_parser(|path: &str| AtlasFile::new(path))
}

/// Defines `taxel frames FILE`. With `--export`, each frame gets a file of its own. `--save` stores a single shape,
/// so it excludes `--all`, and fails for a label that several frames have.
fn frames() -> Command {
    let keeping = keeping().map(|arg| match arg.get_id().as_str() {
        "save" => arg
            .requires("choice")
            .conflicts_with_all(["all", "noise-report"]),
        "export" => arg.requires("choice").help(parameters::wrapped(
            "Write the imprint, or a drawing of it, with the frame's number in the name; with --noise-report the mask",
            52,
        )),
        _ => arg,
    });
    frames::command()
        .args(
            of_sensor(&[Parameter::Pitch])
                .into_iter()
                .map(|arg| arg.requires("choice").conflicts_with("noise-report")),
        )
        .args(keeping)
        .group(kept())
        .args([json().conflicts_with("heat"), frames::heat()])
}

/// Defines `taxel library` and its subcommands, one of which is required: `taxel library list --json`,
/// `taxel library save NAME FILE` and so on.
fn library() -> Command {
    let command = |name: &'static str, about: &'static str, examples: &'static str| {
        Command::new(name).about(about).after_help(examples)
    };
    let names = switch("names", "Print only the names, one per line").conflicts_with("json");
    let own = switch("own", "With --names: only your own shapes").requires("with_names");
    let deleted = switch("deleted", "With --names: only those in the trash")
        .requires("with_names")
        .conflicts_with("own");
    let list =
        command("list", "List all shapes", LIST_EXAMPLES).args([names, own, deleted, json()]);
    let list = list.group(alone("with_names", "names"));
    let show = command("show", "Show a shape and describe it", SHOW_EXAMPLES)
        .arg(name("Name of the shape"))
        .args(of_sensor(&[Parameter::Pitch]))
        .arg(json());
    let save = command("save", "Store a shape under a name", SAVE_EXAMPLES)
        .arg(name("Name to store it under"))
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .arg(force());
    let delete = command("delete", "Move a shape to the trash", DELETE_EXAMPLES);
    let restore = command("restore", "Restore a deleted shape", RESTORE_EXAMPLES);
    Command::new("library")
        .about("List, show, save, delete and check stored shapes")
        .after_help(LIBRARY_EXAMPLES)
        .subcommand_required(true)
        .subcommand(list)
        .subcommand(show)
        .subcommand(save)
        .subcommand(delete.arg(name("Name of the shape")))
        .subcommand(restore.arg(name("Name of the shape")))
        .subcommand(command("path", "Print the library's folder", PATH_EXAMPLES))
        .subcommand(command("check", "Check every file", CHECK_EXAMPLES).arg(json()))
}

/// Groups `--save` and `--export`: `--force` requires at least one of them.
fn kept() -> ArgGroup {
    ArgGroup::new("kept")
        .args(["save", "export"])
        .multiple(true)
}

/// Defines the flags that keep the result of a touch: `--save`, `--export` with `--format`, and `--force`. They are
/// for commands that answer with one imprint: `figure`, `picture` and `frames`.
fn keeping() -> [Arg; 4] {
    let save = option("save", "NAME", "Store the shape in the library too")
        .value_parser(Name::new)
        .help_heading("Library");
    let export = Arg::new("export")
        .long("export")
        .value_name("FILE")
        .value_parser(value_parser!(PathBuf))
        .help_heading("Export")
        .help(parameters::wrapped(
            "Write the imprint, or a drawing of it; '-' for standard output, in place of the table",
            52,
        ));
    let force = force().help("Replace an existing shape or file");
    [
        save,
        export,
        format().help_heading("Export").requires("export"),
        force.requires("kept"),
    ]
}

/// The commands that use no library.
pub(crate) const WITHOUT_LIBRARY: [&str; 3] = ["merge", "completions", "man"];

/// Defines `--library`, which every command takes except those of [`WITHOUT_LIBRARY`].
fn folder() -> Arg {
    option("library", "DIR", "The library's folder")
        .value_parser(value_parser!(PathBuf))
        .help_heading("Library")
}

#[cfg(test)]
mod tests {
    use clap::builder::NonEmptyStringValueParser;
    use clap::error::{ContextKind, ContextValue, ErrorKind};
    use clap::{Arg, Command, Error};

    /// Returns the commands that have no subcommands. All their arguments accept any text.
    fn innermost(command: &Command) -> Vec<Command> {
        let own: Vec<_> = command.get_subcommands().collect();
        if own.is_empty() {
            let any = |arg: Arg| {
                let takes = arg.get_action().takes_values();
                let any = NonEmptyStringValueParser::new();
                if takes { arg.value_parser(any) } else { arg }
            };
            return vec![command.clone().mut_args(any)];
        }
        own.into_iter().flat_map(innermost).collect()
    }

    /// Returns the words that give an argument, with a value if it takes one.
    fn given(arg: &Arg) -> Vec<String> {
        let flag = arg.get_long().map(|long| format!("--{long}"));
        let short = arg.get_short().map(|short| format!("-{short}"));
        let value = arg.get_action().takes_values().then(|| "1".to_owned());
        flag.or(short).into_iter().chain(value).collect()
    }

    /// Parses a command with these arguments and with everything that it always requires.
    fn parsed(command: &Command, args: &[&Arg]) -> Result<(), Error> {
        let is_given = |id: &clap::Id| args.iter().any(|arg| arg.get_id() == id);
        let mut all = args.to_vec();
        let required = |arg: &&Arg| arg.is_required_set() && !is_given(arg.get_id());
        all.extend(command.get_arguments().filter(required));
        let groups = command.get_groups().filter(|group| group.is_required_set());
        for group in groups {
            let own: Vec<_> = group.get_args().collect();
            if !own.iter().any(|id| is_given(id)) {
                let is_first = |arg: &&Arg| own.first() == Some(&arg.get_id());
                all.extend(command.get_arguments().find(is_first));
            }
        }
        let line = all.into_iter().flat_map(given);
        let line = std::iter::once("taxel".to_owned()).chain(line);
        command.clone().try_get_matches_from(line).map(|_| ())
    }

    /// If a flag requires a second one and a third flag excludes the second, clap lets the second be missing. The
    /// first flag would be ignored.
    #[test]
    fn a_flag_that_needs_another_is_refused_without_it_whatever_else_is_given() {
        let mut needy = 0;
        for command in innermost(&super::all()) {
            for arg in command.get_arguments() {
                let alone = parsed(&command, &[arg]).err();
                let alone =
                    alone.filter(|error| error.kind() == ErrorKind::MissingRequiredArgument);
                let Some(ContextValue::Strings(missing)) = alone
                    .as_ref()
                    .and_then(|error| error.get(ContextKind::InvalidArg))
                else {
                    continue;
                };
                needy += 1;
                let missing = missing.join(" ");
                for other in command.get_arguments() {
                    let is_missing = other.get_long().is_some_and(|flag| missing.contains(flag));
                    let (name, own, other_id) = (command.get_name(), arg.get_id(), other.get_id());
                    assert!(
                        is_missing || parsed(&command, &[arg, other]).is_err(),
                        "{name}: {own} needs {missing}, but is accepted with {other_id} alone"
                    );
                }
            }
        }
        assert!(needy > 30, "{needy}");
    }
}
