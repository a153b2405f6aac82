//! Long work, on threads of its own.

pub(crate) mod workers;

pub(crate) mod execution;

pub(crate) mod models;
