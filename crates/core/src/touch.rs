//! One touch: from a shape on a sensor to the coverage of every taxel and the imprint.
//!
//! **The rule** (the paper's "50 %"): a taxel is active if the shape covers at least a given share of its cell, the
//! threshold. Parts of the shape beyond the sensor are cut off.
//!
//! **A coverage of exactly the threshold is active**, in real arithmetic, for the decimals that the user wrote.
//! Coverages are first computed in `f64`, with an error below 1e-11 for every shape of the program
//! ([`Plane::coverages`] says how errors grow). If one lies within 1e-10 of the threshold, it is computed again with 32
//! digits ([`Double`]). The taxel is then active unless the coverage falls short of the threshold by more than 1e-20
//! ([`Real::TIE`]).
//!
//! No number of digits can decide whether two algebraic expressions of the input are *equal*, so a coverage that falls
//! short by less than 1e-20 counts as a tie. This is exact for an upright rectangle whose numbers have at most nine
//! decimals, since its coverages are multiples of 1e-18. With more decimals, a coverage can come nearer than 1e-20
//! without a tie (0.9999999999 × 0.50000000005). Coverages of turned figures given in hundredths come within 3e-11 of
//! the threshold.

use crate::geometry::{
    Double, Drawn, Ellipse, Extent, Overlap, Pen, Point, Real, Side, Solid, cell_area, row_areas,
};
use crate::imprint::Imprint;
use crate::index::wide;
use crate::matrix::Matrix;
use crate::sensor::Sensor;

/// Coverages this near to the threshold are computed again with more digits; a share of a cell.
pub(crate) const DOUBTFUL: f64 = 1e-10;
/// The limit of the coordinates of ellipses: products of four coordinates must be finite.
const ELLIPSE_LIMIT: f64 = 1e70;
/// A bound of the rounding error of a coverage, per unit of the magnitudes that are added up. Outlines of users may
/// reach farther than the shapes of the program, and rounding errors grow with coordinates.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// The sensory plane: a sensor that can be touched repeatedly. A touch allocates only if a coverage is in doubt.
///
/// ```
/// use taxel_core::prelude::*;
/// let mut plane = Plane::new(Sensor::default());
/// let rectangle = Figure::rectangle(6.0, 3.0).at(4.0, 4.0).on(plane.sensor())?;
/// let imprint = plane.touch(&rectangle);
/// assert_eq!(imprint.count(), 6 * 3);
/// assert_eq!(plane.coverages().get(4, 4), Some(1.0));
/// # Ok::<(), ParameterError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Plane {
    sensor: Sensor,
    overlap: Overlap<f64>,
    /// The areas of the last touch in pairs of rows, starting with the first pair of `drawn`.
    areas: Vec<[f64; 2]>,
    /// The cells of the last touch that may have an area.
    drawn: Drawn,
    imprint: Imprint,
}

impl Plane {
    /// Creates the plane of a sensor, not touched yet.
    pub fn new(sensor: Sensor) -> Self {
        Self {
            sensor,
            overlap: Overlap::new(sensor.columns(), sensor.rows()),
            areas: vec![
                [0.0; 2];
                usize::from(sensor.columns()) * usize::from(sensor.rows().div_ceil(2))
            ],
            drawn: Drawn::default(),
            imprint: Imprint::empty(sensor.size()),
        }
    }

    /// Returns the sensor.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// Returns the imprint that a shape leaves. It never fails: the imprint is empty if the shape has no boundary, or
    /// has (as your own shapes may) a coordinate that is not finite or an ellipse with a coordinate of 1e70 or more.
    ///
    /// For an ellipse with a coordinate above 500, a taxel may be wrong if its coverage is nearer to the threshold than
    /// the error of [`Self::coverages`].
    pub fn touch(&mut self, solid: &impl Solid) -> Imprint {
        *self.touched(solid)
    }

    /// Returns the imprint of [`Self::touch`], which stays in the plane until the next touch. Copying half a kilobyte
    /// takes a noticeable part of the time of a touch.
    pub fn touched(&mut self, solid: &impl Solid) -> &Imprint {
        self.imprint.words_mut().fill(0);
        self.drawn = Drawn::default();
        let mut pen = TouchPen {
            overlap: &mut self.overlap,
            finite: true,
        };
        solid.draw(&mut pen);
        if pen.finite {
            self.activate(solid);
        } else {
            // Clears everything, since the extent of such a shape is not known.
            self.overlap.grid.wipe();
        }
        &self.imprint
    }

    /// Activates the taxels of the empty imprint that the shape covers enough, which is drawn.
    fn activate(&mut self, solid: &impl Solid) {
        let grid = &mut self.overlap.grid;
        let drawn = grid.drawn();
        if drawn.is_empty() {
            grid.clear();
            return;
        }
        // Rounding errors grow with the coordinates.
        let doubt = DOUBTFUL.max(ROUNDINGS * grid.magnitude());
        let unused = u64::BITS as usize - drawn.columns.len();
        let words = &mut self.imprint.words_mut()[drawn.rows.clone()];
        let mut rest = &mut self.areas[..];
        let mut nearest = f64::MAX;
        for (areas, words) in grid.take_pairs(&drawn).zip(words.chunks_mut(2)) {
            let Some(kept) = rest.split_off_mut(..drawn.columns.len()) else {
                break;
            };
            let (short, near) = compare(areas, self.sensor.threshold(), kept);
            for (word, short) in words.iter_mut().zip(short) {
                *word = (!short >> unused) << drawn.columns.start;
            }
            nearest = Real::min(near, nearest);
        }
        grid.forget();
        self.drawn = drawn;
        if nearest < doubt {
            self.decide_doubtful(solid, doubt);
        }
    }

    /// The number of each column of a row whose areas were computed, and the area.
    fn computed(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let Drawn { rows, columns } = &self.drawn;
        let (pair, lane) = ((row - rows.start) / 2, (row - rows.start) % 2);
        let areas = self.areas[pair * columns.len()..][..columns.len()].iter();
        columns.clone().zip(areas.map(move |pair| pair[lane]))
    }

    /// Computes the coverages that are nearer to the threshold than `doubt` again.
    #[cold]
    fn decide_doubtful(&mut self, solid: &impl Solid, doubt: f64) {
        let (threshold, columns) = (self.sensor.threshold(), self.sensor.columns());
        let least = least(threshold);
        for index in self.drawn.rows.clone() {
            let near = |&(_, area): &(usize, f64)| (area - threshold).abs() < doubt;
            let near = self.computed(index).filter(near);
            let doubtful = near.fold(0_u64, |word, (column, _)| word | 1 << column);
            let (Ok(row), true) = (u8::try_from(index), doubtful != 0) else {
                continue;
            };
            // If several cells of a row are in doubt, such as full cells at a threshold of 1, the shape is drawn once
            // for all of them.
            let areas =
                (doubtful.count_ones() > 1).then(|| row_areas::<Double>(solid, [0, row], columns));
            let word = &mut self.imprint.words_mut()[index];
            for column in (0..columns).filter(|column| doubtful >> column & 1 == 1) {
                let area = match &areas {
                    Some(areas) => areas[usize::from(column)],
                    None => cell_area(solid, column, row),
                };
                *word = *word & !(1 << column) | u64::from(area >= least) << column;
            }
        }
    }

    /// Compares the last touch with an imprint on a matrix of the same size, without the active taxels of `dead`.
    /// Returns the number of taxels that differ, and their misfit: the sum of |coverage − threshold| over them, which
    /// is how far the shape is from leaving the imprint.
    pub(crate) fn misfit(&self, wanted: &Imprint, dead: Option<&Imprint>) -> (u32, f64) {
        let Drawn { rows, columns } = &self.drawn;
        let (mut differs, mut misfit) = (0, 0.0);
        let words = self.imprint.words().iter().zip(wanted.words());
        for (row, (own, wanted)) in words.enumerate() {
            let dead = dead.and_then(|dead| dead.words().get(row));
            let mut differing = (own ^ wanted) & !dead.copied().unwrap_or_default();
            differs += differing.count_ones();
            while differing != 0 {
                let column = wide(differing.trailing_zeros());
                differing &= differing - 1;
                let area = if rows.contains(&row) && columns.contains(&column) {
                    let (pair, lane) = ((row - rows.start) / 2, (row - rows.start) % 2);
                    self.areas[pair * columns.len() + column - columns.start][lane]
                } else {
                    0.0
                };
                misfit += Real::abs(area - self.sensor.threshold());
            }
        }
        (differs, misfit)
    }

    /// Returns the share of each taxel's cell that the shape of the last touch covers, 0 to 1.
    ///
    /// The error is below 1e-11 for shapes about as large as the sensor. It grows with the square of the largest
    /// coordinate of an ellipse: 3e-12 was measured at 100 cells, 4e-8 at 10,000 and 3e-4 at a million.
    pub fn coverages(&self) -> Matrix<f64> {
        let mut all = Matrix::filled(self.sensor.size(), 0.0);
        self.write_coverages(all.values_mut());
        all
    }

    /// Writes the shares of [`Self::coverages`] to the cells of the sensor, row by row, without an allocation.
    pub fn write_coverages(&self, cells: &mut [f64]) {
        cells.fill(0.0);
        let width = usize::from(self.sensor.columns());
        for row in self.drawn.rows.clone() {
            for (column, area) in self.computed(row) {
                if let Some(cell) = cells.get_mut(row * width + column) {
                    *cell = rounded_coverage(area);
                }
            }
        }
    }
}

/// Compares the areas of two rows with the threshold, and keeps them. Returns for both rows which cells fall short of
/// it, with the last column in the highest bit, and the distance of the nearest area from it.
fn compare(
    areas: impl Iterator<Item = [f64; 2]>,
    threshold: f64,
    kept: &mut [[f64; 2]],
) -> ([u64; 2], f64) {
    let (mut short, mut nearest) = ([0_u64; 2], [f64::MAX; 2]);
    for (kept, areas) in kept.iter_mut().zip(areas) {
        *kept = areas;
        for lane in 0..2 {
            let excess = areas[lane] - threshold;
            // The sign becomes the bit.
            short[lane] = short[lane] >> 1 | excess.to_bits() & 1 << 63;
            nearest[lane] = Real::min(Real::abs(excess), nearest[lane]);
        }
    }
    (short, Real::min(nearest[0], nearest[1]))
}

struct TouchPen<'a> {
    overlap: &'a mut Overlap<f64>,
    /// Whether all coordinates are finite, and those of ellipses within the limit.
    finite: bool,
}

/// Returns true if both coordinates of a point of an ellipse are small enough; false if one is NaN.
fn is_within_limit(point: Point<f64>) -> bool {
    point.x.abs() < ELLIPSE_LIMIT && point.y.abs() < ELLIPSE_LIMIT
}

fn are_finite(points: &[Point<f64>]) -> bool {
    // 0 times infinity is NaN, as is everything added to NaN. Adding is faster than comparing each coordinate.
    let sum = |sum: [f64; 2], point: &Point<f64>| [sum[0] + 0.0 * point.x, sum[1] + 0.0 * point.y];
    let [x, y] = points.iter().fold([0.0; 2], sum);
    x + y == 0.0
}

impl Pen<f64> for TouchPen<'_> {
    fn edge(&mut self, from: Point<f64>, to: Point<f64>) {
        self.finite &= are_finite(&[from, to]);
        self.overlap.edge(from, to);
    }

    fn ellipse(&mut self, ellipse: &Ellipse<f64>, material: Side) {
        let points = [ellipse.centre, ellipse.across, ellipse.along];
        if points.into_iter().all(is_within_limit) {
            self.overlap.ellipse(ellipse, material);
        } else {
            self.finite = false;
        }
    }

    fn ring(&mut self, points: &[Point<f64>], material: Side) {
        self.finite &= are_finite(points);
        self.overlap.ring(points, material);
    }
}

/// Returns the least coverage that activates a taxel: the threshold minus the tolerance for ties. It is above 0, so
/// that a tiny threshold does not activate taxels that are not covered at all.
pub(crate) fn least(threshold: f64) -> Double {
    Real::max(Double::decimal(threshold) - Double::TIE, Double::TIE)
}

/// Removes visible rounding errors from a share of a cell: the result is never below 0 or above 1, and exactly 0, ½
/// or 1 if it is close to them.
fn rounded_coverage(area: f64) -> f64 {
    let near = (area * 2.0).round() / 2.0;
    let area = if (area - near).abs() < f64::TIE {
        near
    } else {
        area
    };
    // A negative zero would be printed with its sign. `max` may keep the sign, the sum does not.
    area.clamp(0.0, 1.0) + 0.0
}

/// Returns true if a shape reaches beyond the sensor by more than a rounding error.
pub fn reaches_beyond(solid: &impl Solid, sensor: &Sensor) -> bool {
    Extent::of(solid).is_some_and(|extent| {
        let beyond =
            |low: f64, high: f64, side: u8| low < -DOUBTFUL || high > f64::from(side) + DOUBTFUL;
        beyond(extent.left, extent.right, sensor.columns())
            || beyond(extent.top, extent.bottom, sensor.rows())
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_ring_leaves_a_piece_and_a_hole() -> Result<(), Box<dyn std::error::Error>> {
        use crate::prelude::*;
        let mut plane = Plane::new(Sensor::default());
        let ring = Figure::ellipse(4.0, 4.0)
            .thickness(2.0)
            .at(4.0, 4.0)
            .on(plane.sensor())?;
        let mut counts = Vec::new();
        each_region(plane.touched(&ring), |region| {
            counts.push(Description::of(region).nae);
        });
        assert_eq!(counts, [52, 12]);
        Ok(())
    }
}
