//! `taxel export`, and `--export` of a touch: an imprint in the forms of other programs, or drawn.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::cli::error::CliError;
use crate::cli::input::content::Content;
use crate::cli::input::shapes::Shelf;
use crate::cli::settings::pitch::Pitch;
use crate::formats::{Drawing, ImprintFormat};
use crate::imprint::Imprint;
use crate::source::Source;
use crate::storage::{Existing, FileError, FinishedFile, UnfinishedFile};

/// What a file is to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// The imprint.
    Imprint(ImprintFormat),
    /// A drawing of it with its descriptors.
    Svg,
    /// The same in pixels.
    Png,
}

impl Format {
    fn of(name: &str) -> Option<Self> {
        match name {
            "svg" => Some(Self::Svg),
            "png" => Some(Self::Png),
            _ => ImprintFormat::ALL
                .iter()
                .find(|format| format.name() == name)
                .map(|&format| Self::Imprint(format)),
        }
    }

    fn of_ending(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        let format = ImprintFormat::of_ending(&ending).map(Self::Imprint);
        format.or_else(|| Self::of(&ending).filter(|format| !matches!(format, Self::Imprint(_))))
    }
}

/// The names of all formats, as `--format` takes them.
pub(crate) fn names() -> Vec<&'static str> {
    let imprints = ImprintFormat::ALL.iter().map(|format| format.name());
    imprints.chain(["svg", "png"]).collect()
}

/// A file that is to be written.
#[derive(Clone, Debug)]
pub(crate) struct Export {
    /// Standard output where there is none.
    path: Option<PathBuf>,
    format: Format,
    existing: Existing,
}

impl Export {
    /// The file of that name, `-` for standard output, in the format of that name or else of its ending.
    ///
    /// # Errors
    /// Where neither tells the format.
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
                return "what goes to standard output needs a '--format'".to_owned();
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

    /// Writes an imprint, all but for the name of the file.
    pub(crate) fn begin(
        &self,
        imprint: &Imprint,
        source: Option<&Source>,
        title: &str,
        pitch: Option<f64>,
    ) -> Result<Begun, CliError> {
        let draw = || {
            let mut drawing = Drawing::new(imprint);
            if let Some(source) = source {
                drawing = drawing.with_outline(source);
            }
            match (source, pitch) {
                // What made it is told in cells, whatever the axes are in.
                (Some(_), Some(pitch)) => drawing
                    .with_pitch(pitch)
                    .with_title(&format!("{title} (in cells)")),
                (None, Some(pitch)) => drawing.with_pitch(pitch).with_title(title),
                (_, None) => drawing.with_title(title),
            }
        };
        let content = match self.format {
            Format::Imprint(format) => format.write(imprint),
            Format::Svg => draw().svg().into_bytes(),
            Format::Png => draw().png().map_err(CliError::Write)?,
        };
        match &self.path {
            None => Ok(Begun::Content(content)),
            Some(path) => Ok(Begun::File(finished(path, &content, self.existing)?)),
        }
    }
}

/// An export that lacks only its name. Dropped, nothing is left of it.
#[derive(Debug)]
pub(crate) enum Begun {
    /// It has none: it is for standard output.
    Content(Vec<u8>),
    /// A file.
    File(FinishedFile),
}

impl Begun {
    /// Gives the file its name, and what is to be said of it; or gives the content.
    pub(crate) fn end(self) -> Result<Exported, CliError> {
        match self {
            Self::Content(content) => Ok(Exported::Content(content)),
            Self::File(file) => {
                let said = format!("written to {}", file.path().display());
                file.persist()?;
                Ok(Exported::Said(said))
            }
        }
    }
}

/// What is left of an export for standard output.
#[derive(Clone, Debug)]
pub(crate) enum Exported {
    /// The file itself.
    Content(Vec<u8>),
    /// Where it is.
    Said(String),
}

/// Writes a file, all of it or none.
pub(crate) fn put(path: &Path, content: &[u8], existing: Existing) -> Result<(), CliError> {
    Ok(finished(path, content, existing)?.persist()?)
}

fn finished(path: &Path, content: &[u8], existing: Existing) -> Result<FinishedFile, FileError> {
    let mut file = UnfinishedFile::new(path, existing)?;
    file.write(content)?;
    file.finish()
}

/// Writes the shape of that name, else what is in that file. A stored shape is drawn with the outline that made it.
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
