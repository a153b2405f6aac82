//! Opens recordings: files, or standard input; a pipe is copied to a temporary file because a recording is read
//! several times.

use std::fmt::Debug;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::ControlFlow;
use std::os::fd::AsFd;
use std::path::Path;

use crate::acquire::metadata_beside;
use crate::cli::error::CliError;
use crate::cli::input::content;
use crate::cli::input::content::{InputError, InputSource};
use crate::cli::input::spool::SpooledInput;
use crate::formats::recording::{
    ReadOptions, RecordingError, RecordingEvent, RecordingFormat, RecordingMetadata, format_of,
    read, read_rows,
};
use crate::frame::Frame;
use crate::imprint::Imprint;
use crate::storage::FileId;

/// The most bytes that are read of a table. A table of 64 × 64 factors is much smaller.
const LARGEST_TABLE: u64 = 1 << 20;

#[derive(Debug)]
pub(crate) struct RecordingFile {
    name: String,
    file: Box<dyn ReadAgain>,
    /// The file that holds the content, so that it is not replaced.
    id: FileId,
    options: ReadOptions,
    metadata: Option<RecordingMetadata>,
    complaint: Option<String>,
    /// Whether the recording is known to be damaged, so that the damage is not reported again.
    is_damaged: bool,
}

impl RecordingFile {
    pub(crate) fn open(path: &Path, options: ReadOptions) -> Result<Self, CliError> {
        let source = InputSource::of(path);
        let name = source.name();
        let opened = || -> io::Result<(FileId, Box<dyn ReadAgain>)> {
            if source == InputSource::Standard {
                let input = content::standard()?;
                let file = File::from(input.as_fd().try_clone_to_owned()?);
                let id = FileId::of(&file)?;
                // A file is read again from its beginning, so that must be where the shell has it.
                let is_whole = file.metadata()?.is_file() && (&file).stream_position()? == 0;
                return Ok((
                    id,
                    if is_whole {
                        Box::new(file)
                    } else {
                        spooled(input)?
                    },
                ));
            }
            let file = File::open(path)?;
            let id = FileId::of(&file)?;
            // A pipe cannot be read twice.
            if file.metadata()?.is_file() || file.metadata()?.is_dir() {
                Ok((id, Box::new(file)))
            } else {
                Ok((id, spooled(file)?))
            }
        };
        let (metadata, complaint) = match metadata_beside(path) {
            Some(Ok(metadata)) => {
                let complaint = unended(path, &metadata);
                (Some(metadata), complaint)
            }
            Some(Err(error)) => (None, Some(error.to_string())),
            None => (None, None),
        };
        match opened() {
            Ok((id, file)) => Ok(Self {
                name,
                file,
                id,
                options,
                metadata,
                complaint,
                is_damaged: false,
            }),
            Err(error) => Err(CliError::Input {
                name,
                error: InputError::Read(error),
            }),
        }
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Refuses to write to the recording, under any path: a recording cannot be made again.
    pub(crate) fn refuse_as_target(&self, target: &Path) -> Result<(), CliError> {
        match FileId::behind(target) {
            Ok(id) if id == self.id => Err(CliError::Frames {
                name: target.to_string_lossy().into_owned(),
                message: "is the recording being read; export to another file".to_owned(),
            }),
            _ => Ok(()),
        }
    }

    pub(crate) fn prefix_name(&mut self, flag: &str) {
        self.name.insert_str(0, flag);
    }

    pub(crate) fn complaint(&self) -> Option<&str> {
        self.complaint.as_deref()
    }

    pub(crate) fn read(
        &mut self,
        sink: &mut dyn FnMut(RecordingEvent<'_>) -> ControlFlow<()>,
    ) -> Result<RecordingFormat, RecordingError> {
        let metadata = self.metadata.as_ref();
        read(&mut self.file, self.options, &mut |event| match event {
            RecordingEvent::Channel(info) => {
                sink(RecordingEvent::Channel(&info.completed(metadata)))
            }
            event => sink(event),
        })
    }

    pub(crate) fn read_table(
        &mut self,
        sink: &mut dyn FnMut(RecordingEvent<'_>) -> ControlFlow<()>,
    ) -> Result<(), RecordingError> {
        self.file.seek(SeekFrom::Start(0))?;
        let mut bytes = Vec::new();
        Read::by_ref(&mut self.file)
            .take(LARGEST_TABLE)
            .read_to_end(&mut bytes)?;
        read_rows(&bytes, sink)
    }

    pub(crate) fn remember_damage(&mut self) {
        self.is_damaged = true;
    }

    /// Reads the frames of a channel from the beginning of the recording again, until `take` breaks or fails. The
    /// inner result has the error of `take`.
    pub(crate) fn frames_again<E>(
        &mut self,
        channel: usize,
        mut take: impl FnMut(&Frame) -> Result<ControlFlow<()>, E>,
    ) -> Result<Result<(), E>, CliError> {
        let mut taken = Ok(());
        let read = self.read(&mut |event| match event {
            RecordingEvent::Frame(frame) if frame.channel == channel => {
                take(frame).unwrap_or_else(|error| {
                    taken = Err(error);
                    ControlFlow::Break(())
                })
            }
            _ => ControlFlow::Continue(()),
        });
        match read {
            Err(error) if taken.is_ok() && !self.is_damaged => Err(self.damaged(error)),
            _ => Ok(taken),
        }
    }

    pub(crate) fn channel_names(&mut self, up_to: Option<&str>) -> (Vec<String>, bool) {
        let mut names = Vec::new();
        let read = self.read(&mut |event| {
            if let RecordingEvent::Channel(info) = event {
                names.push(info.shown_name().to_owned());
                if up_to == Some(info.shown_name()) {
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        });
        (names, read.is_ok())
    }

    pub(crate) fn format(&mut self) -> Option<RecordingFormat> {
        self.file.seek(SeekFrom::Start(0)).ok()?;
        format_of(&mut self.file, self.options).ok()
    }

    pub(crate) fn damaged(&self, error: RecordingError) -> CliError {
        CliError::Recording {
            name: self.name.clone(),
            error,
        }
    }

    pub(crate) fn refused(&self, message: &(impl ToString + ?Sized)) -> CliError {
        CliError::Frames {
            name: self.name.clone(),
            message: message.to_string(),
        }
    }
}

pub(crate) fn dead_cells(path: &Path) -> Result<Imprint, CliError> {
    let source = InputSource::of(path);
    let opened = source.open().map_err(InputError::Read);
    match opened.and_then(content::read_from) {
        Ok(content) => Ok(*content.imprint()),
        Err(error) => Err(CliError::Input {
            name: format!("--mask {}", source.name()),
            error,
        }),
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

trait ReadAgain: Read + Seek + Debug {}

impl<T: Read + Seek + Debug> ReadAgain for T {}

fn spooled(input: impl Read + 'static) -> io::Result<Box<dyn ReadAgain>> {
    Ok(Box::new(SpooledInput::new(input)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(
        text: &str,
        is_damaged: bool,
        fatal: f64,
    ) -> (Vec<f64>, Result<Result<(), f64>, String>) {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::fs::write(file.path(), text).expect("written");
        let mut recording =
            RecordingFile::open(file.path(), ReadOptions::default()).expect("a file");
        if is_damaged {
            recording.remember_damage();
        }
        let mut values = Vec::new();
        let read = recording.frames_again(0, |frame| {
            let value = frame.values()[0];
            values.push(value);
            if value == fatal {
                Err(value)
            } else {
                Ok(ControlFlow::Continue(()))
            }
        });
        (values, read.map_err(|error| error.to_string()))
    }

    #[test]
    fn only_unknown_damage_is_an_error_when_frames_are_read_again() {
        let damaged = "r0c0,r0c1\n1,2\n3,4\n5,x\n";
        let (values, read) = taken(damaged, false, 9.0);
        assert_eq!(values, [1.0, 3.0]);
        let error = read.expect_err("damaged");
        assert!(
            error.ends_with("line 4, column 2: found \"x\", expected a number"),
            "{error}"
        );
        assert_eq!(taken(damaged, true, 9.0), (vec![1.0, 3.0], Ok(Ok(()))));
    }

    #[test]
    fn frames_are_not_read_beyond_a_failure() {
        let two_channels = "{\"channel\":\"a\",\"frame\":[[1]]}\n{\"channel\":\"b\",\"frame\":[[2]]}\n\
                            {\"channel\":\"a\",\"frame\":[[3]]}\n{\"channel\":\"a\",\"frame\":[[4]]}\nx\n";
        assert_eq!(
            taken(two_channels, false, 3.0),
            (vec![1.0, 3.0], Ok(Err(3.0)))
        );
    }
}
