//! Decides what `f64` cannot, with 32 digits: whether the shape covers exactly the threshold of a cell.
//!
//! The rule is that of a touch ([`crate::touch`]): a coverage that falls short by less than 1e-20 does not count as
//! short. The boundary is drawn in [`Double`] once per orientation, at the origin, and shifted by the decimals of the
//! ranges; in real arithmetic, this is exactly the shape in that pose.

use crate::geometry::Overlap;
use crate::geometry::Point;
use crate::geometry::{Double, Real};
use crate::index::index;
use crate::pose::{Boundary, PoseGrid};
use crate::touch::least;

/// The number of values of x0 and of y0 whose positions are kept.
const REMEMBERED: usize = 128;

/// The effort of decisions after which to ask whether to go on: about a millisecond.
const ASK_EVERY: u64 = 256;

/// The number of edges that doubles the effort. A picture may have thousands of edges.
const EDGES: usize = 64;

/// Returns the effort of a pose or a decision; 1 for a shape with few edges.
pub(crate) fn effort(edges: usize) -> u64 {
    (1 + edges / EDGES) as u64
}

/// The shape of one orientation, ready for exact decisions.
pub(crate) struct Exact<'a> {
    grid: &'a PoseGrid,
    orientation: u64,
    /// Drawn when first needed: in most orientations nothing is in doubt.
    boundary: Option<Boundary<Double>>,
    /// The positions of the anchor for the last values of x0 and y0.
    positions: Box<[(Option<u64>, Double)]>,
    /// The area in one cell, added up piece by piece.
    cell: Overlap<Double>,
    /// The least coverage that reaches the threshold.
    least: Double,
    /// Returns whether to go on: a single row may need millions of decisions.
    go_on: &'a dyn Fn() -> bool,
    /// The effort since the last call of `go_on`.
    unasked: u64,
    /// Whether `go_on` has returned `false`.
    stopped: bool,
}

impl<'a> Exact<'a> {
    pub(crate) fn new(grid: &'a PoseGrid, orientation: u64, go_on: &'a dyn Fn() -> bool) -> Self {
        Self {
            grid,
            orientation,
            boundary: None,
            positions: vec![(None, Double::ZERO); 2 * REMEMBERED].into(),
            cell: Overlap::new(1, 1),
            least: least(grid.sensor().threshold()),
            go_on,
            unasked: 0,
            stopped: false,
        }
    }

    pub(crate) fn stopped(&self) -> bool {
        self.stopped
    }

    /// Returns true if the taxel is active when the shape lies at value `x` of x0 and value `y` of y0.
    #[cold]
    #[expect(clippy::cast_precision_loss, reason = "a column or a row")]
    pub(crate) fn active(&mut self, column: usize, row: usize, x: u64, y: u64) -> bool {
        let whole = |index: usize| Double::from(index as f64);
        let by = Point::new(
            self.position(x, false) - whole(column),
            self.position(y, true) - whole(row),
        );
        let boundary = self
            .boundary
            .get_or_insert_with(|| self.grid.boundary(self.orientation));
        self.unasked += effort(boundary.edges.len());
        if self.unasked >= ASK_EVERY {
            self.unasked = 0;
            self.stopped |= !(self.go_on)();
        }
        self.cell.clear();
        boundary.draw(by, &mut self.cell);
        self.cell.grid().first() >= self.least
    }

    /// Returns the position of the anchor at a value of x0, or of y0 if `down`. Looking it up is faster than reading
    /// a decimal.
    fn position(&mut self, number: u64, down: bool) -> Double {
        let slot = index(number) % REMEMBERED;
        let (known, position) = &mut self.positions[2 * slot + usize::from(down)];
        if *known != Some(number) {
            let offset = self.grid.offset::<Double>(self.orientation, number, number);
            (*known, *position) = (Some(number), if down { offset.y } else { offset.x });
        }
        *position
    }
}
