//! Explore: every imprint of a shape.
//!
//! ```text
//! ranges    the form: what to sweep                       work      the sweep in progress, the file of its imprints
//! results   a page of four tabs over what was found
//! imprints  statistics  map                               the tabs: each draws and handles what is its own
//! ```

mod imprints;
mod map;
pub(crate) mod ranges;
pub(crate) mod results;
mod statistics;
pub(crate) mod work;

use taxel_core::atlas::DistinctClasses;
use taxel_core::pose::PoseGrid;
use taxel_core::source::Source;
use taxel_core::sweep::SweepResult;

/// What a sweep found. It never changes, and is shared with the worker that writes it to a file.
#[derive(Debug)]
pub struct Findings {
    pub(crate) sweep: SweepResult,
    classes: DistinctClasses,
}

impl Findings {
    pub(crate) fn new(sweep: SweepResult) -> Self {
        Self {
            classes: sweep.atlas.distinct_classes(),
            sweep,
        }
    }
}

fn name_of(source: &Source) -> &str {
    source.stored_name().unwrap_or(source.kind_name())
}

/// Numbers say how many further on something is; negative goes back.
#[derive(Clone, Debug, PartialEq)]
pub enum ExploreMessage {
    Open,
    Ranges,
    Start(Box<PoseGrid>),
    Stop,
    /// The number of a tab, from 0.
    Tab(usize),
    NextTab(i8),
    Feature(i8),
    /// To the heading to the right.
    Columns(i8),
    Sort,
    Follow,
    /// A click on a place of a tab: a heading, x0 and y0 of a map.
    Point(u64, u64),
    Angle(i8),
    /// To the next zoom of a stored shape.
    Zoom,
    Export,
}
