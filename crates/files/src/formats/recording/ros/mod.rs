//! Reads what ROS records: MCAP files, and the text of `ros2 topic echo`.
//!
//! ```text
//! records   the records of an MCAP file
//! mcap      its topics and their frames
//! echo      messages as text
//! ```

pub(super) const MCAP_MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

mod records;

pub(super) mod mcap;

pub(crate) mod echo;
