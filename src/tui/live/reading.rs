//! The results that the live page computes from the shown frame: values, imprint, descriptors; and the threshold, as keys
//! change it.

use std::sync::Arc;

use taxel_core::description::{Description, main_region, regions};
use taxel_core::frame::{Frame, FrameError, Processing, Rule};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_files::formats::value::{counted, fitting, measured};

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

/// Formats how many frames have come for a tare, and how many it needs: `3 of 30 frames`.
pub(super) fn progress_text((taken, wanted): (u64, u64)) -> String {
    format!("{taken} of {}", counted(wanted, "frame"))
}

pub(super) fn rule_text(rule: Rule, unit: &str) -> String {
    match rule {
        Rule::AtLeast(threshold) => format!("{}{unit}", measured(threshold, 7)),
        Rule::Percent(percent) => format!("{} % of max", fitting(percent, 5)),
        Rule::Hysteresis { low, high } => {
            format!("{} to {}{unit}", measured(low, 7), measured(high, 7))
        }
        Rule::Noise(deviations) => format!("{} × noise", fitting(deviations, 5)),
    }
}

/// Moves the threshold up or down by a step: a hundredth of the top of the range, in round numbers. In percent the
/// step is 5 %, in deviations of the noise it is 1. Without a threshold, it becomes half of the top of the range: above
/// the noise of most sensors, and below most touches.
pub(super) fn stepped_rule(
    rule: Option<Rule>,
    direction: i8,
    top: f64,
) -> Result<Rule, FrameError> {
    let by = f64::from(direction);
    let step = round_up(top / 100.0) * by;
    match rule {
        None => Rule::at_least(nine_digits(top / 2.0)),
        Some(Rule::Percent(percent)) => Rule::percent(stepped(percent, 5.0 * by, (5.0, 100.0))),
        Some(Rule::Hysteresis { low, high }) => {
            Rule::hysteresis(nine_digits(low + step), nine_digits(high + step))
        }
        Some(Rule::Noise(deviations)) => Rule::noise(stepped(deviations, by, (1.0, 1000.0))),
        Some(Rule::AtLeast(threshold)) => Rule::at_least(nine_digits(threshold + step)),
    }
}

/// Returns a value after a step within bounds. A value already beyond a bound stays if the step would lead further
/// away: a step down never goes up, and a step up never down.
fn stepped(value: f64, step: f64, (least, most): (f64, f64)) -> f64 {
    let next = value + step;
    if step < 0.0 {
        next.max(least).min(value)
    } else {
        next.min(most).max(value)
    }
}

pub(super) fn other_unit(rule: Option<Rule>, largest: f64) -> Result<Rule, FrameError> {
    match rule {
        Some(Rule::Percent(percent)) => {
            Rule::at_least(nine_digits(Rule::percent_of(percent, largest)))
        }
        Some(Rule::AtLeast(threshold)) => {
            Rule::percent((100.0 * threshold / largest).round().clamp(1.0, 100.0))
        }
        _ => Rule::percent(50.0),
    }
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

    #[test]
    fn a_step_never_goes_the_other_way() {
        let percent = |value, direction| stepped_rule(Some(Rule::Percent(value)), direction, 1.0);
        for (before, direction, after) in [
            (3.0, -1, 3.0),
            (3.0, 1, 8.0),
            (7.0, -1, 5.0),
            (98.0, 1, 100.0),
            (50.0, -1, 45.0),
            (100.0, 1, 100.0),
        ] {
            assert_eq!(percent(before, direction), Ok(Rule::Percent(after)));
        }
        let noise = |value, direction| stepped_rule(Some(Rule::Noise(value)), direction, 1.0);
        assert_eq!(noise(0.5, -1), Ok(Rule::Noise(0.5)));
        assert_eq!(noise(0.5, 1), Ok(Rule::Noise(1.5)));
        assert_eq!(noise(2.0, -1), Ok(Rule::Noise(1.0)));
    }
}
