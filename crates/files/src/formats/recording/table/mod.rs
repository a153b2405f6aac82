//! Reads tables of numbers, with or without a header.
//!
//! ```text
//! clock            the times of a table
//! cell_names       a header's names of cells
//! header           the header, and whether the first line is one
//! arrangement      what each line and each field is
//! unnamed          the arrangement of a table without a header
//! layout           the arrangement of any table, from its first lines
//! delimited        the frames
//! ```

mod clock;

pub(super) mod cell_names;

mod header;

pub(super) mod arrangement;

mod unnamed;

pub(super) mod layout;

pub(super) mod delimited;
