//! The library as the commands use it: shapes by name or by file, and storing them.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::PathBuf;

use crate::cli::error::CliError;
use crate::cli::input::content;
use crate::cli::input::content::{Content, InputError, InputSource};
use crate::formats::StoredShape;
use crate::imprint::Imprint;
use crate::storage::{Expected, Library, LibraryError};

/// The library, opened when it is used first.
#[derive(Debug)]
pub(crate) struct Shelf {
    folder: Option<PathBuf>,
    /// Whether the arguments name it.
    asked: bool,
    library: RefCell<Option<Library>>,
    /// What [`Shelf::imprint`] has found. A run uses what a shape was when it was asked for first.
    found: RefCell<HashMap<String, Imprint>>,
}

impl Shelf {
    /// The library in that folder, where there is a place for one; and whether the arguments name it.
    pub(crate) fn new(folder: Option<PathBuf>, asked: bool) -> Self {
        Self {
            folder,
            asked,
            library: RefCell::default(),
            found: RefCell::default(),
        }
    }

    /// The library.
    pub(crate) fn library(&self) -> Result<Library, LibraryError> {
        let mut library = self.library.borrow_mut();
        if library.is_none() {
            *library = self.folder.clone().map(Library::open);
        }
        library.clone().ok_or(LibraryError::NoPlace)
    }

    /// The library that the arguments name, if they do.
    pub(crate) fn named(&self) -> Result<Option<Library>, LibraryError> {
        self.asked.then(|| self.library()).transpose()
    }

    /// The shape of that name, else the content of that file; of standard input for `-`.
    pub(crate) fn find(&self, what: &OsStr) -> Result<Content, CliError> {
        let read = |source: &InputSource| {
            content::read(source).map_err(|error| CliError::Input {
                name: source.name(),
                error,
            })
        };
        if what == "-" {
            return read(&InputSource::Standard);
        }
        let named = what
            .to_str()
            .map(|name| self.library().and_then(|library| library.load(name)));
        let nowhere = match named {
            Some(Ok(loaded)) => return Ok(Content::Shape(loaded.shape)),
            Some(Err(LibraryError::Unknown { name })) => Some(name),
            // What cannot be a name may be a path, and a path needs no library.
            Some(Err(LibraryError::Name(_) | LibraryError::NoPlace)) | None => None,
            // A library that cannot be read is told of unless there is such a file.
            Some(Err(error)) => {
                return match read(&InputSource::File(what.into())) {
                    Err(CliError::Input {
                        error: InputError::Read(missing),
                        ..
                    }) if missing.kind() == ErrorKind::NotFound => Err(error.into()),
                    content => content,
                };
            }
        };
        match (read(&InputSource::File(what.into())), nowhere) {
            (
                Err(CliError::Input {
                    error: InputError::Read(error),
                    ..
                }),
                Some(name),
            ) if error.kind() == ErrorKind::NotFound => Err(CliError::Nowhere { name }),
            (result, _) => result,
        }
    }

    /// The imprint of the shape of that name; read once.
    pub(crate) fn imprint(&self, name: &str) -> Result<Imprint, LibraryError> {
        if let Some(imprint) = self.found.borrow().get(name) {
            return Ok(*imprint);
        }
        let shape = self.library()?.load(name)?.shape;
        // Only what is there is kept, and under one name each, not under all ways to write it in upper and lower case:
        // no input makes this larger than the library.
        let mut found = self.found.borrow_mut();
        Ok(*found.entry(shape.name.to_string()).or_insert(shape.imprint))
    }

    /// Stores a shape, in place of an own one of that name only by `force`; answers the name that it has there, which may
    /// differ in upper and lower case.
    pub(crate) fn save(&self, shape: &StoredShape, force: bool) -> Result<String, CliError> {
        let library = self.library()?;
        let saved = match library.save(shape, Expected::Nothing) {
            Err(LibraryError::Exists { stamp, .. }) if force => {
                library.save(shape, Expected::Stamp(stamp))
            }
            Err(LibraryError::Exists { name, .. }) => return Err(CliError::Taken { name }),
            saved => saved,
        };
        saved?;
        Ok(library.stored_name(&shape.name)?)
    }
}
