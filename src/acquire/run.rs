//! Reads a source, whatever it is.

use std::fs::File;
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
    if let (FrameSource::File(path), None) = (source, options.format) {
        let format = File::open(path).and_then(recognised_input);
        let format = format.map_err(|error| AcquireError::Io {
            doing: "open it",
            error,
        })?;
        if format.is_some() {
            return playback::run(path, options, stop, consumer);
        }
    }
    stream::run(source, options, stop, consumer)
}
