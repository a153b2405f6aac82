//! Which shapes can a robot recognise by touching them once?
//!
//! A tactile sensor is a matrix of square cells. When it touches a flat shape, a cell (a *taxel*) becomes active if
//! the shape covers at least half of it, or another share that you set as the threshold. The pattern of active taxels
//! is the *imprint*.
//!
//! This crate computes imprints exactly, for any position, rotation and size. It describes them by the geometric
//! parameters (*descriptors*) of D. Purcaru and E. Niculescu, *Experimental Results in Shape Description*; finds
//! every imprint that a shape can leave; recognises shapes by their imprints; and keeps shapes in a library of files.
//! The program of the same name puts a screen and a command line on top of it.
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
//! # Coordinates and units
//!
//! All coordinates belong to one frame, whose unit is the side of a cell:
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
//! The *rooms* (top-level modules) in reading order. Each uses only the rooms above it, and the modules inside a room
//! do not depend on each other in cycles. A test reads the `use` lines and enforces both. `quote`, `index`, `lock`
//! and `memory` are private.
//! ```text
//!  quote        shortens untrusted text for messages, and suggests names that are nearly right
//!  index        checked conversions between whole numbers and indices
//!  lock         mutexes that a panic of another thread does not close
//!  geometry     the area of polygons and ellipses in each cell of a grid           plane, f64
//!  parameter    the quantities that can be set: one table of keys, units, ranges, defaults
//!  sensor       columns, rows, threshold, pitch
//!  imprint      the binary matrix: one u64 per row
//!  matrix       one value per taxel
//!  figure  picture  source        the shapes that touch: seven figures, a stored imprint
//!  touch        shape + sensor -> coverage of each taxel -> imprint
//!  description  imprint -> regions -> DESCRIPTORS
//!  frame        the measurements of a real sensor: crop, tare, gain, threshold -> imprint
//!  pose         exact ranges, and the numbered poses of a grid
//!  atlas        the distinct imprints of a grid, counted; statistics
//!  progress     how long work reports what is done, and is stopped
//!  sweep        every pose of a grid at once -> its atlas
//!  recognition  models of shapes: how probable each is after a touch, and the limit of any method
//!  prelude      the names that most programs import
//!  ───────────  above: no input or output, and no panic except on an index that the caller made up; below: the world
//!  formats      text, PBM, CSV, NPY, JSON, atlases, models; recordings and streams of
//!               sensors; drawings as SVG and PNG
//!  storage      files: atomic writes, the folder of stored shapes, journal, trash
//!  acquire      where frames come from: serial, pipes, tcp, files; recording them
//!  memory       a limit on the memory of sweeps and trainings
//!  tui          the screen                                                         ratatui, crossterm
//!  cli          the command line over all of it                                    clap
//! ```
//! Only `storage`, `acquire`, `memory`, `cli`, `tui::runtime`, `tui::terminal` and `main` open files and streams;
//! `formats` only reads and writes streams that its callers have opened.
//!
//! The steps from a pose to its descriptors:
//! ```text
//! form, flag or JSON line -> parameter (range) -> figure or picture -> outlines, placed
//!   -> coverage -> imprint -> regions -> descriptors -> panel, table, JSON, drawing, sweep
//! ```
//! The steps from a frame to its descriptors:
//! ```text
//! file -> formats::recording, or acquire -> bytes -> formats::stream
//!   -> frame (crop, tare, gain, threshold) -> imprint -> regions -> descriptors, recognition
//! ```
//!
//! # Features
//!
//! ```text
//!                     adds                                             requires
//! (none)              everything except the items below; the only dependencies are glam, libm and serde
//! json                formats::StoredShape, Job
//! sweep               pose, atlas, progress, sweep; formats::atlas,    json
//!                     archive; storage::AtlasFile, PoseFile,
//!                     UnfinishedFile
//! recognition         recognition; formats::read_model, write_model    sweep
//! frames              formats::recording, stream                       json
//! mcap (by default)   MCAP files in formats::recording                 frames
//! png                 formats::Drawing::png
//! library             storage                                          json
//! acquire             acquire, on Unix-like systems                    frames, library
//! tui                 tui                                              library, recognition, acquire, png
//! cli (by default)    cli, and the program                             tui
//! ```
//!
//! If you need only touches and descriptors, as on the controller of a robot, use `default-features = false`.
//!
//! # Stability
//!
//! The rooms from `geometry` to `acquire` follow semantic versioning; types that are likely to grow are non-exhaustive.
//! `tui` and `cli` are the program: their items are public only for tests and scripts, and change with the program.
//!
//! # Invariants
//!
//! - A taxel is active if its coverage, in real arithmetic, is at least the threshold or falls short of it by less
//!   than 1e-20 ([`touch`]).
//! - Every [`sensor::Sensor`] is in range, and so is every [`figure::Figure`] and [`picture::Picture`] on the sensor
//!   that it is made for. A picture that was not moved lies where its imprint does, on a sensor of any size.
//! - Coverage, imprint, regions and descriptors are computed from a document, never stored beside it.
//! - Infinity is never shown or written. A value that does not exist is None; arrays (`.npz`, recordings) use NaN
//!   instead, because they have no None.

// Shows at each item which feature it needs. `doc_cfg` is not stable yet, so only docs.rs enables it.
#![cfg_attr(docsrs, feature(doc_cfg))]

// Compiles and runs the examples of the README as tests of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

// Does the same for the guide to the library, whose examples need the feature `recognition`.
#[cfg(all(doctest, feature = "recognition"))]
#[doc = include_str!("../docs/library.md")]
struct LibraryGuide;

/// The version of glam whose points are part of the interface: CG, CD and [`description::Value::Point`].
pub use glam;

mod quote;

mod index;

#[cfg(any(feature = "library", feature = "sweep"))]
mod lock;

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
pub mod progress;

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
#[allow(missing_docs, reason = "the program, not a library")]
pub mod tui;

#[cfg(feature = "cli")]
#[allow(missing_docs, reason = "the program, not a library")]
pub mod cli;
