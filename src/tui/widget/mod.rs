//! The parts that views are made of.
//!
//! ```text
//! text_field   a line of text that is edited         theme       styles and characters
//! field_list   the fields of a form, one with focus  write       text into the buffer
//! field_rows   the rows of a form                    found       a text that was searched for, marked
//! number       numbers of columns, lines, taxels     thumbnail   a small imprint
//! rows         the selected row of a list            plot        two axes around a field of dots
//! columns      widths and word wrap                  dots        lines and points in Braille
//! heat         shades and colours of values
//! ```

pub mod text_field;

pub mod field_list;

pub mod field_rows;

pub mod number;

pub mod rows;

pub mod columns;

pub mod theme;

pub mod found;

pub mod heat;

pub mod dots;

pub mod plot;

pub mod write;

pub mod thumbnail;
