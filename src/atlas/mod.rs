//! The atlas: every imprint of a sweep once, with how often and where it occurs and what it looks like.
//!
//! Two imprints are the same when the same taxels are active. An imprint's number is that of its first occurrence in
//! the order of poses (see [`crate::pose::PoseGrid`]), the same for any number of threads. Descriptors are those of the
//! main region. Convention of this project.

mod packing;

mod counter;

mod feature;

mod canonical;

mod sums;

mod values;

mod variance;

mod statistics;

mod distinct;

mod order;

mod histogram;

mod filter;

pub(crate) use counter::ImprintCounter;
pub use distinct::{Atlas, AtlasEntry};
pub use feature::{Feature, ImprintSummary, feature_values, features};
pub use filter::{AtlasFilter, FilterError};
pub use histogram::Histogram;
pub use order::{SortKey, sorted};
pub(crate) use packing::Layout;
pub(crate) use statistics::statistics;
pub use statistics::{STATISTIC_COLUMNS, Statistic, StatisticColumn};
pub(crate) use values::Table;
pub(crate) use variance::{OrientationSums, VarianceParts};
