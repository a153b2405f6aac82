//! One touch: from a shape on a sensor to the coverage of every taxel and the imprint.
//!
//! **The rule** (the paper's "50 %"): a taxel is active if the shape covers at least a given share of its cell, the
//! threshold. Parts of the shape beyond the sensor are cut off.
//!
//! **A coverage of exactly the threshold is active**, in real arithmetic, for the decimals that the user wrote.
//! Coverages are first computed in `f64`, with an error below 1e-11 ([`crate::geometry::cell_area`]). If one lies
//! within 1e-10 of the threshold, it is computed again with 32 digits ([`Double`]), and the taxel is active unless
//! the coverage falls short of the threshold by more than 1e-20 ([`Real::TIE`]). For ellipses at a threshold of one
//! half, hardly any coverage needs to be computed at all: the positions of the cells' centres decide.
//!
//! No number of digits can decide whether two algebraic expressions of the input are *equal*, so a coverage that
//! falls short by less than 1e-20 counts as a tie. This is exact for an upright rectangle whose numbers have at most
//! nine decimals, since its coverages are multiples of 1e-18. With more decimals, a coverage can come nearer than
//! 1e-20 without a tie (0.9999999999 × 0.50000000005). Coverages of turned figures given in hundredths come within
//! 3e-11 of the threshold.

use std::ops::Range;

use crate::geometry::{
    CentreSampling, Double, Ellipse, Extent, Overlap, Pen, Point, Real, Side, Solid, cell_area,
    row_areas,
};
use crate::imprint::Imprint;
use crate::index::from_first;
use crate::matrix::Matrix;
use crate::sensor::Sensor;

/// Coverages this near to the threshold are computed again with more digits; a share of a cell. It holds for every
/// shape of the program.
pub(crate) const DOUBTFUL: f64 = 1e-10;
/// The limit of the coordinates of ellipses: products of four coordinates must be finite.
const ELLIPSE_LIMIT: f64 = 1e70;
/// A bound of the rounding error of a coverage, per unit of the magnitudes that are added up. Outlines defined by
/// users may reach farther than the shapes of the program, and rounding errors grow with coordinates.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// The sensory plane: a sensor that can be touched repeatedly. A touch allocates only if a coverage is in doubt.
///
/// ```
/// use taxel::prelude::*;
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
    /// The areas of the last touch, without those of `ellipses`.
    areas: Overlap<f64>,
    /// The ellipses of the last touch whose areas were not computed, because their centres decided.
    ellipses: CentreSampling,
}

impl Plane {
    /// Creates the plane of a sensor, not touched yet.
    pub fn new(sensor: Sensor) -> Self {
        Self {
            sensor,
            areas: Overlap::new(sensor.columns(), sensor.rows()),
            ellipses: CentreSampling::new(sensor.rows()),
        }
    }

    /// Returns the sensor.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// Returns the imprint that a shape leaves. It never fails: the imprint is empty if the shape has no boundary, or
    /// has (as your own shapes may) a coordinate that is not finite or an ellipse with a coordinate of 1e70 or more.
    pub fn touch(&mut self, solid: &impl Solid) -> Imprint {
        self.areas.clear();
        self.ellipses.clear();
        let mut pen = TouchPen {
            areas: &mut self.areas,
            ellipses: &mut self.ellipses,
            edges: false,
            finite: true,
        };
        solid.draw(&mut pen);
        let (round, finite) = (!pen.edges, pen.finite);
        let mut imprint = Imprint::empty(self.sensor.size());
        if !finite {
            // Clears everything, since the extent of such a shape is not known.
            self.areas.wipe();
            self.ellipses.clear();
            return imprint;
        }
        if round
            && self.sensor.threshold() == CentreSampling::THRESHOLD
            && let Some(rows) = self.ellipses.sample()
        {
            self.activate_by_centres(solid, rows, &mut imprint);
        } else {
            self.ellipses.draw(&mut self.areas);
            self.ellipses.clear();
            self.activate_by_areas(solid, &mut imprint);
        }
        imprint
    }

    /// Activates the taxels that are covered enough. For most of them, the position of the cell's centre decides.
    fn activate_by_centres(&mut self, solid: &impl Solid, rows: Range<i32>, imprint: &mut Imprint) {
        let columns = imprint.mask();
        let words = imprint.words_mut();
        for row in rows {
            let (mut active, open) = self.ellipses.row(row);
            let (mut open, mut doubtful) = (open & columns, 0);
            while open != 0 {
                let column = open.trailing_zeros();
                open &= open - 1;
                let excess = self.ellipses.area(column, row) - CentreSampling::THRESHOLD;
                active = active & !(1 << column) | u64::from(excess > 0.0) << column;
                doubtful |= u64::from(excess.abs() < DOUBTFUL) << column;
            }
            if doubtful != 0 {
                active = self.decide(solid, from_first(row), active, doubtful);
            }
            words[from_first(row)] = active & columns;
        }
    }

    /// Activates the taxels that are covered enough. The covered areas decide.
    fn activate_by_areas(&self, solid: &impl Solid, imprint: &mut Imprint) {
        let (threshold, doubt) = (self.sensor.threshold(), self.doubt());
        let areas = self.areas.grid();
        let rows = areas.rows();
        let columns = areas.columns();
        let first = columns.start;
        let unused = u64::BITS as usize - columns.len();
        // A shape wholly right of the sensor has no columns.
        if rows.is_empty() || columns.is_empty() {
            return;
        }
        for pair in rows.start / 2..rows.end.div_ceil(2) {
            // The sign of a cell's excess becomes its bit. Bits are shifted in from the left, so after the last
            // column they are `unused` places too high.
            let (mut short, mut nearest) = ([0_u64; 2], [f64::MAX; 2]);
            for excess in areas.pair(pair, &columns, threshold) {
                for lane in 0..2 {
                    short[lane] = short[lane] >> 1 | excess[lane].to_bits() & 1 << 63;
                    nearest[lane] = Real::min(Real::abs(excess[lane]), nearest[lane]);
                }
            }
            let mut active = short.map(|short| (!short >> unused) << first);
            if Real::min(nearest[0], nearest[1]) < doubt {
                for (row, active) in (2 * pair..).zip(&mut active) {
                    *active = self.decide(solid, row, *active, self.doubtful(row));
                }
            }
            imprint.set_pair(pair, active);
        }
    }

    /// Returns how near to the threshold a coverage of the last touch must be to be in doubt.
    fn doubt(&self) -> f64 {
        DOUBTFUL.max(ROUNDINGS * self.areas.grid().magnitude())
    }

    /// Returns the taxels of a row whose areas are in doubt.
    fn doubtful(&self, row: usize) -> u64 {
        let (threshold, doubt) = (self.sensor.threshold(), self.doubt());
        let areas = self.areas.grid();
        let columns = areas.columns();
        let mut doubtful = 0;
        for (column, area) in columns.clone().zip(areas.row(row, &columns)) {
            doubtful |= u64::from((area - threshold).abs() < doubt) << column;
        }
        doubtful
    }

    /// Returns the active taxels of a row, after computing those in doubt again.
    #[cold]
    fn decide(&self, solid: &impl Solid, row: usize, mut active: u64, doubtful: u64) -> u64 {
        let Ok(row) = u8::try_from(row) else {
            return active;
        };
        let least = least(self.sensor.threshold());
        // If several cells of a row are in doubt, such as full cells at a threshold of 1, the shape is drawn once for
        // all of them.
        let areas = (doubtful.count_ones() > 1)
            .then(|| row_areas::<Double>(solid, self.sensor.columns(), row));
        for column in 0..self.sensor.columns() {
            if doubtful >> column & 1 == 1 {
                let area = match &areas {
                    Some(areas) => areas[usize::from(column)],
                    None => cell_area(solid, column, row),
                };
                active = active & !(1 << column) | u64::from(area >= least) << column;
            }
        }
        active
    }

    /// Returns the share of each taxel's cell that the shape of the last touch covers, 0 to 1.
    pub fn coverages(&self) -> Matrix<f64> {
        let width = usize::from(self.sensor.columns());
        let mut all = Matrix::filled(self.sensor.size(), 0.0);
        let mut areas = self.areas.clone();
        self.ellipses.draw(&mut areas);
        let areas = areas.grid();
        let columns = areas.columns();
        // A shape beside the sensor has no columns.
        if columns.is_empty() {
            return all;
        }
        for row in areas.rows() {
            let cells = &mut all.values_mut()[row * width..][columns.clone()];
            for (cell, area) in cells.iter_mut().zip(areas.row(row, &columns)) {
                *cell = share(area);
            }
        }
        all
    }
}

/// A pen that draws edges at once but only collects ellipses: if there is nothing else, their areas may not be
/// needed.
struct TouchPen<'a> {
    areas: &'a mut Overlap<f64>,
    ellipses: &'a mut CentreSampling,
    /// Whether the shape has edges.
    edges: bool,
    /// Whether areas can be computed with all coordinates of the shape: they are finite, and small enough for
    /// ellipses.
    finite: bool,
}

/// Returns true if both coordinates of a point are below a limit in size; false if one is NaN.
fn is_within(point: Point<f64>, limit: f64) -> bool {
    point.x.abs() < limit && point.y.abs() < limit
}

impl Pen<f64> for TouchPen<'_> {
    fn edge(&mut self, from: Point<f64>, to: Point<f64>) {
        self.edges = true;
        self.finite &= is_within(from, f64::INFINITY) & is_within(to, f64::INFINITY);
        self.areas.edge(from, to);
    }

    #[inline]
    fn ellipse(&mut self, ellipse: &Ellipse<f64>, material: Side) {
        let Ellipse {
            centre,
            across,
            along,
        } = *ellipse;
        self.finite &= is_within(centre, ELLIPSE_LIMIT)
            & is_within(across, ELLIPSE_LIMIT)
            & is_within(along, ELLIPSE_LIMIT);
        self.ellipses.add(ellipse, material);
    }

    fn ring(&mut self, points: &[Point<f64>], material: Side) {
        self.edges = true;
        for &point in points {
            self.finite &= is_within(point, f64::INFINITY);
        }
        self.areas.ring(points, material);
    }
}

/// Returns the least coverage that activates a taxel: the threshold minus the tolerance for ties. It is above 0, so
/// that a tiny threshold does not activate taxels that are not covered at all.
pub(crate) fn least(threshold: f64) -> Double {
    Real::max(Double::decimal(threshold) - Double::TIE, Double::TIE)
}

/// Removes visible rounding errors from a share of a cell: the result is never below 0 or above 1, and exactly 0, ½
/// or 1 if it is close to them.
fn share(area: f64) -> f64 {
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
