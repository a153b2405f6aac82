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

/// How many values of x0 and of y0 are kept as positions.
const REMEMBERED: usize = 128;

/// The shape of one orientation, ready for exact decisions.
#[derive(Debug)]
pub(crate) struct Exact<'a> {
    /// The grid.
    grid: &'a PoseGrid,
    /// The number of the orientation.
    orientation: u64,
    /// Drawn when first needed: in most orientations nothing is in doubt.
    boundary: Option<Boundary<Double>>,
    /// Where the anchor lies for the values of x0 and of y0 asked for last.
    positions: Box<[(Option<u64>, Double)]>,
    /// Adds up the area in one cell.
    cell: Overlap<Double>,
    /// The coverage that counts as the threshold.
    least: Double,
}

impl<'a> Exact<'a> {
    pub(crate) fn new(grid: &'a PoseGrid, orientation: u64) -> Self {
        Self {
            grid,
            orientation,
            boundary: None,
            positions: vec![(None, Double::ZERO); 2 * REMEMBERED].into(),
            cell: Overlap::new(1, 1),
            least: least(grid.sensor().threshold()),
        }
    }

    /// Whether the taxel is active when the shape lies at value `x` of x0 and value `y` of y0.
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
        self.cell.clear();
        boundary.draw(by, &mut self.cell);
        self.cell.grid().first() >= self.least
    }

    /// Where the anchor lies at a value of x0, or of y0. Reading a decimal takes longer than looking it up.
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
