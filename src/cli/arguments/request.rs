//! What the arguments ask for. Nothing below this module knows clap.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::ArgMatches;
use clap::error::ErrorKind;
use clap::parser::ValueSource;

use crate::cli::arguments::definitions;
use crate::cli::arguments::parameters;
use crate::cli::arguments::parameters::Given;
use crate::cli::arguments::program::Script;
use crate::cli::commands::completions::Shell;
use crate::cli::commands::export::Export;
use crate::cli::commands::sweep::Wanted;
use crate::cli::error::CliError;
use crate::cli::settings::flags::Chosen;
use crate::cli::settings::pitch::Pitch;
use crate::cli::settings::resolved::{Effective, Loaded};
use crate::figure::FigureKind;
use crate::formats::Name;
use crate::pose::{Anchor, GivenRanges};
use crate::sensor::Sensor;
use crate::source::Source;
use crate::storage::AtlasFile;
use crate::sweep::Shard;

/// What is asked for, and with which settings.
#[derive(Clone, Debug)]
pub(crate) struct Asked {
    pub(crate) request: Request,
    /// Whether the arguments name the library's folder.
    pub(crate) library_named: bool,
    pub(crate) settings: Effective,
}

/// What is to be done.
#[derive(Clone, Debug)]
pub(crate) enum Request {
    /// To print this text.
    Help(String),
    /// The screen, of so many columns and rows whatever the terminal says, and recorded or not.
    Screen(Option<(u16, u16)>, Option<PathBuf>),
    /// To drive the screen without a terminal.
    Script(Script),
    /// To touch a figure.
    Figure(Box<Source>, Sensor, Form, Kept),
    /// To touch a stored shape, moved as the values say.
    Picture(OsString, Given, Form, Kept),
    /// To describe a stored shape, or what a file holds.
    Describe(OsString, Form),
    /// To write a shape of the library or of a file, in mm where a pitch is given.
    Export(OsString, Export, Pitch),
    /// To answer lines.
    Batch(Sensor),
    /// To go through a grid.
    Sweep(Box<SweepArguments>),
    /// To put the shards in these files together.
    Merge(Vec<PathBuf>, Wanted),
    /// Something about the library.
    Library(Chore),
    /// To print the settings.
    Settings,
    /// To print completions.
    Completions(Shell),
    /// To print the program's page of the manual, or to write all pages into a folder.
    Man(Option<PathBuf>),
}

/// A grid and how it is gone through.
#[derive(Clone, Debug)]
pub(crate) struct SweepArguments {
    pub(crate) what: Swept,
    pub(crate) anchor: Anchor,
    pub(crate) ranges: GivenRanges,
    pub(crate) shard: Shard,
    /// Threads; 0 for as many as there are cores.
    pub(crate) jobs: usize,
    pub(crate) wanted: Wanted,
}

/// What is swept.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub(crate) enum Swept {
    /// A figure.
    Figure(Source, Sensor),
    /// A stored shape, on a sensor changed as the values say.
    Picture(OsString, Given),
}

/// What is to be done with the library.
#[derive(Clone, Debug)]
pub(crate) enum Chore {
    /// To list it; as JSON or not.
    List(bool),
    /// To describe one of its shapes.
    Show(Name, Form),
    /// To store a shape of the library or of a file.
    Save(Saving, OsString),
    /// To move a shape into the trash.
    Delete(Name),
    /// To bring it back.
    Restore(Name),
    /// To tell its folder.
    Path,
    /// To read all of it.
    Check,
}

/// What is to be kept of a touch.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    pub(crate) saving: Option<Saving>,
    pub(crate) export: Option<Export>,
}

/// The name that a shape is to be stored under.
#[derive(Clone, Debug)]
pub(crate) struct Saving {
    pub(crate) name: Name,
    /// Whether an own shape of that name is replaced.
    pub(crate) force: bool,
}

/// How an imprint and its descriptors are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    /// One line of JSON; what is drawn beside it is in mm where a pitch is known.
    Json(Pitch),
    /// The matrix and a table, in mm too where a pitch is known.
    Table(Pitch),
}

/// What the arguments ask for; the first is the program's own name.
pub(crate) fn read(arguments: Vec<OsString>) -> Result<Asked, CliError> {
    let mut command = definitions::all();
    let matches = match command.try_get_matches_from_mut(arguments) {
        Ok(matches) => matches,
        Err(error) if error.use_stderr() => return Err(error.into()),
        Err(help) => {
            let none = Chosen::default();
            return Ok(Asked {
                request: Request::Help(help.render().to_string()),
                library_named: false,
                settings: Effective::new(Loaded::default(), none, |_| None)?,
            });
        }
    };
    let asked = || matches.get_one::<PathBuf>("config").cloned();
    let library_named = matches.contains_id("library");
    let Some((name, own)) = matches.subcommand() else {
        let settings = effective(Loaded::find(asked())?, &matches)?;
        let size = matches.get_one("size").copied();
        let record = matches.get_one::<PathBuf>("record").cloned();
        return Ok(Asked {
            request: Request::Screen(size, record),
            library_named,
            settings,
        });
    };
    if let Some(flag) = Given::of(&matches).first().or(of_screen(&matches)) {
        let message = format!(
            "the subcommand '{name}' cannot be used with '--{flag}', which is the screen's"
        );
        return Err(command.error(ErrorKind::ArgumentConflict, message).into());
    }
    let loaded = match (name, asked()) {
        // What these print is the same for everybody.
        ("completions" | "man", _) | ("script", None) => Loaded::default(),
        (_, asked) => Loaded::find(asked)?,
    };
    let settings = effective(loaded, own)?;
    let request = request(name, own, &mut command, &settings)?;
    Ok(Asked {
        request,
        library_named,
        settings,
    })
}

/// A flag of the screen that is given, as what comes before a command would be lost.
fn of_screen(matches: &ArgMatches) -> Option<String> {
    let flags = ["color", "theme", "no-mouse", "size", "record"];
    let given = |flag: &&str| matches.value_source(flag) == Some(ValueSource::CommandLine);
    flags.into_iter().find(given).map(str::to_owned)
}

fn effective(loaded: Loaded, matches: &ArgMatches) -> Result<Effective, CliError> {
    Effective::new(loaded, Chosen::of(matches), std::env::var_os)
}

/// What a command asks for.
fn request(
    name: &str,
    own: &ArgMatches,
    command: &mut clap::Command,
    settings: &Effective,
) -> Result<Request, CliError> {
    Ok(match name {
        "figure" => {
            let (figure, sensor) = source(own, command, "figure", settings)?;
            let kept = kept(own, command, "figure")?;
            Request::Figure(Box::new(figure), sensor, form(own, settings)?, kept)
        }
        "config" => Request::Settings,
        "picture" => {
            let kept = kept(own, command, "picture")?;
            Request::Picture(what(own)?, Given::of(own), form(own, settings)?, kept)
        }
        "describe" => Request::Describe(what(own)?, form(own, settings)?),
        "export" => {
            let pitch = pitch(own, settings)?;
            let to = required::<PathBuf>(own, "to")?;
            let export = export(own, &to, command, "export")?;
            Request::Export(what(own)?, export, pitch)
        }
        "library" => Request::Library(chore(own, settings)?),
        "script" => Request::Script(Script::of(own)),
        "completions" => Request::Completions(required::<Shell>(own, "shell")?),
        "man" => Request::Man(own.get_one::<PathBuf>("folder").cloned()),
        "sweep" => Request::Sweep(Box::new(sweep(own, command, settings)?)),
        "merge" => {
            let files = own.get_many::<PathBuf>("files").into_iter().flatten();
            Request::Merge(files.cloned().collect(), wanted(own))
        }
        _ => Request::Batch(settings.sensor()),
    })
}

fn sweep(
    matches: &ArgMatches,
    command: &mut clap::Command,
    settings: &Effective,
) -> Result<SweepArguments, CliError> {
    let given = Given::of(matches);
    let ranges = GivenRanges::from_fn(|axis| {
        let range = matches.get_one(&format!("range_{}", axis.name()));
        range.copied()
    });
    let what = if let Some(picture) = matches.get_one::<OsString>("picture") {
        let size = parameters::figure_parameters().find(|&parameter| given.has(parameter));
        if let Some(size) = size {
            let message = format!("'--{}' does not belong to a picture", size.flag());
            return Err(misused(command, "sweep", &message));
        }
        Swept::Picture(picture.clone(), given)
    } else {
        let (figure, sensor) = source(matches, command, "sweep", settings)?;
        Swept::Figure(figure, sensor)
    };
    let anchor = matches.get_one::<Anchor>("anchor").copied();
    Ok(SweepArguments {
        what,
        anchor: anchor.unwrap_or_default(),
        ranges,
        shard: matches.get_one("shard").copied().unwrap_or(Shard::WHOLE),
        jobs: matches
            .get_one::<u16>("jobs")
            .map_or(0, |&jobs| jobs.into()),
        wanted: wanted(matches),
    })
}

fn wanted(matches: &ArgMatches) -> Wanted {
    let poses = matches.try_get_one::<PathBuf>("poses");
    Wanted {
        atlas: matches.get_one::<AtlasFile>("atlas").cloned(),
        poses: poses.ok().flatten().cloned(),
        existing: parameters::existing(matches),
        json: matches.get_flag("json"),
        quiet: matches.get_flag("quiet"),
    }
}

/// An error that shows the usage of the command that it is made by.
fn misused(command: &mut clap::Command, name: &str, message: &str) -> CliError {
    let error = command.find_subcommand_mut(name).map_or_else(
        || clap::Error::raw(ErrorKind::ArgumentConflict, format!("{message}\n")),
        |command| command.error(ErrorKind::ArgumentConflict, message),
    );
    error.into()
}

/// The figure that the arguments of a command give, and the sensor.
fn source(
    matches: &ArgMatches,
    command: &mut clap::Command,
    name: &str,
    settings: &Effective,
) -> Result<(Source, Sensor), CliError> {
    let kind = required::<FigureKind>(matches, "kind")?;
    let given = Given::of(matches);
    if let Some(parameter) = given.foreign(kind) {
        let own = kind
            .parameters()
            .iter()
            .map(|own| format!("--{}", own.flag()));
        let message = format!(
            "'--{}' does not belong to '{}', which takes {}",
            parameter.flag(),
            kind.name(),
            definitions::list(own, "and")
        );
        return Err(misused(command, name, &message));
    }
    let sensor = settings.sensor();
    let figure = Source::Figure(given.figure(kind, &sensor)?);
    Ok((figure, sensor))
}

fn chore(matches: &ArgMatches, settings: &Effective) -> Result<Chore, CliError> {
    let Some((command, own)) = matches.subcommand() else {
        // Required: there is always one.
        return Ok(Chore::Path);
    };
    let name = own.try_get_one::<Name>("name").ok().flatten().cloned();
    Ok(match (command, name) {
        ("list", _) => Chore::List(own.get_flag("json")),
        ("show", Some(name)) => Chore::Show(name, form(own, settings)?),
        ("save", Some(name)) => {
            let force = own.get_flag("force");
            Chore::Save(Saving { name, force }, what(own)?)
        }
        ("delete", Some(name)) => Chore::Delete(name),
        ("restore", Some(name)) => Chore::Restore(name),
        ("check", _) => Chore::Check,
        _ => Chore::Path,
    })
}

/// The argument that is a name or a file.
fn what(matches: &ArgMatches) -> Result<OsString, CliError> {
    required(matches, "what")
}

/// The value of an argument that clap makes sure of: without it the command is refused before this is called.
fn required<T: Clone + Send + Sync + 'static>(
    matches: &ArgMatches,
    id: &str,
) -> Result<T, CliError> {
    matches.get_one::<T>(id).cloned().ok_or_else(|| {
        let message = format!("the argument '{id}' is required\n");
        clap::Error::raw(ErrorKind::MissingRequiredArgument, message).into()
    })
}

fn kept(matches: &ArgMatches, command: &mut clap::Command, name: &str) -> Result<Kept, CliError> {
    let path = matches.get_one::<PathBuf>("export");
    let export = path.map(|path| export(matches, path, command, name));
    Ok(Kept {
        saving: saving(matches),
        export: export.transpose()?,
    })
}

/// The file at the path, in the format that it has or that is given.
fn export(
    matches: &ArgMatches,
    path: &Path,
    command: &mut clap::Command,
    name: &str,
) -> Result<Export, CliError> {
    let format = matches.get_one::<String>("format").map(String::as_str);
    let export = Export::new(path, format, parameters::existing(matches));
    export.map_err(|message| misused(command, name, &message))
}

fn saving(matches: &ArgMatches) -> Option<Saving> {
    let name = matches.get_one::<Name>("save")?.clone();
    let force = matches.get_flag("force");
    Some(Saving { name, force })
}

fn pitch(matches: &ArgMatches, settings: &Effective) -> Result<Pitch, CliError> {
    Ok(Pitch {
        given: Given::of(matches).pitch()?,
        usual: settings.pitch(),
    })
}

fn form(matches: &ArgMatches, settings: &Effective) -> Result<Form, CliError> {
    let pitch = pitch(matches, settings)?;
    Ok(if matches.get_flag("json") {
        Form::Json(pitch)
    } else {
        Form::Table(pitch)
    })
}
