//! `taxel library`: lists, stores, deletes and restores shapes.

use std::ffi::OsString;
use std::io::{self, IsTerminal};
use std::iter;

use clap::{Args, Subcommand};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde_json::{Value, json};
use taxel_core::description::{Region, RegionKind, regions};
use taxel_core::quote::shortened_message;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::touch::Plane;
use taxel_files::formats::{Content, Name, StoredShape, json};
use taxel_files::storage::{Library, LibraryEntry, LibraryError, ShapeOrigin};

use crate::cli::Context;
use crate::cli::arguments::flags::name_or_path;
use crate::cli::arguments::parameters::{Given, OwnSensorFlags};
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
  taxel describe washer
  taxel library save ring imprint.txt
  taxel library --library ./shapes list";

/// List, save, delete and restore stored shapes
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
}

impl LibraryCommand {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        match self.command {
            Act::List { json } => list(json, cx),
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
            Act::Delete { name } => {
                let deleted = cx.shelf.library()?.delete(name.as_str());
                let name = deleted.map_err(|error| cx.shelf.refused(error))?;
                cx.print(&format!(
                    "deleted {name}; 'taxel library restore' brings it back\n"
                ))
            }
            Act::Restore { name } => {
                let restored = cx.shelf.library()?.restore(Some(name.as_str()));
                let name = restored.map_err(|error| cx.shelf.refused(error))?;
                cx.print(&format!("restored {name}\n"))
            }
            Act::Path => path(cx),
        }
    }
}

const LIST_EXAMPLES: &str = "\
Prints size (columns x rows), active taxels, pieces and holes. Files that cannot
be read are listed as broken, with the reason.

Examples:
  taxel library list
  taxel library list --json";

/// A shape as it is listed: its name, where it comes from, and the numbers of [`SIZES`], or why it cannot be read.
type Line = (String, &'static str, Result<[u64; 5], String>);

const SIZES: [&str; 5] = ["columns", "rows", "na", "pieces", "holes"];

/// Reads a shape; None if another program has deleted it since the folder was listed.
fn line(library: &Library, entry: LibraryEntry) -> Option<Line> {
    let imprint = match library.load(&entry.name) {
        Err(LibraryError::Unknown(_)) => return None,
        Err(error) => {
            let why = shortened_message(&error.to_string());
            return Some((entry.name, "broken", Err(why)));
        }
        Ok(loaded) => loaded.shape.imprint,
    };
    let regions = regions(&imprint);
    let kinds = regions.iter().map(Region::kind);
    let holes = kinds.filter(|kind| *kind == RegionKind::Hole).count();
    let pieces = (regions.len() - holes) as u64;
    let [columns, rows] = [imprint.columns(), imprint.rows()].map(u64::from);
    let origin = match entry.origin {
        ShapeOrigin::Own => "own",
        ShapeOrigin::Shipped => "shipped",
    };
    let sizes = [columns, rows, imprint.count().into(), pieces, holes as u64];
    Some((entry.name, origin, Ok(sizes)))
}

fn list(json: bool, cx: &Context) -> Result<(), Failure> {
    if let Some(folder) = cx.shelf.missing_folder() {
        let folder = folder.display();
        let why = "does not exist; it is made when a shape is saved";
        cx.note(&format!("warning: {folder} {why}"));
    }
    let library = cx.shelf.readable();
    let entries = library.list()?.into_par_iter();
    let lines: Vec<Line> = entries.filter_map(|entry| line(&library, entry)).collect();
    if json {
        let record = |(name, origin, sizes): &Line| {
            let mut record = vec![("name", json!(name)), ("origin", json!(origin))];
            match sizes {
                Ok(sizes) => record.extend(SIZES.into_iter().zip(sizes.map(Value::from))),
                Err(error) => record.push(("error", json!(error))),
            }
            Record(record)
        };
        let records: Vec<_> = lines.iter().map(record).collect();
        return cx.print(&(json::ascii(&records) + "\n"));
    }
    let names = iter::once("name").chain(lines.iter().map(|line| &*line.0));
    let names = Charset::current().column(names);
    let mut text = format!("{}  origin      size   NA  pieces  holes\n", names[0]);
    for ((_, origin, sizes), name) in lines.iter().zip(&names[1..]) {
        text += &format!("{name}  {origin:<7}  ");
        text += &match sizes {
            Ok([columns, rows, na, pieces, holes]) => {
                let size = format!("{columns} × {rows}");
                format!("{size:>7} {na:>4}  {pieces:>6}  {holes:>5}\n")
            }
            Err(error) => format!("{}\n", Charset::current().line(error)),
        };
    }
    cx.print(&text)
}

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
