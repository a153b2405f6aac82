//! The columns of the list of imprints that its rows can be sorted by.

use crate::atlas::{SortDirection, SortKey, sorted};
use crate::pose::Axis;
use crate::sweep::SweepResult;

/// A column of the list of imprints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListColumn {
    /// The number of the imprint; imprints are numbered in the order of their first poses.
    FirstPose,
    /// The number of poses that leave it; their share has the same order.
    Poses,
    /// The position of the first of these poses, along an axis.
    Position(Axis),
    /// The number of pieces.
    Pieces,
    /// The number of holes.
    Holes,
    /// The value of the chosen descriptor.
    Value,
}

impl ListColumn {
    /// Returns the direction when rows are sorted by this column for the first time. Counts and values begin with the
    /// largest, numbers and positions with the smallest.
    pub fn first_direction(self) -> SortDirection {
        match self {
            Self::FirstPose | Self::Position(_) => SortDirection::Ascending,
            Self::Poses | Self::Pieces | Self::Holes | Self::Value => SortDirection::Descending,
        }
    }

    /// Returns the numbers of all imprints of a sweep, sorted by this column. `values` are those of the chosen
    /// descriptor, by the imprints' numbers.
    pub fn order(
        self,
        sweep: &SweepResult,
        values: &[Option<f64>],
        direction: SortDirection,
    ) -> Vec<u32> {
        let key = match self {
            Self::FirstPose => SortKey::FirstPose,
            Self::Poses => SortKey::Poses,
            Self::Pieces => SortKey::Pieces,
            Self::Holes => SortKey::Holes,
            Self::Value => SortKey::Value(values),
            Self::Position(axis) => {
                let range = sweep.grid.ranges()[axis];
                let first_poses = sweep.atlas.first_poses();
                let positions =
                    first_poses.map(|pose| Some(range.value(sweep.grid.index(pose)[axis])));
                let positions: Vec<Option<f64>> = positions.collect();
                return sorted(&sweep.atlas, SortKey::Value(&positions), direction);
            }
        };
        sorted(&sweep.atlas, key, direction)
    }
}
