//! The quantities that a user can set, each with a row in a table: key, label, unit, range, decimals, default.
//!
//! Forms, flags, JSON checks and error messages are made from [`PARAMETERS`]; no other place knows a range. Lengths are
//! in sides of a cell. The ranges of figures are the paper's (0.00–9.99 with two decimals, 10.0–16.0 with one, whole
//! degrees 0–359) for a sensor whose larger side is 16, and scale with that side (a convention of this project). So it
//! is a [`Sensor`](crate::sensor::Sensor) that says which values are allowed on it. Values with other decimals than a
//! form shows are accepted everywhere.

pub mod number;

mod table;

mod error;

pub use error::{ParameterError, UnknownName, named};
pub use table::{PARAMETERS, Parameter, ParameterRow, Range, Unit};
