//! Recordings of sensors and streams of frames.

use std::io::{BufRead, BufReader, Cursor, Read};
use std::ops::ControlFlow;

use taxel_core::frame::{FrameSize, Processing, Rule};
use taxel_files::formats::recording::{
    ReadOptions, RecordingEvent, RecordingMetadata, StreamCounts, StreamReader, read,
};

use super::{is_short, refused};

/// Reads a recording in any format: without and with rows and columns that may fit, and with wrong frames left out.
pub(crate) fn recording(bytes: &[u8]) -> bool {
    let size = FrameSize::new(5, 4).expect("1 to 512");
    let with_size = ReadOptions {
        size: Some(size),
        ..ReadOptions::default()
    };
    let mut is_read = false;
    for options in [
        ReadOptions::default(),
        with_size.clone(),
        ReadOptions {
            leaves_out: true,
            ..with_size
        },
    ] {
        let mut processing = Processing::default();
        processing.rule = Rule::percent(50.0).ok();
        let mut channels = 0;
        let read = read(Cursor::new(bytes), &options, &mut |event| {
            match event {
                RecordingEvent::Channel(_) => channels += 1,
                RecordingEvent::Frame(frame) => {
                    assert!(
                        frame.channel < channels,
                        "a channel is reported before its frames"
                    );
                    assert!(frame.values().iter().all(|value| !value.is_infinite()));
                    if let Ok(processed) = processing.run(frame) {
                        assert!(processed.sum.is_finite());
                    }
                }
                RecordingEvent::Note(note) => is_short(&note.to_string()),
                RecordingEvent::Damage { .. } => {}
            }
            ControlFlow::Continue(())
        });
        is_read |= read.map_or_else(|error| refused(&error.to_string()), |_| true);
    }
    is_read
}

/// Reads the metadata of a recording from the file beside it. It must be the same when it is written and read again.
pub(crate) fn metadata(bytes: &[u8]) -> bool {
    match RecordingMetadata::read(bytes) {
        Some(Ok(metadata)) => {
            let text = metadata.text();
            let again = RecordingMetadata::read(&text).expect("it is one");
            let again = again.expect("it is a right one").text();
            assert_eq!(again, text);
            true
        }
        Some(Err(error)) => refused(&error.to_string()),
        None => false,
    }
}

/// Reads a stream in any format; the first byte says what is known about it. It must be decoded alike in pieces and as
/// a whole.
pub(crate) fn stream(bytes: &[u8]) -> bool {
    let Some((&first, bytes)) = bytes.split_first() else {
        return false;
    };
    let options = ReadOptions {
        is_joined: first & 1 != 0,
        size: FrameSize::new(5, 4).ok().filter(|_| first & 2 != 0),
        ..ReadOptions::default()
    };
    let decoded = |mut pieces: &mut dyn BufRead| {
        let mut frames = Vec::new();
        let mut counts = StreamCounts::default();
        let mut reader = StreamReader::new(&options);
        let read = reader.read(&mut pieces, &mut |event| {
            counts.note(&event);
            if let RecordingEvent::Frame(frame) = event {
                let values = frame.values().iter().map(|value| value.to_bits());
                frames.push(values.collect::<Vec<_>>());
            }
            ControlFlow::Continue(())
        });
        assert_eq!(counts.frames, frames.len() as u64);
        (
            frames,
            counts.dropped,
            read.err().map(|error| error.to_string()),
        )
    };
    let whole = decoded(&mut &bytes[..]);
    let start = bytes.len().min(usize::from(first) * 8);
    let (start, rest) = bytes.split_at(start);
    let mut pieces = start.chain(BufReader::with_capacity(7, rest));
    assert!(decoded(&mut pieces) == whole, "decoded in pieces");
    !whole.0.is_empty()
}
