//! Reads the times of frames, and finds the fields that hold them.
//!
//! ```text
//! unit         s, ms, µs and others
//! field_role   names such as `timestamp` or `t_ms`, in a header, an object or an archive
//! moment       timestamps such as 2024-05-01T12:00:00.125Z
//! exact        numbers, subtracted with all their digits
//! frame_clock  seconds since the first frame, from numbers and timestamps
//! ```

pub(super) mod unit;

pub(super) mod field_role;

pub(in crate::formats) mod moment;

pub(in crate::formats) mod exact;

pub(in crate::formats) mod frame_clock;
