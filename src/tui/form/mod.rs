//! The forms of Figure, Picture and the sensor.
//!
//! ```text
//! state    a form, and the document that it makes          memory   the last values
//! view     impl Page for FormDialog
//! ```

pub mod state;

pub mod view;
