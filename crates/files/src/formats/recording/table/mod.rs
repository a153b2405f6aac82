//! Reads tables of numbers, with or without a header.
//!
//! ```text
//! header           the header, and whether the first line is one
//! layout           the arrangement of any table, from its first lines
//! delimited        the frames
//! ```

pub(super) mod header;

pub(super) mod layout;

pub(super) mod delimited;
