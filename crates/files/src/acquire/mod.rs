//! Acquires frames: from a serial line, a pipe, a network connection, a growing file, or a recording played back.
//!
//! [`acquire`] reads a source until it ends or is stopped, and reports frames and problems, one after the other, on the
//! thread that calls it. A consumer that must see every frame, such as a [`FrameRecorder`], runs on that thread. A
//! screen takes the frames that have arrived whenever it draws; nothing waits for the screen.
//!
//! ```text
//! serial, tcp, FIFO, standard input, file -> StreamDecoder \
//! recording -> formats::recording, at its own rate          -> AcquireEvent -> FrameRecorder (every frame)
//! ```

mod byte_input;
mod clocks;
mod event;
mod followed_file;
mod playback;
mod recorder;
mod source;
mod stream;

use std::sync::atomic::AtomicBool;

pub use clocks::FrameRate;
pub use event::{AcquireError, AcquireEvent, AcquireOptions, AcquireSink, Playback};
pub use followed_file::ReadAnew;
pub use recorder::{FrameRecorder, MetadataFileError, RecorderError, metadata_beside};
pub use source::{FrameSource, SourceName};

/// Reads a source until it ends, `stop` is set, or the consumer breaks off. A recording is played back, and followed if
/// it grows meanwhile. Any other file is read while it grows; if the format of a stream is given, reading always waits
/// for more.
///
/// If a connection or a serial line is lost, as when the other end closes it, opening it is tried again each second
/// until it is back ([`AcquireEvent::Lost`]), regardless of
/// [`AcquireOptions::waits`]. With [`Playback::Once`], reading ends there. Standard
/// input and a FIFO end when they are closed, and a recording that does not grow ends with its last frame.
///
/// ```
/// use std::ops::ControlFlow;
/// use std::sync::atomic::AtomicBool;
///
/// use taxel_files::acquire::{AcquireEvent, AcquireOptions, FrameSource, Playback, acquire};
/// use taxel_core::frame::{Processing, Rule};
///
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("touch.jsonl");
/// # std::fs::write(&path, "{\"t\":0,\"frame\":[[0,9],[0,8]]}\n{\"t\":0.01,\"frame\":[[0,9],[7,8]]}\n")?;
/// // Or "/dev/ttyUSB0", "tcp://192.168.1.4:5000", a FIFO, or a file that grows.
/// let source = FrameSource::new(path.as_os_str());
/// // As fast as possible, then stop; without this a recording is played at its own rate.
/// let options = AcquireOptions {
///     playback: Playback::Once,
///     ..AcquireOptions::default()
/// };
/// let mut processing = Processing::default();
/// processing.rule = Some(Rule::at_least(5.0)?);
/// let mut imprints = Vec::new();
/// let stop = AtomicBool::new(false);
/// acquire(&source, &options, &stop, &mut |event| {
///     if let AcquireEvent::Frame { frame, .. } = event {
///         // A frame of another size than the mask or the tare is an error; this one has neither.
///         imprints.extend(processing.run(frame).ok().and_then(|processed| processed.imprint));
///     }
///     // `Break` ends it from here, `stop` from another thread.
///     ControlFlow::Continue(())
/// })?;
/// assert_eq!(imprints.len(), 2);
/// assert_eq!(imprints[1].to_string(), ".#\n##");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the source cannot be opened at first, cannot be read on and does not come back, is a damaged
/// recording, or turns out to be a recording that cannot be a stream, such as NPY: on standard input or a FIFO, or in a
/// file that was no recording yet when it was opened.
pub fn acquire(
    source: &FrameSource,
    options: &AcquireOptions,
    stop: &AtomicBool,
    consumer: &mut AcquireSink<'_>,
) -> Result<(), AcquireError> {
    let recording = source.open_recording(options);
    match recording.map_err(|error| source.not_opened(error))? {
        Some(recording) => playback::run(recording, options, stop, consumer),
        None => stream::run(source, options, stop, consumer),
    }
}
