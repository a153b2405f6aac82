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
//! use taxel::formats::recording::{ReadOptions, RecordingEvent, RecordingFormat, read};
//! let file = b"time,r0c0,r0c1,r1c0,r1c1\n0.0,1,2,3,4\n0.1,5,6,7,8\n";
//! let mut sums = Vec::new();
//! let format = read(Cursor::new(file), ReadOptions::default(), &mut |event| {
//!     if let RecordingEvent::Frame(frame) = event {
//!         sums.push((frame.time, frame.values().iter().sum::<f64>()));
//!     }
//!     ControlFlow::Continue(())
//! })?;
//! assert_eq!(format, RecordingFormat::Csv);
//! assert_eq!(sums, [(Some(0.0), 10.0), (Some(0.1), 26.0)]);
//! # Ok::<(), taxel::formats::recording::RecordingError>(())
//! ```

mod error;

mod event;

mod channel_choice;

pub(crate) mod number;

mod lines;

pub(crate) mod moment;

pub(crate) mod side;

pub(crate) mod text_row;

mod tekscan;

mod xsensor;

mod emed;

mod zebris;

pub(crate) mod separator;

mod frame_time;

mod cell_names;

mod unnamed_fields;

mod header_line;

mod table_layout;

mod delimited;

mod numpy;

#[cfg(feature = "mcap")]
mod cdr;

#[cfg(feature = "mcap")]
mod ros_message;

#[cfg(feature = "mcap")]
mod mcap;

mod npz;

pub(crate) mod json_time;

pub(crate) mod json_lines;

mod popu;

pub(crate) mod ros_text;

mod flexitac;

mod detect;

mod answer;

mod description;

pub use answer::FrameAnswer;
pub use channel_choice::ChannelChoice;
#[cfg(feature = "cli")]
pub(crate) use delimited::read_rows;
pub use description::{FrameMark, MetadataError, RecordedView, RecordingMetadata};
#[cfg(feature = "tui")]
pub(crate) use detect::may_be_recording;
#[cfg(all(feature = "acquire", unix))]
pub(crate) use detect::{RecordingInput, format_of, read_as};
pub use detect::{read, recognised, recognised_input};
pub use error::RecordingError;
#[cfg(feature = "cli")]
pub(crate) use event::UNNAMED;
pub use event::{ChannelInfo, ReadOptions, RecordingEvent, RecordingFormat, RecordingNote};
