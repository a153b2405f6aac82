//! One touch: a shape on a sensor gives the coverage of every taxel and the imprint.
//!
//! **The rule** (the paper's "50 %"): a taxel is active when the shape covers at least the threshold share of its
//! cell. What reaches beyond the sensor is cut off.
//!
//! **Exactly the threshold is active**, in real arithmetic, for the decimals that the user wrote. Coverages are
//! computed in `f64` first, with an error below 1e-11 ([`crate::geometry::cell_area`]). One that lies within 1e-10 of
//! the threshold is computed again with 32 digits ([`Double`]), and is active unless it falls short by more than 1e-20
//! ([`Real::TIE`]).
//!
//! Whether two algebraic expressions of the input are *equal* cannot be decided by any number of digits: what falls
//! short by less than 1e-20 is taken for a tie. For an upright rectangle whose numbers have at most nine decimals that
//! is exact, since its coverages are multiples of 1e-18; with more decimals a coverage can come nearer than 1e-20
//! (0.9999999999 × 0.50000000005). Turned figures of hundredths come within 3e-11.

use crate::geometry::{Double, Extent, Overlap, Real, Solid, cell_area, row_areas};
use crate::imprint::Imprint;
use crate::sensor::Sensor;

/// A coverage this near to the threshold is decided with more digits, of every shape of the program; a share of a cell.
pub(crate) const DOUBTFUL: f64 = 1e-10;
/// Outlines of one's own may reach further: roundings grow with the numbers that they are roundings of.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// The sensory plane: a sensor that can be touched again and again without allocating, unless a coverage is in doubt.
///
/// ```
/// use taxel::prelude::*;
/// let mut plane = Plane::new(Sensor::default());
/// let rectangle = Figure::rectangle(6.0, 3.0).at(4.0, 4.0).on(plane.sensor())?;
/// let imprint = plane.touch(&rectangle);
/// assert_eq!(imprint.count(), 6 * 3);
/// assert_eq!(plane.coverage(4, 4), 1.0);
/// # Ok::<(), ParameterError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Plane {
    sensor: Sensor,
    areas: Overlap<f64>,
}

impl Plane {
    /// The plane of a sensor, untouched.
    pub fn new(sensor: Sensor) -> Self {
        Self {
            sensor,
            areas: Overlap::new(sensor.columns(), sensor.rows()),
        }
    }

    /// The sensor.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// The imprint that a shape leaves. Total: a shape without a boundary leaves none.
    pub fn touch(&mut self, solid: &impl Solid) -> Imprint {
        self.areas.clear();
        solid.draw(&mut self.areas);
        let mut imprint = Imprint::empty(self.sensor.columns(), self.sensor.rows());
        self.activate(solid, &mut imprint);
        imprint
    }

    /// Activates the taxels that are covered enough.
    fn activate(&self, solid: &impl Solid, imprint: &mut Imprint) {
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
            // The sign of what a cell has too little is its bit. Bits come in from the left: after the last one they
            // stand `unused` places too high.
            let (mut short, mut nearest) = ([0_u64; 2], [f64::MAX; 2]);
            for excess in areas.pair(pair, &columns, threshold) {
                for lane in 0..2 {
                    short[lane] = short[lane] >> 1 | excess[lane].to_bits() & 1 << 63;
                    nearest[lane] = Real::min(Real::abs(excess[lane]), nearest[lane]);
                }
            }
            let mut active = short.map(|short| (!short >> unused) << first);
            if Real::min(nearest[0], nearest[1]) < doubt {
                for lane in 0..2 {
                    if nearest[lane] < doubt {
                        active[lane] = self.decide(solid, 2 * pair + lane, active[lane]);
                    }
                }
            }
            imprint.set_pair(pair, active);
        }
    }

    /// How near to the threshold a coverage of the last touch is in doubt.
    fn doubt(&self) -> f64 {
        DOUBTFUL.max(ROUNDINGS * self.areas.grid().magnitude())
    }

    /// The active taxels of a row, those in doubt computed again.
    #[cold]
    fn decide(&self, solid: &impl Solid, row: usize, mut active: u64) -> u64 {
        let (threshold, doubt) = (self.sensor.threshold(), self.doubt());
        let least = least(threshold);
        let areas = self.areas.grid();
        let columns = areas.columns();
        // Cells next to each other that no boundary seems to cross, as full ones at a threshold of 1, are decided by
        // one drawing of their row. Their areas need not be the same: an edge that is horizontal up to a rounding of
        // `f64` has a height in more digits.
        let mut open = None;
        let mut whole: Option<Vec<Double>> = None;
        for (column, area) in columns.clone().zip(areas.row(row, &columns)) {
            if (area - threshold).abs() >= doubt {
                continue;
            }
            let (Ok(cell_column), Ok(cell_row)) = (u8::try_from(column), u8::try_from(row)) else {
                continue;
            };
            let is_open = !areas.crosses(row, column);
            let after_open = open.is_some_and(|last: usize| last + 1 == column);
            if is_open && after_open && whole.is_none() {
                whole = Some(row_areas(solid, self.sensor.columns(), cell_row));
            }
            open = is_open.then_some(column);
            let area = match &whole {
                Some(areas) => areas[column],
                None => cell_area(solid, cell_column, cell_row),
            };
            active = active & !(1 << column) | u64::from(area >= least) << column;
        }
        active
    }

    /// How much of a taxel's cell the shape of the last touch covers, 0 to 1; of one beyond the sensor, 0.
    pub fn coverage(&self, column: u8, row: u8) -> f64 {
        let (column, row) = (usize::from(column), usize::from(row));
        let areas = self.areas.grid();
        let columns = areas.columns();
        if !areas.rows().contains(&row) || !columns.contains(&column) {
            return 0.0;
        }
        let area = areas.row(row, &columns).nth(column - columns.start);
        area.map_or(0.0, share)
    }

    /// All coverages of the last touch in reading order, each 0 to 1.
    pub fn coverages(&self) -> Vec<f64> {
        let width = usize::from(self.sensor.columns());
        let mut all = vec![0.0; width * usize::from(self.sensor.rows())];
        let areas = self.areas.grid();
        let columns = areas.columns();
        // A shape beside the sensor has no columns.
        if columns.is_empty() {
            return all;
        }
        for row in areas.rows() {
            let cells = &mut all[row * width..][columns.clone()];
            for (cell, area) in cells.iter_mut().zip(areas.row(row, &columns)) {
                *cell = share(area);
            }
        }
        all
    }
}

/// The least coverage that activates a taxel: the threshold, short of a tie; and more than nothing, so that a threshold
/// below a tie does not activate what is not covered at all.
pub(crate) fn least(threshold: f64) -> Double {
    Real::max(Double::decimal(threshold) - Double::TIE, Double::TIE)
}

/// A share of a cell without the roundings that show: never below 0 or above 1, and 0, ½ and 1 just these.
fn share(area: f64) -> f64 {
    let near = (area * 2.0).round() / 2.0;
    let area = if (area - near).abs() < f64::TIE {
        near
    } else {
        area
    };
    // A negative zero would be printed as such; `max` may keep it, the sum does not.
    area.clamp(0.0, 1.0) + 0.0
}

/// Whether a shape reaches beyond the sensor, by more than a rounding.
pub fn reaches_beyond(solid: &impl Solid, sensor: &Sensor) -> bool {
    Extent::of(solid).is_some_and(|extent| {
        let beyond =
            |low: f64, high: f64, side: u8| low < -DOUBTFUL || high > f64::from(side) + DOUBTFUL;
        beyond(extent.left, extent.right, sensor.columns())
            || beyond(extent.top, extent.bottom, sensor.rows())
    })
}
