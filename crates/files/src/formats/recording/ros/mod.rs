//! Reads what ROS records: MCAP files, and the text of `ros2 topic echo`.
//!
//! ```text
//! cdr       the encoding of messages
//! message   the messages that have frames
//! records   the records of an MCAP file
//! mcap      its topics and their frames
//! echo      messages as text
//! ```

/// The magic number of an MCAP file, at its start and at its end.
pub(super) const MCAP_MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

mod cdr;

mod message;

mod records;

pub(super) mod mcap;

pub(in crate::formats) mod echo;
