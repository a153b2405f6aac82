//! The names that most programs need: `use taxel_core::prelude::*;`.

pub use crate::description::{
    DESCRIPTORS, Description, Region, RegionKind, each_region, main_region, regions,
};
pub use crate::figure::{Figure, FigureKind};
pub use crate::geometry::Solid;
pub use crate::imprint::Imprint;
pub use crate::parameter::{Parameter, ParameterError};
pub use crate::picture::Picture;
pub use crate::sensor::{MatrixSize, Sensor};
pub use crate::source::Source;
pub use crate::touch::Plane;

pub use crate::atlas::Atlas;
pub use crate::pose::{Anchor, Axis, DecimalRange, Pose, PoseGrid, PoseIndex, Ranges};
pub use crate::sweep::{Shard, Sweep, SweepResult};
