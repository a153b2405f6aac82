//! `taxel export`, and `--export` of a touch: writes an imprint in a format for other programs, or draws it.
//!
//! A file is complete or does not exist: it is written under another name in the same folder and then renamed.
//! Standard output, `-`, gets the same bytes.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::cli::error::CliError;
use crate::cli::input::shapes::Shelf;
use crate::cli::settings::pitch::Pitch;
use crate::formats::Content;
use crate::formats::{Drawing, DrawingFormat, ImprintFormat};
use crate::imprint::Imprint;
use crate::matrix::Matrix;
use crate::source::Source;
use crate::storage::{Existing, FinishedFile};

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// The imprint, as text, PBM, CSV or NPY.
    Imprint(ImprintFormat),
    /// A drawing of the imprint with its descriptors.
    Drawing(DrawingFormat),
}

impl Format {
    /// Returns the format of this name, as in `--format`.
    fn of(name: &str) -> Option<Self> {
        let format = name.parse().map(Self::Imprint);
        format.or_else(|_| name.parse().map(Self::Drawing)).ok()
    }

    /// Returns the format of a file's extension.
    fn of_ending(path: &Path) -> Option<Self> {
        let format = ImprintFormat::of_ending(&ending(path)).map(Self::Imprint);
        format.or_else(|| DrawingFormat::of_path(path).map(Self::Drawing))
    }
}

/// Returns the names of all formats, for `--format`.
pub(crate) fn names() -> Vec<&'static str> {
    let imprints = ImprintFormat::ALL.iter().map(|format| format.name());
    let drawings = DrawingFormat::ALL.iter().map(|format| format.name());
    imprints.chain(drawings).collect()
}

/// A file to write.
#[derive(Clone, Debug)]
pub(crate) struct Export {
    /// Its path; None for standard output.
    path: Option<PathBuf>,
    /// The format that is written.
    format: Format,
    /// Whether an existing file is replaced.
    existing: Existing,
}

impl Export {
    /// Creates an export to `path`, or to standard output for `-`, in the format named by `format`, or else by the
    /// path's extension.
    ///
    /// # Errors
    /// Returns a message if neither names a format.
    pub(crate) fn new(
        path: &Path,
        format: Option<&str>,
        existing: Existing,
    ) -> Result<Self, String> {
        let format = match format {
            Some(name) => Format::of(name),
            None => Format::of_ending(path),
        };
        let is_standard = path.as_os_str() == "-";
        let format = format.ok_or_else(|| {
            if is_standard {
                return "writing to standard output needs '--format'".to_owned();
            }
            format!(
                "'{}': expected a name that ends in .txt, .pbm, .csv, .npy, .svg or .png, or a '--format'",
                path.display()
            )
        })?;
        Ok(Self {
            path: (!is_standard).then(|| path.to_owned()),
            format,
            existing,
        })
    }

    /// Returns the same export with the number of a frame at the end of the file name, before the extension.
    pub(crate) fn numbered(&self, number: u64) -> Self {
        let path = self.path.as_ref().map(|path| {
            let stem = path.file_stem().unwrap_or(path.as_os_str());
            let mut name = stem.to_owned();
            name.push(format!("-{number}"));
            if let Some(ending) = path.extension() {
                name.push(".");
                name.push(ending);
            }
            path.with_file_name(name)
        });
        Self { path, ..*self }
    }

    /// Like [`Self::begin`], for a frame. A drawing shows its values in shades, if they are given.
    pub(crate) fn begin_frame(
        &self,
        imprint: &Imprint,
        heat: Option<&Matrix<f64>>,
        title: &str,
        pitch: Option<f64>,
    ) -> Result<Begun, CliError> {
        self.begin_with(imprint, || {
            let mut drawing = Drawing::new(imprint).with_title(title);
            if let Some(values) = heat {
                drawing = drawing.with_heat(values);
            }
            match pitch {
                Some(pitch) => drawing.with_pitch(pitch),
                None => drawing,
            }
        })
    }

    /// Writes the file completely, but does not give it its name yet.
    ///
    /// A drawing shows the outline of `source` if there is one, `title` above it, and axes in mm if there is a
    /// `pitch`.
    pub(crate) fn begin(
        &self,
        imprint: &Imprint,
        source: Option<&Source>,
        title: &str,
        pitch: Option<f64>,
    ) -> Result<Begun, CliError> {
        self.begin_with(imprint, || {
            let mut drawing = Drawing::new(imprint);
            if let Some(source) = source {
                drawing = drawing.with_outline(source);
            }
            match (source, pitch) {
                // The title describes the source, which is always in cells.
                (Some(_), Some(pitch)) => drawing
                    .with_pitch(pitch)
                    .with_title(&format!("{title} (in cells)")),
                (None, Some(pitch)) => drawing.with_pitch(pitch).with_title(title),
                (_, None) => drawing.with_title(title),
            }
        })
    }

    /// Makes the content and writes the file, which gets its name only in [`Begun::end`]. `draw` is called only for
    /// drawings.
    fn begin_with(&self, imprint: &Imprint, draw: impl Fn() -> Drawing) -> Result<Begun, CliError> {
        let content = match self.format {
            Format::Imprint(format) => format.write(imprint),
            Format::Drawing(format) => draw().content(format).map_err(CliError::Write)?,
        };
        match &self.path {
            None => Ok(Begun::Content(content)),
            Some(path) => Ok(Begun::File(FinishedFile::new(
                path,
                &content,
                self.existing,
            )?)),
        }
    }
}

/// A file that has no name yet. If it is dropped, it is removed.
#[derive(Debug)]
pub(crate) enum Begun {
    /// The bytes for standard output.
    Content(Vec<u8>),
    /// The file.
    File(FinishedFile),
}

impl Begun {
    /// Gives the file its name.
    ///
    /// # Errors
    /// Returns an error if this fails, for example because a file of this name exists by now.
    pub(crate) fn end(self) -> Result<Exported, CliError> {
        match self {
            Self::Content(content) => Ok(Exported::Content(content)),
            Self::File(file) => {
                let said = written(file.path());
                file.persist()?;
                Ok(Exported::Said(said))
            }
        }
    }
}

/// The output after an export.
#[derive(Clone, Debug)]
pub(crate) enum Exported {
    /// The exported bytes.
    Content(Vec<u8>),
    /// A note that names the file.
    Said(String),
}

/// Returns the note that a file was written.
pub(crate) fn written(path: &Path) -> String {
    format!("written: {}", path.display())
}

/// Returns the extension of a file's name in lower case; empty if there is none.
pub(crate) fn ending(path: &Path) -> String {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.map_or_else(String::new, str::to_ascii_lowercase)
}

/// Writes a file, completely or not at all.
pub(crate) fn put(path: &Path, content: &[u8], existing: Existing) -> Result<(), CliError> {
    Ok(FinishedFile::new(path, content, existing)?.persist()?)
}

/// Looks up a shape and exports it. The drawing of a stored shape shows the outline of its source.
pub(crate) fn export(
    shelf: &Shelf,
    what: &OsStr,
    export: &Export,
    pitch: Pitch,
) -> Result<Exported, CliError> {
    let begun = match shelf.find(what)? {
        Content::Imprint(imprint) => {
            let title = Path::new(what)
                .file_name()
                .unwrap_or(what)
                .to_string_lossy();
            export.begin(&imprint, None, &title, pitch.of(None))
        }
        Content::Shape(shape) => {
            let source = shape.source.as_ref();
            let title = match source {
                Some(source) => format!("{}: {source}", shape.name),
                None => shape.name.to_string(),
            };
            let pitch = pitch.of(Some(&shape.sensor));
            export.begin(&shape.imprint, source, &title, pitch)
        }
    };
    begun?.end()
}
