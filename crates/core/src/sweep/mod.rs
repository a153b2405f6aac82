//! Sweeps every pose of a grid: finds runs of equal imprints, an atlas of the distinct ones, and statistics of their
//! descriptors.
//!
//! The paper wanted "almost all possible imprints" of a shape and could only sample them. A sweep finds all of them.
//! Instead of touching pose by pose, it finds where along a range of positions the imprint changes; the result is
//! identical to touching every pose. No I/O, no panics.
//!
//! **How a row is swept** (all x0 at one y0 and one angle):
//! ```text
//! polygon | ellipse   for each row of the sensor: the spans of x at which a taxel is active
//! -> flips            the steps of x0 at which taxels become active or inactive
//! -> events -> runs   the runs of poses with the same imprint
//! -> atlas            each imprint counted once per run, and described once per sweep
//! ```
//! From the whole to the part: a grid has *orientations* (an angle and a pair of zooms), those that show the same shape
//! form a *group*, a *task* is some rows of one or two groups, and a *row* crosses the shape's *bands*, one for each
//! row of the sensor. So read `run` (tasks), `runs` (rows), `flips` (bands), then `polygon`.
//!
//! **What is skipped.** If the shape looks the same at several angles, only one of them is swept ([`crate::pose`]).
//! If the shape at one angle is the mirror image of itself at another, the spans of one follow from those of the
//! other, with right and left exchanged. If a half turn of the plane maps the poses of an angle onto each other, only
//! half of their rows are swept (`plan`, `runs`). Exact decimals decide all of this.
//!
//! Sums are whole numbers, so the statistics are the same to the last digit for any number of threads or shards.

mod plan;

mod polygon;

mod ellipse;

mod flips;

mod runs;

mod result;

mod run;

pub use plan::{MergeError, Shard, ShardError};
pub use result::{Parts, PartsError, SweepMerge, SweepResult};
pub(crate) use run::CountedImprints;
pub use run::{Sweep, TakeRow};
