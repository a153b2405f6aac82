//! Messages about sweeps: what a key or a command asks for.

use std::time::Duration;

use crate::atlas::{SortKey, sorted};
use crate::pose::{Axis, PoseGrid};
use crate::source::Source;
use crate::storage::Existing;
use crate::sweep::SweepResult;
use crate::tui::explore::column::ListColumn;

/// What a sweep found, whole or in part.
#[derive(Debug)]
pub struct Findings {
    /// The sweep.
    pub sweep: SweepResult,
    /// How many of its imprints are distinct up to shifts, and up to quarter turns and mirror images too.
    pub classes: (usize, usize),
    /// The numbers of its imprints, the most frequent first.
    pub by_poses: Vec<u32>,
}

impl Findings {
    /// What a sweep found. It is counted and sorted here, which takes a moment for millions of imprints.
    pub fn new(sweep: SweepResult) -> Self {
        Self {
            classes: sweep.atlas.distinct_classes(),
            by_poses: sorted(&sweep.atlas, &[], SortKey::Poses, true),
            sweep,
        }
    }
}

impl PartialEq for Findings {
    /// Whether they are those of one sweep: they are never changed.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

/// What is swept, in a word: the kind of a figure, the name of a stored shape, or a picture.
pub fn name_of(source: &Source) -> &str {
    let stored = match source {
        Source::Figure(_) => None,
        Source::Picture(picture) => picture.name(),
    };
    stored.unwrap_or(source.kind_name())
}

/// The pages that they are shown on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExplorePage {
    /// The distinct imprints.
    Imprints,
    /// Statistics of every descriptor.
    Statistics,
    /// How often which values of the chosen descriptor occur.
    Histogram,
    /// The square of x0 and y0 at one angle.
    Map,
    /// Two descriptors, one against the other.
    Scatter,
    /// The chosen descriptor against the angle.
    Angles,
}

impl ExplorePage {
    /// All of them, in their order.
    pub const ALL: [Self; 6] = [
        Self::Imprints,
        Self::Statistics,
        Self::Histogram,
        Self::Map,
        Self::Scatter,
        Self::Angles,
    ];
}

/// A zoom of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zoom {
    /// Along x.
    X,
    /// Along y.
    Y,
}

impl Zoom {
    /// The axis of the grid.
    pub fn axis(self) -> Axis {
        match self {
            Self::X => Axis::ZoomX,
            Self::Y => Axis::ZoomY,
        }
    }
}

/// What a key or a command asks for on the pages of Explore.
#[derive(Clone, Debug, PartialEq)]
pub enum ExploreMessage {
    /// The last result, or a form for the first.
    Open,
    /// The form of ranges.
    Ranges,
    /// Sweep a grid.
    Start(Box<PoseGrid>),
    /// Stop the work in progress. A sweep keeps what is complete.
    Stop,
    /// A page.
    Page(ExplorePage),
    /// The page this many further on; negative goes back.
    NextPage(i8),
    /// The descriptor this many further on; negative goes back.
    Feature(i8),
    /// Scroll the columns of the statistics by this many; choose another heading of the list, another descriptor for
    /// the right of the scatter plot.
    Columns(i8),
    /// Sort the imprints by a column; again by the same column, reversed.
    Sort(ListColumn),
    /// The same by the column that is chosen in the headings.
    SortHere,
    /// Ask for an expression that imprints of the list have to fulfil.
    Filter,
    /// Ask for a letter to mark what is selected with.
    Mark,
    /// Ask for the letter of a mark to go to.
    Jump,
    /// Select the imprint that is on the matrix.
    Find,
    /// Go from an imprint of the list to the map, or back.
    Follow,
    /// Select a row of the page.
    Select(usize),
    /// Put the cursor of the map at an x0 and a y0, by index.
    Point(u64, u64),
    /// The angle of the map this many further on; negative goes back.
    Angle(i16),
    /// The zoom of the map this many further on; negative goes back.
    Zoomed(Zoom, i8),
    /// Ask for the name of a file to export to.
    Export,
    /// Write the results to a file.
    Write(String, Existing),
}

/// How far a sweep is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepProgress {
    /// Poses done.
    pub poses: u64,
    /// Time since the work began.
    pub elapsed: Duration,
}
