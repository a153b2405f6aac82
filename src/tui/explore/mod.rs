//! Explore: every imprint of a shape.
//!
//! ```text
//! ranges    the form: what to sweep                       work      the sweep or the export in progress
//! results   a page of six tabs over what was found        export    the prompts: filter of the list, name of a file
//! imprints  statistics  map  plots                        the tabs: each draws, exports and handles what is its own
//! ```

mod export;
mod imprints;
mod map;
mod plots;
pub(crate) mod ranges;
pub(crate) mod results;
mod statistics;
pub(crate) mod work;

use taxel_core::atlas::{DistinctClasses, SortDirection, SortKey, sorted};
use taxel_core::pose::PoseGrid;
use taxel_core::source::Source;
use taxel_core::sweep::SweepResult;

/// What a sweep found. It never changes, and is shared with workers that write it to files.
#[derive(Debug)]
pub struct Findings {
    pub(crate) sweep: SweepResult,
    classes: DistinctClasses,
    by_poses: Vec<u32>,
}

impl Findings {
    pub(crate) fn new(sweep: SweepResult) -> Self {
        Self {
            classes: sweep.atlas.distinct_classes(),
            by_poses: sorted(&sweep.atlas, SortKey::Poses, SortDirection::Descending),
            sweep,
        }
    }
}

fn name_of(source: &Source) -> &str {
    source.stored_name().unwrap_or(source.kind_name())
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

/// Numbers say how many further on something is; negative goes back.
#[derive(Clone, Debug, PartialEq)]
pub enum ExploreMessage {
    Open,
    Ranges,
    Start(Box<PoseGrid>),
    Stop,
    Tab(ExploreTab),
    NextTab(i8),
    Feature(i8),
    /// To the heading or the horizontal descriptor to the right.
    Columns(i8),
    Sort,
    Filter,
    Find,
    Follow,
    /// A click on a place of a tab: a heading, x0 and y0 of a map, an angle.
    Point(u64, u64),
    Angle(i8),
    /// To the next zoom of a stored shape.
    Zoom,
    Export,
}
