//! All the imprints of a shape: a form of ranges, work under way, what was found, a file to write it to.
//!
//! Each is a dialog of the screen: plain state and what keys do to it. Nothing here starts a thread or draws.

pub mod ranges;

pub mod running;

pub mod results;

pub mod letters;

pub mod export;
