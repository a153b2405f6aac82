//! Messages about sweeps: requests by keys and commands, and what a sweep found.

use std::time::Duration;

use taxel_core::atlas::{DistinctClasses, SortDirection, SortKey, sorted};
use taxel_core::pose::{Axis, PoseGrid};
use taxel_core::source::Source;
use taxel_core::sweep::SweepResult;
use taxel_files::storage::Existing;

#[derive(Debug)]
pub struct Findings {
    pub sweep: SweepResult,
    pub classes: DistinctClasses,
    pub by_poses: Vec<u32>,
}

impl Findings {
    pub fn new(sweep: SweepResult) -> Self {
        Self {
            classes: sweep.atlas.distinct_classes(),
            by_poses: sorted(&sweep.atlas, SortKey::Poses, SortDirection::Descending),
            sweep,
        }
    }
}

impl PartialEq for Findings {
    /// Returns true if both are the same object in memory; findings never change.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

pub fn name_of(source: &Source) -> &str {
    let stored = match source {
        Source::Figure(_) => None,
        Source::Picture(picture) => picture.name(),
    };
    stored.unwrap_or(source.kind_name())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExploreTab {
    Imprints,
    Statistics,
    Histogram,
    Map,
    Scatter,
    Angles,
}

impl ExploreTab {
    pub const ALL: [Self; 6] = [
        Self::Imprints,
        Self::Statistics,
        Self::Histogram,
        Self::Map,
        Self::Scatter,
        Self::Angles,
    ];
}

#[derive(Clone, Debug, PartialEq)]
pub enum ExploreMessage {
    Open,
    Ranges,
    Start(Box<PoseGrid>),
    /// A sweep keeps what is complete.
    Stop,
    Tab(ExploreTab),
    /// Go to the tab this many further on; negative goes back.
    NextTab(i8),
    /// Choose the descriptor this many further on; negative goes back.
    Feature(i8),
    Columns(i8),
    Sort(ListColumn),
    SortHere,
    Filter,
    Find,
    Follow,
    Point(u64, u64),
    /// Choose the angle of the map this many further on; negative goes back.
    Angle(i16),
    ToAngle(u64),
    /// Go to the pose this many steps further on along an axis; negative goes back.
    Along(Axis, i8),
    Export,
    Write(String, Existing),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepProgress {
    pub poses: u64,
    /// The time since the work began.
    pub elapsed: Duration,
}

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
