//! Drawings for papers and reports: a touch ([`Drawing`]), a confusion matrix ([`ConfusionMap`]), curves ([`LinePlot`]),
//! points ([`PointPlot`]) and maps of positions ([`PoseMap`]).
//!
//! They are black, white and grey, and no information depends on a shade alone, so they survive any printer.

mod confusion_map;
mod plots;
mod pose_map;
mod svg;
mod touch;

pub use confusion_map::ConfusionMap;
pub use plots::{LinePlot, PointPlot};
pub use plots::{axis_ends, axis_marks};
pub use pose_map::PoseMap;
pub use touch::Drawing;
