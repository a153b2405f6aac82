//! The description of an imprint: its regions, and the paper's descriptors of each region.
//!
//! The object is 8-connected and the background 4-connected. So a diagonal line of taxels is one piece, and it
//! separates the background on its two sides. All counting is integer arithmetic on the rows' words; only the last step
//! divides.

mod region;

mod measures;

mod descriptor;

pub use descriptor::{DESCRIPTORS, Descriptor, Dimension, Value};
pub use measures::{ChainSteps, Description, ExactValue};
pub use region::{Region, RegionKind, each_region, main_region, regions};
