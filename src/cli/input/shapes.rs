//! The library as commands use it: looks up shapes by name or file, and stores them.
//!
//! A `NAME|FILE` argument is looked up in this order: `-` is standard input; then a shape of the library; then a file.
//! A path such as `./washer.json` cannot be a name, so it always means the file.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use taxel_core::figure::{Figure, FigureKind};
use taxel_core::imprint::Imprint;
use taxel_core::lock::locked;
use taxel_core::picture::Picture;
use taxel_core::quote::as_argument;
use taxel_core::recognition::NamedShape;
use taxel_core::sensor::Sensor;
use taxel_files::formats::file::{has_ending, is_missing, system_reason, without_mark};
use taxel_files::formats::name::folded;
use taxel_files::formats::{Content, ShapeLookup, StoredShape, named_shape};
use taxel_files::storage::{Existing, Expected, Library, LibraryError};

use crate::cli::commands::model::SetFlags;
use crate::cli::error::CliError;
use crate::cli::input::content::{self, InputError, InputSource};

/// The library, which is opened when it is first used: most commands never need it.
#[derive(Clone, Debug)]
pub(crate) struct Shelf {
    /// The folder of the library; None if the user has no home.
    folder: Option<PathBuf>,
    asked: bool,
    /// The imprints that [`Shelf::imprint`] has found. A batch keeps using a shape as it was when it was first looked
    /// up.
    found: Arc<Mutex<HashMap<String, Imprint>>>,
}

/// A folder that cannot exist, because it would be below a device.
const NO_FOLDER: &str = "/dev/null/library";

#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub(crate) enum Located {
    Shape(StoredShape),
    File(PathBuf, File),
    Standard,
}

impl Shelf {
    /// Creates a shelf for the library in `folder`, None if the user has no home. `asked` tells whether `--library`
    /// names it.
    pub(crate) fn new(folder: Option<PathBuf>, asked: bool) -> Self {
        Self {
            folder,
            asked,
            found: Arc::default(),
        }
    }

    pub(crate) fn library(&self) -> Result<Library, LibraryError> {
        let folder = self.folder.clone().ok_or(LibraryError::NoPlace)?;
        Ok(Library::open(folder))
    }

    pub(crate) fn readable(&self) -> Library {
        self.library()
            .unwrap_or_else(|_| Library::open(PathBuf::from(NO_FOLDER)))
    }

    /// Returns the library that `--library` names; None if it is not given: scripts then use an empty library of
    /// their own.
    pub(crate) fn named(&self) -> Result<Option<Library>, LibraryError> {
        self.asked.then(|| self.library()).transpose()
    }

    /// Returns the folder that `--library` names, if it does not exist: it is made when a shape is saved, but its name
    /// may be mistyped.
    pub(crate) fn missing_folder(&self) -> Option<&Path> {
        let folder = self.folder.as_deref().filter(|_| self.asked)?;
        (folder.metadata().as_ref().err().is_some_and(is_missing)).then_some(folder)
    }

    pub(crate) fn find(&self, what: &OsStr) -> Result<Content, CliError> {
        let (name, content) = match self.locate(what)? {
            Located::Shape(shape) => return Ok(Content::Shape(shape)),
            Located::Standard => (
                InputSource::Standard.name(),
                content::standard()
                    .map_err(InputError::from)
                    .and_then(content::read_from),
            ),
            Located::File(path, file) => (InputSource::File(path).name(), content::read_from(file)),
        };
        content.map_err(|error| CliError::Input { name, error })
    }

    pub(crate) fn locate(&self, what: &OsStr) -> Result<Located, CliError> {
        if what == "-" {
            return Ok(Located::Standard);
        }
        let named = what.to_str().map(|name| self.readable().load(name));
        let nowhere = match named {
            Some(Ok(loaded)) => return Ok(Located::Shape(loaded.shape)),
            // A similar name is searched only if there is no such file.
            Some(Err(LibraryError::Unknown(name))) => {
                let near = String::new();
                Some(CliError::Nowhere { name, near })
            }
            // A text that cannot be a name may be a path.
            Some(Err(LibraryError::Name(_))) | None => None,
            // An error of the library is reported only if there is no such file.
            Some(Err(error)) => Some(error.into()),
        };
        let path = PathBuf::from(what);
        let is_missing = |error: &std::io::Error| error.kind() == ErrorKind::NotFound;
        match (File::open(&path), nowhere) {
            (Ok(file), _) => Ok(Located::File(path, file)),
            (Err(error), Some(CliError::Nowhere { name, .. })) if is_missing(&error) => {
                let near = self.near_or_figure(&name);
                Err(CliError::Nowhere { name, near })
            }
            (Err(error), Some(nowhere)) if is_missing(&error) => Err(nowhere),
            (Err(error), _) => Err(CliError::Input {
                name: InputSource::File(path).name(),
                error: error.into(),
            }),
        }
    }

    /// Returns the end of a message about a name that no stored shape and no file has: that it is the name of a
    /// figure, or what [`Self::suggestion`] says.
    fn near_or_figure(&self, name: &str) -> String {
        match name.parse::<FigureKind>() {
            Ok(_) => format!("; {name:?} is a figure, which taxel figure and taxel sweep take"),
            Err(_) => self.suggestion(&LibraryError::Unknown(name.into())),
        }
    }

    /// Returns the message about an error of the library. For an unknown name, it suggests a similar one, or says where
    /// to look.
    pub(crate) fn refused(&self, error: LibraryError) -> CliError {
        if let LibraryError::System(refused) = &error
            && refused.error.kind() == ErrorKind::ReadOnlyFilesystem
        {
            let folder = self.folder.as_ref().unwrap_or(&refused.path);
            let name = folder.to_string_lossy().into_owned();
            return CliError::ReadOnlyLibrary { name };
        }
        if !matches!(
            error,
            LibraryError::Unknown(_) | LibraryError::NotInTrash(_)
        ) {
            return error.into();
        }
        let near = self.suggestion(&error);
        CliError::NoShape { error, near }
    }

    /// Returns the end of a message about an unknown name: a shape with a similar name, or if there is none, the
    /// command that lists the names.
    fn suggestion(&self, error: &LibraryError) -> String {
        let similar = self.readable().suggestion(error);
        if !similar.is_empty() {
            return similar;
        }
        if matches!(error, LibraryError::NotInTrash(_)) {
            return String::new();
        }
        let command = self.library_command("list");
        command.map_or(String::new(), |list| {
            format!("; to list all shapes: {list}")
        })
    }

    /// Returns the words `taxel library` with a command, and with the folder if `--library` names it; None if the
    /// folder's path is not UTF-8.
    pub(crate) fn library_command(&self, command: &str) -> Option<String> {
        let mut words = format!("taxel library {command}");
        if let Some(folder) = self.folder.as_ref().filter(|_| self.asked) {
            let folder = folder.to_str()?;
            // Otherwise a folder with a dash would be taken for a flag.
            let is_dashed = folder.starts_with('-');
            words += if is_dashed {
                " --library="
            } else {
                " --library "
            };
            words += &as_argument(folder);
        }
        Some(words)
    }

    pub(crate) fn imprint(&self, name: &str) -> Result<Imprint, LibraryError> {
        // The map is never left half changed.
        let found = || locked(&self.found);
        // Upper and lower case are the same in names, and only shapes that exist are kept. So the map never outgrows
        // the library, whatever names the input contains.
        let own = folded(name);
        if let Some(imprint) = found().get(&own) {
            return Ok(*imprint);
        }
        let shape = self.readable().load(name)?.shape;
        Ok(*found().entry(own).or_insert(shape.imprint))
    }

    /// Stores a shape and returns its name in the library, which may differ in case. `existing` tells whether an own
    /// shape of that name is replaced.
    pub(crate) fn save(&self, shape: &StoredShape, existing: Existing) -> Result<String, CliError> {
        let library = self.library()?;
        let expected = match existing {
            Existing::Replaced => Expected::Anything,
            Existing::Kept => Expected::Nothing,
        };
        let saved = match library.save(shape, expected) {
            Err(LibraryError::Exists { name, .. }) => return Err(CliError::Taken { name }),
            saved => saved,
        };
        saved.map_err(|error| self.refused(error))?;
        let stored = library.own_name(&shape.name).map_err(LibraryError::from)?;
        Ok(stored.unwrap_or_else(|| shape.name.to_string()))
    }
}

/// The largest file of shapes, in bytes.
const MAX_SET: u64 = 64 << 20;

pub(crate) fn read_set(asked: &SetFlags, shelf: &Shelf) -> Result<Vec<NamedShape>, CliError> {
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
            set_lines(&mut input, &name, &lookup, &mut shapes)?;
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

/// Returns the message about an argument that is not the name of a shape. For the name of a figure, it shows the line
/// that gives one; a folder of that name is mentioned.
fn no_shape(error: LibraryError, shelf: &Shelf) -> CliError {
    let kind = match &error {
        LibraryError::Unknown(name) => name.parse().ok(),
        _ => None,
    };
    let Some(kind) = kind else {
        return match error {
            LibraryError::Unknown(name) if Path::new(&name).is_dir() => CliError::NoShape {
                error: LibraryError::Unknown(name),
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

fn set_lines(
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
        let shape = named_shape(line, lookup)
            .map_err(|error| refused(name.to_owned(), error.in_line(index as u64 + 1).to_string()));
        shapes.push(shape?);
    }
    if shapes.len() == before {
        let error = "no shapes, expected a line of JSON for each";
        return Err(refused(name.to_owned(), error.to_owned()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use taxel_files::storage::FileError;

    use super::*;

    /// The lock or the temporary file is the first that cannot be written, but does not matter to the user.
    #[test]
    fn a_read_only_library_is_called_so() {
        let shelf = Shelf::new(None, false);
        let (doing, lock) = ("open the lock", Path::new("ro/.lock"));
        let refused = FileError::cannot(doing, lock)(ErrorKind::ReadOnlyFilesystem.into());
        let said = shelf.refused(refused.into()).to_string();
        assert!(said.ends_with(": the library is read-only"), "{said}");
    }

    #[test]
    fn shipped_shapes_need_no_folder() {
        let shelf = Shelf::new(None, false);
        let washer = shelf.locate(OsStr::new("washer"));
        assert!(matches!(washer, Ok(Located::Shape(_))), "{washer:?}");
        assert!(shelf.imprint("washer").is_ok());
        assert!(!shelf.readable().list().expect("shipped shapes").is_empty());
        assert!(matches!(shelf.library(), Err(LibraryError::NoPlace)));
    }

    #[test]
    fn a_name_that_ends_like_a_file_of_lines_is_one_in_upper_case_too() {
        let is_source =
            |what| source_of_lines(OsStr::new(what), &Shelf::new(None, false)).is_some();
        assert!(is_source("missing.jsonl") && is_source("MISSING.JSONL"));
        assert!(!is_source("missing"));
    }
}
