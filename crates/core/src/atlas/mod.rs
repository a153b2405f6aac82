//! The atlas: the distinct imprints of a sweep, each with its description and with how often and where it occurs.
//!
//! Two imprints are the same if the same taxels are active. Imprints are numbered in the order of their first
//! occurrence among the poses (see [`crate::pose::PoseGrid`]); the numbers are the same for any number of threads.
//! Descriptors are those of the main region. These are conventions of this project.

mod counter;
mod distinct;
mod feature;
mod histogram;
mod key;
mod statistics;
mod values;

pub(crate) use counter::{ImprintCounter, Layout};
pub use distinct::{Atlas, AtlasEntry, DistinctClasses};
pub use feature::{Feature, ImprintSummary, feature_values, features};
pub use histogram::Histogram;
pub use key::{ImprintKey, KeyTable};
pub(crate) use key::{KeyRef, or_bits};
pub(crate) use statistics::statistics;
pub use statistics::{STATISTIC_COLUMNS, Statistic, StatisticColumn};
pub(crate) use values::{OrientationSums, Table, VarianceParts};
