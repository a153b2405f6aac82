//! The parts that views are made of.
//!
//! ```text
//! text_field   a line of text that is edited         theme       styles and characters
//! field_rows   the rows of a form                    write       text into the buffer
//! number       numbers of columns, lines, taxels     found       a text that was searched for, marked
//! rows         the selected row of a list            thumbnail   a small imprint
//! columns      widths and word wrap                  plot        two axes around a field of dots
//! curve        a curve with axes                     dots        lines and points in Braille
//! heat         shades and colours of values
//! ```

pub mod text_field;

pub mod field_rows;

pub mod number;

pub mod rows;

pub mod columns;

pub mod theme;

pub mod found;

pub mod heat;

pub mod dots;

pub mod curve;

pub mod plot;

pub mod write;

pub mod thumbnail;
