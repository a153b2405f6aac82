//! The library as commands use it: looks up shapes by name or file, and stores them.
//!
//! A `NAME|FILE` argument is looked up in this order: `-` is standard input; then a shape of the library; then a file.
//! A path such as `./washer.json` cannot be a name, so it always means the file.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use taxel_core::figure::FigureKind;
use taxel_core::lock::locked;
use taxel_core::quote::shortened_message;
use taxel_core::recognition::NamedShape;
use taxel_core::source::Source;
use taxel_files::formats::file::{is_missing, without_mark};
use taxel_files::formats::name::folded;
use taxel_files::formats::{Content, StoredShape, named_shape};
use taxel_files::storage::{Existing, Expected, Library, LibraryError};

use crate::cli::commands::model::SetFlags;
use crate::cli::failure::{Failure, Named};
use crate::cli::input::content::Input;
use crate::cli::input::outlines::{may_be_outline, stem};
use crate::cli::settings::Pitch;

/// The library, which is opened when it is first used: most commands never need it.
#[derive(Debug, Default)]
pub(crate) struct Shelf {
    /// The folder of the library; None if the user has no home.
    pub(crate) folder: Option<PathBuf>,
    /// Whether `--library` names it.
    pub(crate) asked: bool,
    /// The shapes that [`Shelf::source`] has found. A batch keeps using a shape as it was when it was first looked
    /// up.
    pub(crate) found: Mutex<HashMap<String, Source>>,
}

/// A folder that cannot exist, because it would be below a device.
const NO_FOLDER: &str = "/dev/null/library";

/// What a `NAME|FILE` argument stands for.
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub(crate) enum Located {
    Shape(StoredShape),
    Input(Input),
}

impl Shelf {
    pub(crate) fn library(&self) -> Result<Library, Failure> {
        let folder = self.folder.clone().ok_or(LibraryError::NoPlace);
        folder
            .map(Library::open)
            .map_err(|error| self.refused(error))
    }

    pub(crate) fn readable(&self) -> Library {
        Library::open(self.folder.clone().unwrap_or_else(|| NO_FOLDER.into()))
    }

    /// Returns the library that `--library` names; None if it is not given: scripts then use an empty library of
    /// their own.
    pub(crate) fn named(&self) -> Result<Option<Library>, Failure> {
        self.asked.then(|| self.library()).transpose()
    }

    /// Returns the folder that `--library` names, if it does not exist: it is made when a shape is saved, but its name
    /// may be mistyped.
    pub(crate) fn missing_folder(&self) -> Option<&Path> {
        let folder = self.folder.as_deref().filter(|_| self.asked)?;
        (folder.metadata().as_ref().err().is_some_and(is_missing)).then_some(folder)
    }

    pub(crate) fn find(&self, what: &OsStr) -> Result<Content, Failure> {
        match self.locate(what)? {
            Located::Shape(shape) => Ok(Content::Shape(shape)),
            Located::Input(input) => input.content(),
        }
    }

    pub(crate) fn locate(&self, what: &OsStr) -> Result<Located, Failure> {
        let path = Path::new(what);
        let name = what.to_str().filter(|&name| name != "-");
        match name.map(|name| self.readable().load(name)) {
            Some(Ok(loaded)) => return Ok(Located::Shape(loaded.shape)),
            // A text that cannot be a name may be a path.
            None | Some(Err(LibraryError::Name(_))) => {}
            // An error of the library matters only if there is no such file.
            Some(Err(error)) if path.symlink_metadata().is_err_and(|own| is_missing(&own)) => {
                return Err(match &error {
                    LibraryError::Unknown(name) => {
                        let text = format!("no stored shape or file named {name:?}");
                        Failure::new(shortened_message(&text)).with_hint(self.hint(&error))
                    }
                    _ => self.refused(error),
                });
            }
            Some(Err(_)) => {}
        }
        Input::open(path).map(Located::Input)
    }

    /// The message about an error of the library, and what helps.
    pub(crate) fn refused(&self, error: LibraryError) -> Failure {
        let hint = self.hint(&error);
        Failure::from(error).with_hint(hint)
    }

    fn hint(&self, error: &LibraryError) -> String {
        let similar = self.readable().suggestion(error);
        match error {
            LibraryError::NoPlace => {
                "; name a folder with --library DIR or TAXEL_LIBRARY".to_owned()
            }
            LibraryError::Unknown(name) if name.parse::<FigureKind>().is_ok() => {
                format!("; {name:?} is a figure, which taxel figure and taxel sweep take")
            }
            LibraryError::Unknown(_) if similar.is_empty() => {
                "; 'taxel library list' shows all".to_owned()
            }
            _ => similar,
        }
    }

    pub(crate) fn source(&self, name: &str) -> Result<Source, LibraryError> {
        // Upper and lower case are the same in names, and only shapes that exist are kept. So the map never outgrows
        // the library, whatever names the input contains.
        let own = folded(name);
        if let Some(source) = locked(&self.found).get(&own) {
            return Ok(source.clone());
        }
        let source = self.readable().load(name)?.shape.touched_again();
        locked(&self.found).insert(own, source.clone());
        Ok(source)
    }

    /// Stores a shape and returns its name in the library, which may differ in case. `existing` tells whether an own
    /// shape of that name is replaced.
    pub(crate) fn save(&self, shape: &StoredShape, existing: Existing) -> Result<String, Failure> {
        let library = self.library()?;
        let expected = match existing {
            Existing::Replaced => Expected::Anything,
            Existing::Kept => Expected::Nothing,
        };
        library.save(shape, expected).map_err(|error| {
            let exists = matches!(error, LibraryError::Exists { .. });
            let hint = if exists { "; --force replaces it" } else { "" };
            self.refused(error).with_hint(hint)
        })?;
        let stored = library.own_name(&shape.name)?;
        Ok(stored.unwrap_or_else(|| shape.name.to_string()))
    }
}

/// The largest file of shapes, in bytes.
const MAX_SET: usize = 64 << 20;

/// Reads a set of shapes: shapes of the library, outlines, files with a line of JSON for each, or the whole library.
pub(crate) fn read_set(
    asked: &SetFlags,
    pitch: Pitch,
    shelf: &Shelf,
) -> Result<Vec<NamedShape>, Failure> {
    let lengths = pitch.of(None);
    let (mut shapes, mut outlines) = (Vec::new(), 0);
    for what in &asked.what {
        match shelf.locate(what)? {
            Located::Shape(shape) => shapes.push(shape.of_set()),
            Located::Input(input) => {
                let name = input.name.clone();
                let bytes = input.bytes(MAX_SET)?;
                if may_be_outline(&name, &bytes) {
                    let outline = asked.outlines.read(&bytes, &name, lengths)?;
                    shapes.push(NamedShape::new(stem(&name), outline));
                    outlines += 1;
                } else {
                    shapes.extend(set_of_lines(&bytes, lengths, shelf).named(name)?);
                }
            }
        }
    }
    if outlines == 0 {
        asked.outlines.refuse()?;
    }
    if asked.library_all {
        let library = shelf.readable();
        for entry in library.list()? {
            shapes.push(library.load(&entry.name)?.shape.of_set());
        }
    }
    for shape in &mut shapes {
        let source = shape.source.clone().at_pitch(pitch.given);
        shape.source = source.named(&shape.name)?;
    }
    Ok(shapes)
}

fn set_of_lines(
    text: &[u8],
    pitch: Option<f64>,
    shelf: &Shelf,
) -> Result<Vec<NamedShape>, Failure> {
    let lookup = |name: &str| {
        let found = shelf.source(name);
        found.map_err(|error| shelf.refused(error).text)
    };
    if text.len() > MAX_SET {
        let text = "larger than 64 MiB, the limit for a set of shapes";
        return Err(Failure::new(text));
    }
    let mut shapes = Vec::new();
    for (number, line) in (1..).zip(without_mark(text).split(|&byte| byte == b'\n')) {
        if !line.trim_ascii().is_empty() {
            let shape = named_shape(line, pitch, &lookup);
            shapes.push(shape.map_err(|error| error.in_line(number))?);
        }
    }
    if shapes.is_empty() {
        return Err(Failure::new("no shapes, expected a line of JSON for each"));
    }
    Ok(shapes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_shapes_need_no_folder() {
        let shelf = Shelf::default();
        let washer = shelf.locate(OsStr::new("washer"));
        assert!(matches!(washer, Ok(Located::Shape(_))));
        assert!(!shelf.readable().list().expect("shipped shapes").is_empty());
        assert!(
            shelf
                .library()
                .is_err_and(|failure| failure.text.contains("--library DIR"))
        );
    }
}
