//! The range of values that the shades cover.

use crate::frame::Frame;
use crate::tui::live::reading::{LiveReading, round_up};

/// The values so far, which the fixed range covers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShadeRange {
    /// The largest value so far in round numbers, which only grows; None as long as nothing is above 0. No sensor has
    /// values of a known size: one may measure thousands of pascals, another one parts of a newton.
    top: Option<f64>,
    /// The least value that was shown, at most 0.
    bottom: f64,
    /// Whether shades are spread over the values of the frame that is shown only.
    pub(super) is_own: bool,
}

impl ShadeRange {
    /// Takes the values of a new frame.
    pub(super) fn add(&mut self, frame: &Frame) {
        let largest = frame.values().iter().copied().fold(0.0, f64::max);
        if largest > 0.0 {
            let top = round_up(largest);
            self.top = Some(self.top.map_or(top, |before| before.max(top)));
        }
    }

    /// Takes what a frame is shown as.
    pub(super) fn add_shown(&mut self, reading: &LiveReading) {
        self.bottom = self.bottom.min(reading.least);
    }

    /// The upper end of the fixed range.
    pub(super) fn top(&self) -> f64 {
        self.top.unwrap_or(1.0)
    }

    /// The ends of the range.
    pub(super) fn ends(&self, reading: Option<&LiveReading>) -> (f64, f64) {
        let largest = reading
            .and_then(|reading| reading.max)
            .map(|(largest, _)| largest);
        let least = reading.map_or(0.0, |reading| reading.least);
        match largest {
            Some(largest) if self.is_own && (largest > 0.0 || least < 0.0) => {
                (least.min(0.0), largest.max(0.0))
            }
            // What little a tare leaves below 0 is noise.
            _ if self.bottom < -self.top() / 20.0 => (-round_up(-self.bottom), self.top()),
            _ => (0.0, self.top()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_is_that_of_the_values_however_small_they_are() {
        let mut range = ShadeRange::default();
        let mut top = |value: f64| {
            let mut frame = Frame::new(2, 1);
            frame.values_mut()[0] = value;
            range.add(&frame);
            range.top()
        };
        assert_eq!([top(0.0), top(-3.0), top(f64::NAN)], [1.0, 1.0, 1.0]);
        assert_eq!([top(0.004), top(0.001)], [0.005, 0.005]);
        assert_eq!([top(30.0), top(2.0)], [50.0, 50.0]);
    }
}
