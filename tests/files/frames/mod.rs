//! Recordings of sensors: those of `../shared/reference`, if they are available, and small ones made up here.

mod checksums;
mod echoes;

mod playback;

mod reference;

mod samples;

mod streams;

mod tables;

mod vendors;

use std::io::Cursor;
use std::ops::ControlFlow;

use taxel_core::frame::{Frame, FrameSize};
use taxel_files::ReadError;
use taxel_files::formats::recording::{
    ChannelInfo, ReadOptions, RecordingEvent, RecordingNote, read,
};

/// Everything that was read from a recording.
#[derive(Debug, Default)]
pub(crate) struct Recorded {
    pub(crate) format: Option<&'static str>,
    pub(crate) channels: Vec<ChannelInfo>,
    pub(crate) frames: Vec<Frame>,
    pub(crate) notes: Vec<RecordingNote>,
    pub(crate) error: Option<ReadError>,
}

/// Returns the size of a frame, with rows first, as recordings state it.
pub(crate) fn frame_size(rows: u16, columns: u16) -> FrameSize {
    FrameSize::new(columns, rows).expect("1 to 512")
}

/// Returns the rows and columns of a channel's frames.
pub(crate) fn channel_shape(info: &ChannelInfo) -> Option<(u16, u16)> {
    info.size.map(|size| (size.rows(), size.columns()))
}

/// Reads a whole recording, or the part of a damaged one before the damage.
pub(crate) fn recorded(bytes: &[u8], shape: Option<(u16, u16)>) -> Recorded {
    let size = shape.map(|(rows, columns)| frame_size(rows, columns));
    let options = ReadOptions {
        size,
        ..ReadOptions::default()
    };
    recorded_with(bytes, &options)
}

/// Reads a recording with these options. Notes that only say how it is read are left out.
pub(crate) fn recorded_with(bytes: &[u8], options: &ReadOptions) -> Recorded {
    let mut found = Recorded::default();
    let read = read(Cursor::new(bytes), options, &mut |event| {
        match event {
            RecordingEvent::Channel(info) => found.channels.push(info.clone()),
            RecordingEvent::Frame(frame) => found.frames.push(frame.clone()),
            RecordingEvent::Note(note) if !note.is_plain() => found.notes.push(note.clone()),
            _ => {}
        }
        ControlFlow::Continue(())
    });
    match read {
        Ok(format) => found.format = Some(format.name),
        Err(error) => found.error = Some(error),
    }
    found
}

#[test]
fn a_caller_decides_whether_a_wrong_frame_is_left_out() {
    for text in [
        "{\"frame\":[[1,2]]}\n{\"frame\":[[3\n{\"frame\":[[5,6]]}\n",
        "r0c0,r0c1\n1,2\n3,x\n5,6\n",
    ] {
        let read_with = |options: &ReadOptions, flow: ControlFlow<()>| {
            let (mut firsts, mut damage) = (Vec::new(), Vec::new());
            let read = read(Cursor::new(text), options, &mut |event| match event {
                RecordingEvent::Frame(frame) => {
                    firsts.push(frame.values()[0]);
                    ControlFlow::Continue(())
                }
                RecordingEvent::Damage { error, .. } => {
                    damage.push(error.to_string());
                    flow
                }
                _ => ControlFlow::Continue(()),
            });
            (firsts, damage, read.err().map(|error| error.to_string()))
        };
        let (go_on, stop) = (ControlFlow::Continue(()), ControlFlow::Break(()));
        let leaving_out = ReadOptions {
            leaves_out: true,
            ..ReadOptions::default()
        };
        let (firsts, damage, error) = read_with(&ReadOptions::default(), go_on);
        assert_eq!((&firsts[..], damage.len()), (&[1.0][..], 0), "{text}");
        let error = error.expect("the second frame is wrong");
        let expected = (vec![1.0, 5.0], vec![error.clone()], None);
        assert_eq!(read_with(&leaving_out, go_on), expected);
        let expected = (vec![1.0], vec![error.clone()], Some(error));
        assert_eq!(read_with(&leaving_out, stop), expected);
    }
}

#[test]
fn times_count_from_the_first_frame_even_if_a_wrong_one_before_it_is_left_out() {
    let text = "00:00:01 -> 5 6\n\n00:00:02 -> 1 2\n00:00:02 -> 3 4\n\n00:00:03.5 -> 1 2\n00:00:03.5 -> 3 4\n";
    let options = ReadOptions {
        size: Some(frame_size(2, 2)),
        leaves_out: true,
        ..ReadOptions::default()
    };
    let mut times = Vec::new();
    let read = read(Cursor::new(text), &options, &mut |event| {
        if let RecordingEvent::Frame(frame) = event {
            times.push(frame.time);
        }
        ControlFlow::Continue(())
    });
    assert!(read.is_ok(), "{read:?}");
    assert_eq!(times, [0.0, 1.5].map(Some));
}
