//! `taxel library`: lists, shows, stores, deletes, restores and checks shapes.

use std::ffi::OsStr;
use std::fmt::{self, Write};
use std::iter;
use std::path::Path;

use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use taxel_core::description::{RegionKind, regions};
use taxel_core::quote::{as_argument, shortened_message};
use taxel_core::sensor::Sensor;
use taxel_files::formats::{Content, Name, StoredShape, json};
use taxel_files::storage::{
    Existing, Library, LibraryEntry, LibraryError, LoadedShape, ShapeOrigin,
};

use crate::cli::arguments::flags::Form;
use crate::cli::commands::describe::described;
use crate::cli::error::CliError;
use crate::cli::failure::Failure;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::Charset;

struct ListLine {
    name: String,
    origin: ShapeOrigin,
    found: Result<ShapeSummary, String>,
}

struct ShapeSummary {
    written_name: Name,
    columns: u8,
    rows: u8,
    na: u32,
    pieces: usize,
    holes: usize,
}

impl ListLine {
    /// Reads a shape; None if another program has deleted it since the folder was listed.
    fn of(library: &Library, entry: LibraryEntry) -> Option<Self> {
        let found = match library.load(&entry.name) {
            Ok(loaded) => Ok(ShapeSummary::of(loaded)),
            Err(LibraryError::Unknown(_)) => return None,
            Err(error) => Err(shortened_message(&error.to_string())),
        };
        Some(Self {
            found,
            name: entry.name,
            origin: entry.origin,
        })
    }

    fn origin(&self) -> &'static str {
        match (&self.found, self.origin) {
            (Err(_), _) => "broken",
            (_, ShapeOrigin::Own) => "own",
            (_, ShapeOrigin::Shipped) => "shipped",
        }
    }
}

impl ShapeSummary {
    fn of(loaded: LoadedShape) -> Self {
        let shape = &loaded.shape;
        let regions = regions(&shape.imprint);
        let holes = regions
            .iter()
            .filter(|region| region.kind() == RegionKind::Hole);
        let holes = holes.count();
        Self {
            written_name: loaded.written_name,
            columns: shape.imprint.columns(),
            rows: shape.imprint.rows(),
            na: shape.imprint.count(),
            pieces: regions.len() - holes,
            holes,
        }
    }
}

impl Serialize for ListLine {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("name", &self.name)?;
        map.serialize_entry("origin", self.origin())?;
        match &self.found {
            Ok(summary) => {
                map.serialize_entry("columns", &summary.columns)?;
                map.serialize_entry("rows", &summary.rows)?;
                map.serialize_entry("na", &summary.na)?;
                map.serialize_entry("pieces", &summary.pieces)?;
                map.serialize_entry("holes", &summary.holes)?;
            }
            Err(reason) => map.serialize_entry("error", reason)?,
        }
        map.end()
    }
}

fn lines(library: &Library) -> Result<Vec<ListLine>, CliError> {
    let entries = library.list()?;
    let line = |entry| ListLine::of(library, entry);
    Ok(entries.into_par_iter().filter_map(line).collect())
}

pub(crate) fn missing(shelf: &Shelf) -> Option<String> {
    let folder = shelf.missing_folder()?.display();
    Some(format!(
        "warning: {folder} does not exist; it is made when a shape is saved"
    ))
}

pub(crate) fn list(shelf: &Shelf, as_json: bool, charset: Charset) -> Result<String, CliError> {
    let lines = lines(&shelf.readable())?;
    if as_json {
        return Ok(json::ascii(&lines) + "\n");
    }
    let names = lines.iter().map(|line| &*line.name);
    let column = charset.column(iter::once("name").chain(names));
    let mut text = format!(
        "{}  origin   {:>7}   NA  pieces  holes\n",
        column[0], "size"
    );
    for (line, name) in lines.iter().zip(&column[1..]) {
        // Cannot fail: the text is kept in memory.
        let _ = write!(text, "{name}  {:<7}  ", line.origin());
        let _ = match &line.found {
            Ok(summary) => {
                let size = format!("{} × {}", summary.columns, summary.rows);
                let size = charset.line(&size);
                let (na, pieces, holes) = (summary.na, summary.pieces, summary.holes);
                writeln!(text, "{size:>7} {na:>4}  {pieces:>6}  {holes:>5}")
            }
            Err(reason) => writeln!(text, "{}", charset.line(reason)),
        };
    }
    Ok(text)
}

pub(crate) fn show(
    shelf: &Shelf,
    name: &str,
    form: Form,
    charset: Charset,
) -> Result<String, CliError> {
    let loaded = shelf.readable().load(name);
    let shape = loaded.map_err(|error| shelf.refused(error))?.shape;
    let (Form::Json(pitch) | Form::Table(pitch)) = form;
    let is_json = matches!(form, Form::Json(_));
    Ok(described(&Content::Shape(shape), is_json, pitch, charset))
}

/// Stores a shape of the library or of a file under another name. An imprint without a sensor gets one of its own
/// size.
pub(crate) fn save(
    shelf: &Shelf,
    name: Name,
    existing: Existing,
    what: &OsStr,
) -> Result<String, CliError> {
    let found = shelf.find(what);
    let shape = match found.map_err(|error| in_order(error, what, name.as_str()))? {
        Content::Shape(shape) => shape.renamed(name),
        Content::Imprint(imprint) => StoredShape {
            name,
            sensor: Sensor::of_size(imprint.size()),
            imprint,
            source: None,
        },
    };
    let name = shelf.save(&shape, existing)?;
    Ok(format!("saved as {name}\n"))
}

/// Adds the right order of the arguments to the error, if a file was given in place of the name and the shape cannot
/// be found.
fn in_order(failure: Failure, what: &OsStr, file: &str) -> Failure {
    if Path::new(what).exists() || !Path::new(file).is_file() {
        return failure;
    }
    let (first, then) = (as_argument(&what.to_string_lossy()), as_argument(file));
    failure.with_hint(format!(
        "; the name comes first: taxel library save {first} {then}"
    ))
}

pub(crate) fn delete(shelf: &Shelf, name: &str, charset: Charset) -> Result<String, CliError> {
    let deleted = shelf.library()?.delete(name);
    let name = deleted.map_err(|error| shelf.refused(error))?;
    let hint = restoring(shelf, &name);
    // A command whose characters are escaped, or whose folder is not UTF-8, cannot be typed.
    let hint = hint.filter(|hint| charset.line(hint) == *hint);
    let hint = hint.map_or(String::new(), |hint| format!("; to restore it: {hint}"));
    Ok(charset.lines(&format!("deleted {name}{hint}\n")))
}

fn restoring(shelf: &Shelf, name: &str) -> Option<String> {
    let mut command = shelf.library_command("restore")?;
    // Otherwise a name with a dash would be taken for a flag.
    command += if name.starts_with('-') { " -- " } else { " " };
    Some(command + &as_argument(name))
}

pub(crate) fn restore(shelf: &Shelf, name: &str) -> Result<String, CliError> {
    let restored = shelf.library()?.restore(Some(name));
    let name = restored.map_err(|error| shelf.refused(error))?;
    Ok(format!("restored {name}\n"))
}

#[derive(Serialize)]
#[serde(tag = "finding")]
enum Finding {
    #[serde(rename = "broken")]
    Broken { name: String, reason: String },
    #[serde(rename = "name")]
    Name { name: String, reason: String },
    #[serde(rename = "other file")]
    OtherFile { path: String, reason: &'static str },
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Broken { name, reason } => write!(f, "broken: {name}: {reason}"),
            Self::Name { name, reason } => write!(f, "name: {name}: {reason}"),
            Self::OtherFile { path, reason } => write!(f, "other file: {path}: {reason}"),
        }
    }
}

fn unclear_names(lines: &[ListLine]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let own = lines.iter().filter(|line| line.origin == ShapeOrigin::Own);
    for line in own {
        if let Ok(summary) = &line.found
            && summary.written_name.as_str() != line.name
        {
            let written = &summary.written_name;
            let reason = format!(
                "the name inside the file is {:?}; the name of the file counts",
                written.as_str()
            );
            let name = line.name.clone();
            findings.push(Finding::Name { name, reason });
        }
    }
    findings
}

/// Reads every shape, and looks for other files in the folder. Returns the report, a line for each finding or a JSON
/// array of objects, and [`CliError::Shapes`] if a shape is damaged, to be reported after it.
pub(crate) fn check(
    shelf: &Shelf,
    as_json: bool,
    charset: Charset,
) -> Result<(String, Result<(), CliError>), CliError> {
    if let Some(folder) = shelf.missing_folder() {
        // A script must not take a mistyped name, or a disk that is not there, for a sound library.
        let name = folder.to_string_lossy().into_owned();
        return Err(CliError::NoFolder { name });
    }
    let library = shelf.readable();
    let lines = lines(&library)?;
    let shapes = lines.len();
    let names = unclear_names(&lines);
    let broken = lines.into_iter().filter_map(|line| {
        let (name, reason) = (line.name, line.found.err()?);
        Some(Finding::Broken { name, reason })
    });
    let mut findings: Vec<Finding> = broken.collect();
    let broken = findings.len();
    findings.extend(names);
    let foreign = library.foreign_files()?;
    findings.extend(foreign.into_iter().map(|path| Finding::OtherFile {
        path: path.display().to_string(),
        reason: "not a shape: its name is not NAME.json",
    }));
    let text = if as_json {
        json::ascii(&findings) + "\n"
    } else {
        let lines = findings.iter().map(Finding::to_string);
        let whole = (broken == 0).then(|| format!("{shapes} shapes, all intact"));
        let lines = lines.chain(whole);
        lines
            .map(|line| charset.line(&line).into_owned() + "\n")
            .collect()
    };
    let result = match broken {
        0 => Ok(()),
        _ => Err(CliError::Shapes { broken, shapes }),
    };
    Ok((text, result))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_that_is_deleted_meanwhile_is_not_listed() {
        let folder = tempfile::tempdir().expect("a folder");
        let library = Library::open(folder.path().to_owned());
        let entry = |name: &str| LibraryEntry {
            name: name.to_owned(),
            origin: ShapeOrigin::Own,
        };
        assert!(ListLine::of(&library, entry("gone")).is_none());
        std::fs::write(folder.path().join("bad.json"), "{").expect("written");
        assert!(ListLine::of(&library, entry("bad")).is_some());
    }
}
