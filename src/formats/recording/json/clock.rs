//! Reads the times of JSON lines that have neither `t` nor `time`: from a key that is the name of a time, such as
//! `timestamp` or `t_ms`, or from two keys of which one has the rest of the second, such as `sec` and `nanosec`.
//!
//! The first line with a time decides the key and its unit. Whole numbers are subtracted before they become floats.

use serde_json::Value;

use crate::formats::recording::time::exact::Time;
use crate::formats::recording::time::field_role::{FieldRole, is_named_time, rest_of_second, role};
use crate::formats::recording::time::moment;
use crate::formats::recording::time::unit::TimeUnit;
use crate::frame::LARGEST_VALUE;

/// The most keys of a line that are considered as its time.
const MOST_KEYS: usize = 16;

/// The key that holds the time in each line.
#[derive(Debug)]
struct TimeKey {
    name: String,
    /// The unit of the key; None until the size of a number decides it.
    unit: Option<TimeUnit>,
    /// The key with the rest of the second, and its unit.
    rest: Option<(String, TimeUnit)>,
}

/// A clock that turns the times of lines into seconds since the first one.
#[derive(Debug, Default)]
pub(in crate::formats) struct JsonClock {
    /// The key of the time; None until a line has a time.
    key: Option<TimeKey>,
    /// The first time.
    start: Option<Time>,
    /// The unit that was derived from the size alone, until it is reported.
    assumed: Option<TimeUnit>,
}

/// The keys of a line that may be its time, with their values.
#[derive(Debug, Default)]
pub(super) struct TimeCandidates(Vec<(String, Value)>);

impl TimeCandidates {
    pub(super) fn add(&mut self, name: String, value: Value) {
        self.0.push((name, value));
    }

    fn value(&self, name: &str) -> Option<&Value> {
        let mut all = self.0.iter();
        all.find(|(own, _)| own == name).map(|(_, value)| value)
    }
}

impl JsonClock {
    /// Returns true if a key may be the time of a line, or a part of it.
    pub(super) fn takes(&self, name: &str, others: &TimeCandidates) -> bool {
        match &self.key {
            Some(key) => {
                key.name == name || key.rest.as_ref().is_some_and(|(rest, _)| rest == name)
            }
            None => others.0.len() < MOST_KEYS && matches!(role(name), Some(FieldRole::Time(_))),
        }
    }

    /// Returns the seconds from the first time to that of a line; None if the line has no time.
    pub(super) fn seconds(&mut self, line: &TimeCandidates) -> Option<f64> {
        if self.key.is_none() {
            self.key = TimeKey::of(line);
        }
        let key = self.key.as_mut()?;
        let has_unit = key.unit.is_some();
        let mut time = read(line.value(&key.name)?, &mut key.unit)?;
        if !has_unit {
            self.assumed = key.unit.filter(|&unit| unit != TimeUnit::Seconds);
        }
        if let Some((rest, unit)) = &key.rest {
            time = time.plus(read(line.value(rest)?, &mut Some(*unit))?);
        }
        Some(time.since(*self.start.get_or_insert(time)))
    }

    /// Returns once the unit that was derived from the size of the first time, unless it is seconds.
    pub(super) fn take_assumed(&mut self) -> Option<TimeUnit> {
        self.assumed.take()
    }
}

impl TimeKey {
    /// Chooses the key of a first line: seconds with their rest in another key, otherwise the first key that is
    /// called a time.
    fn of(line: &TimeCandidates) -> Option<Self> {
        let are_times = line
            .0
            .iter()
            .filter(|(_, value)| read(value, &mut None).is_some());
        let names: Vec<&str> = are_times.map(|(name, _)| name.as_str()).collect();
        let pair = |index| rest_of_second(&names, index).map(|rest| (index, Some(rest)));
        let alone = || names.iter().position(|name| is_named_time(name));
        let pairs = (0..names.len()).find_map(pair);
        let (index, rest) = pairs.or_else(|| Some((alone()?, None)))?;
        Some(Self {
            name: names[index].to_owned(),
            unit: role_unit(names[index]),
            rest: rest.map(|(rest, unit)| (names[rest].to_owned(), unit)),
        })
    }
}

/// Returns the unit in the name of a time.
fn role_unit(name: &str) -> Option<TimeUnit> {
    match role(name) {
        Some(FieldRole::Time(unit)) => unit,
        _ => None,
    }
}

/// Reads a time: a number, whose size decides the unit if there is none yet, or a text with a date.
fn read(value: &Value, unit: &mut Option<TimeUnit>) -> Option<Time> {
    match value {
        Value::String(text) => moment::read(text.as_bytes())
            .filter(|moment| moment.is_dated)
            .map(|moment| Time::Seconds(moment.seconds)),
        Value::Number(written) => {
            let number = written
                .as_f64()
                .filter(|time| time.abs() <= LARGEST_VALUE)?;
            let unit = *unit.get_or_insert_with(|| TimeUnit::by_size(number));
            Some(Time::read(written.to_string().as_bytes(), number, unit))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the seconds of such lines, and the unit that was assumed.
    fn seconds(lines: &[&str]) -> (Vec<Option<f64>>, Option<TimeUnit>) {
        let mut clock = JsonClock::default();
        let of_line = |line: &&str| {
            let object: Value = serde_json::from_str(line).expect("JSON");
            let mut candidates = TimeCandidates::default();
            for (name, value) in object.as_object().expect("an object") {
                if clock.takes(name, &candidates) {
                    candidates.add(name.clone(), value.clone());
                }
            }
            clock.seconds(&candidates)
        };
        let seconds = lines.iter().map(of_line).collect();
        (seconds, clock.take_assumed())
    }

    #[test]
    fn the_rest_of_a_second_is_added() {
        let lines = [
            r#"{"sec":1714564800,"nanosec":950000000}"#,
            r#"{"sec":1714564801,"nanosec":50000001}"#,
            r#"{"nanosec":150000000,"sec":1714564801}"#,
            r#"{"sec":1714564801}"#,
        ];
        let times = vec![Some(0.0), Some(0.100_000_001), Some(0.2), None];
        assert_eq!(seconds(&lines), (times, None));
        let lines = [
            r#"{"stamp_nanosec":9,"stamp_sec":5}"#,
            r#"{"stamp_nanosec":8,"stamp_sec":6}"#,
        ];
        let times = vec![Some(0.0), Some(0.999_999_999)];
        assert_eq!(seconds(&lines), (times, None));
    }

    #[test]
    fn a_key_with_only_the_unit_of_a_time_is_not_a_time() {
        for key in [
            "latency_ms",
            "exposure_us",
            "exposure_sec",
            "sec",
            "nanosec",
        ] {
            let line = format!("{{\"{key}\":7}}");
            assert_eq!(seconds(&[&line, &line]).0, [None, None], "{key}");
        }
        let lines = [
            r#"{"exposure_us":7,"timestamp":10}"#,
            r#"{"exposure_us":9,"timestamp":11.5}"#,
        ];
        assert_eq!(seconds(&lines).0, [Some(0.0), Some(1.5)]);
    }

    #[test]
    fn the_first_time_decides_the_key_and_its_unit() {
        let lines = [
            r#"{"timestamp":null,"t_ms":null}"#,
            r#"{"timestamp":0}"#,
            r#"{"t_ms":5,"timestamp":1714564800123}"#,
            r#"{"t_ms":6}"#,
        ];
        let times = vec![None, Some(0.0), Some(1_714_564_800_123.0), None];
        assert_eq!(seconds(&lines), (times, None));
    }

    #[test]
    fn nanoseconds_since_1970_lose_nothing() {
        let lines = [
            r#"{"timestamp":1714564800123456789}"#,
            r#"{"timestamp":1714564800124456790}"#,
        ];
        let times = vec![Some(0.0), Some(0.001_000_001)];
        assert_eq!(seconds(&lines), (times, Some(TimeUnit::Nanoseconds)));
    }
}
