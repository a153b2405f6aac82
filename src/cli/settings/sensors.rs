//! The settings of real sensors: the tables `[source]` and `[frames]` of the settings file.
//!
//! Flags of `taxel watch` and `taxel frames` override them. On the screen, `:watch SOURCE` starts with them.

use std::ops::RangeInclusive;

use crate::acquire::AcquireOptions;
use crate::formats::stream::StreamFormat;
use crate::frame::{FrameSize, LARGEST_VALUE, Rule, RuleOrigin, SetRule};
use crate::tui::live::history::HISTORY_BYTES;
use crate::tui::live::request::WatchRequest;

/// A value of the settings file, with its line.
#[derive(Clone, Debug, PartialEq)]
pub struct Written<T> {
    /// The value.
    pub value: T,
    /// The line, from 1.
    pub line: usize,
}

/// A setting of real sensors.
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

/// The values that a setting may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SettingKind {
    /// The name of a format of streams, or `auto`.
    Format,
    /// A whole number in a range.
    Whole(u64, u64),
    /// A number in a range.
    Number(f64, f64),
    /// A share above 0 %.
    Percent,
}

/// A row of the table of settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SensorSetting {
    pub(crate) key: SensorKey,
    /// The table that contains the setting: `source` or `frames`.
    pub(crate) table: &'static str,
    pub(crate) name: &'static str,
    pub(crate) kind: SettingKind,
}

/// The tables, in the order in which they are shown.
pub(crate) const TABLES: [&str; 2] = ["source", "frames"];

/// The number of taxels below which pieces may be dropped.
pub(crate) const LEAST: RangeInclusive<u32> = 1..=4096;

/// All settings of real sensors.
pub(crate) const SENSOR_SETTINGS: [SensorSetting; 11] = {
    use SensorKey as Key;
    use SettingKind::{Format, Number, Percent, Whole};
    const fn row(
        table: &'static str,
        name: &'static str,
        key: SensorKey,
        kind: SettingKind,
    ) -> SensorSetting {
        SensorSetting {
            key,
            table,
            name,
            kind,
        }
    }
    let value = Number(-LARGEST_VALUE, LARGEST_VALUE);
    let side = Whole(
        *FrameSize::SIDES.start() as u64,
        *FrameSize::SIDES.end() as u64,
    );
    let least = Whole(*LEAST.start() as u64, *LEAST.end() as u64);
    let baud = &AcquireOptions::BAUDS;
    let baud = Whole(*baud.start() as u64, *baud.end() as u64);
    [
        row("source", "format", Key::Format, Format),
        row("source", "baud", Key::Baud, baud),
        row("source", "rows", Key::Rows, side),
        row("source", "columns", Key::Columns, side),
        row("frames", "at_least", Key::AtLeast, value),
        row("frames", "percent", Key::Percent, Percent),
        row("frames", "low", Key::Low, value),
        row("frames", "high", Key::High, value),
        row("frames", "least", Key::Least, least),
        row("frames", "tare", Key::Tare, Whole(0, 1_000_000)),
        row(
            "frames",
            "history_bytes",
            Key::HistoryBytes,
            Whole(1 << 16, 1 << 40),
        ),
    ]
};

/// A value of a setting of real sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SettingValue {
    /// The format of a stream; None for `auto`.
    Format(Option<StreamFormat>),
    /// A whole number.
    Whole(u64),
    /// A number.
    Number(f64),
}

impl SettingKind {
    /// Returns the possible values, for messages.
    pub(crate) fn expected(self) -> String {
        match self {
            Self::Format => {
                let names = StreamFormat::ALL.map(|format| format!("{:?}", format.name()));
                format!("one of \"auto\", {}", names.join(", "))
            }
            Self::Whole(least, most) => format!("a whole number from {least} to {most}"),
            Self::Number(least, most) => format!("a number from {least:?} to {most:?}"),
            Self::Percent => "a number above 0, up to 100".to_owned(),
        }
    }

    /// Returns the value of a number; None if it is out of range.
    pub(crate) fn value(self, number: f64) -> Option<SettingValue> {
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the limits are below 2^53, and the number is whole and between them"
        )]
        match self {
            Self::Format => None,
            Self::Whole(least, most) => (number.fract() == 0.0
                && (least as f64..=most as f64).contains(&number))
            .then_some(SettingValue::Whole(number as u64)),
            Self::Number(least, most) => (least..=most)
                .contains(&number)
                .then_some(SettingValue::Number(number)),
            Self::Percent => Rule::percent(number)
                .is_ok()
                .then_some(SettingValue::Number(number)),
        }
    }
}

/// The settings of real sensors that the file sets.
#[derive(Clone, Debug, Default)]
pub(crate) struct SensorSettings {
    entries: Vec<(SensorKey, Written<SettingValue>)>,
}

impl SensorSettings {
    /// Adds an entry of the file.
    pub(crate) fn add(&mut self, key: SensorKey, written: Written<SettingValue>) {
        self.entries.push((key, written));
    }

    /// Returns the entry of the file, if there is one.
    pub(crate) fn get(&self, key: SensorKey) -> Option<&Written<SettingValue>> {
        let found = self.entries.iter().find(|(own, _)| *own == key);
        found.map(|(_, written)| written)
    }

    fn number(&self, key: SensorKey) -> Option<f64> {
        match self.get(key)?.value {
            SettingValue::Number(number) => Some(number),
            _ => None,
        }
    }

    fn whole<T: TryFrom<u64>>(&self, key: SensorKey) -> Option<T> {
        match self.get(key)?.value {
            SettingValue::Whole(whole) => T::try_from(whole).ok(),
            _ => None,
        }
    }

    /// Returns the first key that conflicts with the others or lacks one, what was expected, and the key with which it
    /// conflicts, if there is one.
    pub(crate) fn conflict(&self) -> Option<(SensorKey, &'static str, Option<SensorKey>)> {
        let has = |key: SensorKey| self.get(key).is_some();
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
        let low = self
            .number(SensorKey::Low)
            .zip(self.number(SensorKey::High));
        let order = || low.is_some_and(|(low, high)| low > high);
        pair(
            SensorKey::Rows,
            SensorKey::Columns,
            "rows and columns together",
        )
        .or_else(|| pair(SensorKey::Low, SensorKey::High, "low and high together"))
        .or_else(rule)
        .or_else(|| order().then_some((SensorKey::Low, "a number at most that of high", None)))
    }

    /// Returns the rule for imprints.
    pub(crate) fn rule(&self) -> Option<Rule> {
        let made = |key, make: fn(f64) -> Result<Rule, _>| make(self.number(key)?).ok();
        let both = self
            .number(SensorKey::Low)
            .zip(self.number(SensorKey::High));
        made(SensorKey::AtLeast, Rule::at_least)
            .or_else(|| made(SensorKey::Percent, Rule::percent))
            .or_else(|| both.and_then(|(low, high)| Rule::hysteresis(low, high).ok()))
    }

    /// Returns the smallest piece that is kept, in taxels.
    pub(crate) fn least(&self) -> Option<u32> {
        self.whole(SensorKey::Least)
    }

    /// Returns the number of frames for a tare.
    pub(crate) fn tare(&self) -> Option<u64> {
        self.whole(SensorKey::Tare)
    }

    /// Returns the memory for the history of frames, in bytes.
    pub(crate) fn history_bytes(&self) -> usize {
        let bytes = self.whole(SensorKey::HistoryBytes);
        bytes.unwrap_or(HISTORY_BYTES)
    }

    /// Sets how a source is read, for the settings that the file has.
    pub(crate) fn apply(&self, options: &mut AcquireOptions) {
        if let Some(Written {
            value: SettingValue::Format(format),
            ..
        }) = self.get(SensorKey::Format)
        {
            options.stream_format = *format;
        }
        options.baud = self.whole(SensorKey::Baud).unwrap_or(options.baud);
        let sides = [SensorKey::Columns, SensorKey::Rows].map(|key| self.whole(key));
        options.stream_size = FrameSize::of_sides(sides[0], sides[1]);
    }

    /// Returns the request that `:watch` starts with; its source is still missing.
    pub(crate) fn request(&self) -> WatchRequest {
        let mut request = WatchRequest::new("");
        self.apply(&mut request.options);
        let least = self.least().unwrap_or_default();
        request.processing.least = least;
        let from = RuleOrigin::Settings;
        request.rule = self.rule().map(|rule| SetRule { rule, least, from });
        request.tare = self.tare().unwrap_or_default();
        request.own_tare = self.tare().is_none();
        request.history_bytes = self.history_bytes();
        request
    }

    /// Returns the value of a setting as it is written in the file; None if it is not set and has no default.
    pub(crate) fn text(&self, setting: &SensorSetting) -> Option<String> {
        match self.get(setting.key).map(|own| own.value) {
            Some(SettingValue::Whole(whole)) => Some(whole.to_string()),
            Some(SettingValue::Number(number)) => Some(number.to_string()),
            Some(SettingValue::Format(Some(format))) => Some(format!("{:?}", format.name())),
            Some(SettingValue::Format(None)) => Some("\"auto\"".to_owned()),
            None => match setting.key {
                SensorKey::Format => Some("\"auto\"".to_owned()),
                SensorKey::Baud => Some(AcquireOptions::default().baud.to_string()),
                SensorKey::Tare => Some("0".to_owned()),
                SensorKey::HistoryBytes => Some(HISTORY_BYTES.to_string()),
                _ => None,
            },
        }
    }
}
