//! `taxel export`, and `--export` of a touch: writes an imprint in a format for other programs, or draws it.
//!
//! A file is complete or does not exist: it is written under another name in the same folder and then renamed.
//! Standard output, `-`, gets the same bytes.

use std::ffi::OsStr;
use std::path::Path;
use std::{fs, io};

use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_core::source::Source;
use taxel_files::formats::{Content, Drawing, Name, StoredShape};
use taxel_files::storage::{self, Existing, NewFile, check_writable};

use crate::cli::arguments::touch::{Export, Kept, Saving};
use crate::cli::error::CliError;
use crate::cli::input::recording::RecordingFile;
use crate::cli::input::shapes::Shelf;
use crate::cli::settings::resolved::Pitch;

impl Export {
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

    /// Refuses a file that would replace the recording being read, or that cannot be written. So one of
    /// several files that cannot be written is an error before the first of them is written.
    pub(crate) fn check(&self, recording: &RecordingFile) -> Result<(), CliError> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        recording.refuse_as_target(path)?;
        Ok(check_writable(path, self.existing)?)
    }

    pub(crate) fn begin_frame(
        &self,
        imprint: &Imprint,
        heat: Option<&Matrix<f64>>,
        title: &str,
        pitch: Option<f64>,
    ) -> Result<Begun, CliError> {
        let mut drawing = Drawing::new(imprint);
        title.clone_into(&mut drawing.title);
        drawing.heat = heat.cloned();
        drawing.pitch_mm = pitch;
        self.begin_with(&drawing)
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
        let mut drawing = Drawing::new(imprint);
        if let Some(source) = source {
            drawing = drawing.with_outline(source);
        }
        drawing.pitch_mm = pitch;
        drawing.title = match (source, pitch) {
            // The title describes the source, which is always in cells.
            (Some(_), Some(_)) => format!("{title} (in cells)"),
            _ => title.to_owned(),
        };
        self.begin_with(&drawing)
    }

    /// Makes the content and writes the file, which gets its name only in [`Begun::end`].
    fn begin_with(&self, drawing: &Drawing) -> Result<Begun, CliError> {
        let content = (self.format.write)(drawing);
        match &self.path {
            None => Ok(Begun::Content(content)),
            Some(path) => Ok(Begun::File(NewFile::with_content(
                path,
                &content,
                self.existing,
            )?)),
        }
    }
}

impl Kept {
    /// Keeps a touch: the file is written, then the shape is stored, then the file gets its name, which hardly ever
    /// fails. So both are kept or neither. Notes of what was kept are added to `notes`. Returns the content for
    /// standard output that takes the place of the answer, if any.
    pub(crate) fn keep(
        &self,
        begin: impl FnOnce(&Export) -> Result<Begun, CliError>,
        shape: impl FnOnce(Name) -> StoredShape,
        shelf: &Shelf,
        notes: &mut Vec<String>,
    ) -> Result<Option<Vec<u8>>, CliError> {
        let begun = self.export.as_ref().map(begin).transpose()?;
        if let Some(Saving { name, existing }) = &self.saving {
            let saved = shelf.save(&shape(name.clone()), *existing)?;
            notes.push(format!("saved as {saved}"));
        }
        Ok(match begun.map(Begun::end).transpose()? {
            Some(Exported::Content(content)) => Some(content),
            Some(Exported::Said(said)) => {
                notes.push(said);
                None
            }
            None => None,
        })
    }
}

#[derive(Debug)]
pub(crate) enum Begun {
    /// The bytes for standard output.
    Content(Vec<u8>),
    File(NewFile),
}

impl Begun {
    pub(crate) fn end(self) -> Result<Exported, CliError> {
        match self {
            Self::Content(content) => Ok(Exported::Content(content)),
            Self::File(file) => {
                let said = written(&file.path);
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
    Said(String),
}

pub(crate) fn written(path: &Path) -> String {
    format!("written: {}", path.display())
}

pub(crate) fn make_folder(folder: &Path) -> Result<(), CliError> {
    fs::create_dir_all(folder).map_err(|error| {
        let error = if folder.exists() {
            io::Error::other("a file, expected a folder")
        } else {
            error
        };
        CliError::of_file(folder, error)
    })
}

pub(crate) fn put(path: &Path, content: &[u8], existing: Existing) -> Result<(), CliError> {
    Ok(storage::write(path, content, existing)?)
}

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
