//! The results that the live page computes from the shown frame: values, imprint, descriptors.

use std::sync::Arc;

use crate::description::{Description, main_region, regions};
use crate::frame::{Frame, FrameError, Processing};
use crate::imprint::Imprint;
use crate::matrix::Matrix;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeatLayer {
    Raw,
    Tared,
    Imprint,
}

impl HeatLayer {
    pub(super) fn next(self) -> Self {
        match self {
            Self::Raw => Self::Tared,
            Self::Tared => Self::Imprint,
            Self::Imprint => Self::Raw,
        }
    }
}

impl HeatLayer {
    pub fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Tared => "tared",
            Self::Imprint => "imprint",
        }
    }
}

#[derive(Clone, Debug)]
pub struct LiveReading {
    pub frame: Arc<Frame>,
    /// The shown values; NaN if there is no cell.
    pub values: Matrix<f64>,
    pub sum: f64,
    /// The largest value before tare and gain, and its column and row; None without cells.
    pub max: Option<(f64, (u8, u8))>,
    /// The largest shown value, and its column and row; None without cells.
    pub shown_max: Option<(f64, (u8, u8))>,
    /// The largest value after tare and gain, which the threshold applies to; None without cells.
    pub tared_max: Option<f64>,
    pub least: f64,
    /// The active taxels; None without a threshold.
    pub imprint: Option<Imprint>,
    /// The active taxels of the main region; empty if there is none.
    pub main: Imprint,
    pub description: Option<Description>,
    /// The number of regions of the imprint: pieces and holes.
    pub regions: usize,
}

impl LiveReading {
    pub(super) fn of(
        frame: Arc<Frame>,
        processing: &mut Processing,
        layer: HeatLayer,
    ) -> Result<Self, FrameError> {
        let processed = processing.run(&frame)?;
        let values = match layer {
            HeatLayer::Raw => processed.raw,
            HeatLayer::Tared | HeatLayer::Imprint => processed.tared,
        };
        let imprint = processed.imprint;
        let found = imprint.as_ref().map_or_else(Vec::new, regions);
        let main = main_region(&found).and_then(|main| found.get(main));
        let empty = || Imprint::empty(values.size());
        Ok(Self {
            sum: processed.sum,
            max: largest(processed.raw),
            shown_max: largest(values),
            tared_max: largest(processed.tared).map(|(largest, _)| largest),
            least: values.values().iter().copied().fold(0.0, f64::min),
            values: values.clone(),
            imprint,
            main: main.map_or_else(empty, |region| *region.taxels()),
            description: main.map(Description::of),
            regions: found.len(),
            frame,
        })
    }
}

/// Returns the largest value with its column and row, the first one of equals; None without cells.
fn largest(values: &Matrix<f64>) -> Option<(f64, (u8, u8))> {
    let mut largest: Option<(f64, (u8, u8))> = None;
    for row in 0..values.rows() {
        for (column, &value) in (0..values.columns()).zip(values.row(row)) {
            let is_more = largest.is_none_or(|(most, _)| value > most);
            if !value.is_nan() && is_more {
                largest = Some((value, (column, row)));
            }
        }
    }
    largest
}

pub(super) fn hold(held: &mut Frame, frame: &Frame) {
    if held.size() == frame.size() {
        for (own, &other) in held.values_mut().iter_mut().zip(frame.values()) {
            *own = own.max(other);
        }
        held.number = frame.number;
        held.label = frame.label;
        held.time = frame.time;
    } else {
        held.copy_from(frame);
    }
}

pub(super) fn round_up(value: f64) -> f64 {
    if value < f64::MIN_POSITIVE || !value.is_finite() {
        return 1.0;
    }
    let unit = libm::pow(10.0, libm::log10(value).floor());
    let steps = [1.0, 2.0, 5.0, 10.0];
    let fits = steps.map(|step| step * unit).into_iter();
    // A value that rounding has made slightly too large is not rounded up again.
    let mut fits = fits.filter(|step| *step >= value * (1.0 - 1e-12));
    fits.next().map_or(10.0 * unit, nine_digits)
}

/// Rounds to nine digits, so that steps do not drift.
pub(super) fn nine_digits(value: f64) -> f64 {
    let text = format!("{value:.8e}");
    text.parse::<f64>().map_or(value, |value| value + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_end_at_round_numbers() {
        let rounded = [0.0, 0.03, 1.0, 1.2, 45.0, 100.0, 255.0, 1e300].map(round_up);
        assert_eq!(rounded, [1.0, 0.05, 1.0, 2.0, 50.0, 100.0, 500.0, 1e300]);
        assert_eq!(nine_digits(0.1 + 0.2), 0.3);
    }
}
