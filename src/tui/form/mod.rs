//! The forms of Figure, Picture and the sensor.
//!
//! ```text
//! fields   text fields of parameters                       layout   which line a field has
//! state    a form, and the document that it makes          update   keys
//! view     impl Page for FormDialog                        memory   the last values
//! ```

pub mod fields;

pub mod state;

pub mod memory;

pub mod layout;

pub mod view;

pub mod update;
