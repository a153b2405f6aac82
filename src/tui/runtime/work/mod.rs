//! Long work, on threads of its own.
//!
//! ```text
//! workers    sweeps and exports; begins all other work, too
//! execution  work at once or on threads, and how it is stopped
//! progress   how workers report
//! threads    the threads that share long work
//! models     models for recognition: trained, read
//! poses      searches a model for an imprint
//! sizes      the limit of a set in several sizes
//! naming     the shapes that left the imprints of frames
//! ```

pub mod workers;

pub(super) mod execution;

pub mod progress;

pub(crate) mod threads;

pub(super) mod models;

pub(super) mod poses;

pub(super) mod sizes;

pub(super) mod naming;
