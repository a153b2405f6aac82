//! The bytes of a `FlexiTac` board in a file: `AA 55`, then a byte a cell.
//!
//! The same bytes as from the board itself, so the decoder of streams reads them. The file names no rows and columns;
//! if they are not known, the error says how many cells the first frame has. Frames that are torn are dropped and
//! counted in a note, as there is no checksum that would tell what is wrong with them.

use std::cell::Cell;
use std::io::{ErrorKind, Read};
use std::ops::ControlFlow;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{
    ChannelInfo, ReadOptions, RecordingEvent, RecordingNote, Sink,
};
use crate::formats::stream::{StreamDecoder, StreamEvent, StreamFormat, StreamOptions};

/// Bytes read at a time, at most.
const CHUNK: usize = 1 << 16;

/// Reads a recording.
///
/// # Errors
/// [`RecordingError::Shape`] if rows and columns are not named.
pub(super) fn read(
    input: &mut impl Read,
    options: ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), RecordingError> {
    let mut bytes = vec![0; CHUNK];
    let Some((rows, columns)) = options.shape else {
        let length = super::numpy::fill(input, &mut bytes)?;
        let marker = |at: &usize| bytes[..length].get(*at..at + 2) == Some(&[0xaa, 0x55]);
        let next = (3..length).find(marker).unwrap_or(length);
        let values = next.saturating_sub(2) as u64;
        return Err(RecordingError::Shape { values });
    };
    let info = ChannelInfo {
        shape: options.shape,
        ..ChannelInfo::default()
    };
    if sink(RecordingEvent::Channel(&info)).is_break() {
        return Ok(());
    }
    let stream = StreamOptions::default()
        .with_format(StreamFormat::Flexitac)
        .with_shape(rows, columns)
        .from_start();
    let mut decoder = StreamDecoder::new(stream);
    let state = Cell::new(ControlFlow::Continue(()));
    let mut give = |event: StreamEvent<'_>| {
        if let (StreamEvent::Frame(frame), ControlFlow::Continue(())) = (event, state.get()) {
            state.set(sink(RecordingEvent::Frame(frame)));
        }
    };
    while state.get().is_continue() {
        // What is there, at once: the end of a file that grows is waited for.
        let length = match input.read(&mut bytes) {
            Ok(0) => break,
            Ok(length) => length,
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) => return Err(error.into()),
        };
        decoder.push(&bytes[..length], &mut give);
    }
    decoder.finish(&mut give);
    let frames = decoder.counts().dropped;
    if state.get().is_continue() && frames > 0 {
        let _ = sink(RecordingEvent::Note(&RecordingNote::Garbled { frames }));
    }
    Ok(())
}
