//! The parts that views are made of.
//!
//! ```text
//! text_field   a line of text that is edited         theme       styles and characters
//! number       numbers of columns, lines, taxels     write       text into the buffer
//! curve        a curve with axes                  found       a text that was searched for, marked
//! rows         the selected row of a list
//! columns      widths and word wrap                  thumbnail   a small imprint
//! dots         lines and points in Braille           plot        two axes around a field of dots
//! heat         shades and colours of values
//! ```

pub mod text_field;

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
