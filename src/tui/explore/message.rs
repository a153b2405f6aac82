//! Messages about sweeps: what a key or a command asks for, and what workers answer.

use std::sync::Arc;
use std::time::Duration;

use crate::atlas::SortKey;
use crate::figure::FigureKind;
use crate::pose::PoseGrid;
use crate::source::Source;
use crate::storage::Existing;
use crate::sweep::SweepResult;

/// What a sweep found, whole or in part.
#[derive(Debug)]
pub struct Findings {
    /// The sweep.
    pub sweep: SweepResult,
    /// How many of its imprints are distinct up to shifts, and up to quarter turns and mirror images too.
    pub classes: (usize, usize),
}

impl PartialEq for Findings {
    /// Whether they are those of one sweep: they are never changed.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

/// What is swept, in a word: the kind of a figure, or a picture.
pub fn name_of(source: &Source) -> &'static str {
    source.kind().map_or("picture", FigureKind::name)
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
}

impl ExplorePage {
    /// All of them, in their order.
    pub const ALL: [Self; 4] = [Self::Imprints, Self::Statistics, Self::Histogram, Self::Map];
}

/// A zoom of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zoom {
    /// Along x.
    X,
    /// Along y.
    Y,
}

/// What a key or a command asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum ExploreMessage {
    /// The last result, or a form for the first.
    Open,
    /// The form of ranges.
    Ranges,
    /// To go through a grid.
    Start(Box<PoseGrid>),
    /// To stop what is under way, and keep what is complete.
    Stop,
    /// A page.
    Page(ExplorePage),
    /// Another page, so many further on.
    NextPage(i8),
    /// Another descriptor, so many further on.
    Feature(i8),
    /// Other columns of a table, so many further on.
    Columns(i8),
    /// To sort the imprints; by what they are sorted by already, the other way.
    Sort(SortKey),
    /// To go to the imprint that is on the matrix.
    Find,
    /// From an imprint of the list to the map, and back.
    Follow,
    /// To select a row of the page.
    Select(usize),
    /// To put the map's cursor at an x0 and a y0.
    Point(u64, u64),
    /// Another angle of the map, so many further on.
    Angle(i16),
    /// Another zoom of the map, so many further on.
    Zoomed(Zoom, i8),
    /// To ask for the name of a file.
    Export,
    /// To write a file.
    Write(String, Existing),
}

/// How far a sweep is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepProgress {
    /// Poses done.
    pub poses: u64,
    /// In this time.
    pub elapsed: Duration,
}

/// What a worker tells. Each piece of work has a number; what comes from an earlier one is not heard.
#[derive(Clone, Debug, PartialEq)]
pub enum WorkerEvent {
    /// How far it is.
    Progress(u64, SweepProgress),
    /// How long a grid will take, about.
    Estimate(Box<PoseGrid>, Duration),
    /// A sweep is over, at its end or because it was stopped.
    Swept(u64, Arc<Findings>),
    /// A file was written.
    Written(u64, String),
    /// It was not, because a file of that name is there.
    Exists(u64, String),
    /// Nothing came of it, and why.
    Failed(u64, String),
    /// Something that belongs to no piece of work cannot be done, and why.
    Refused(String),
}
