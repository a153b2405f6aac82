//! The forms of Figure, Picture and the sensor.
//!
//! ```text
//! fields   text fields of parameters                       update   keys
//! state    a form, and the document that it makes          memory   the last values
//! view     impl Page for FormDialog
//! ```

pub mod fields;

pub mod state;

pub mod memory;

pub mod view;

pub mod update;
