//! The bytes of a `FlexiTac` board in a file: `AA 55`, then a byte per cell.
//!
//! The bytes are the same as from the board itself, so the decoder of streams reads them. The file does not give rows
//! and columns; if the caller does not either, the error says how many cells the first frame has. Torn frames are
//! dropped and counted in a note, as no checksum could show what is wrong with them.

use crate::formats::recording::error::unshaped;
use std::io::{ErrorKind, Read};

use crate::formats::recording::event::{
    ChannelInfo, ReadOptions, RecordingEvent, RecordingNote, Sink, Stop,
};
use crate::formats::stream::{
    FLEXITAC_MARKER, StreamDecoder, StreamEvent, StreamFormat, StreamOptions,
};

/// The most bytes read at a time.
const CHUNK: usize = 1 << 16;

pub(in crate::formats::recording) fn read(
    mut input: impl Read,
    options: &ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let Some(size) = options.size else {
        let mut start = Vec::new();
        input.by_ref().take(CHUNK as u64).read_to_end(&mut start)?;
        let marker = |at: &usize| start[*at..].starts_with(&FLEXITAC_MARKER);
        let next = (3..start.len()).find(marker).unwrap_or(start.len());
        let values = next.saturating_sub(2) as u64;
        return Err(unshaped(values, None).into());
    };
    let info = ChannelInfo {
        size: options.size,
        ..ChannelInfo::default()
    };
    sink.event(RecordingEvent::Channel(&info))?;
    let stream = StreamOptions::default()
        .with_format(StreamFormat::Flexitac)
        .with_size(size)
        .from_start();
    let mut decoder = StreamDecoder::new(stream);
    let mut ended = Ok(());
    let mut bytes = vec![0; CHUNK];
    while ended.is_ok() {
        // Read only the bytes that are there: a full read would wait for the end of a growing file.
        let length = match input.read(&mut bytes) {
            Ok(0) => break,
            // A followed file was replaced, or no more is wanted: the last frame may be whole.
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => break,
            Ok(length) => length,
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) => return Err(error.into()),
        };
        decoder.push(&bytes[..length], &mut |event| {
            pass_on(event, &mut ended, sink);
        });
    }
    decoder.finish(&mut |event| pass_on(event, &mut ended, sink));
    ended?;
    let frames = decoder.counts().dropped;
    if frames > 0 {
        sink.event(RecordingEvent::Note(&RecordingNote::Garbled { frames }))?;
    }
    Ok(())
}

/// Passes on a frame of the stream, unless the reading has ended already.
fn pass_on(event: StreamEvent<'_>, ended: &mut Result<(), Stop>, sink: &mut Sink<'_>) {
    if let (StreamEvent::Frame(frame), Ok(())) = (event, &*ended) {
        *ended = sink.event(RecordingEvent::Frame(frame));
    }
}
