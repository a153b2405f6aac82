//! The shape library: a folder with one JSON file a shape, and the shapes that come with the program.
//!
//! **Nothing is lost.** A file is written beside its place, synced, renamed over it, and the folder synced: at every
//! moment, whatever fails, the old file or the new one is there whole. Deleting moves into a trash inside the folder.
//! Writers hold the folder's lock for the moment of writing, so that two programs see each other's work; what lies
//! half-written when nobody holds the lock was left by a program that died, and is swept away. Reading needs neither
//! a lock nor a folder that can be written to.
//!
//! ```text
//! FOLDER/washer.json                    a shape
//! FOLDER/.lock                          held while writing
//! FOLDER/.taxel-tmp                     being written
//! FOLDER/.trash/0000000007 washer.json  deleted
//! FOLDER/.journal/4711-0.json           unsaved work of a running program, or of one that died
//! FOLDER/.journal/4711-0.lock           held as long as that program runs
//! FOLDER/.journal/4711-0.tmp            being written
//! ```

#[cfg(feature = "library")]
pub mod error;

#[cfg(feature = "library")]
pub mod place;

#[cfg(feature = "library")]
mod file;

#[cfg(feature = "library")]
mod lock;

#[cfg(feature = "library")]
pub mod shipped;

#[cfg(feature = "library")]
pub mod store;

#[cfg(feature = "library")]
pub mod trash;

#[cfg(feature = "library")]
pub mod journal;

#[cfg(feature = "library")]
mod leftover;

#[cfg(feature = "sweep")]
mod latch;

#[cfg(feature = "sweep")]
pub mod unfinished;

#[cfg(feature = "sweep")]
pub mod sweep_file;
