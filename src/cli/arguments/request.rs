//! Turns the arguments that clap has parsed into a [`Request`]: plain values, typed and checked. Only this module and
//! those beside it know clap.
//!
//! Settings are resolved here, since they provide defaults: the sensor of a figure, the pitch of a table.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::ArgMatches;
use clap::error::ErrorKind;
use clap::parser::ValueSource;

use crate::cli::arguments::advice::with_tips;
use crate::cli::arguments::definitions;
use crate::cli::arguments::export::Export;
use crate::cli::arguments::flags::{self, required, unhandled_subcommand};
use crate::cli::arguments::frames::FramesArguments;
use crate::cli::arguments::groups;
use crate::cli::arguments::model::ModelRequest;
use crate::cli::arguments::parameters;
use crate::cli::arguments::parameters::{Given, ShardFile};
use crate::cli::arguments::program::{Script, Shell};
use crate::cli::arguments::recognise::RecogniseArguments;
use crate::cli::arguments::watch::WatchArguments;
use crate::cli::error::CliError;
use crate::cli::settings::flags::Chosen;
use crate::cli::settings::pitch::Pitch;
use crate::cli::settings::resolved::{Effective, Loaded};
use crate::figure::FigureKind;
use crate::formats::Name;
use crate::memory::MemorySize;
use crate::pose::{Anchor, GivenRanges};
use crate::quote::joined;
use crate::sensor::Sensor;
use crate::source::Source;
use crate::storage::AtlasFile;
use crate::sweep::Shard;

/// The request of a command line, and the settings for it.
#[derive(Clone, Debug)]
pub(crate) struct Invocation {
    /// The command.
    pub(crate) request: Request,
    /// Whether `--library` is given.
    pub(crate) library_named: bool,
    /// The settings in effect.
    pub(crate) settings: Effective,
}

/// A command with its arguments.
#[derive(Clone, Debug)]
pub(crate) enum Request {
    /// Print this text: the help, or the version.
    Help(String),
    /// Open the screen: with this size instead of the terminal's, and recording into this file, if given.
    Screen(Option<(u16, u16)>, Option<PathBuf>),
    /// Run a script.
    Script(Script),
    /// Touch a figure.
    Figure(Box<Source>, Sensor, Form, Kept),
    /// Touch a stored shape after changing the given values.
    Picture(OsString, Given, Form, Kept),
    /// Describe a stored shape or a file.
    Describe(OsString, Form),
    /// Write a stored shape or a file in another format.
    Export(OsString, Export, Pitch),
    /// Answer lines of JSON from a file or standard input; with the sensor for lines without one, and the number of
    /// threads (0 means one per core).
    Batch(Option<PathBuf>, Sensor, usize),
    /// Sweep a grid of poses.
    Sweep(Box<SweepArguments>),
    /// Merge the shards in these files.
    Merge(Vec<PathBuf>, Wanted),
    /// A subcommand of `taxel model`.
    Model(ModelRequest),
    /// Name the shape that left an imprint.
    Recognise(Box<RecogniseArguments>),
    /// List a recording, or describe its frames.
    Frames(Box<FramesArguments>, Form, Kept),
    /// Answer the frames of a source as they arrive.
    Watch(Box<WatchArguments>),
    /// A subcommand of `taxel library`.
    Library(LibraryCommand),
    /// Print the settings.
    Settings,
    /// Print completions for a shell.
    Completions(Shell),
    /// Print the manual page of the program, or write those of all commands into a folder.
    Man(Option<PathBuf>),
}

/// The arguments of `taxel sweep`.
#[derive(Clone, Debug)]
pub(crate) struct SweepArguments {
    /// The shape to sweep.
    pub(crate) what: Swept,
    /// The point of the shape that x0 and y0 place.
    pub(crate) anchor: Anchor,
    /// The axes that are given. The others use the range of the paper, or for x0 and y0 a cell that suits the shape.
    pub(crate) ranges: GivenRanges,
    /// The part of the grid to sweep.
    pub(crate) shard: Shard,
    /// The number of threads; 0 means one per core.
    pub(crate) jobs: usize,
    /// The files to write, and the form of the summary.
    pub(crate) wanted: Wanted,
}

/// The files that a sweep or a merge writes, and the form of its summary.
#[derive(Clone, Debug)]
pub(crate) struct Wanted {
    /// `--atlas`: the file of all distinct imprints.
    pub(crate) atlas: Option<AtlasFile>,
    /// `--poses`: the file of each pose's imprint.
    pub(crate) poses: Option<PathBuf>,
    /// The action if a file exists already.
    pub(crate) there: ShardFile,
    /// Whether the summary is one line of JSON.
    pub(crate) json: bool,
    /// Whether to show no progress and no notes.
    pub(crate) quiet: bool,
    /// `--memory`: the most memory to use.
    pub(crate) memory: Option<MemorySize>,
}

/// The shape of a sweep.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub(crate) enum Swept {
    /// A figure on a sensor.
    Figure(Source, Sensor),
    /// A stored shape, which is read later, and the given values of its sensor.
    Picture(OsString, Given),
}

/// The shapes whose names are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NameSet {
    /// All shapes: the user's own and those that come with the program.
    All,
    /// The user's own shapes.
    Own,
    /// The deleted shapes, the last deleted first.
    Deleted,
}

/// A subcommand of `taxel library`.
#[derive(Clone, Debug)]
pub(crate) enum LibraryCommand {
    /// List all shapes; true for JSON.
    List(bool),
    /// Print the names of some shapes.
    Names(NameSet),
    /// Describe a shape.
    Show(Name, Form),
    /// Store a shape of the library or of a file under a name.
    Save(Saving, OsString),
    /// Move a shape to the trash.
    Delete(Name),
    /// Restore a deleted shape.
    Restore(Name),
    /// Print the library's folder.
    Path,
    /// Read every shape and report what is damaged or left over; true for JSON.
    Check(bool),
}

/// The places in which a touch is kept, in addition to printing it.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    /// The name to store the shape under: `--save`.
    pub(crate) saving: Option<Saving>,
    /// The file to write: `--export`.
    pub(crate) export: Option<Export>,
}

impl Kept {
    /// Returns true if anything is to be kept.
    pub(crate) fn is_asked(&self) -> bool {
        self.saving.is_some() || self.export.is_some()
    }
}

/// How to store a shape.
#[derive(Clone, Debug)]
pub(crate) struct Saving {
    /// The name of the stored shape.
    pub(crate) name: Name,
    /// Whether to replace an own shape of this name.
    pub(crate) force: bool,
}

/// The form in which an imprint and its descriptors are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    /// One line of JSON, in cells. The pitch is for a drawing that is exported too.
    Json(Pitch),
    /// The matrix and a table, which is in mm too if the pitch is known.
    Table(Pitch),
}

/// Reads the arguments, the first of which is the program's own name, and the settings.
///
/// # Errors
/// Returns [`CliError::Usage`] with clap's message; [`CliError::Settings`] for the settings file; [`CliError::Range`]
/// for values out of range.
pub(crate) fn read(arguments: Vec<OsString>) -> Result<Invocation, CliError> {
    let mut command = groups::grouped(definitions::all());
    let matches = match command.try_get_matches_from_mut(arguments) {
        Ok(matches) => matches,
        Err(error) if error.use_stderr() => {
            return Err(with_tips(error, &mut command).into());
        }
        Err(help) => {
            let none = Chosen::default();
            return Ok(Invocation {
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
        return Ok(Invocation {
            request: Request::Screen(size, record),
            library_named,
            settings,
        });
    };
    if let Some(flag) = Given::of(&matches).first().or(of_screen(&matches)) {
        let message = too_early(&flag, name, &command);
        return Err(command.error(ErrorKind::ArgumentConflict, message).into());
    }
    if definitions::WITHOUT_LIBRARY.contains(&name) && (library_named || own.contains_id("library"))
    {
        let message = format!("'--library' does not belong to '{name}', which uses no library");
        return Err(misused(&mut command, name, &message));
    }
    if let Some(message) = shared_input(deepest(own)) {
        return Err(misused(&mut command, name, &message));
    }
    let loaded = match (name, asked()) {
        // The output of these does not depend on settings.
        ("completions" | "man", _) | ("script", None) => Loaded::default(),
        (_, asked) => Loaded::find(asked)?,
    };
    let settings = effective(loaded, own)?;
    let request = request(name, own, &mut command, &settings)?;
    Ok(Invocation {
        request,
        library_named,
        settings,
    })
}

/// Returns the arguments of the innermost command, such as those of `model train`.
fn deepest(matches: &ArgMatches) -> &ArgMatches {
    matches
        .subcommand()
        .map_or(matches, |(_, own)| deepest(own))
}

/// Returns the message that two arguments both stand for standard input, which can be read only once; None if at most
/// one does.
fn shared_input(matches: &ArgMatches) -> Option<String> {
    let inputs = ["file", "what", "set", "source", "mask", "gain"];
    let mut standard = inputs.into_iter().flat_map(|id| {
        let given = matches.try_get_raw(id).ok().flatten();
        let standard = given.into_iter().flatten().filter(|value| *value == "-");
        standard.map(move |_| id)
    });
    let text = |id: &str| match id {
        "mask" | "gain" => format!("--{id} -"),
        _ => "-".to_owned(),
    };
    let (one, other) = (standard.next()?, standard.next()?);
    Some(format!(
        "'{}' and '{}' both stand for standard input, which can be read only once",
        text(one),
        text(other)
    ))
}

/// Returns the first given flag of the screen. Before a command such a flag would have no effect, so it is refused.
fn of_screen(matches: &ArgMatches) -> Option<String> {
    let flags = ["color", "theme", "no-mouse", "size", "record"];
    let given = |flag: &&str| matches.value_source(flag) == Some(ValueSource::CommandLine);
    flags.into_iter().find(given).map(str::to_owned)
}

/// Returns the message about a flag of the screen before the command `name`.
fn too_early(flag: &str, name: &str, command: &clap::Command) -> String {
    let has_flag =
        |own: &clap::Command| own.get_arguments().any(|own| own.get_long() == Some(flag));
    if command.find_subcommand(name).is_some_and(has_flag) {
        format!("'--{flag}' must come after '{name}'; before it, it is a flag of the screen")
    } else {
        format!(
            "the subcommand '{name}' cannot be used with '--{flag}', which is only for the screen"
        )
    }
}

/// Returns the settings in effect, from the file, the flags of a command and the environment.
fn effective(loaded: Loaded, matches: &ArgMatches) -> Result<Effective, CliError> {
    Effective::new(loaded, Chosen::of(matches), std::env::var_os)
}

/// Reads the arguments of the command `name`. `command` is for usage errors.
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
            let to = required::<PathBuf>(own, "to")?;
            let export = export(own, &to, command, "export")?;
            let pitch = pitch_of_export(own, settings, &export)?;
            Request::Export(what(own)?, export, pitch)
        }
        "watch" => {
            let source = required::<OsString>(own, "source")?;
            Request::Watch(Box::new(WatchArguments::of(
                own,
                source,
                settings.sensors(),
            )?))
        }
        "frames" => {
            let file = required::<PathBuf>(own, "file")?;
            let kept = kept(own, command, "frames")?;
            let asked = FramesArguments::of(own, file, settings.sensors())?;
            Request::Frames(Box::new(asked), form(own, settings)?, kept)
        }
        "library" => Request::Library(library_command(own, settings)?),
        "script" => Request::Script(Script::of(own)),
        "completions" => Request::Completions(required::<Shell>(own, "shell")?),
        "man" => Request::Man(man_folder(own, command)?),
        "sweep" => Request::Sweep(Box::new(sweep(own, command, settings)?)),
        "merge" => {
            let files = own.get_many::<PathBuf>("files").into_iter().flatten();
            Request::Merge(files.cloned().collect(), wanted(own))
        }
        "model" => Request::Model(ModelRequest::of(own)?),
        "recognise" => Request::Recognise(Box::new(RecogniseArguments::of(
            own,
            pitch(own, settings)?.of(None),
        ))),
        "batch" => {
            let file = own.get_one::<PathBuf>("file").cloned();
            let file = file.filter(|file| file.as_os_str() != "-");
            Request::Batch(file, settings.sensor(), flags::jobs_of(own))
        }
        other => return Err(unhandled_subcommand(other)),
    })
}

/// Reads the arguments of `taxel sweep`.
///
/// # Errors
/// Returns a usage error for sizes of a figure given with a picture, and the errors of [`source`].
fn sweep(
    matches: &ArgMatches,
    command: &mut clap::Command,
    settings: &Effective,
) -> Result<SweepArguments, CliError> {
    let given = Given::of(matches);
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
        ranges: flags::ranges_of(matches),
        shard: flags::shard_of(matches),
        jobs: flags::jobs_of(matches),
        wanted: wanted(matches),
    })
}

/// Reads what a sweep or a merge is to write and print.
fn wanted(matches: &ArgMatches) -> Wanted {
    let poses = matches.try_get_one::<PathBuf>("poses");
    Wanted {
        atlas: matches.get_one::<AtlasFile>("atlas").cloned(),
        poses: poses.ok().flatten().cloned(),
        there: ShardFile::of(matches),
        json: matches.get_flag("json"),
        quiet: matches.get_flag("quiet"),
        memory: flags::memory_of(matches),
    }
}

/// Returns a usage error with the usage of the command `name`.
fn misused(command: &mut clap::Command, name: &str, message: &str) -> CliError {
    let error = command.find_subcommand_mut(name).map_or_else(
        || clap::Error::raw(ErrorKind::ArgumentConflict, format!("{message}\n")),
        |command| command.error(ErrorKind::ArgumentConflict, message),
    );
    error.into()
}

/// Returns the figure given to a command, and its sensor.
///
/// # Errors
/// Returns a usage error for a parameter that this kind of figure does not have; [`CliError::Range`] for values out
/// of range.
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
            joined(own, "and")
        );
        return Err(misused(command, name, &message));
    }
    let sensor = settings.sensor();
    let figure = Source::Figure(given.figure(kind, &sensor)?);
    Ok((figure, sensor))
}

/// Returns the folder for manual pages, if one is given.
///
/// # Errors
/// Returns a usage error if the folder is the name of a command: its page was meant.
fn man_folder(
    matches: &ArgMatches,
    command: &mut clap::Command,
) -> Result<Option<PathBuf>, CliError> {
    let folder = matches.get_one::<PathBuf>("folder").cloned();
    let named = folder.as_ref().and_then(|folder| folder.to_str());
    match named.filter(|name| command.find_subcommand(name).is_some()) {
        Some(name) => {
            let message = format!(
                "'{name}' is a command, which 'taxel help {name}' explains; as a folder, write './{name}'"
            );
            Err(misused(command, "man", &message))
        }
        None => Ok(folder),
    }
}

/// Reads the subcommand of `taxel library`.
fn library_command(matches: &ArgMatches, settings: &Effective) -> Result<LibraryCommand, CliError> {
    let Some((command, own)) = matches.subcommand() else {
        // clap requires a subcommand, so there is always one.
        return Err(unhandled_subcommand("library"));
    };
    let name = own.try_get_one::<Name>("name").ok().flatten().cloned();
    Ok(match (command, name) {
        ("list", _) if own.get_flag("own") => LibraryCommand::Names(NameSet::Own),
        ("list", _) if own.get_flag("deleted") => LibraryCommand::Names(NameSet::Deleted),
        ("list", _) if own.get_flag("names") => LibraryCommand::Names(NameSet::All),
        ("list", _) => LibraryCommand::List(own.get_flag("json")),
        ("show", Some(name)) => LibraryCommand::Show(name, form(own, settings)?),
        ("save", Some(name)) => {
            let force = own.get_flag("force");
            LibraryCommand::Save(Saving { name, force }, what(own)?)
        }
        ("delete", Some(name)) => LibraryCommand::Delete(name),
        ("restore", Some(name)) => LibraryCommand::Restore(name),
        ("check", _) => LibraryCommand::Check(own.get_flag("json")),
        ("path", _) => LibraryCommand::Path,
        (other, _) => return Err(unhandled_subcommand(other)),
    })
}

/// Returns the argument that is a name or a file.
fn what(matches: &ArgMatches) -> Result<OsString, CliError> {
    required(matches, "what")
}

/// Reads what to keep of a touch.
///
/// # Errors
/// Returns an error if standard output would get more than one export: an answer too, or several frames.
fn kept(matches: &ArgMatches, command: &mut clap::Command, name: &str) -> Result<Kept, CliError> {
    let path = matches.get_one::<PathBuf>("export");
    if path.is_some_and(|path| path.as_os_str() == "-") {
        if matches.get_flag("json") {
            return Err(CliError::Unused {
                flag: "json",
                reason: "with '--export -', which writes to standard output in its place"
                    .to_owned(),
            });
        }
        // Only `taxel frames` has this flag.
        if let Ok(Some(true)) = matches.try_get_one::<bool>("all") {
            let message = "the argument '--all' cannot be used with '--export -', which takes one frame; \
                           with a name each frame has a file of its own";
            return Err(misused(command, name, message));
        }
    }
    let export = path.map(|path| export(matches, path, command, name));
    Ok(Kept {
        saving: saving(matches),
        export: export.transpose()?,
    })
}

/// Returns the file to write, in the format given by `--format` or by its extension.
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

/// Returns the pitch for an export.
///
/// # Errors
/// Returns [`CliError::Unused`] if a flag gives one and nothing is drawn.
fn pitch_of_export(
    matches: &ArgMatches,
    settings: &Effective,
    export: &Export,
) -> Result<Pitch, CliError> {
    let pitch = pitch(matches, settings)?;
    if pitch.given.is_some() && !export.is_drawing() {
        let reason = "on this format: it is for drawings".to_owned();
        return Err(CliError::Unused {
            flag: "pitch",
            reason,
        });
    }
    Ok(pitch)
}

/// Reads `--save` with its `--force`.
fn saving(matches: &ArgMatches) -> Option<Saving> {
    let name = matches.get_one::<Name>("save")?.clone();
    let force = matches.get_flag("force");
    Some(Saving { name, force })
}

/// Returns the pitch of the flags and of the settings.
fn pitch(matches: &ArgMatches, settings: &Effective) -> Result<Pitch, CliError> {
    Ok(Pitch {
        given: Given::of(matches).pitch()?,
        usual: settings.pitch(),
    })
}

/// Returns JSON for `--json`, otherwise a table.
fn form(matches: &ArgMatches, settings: &Effective) -> Result<Form, CliError> {
    let pitch = pitch(matches, settings)?;
    Ok(if matches.get_flag("json") {
        Form::Json(pitch)
    } else {
        Form::Table(pitch)
    })
}
