//! `taxel export`, and `--export` of a touch: an imprint in the forms of other programs, or drawn.

use std::ffi::OsStr;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::input::Content;
use super::shelf::Shelf;
use crate::formats::drawing::Drawing;
use crate::formats::exchange::Format as ImprintFormat;
use crate::formats::unfinished::{Existing, Unfinished};
use crate::imprint::Imprint;
use crate::source::Source;

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
pub(super) fn names() -> Vec<&'static str> {
    let imprints = ImprintFormat::ALL.iter().map(|format| format.name());
    imprints.chain(["svg", "png"]).collect()
}

/// A file that is to be written.
#[derive(Clone, Debug)]
pub(super) struct Export {
    /// Standard output where there is none.
    path: Option<PathBuf>,
    format: Format,
    force: bool,
}

impl Export {
    /// The file of that name, `-` for standard output, in the format of that name or else of its ending.
    ///
    /// # Errors
    /// Where neither tells the format.
    pub(super) fn new(path: &Path, format: Option<&str>, force: bool) -> Result<Self, String> {
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
            force,
        })
    }

    /// Writes an imprint, and gives what is to be said of it; or gives the content, where it is for standard output.
    pub(super) fn write(
        &self,
        imprint: &Imprint,
        source: Option<&Source>,
        title: Option<&str>,
        pitch: Option<f64>,
    ) -> Result<Exported, Failure> {
        let draw = || {
            let mut drawing = Drawing::new(imprint);
            if let Some(source) = source {
                drawing = drawing.with_outline(source);
            }
            if let Some(title) = title {
                drawing = drawing.with_title(title);
            }
            match pitch {
                Some(pitch) => drawing.with_pitch(pitch),
                None => drawing,
            }
        };
        let content = match self.format {
            Format::Imprint(format) => format.write(imprint),
            Format::Svg => draw().svg().into_bytes(),
            Format::Png => draw().png().map_err(Failure::Write)?,
        };
        let Some(path) = &self.path else {
            return Ok(Exported::Content(content));
        };
        put(path, &content, self.force)?;
        Ok(Exported::Said(format!("written to {}", path.display())))
    }
}

/// What is left of an export for standard output.
#[derive(Clone, Debug)]
pub(super) enum Exported {
    /// The file itself.
    Content(Vec<u8>),
    /// Where it is.
    Said(String),
}

/// Writes a file whole; over one that is there only by `force`.
pub(super) fn put(path: &Path, content: &[u8], force: bool) -> Result<(), Failure> {
    let existing = if force {
        Existing::Replaced
    } else {
        Existing::Kept
    };
    let name = || path.to_string_lossy().into_owned();
    let written = Unfinished::new(path, existing).and_then(|mut file| {
        file.output.write_all(content)?;
        file.whole()?.keep()
    });
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Failure::Taken { name: name() },
        _ => Failure::File {
            name: name(),
            error,
        },
    })
}

/// Writes the shape of that name, else what is in that file. A stored shape is drawn with the outline that made it.
pub(super) fn export(
    shelf: &Shelf,
    what: &OsStr,
    export: &Export,
    pitch: Option<f64>,
) -> Result<Exported, Failure> {
    match shelf.find(what)? {
        Content::Imprint(imprint) => export.write(&imprint, None, None, pitch),
        Content::Shape(shape) => {
            let source = shape.source.as_ref();
            let title = match source {
                Some(source) => format!("{}: {source}", shape.name),
                None => shape.name.to_string(),
            };
            export.write(&shape.imprint, source, Some(&title), pitch)
        }
    }
}
