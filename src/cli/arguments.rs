//! What the arguments ask for. Nothing below this module knows clap.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::ArgMatches;
use clap::error::ErrorKind;

use super::commands;
use super::failure::Failure;
use super::flags::{self, Given};
use super::input::Place;
use super::sweep::Wanted;
use crate::figure::Kind;
use crate::formats::name::Name;
use crate::formats::sweep_file::AtlasFile;
use crate::parameter::Parameter;
use crate::sensor::Sensor;
use crate::source::Source;
use crate::sweep::grid::{Anchor, Ranges};
use crate::sweep::plan::Shard;
use crate::sweep::range::DecimalRange;
use crate::tui::terminal::settings::Flags;
use crate::tui::theme::{ColorDepth, Palette};

/// What is asked for, and the library's folder where one is named.
#[derive(Clone, Debug)]
pub(super) struct Asked {
    pub(super) request: Request,
    pub(super) library: Option<PathBuf>,
}

/// What is to be done.
#[derive(Clone, Debug)]
pub(super) enum Request {
    /// To print this text.
    Help(String),
    /// The screen, with this sensor, on a terminal that is told about, and recorded or not.
    Screen(Sensor, Flags, Option<PathBuf>),
    /// To drive the screen without a terminal.
    Script(Script),
    /// To touch a figure.
    Figure(Box<Source>, Sensor, Form, Option<Saving>),
    /// To touch a stored shape, moved as the values say.
    Picture(OsString, Given, Form, Option<Saving>),
    /// To describe a stored shape, or what a file holds.
    Describe(OsString, Form),
    /// To answer lines.
    Batch(Sensor),
    /// To go through a grid.
    Sweep(Box<Sweep>),
    /// To put the shards in these files together.
    Merge(Vec<PathBuf>, Wanted),
    /// Something about the library.
    Library(Chore),
}

/// A grid and how it is gone through.
#[derive(Clone, Debug)]
pub(super) struct Sweep {
    pub(super) what: Swept,
    pub(super) anchor: Anchor,
    pub(super) ranges: Ranges,
    pub(super) shard: Shard,
    /// Threads; 0 for as many as there are cores.
    pub(super) jobs: usize,
    pub(super) wanted: Wanted,
}

/// What is swept.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub(super) enum Swept {
    /// A figure.
    Figure(Source, Sensor),
    /// A stored shape, on a sensor changed as the values say.
    Picture(OsString, Given),
}

/// A script and how it is run.
#[derive(Clone, Debug)]
pub(super) struct Script {
    /// Where its lines come from, where they do.
    pub(super) place: Option<Place>,
    /// Keys that are pressed before.
    pub(super) keys: Option<String>,
    pub(super) size: (u16, u16),
    pub(super) styles: bool,
    pub(super) json: bool,
}

/// What is to be done with the library.
#[derive(Clone, Debug)]
pub(super) enum Chore {
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

/// The name that a shape is to be stored under.
#[derive(Clone, Debug)]
pub(super) struct Saving {
    pub(super) name: Name,
    /// Whether an own shape of that name is replaced.
    pub(super) force: bool,
}

/// How an imprint and its descriptors are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// One line of JSON.
    Json,
    /// The matrix and a table, in mm too where a pitch is given.
    Table(Option<f64>),
}

/// What the arguments ask for; the first is the program's own name.
pub(super) fn read(arguments: Vec<OsString>) -> Result<Asked, Failure> {
    let mut command = commands::all();
    let matches = match command.try_get_matches_from_mut(arguments) {
        Ok(matches) => matches,
        Err(error) if error.use_stderr() => return Err(error.into()),
        Err(help) => {
            let request = Request::Help(help.render().to_string());
            let library = None;
            return Ok(Asked { request, library });
        }
    };
    let library = matches.get_one::<PathBuf>("library").cloned();
    let screen = Given::of(&matches);
    let Some((name, own)) = matches.subcommand() else {
        let record = matches.get_one::<PathBuf>("record").cloned();
        let request = Request::Screen(
            screen.sensor(Sensor::default())?,
            terminal(&matches),
            record,
        );
        return Ok(Asked { request, library });
    };
    if let Some(flag) = screen.first() {
        let message = format!(
            "the subcommand '{name}' cannot be used with '--{flag}', which is the screen's"
        );
        return Err(command.error(ErrorKind::ArgumentConflict, message).into());
    }
    let request = match name {
        "figure" => figure(own, &mut command)?,
        "picture" => Request::Picture(what(own), Given::of(own), form(own)?, saving(own)),
        "describe" => Request::Describe(what(own), form(own)?),
        "library" => Request::Library(chore(own)?),
        "script" => Request::Script(script(own)),
        "sweep" => Request::Sweep(Box::new(sweep(own, &mut command)?)),
        "merge" => {
            let files = own.get_many::<PathBuf>("files");
            let files = files.map(|files| files.cloned().collect());
            Request::Merge(files.unwrap_or_default(), wanted(own))
        }
        _ => Request::Batch(Given::of(own).sensor(Sensor::default())?),
    };
    Ok(Asked { request, library })
}

fn script(matches: &ArgMatches) -> Script {
    let place = matches.get_one::<PathBuf>("file").map(|file| {
        if file.as_os_str() == "-" {
            Place::Standard
        } else {
            Place::File(file.clone())
        }
    });
    let keys = matches.get_one::<String>("keys").cloned();
    // Neither a file nor keys: the script comes on standard input.
    let place = if keys.is_none() {
        place.or(Some(Place::Standard))
    } else {
        place
    };
    Script {
        place,
        keys,
        size: matches.get_one("size").copied().unwrap_or((80, 24)),
        styles: matches.get_flag("styles"),
        json: matches.get_flag("json"),
    }
}

/// What the arguments say of the terminal; whether it has ASCII only is known elsewhere.
fn terminal(matches: &ArgMatches) -> Flags {
    let chosen = |name: &str| matches.get_one::<String>(name).map(String::as_str);
    Flags {
        color: match chosen("color") {
            Some("never") => Some(ColorDepth::Never),
            Some("16") => Some(ColorDepth::Sixteen),
            Some("256") => Some(ColorDepth::TwoFiftySix),
            Some("true") => Some(ColorDepth::True),
            _ => None,
        },
        palette: match chosen("theme") {
            Some("dark") => Some(Palette::Dark),
            Some("light") => Some(Palette::Light),
            Some("mono") => Some(Palette::Mono),
            _ => None,
        },
        ascii: false,
        no_mouse: matches.get_flag("no-mouse"),
        size: matches.get_one("size").copied(),
    }
}

fn figure(matches: &ArgMatches, command: &mut clap::Command) -> Result<Request, Failure> {
    let (figure, sensor) = source(matches, command, "figure")?;
    let (form, saving) = (form(matches)?, saving(matches));
    Ok(Request::Figure(Box::new(figure), sensor, form, saving))
}

fn sweep(matches: &ArgMatches, command: &mut clap::Command) -> Result<Sweep, Failure> {
    let given = Given::of(matches);
    let mut ranges = Ranges::default();
    let read = |parameter: Parameter, range: &mut DecimalRange| {
        let given = matches.get_one::<DecimalRange>(&format!("range_{}", parameter.row().key));
        *range = given.copied().unwrap_or(*range);
    };
    read(Parameter::X0, &mut ranges.x0);
    read(Parameter::Y0, &mut ranges.y0);
    read(Parameter::Angle, &mut ranges.angle);
    read(Parameter::ZoomX, &mut ranges.zoom_x);
    read(Parameter::ZoomY, &mut ranges.zoom_y);
    let what = if let Some(picture) = matches.get_one::<OsString>("picture") {
        let size = flags::figure_parameters().find(|&parameter| given.has(parameter));
        if let Some(size) = size {
            let message = format!("'--{}' does not belong to a picture", size.flag());
            return Err(misused(command, "sweep", &message));
        }
        Swept::Picture(picture.clone(), given)
    } else {
        let (figure, sensor) = source(matches, command, "sweep")?;
        Swept::Figure(figure, sensor)
    };
    let anchor = match matches.get_one::<String>("anchor").map(String::as_str) {
        Some("centre") => Anchor::Centre,
        _ => Anchor::Corner,
    };
    Ok(Sweep {
        what,
        anchor,
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
        json: matches.get_flag("json"),
        quiet: matches.get_flag("quiet"),
    }
}

/// An error that shows the usage of the command that it is made by.
fn misused(command: &mut clap::Command, name: &str, message: &str) -> Failure {
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
) -> Result<(Source, Sensor), Failure> {
    // Required, and one of the names: there is always one.
    let kind = matches.get_one::<String>("kind");
    let kind = kind.and_then(|name| Kind::from_name(name));
    let kind = kind.unwrap_or(Kind::Ellipse);
    let given = Given::of(matches);
    if let Some(parameter) = given.foreign(kind) {
        let own = kind.parameters().map(|own| format!("--{}", own.flag()));
        let message = format!(
            "'--{}' does not belong to '{}', which takes {}",
            parameter.flag(),
            kind.name(),
            commands::list(own, "and")
        );
        return Err(misused(command, name, &message));
    }
    let sensor = given.sensor(Sensor::default())?;
    let figure = Source::Figure(given.figure(kind, sensor.side())?);
    Ok((figure, sensor))
}

fn chore(matches: &ArgMatches) -> Result<Chore, Failure> {
    let Some((command, own)) = matches.subcommand() else {
        // Required: there is always one.
        return Ok(Chore::Path);
    };
    let name = own.try_get_one::<Name>("name").ok().flatten().cloned();
    Ok(match (command, name) {
        ("list", _) => Chore::List(own.get_flag("json")),
        ("show", Some(name)) => Chore::Show(name, form(own)?),
        ("save", Some(name)) => {
            let force = own.get_flag("force");
            Chore::Save(Saving { name, force }, what(own))
        }
        ("delete", Some(name)) => Chore::Delete(name),
        ("restore", Some(name)) => Chore::Restore(name),
        ("check", _) => Chore::Check,
        _ => Chore::Path,
    })
}

/// The argument that is a name or a file; required.
fn what(matches: &ArgMatches) -> OsString {
    let what = matches.get_one::<OsString>("what");
    what.cloned().unwrap_or_default()
}

fn saving(matches: &ArgMatches) -> Option<Saving> {
    let name = matches.get_one::<Name>("save")?.clone();
    let force = matches.get_flag("force");
    Some(Saving { name, force })
}

fn form(matches: &ArgMatches) -> Result<Form, Failure> {
    let pitch = Given::of(matches).pitch()?;
    Ok(if matches.get_flag("json") {
        Form::Json
    } else {
        Form::Table(pitch)
    })
}
