//! `taxel library`: lists, shows, stores, deletes, restores and checks shapes.

use std::ffi::OsString;
use std::io::{self, IsTerminal};
use std::iter;

use clap::{Args, Subcommand};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde::Serialize;
use taxel_core::description::{Region, RegionKind, regions};
use taxel_core::quote::{as_argument, shortened_message};
use taxel_core::sensor::Sensor;
use taxel_files::formats::{Content, Name, StoredShape, json};
use taxel_files::storage::{Library, LibraryEntry, LibraryError, ShapeOrigin};

use crate::cli::Context;
use crate::cli::arguments::flags::name_or_path;
use crate::cli::arguments::parameters::PitchFlag;
use crate::cli::commands::describe::described;
use crate::cli::commands::export;
use crate::cli::failure::Failure;
use crate::cli::output::charset::Charset;

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
    List(List),
    Show(Show),
    Save(Save),
    Delete(Delete),
    Restore(Restore),
    /// Print the library's folder
    #[command(after_help = PATH_EXAMPLES)]
    Path,
    Check(Check),
}

impl LibraryCommand {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        match self.command {
            Act::List(command) => command.run(cx),
            Act::Show(command) => command.run(cx),
            Act::Save(command) => command.run(cx),
            Act::Delete(command) => command.run(cx),
            Act::Restore(command) => command.run(cx),
            Act::Path => path(cx),
            Act::Check(command) => command.run(cx),
        }
    }
}

const LIST_EXAMPLES: &str = "\
Prints size (columns x rows), active taxels, pieces and holes. Files that cannot
be read are listed as broken, with the reason.

Examples:
  taxel library list
  taxel library list --json";

/// List all shapes
#[derive(Debug, Args)]
#[command(after_help = LIST_EXAMPLES)]
struct List {
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Line {
    name: String,
    origin: &'static str,
    #[serde(flatten)]
    found: Found,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Found {
    Shape {
        columns: u8,
        rows: u8,
        na: u32,
        pieces: usize,
        holes: usize,
        /// The name inside the file, if it is another one.
        #[serde(skip)]
        other_name: Option<Name>,
    },
    Broken {
        error: String,
    },
}

/// Reads a shape; None if another program has deleted it since the folder was listed.
fn line(library: &Library, entry: LibraryEntry) -> Option<Line> {
    let own = match entry.origin {
        ShapeOrigin::Own => "own",
        ShapeOrigin::Shipped => "shipped",
    };
    let (origin, found) = match library.load(&entry.name) {
        Ok(loaded) => {
            let imprint = &loaded.shape.imprint;
            let regions = regions(imprint);
            let kinds = regions.iter().map(Region::kind);
            let holes = kinds.filter(|kind| *kind == RegionKind::Hole).count();
            let name = loaded.written_name;
            let found = Found::Shape {
                columns: imprint.columns(),
                rows: imprint.rows(),
                na: imprint.count(),
                pieces: regions.len() - holes,
                holes,
                other_name: Some(name).filter(|name| name.as_str() != entry.name && own == "own"),
            };
            (own, found)
        }
        Err(LibraryError::Unknown(_)) => return None,
        Err(error) => {
            let error = shortened_message(&error.to_string());
            ("broken", Found::Broken { error })
        }
    };
    let name = entry.name;
    Some(Line {
        name,
        origin,
        found,
    })
}

fn lines(library: &Library) -> Result<Vec<Line>, Failure> {
    let entries = library.list()?.into_par_iter();
    Ok(entries.filter_map(|entry| line(library, entry)).collect())
}

impl List {
    fn run(self, cx: &Context) -> Result<(), Failure> {
        if let Some(folder) = cx.shelf.missing_folder() {
            let folder = folder.display();
            cx.note(&format!("warning: {folder} {NOT_THERE}"));
        }
        let lines = lines(&cx.shelf.readable())?;
        if self.json {
            return cx.print(&(json::ascii(&lines) + "\n"));
        }
        let names = iter::once("name").chain(lines.iter().map(|line| &*line.name));
        let names = Charset::current().column(names);
        let mut text = format!("{}  origin      size   NA  pieces  holes\n", names[0]);
        for (line, name) in lines.iter().zip(&names[1..]) {
            text += &format!("{name}  {:<7}  ", line.origin);
            text += &match &line.found {
                Found::Shape {
                    columns,
                    rows,
                    na,
                    pieces,
                    holes,
                    ..
                } => {
                    let size = format!("{columns} × {rows}");
                    format!("{size:>7} {na:>4}  {pieces:>6}  {holes:>5}\n")
                }
                Found::Broken { error } => format!("{}\n", Charset::current().line(error)),
            };
        }
        cx.print(&text)
    }
}

const NOT_THERE: &str = "does not exist; it is made when a shape is saved";

const SHOW_EXAMPLES: &str = "\
Examples:
  taxel library show washer
  taxel library show \"my nut\" --pitch 2.5
  taxel library show key --json";

/// Show a shape and describe it
#[derive(Debug, Args)]
#[command(after_help = SHOW_EXAMPLES)]
struct Show {
    /// Name of the shape
    #[arg(value_parser = Name::new)]
    name: Name,
    #[command(flatten)]
    pitch: PitchFlag,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
}

impl Show {
    fn run(self, cx: &Context) -> Result<(), Failure> {
        let pitch = self.pitch.pitch(&cx.settings)?;
        let loaded = cx.shelf.readable().load(self.name.as_str());
        let shape = loaded.map_err(|error| cx.shelf.refused(error))?.shape;
        let content = Content::Shape(shape);
        cx.print(&described(&content, self.json, pitch))
    }
}

const SAVE_EXAMPLES: &str = "\
A file holds a stored shape or an imprint. If a stored shape and a file have the
same name, taxel uses the shape, so you can copy a shape.

Examples:
  taxel library save ring imprint.txt
  taxel library save \"my washer\" washer
  printf '.##.\\n#..#\\n.##.\\n' | taxel library save ring - --force";

/// Store a shape under a name
#[derive(Debug, Args)]
#[command(after_help = SAVE_EXAMPLES)]
struct Save {
    /// Name to store it under
    #[arg(value_parser = Name::new)]
    name: Name,
    /// Shape of the library, or file; '-' for standard input
    #[arg(value_name = "NAME|FILE", value_parser = name_or_path())]
    what: OsString,
    /// Replace an existing shape of this name
    #[arg(long)]
    force: bool,
}

impl Save {
    /// Stores a shape of the library or of a file under another name. An imprint without a sensor gets one of its own
    /// size.
    fn run(self, cx: &Context) -> Result<(), Failure> {
        let shape = match cx.shelf.find(&self.what)? {
            Content::Shape(shape) => shape.renamed(self.name),
            Content::Imprint(imprint) => StoredShape {
                name: self.name,
                sensor: Sensor::of_size(imprint.size()),
                imprint,
                source: None,
            },
        };
        let existing = export::replacing(self.force);
        let name = cx.shelf.save(&shape, existing)?;
        cx.print(&format!("saved as {name}\n"))
    }
}

const DELETE_EXAMPLES: &str = "\
The last 50 deleted shapes are kept.

Examples:
  taxel library delete ring
  taxel library restore ring";

/// Move a shape to the trash
#[derive(Debug, Args)]
#[command(after_help = DELETE_EXAMPLES)]
struct Delete {
    /// Name of the shape
    #[arg(value_parser = Name::new)]
    name: Name,
}

impl Delete {
    fn run(self, cx: &Context) -> Result<(), Failure> {
        let library = cx.shelf.library();
        let deleted = library.and_then(|library| library.delete(self.name.as_str()));
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
}

const RESTORE_EXAMPLES: &str = "\
If several shapes of that name were deleted, the last one is restored.

Examples:
  taxel library restore ring";

/// Restore a deleted shape
#[derive(Debug, Args)]
#[command(after_help = RESTORE_EXAMPLES)]
struct Restore {
    /// Name of the shape
    #[arg(value_parser = Name::new)]
    name: Name,
}

impl Restore {
    fn run(self, cx: &Context) -> Result<(), Failure> {
        let library = cx.shelf.library();
        let restored = library.and_then(|library| library.restore(Some(self.name.as_str())));
        let name = restored.map_err(|error| cx.shelf.refused(error))?;
        cx.print(&format!("restored {name}\n"))
    }
}

const PATH_EXAMPLES: &str = "\
Examples:
  taxel library path
  ls \"$(taxel library path)\"";

/// Prints the path byte for byte, so that other programs find the folder, but escaped on a terminal.
fn path(cx: &Context) -> Result<(), Failure> {
    let library = cx
        .shelf
        .library()
        .map_err(|error| cx.shelf.refused(error))?;
    let folder = library.folder();
    if io::stdout().is_terminal() {
        return cx.print(&format!(
            "{}\n",
            Charset::current().line(&folder.to_string_lossy())
        ));
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

/// Find broken shapes and stray files
#[derive(Debug, Args)]
#[command(after_help = CHECK_EXAMPLES)]
struct Check {
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Finding {
    #[serde(rename = "finding")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    path: Option<String>,
    reason: String,
}

impl Check {
    /// Reads every shape, and looks for other files in the folder. A damaged shape is a failure.
    fn run(self, cx: &Context) -> Result<(), Failure> {
        if let Some(folder) = cx.shelf.missing_folder() {
            // A script must not take a mistyped name, or a disk that is not there, for a sound library.
            return Err(Failure::new(format!("{} {NOT_THERE}", folder.display())));
        }
        let library = cx.shelf.readable();
        let lines = lines(&library)?;
        let shapes = lines.len();
        let (mut findings, mut names) = (Vec::new(), Vec::new());
        for line in lines {
            let name = Some(line.name);
            match line.found {
                Found::Broken { error } => findings.push(Finding {
                    kind: "broken",
                    name,
                    path: None,
                    reason: error,
                }),
                Found::Shape { other_name, .. } => names.extend(other_name.map(|other| Finding {
                    kind: "name",
                    name,
                    path: None,
                    reason: format!(
                        "the name inside the file is {:?}; the name of the file counts",
                        other.as_str()
                    ),
                })),
            }
        }
        let broken = findings.len();
        findings.extend(names);
        findings.extend(library.foreign_files()?.into_iter().map(|path| Finding {
            kind: "other file",
            name: None,
            path: Some(path.display().to_string()),
            reason: "not a shape: its name is not NAME.json".to_owned(),
        }));
        if self.json {
            cx.print(&(json::ascii(&findings) + "\n"))?;
        } else {
            for found in &findings {
                let place = found.name.as_ref().or(found.path.as_ref());
                let place = Charset::current().line(place.map_or("", String::as_str));
                let (what, reason) = (found.kind, Charset::current().line(&found.reason));
                cx.print(&format!("{what}: {place}: {reason}\n"))?;
            }
        }
        if broken > 0 {
            let text = format!("{broken} of {shapes} shapes cannot be read");
            return Err(Failure::new(text));
        }
        if self.json {
            return Ok(());
        }
        cx.print(&format!("{shapes} shapes, all intact\n"))
    }
}
