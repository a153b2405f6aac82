//! Long work, on threads of its own.
//!
//! ```text
//! workers    sweeps and exports; begins all other work, too
//! execution  work at once or on threads, how it is stopped, and how it reports
//! models     models for recognition: trained, read
//! ```

pub mod workers;

pub mod execution;

pub(super) mod models;
