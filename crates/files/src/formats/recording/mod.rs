//! Reads recordings of real tactile and pressure sensors: files of any length in, frames out, one after the other.
//!
//! The content of a file decides its format. Nothing is cut or padded: if the number of values does not fit the rows
//! and columns, that is an error, and if a file does not say how many there are, the caller must. If a file is
//! damaged, every whole frame before the damage is given, then the error with line and column. Memory does not grow
//! with the length of a recording.
//!
//! ```
//! use std::io::Cursor;
//! use std::ops::ControlFlow;
//! use taxel_files::formats::recording::{ReadOptions, RecordingEvent, read};
//! let file = b"time,r0c0,r0c1,r1c0,r1c1\n0.0,1,2,3,4\n0.1,5,6,7,8\n";
//! let mut sums = Vec::new();
//! let format = read(Cursor::new(file), &ReadOptions::default(), &mut |event| {
//!     if let RecordingEvent::Frame(frame) = event {
//!         sums.push((frame.time, frame.values().iter().sum::<f64>()));
//!     }
//!     ControlFlow::Continue(())
//! })?;
//! assert_eq!(format.name, "csv");
//! assert_eq!(sums, [(Some(0.0), 10.0), (Some(0.1), 26.0)]);
//! # Ok::<(), taxel_files::ReadError>(())
//! ```
//!
//! ```text
//! error            why a recording cannot be read, and where
//! event            what a reader reports: channels, frames, notes
//! metadata         the file beside a recording of taxel's own
//! channels         the channels of a recording, as they appear
//! answer           a frame as a line of JSON
//! size             numbers of rows and columns
//! text             lines, fields and numbers
//! time             the times of frames
//! table            numbers in rows and columns, with or without a header
//! json             JSON lines
//! numpy            NPY and NPZ
//! mcap             MCAP, whose records it reads by `records`
//! echo             ros2 topic echo
//! tekscan, xsensor, boards
//! format           which of these a file is
//! ```
//! Each format uses the modules above it; formats do not use each other.

mod error;

mod event;

mod metadata;

mod channels;

mod answer;

pub(super) mod size;

pub(super) mod text;

pub(super) mod time;

mod table;

pub(super) mod json;

mod numpy;

mod echo;

mod mcap;

mod records;

mod tekscan;

mod xsensor;

mod boards;

mod stream;

mod format;

pub use answer::FrameAnswer;
pub use channels::{ChannelChoice, no_channel};
pub use error::{unknown_format, unshaped};
pub use event::{
    ChannelInfo, Column, ReadOptions, RecordingEvent, RecordingNote, RecordingSink, TimeColumn,
};
pub use format::{FORMATS, Format, format_of, may_be_recording, read};
pub use metadata::{FrameMark, RecordingMetadata};
pub use stream::{StreamCounts, StreamReader};
pub use table::read_rows;
pub use time::TimeUnit;
