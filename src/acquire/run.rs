//! Reads a source, whatever it is.

use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::acquire::event::{AcquireError, AcquireOptions};
use crate::acquire::source::FrameSource;
use crate::acquire::stream::Consumer;
use crate::acquire::{playback, stream};
use crate::formats::recording::recognised_input;

/// Reads a source until it ends, `stop` is set, or the consumer breaks off. A file that is a recording is played back,
/// unless the form of a stream is given; any other file is read as it grows.
///
/// # Errors
/// If the source cannot be opened at first, cannot be read on and does not come back, or is a damaged recording.
pub fn acquire(
    source: &FrameSource,
    options: &AcquireOptions,
    stop: &AtomicBool,
    consumer: &mut Consumer<'_>,
) -> Result<(), AcquireError> {
    let recording = source.recording(options);
    let recording = recording.map_err(|error| AcquireError::Io {
        doing: "open it",
        error,
    })?;
    match recording {
        Some(path) => playback::run(path, options, stop, consumer),
        None => stream::run(source, options, stop, consumer),
    }
}

impl FrameSource {
    /// Returns the file if it is played as a recording: of a known form, and no form of a stream was asked for.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn recording(&self, options: &AcquireOptions) -> io::Result<Option<&Path>> {
        let (Self::File(path), None) = (self, options.format) else {
            return Ok(None);
        };
        let format = File::open(path).and_then(recognised_input)?;
        Ok(format.map(|_| path.as_path()))
    }
}
