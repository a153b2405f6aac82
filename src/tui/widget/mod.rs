//! The parts that views are made of.
//!
//! ```text
//! text_field   a line of text that is edited         theme       styles and characters
//! field_list   the fields of a form, one with focus  write       text into the buffer
//! rows         the selected row of a list            plot        two axes around a field of dots
//! ```

pub mod text_field;

pub mod field_list;

pub mod rows;

pub mod theme;

pub mod plot;

pub mod write;

pub(in crate::tui) use field_list::*;
pub use plot::*;
pub use rows::*;
pub use text_field::TextField;
pub use theme::*;
