//! Acquires frames: from a serial line, a pipe, a network connection, a growing file, or a recording played back.
//!
//! [`acquire`] reads a source until it ends or is stopped, and reports frames and problems, one after the other, on the
//! thread that calls it. A consumer that must see every frame, such as a [`FrameRecorder`], runs on that thread. A
//! screen takes the frames that have arrived whenever it draws; nothing waits for the screen.
//!
//! ```text
//! source: serial, tcp, FIFO, standard input, growing file -> an input that waits -> StreamReader \
//!         a recording that is complete                                     -> recording::read     -> Session -> AcquireEvent
//! ```
//! The session gives each frame its time, waits until a frame of a recording is due, counts, ticks and notices silences.

mod clock;
mod event;
mod input;
mod rate;
mod recorder;
mod session;
mod source;
mod unix;

use std::cell::{Cell, RefCell};
use std::fs::File;
use std::io::{self, ErrorKind, Seek};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use crate::formats::recording::{
    Format, ReadOptions, RecordingNote, StreamReader, format_of, read,
};
use crate::{ReadError, ReadErrorKind};
use clock::TICK;
use input::{InputEnd, OpenSource, WaitingInput};
use session::Session;

pub use event::{AcquireEvent, AcquireOptions, AcquireSink, Playback};
pub use rate::FrameRate;
pub use recorder::{FrameRecorder, RecorderError, metadata_beside};
pub use source::FrameSource;

/// The pause before opening a source is tried again.
const RETRY: Duration = Duration::from_secs(1);

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
/// let source = FrameSource::new(&path);
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
/// If the source cannot be opened at first, cannot be read on and does not come back (both with the kind
/// [`ReadErrorKind::Io`]), is a damaged recording, has no known format, or does not say how its values are arranged.
pub fn acquire(
    source: &FrameSource,
    options: &AcquireOptions,
    stop: &AtomicBool,
    consumer: &mut AcquireSink<'_>,
) -> Result<(), ReadError> {
    // A reader whose input was ended because no more is wanted may still have a frame.
    let is_done = Cell::new(false);
    let mut consumer = |event: AcquireEvent<'_>| {
        if is_done.get() || consumer(event).is_break() {
            is_done.set(true);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    let mut session = Session::new(source, options, stop, &is_done, &mut consumer);
    let recording = source.open_recording(options)?;
    if let Some((path, file, format)) = &recording {
        let metadata = metadata_beside(path).unwrap_or_else(|error| {
            let note = RecordingNote::Oddity(error.to_string());
            let _ = session.report(AcquireEvent::Note(&note));
            None
        });
        session.play(metadata);
        if options.playback != Playback::Live || format.stream.is_none() {
            return play(&mut session, file, format);
        }
    }
    let mut reading = ReadOptions {
        leaves_out: true,
        is_joined: source.comes_back(),
        ..options.of_recording()
    };
    if recording.is_none() {
        reading.size = options.size.or(options.stream_size);
        reading.format = options.format.or(options.stream_format);
    }
    let opened = recording.map(|(_, file, _)| OpenSource::file(file));
    stream(source, opened, &reading, &RefCell::new(session))
}

/// Errors of a file that may be a stream, or become a recording.
const UNDECIDED: [ReadErrorKind; 2] = [ReadErrorKind::UnknownFormat, ReadErrorKind::Unsized];

impl FrameSource {
    /// Whether it is played as a recording: a file that has a known format, unless `options` names a format of streams.
    ///
    /// # Errors
    /// If the file cannot be read, or is of another kind, such as an image.
    pub fn is_recording(&self, options: &AcquireOptions) -> Result<bool, ReadError> {
        self.open_recording(options)
            .map(|recording| recording.is_some())
    }

    /// The file in which the format was found, too: another one may have its name by now.
    fn open_recording(
        &self,
        options: &AcquireOptions,
    ) -> Result<Option<(&Path, File, &'static Format)>, ReadError> {
        let (Self::File(path), None) = (self, options.format) else {
            return Ok(None);
        };
        let mut file = File::open(path).map_err(|error| self.not_opened(&error))?;
        let found = format_of(&file, &options.of_recording());
        file.rewind()?;
        match found {
            Ok(format) => Ok(Some((path, file, format))),
            // It may become one.
            Err(error) if UNDECIDED.contains(&error.kind) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

/// Plays a recording that does not grow, once or again and again.
fn play(
    session: &mut Session<'_, '_>,
    file: &File,
    format: &'static Format,
) -> Result<(), ReadError> {
    let options = ReadOptions {
        format: Some(format),
        ..session.options.of_recording()
    };
    loop {
        read(file, &options, &mut |event| session.take(event))?;
        session.check()?;
        if session.is_stopped() || !session.begins_again() {
            return Ok(());
        }
    }
}

/// Reads a stream of bytes until it ends. What is lost is opened again.
fn stream(
    source: &FrameSource,
    opened: Option<OpenSource>,
    options: &ReadOptions,
    session: &RefCell<Session<'_, '_>>,
) -> Result<(), ReadError> {
    let comes_back = source.comes_back() && session.borrow().options.playback != Playback::Once;
    // The format of a recording was found already.
    let mut reader = match &opened {
        Some(_) => StreamReader::of_recording(options),
        None => StreamReader::new(options),
    };
    let mut next = match opened {
        Some(opened) => Some(opened),
        None => first_input(source, &mut session.borrow_mut())?,
    };
    if let Some(OpenSource::File { file, .. }) = &next
        && session.borrow().options.playback != Playback::Once
    {
        let followed = session.borrow_mut().follow(file);
        followed.map_err(|error| source.not_opened(&error))?;
    }
    session.borrow_mut().begin();
    while let Some(opened) = next {
        let mut input = WaitingInput::new(opened, session);
        let result = reader.read(&mut input, &mut |event| session.borrow_mut().take(event));
        let end = input.into_inner().end;
        let mut session = session.borrow_mut();
        session.check()?;
        if session.is_stopped() {
            return Ok(());
        }
        let lost = match end {
            Some(InputEnd::Closed) if comes_back => {
                io::Error::new(ErrorKind::UnexpectedEof, "the other end has closed it")
            }
            Some(InputEnd::Lost(error)) if comes_back => error,
            Some(InputEnd::Lost(error)) => return Err(error.into()),
            _ => {
                result?;
                session.report_end();
                return Ok(());
            }
        };
        result?;
        next = back(source, &mut session, AcquireEvent::Lost(&lost))?;
        session.begin();
    }
    Ok(())
}

/// Opens the source; if it does not exist yet, waits for it if the options say so. None if no more is wanted.
fn first_input(
    source: &FrameSource,
    session: &mut Session<'_, '_>,
) -> Result<Option<OpenSource>, ReadError> {
    match OpenSource::open(source, session) {
        Err(error) if session.options.waits && source.comes_back() && !is_invalid(&error) => {
            back(source, session, AcquireEvent::Absent(&error))
        }
        opened => opened.map_err(|error| source.not_opened(&error)),
    }
}

/// Reports why it waits for the source, opens it, and reports how long that took. None if no more is wanted.
fn back(
    source: &FrameSource,
    session: &mut Session<'_, '_>,
    event: AcquireEvent<'_>,
) -> Result<Option<OpenSource>, ReadError> {
    let since = Instant::now();
    if session.report(event).is_break() {
        return Ok(None);
    }
    let opened = reopened(source, session, RETRY)?;
    let gap = since.elapsed();
    let back = session.report(AcquireEvent::Back { gap });
    Ok(opened.filter(|_| back.is_continue()))
}

/// Opens the source as soon as it is there, trying again after this pause. None if no more is wanted.
fn reopened(
    source: &FrameSource,
    session: &mut Session<'_, '_>,
    pause: Duration,
) -> Result<Option<OpenSource>, ReadError> {
    loop {
        let next = Instant::now() + pause;
        while Instant::now() < next {
            if session.beat().is_break() {
                return Ok(None);
            }
            std::thread::sleep(TICK);
        }
        match OpenSource::open(source, session) {
            Err(error) if is_invalid(&error) => return Err(source.not_opened(&error)),
            Err(_) => {}
            Ok(opened) => return Ok(opened),
        }
    }
}

/// Whether the source is not one that can be opened. Waiting does not make it valid.
fn is_invalid(error: &io::Error) -> bool {
    error.kind() == ErrorKind::InvalidInput
}

#[cfg(test)]
mod tests;
