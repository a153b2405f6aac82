//! Exact tactile imprints of flat shapes, and what one touch tells of a shape.
//!
//! A tactile sensor is a matrix of square cells. When it touches a flat shape, a cell (a *taxel*) becomes active if
//! the shape covers at least half of it, or another share that you set as the threshold. The pattern of active taxels
//! is the *imprint*.
//!
//! This crate computes imprints exactly, for any position, rotation and size. It describes them by the geometric
//! parameters (*descriptors*) of D. Purcaru and E. Niculescu, *Experimental Results in Shape Description*; finds
//! every imprint that a shape can leave; and recognises shapes by their imprints. It does no input and no output, and
//! does not panic except on an index that the caller made up. `taxel-files` reads and writes files, and the program
//! `taxel` puts a screen and a command line on top of both.
//!
//! ```
//! use taxel_core::prelude::*;
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
//! The modules in reading order; each uses only those above it.
//! ```text
//!  quote        shortens untrusted text for messages, and suggests names that are nearly right
//!  index        checked conversions between whole numbers and indices
//!  lock         mutexes that a panic of another thread does not close
//!  geometry     the area of polygons and ellipses in each cell of a grid           plane, f64
//!  parameter    the quantities that can be set: one table of keys, units, ranges, defaults
//!  sensor       columns, rows, threshold, pitch
//!  imprint      the binary matrix: one u64 per row
//!  matrix       one value per taxel
//!  values       the values of a shape's parameters
//!  figure  picture  outline  source        the shapes that touch: seven figures, a stored imprint, rings
//!  touch        shape + sensor -> coverage of each taxel -> imprint
//!  description  imprint -> regions -> DESCRIPTORS
//!  frame        the measurements of a real sensor: crop, tare, gain, threshold -> imprint
//!  pose         exact ranges, and the numbered poses of a grid
//!  atlas        the distinct imprints of a grid, counted; statistics
//!  progress     how long work reports what is done, and is stopped
//!  sweep        every pose of a grid at once -> its atlas
//!  serialize    what files and answers contain, as serde writes it
//!  recognition  models of shapes: how probable each is after a touch, and the limit of any method
//!  prelude      the names that most programs import
//! ```
//!
//! # Invariants
//!
//! - A taxel is active if its coverage, in real arithmetic, is at least the threshold or falls short of it by less
//!   than 1e-20 ([`touch`]).
//! - Every [`sensor::Sensor`] is in range, and so is every [`figure::Figure`] and [`picture::Picture`] on the sensor
//!   that it is made for. A picture that was not moved lies where its imprint does, on a sensor of any size.
//! - Infinity and NaN are never shown or written as values. A value that does not exist is None.

#![warn(missing_docs)]

/// The version of glam whose points are part of the interface: CG, CD and [`description::Value::Point`].
pub use glam;

pub mod atlas;
pub mod description;
pub mod figure;
pub mod frame;
pub mod geometry;
pub mod imprint;
pub mod index;
pub mod lock;
pub mod matrix;
pub mod outline;
pub mod parameter;
pub mod picture;
pub mod pose;
pub mod prelude;
pub mod progress;
pub mod quote;
pub mod recognition;
pub mod sensor;
pub mod serialize;
pub mod source;
pub mod sweep;
pub mod touch;
mod values;
