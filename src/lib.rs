//! Which shapes can a robot recognise by touching them once?
//!
//! A tactile matrix sensor touches a flat shape, and a taxel is active when the shape covers at least half of its cell.
//! This crate computes that binary imprint exactly, for any position, rotation and size; describes it by the geometric
//! parameters of D. Purcaru and E. Niculescu, *Experimental Results in Shape Description*; and keeps shapes in a
//! library of files. The program of the same name puts a screen and a command line on top of it.
//!
//! ```
//! use taxel::prelude::*;
//!
//! // The paper's Fig. 1: an ellipse with radii of 4 and a wall of 2.
//! let sensor = Sensor::default();
//! let figure = Figure::ellipse(4.0, 4.0).at(1.99, 1.47).thickness(2.0).on(&sensor)?;
//! let imprint = Plane::new(sensor).touch(&figure);
//! assert_eq!(imprint.count(), 36);
//!
//! let regions = regions(&imprint);
//! let main = main_region(&regions).expect("something is active");
//! let ring = Description::of(&regions[main]);
//! assert_eq!((ring.na, ring.nae, ring.ce), (36, 48, 22));
//! assert_eq!(ring.cg(), ring.cd());
//! # Ok::<(), ParameterError>(())
//! ```
//!
//! # Frame and units
//!
//! There is one coordinate frame for everything, and its unit is the side of a sensory cell:
//! ```text
//!   0   1   2   3 → x        The taxel in column i, row j (both from 0) covers
//! 0 +---+---+---+            [i, i+1] × [j, j+1]; its coordinates are those of its
//!   |0,0|1,0|2,0|            centre, (i + ½, j + ½). Directions are degrees
//! 1 +---+---+---+            counter-clockwise from +x as seen, in (−180, 180].
//!   |0,1|1,1|2,1|            Figures turn clockwise as seen, pictures
//! 2 +---+---+---+            counter-clockwise. With a pitch, lengths and areas
//! ↓ y                        are given in mm and mm² too.
//! ```
//!
//! # Map
//!
//! The rooms (top-level modules) in reading order. Each uses only rooms above it, and inside a room there are no
//! cycles. A test reads the `use` lines and enforces this.
//! ```text
//!  quote        untrusted text, cut short for messages, and names that are nearly right
//!  index        whole numbers as indices, checked
//!  geometry     the area of polygons and ellipses in each cell of a grid           plane, f64
//!  parameter    what can be set: one table of keys, units, ranges, defaults
//!  sensor       columns, rows, threshold, pitch
//!  imprint      the matrix: a u64 a row
//!  matrix       a value a taxel
//!  figure  picture  source        what touches: seven figures, a stored imprint
//!  touch        shape + sensor -> coverage of each taxel -> imprint
//!  description  imprint -> regions -> DESCRIPTORS
//!  frame        what a real sensor measures: crop, tare, gain, threshold -> imprint
//!  pose         exact ranges, the grid of poses and the index of each
//!  atlas        the distinct imprints of a grid, counted; statistics
//!  sweep        every pose of a grid at once -> its atlas
//!  recognition  models of shapes: the posterior of a touch, the limit of any method
//!  prelude      what a program that uses the crate imports
//!  ───────────  above: no input or output, no panic except on an index that the caller made up; below: the world
//!  formats      text, PBM, CSV, NPY, JSON, atlases, models; recordings and streams of
//!               sensors; drawings as SVG and PNG
//!  storage      files: atomic writes, the folder of stored shapes, journal, trash
//!  acquire      where frames come from: serial, pipes, tcp, files; recording them
//!  memory       a bound on the memory of sweeps and trainings
//!  tui          the screen                                                         ratatui, crossterm
//!  cli          the command line over all of it                                    clap
//! ```
//! Only `storage`, `acquire`, `memory`, `cli`, `tui::runtime`, `tui::terminal` and `main` open files and streams;
//! `formats` reads and writes those that it is given.
//!
//! What happens to a pose:
//! ```text
//! form, flag or JSON line -> parameter (range) -> figure or picture -> outlines, placed
//!   -> coverage -> imprint -> regions -> descriptors -> panel, table, JSON, drawing, sweep
//! ```
//! What happens to a frame:
//! ```text
//! file -> formats::recording, or acquire -> bytes -> formats::stream
//!   -> frame (crop, tare, gain, threshold) -> imprint -> regions -> descriptors, recognition
//! ```
//!
//! # Features
//!
//! ```text
//!                     brings                                           on top of
//! (none)              all but what stands below; glam, libm and serde only
//! json                formats::StoredShape, Job
//! sweep               pose, atlas, sweep; formats::atlas, archive;     json
//!                     storage::AtlasFile, PoseFile, UnfinishedFile
//! recognition         recognition; formats::model                      sweep
//! frames              formats::recording, stream                       json
//! mcap (by default)   MCAP files in formats::recording                 frames
//! png                 formats::Drawing::png
//! library             storage                                          json
//! acquire             acquire, on Unix-like systems                    frames, library
//! tui                 tui                                              library, recognition, acquire, png
//! cli (by default)    cli, and the program                             tui
//! ```
//!
//! A controller that only needs touches and descriptors uses `default-features = false`.
//!
//! # Stability
//!
//! The rooms from `geometry` to `acquire` follow semantic versioning; types that are likely to grow are non-exhaustive.
//! `tui` and `cli` are the program: their items are public only for tests and scripts, and change with the program.
//!
//! # Invariants
//!
//! - A taxel is active if its coverage in real arithmetic is exactly the threshold, or falls short of it by less than
//!   1e-20 ([`touch`]).
//! - Every [`figure::Figure`], [`picture::Picture`] and [`sensor::Sensor`] is in range for the sensor that it is made
//!   for; a picture that was not moved lies where its imprint does.
//! - What follows from a document (coverage, imprint, regions, descriptors) is computed, never stored beside it.
//! - Infinity is never shown or written. A value that does not exist is None; arrays (`.npz`, recordings) cannot
//!   express that otherwise and use NaN.

// Says at each item which feature it needs. It is not stable yet, so only docs.rs sets this.
#![cfg_attr(docsrs, feature(doc_cfg))]

// The examples of the README are compiled and run with those of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

// So are those of the guide to the library, which need its rooms.
#[cfg(all(doctest, feature = "recognition"))]
#[doc = include_str!("../docs/library.md")]
struct LibraryGuide;

/// The version of glam whose points are in the interface: CG, CD and [`description::Value::Point`].
pub use glam;

mod quote;

mod index;

pub mod geometry;

pub mod parameter;

pub mod sensor;

pub mod imprint;

pub mod matrix;

pub mod figure;

pub mod picture;

pub mod source;

pub mod touch;

pub mod description;

pub mod frame;

#[cfg(feature = "sweep")]
pub mod pose;

#[cfg(feature = "sweep")]
pub mod atlas;

#[cfg(feature = "sweep")]
pub mod sweep;

#[cfg(feature = "recognition")]
pub mod recognition;

pub mod prelude;

pub mod formats;

#[cfg(any(feature = "library", feature = "sweep"))]
pub mod storage;

#[cfg(all(feature = "acquire", unix))]
pub mod acquire;

#[cfg(all(feature = "tui", not(unix)))]
compile_error!("the features `tui` and `cli` need a Unix-like system; on Windows use WSL");

#[cfg(feature = "tui")]
mod memory;

#[cfg(feature = "tui")]
pub mod tui;

#[cfg(feature = "cli")]
pub mod cli;
