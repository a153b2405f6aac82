//! Drawings for papers and reports: a touch ([`Drawing`]), a confusion matrix ([`ConfusionMap`]) and curves ([`Plot`]).
//!
//! They are black, white and grey, and no information depends on a shade alone, so they survive any printer.

mod confusion_map;
mod plot;
mod svg;
mod touch;

pub use confusion_map::ConfusionMap;
pub use plot::Plot;
pub use touch::Drawing;
