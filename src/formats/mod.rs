//! The forms in which imprints, poses and answers leave the program and come back.
//!
//! Every reader is strict and total: it takes any bytes, and answers with a value in range or with one error that
//! says what was found, where, and what was expected.

pub mod value;

pub mod answer;

mod quote;

pub mod record;

pub mod job;

pub mod name;

pub mod shape;

pub mod npy;

pub mod atlas;

pub mod archive;

mod latch;

pub mod sweep_file;
