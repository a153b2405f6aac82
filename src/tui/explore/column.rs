//! The columns of the list of imprints that its rows can be sorted by.

use crate::atlas::{SortDirection, SortKey, sorted};
use crate::pose::Axis;
use crate::sweep::SweepResult;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListColumn {
    FirstPose,
    Poses,
    Position(Axis),
    Pieces,
    Holes,
    Value,
}

impl ListColumn {
    /// Counts and values begin with the largest, numbers and positions with the smallest.
    pub fn first_direction(self) -> SortDirection {
        match self {
            Self::FirstPose | Self::Position(_) => SortDirection::Ascending,
            Self::Poses | Self::Pieces | Self::Holes | Self::Value => SortDirection::Descending,
        }
    }

    /// `values` are those of the chosen descriptor, by the imprints' numbers.
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
