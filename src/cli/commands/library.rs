//! `taxel library`: lists, shows, stores, deletes, restores and checks shapes.

use std::ffi::OsString;
use std::io::{self, IsTerminal};
use std::iter;

use clap::{Args, Subcommand};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde_json::{Value, json};
use taxel_core::description::{Region, RegionKind, regions};
use taxel_core::quote::{as_argument, shortened_message};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::touch::Plane;
use taxel_files::formats::{Content, Name, StoredShape, json};
use taxel_files::storage::{Library, LibraryEntry, LibraryError, ShapeOrigin};

use crate::cli::Context;
use crate::cli::arguments::flags::name_or_path;
use crate::cli::arguments::parameters::{Given, OwnSensorFlags, PitchFlag};
use crate::cli::commands::describe::described;
use crate::cli::commands::export;
use crate::cli::failure::{Failure, Named};
use crate::cli::input::outlines::OutlineFlags;
use crate::cli::output::charset::Charset;
use crate::cli::output::table::Record;

const EXAMPLES: &str = "\
A library is a folder with one JSON file per shape. The shapes that come with
the program are always listed; you can copy them, but not change them. A name
has 1 to 64 letters, digits, spaces, '-', '_' or '.'; case does not matter.
The folder is the one that --library names; if it is not given, the one in the
variable TAXEL_LIBRARY, then the 'library' of the settings, then
~/.local/share/taxel/library.

Examples:
  taxel library list
  taxel library show washer
  taxel library save ring imprint.txt
  taxel library --library ./shapes check";

/// List, show, save, delete and check stored shapes
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct LibraryCommand {
    #[command(subcommand)]
    command: Act,
}

#[derive(Debug, Subcommand)]
enum Act {
    /// List all shapes
    #[command(after_help = LIST_EXAMPLES)]
    List {
        /// Print JSON, one line per answer
        #[arg(long)]
        json: bool,
    },
    /// Show a shape and describe it
    #[command(after_help = SHOW_EXAMPLES)]
    Show {
        /// Name of the shape
        #[arg(value_parser = Name::new)]
        name: Name,
        #[command(flatten)]
        pitch: PitchFlag,
        /// Print JSON, one line per answer
        #[arg(long)]
        json: bool,
    },
    /// Store a shape under a name
    #[command(after_help = SAVE_EXAMPLES)]
    Save {
        /// Name to store it under
        #[arg(value_parser = Name::new)]
        name: Name,
        /// Shape of the library, or file; '-' for standard input
        #[arg(value_name = "NAME|FILE", value_parser = name_or_path())]
        what: OsString,
        /// Replace an existing shape of this name
        #[arg(long)]
        force: bool,
    },
    /// Store an outline under a name
    #[command(after_help = IMPORT_EXAMPLES)]
    Import {
        /// Outline: an SVG, a CSV of points, or a stored shape; '-' for standard input
        #[arg(value_name = "FILE|NAME", value_parser = name_or_path())]
        what: OsString,
        /// Name to store it under
        #[arg(long, value_parser = Name::new)]
        name: Name,
        #[command(flatten)]
        sensor: OwnSensorFlags,
        #[command(flatten)]
        outlines: OutlineFlags,
        /// Replace an existing shape of this name
        #[arg(long)]
        force: bool,
    },
    /// Move a shape to the trash
    #[command(after_help = DELETE_EXAMPLES)]
    Delete {
        /// Name of the shape
        #[arg(value_parser = Name::new)]
        name: Name,
    },
    /// Restore a deleted shape
    #[command(after_help = RESTORE_EXAMPLES)]
    Restore {
        /// Name of the shape
        #[arg(value_parser = Name::new)]
        name: Name,
    },
    /// Print the library's folder
    #[command(after_help = PATH_EXAMPLES)]
    Path,
    /// Find broken shapes and stray files
    #[command(after_help = CHECK_EXAMPLES)]
    Check {
        /// Print JSON, one line per answer
        #[arg(long)]
        json: bool,
    },
}

impl LibraryCommand {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        match self.command {
            Act::List { json } => list(json, cx),
            Act::Show { name, pitch, json } => {
                let pitch = pitch.pitch(&cx.settings)?;
                let loaded = cx.shelf.readable().load(name.as_str());
                let shape = loaded.map_err(|error| cx.shelf.refused(error))?.shape;
                cx.print(&described(&Content::Shape(shape), json, pitch))
            }
            Act::Save { name, what, force } => {
                let shape = match cx.shelf.find(&what)? {
                    Content::Shape(shape) => shape.renamed(name),
                    Content::Imprint(imprint) => StoredShape {
                        name,
                        sensor: Sensor::of_size(imprint.size()),
                        imprint,
                        source: None,
                    },
                };
                let name = cx.shelf.save(&shape, export::replacing(force))?;
                cx.print(&format!("saved as {name}\n"))
            }
            Act::Import {
                what,
                name,
                sensor,
                outlines,
                force,
            } => {
                let (source, sensor) = outlines.placed(&what, &Given::default(), &sensor, cx)?;
                if !matches!(source, Source::Outline(_)) {
                    let text = "not an outline; for an imprint, use taxel library save";
                    return Err(Failure::new(text)).named(what.display());
                }
                let shape = StoredShape {
                    name,
                    sensor,
                    imprint: Plane::new(sensor).touch(&source),
                    source: Some(source),
                };
                let name = cx.shelf.save(&shape, export::replacing(force))?;
                cx.print(&format!("saved as {name}\n"))
            }
            Act::Delete { name } => delete(&name, cx),
            Act::Restore { name } => {
                let restored = cx.shelf.library()?.restore(Some(name.as_str()));
                let name = restored.map_err(|error| cx.shelf.refused(error))?;
                cx.print(&format!("restored {name}\n"))
            }
            Act::Path => path(cx),
            Act::Check { json } => check(json, cx),
        }
    }
}

const LIST_EXAMPLES: &str = "\
Prints size (columns x rows), active taxels, pieces and holes. Files that cannot
be read are listed as broken, with the reason.

Examples:
  taxel library list
  taxel library list --json";

/// A shape as it is listed.
struct Line {
    name: String,
    origin: &'static str,
    /// The numbers of [`SIZES`], or why it cannot be read.
    sizes: Result<[u64; 5], String>,
    /// The name inside the file, if it is another one.
    other_name: Option<Name>,
}

const SIZES: [&str; 5] = ["columns", "rows", "na", "pieces", "holes"];

/// Reads a shape; None if another program has deleted it since the folder was listed.
fn line(library: &Library, entry: LibraryEntry) -> Option<Line> {
    let (name, is_own) = (entry.name, entry.origin == ShapeOrigin::Own);
    let loaded = match library.load(&name) {
        Err(LibraryError::Unknown(_)) => return None,
        Err(error) => {
            return Some(Line {
                name,
                origin: "broken",
                sizes: Err(shortened_message(&error.to_string())),
                other_name: None,
            });
        }
        Ok(loaded) => loaded,
    };
    let imprint = &loaded.shape.imprint;
    let regions = regions(imprint);
    let kinds = regions.iter().map(Region::kind);
    let holes = kinds.filter(|kind| *kind == RegionKind::Hole).count();
    let pieces = (regions.len() - holes) as u64;
    let [columns, rows] = [imprint.columns(), imprint.rows()].map(u64::from);
    let is_other = is_own && loaded.written_name.as_str() != name;
    Some(Line {
        name,
        origin: if is_own { "own" } else { "shipped" },
        sizes: Ok([columns, rows, imprint.count().into(), pieces, holes as u64]),
        other_name: is_other.then_some(loaded.written_name),
    })
}

fn lines(library: &Library) -> Result<Vec<Line>, Failure> {
    let entries = library.list()?.into_par_iter();
    Ok(entries.filter_map(|entry| line(library, entry)).collect())
}

fn list(json: bool, cx: &Context) -> Result<(), Failure> {
    if let Some(folder) = cx.shelf.missing_folder() {
        let folder = folder.display();
        cx.note(&format!("warning: {folder} {NOT_THERE}"));
    }
    let lines = lines(&cx.shelf.readable())?;
    if json {
        let record = |line: &Line| {
            let mut record = vec![("name", json!(line.name)), ("origin", json!(line.origin))];
            match &line.sizes {
                Ok(sizes) => record.extend(SIZES.into_iter().zip(sizes.map(Value::from))),
                Err(error) => record.push(("error", json!(error))),
            }
            Record(record)
        };
        let records: Vec<_> = lines.iter().map(record).collect();
        return cx.print(&(json::ascii(&records) + "\n"));
    }
    let names = iter::once("name").chain(lines.iter().map(|line| &*line.name));
    let names = Charset::current().column(names);
    let mut text = format!("{}  origin      size   NA  pieces  holes\n", names[0]);
    for (line, name) in lines.iter().zip(&names[1..]) {
        text += &format!("{name}  {:<7}  ", line.origin);
        text += &match &line.sizes {
            Ok([columns, rows, na, pieces, holes]) => {
                let size = format!("{columns} × {rows}");
                format!("{size:>7} {na:>4}  {pieces:>6}  {holes:>5}\n")
            }
            Err(error) => format!("{}\n", Charset::current().line(error)),
        };
    }
    cx.print(&text)
}

const NOT_THERE: &str = "does not exist; it is made when a shape is saved";

const SHOW_EXAMPLES: &str = "\
Examples:
  taxel library show washer
  taxel library show \"my nut\" --pitch 2.5
  taxel library show key --json";

const SAVE_EXAMPLES: &str = "\
A file holds a stored shape or an imprint. If a stored shape and a file have the
same name, taxel uses the shape, so you can copy a shape.

Examples:
  taxel library save ring imprint.txt
  taxel library save \"my washer\" washer
  printf '.##.\\n#..#\\n.##.\\n' | taxel library save ring - --force";

const IMPORT_EXAMPLES: &str = "\
The shape keeps its outline, and its unit; its imprint is that in the middle of
the sensor. An SVG with a width in mm, cm, in or pt is in mm, which needs the
--pitch. Strokes, texts and images of an SVG are left out and named.

Examples:
  taxel library import parts/bracket.svg --name \"my bracket\" --pitch 2.5
  taxel library import logo.svg --name logo --mm-per-unit 0.1 --pitch 1
  taxel library import points.csv --name plate --unit mm --y-up --pitch 2.5";

const DELETE_EXAMPLES: &str = "\
The last 50 deleted shapes are kept.

Examples:
  taxel library delete ring
  taxel library restore ring";

fn delete(name: &Name, cx: &Context) -> Result<(), Failure> {
    let deleted = cx.shelf.library()?.delete(name.as_str());
    let name = deleted.map_err(|error| cx.shelf.refused(error))?;
    // Otherwise a name with a dash would be taken for a flag.
    let dashes = if name.starts_with('-') { "-- " } else { "" };
    let restore = cx.shelf.library_command("restore");
    let restore = restore.map(|words| format!("{words} {dashes}{}", as_argument(&name)));
    // A command whose characters are escaped cannot be typed.
    let hint = restore.filter(|restore| Charset::current().line(restore) == *restore);
    let hint = hint.map_or(String::new(), |hint| format!("; to restore it: {hint}"));
    cx.print(&format!("deleted {name}{hint}\n"))
}

const RESTORE_EXAMPLES: &str = "\
If several shapes of that name were deleted, the last one is restored.

Examples:
  taxel library restore ring";

const PATH_EXAMPLES: &str = "\
Examples:
  taxel library path
  ls \"$(taxel library path)\"";

/// Prints the path byte for byte, so that other programs find the folder, but escaped on a terminal.
fn path(cx: &Context) -> Result<(), Failure> {
    let library = cx.shelf.library()?;
    let folder = library.folder();
    if io::stdout().is_terminal() {
        let folder = folder.to_string_lossy();
        return cx.print(&format!("{}\n", Charset::current().line(&folder)));
    }
    cx.write(&[folder.as_os_str().as_encoded_bytes(), b"\n"].concat())
}

const CHECK_EXAMPLES: &str = r#"Reads every shape and lists broken ones, shapes whose file holds another name,
and other files in the folder. The exit status is 1 if a shape is broken, or if
--library names a folder that does not exist. --json prints an array on one
line, with an object for each finding:
  {"finding":"broken","name":"ring","reason":"..."}
  {"finding":"name","name":"Ring","reason":"..."}
  {"finding":"other file","path":"shapes/notes.txt","reason":"..."}

Examples:
  taxel library check
  taxel library check --json
  taxel library check --library ./shapes"#;

struct Finding {
    kind: &'static str,
    /// Whether `place` is a name of the library or a path.
    key: &'static str,
    place: String,
    reason: String,
}

/// Reads every shape, and looks for other files in the folder. A damaged shape is a failure.
fn check(json: bool, cx: &Context) -> Result<(), Failure> {
    if let Some(folder) = cx.shelf.missing_folder() {
        // A script must not take a mistyped name, or a disk that is not there, for a sound library.
        return Err(Failure::new(format!("{} {NOT_THERE}", folder.display())));
    }
    let library = cx.shelf.readable();
    let lines = lines(&library)?;
    let shapes = lines.len();
    let (mut findings, mut names) = (Vec::new(), Vec::new());
    for line in lines {
        let finding = |kind, reason| Finding {
            kind,
            key: "name",
            place: line.name,
            reason,
        };
        if let Err(error) = line.sizes {
            findings.push(finding("broken", error));
        } else if let Some(other) = &line.other_name {
            let other = other.as_str();
            let why = format!("the name inside the file is {other:?}; the name of the file counts");
            names.push(finding("name", why));
        }
    }
    let broken = findings.len();
    findings.extend(names);
    findings.extend(library.foreign_files()?.into_iter().map(|path| Finding {
        kind: "other file",
        key: "path",
        place: path.display().to_string(),
        reason: "not a shape: its name is not NAME.json".to_owned(),
    }));
    if json {
        let record = |own: &Finding| {
            let (kind, place) = (json!(own.kind), json!(own.place));
            Record(vec![
                ("finding", kind),
                (own.key, place),
                ("reason", json!(own.reason)),
            ])
        };
        let records: Vec<_> = findings.iter().map(record).collect();
        cx.print(&(json::ascii(&records) + "\n"))?;
    } else {
        for own in &findings {
            let [place, reason] =
                [&own.place, &own.reason].map(|text| Charset::current().line(text));
            cx.print(&format!("{}: {place}: {reason}\n", own.kind))?;
        }
    }
    if broken > 0 {
        let text = format!("{broken} of {shapes} shapes cannot be read");
        return Err(Failure::new(text));
    }
    if json {
        return Ok(());
    }
    cx.print(&format!("{shapes} shapes, all intact\n"))
}
