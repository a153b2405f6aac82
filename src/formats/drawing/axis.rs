//! The marks of an axis: round numbers, not too many of them.

/// The largest number of steps between marks.
const STEPS: f64 = 8.0;

/// Where the marks of an axis stand, in its unit, with their labels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks(pub(super) Vec<(f64, String)>);

impl Ticks {
    /// Ticks from 0 to `length`, at steps of 1, 2 or 5 times a power of ten, none smaller than `least`.
    pub(super) fn new(length: f64, least: f64) -> Self {
        let smallest = (length / STEPS).max(least);
        let power = 10_f64.powf(smallest.log10().floor());
        // A hair is allowed for the roundings of the logarithm.
        let fits = |factor: &f64| factor * power >= smallest * (1.0 - 1e-9);
        let factor = [1.0, 2.0, 5.0].into_iter().find(fits).unwrap_or(10.0);
        let step = factor * power;
        let decimals = (1..=12_u8).find(|&n| step * 10_f64.powi(n.into()) >= 10.0 * (1.0 - 1e-9));
        let decimals = usize::from(decimals.map_or(12, |n| n - 1));
        let place = |index: u32| f64::from(index) * step;
        let last = length * (1.0 + 1e-9);
        let places = (0..=10).map(place).take_while(|&place| place <= last);
        Self(
            places
                .map(|place| (place, format!("{place:.decimals$}")))
                .collect(),
        )
    }

    /// The longest label, in characters.
    pub(super) fn width(&self) -> usize {
        let widths = self.0.iter().map(|(_, label)| label.chars().count());
        widths.max().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(length: f64, least: f64) -> Vec<String> {
        let Ticks(marks) = Ticks::new(length, least);
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
