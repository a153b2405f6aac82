//! Every pose of a grid: runs of equal imprints, an atlas of the distinct ones, statistics of their descriptors.
//!
//! What the paper wanted and could only sample: "almost all possible imprints" of a shape. A sweep does not touch
//! pose by pose; it finds where along a range of positions the imprint changes, and is identical to touching all
//! the same. No I/O, no panics.
//!
//! **The way of a row** (all x0 at one y0 and one angle). For each row of the sensor, the places at which a taxel is
//! active are spans along x: of shapes of straight edges, convex or not, so pictures too, in `polygon`; of ellipses in
//! `ellipse`, with `settle` for what it is not sure of. From the spans follow the steps at which taxels turn over
//! (`mark`, `events`), and so the runs of one imprint each (`runs`). What `f64` can't decide is decided with 32 digits
//! (`exact`). Each imprint is counted once per run (`counter`) and described once per sweep (`atlas`).
//!
//! **What is not gone through.** Angles at which the shape looks the same (`symmetry`); and, where a half turn of the
//! plane maps the poses of one angle onto each other, one half of their rows (`half_turn`, `images`). Both by exact decimals.
//!
//! Sums are whole numbers (`sums`), so no thread, shard or symmetry changes a digit of the statistics.

mod point_symmetry;

mod plan;

mod exact;

mod span;

mod polygon;

mod ellipse_band;

mod isolate;

mod track;

mod ellipse;

mod events;

mod flips;

mod reflected_rows;

mod runs;

mod ideal;

mod result;

mod run;

mod sample;

mod count;

pub use count::{CountedImprints, PoseRun};
pub use plan::{Shard, ShardError};
pub(crate) use result::Parts;
pub use result::{MergeError, PartsError, SweepResult};
pub use run::{Sweep, TakeRow};
pub use sample::TimingSample;
