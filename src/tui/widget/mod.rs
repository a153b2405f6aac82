//! The parts that views are made of.
//!
//! ```text
//! text_field   a line of text that is edited         theme       styles and characters
//! field_list   the fields of a form, one with focus  write       text into the buffer
//! rows         the selected row of a list            dots        lines of dots finer than characters
//! ```

pub mod text_field;

pub mod field_list;

pub mod rows;

pub mod theme;

pub mod dots;

pub mod write;

pub use dots::*;
pub(in crate::tui) use field_list::*;

pub use rows::*;
pub use text_field::TextField;
pub use theme::*;
