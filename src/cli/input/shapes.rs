//! The library as the commands see it: looks up shapes by name or file, and stores them.
//!
//! A `NAME|FILE` argument is looked up in this order: `-` is standard input; then a shape of the library; then a file.
//! A path such as `./washer.json` cannot be a name, so it always means the file.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::fs::File;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::cli::error::CliError;
use crate::cli::input::content;
use crate::cli::input::content::{InputError, InputSource};
use crate::figure::FigureKind;
use crate::formats::Content;
use crate::formats::StoredShape;
use crate::formats::name::folded;
use crate::imprint::Imprint;
use crate::storage::{Expected, Library, LibraryError};

/// The library, opened when it is first used: most commands never need it.
#[derive(Clone, Debug)]
pub(crate) struct Shelf {
    /// The folder of the library; None if the user has no home.
    folder: Option<PathBuf>,
    /// Whether `--library` names the folder.
    asked: bool,
    /// The library once it has been opened.
    library: OnceLock<Option<Library>>,
    /// What [`Shelf::imprint`] has found. A batch keeps using a shape as it was when it was first looked up.
    found: Arc<Mutex<HashMap<String, Imprint>>>,
}

/// What a `NAME|FILE` argument means.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub(crate) enum Located {
    /// A shape of the library.
    Shape(StoredShape),
    /// A file, opened.
    File(PathBuf, File),
    /// Standard input.
    Standard,
}

impl Shelf {
    /// A shelf for the library in `folder`, None if the user has no home; `asked` if `--library` names the folder.
    pub(crate) fn new(folder: Option<PathBuf>, asked: bool) -> Self {
        Self {
            folder,
            asked,
            library: OnceLock::new(),
            found: Arc::default(),
        }
    }

    /// The library.
    ///
    /// # Errors
    /// [`LibraryError::NoPlace`] if there is no folder for one.
    pub(crate) fn library(&self) -> Result<Library, LibraryError> {
        let library = || self.folder.clone().map(Library::open);
        let library = self.library.get_or_init(library);
        library.clone().ok_or(LibraryError::NoPlace)
    }

    /// A warning that only the shapes that come with the program can be read, if the library was used and a file is where a
    /// folder above its own would be.
    pub(crate) fn complaint(&self) -> Option<String> {
        let library = self.library.get()?.as_ref()?;
        let file = library.file_above()?;
        Some(format!(
            "warning: {}: a file, expected a folder for the library: only shipped shapes can be read",
            file.display()
        ))
    }

    /// The library that `--library` names, or None if it is not given: scripts use an empty library of their own then.
    pub(crate) fn named(&self) -> Result<Option<Library>, LibraryError> {
        self.asked.then(|| self.library()).transpose()
    }

    /// Looks up a `NAME|FILE` argument and reads it.
    ///
    /// # Errors
    /// Those of [`Self::locate`]; otherwise what is wrong with the file.
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

    /// Looks up a `NAME|FILE` argument: `-`, then a name, then a file.
    ///
    /// # Errors
    /// [`CliError::Nowhere`] if it is neither; otherwise what is wrong with the shape, or why the file cannot be
    /// opened.
    pub(crate) fn locate(&self, what: &OsStr) -> Result<Located, CliError> {
        if what == "-" {
            return Ok(Located::Standard);
        }
        let named = what
            .to_str()
            .map(|name| self.library().and_then(|library| library.load(name)));
        let nowhere = match named {
            Some(Ok(loaded)) => return Ok(Located::Shape(loaded.shape)),
            // What is like it is looked for only if there is no such file.
            Some(Err(LibraryError::Unknown { name })) => {
                let near = String::new();
                Some(CliError::Nowhere { name, near })
            }
            // What cannot be a name may be a path, and paths do not need a library.
            Some(Err(LibraryError::Name(_) | LibraryError::NoPlace)) | None => None,
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

    /// The end of a message about a name that no stored shape and no file has: that it is a figure, or a shape that is much
    /// like it.
    fn near_or_figure(&self, name: &str) -> String {
        match FigureKind::from_name(name) {
            Some(_) => format!("; {name:?} is a figure, which taxel figure and taxel sweep take"),
            None => self.suggestion(&LibraryError::Unknown { name: name.into() }),
        }
    }

    /// The message about an error of the library; a name that it does not have is compared with those that it has.
    pub(crate) fn refused(&self, error: LibraryError) -> CliError {
        if !matches!(
            error,
            LibraryError::Unknown { .. } | LibraryError::NotInTrash { .. }
        ) {
            return error.into();
        }
        let near = self.suggestion(&error);
        CliError::NoShape { error, near }
    }

    /// The end of a message about a name that is not there: the name of a shape that is much like it, if there is one.
    fn suggestion(&self, error: &LibraryError) -> String {
        let library = self.library();
        library.map_or_else(|_| String::new(), |library| library.suggestion(error))
    }

    /// The imprint of a stored shape, for the lines of a batch. Each shape is read once.
    ///
    /// # Errors
    /// If there is no such shape, or it cannot be read.
    pub(crate) fn imprint(&self, name: &str) -> Result<Imprint, LibraryError> {
        // It is whole at any time, whether or not a thread has panicked.
        let found = || self.found.lock().unwrap_or_else(PoisonError::into_inner);
        // Upper and lower case are the same in names, and only shapes that exist are kept: so the map never outgrows the
        // library, whatever the input asks for.
        let own = folded(name);
        if let Some(imprint) = found().get(&own) {
            return Ok(*imprint);
        }
        let shape = self.library()?.load(name)?.shape;
        Ok(*found().entry(own).or_insert(shape.imprint))
    }

    /// Stores a shape and returns the name that it has in the library, which may differ in upper and lower case. With
    /// `force` it replaces an own shape of that name.
    ///
    /// # Errors
    /// [`CliError::Taken`] if there is one and `force` is false; otherwise those of the library.
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
