//! The settings of real sensors: the tables `[source]` and `[frames]` of the settings file.
//!
//! Flags of `taxel watch` and `taxel frames` override them. On the screen, `:watch SOURCE` starts with them.

use std::fmt;
use std::ops::RangeInclusive;

use taxel_core::frame::{FrameSize, LARGEST_VALUE, Processing, Rule, RuleOrigin, SetRule};
use taxel_files::acquire::AcquireOptions;
use taxel_files::formats::recording::Format;

use crate::frames::{HISTORY_BYTES, Pipeline, WatchRequest};

fn fill<T, U: TryFrom<T>>(value: T, field: &mut Option<U>) -> bool {
    *field = U::try_from(value).ok();
    field.is_some()
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SensorKey {
    Format,
    Baud,
    Rows,
    Columns,
    AtLeast,
    Percent,
    Low,
    High,
    Least,
    Tare,
    HistoryBytes,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FormatSetting(pub(crate) Option<&'static Format>);

impl fmt::Display for FormatSetting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:?}",
            self.0.and_then(|format| format.stream).unwrap_or("auto")
        )
    }
}

type Fill<T> = fn(&mut SensorSettings, T) -> bool;

#[derive(Clone, Copy, Debug)]
pub(crate) enum SettingKind {
    Format {
        fill: Fill<FormatSetting>,
    },
    Whole {
        least: u64,
        most: u64,
        fill: Fill<u64>,
    },
    Number {
        least: f64,
        most: f64,
        fill: Fill<f64>,
    },
    /// A share above 0 %.
    Percent {
        fill: Fill<f64>,
    },
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct SensorSetting {
    pub(crate) key: SensorKey,
    pub(crate) table: &'static str,
    pub(crate) name: &'static str,
    pub(crate) kind: SettingKind,
    shown: fn(&SensorSettings) -> Option<String>,
}

pub(crate) const TABLES: [&str; 2] = ["source", "frames"];

pub(crate) const LEAST: RangeInclusive<u32> = 1..=4096;

const MOST_HISTORY_BYTES: u64 = {
    let (most, addressable) = (1 << 40, usize::MAX as u64);
    if most < addressable {
        most
    } else {
        addressable
    }
};

pub(crate) const SENSOR_SETTINGS: [SensorSetting; 11] = {
    macro_rules! row {
        ($table:literal, $key:ident, $field:ident, $kind:ident $(, $least:expr, $most:expr)?) => {
            SensorSetting {
                key: SensorKey::$key,
                table: $table,
                name: stringify!($field),
                kind: SettingKind::$kind {
                    $(least: $least, most: $most,)?
                    fill: |own, value| fill(value, &mut own.$field),
                },
                shown: |own| own.$field.map(|value| value.to_string()),
            }
        };
    }
    let (side, most_side) = (
        *FrameSize::SIDES.start() as u64,
        *FrameSize::SIDES.end() as u64,
    );
    let (least, most_least) = (*LEAST.start() as u64, *LEAST.end() as u64);
    let bauds = &AcquireOptions::BAUDS;
    let (baud, most_baud) = (*bauds.start() as u64, *bauds.end() as u64);
    [
        row!("source", Format, format, Format),
        row!("source", Baud, baud, Whole, baud, most_baud),
        row!("source", Rows, rows, Whole, side, most_side),
        row!("source", Columns, columns, Whole, side, most_side),
        row!(
            "frames",
            AtLeast,
            at_least,
            Number,
            -LARGEST_VALUE,
            LARGEST_VALUE
        ),
        row!("frames", Percent, percent, Percent),
        row!("frames", Low, low, Number, -LARGEST_VALUE, LARGEST_VALUE),
        row!("frames", High, high, Number, -LARGEST_VALUE, LARGEST_VALUE),
        row!("frames", Least, least, Whole, least, most_least),
        row!("frames", Tare, tare, Whole, 0, 1_000_000),
        row!(
            "frames",
            HistoryBytes,
            history_bytes,
            Whole,
            1 << 16,
            MOST_HISTORY_BYTES
        ),
    ]
};

impl SettingKind {
    pub(crate) fn expected(self) -> String {
        match self {
            Self::Format { .. } => {
                let names = Format::of_streams().map(|(name, _)| format!("{name:?}"));
                format!("one of \"auto\", {}", names.collect::<Vec<_>>().join(", "))
            }
            Self::Whole { least, most, .. } => format!("a whole number from {least} to {most}"),
            Self::Number { least, most, .. } => format!("a number from {least:?} to {most:?}"),
            Self::Percent { .. } => "a number above 0, up to 100".to_owned(),
        }
    }

    pub(crate) fn fill(self, settings: &mut SensorSettings, number: f64) -> bool {
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the limits are below 2^53, and the number is whole and between them"
        )]
        match self {
            Self::Format { .. } => false,
            Self::Whole { least, most, fill } => {
                let range = least as f64..=most as f64;
                number.fract() == 0.0 && range.contains(&number) && fill(settings, number as u64)
            }
            Self::Number { least, most, fill } => {
                (least..=most).contains(&number) && fill(settings, number)
            }
            Self::Percent { fill } => Rule::percent(number).is_ok() && fill(settings, number),
        }
    }
}

#[derive(Clone, Debug, Default)]
pub(crate) struct SensorSettings {
    format: Option<FormatSetting>,
    baud: Option<u32>,
    rows: Option<u16>,
    columns: Option<u16>,
    at_least: Option<f64>,
    percent: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    least: Option<u32>,
    tare: Option<u64>,
    history_bytes: Option<usize>,
}

impl SensorSettings {
    fn is_set(&self, key: SensorKey) -> bool {
        let mut rows = SENSOR_SETTINGS.iter();
        rows.any(|row| row.key == key && (row.shown)(self).is_some())
    }

    fn low_and_high(&self) -> Option<(f64, f64)> {
        self.low.zip(self.high)
    }

    /// Returns the first key that conflicts with the others or lacks one, what was expected, and the key with which it
    /// conflicts, if there is one.
    pub(crate) fn conflict(&self) -> Option<(SensorKey, &'static str, Option<SensorKey>)> {
        let has = |key: SensorKey| self.is_set(key);
        let pair = |one: SensorKey, other: SensorKey, why| {
            let found = [(one, other), (other, one)].into_iter();
            let mut lone = found.filter(|&(own, other)| has(own) && !has(other));
            lone.next().map(|(own, _)| (own, why, None))
        };
        let rules = [SensorKey::AtLeast, SensorKey::Percent, SensorKey::Low];
        let mut given = rules.into_iter().filter(|&key| has(key));
        let two = given.next().zip(given.next());
        let rule = || {
            let why = "one threshold: at_least, percent, or low and high";
            two.map(|(first, second)| (second, why, Some(first)))
        };
        let order = || self.low_and_high().is_some_and(|(low, high)| low > high);
        pair(
            SensorKey::Rows,
            SensorKey::Columns,
            "rows and columns together",
        )
        .or_else(|| pair(SensorKey::Low, SensorKey::High, "low and high together"))
        .or_else(rule)
        .or_else(|| order().then_some((SensorKey::Low, "a number at most that of high", None)))
    }

    pub(crate) fn rule(&self) -> Option<Rule> {
        let made = |value: Option<f64>, make: fn(f64) -> Result<Rule, _>| make(value?).ok();
        let both = || self.low_and_high();
        made(self.at_least, Rule::at_least)
            .or_else(|| made(self.percent, Rule::percent))
            .or_else(|| both().and_then(|(low, high)| Rule::hysteresis(low, high).ok()))
    }

    pub(crate) fn least(&self) -> Option<u32> {
        self.least
    }

    pub(crate) fn tare(&self) -> Option<u64> {
        self.tare
    }

    pub(crate) fn history_bytes(&self) -> usize {
        self.history_bytes.unwrap_or(HISTORY_BYTES)
    }

    pub(crate) fn apply(&self, options: &mut AcquireOptions) {
        if let Some(FormatSetting(format)) = self.format {
            options.stream_format = format;
        }
        options.baud = self.baud.or(options.baud);
        options.stream_size = FrameSize::of_sides(self.columns, self.rows);
    }

    pub(crate) fn request(&self) -> WatchRequest {
        let mut request = WatchRequest::new("");
        self.apply(&mut request.options);
        let least = self.least().unwrap_or_default();
        let from = RuleOrigin::Settings;
        let mut processing = Processing::default();
        processing.least = least;
        processing.apply_rule(self.rule().map(|rule| SetRule { rule, least, from }));
        request.pipeline = Pipeline::new(processing, self.tare(), from);
        request.history_bytes = self.history_bytes();
        request
    }

    pub(crate) fn shown(&self, setting: &SensorSetting) -> Option<String> {
        (setting.shown)(self)
    }

    /// Returns the default of a setting as it would be written in the file; None if it has no default.
    pub(crate) fn default_text(key: SensorKey) -> Option<String> {
        match key {
            SensorKey::Format => Some(FormatSetting(None).to_string()),
            SensorKey::Baud => Some(AcquireOptions::BAUD.to_string()),
            SensorKey::Tare => Some("0".to_owned()),
            SensorKey::HistoryBytes => Some(HISTORY_BYTES.to_string()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_fills_the_field_that_it_shows_over_its_whole_range() {
        #[expect(clippy::cast_precision_loss, reason = "the limits are below 2^53")]
        let ends = |kind| match kind {
            SettingKind::Format { .. } => [None, None],
            SettingKind::Whole { least, most, .. } => [least as f64, most as f64].map(Some),
            SettingKind::Number { least, most, .. } => [least, most].map(Some),
            SettingKind::Percent { .. } => [1e-3, 100.0].map(Some),
        };
        for row in &SENSOR_SETTINGS {
            for end in ends(row.kind) {
                let mut settings = SensorSettings::default();
                let is_filled = match (row.kind, end) {
                    (SettingKind::Format { fill }, _) => fill(&mut settings, FormatSetting(None)),
                    (kind, Some(value)) => kind.fill(&mut settings, value),
                    (_, None) => false,
                };
                assert!(is_filled, "{row:?} {end:?}");
                let value = end.map_or("\"auto\"".to_owned(), |end| end.to_string());
                let shown = |other: &SensorSetting| settings.shown(other);
                assert_eq!(shown(row), Some(value));
                let all = SENSOR_SETTINGS
                    .iter()
                    .filter(|other| shown(other).is_some());
                assert_eq!(all.count(), 1, "{row:?}");
            }
        }
    }
}
