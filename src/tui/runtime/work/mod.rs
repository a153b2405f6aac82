//! Long work, on threads of its own.

pub mod workers;

pub mod execution;

pub(super) mod models;
