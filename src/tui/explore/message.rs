//! Messages about sweeps: requests by keys and commands, and what a sweep found.

use std::time::Duration;

use crate::atlas::{DistinctClasses, SortDirection, SortKey, sorted};
use crate::pose::{Axis, PoseGrid};
use crate::source::Source;
use crate::storage::Existing;
use crate::sweep::SweepResult;
use crate::tui::explore::column::ListColumn;

/// The findings of a sweep, whole or in part.
#[derive(Debug)]
pub struct Findings {
    /// The sweep.
    pub sweep: SweepResult,
    /// The numbers of imprints that are distinct if their images count as one.
    pub classes: DistinctClasses,
    /// The numbers of the imprints, the most frequent first.
    pub by_poses: Vec<u32>,
}

impl Findings {
    /// Counts and sorts what a sweep found, which takes a moment for millions of imprints.
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

/// Returns the name of what is swept: the kind of a figure, the name of a stored shape, or "picture".
pub fn name_of(source: &Source) -> &str {
    let stored = match source {
        Source::Figure(_) => None,
        Source::Picture(picture) => picture.name(),
    };
    stored.unwrap_or(source.kind_name())
}

/// The tabs of the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExploreTab {
    /// The distinct imprints.
    Imprints,
    /// Statistics of every descriptor.
    Statistics,
    /// How often each value of the chosen descriptor occurs.
    Histogram,
    /// The square of x0 and y0 at one angle.
    Map,
    /// Two descriptors, one against the other.
    Scatter,
    /// The chosen descriptor against the angle.
    Angles,
}

impl ExploreTab {
    /// All tabs, from the left.
    pub const ALL: [Self; 6] = [
        Self::Imprints,
        Self::Statistics,
        Self::Histogram,
        Self::Map,
        Self::Scatter,
        Self::Angles,
    ];
}

/// A request by a key or a command on the tabs of Explore.
#[derive(Clone, Debug, PartialEq)]
pub enum ExploreMessage {
    /// Open the last results, or the form if there are none.
    Open,
    /// Open the form of ranges.
    Ranges,
    /// Sweep a grid.
    Start(Box<PoseGrid>),
    /// Stop the work in progress. A sweep keeps what is complete.
    Stop,
    /// Go to a tab.
    Tab(ExploreTab),
    /// Go to the tab this many further on; negative goes back.
    NextTab(i8),
    /// Choose the descriptor this many further on; negative goes back.
    Feature(i8),
    /// Scroll the columns of the statistics by this many; in the list, choose another heading; in the scatter plot,
    /// choose another descriptor for the horizontal axis.
    Columns(i8),
    /// Sort the imprints by a column; by the same column again, reverse their order.
    Sort(ListColumn),
    /// Sort the imprints by the column of the chosen heading.
    SortHere,
    /// Ask for an expression that filters the list of imprints.
    Filter,
    /// Select the imprint that is on the matrix.
    Find,
    /// Go from an imprint of the list to the map, or back.
    Follow,
    /// Put the cursor of the map at an x0 and a y0, by index.
    Point(u64, u64),
    /// Choose the angle of the map this many further on; negative goes back.
    Angle(i16),
    /// Choose the angle of the map by its index.
    ToAngle(u64),
    /// Go to the pose this many steps further on along an axis; negative goes back.
    Along(Axis, i8),
    /// Ask for the name of a file to export to.
    Export,
    /// Write the results to a file.
    Write(String, Existing),
}

/// The progress of a sweep or an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepProgress {
    /// The number of poses done.
    pub poses: u64,
    /// The time since the work began.
    pub elapsed: Duration,
}
