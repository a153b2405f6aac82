//! Reads tables of numbers, with or without a header.
//!
//! ```text
//! clock            the times of a table
//! cell_names       a header's names of cells
//! unnamed_fields   the fields beside the cells, without a header
//! header           the header, and whether the first line is one
//! layout           what each field is, from the lines above
//! delimited        the frames
//! ```

mod clock;

pub(super) mod cell_names;

mod unnamed_fields;

mod header;

pub(super) mod layout;

pub(super) mod delimited;
