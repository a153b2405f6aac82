//! The marks of an axis: round numbers, and not too many of them.

/// The most steps between the first and the last mark.
const STEPS: f64 = 8.0;

/// The marks of an axis: their places in its unit, and their labels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks(pub(super) Vec<(f64, String)>);

impl Ticks {
    /// Makes marks from one number to another, at steps of 1, 2 or 5 times a power of ten, none smaller than
    /// `least`; at most about eight steps.
    pub(super) fn new(ends: (f64, f64), least: f64) -> Self {
        Self::between(ends, least, STEPS)
    }

    /// Makes such marks, at most about `steps` of them.
    pub(super) fn between((low, high): (f64, f64), least: f64, steps: f64) -> Self {
        let smallest = ((high - low) / steps).max(least);
        let power = libm::pow(10.0, libm::log10(smallest).floor());
        // A small tolerance absorbs the rounding of the logarithm.
        let fits = |factor: &f64| factor * power >= smallest * (1.0 - 1e-9);
        let factor = [1.0, 2.0, 5.0].into_iter().find(fits).unwrap_or(10.0);
        let step = factor * power;
        let decimals = (1..=12_u8).find(|&n| step * 10_f64.powi(n.into()) >= 10.0 * (1.0 - 1e-9));
        let decimals = usize::from(decimals.map_or(12, |n| n - 1));
        let first = (low / step - 1e-9).ceil();
        // Adding 0.0 turns a negative zero into a positive one.
        let place = |index: u32| (first + f64::from(index)) * step + 0.0;
        let last = high + (high - low) * 1e-9;
        let places = (0..=10).map(place).take_while(|&place| place <= last);
        Self(
            places
                .map(|place| (place, format!("{place:.decimals$}")))
                .collect(),
        )
    }

    /// Returns the number of characters of the longest label.
    pub(super) fn width(&self) -> usize {
        let widths = self.0.iter().map(|(_, label)| label.chars().count());
        widths.max().unwrap_or(0)
    }
}

/// Returns the marks of an axis between two ends, each with its label: at most about `steps` of them.
pub fn axis_marks(ends: (f64, f64), steps: u16) -> Vec<(f64, String)> {
    let steps = f64::from(steps.max(1));
    Ticks::between(ends, 0.0, steps).0
}

/// Returns the ends of an axis for some values: a little beyond the smallest and the largest, so that no point lies
/// on the frame. Without a finite value they are 0 and 1.
pub fn axis_ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let nothing = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold(nothing, |ends, value| {
            (ends.0.min(value), ends.1.max(value))
        });
    if low > high {
        return (0.0, 1.0);
    }
    // The digits of the numbers do not show differences below a billionth of their size.
    let least = low.abs().max(high.abs()).max(1e-6) * 1e-9;
    let beyond = if high - low > least {
        (high - low) * 0.04
    } else {
        high.abs().max(1.0) * 0.1
    };
    (low - beyond, high + beyond)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_may_begin_anywhere() {
        let labels = |low, high, steps| {
            let marks = axis_marks((low, high), steps);
            let labels: Vec<String> = marks.into_iter().map(|(_, label)| label).collect();
            labels.join(" ")
        };
        assert_eq!(labels(-190.0, 190.0, 4), "-100 0 100");
        assert_eq!(
            labels(41.7, 43.2, 8),
            "41.8 42.0 42.2 42.4 42.6 42.8 43.0 43.2"
        );
        assert_eq!(labels(-0.02, 0.02, 4), "-0.02 -0.01 0.00 0.01 0.02");
        let ends = |values: &[f64]| axis_ends(values.iter().copied());
        assert_eq!(ends(&[]), (0.0, 1.0));
        assert_eq!(ends(&[f64::NAN]), (0.0, 1.0));
        assert_eq!(ends(&[20.0, 20.0]), (18.0, 22.0));
        assert_eq!(ends(&[0.0]), (-0.1, 0.1));
        assert_eq!(ends(&[0.0, 100.0]), (-4.0, 104.0));
        for (low, high) in [(1e12, 1e12 + 1.0), (-1e300, 1e300), (0.0, 1e-300)] {
            let (low, high) = ends(&[low, high]);
            assert!(
                low < high && axis_marks((low, high), 8).len() <= 11,
                "{low} {high}"
            );
        }
    }

    fn labels(length: f64, least: f64) -> Vec<String> {
        let Ticks(marks) = Ticks::new((0.0, length), least);
        marks.into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn marks_are_round_and_few() {
        let pairs = "0 2 4 6 8 10 12 14 16";
        assert_eq!(labels(16.0, 1.0).join(" "), pairs);
        assert_eq!(labels(1.0, 1.0), ["0", "1"]);
        assert_eq!(labels(64.0, 1.0).join(" "), "0 10 20 30 40 50 60");
        assert_eq!(labels(40.0, 0.0).join(" "), "0 5 10 15 20 25 30 35 40");
        assert_eq!(
            labels(1.6, 0.0).join(" "),
            "0.0 0.2 0.4 0.6 0.8 1.0 1.2 1.4 1.6"
        );
        assert_eq!(
            labels(0.001, 0.0).last().map(String::as_str),
            Some("0.0010")
        );
        for length in [1e-6, 3.7e-3, 0.9, 17.0, 640.0, 6.4e6, 1e12] {
            let labels = labels(length, 0.0);
            assert!((3..=9).contains(&labels.len()), "{length}: {labels:?}");
            let mut different = labels.clone();
            different.dedup();
            assert_eq!(different, labels);
        }
    }
}
