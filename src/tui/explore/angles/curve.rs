//! How a descriptor changes over the angles of a sweep: its smallest, mean and largest value over the positions at each
//! angle.
//!
//! The imprints of an angle are found by sweeping its positions again. A large grid is sampled: only every n-th angle
//! and every m-th y0 are swept, so that the plot is there within a second. Until then the tab says "computing".

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;

use crate::atlas::{Feature, mean_direction};
use crate::index::{index, wide};
use crate::pose::{Axis, PoseIndex};
use crate::sweep::SweepResult;

const MOST_ANGLES: u64 = 720;

const MOST_ROWS: u64 = 8_000;

#[derive(Clone, Debug)]
pub enum AngleSearch {
    Running,
    Found(Arc<AngleCurve>),
    /// They cannot be found.
    Failed,
}

#[derive(Clone, Debug, PartialEq)]
pub struct AngleCurve {
    pub every_angle: u64,
    pub every_row: u64,
    angles: Vec<(u64, BTreeMap<u32, u32>)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleSpread {
    pub index: u64,
    /// The angle in degrees.
    pub degrees: f64,
    pub min: Option<f64>,
    pub mean: f64,
    pub max: Option<f64>,
}

pub(in crate::tui::explore) fn zooms_of(place: PoseIndex) -> PoseIndex {
    place
        .with(Axis::X0, 0)
        .with(Axis::Y0, 0)
        .with(Axis::Angle, 0)
}

impl AngleCurve {
    pub fn of(sweep: &SweepResult, place: PoseIndex) -> Self {
        let counts = sweep.grid.counts();
        let (columns, rows, angles) = (counts[Axis::X0], counts[Axis::Y0], counts[Axis::Angle]);
        let every_angle = angles.div_ceil(MOST_ANGLES).max(1);
        let each = (MOST_ROWS / angles.div_ceil(every_angle)).max(1);
        let every_row = rows.div_ceil(each).max(1);
        let zooms = zooms_of(place);
        let found = |angle: u64| {
            let mut imprints = BTreeMap::new();
            for row in (0..rows).step_by(index(every_row)) {
                let at = zooms.with(Axis::Angle, angle);
                let end = if every_row == 1 { rows } else { row + 1 };
                for id in sweep.ids(at, 0..columns, row..end).into_iter().flatten() {
                    *imprints.entry(id).or_insert(0) += 1;
                }
                if every_row == 1 {
                    break;
                }
            }
            (angle, imprints)
        };
        let sampled: Vec<u64> = (0..angles).step_by(index(every_angle)).collect();
        Self {
            every_angle,
            every_row,
            angles: sampled.into_par_iter().map(found).collect(),
        }
    }

    /// `values` has the value of each imprint, by number.
    pub fn spread(
        &self,
        sweep: &SweepResult,
        feature: &Feature,
        values: &[Option<f64>],
    ) -> Vec<AngleSpread> {
        let range = sweep.grid.ranges()[Axis::Angle];
        let mut spread = Vec::with_capacity(self.angles.len());
        for (index, imprints) in &self.angles {
            let known = imprints
                .iter()
                .filter_map(|(&id, &count)| Some(((*values.get(wide(id))?)?, f64::from(count))));
            let known: Vec<(f64, f64)> = known.collect();
            let mean = if feature.circular {
                circular_mean(&known)
            } else {
                mean(&known, |value| value)
            };
            let Some(mean) = mean else {
                continue;
            };
            let plain = !feature.circular;
            let all = || known.iter().map(|(value, _)| *value);
            spread.push(AngleSpread {
                index: *index,
                degrees: range.value(*index),
                min: plain.then(|| all().fold(f64::INFINITY, f64::min)),
                mean,
                max: plain.then(|| all().fold(f64::NEG_INFINITY, f64::max)),
            });
        }
        spread
    }
}

fn mean(known: &[(f64, f64)], of: fn(f64) -> f64) -> Option<f64> {
    let count: f64 = known.iter().map(|(_, count)| count).sum();
    let sum: f64 = known.iter().map(|(value, count)| of(*value) * count).sum();
    (count > 0.0).then(|| sum / count)
}

/// Returns the circular mean of directions in degrees, given how often each occurs. None if there are no directions,
/// or if they cancel.
fn circular_mean(known: &[(f64, f64)]) -> Option<f64> {
    let x = mean(known, |degrees| libm::cos(degrees.to_radians()))?;
    let y = mean(known, |degrees| libm::sin(degrees.to_radians()))?;
    mean_direction(x, y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atlas::features;
    use crate::figure::{Figure, FigureKind};
    use crate::pose::{Anchor, PoseGrid, Ranges};
    use crate::sensor::Sensor;
    use crate::source::Source;
    use crate::sweep::Sweep;

    fn sweep(y0: &str, angle: &str) -> SweepResult {
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, range("5:5.9:0.1"))
            .with(Axis::Y0, range(y0))
            .with(Axis::Angle, range(angle));
        let figure = Figure::default_of(FigureKind::Rectangle, &Sensor::default());
        let grid = PoseGrid::new(
            Source::Figure(figure),
            Sensor::default(),
            Anchor::Corner,
            ranges,
        );
        Sweep::new(&grid.expect("in range")).run()
    }

    #[test]
    fn each_angle_has_the_values_of_its_positions() {
        let sweep = sweep("5:5.3:0.1", "0:80:20");
        let curve = AngleCurve::of(&sweep, PoseIndex::new([3, 2, 1, 0, 0]));
        assert_eq!((curve.every_angle, curve.every_row), (1, 1));
        for (number, feature) in features().iter().enumerate() {
            let values = sweep.atlas.values(number);
            let spread = curve.spread(&sweep, feature, &values);
            assert_eq!(spread.len(), 5, "{}", feature.key);
            for at in spread {
                let place = PoseIndex::new([0, 0, at.index, 0, 0]);
                let ids = sweep.ids(place, 0..10, 0..4);
                let own: Vec<f64> = ids.iter().filter_map(|id| values[wide((*id)?)]).collect();
                let within = |value: f64| {
                    at.min.is_none_or(|min| min <= value) && at.max.is_none_or(|max| value <= max)
                };
                assert!(own.iter().all(|&value| within(value)), "{}", feature.key);
                assert_eq!(at.min.is_none(), feature.circular);
                if !feature.circular {
                    let count = f64::from(u32::try_from(own.len()).expect("few"));
                    let mean = own.iter().sum::<f64>() / count;
                    assert!((at.mean - mean).abs() < 1e-9, "{}", feature.key);
                }
            }
        }
    }

    #[test]
    fn directions_have_a_circular_mean() {
        let mean = |known: &[(f64, f64)]| circular_mean(known).expect("a mean");
        let west = mean(&[(170.0, 1.0), (-170.0, 1.0)]);
        assert!((west.abs() - 180.0).abs() < 1e-9, "{west}");
        assert!((mean(&[(10.0, 3.0), (50.0, 0.0)]) - 10.0).abs() < 1e-9);
    }

    #[test]
    fn directions_that_cancel_have_no_mean() {
        let opposite = [(90.0, 1.0), (-90.0, 1.0)];
        let thirds = [(-110.0, 700.0), (10.0, 700.0), (130.0, 700.0)];
        assert_eq!(circular_mean(&opposite), None);
        assert_eq!(circular_mean(&thirds), None);
    }

    #[test]
    fn only_part_of_a_large_grid_is_visited() {
        let sweep = sweep("5:5.99:0.01", "0:89.9:0.1");
        let curve = AngleCurve::of(&sweep, PoseIndex::new([0; 5]));
        assert_eq!((curve.every_angle, curve.every_row), (2, 6));
        let spread = curve.spread(&sweep, &features()[0], &sweep.atlas.values(0));
        assert_eq!(spread.len(), 450);
        assert_eq!((spread[1].index, spread[449].index), (2, 898));
    }
}
