//! Opens recordings: files, or standard input; a pipe is first copied to a temporary file because a recording is read
//! several times.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::ops::ControlFlow;
use std::os::fd::AsFd;
use std::path::Path;

use taxel_core::frame::{Frame, View};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_core::progress::stop_if;
use taxel_core::quote::shortened_message;
use taxel_core::sensor::MatrixSize;
use taxel_files::acquire::metadata_beside;
use taxel_files::formats::recording::{
    Format, ReadOptions, RecordingEvent, RecordingMetadata, format_of, read, read_rows,
};
use taxel_files::{ReadError, ReadErrorKind};

use crate::cli::failure::{Failure, Named};
use crate::cli::input::content::{Input, input_name};

/// The most bytes that are read of a table. A table of 64 × 64 factors is much smaller.
const LARGEST_TABLE: u64 = 1 << 20;

pub(crate) struct RecordingFile {
    pub(crate) name: String,
    file: File,
    options: ReadOptions,
    metadata: Option<RecordingMetadata>,
    /// What is wrong with the metadata beside it.
    pub(crate) complaint: Option<String>,
    /// Whether it is known to be damaged, so that the damage is not reported again.
    pub(crate) is_damaged: bool,
}

impl RecordingFile {
    pub(crate) fn open(path: &Path, options: ReadOptions) -> Result<Self, Failure> {
        Self::named(input_name(path), path, options)
    }

    fn named(name: String, path: &Path, options: ReadOptions) -> Result<Self, Failure> {
        let (metadata, complaint) = match metadata_beside(path) {
            Ok(metadata) => {
                let complaint = metadata.as_ref().and_then(|own| unended(path, own));
                (metadata, complaint)
            }
            Err(error) => (None, Some(error.to_string())),
        };
        let file = opened(path).map_err(ReadError::from).named(&name)?;
        Ok(Self {
            name,
            file,
            options,
            metadata,
            complaint,
            is_damaged: false,
        })
    }

    pub(crate) fn read(
        &mut self,
        sink: &mut dyn FnMut(RecordingEvent<'_>) -> ControlFlow<()>,
    ) -> Result<&'static Format, ReadError> {
        let metadata = self.metadata.as_ref();
        read(&mut self.file, &self.options, &mut |event| match event {
            RecordingEvent::Channel(info) => {
                sink(RecordingEvent::Channel(&info.completed(metadata)))
            }
            event => sink(event),
        })
    }

    /// Reads the frames of a channel from the beginning of the recording again, until `take` breaks or fails. Damage
    /// is an error unless it is known or comes after that.
    pub(crate) fn frames_again(
        &mut self,
        channel: usize,
        mut take: impl FnMut(&Frame) -> Result<ControlFlow<()>, Failure>,
    ) -> Result<(), Failure> {
        let mut failed = None;
        let read = self.read(&mut |event| match event {
            RecordingEvent::Frame(frame) if frame.channel == channel => {
                take(frame).unwrap_or_else(|error| {
                    failed = Some(error);
                    ControlFlow::Break(())
                })
            }
            _ => ControlFlow::Continue(()),
        });
        match (failed, read) {
            (Some(failed), _) => Err(failed),
            (None, Err(error)) if !self.is_damaged => Err(damaged(&self.name, &error)),
            _ => Ok(()),
        }
    }

    /// The names of its channels, up to the one of this name; and whether all of it could be read.
    pub(crate) fn channel_names(&mut self, up_to: &str) -> (Vec<String>, bool) {
        let mut names = Vec::new();
        let read = self.read(&mut |event| {
            if let RecordingEvent::Channel(info) = event {
                names.push(info.shown_name().to_owned());
            }
            stop_if(names.last().is_some_and(|name| name == up_to))
        });
        (names, read.is_ok())
    }

    pub(crate) fn format(&mut self) -> Option<&'static Format> {
        self.file.rewind().ok()?;
        format_of(&mut self.file, &self.options).ok()
    }
}

/// The failure about a recording or a source of this name.
pub(crate) fn refused(name: &str, why: impl Display) -> Failure {
    Failure::new(format!("{name}: {}", shortened_message(&why.to_string())))
}

/// The failure that a recording cannot be read, and what helps if it does not state the size of its frames.
pub(crate) fn damaged(name: &str, error: &ReadError) -> Failure {
    let failure = refused(name, error);
    match error.kind {
        ReadErrorKind::Unsized => failure.with_hint("; give --rows and --columns"),
        _ => failure,
    }
}

fn unended(path: &Path, metadata: &RecordingMetadata) -> Option<String> {
    let beside = path.with_extension("json");
    let beside = beside.display();
    if metadata.ended == Some(false) {
        return Some(format!(
            "{beside}: has no end: still being recorded, or the program was killed; the last half second may be missing"
        ));
    }
    let reason = metadata.ended_by.as_ref()?;
    Some(format!("{beside}: the recording ended early: {reason}"))
}

fn opened(path: &Path) -> io::Result<File> {
    let mut file: File = if path.as_os_str() == "-" {
        io::stdin().as_fd().try_clone_to_owned()?.into()
    } else {
        File::open(path)?
    };
    let kind = file.metadata()?;
    // A file is read again from its beginning, so that must be where the shell has it. A pipe cannot be read twice.
    if kind.is_dir() || kind.is_file() && file.stream_position()? == 0 {
        return Ok(file);
    }
    let mut copy = tempfile::tempfile()?;
    if io::copy(&mut file.take(MOST + 1), &mut copy)? > MOST {
        let text = "more than 4 GiB; use taxel watch for endless input";
        return Err(io::Error::other(text));
    }
    copy.rewind()?;
    Ok(copy)
}

/// The most that is copied, in bytes, so that an endless input does not fill the disk.
const MOST: u64 = 4 << 30;

/// The cells without a value: the active taxels of an imprint.
pub(crate) fn dead_cells(path: &Path) -> Result<Imprint, Failure> {
    let read = Input::open(path).and_then(Input::content);
    let content = read.map_err(|failure| failure.of_flag("--mask"))?;
    Ok(*content.imprint())
}

/// Reads a table of factors, in any format of recordings with one frame. Reading stops at a second frame, which is an
/// error. The table must have the size of the cropped frames, which is checked when the first of them is processed.
pub(crate) fn gain(path: &Path) -> Result<Matrix<f64>, Failure> {
    let name = format!("--gain {}", input_name(path));
    let mut file = RecordingFile::named(name, path, ReadOptions::default())?;
    let mut gain = Matrix::filled(MatrixSize::SMALLEST, 1.0);
    let mut frames = Vec::new();
    let mut take = |event: RecordingEvent<'_>| {
        if let RecordingEvent::Frame(frame) = event {
            frames.push(View::default().apply_to(frame, &mut gain));
        }
        stop_if(frames.len() > 1)
    };
    let unclear = [ReadErrorKind::Unsized, ReadErrorKind::UnknownFormat];
    let read = match file.read(&mut take) {
        // Either each line was read as a frame; or the file did not look like a table, because a single column has no
        // separators. In both cases it is one table of factors.
        Err(error) if unclear.contains(&error.kind) => match file.read_table(&mut take) {
            Err(table) if table.kind == ReadErrorKind::UnknownFormat => Err(error),
            read => read,
        },
        read => read.map(drop),
    };
    let refused = |why| Err(refused(&file.name, why));
    match (read, frames.pop()) {
        (Err(error), _) if error.kind == ReadErrorKind::Unsized => {
            refused("expected a table: a line for each row")
        }
        (Err(error), _) => Err(damaged(&file.name, &error)),
        (Ok(()), Some(_)) if !frames.is_empty() => {
            refused("a recording of several frames, expected a table of factors")
        }
        (Ok(()), Some(taken)) => taken.map(|()| gain).named(&file.name),
        (Ok(()), None) => refused("no frame, expected a table of factors"),
    }
}

impl RecordingFile {
    fn read_table(
        &mut self,
        sink: &mut dyn FnMut(RecordingEvent<'_>) -> ControlFlow<()>,
    ) -> Result<(), ReadError> {
        self.file.rewind()?;
        let mut bytes = Vec::new();
        Read::by_ref(&mut self.file)
            .take(LARGEST_TABLE)
            .read_to_end(&mut bytes)?;
        read_rows(&bytes, sink)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(text: &str, is_damaged: bool, fatal: f64) -> (Vec<f64>, Result<(), String>) {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::fs::write(file.path(), text).expect("written");
        let mut recording =
            RecordingFile::open(file.path(), ReadOptions::default()).expect("a file");
        recording.is_damaged = is_damaged;
        let mut values = Vec::new();
        let read = recording.frames_again(0, |frame| {
            let value = frame.values()[0];
            values.push(value);
            if value == fatal {
                return Err(Failure::new("fatal"));
            }
            Ok(ControlFlow::Continue(()))
        });
        (values, read.map_err(|error| error.text))
    }

    #[test]
    fn only_unknown_damage_is_an_error_when_frames_are_read_again() {
        let damaged = "r0c0,r0c1\n1,2\n3,4\n5,x\n";
        let (values, read) = taken(damaged, false, 9.0);
        assert_eq!(values, [1.0, 3.0]);
        let error = read.expect_err("damaged");
        assert!(error.contains("line 4, column 2: found \"x\""), "{error}");
        assert_eq!(taken(damaged, true, 9.0), (vec![1.0, 3.0], Ok(())));
    }

    #[test]
    fn frames_are_not_read_beyond_a_failure() {
        let two_channels = "{\"channel\":\"a\",\"frame\":[[1]]}\n{\"channel\":\"b\",\"frame\":[[2]]}\n\
                            {\"channel\":\"a\",\"frame\":[[3]]}\n{\"channel\":\"a\",\"frame\":[[4]]}\nx\n";
        let failed = Err("fatal".to_owned());
        assert_eq!(taken(two_channels, false, 3.0), (vec![1.0, 3.0], failed));
    }
}
