//! The columns of the list of imprints that its rows can be sorted by.

use crate::atlas::{SortKey, sorted};
use crate::pose::Axis;
use crate::sweep::SweepResult;

/// A column of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListColumn {
    /// The imprint's number, which is the order of first poses.
    FirstPose,
    /// The number of poses that leave it; their share has the same order.
    Poses,
    /// Where the first of them is, along an axis.
    Place(Axis),
    /// Number of pieces.
    Pieces,
    /// Number of holes.
    Holes,
    /// The value of the chosen descriptor.
    Value,
}

impl ListColumn {
    /// Whether the largest comes first when rows are sorted by it for the first time: counts and values do so, numbers and
    /// places begin at their first.
    pub fn largest_first(self) -> bool {
        !matches!(self, Self::FirstPose | Self::Place(_))
    }

    /// The numbers of all imprints of a sweep, sorted by it. `values` are those of the chosen descriptor.
    pub fn order(self, sweep: &SweepResult, values: &[Option<f64>], descending: bool) -> Vec<u32> {
        let key = match self {
            Self::FirstPose => SortKey::FirstPose,
            Self::Poses => SortKey::Poses,
            Self::Pieces => SortKey::Pieces,
            Self::Holes => SortKey::Holes,
            Self::Value => SortKey::Value,
            Self::Place(axis) => {
                let range = sweep.grid.ranges()[axis];
                let first_poses = sweep.atlas.first_poses();
                let places =
                    first_poses.map(|pose| Some(range.value(sweep.grid.index(pose)[axis])));
                let places: Vec<Option<f64>> = places.collect();
                return sorted(&sweep.atlas, &places, SortKey::Value, descending);
            }
        };
        sorted(&sweep.atlas, values, key, descending)
    }
}
