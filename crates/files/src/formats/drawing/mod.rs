//! Drawings for papers and reports: a touch ([`Drawing`]), a confusion matrix ([`ConfusionMap`]), points and curves
//! ([`Plot`]) and maps of positions ([`PoseMap`]).
//!
//! They are black, white and grey, and no information depends on a shade alone, so they survive any printer.

mod confusion_map;
mod plot;
mod pose_map;
mod svg;
mod touch;

pub use confusion_map::ConfusionMap;
pub use plot::{Plot, axis_ends, axis_marks};
pub use pose_map::PoseMap;
pub use touch::Drawing;
