//! The forms in which imprints, poses and answers leave the program and come back.
//!
//! Every reader is strict and total: it takes any bytes, and answers with a value in range or with one error that
//! says what was found, where, and what was expected.

pub mod value;

pub mod answer;

mod quote;

pub mod record;

#[cfg(feature = "json")]
pub mod job;

pub mod name;

#[cfg(feature = "json")]
pub mod shape;

pub mod npy;

#[cfg(feature = "sweep")]
pub mod atlas;

#[cfg(feature = "sweep")]
pub mod archive;

mod latch;

pub mod sweep_file;
