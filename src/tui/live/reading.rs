//! The results that the live page computes from the shown frame: values, imprint, descriptors.

use std::sync::Arc;

use taxel_core::description::{Description, main_region, regions};
use taxel_core::frame::{Frame, FrameError, Processing};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;

use crate::frames::sensor;
use crate::tui::app::Document;
use crate::tui::live::Live;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeatLayer {
    Raw,
    Tared,
    Imprint,
}

impl HeatLayer {
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::Raw => Self::Tared,
            Self::Tared => Self::Imprint,
            Self::Imprint => Self::Raw,
        }
    }

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
    /// The sum of the values before tare and gain.
    pub sum: f64,
    pub force: f64,
    pub contact: u32,
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
    pub fn of(
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
            force: processed.force,
            contact: processed.contact,
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

pub fn round_up(value: f64) -> f64 {
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
pub fn nine_digits(value: f64) -> f64 {
    let text = format!("{value:.8e}");
    text.parse::<f64>().map_or(value, |value| value + 0.0)
}

/// The span of the values so far, which the fixed range covers.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShadeRange {
    raw: Span,
    tared: Span,
    pub is_own: bool,
}

/// The span of some values; it only grows.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    /// The largest value, rounded up to a round number; 0 as long as no value is above it. The size of values depends on
    /// the sensor: one may measure thousands of pascals, another one fractions of a newton.
    top: f64,
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
            self.top = self.top.max(round_up(largest));
        }
    }

    /// Returns the upper end of the fixed range; 1 as long as no value is above 0.
    fn top(&self) -> f64 {
        if self.top > 0.0 { self.top } else { 1.0 }
    }
}

impl ShadeRange {
    pub fn add(&mut self, [raw, tared]: [&Matrix<f64>; 2]) {
        self.raw.add(raw);
        self.tared.add(tared);
    }

    /// Forgets the values so far, since another tare is subtracted now.
    pub fn begin_anew(&mut self) {
        (self.raw, self.tared) = (Span::default(), Span::default());
    }

    /// Returns the largest value so far after tare and gain, rounded up to a round number. Thresholds depend on these
    /// values.
    pub fn tared_top(&self) -> f64 {
        self.tared.top()
    }

    /// Returns the values at both ends of the shades. After a tare, 0 is the lower end, so that a pad at rest is drawn
    /// empty, whatever noise the tare has left.
    pub fn ends(&self, layer: HeatLayer, reading: Option<&LiveReading>, tared: bool) -> (f64, f64) {
        let largest = reading.and_then(|reading| Some(reading.shown_max?.0));
        let least = reading.map_or(0.0, |reading| reading.least);
        let span = match layer {
            HeatLayer::Raw => self.raw,
            HeatLayer::Tared | HeatLayer::Imprint => self.tared,
        };
        let (low, high) = match largest {
            Some(largest) if self.is_own && (largest > 0.0 || least < 0.0) => {
                (least, largest.max(0.0))
            }
            // Values a little below 0 are noise.
            _ if span.bottom < -span.top() / 20.0 => (-round_up(-span.bottom), span.top()),
            _ => (0.0, span.top()),
        };
        let is_tared = tared && layer != HeatLayer::Raw && high > 0.0;
        (if is_tared { 0.0 } else { low }, high)
    }
}

/// Returns the shown imprint as a drawn one; None without one. The sensor has the size of the frame, and its pitch in
/// mm if that is known and cells are square; otherwise the default pitch is kept, with which lengths are shown in
/// taxels only.
pub fn document(page: &Live) -> Option<Document> {
    let imprint = page.reading.as_ref()?.imprint?;
    let sensor = sensor(&imprint, page.status.channel.square_pitch_mm());
    Some(Document::drawn(sensor, imprint))
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
