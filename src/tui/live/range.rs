//! The range of values that the shades cover.

use crate::matrix::Matrix;
use crate::tui::live::reading::{HeatLayer, LiveReading, round_up};

/// The span of the values so far, which the fixed range covers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShadeRange {
    raw: Span,
    tared: Span,
    pub(super) is_own: bool,
}

/// The span of some values; it only grows.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    /// The largest value, rounded up to a round number; None as long as no value is above 0. The size of values
    /// depends on the sensor: one may measure thousands of pascals, another one fractions of a newton.
    top: Option<f64>,
    bottom: f64,
}

impl Span {
    fn add(&mut self, values: &Matrix<f64>) {
        let values = values.values().iter().copied();
        let (least, largest) = values.fold((0.0, 0.0), |(least, largest): (f64, f64), value| {
            (least.min(value), largest.max(value))
        });
        self.bottom = self.bottom.min(least);
        if largest > 0.0 {
            let top = round_up(largest);
            self.top = Some(self.top.map_or(top, |before| before.max(top)));
        }
    }

    /// Returns the upper end of the fixed range; 1 as long as no value is above 0.
    fn top(&self) -> f64 {
        self.top.unwrap_or(1.0)
    }
}

impl ShadeRange {
    pub(super) fn add(&mut self, [raw, tared]: [&Matrix<f64>; 2]) {
        self.raw.add(raw);
        self.tared.add(tared);
    }

    /// Forgets the values so far, since another tare is subtracted now.
    pub(super) fn begin_anew(&mut self) {
        (self.raw, self.tared) = (Span::default(), Span::default());
    }

    /// Returns the largest value so far after tare and gain, rounded up to a round number. Thresholds depend on these
    /// values.
    pub(super) fn tared_top(&self) -> f64 {
        self.tared.top()
    }

    pub(super) fn ends(&self, layer: HeatLayer, reading: Option<&LiveReading>) -> (f64, f64) {
        let largest = reading
            .and_then(|reading| reading.shown_max)
            .map(|(largest, _)| largest);
        let least = reading.map_or(0.0, |reading| reading.least);
        let span = match layer {
            HeatLayer::Raw => self.raw,
            HeatLayer::Tared | HeatLayer::Imprint => self.tared,
        };
        match largest {
            Some(largest) if self.is_own && (largest > 0.0 || least < 0.0) => {
                (least.min(0.0), largest.max(0.0))
            }
            // Values a little below 0 are noise that the tare has left.
            _ if span.bottom < -span.top() / 20.0 => (-round_up(-span.bottom), span.top()),
            _ => (0.0, span.top()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::MatrixSize;

    #[test]
    fn the_top_follows_the_values_even_if_they_are_small() {
        let mut range = ShadeRange::default();
        let mut top = |value: f64| {
            let [raw, tared] = [10.0 * value, value].map(|value| {
                Matrix::filled(MatrixSize::new(2, 1).expect("an allowed size"), value)
            });
            range.add([&raw, &tared]);
            range.tared_top()
        };
        assert_eq!([top(0.0), top(-3.0), top(f64::NAN)], [1.0, 1.0, 1.0]);
        assert_eq!([top(0.004), top(0.001)], [0.005, 0.005]);
        assert_eq!([top(30.0), top(2.0)], [50.0, 50.0]);
        let ends = [HeatLayer::Raw, HeatLayer::Tared].map(|layer| range.ends(layer, None));
        assert_eq!(ends, [(-50.0, 500.0), (-5.0, 50.0)]);
        range.begin_anew();
        assert_eq!(range.ends(HeatLayer::Raw, None), (0.0, 1.0));
    }
}
