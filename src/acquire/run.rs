//! Reads a source of any kind.

use std::sync::atomic::AtomicBool;

use crate::acquire::event::{AcquireError, AcquireOptions};
use crate::acquire::source::FrameSource;
use crate::acquire::stream::Consumer;
use crate::acquire::{playback, stream};

/// Reads a source until it ends, `stop` is set, or the consumer breaks off. A file that is a recording is played back, and
/// followed if it grows meanwhile; any other file, or one for which the format of a stream is given, is read as it grows.
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
    match recording.map_err(AcquireError::opening)? {
        Some(path) => playback::run(path, options, stop, consumer),
        None => stream::run(source, options, stop, consumer),
    }
}
