//! Histograms: how often the values of a feature occur, over all poses.

use crate::atlas::distinct::Atlas;
use crate::atlas::feature::Feature;

/// The number of poses in equal intervals of a value. Each interval includes its lower end; the last one includes both
/// ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// The lower end of the first interval, in the feature's own unit.
    pub start: f64,
    /// The width of an interval: 1, 2 or 5 times a power of ten, so that all ends are short decimals. For circular
    /// directions, it divides 360.
    pub width: f64,
    /// The number of poses with a value in each interval; empty if no pose has a value.
    pub poses: Vec<u64>,
    /// The number of poses without a value.
    pub without: u64,
}

/// The widths of intervals of directions, in degrees; 360 if none of them fits.
const ARCS: [f64; 12] = [
    1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0,
];

/// The largest number of intervals. The smallest width is far below the range of most features, so without this limit
/// their memory has none.
const MOST_INTERVALS: usize = 10_000;

/// The largest value, so that differences are finite.
const LARGEST: f64 = 1e300;

impl Histogram {
    /// Counts the poses of an atlas in at most `most` intervals, never more than 10,000, or in the smallest
    /// possible number. `values` are those of the feature, one per imprint ([`Atlas::values`]). If all are
    /// whole, the width is at least 1. A value that is missing, not finite or beyond ±1e300 counts as none.
    pub fn of(atlas: &Atlas, feature: &Feature, values: &[Option<f64>], most: usize) -> Self {
        let usable = |value: Option<f64>| value.filter(|value| value.abs() <= LARGEST);
        let found = || values.iter().filter_map(|&value| usable(value));
        let (low, high) = found().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let most = most.min(MOST_INTERVALS);
        let (start, width, bins) = if feature.circular {
            around(most)
        } else if low > high {
            (0.0, 1.0, 0)
        } else {
            let whole = found().all(|value| value.fract() == 0.0);
            straight(low, high, if whole { 1.0 } else { 0.0 }, most)
        };
        let mut histogram = Self {
            start,
            width,
            poses: vec![0; if low > high { 0 } else { bins }],
            without: 0,
        };
        let values = values.iter().copied().chain(std::iter::repeat(None));
        for (value, count) in values.zip(atlas.counts()) {
            let bin = usable(value).map(|value| interval(value - start, width).min(bins - 1));
            match bin {
                Some(bin) => histogram.poses[bin] += count,
                None => histogram.without += count,
            }
        }
        histogram
    }

    /// Returns the lower end of an interval, in the feature's own unit.
    #[expect(clippy::cast_precision_loss, reason = "few of them")]
    pub fn from(&self, bin: usize) -> f64 {
        self.start + self.width * bin as f64
    }

    /// Returns the number of decimals that the ends of the intervals need, at most 12.
    pub fn decimals(&self) -> usize {
        let short = |decimals: &u8| {
            let scaled = self.width * 10_f64.powi(i32::from(*decimals));
            (scaled - scaled.round()).abs() < 1e-6 && scaled.round() >= 1.0
        };
        (0..12).find(short).unwrap_or(12).into()
    }
}

/// Returns the index of the interval at a distance from the start. A value that differs from an end only by rounding
/// counts as equal to it.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
fn interval(way: f64, width: f64) -> usize {
    (way / width + 1e-9).floor().max(0.0) as usize
}

/// Returns the start, the width and the number of the intervals of a direction: all around, from −180.
fn around(most: usize) -> (f64, f64, usize) {
    let fits = |width: &&f64| interval(360.0, **width) <= most;
    let width = ARCS.iter().find(fits).copied().unwrap_or(360.0);
    (-180.0, width, interval(360.0, width))
}

/// Returns the start, the width and the number of intervals that begin at a multiple of the width, as narrow as `most`
/// allows.
fn straight(low: f64, high: f64, least: f64, most: usize) -> (f64, f64, usize) {
    // Zero is an end for every width, so a single interval cannot have values on both sides of it.
    let most = most.max(if low < 0.0 && high >= 0.0 { 2 } else { 1 });
    #[expect(clippy::cast_precision_loss, reason = "an estimate, made larger below")]
    let guess = ((high - low) / most as f64).max(least).max(1e-9);
    #[expect(clippy::cast_possible_truncation, reason = "at most a few hundred")]
    let mut exponent = if high > low || least > 0.0 {
        libm::log10(guess).floor() as i32
    } else {
        0
    };
    loop {
        for step in [1.0, 2.0, 5.0] {
            // The quotient of two whole numbers is the f64 nearest to the decimal; a product may not be.
            let width = if exponent < 0 {
                step / 10_f64.powi(-exponent)
            } else {
                step * 10_f64.powi(exponent)
            };
            let start = (low / width + 1e-9).floor() * width;
            let bins = interval(high - start, width) + 1;
            if width >= least && bins <= most {
                return (start + 0.0, width, bins);
            }
        }
        exponent += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atlas::feature::features;
    use crate::figure::{Figure, FigureKind};
    use crate::pose::{Anchor, Axis, PoseGrid, Ranges};
    use crate::sensor::Sensor;
    use crate::source::Source;
    use crate::sweep::{Sweep, SweepResult};

    fn result(x0: &str) -> SweepResult {
        let source = Source::Figure(Figure::default_of(FigureKind::Triangle, &Sensor::default()));
        let ranges = Ranges::default()
            .with(Axis::X0, x0.parse().expect("a range"))
            .with(Axis::Y0, "5:5.9:0.1".parse().expect("a range"))
            .with(Axis::Angle, "0:350:10".parse().expect("a range"));
        let grid = PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges);
        Sweep::new(&grid.expect("in range")).run()
    }

    /// Every pose is in one interval or has no value, and each interval has the poses whose values lie in it.
    #[test]
    fn every_pose_is_counted_in_the_interval_of_its_value() {
        let result = result("-5:15:0.5");
        for (index, feature) in features().iter().enumerate() {
            let values = result.atlas.values(index);
            for most in [1, 2, 7, 15, 100] {
                let histogram = Histogram::of(&result.atlas, feature, &values, most);
                let poses: u64 = histogram.poses.iter().sum();
                assert_eq!(poses + histogram.without, result.poses, "{}", feature.key);
                assert_eq!(poses, result.statistics[index].poses, "{}", feature.key);
                assert!(
                    (1..=most).contains(&histogram.poses.len()),
                    "{}",
                    feature.key
                );
                let counts: Vec<u64> = result.atlas.counts().collect();
                for (bin, &poses) in histogram.poses.iter().enumerate() {
                    let (from, to) = (histogram.from(bin), histogram.from(bin + 1));
                    let last = bin + 1 == histogram.poses.len();
                    let inside = |value: &Option<f64>| {
                        value.is_some_and(|value| {
                            value >= from - 1e-7 && (value < to - 1e-7 || last && value <= to)
                        })
                    };
                    let expected = values.iter().zip(&counts);
                    let expected = expected.filter(|(value, _)| inside(value));
                    let expected: u64 = expected.map(|(_, count)| count).sum();
                    assert_eq!(poses, expected, "{} from {from}", feature.key);
                }
            }
        }
    }

    #[test]
    fn any_number_of_intervals_may_be_allowed() {
        let result = result("5");
        for (index, feature) in features().iter().enumerate() {
            let values = result.atlas.values(index);
            let histogram = Histogram::of(&result.atlas, feature, &values, usize::MAX);
            assert!(histogram.poses.len() <= MOST_INTERVALS, "{}", feature.key);
            let poses = histogram.poses.iter().sum::<u64>() + histogram.without;
            assert_eq!(poses, result.poses, "{}", feature.key);
        }
    }

    #[test]
    fn values_that_are_missing_or_no_numbers_are_counted_as_none() {
        let result = result("5");
        let (atlas, feature) = (&result.atlas, &features()[0]);
        let counts: Vec<u64> = atlas.counts().collect();
        let strange = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX];
        for strange in strange {
            let histogram = Histogram::of(atlas, feature, &[Some(strange), Some(2.0)], 10);
            assert_eq!((histogram.start, histogram.poses), (2.0, vec![counts[1]]));
            assert_eq!(histogram.without, result.poses - counts[1], "{strange}");
        }
    }

    #[test]
    fn ends_are_short_decimals() {
        for (low, high, least, most, expected) in [
            (10.0, 14.0, 1.0, 15, (10.0, 1.0, 5)),
            (10.0, 400.0, 1.0, 15, (0.0, 50.0, 9)),
            (0.3, 0.9, 0.0, 7, (0.3, 0.1, 7)),
            (0.3, 0.9, 0.0, 6, (0.2, 0.2, 4)),
            (5.0, 5.0, 0.0, 15, (5.0, 1.0, 1)),
            (5.0, 5.0, 1.0, 1, (5.0, 1.0, 1)),
            (-3.0, 3.0, 0.0, 1, (-5.0, 5.0, 2)),
        ] {
            let (start, width, bins) = straight(low, high, least, most);
            assert!(
                (start - expected.0).abs() < 1e-12 && width == expected.1,
                "{start} {width}"
            );
            assert_eq!(bins, expected.2);
        }
        let decimals = |width| {
            let histogram = Histogram {
                start: 0.0,
                width,
                poses: Vec::new(),
                without: 0,
            };
            histogram.decimals()
        };
        assert_eq!([50.0, 1.0, 0.5, 0.02, 0.001].map(decimals), [0, 0, 1, 2, 3]);
        assert_eq!(
            (around(15), around(40), around(1)),
            ((-180.0, 30.0, 12), (-180.0, 10.0, 36), (-180.0, 360.0, 1))
        );
    }

    #[test]
    fn empty_imprints_are_counted_as_without_a_value() {
        let source = Source::Figure(Figure::default_of(FigureKind::Triangle, &Sensor::default()));
        let ranges = Ranges::default()
            .with(Axis::X0, "-16".parse().expect("a range"))
            .with(Axis::Y0, "-16".parse().expect("a range"));
        let grid = PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges);
        let result = Sweep::new(&grid.expect("in range")).run();
        for (index, feature) in features().iter().enumerate() {
            let histogram = Histogram::of(&result.atlas, feature, &result.atlas.values(index), 15);
            let empty = result.statistics[index].poses == 0;
            assert_eq!(histogram.poses.is_empty(), empty, "{}", feature.key);
            assert_eq!(histogram.without, if empty { 360 } else { 0 });
        }
    }
}
