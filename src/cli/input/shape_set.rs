//! The shapes of a set: from files of lines of JSON ([`named_shape`]), and from the library.
//!
//! An argument is a file if it ends in `.jsonl` or `.json`, if it has a `/`, or if there is such a file but no shape
//! of that name. Otherwise it is the name of a stored shape, which is taken as it was stored.

use std::ffi::OsStr;
use std::io::{BufReader, Read};
use std::path::Path;

use crate::cli::arguments::model::shape_set::SetArguments;
use crate::cli::error::CliError;
use crate::cli::input::content::{InputError, InputSource};
use crate::cli::input::shapes::Shelf;
use crate::figure::Figure;
use crate::formats::file::has_ending;
use crate::formats::file::system_reason;
use crate::formats::file::without_mark;
use crate::formats::{NamedShapeError, ShapeLookup, named_shape};
use crate::picture::Picture;
use crate::recognition::NamedShape;
use crate::sensor::Sensor;
use crate::storage::LibraryError;

/// The largest file of shapes, in bytes.
const MAX_SET: u64 = 64 << 20;

pub(crate) fn read(asked: &SetArguments, shelf: &Shelf) -> Result<Vec<NamedShape>, CliError> {
    let lookup = |name: &str| {
        shelf
            .imprint(name)
            .map_err(|error| shelf.refused(error).to_string())
    };
    let mut shapes = Vec::new();
    for what in &asked.what {
        if let Some(source) = source_of_lines(what, shelf) {
            let name = source.name();
            let mut input = source.open().map_err(|error| CliError::Input {
                name: name.clone(),
                error: InputError::Read(error),
            })?;
            lines(&mut input, &name, &lookup, &mut shapes)?;
        } else {
            let name = what.to_string_lossy();
            let imprint = shelf
                .imprint(&name)
                .map_err(|error| no_shape(error, shelf))?;
            shapes.push(NamedShape::new(name, Picture::at_home(imprint)));
        }
    }
    if asked.library_all {
        shapes.extend(library_shapes(shelf)?);
    }
    Ok(shapes)
}

/// Returns the message about an argument that is not the name of a shape. For the name of a figure, it shows
/// the line that gives one; a folder of that name is mentioned.
fn no_shape(error: LibraryError, shelf: &Shelf) -> CliError {
    let kind = match &error {
        LibraryError::Unknown { name } => name.parse().ok(),
        _ => None,
    };
    let Some(kind) = kind else {
        return match error {
            LibraryError::Unknown { name } if Path::new(&name).is_dir() => CliError::NoShape {
                error: LibraryError::Unknown { name },
                near: "; there is a folder of this name, but a set is a file".to_owned(),
            },
            error => shelf.refused(error),
        };
    };
    let figure = Figure::default_of(kind, &Sensor::default());
    let sizes = kind.sizes().iter().filter_map(|&size| {
        let value = figure.get(size)?;
        Some(format!(",\"{}\":{value}", size.row().key))
    });
    let sizes: String = sizes.collect();
    let name = kind.name();
    let near = format!(
        "; {name:?} is a figure: a file of lines may have {{\"name\":{name:?},\"figure\":{name:?}{sizes}}}"
    );
    CliError::NoShape { error, near }
}

fn library_shapes(shelf: &Shelf) -> Result<Vec<NamedShape>, CliError> {
    let library = shelf.readable();
    let mut shapes = Vec::new();
    for entry in library.list()? {
        let name = entry.name.clone();
        let imprint = library.load(&name)?.shape.imprint;
        shapes.push(NamedShape::new(name, Picture::at_home(imprint)));
    }
    Ok(shapes)
}

fn source_of_lines(what: &OsStr, shelf: &Shelf) -> Option<InputSource> {
    let path = Path::new(what);
    let ending = has_ending(path, "jsonl") || has_ending(path, "json");
    // A FIFO, too, and a broken link, so that the reason why it cannot be opened is reported.
    let found = path.metadata();
    let is_file = found.map_or_else(|_| path.is_symlink(), |found| !found.is_dir());
    let known = || {
        what.to_str()
            .is_some_and(|name| shelf.imprint(name).is_ok())
    };
    let has_slash = what.as_encoded_bytes().contains(&b'/');
    let is_source = what == "-" || ending || has_slash || is_file && !known();
    is_source.then(|| InputSource::of(path))
}

fn lines(
    input: &mut dyn Read,
    name: &str,
    lookup: &ShapeLookup<'_>,
    shapes: &mut Vec<NamedShape>,
) -> Result<(), CliError> {
    let mut text = Vec::new();
    let read = BufReader::new(input)
        .take(MAX_SET + 1)
        .read_to_end(&mut text);
    let refused = |place: String, error: String| CliError::Set { place, error };
    read.map_err(|error| {
        refused(
            name.to_owned(),
            format!("cannot read: {}", system_reason(&error)),
        )
    })?;
    if text.len() as u64 > MAX_SET {
        let error = "larger than 64 MiB, the limit for a set of shapes";
        return Err(refused(name.to_owned(), error.to_owned()));
    }
    let text = without_mark(&text);
    let before = shapes.len();
    for (index, line) in text.split(|&byte| byte == b'\n').enumerate() {
        if line.trim_ascii().is_empty() {
            continue;
        }
        let shape = named_shape(line, lookup);
        shapes.push(shape.map_err(|error| {
            let place = format!("{name}: line {}", index + 1);
            match error {
                NamedShapeError::Json { column, message } => {
                    refused(format!("{place}, column {column}"), message)
                }
                error => refused(place, error.to_string()),
            }
        })?);
    }
    if shapes.len() == before {
        let error = "no shapes, expected a line of JSON for each";
        return Err(refused(name.to_owned(), error.to_owned()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_ends_like_a_file_of_lines_is_one_in_upper_case_too() {
        let is_source =
            |what| source_of_lines(OsStr::new(what), &Shelf::new(None, false)).is_some();
        assert!(is_source("missing.jsonl") && is_source("MISSING.JSONL"));
        assert!(!is_source("missing"));
    }
}
