//! Reads the times of JSON lines that have neither `t` nor `time`: from a key that is the name of a time, such as
//! `timestamp` or `t_ms`, or from two keys of which one has the rest of the second, such as `sec` and `nanosec`.
//!
//! The first line with a time decides the key and its unit. Whole numbers are subtracted before they become floats.

use serde_json::Value;

use crate::formats::recording::time::exact::Time;
use crate::formats::recording::time::field_role::{FieldRole, is_named_time, rest_of_second, role};
use crate::formats::recording::time::frame_clock::FrameClock;
use crate::formats::recording::time::moment;
use crate::formats::recording::time::unit::TimeUnit;
use crate::frame::LARGEST_VALUE;

/// The most keys of a line that are considered as its time.
const MOST_KEYS: usize = 16;

/// The key that holds the time in each line.
#[derive(Debug)]
struct TimeKey {
    name: String,
    /// The key with the rest of the second, and its unit.
    rest: Option<(String, TimeUnit)>,
}

/// A clock that reads the times of lines.
#[derive(Debug, Default)]
pub(in crate::formats) struct JsonClock {
    /// The key of the time; None until a line has a time.
    key: Option<TimeKey>,
    /// The clock of the frames.
    pub(in crate::formats) clock: FrameClock,
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

    /// Returns the time of a line; None if it has none.
    pub(super) fn time(&mut self, line: &TimeCandidates) -> Option<Time> {
        if self.key.is_none() {
            self.key = TimeKey::of(line);
            let name = self.key.as_ref().map(|key| &*key.name);
            self.clock.set_unit(name.and_then(role_unit));
        }
        let key = self.key.as_ref()?;
        let time = match line.value(&key.name)? {
            Value::String(text) => self.clock.moment(moment::read(text.as_bytes())?),
            value => {
                let (text, number) = number(value)?;
                self.clock.number(text.as_bytes(), number)
            }
        };
        let Some((rest, unit)) = &key.rest else {
            return Some(time);
        };
        let (text, number) = number(line.value(rest)?)?;
        Some(time.plus(Time::read(text.as_bytes(), number, *unit)))
    }

    /// Forgets the key of the time: another file may have another one.
    pub(in crate::formats) fn forget_key(&mut self) {
        self.key = None;
    }
}

impl TimeKey {
    /// Chooses the key of a first line: seconds with their rest in another key, otherwise the first key that is
    /// called a time.
    fn of(line: &TimeCandidates) -> Option<Self> {
        let are_times = line.0.iter().filter(|(_, value)| is_time(value));
        let names: Vec<&str> = are_times.map(|(name, _)| name.as_str()).collect();
        let pair = |index| rest_of_second(&names, index).map(|rest| (index, Some(rest)));
        let alone = || names.iter().position(|name| is_named_time(name));
        let pairs = (0..names.len()).find_map(pair);
        let (index, rest) = pairs.or_else(|| Some((alone()?, None)))?;
        Some(Self {
            name: names[index].to_owned(),
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

/// Returns true if a value can be a time: a number, or a timestamp.
fn is_time(value: &Value) -> bool {
    match value {
        Value::String(text) => moment::read(text.as_bytes()).is_some(),
        value => number(value).is_some(),
    }
}

/// Returns a number as it is written, and its value.
fn number(value: &Value) -> Option<(String, f64)> {
    let Value::Number(written) = value else {
        return None;
    };
    let number = written
        .as_f64()
        .filter(|time| time.abs() <= LARGEST_VALUE)?;
    Some((written.to_string(), number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::recording::event::RecordingNote;

    /// Returns the seconds of such lines, and the note about their unit.
    fn seconds(lines: &[&str]) -> (Vec<Option<f64>>, Option<RecordingNote>) {
        let mut clock = JsonClock::default();
        let of_line = |line: &&str| {
            let object: Value = serde_json::from_str(line).expect("JSON");
            let mut candidates = TimeCandidates::default();
            for (name, value) in object.as_object().expect("an object") {
                if clock.takes(name, &candidates) {
                    candidates.add(name.clone(), value.clone());
                }
            }
            let time = clock.time(&candidates)?;
            Some(clock.clock.since_first(time))
        };
        let seconds = lines.iter().map(of_line).collect();
        (seconds, clock.clock.take_note())
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
        let unit = "nanoseconds";
        assert_eq!(
            seconds(&lines),
            (times, Some(RecordingNote::TimeUnit { unit }))
        );
    }

    #[test]
    fn timestamps_need_no_date() {
        let lines = [
            r#"{"timestamp":"23:59:59.5"}"#,
            r#"{"timestamp":null}"#,
            r#"{"timestamp":"00:00:00.25"}"#,
        ];
        assert_eq!(seconds(&lines).0, [Some(0.0), None, Some(0.75)]);
    }
}
