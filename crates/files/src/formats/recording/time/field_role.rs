//! Finds the fields with the label and the time of a frame by their names: in headers of tables, keys of JSON and names
//! of arrays.
//!
//! | names | are |
//! |---|---|
//! | `frame`, `index`, `id`, … or an empty first name | the frame's label in the recording |
//! | `time`, `t_ns`, `Time (ms)`, `host_time`, `timestampMs`, … | the frame's time, with its unit if there is one |
//! | `sec` beside `nanosec`, `header.stamp.secs` beside `header.stamp.nsecs` | the whole seconds of the frame's time, and the rest |

use crate::formats::recording::time::TimeUnit;

/// The role of a field that is not a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::formats::recording) enum FieldRole {
    Label,
    /// The frame's time, and the unit if the name gives one.
    Time(Option<TimeUnit>),
}

/// The words for each unit of time. `min` may also mean a minimum, so it needs a word for a time before it.
const UNITS: [(TimeUnit, &[&str]); 5] = [
    (
        TimeUnit::Nanoseconds,
        &[
            "ns",
            "nsec",
            "nsecs",
            "nanosec",
            "nanosecs",
            "nanosecond",
            "nanoseconds",
            "nanos",
        ],
    ),
    (
        TimeUnit::Microseconds,
        &[
            "us",
            "µs",
            "usec",
            "usecs",
            "microsec",
            "microsecs",
            "microsecond",
            "microseconds",
            "micros",
        ],
    ),
    (
        TimeUnit::Milliseconds,
        &[
            "ms",
            "msec",
            "msecs",
            "millisec",
            "millisecs",
            "millisecond",
            "milliseconds",
            "millis",
        ],
    ),
    (
        TimeUnit::Seconds,
        &["s", "sec", "secs", "second", "seconds"],
    ),
    (TimeUnit::Minutes, &["min", "mins", "minutes"]),
];

const TIMES: [&str; 15] = [
    "t",
    "time",
    "times",
    "timestamp",
    "timestamps",
    "ts",
    "stamp",
    "clock",
    "elapsed",
    "epoch",
    "datetime",
    "utime",
    "unixtime",
    "unix",
    "walltime",
];

const CLOCKS: [&str; 17] = [
    "header", "field", "msg", "ros", "unix", "host", "log", "system", "sys", "device", "sensor",
    "recv", "received", "utc", "cpu", "wall", "tv",
];

const LABELS: [&str; 13] = [
    "frame", "index", "idx", "number", "no", "nr", "n", "id", "label", "seq", "sequence", "sample",
    "count",
];

/// Splits a name into words in lower case: `timestampMs` and `Time (ms)` have two.
fn words(name: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut word = String::new();
    let mut after_small = false;
    for character in name.chars() {
        if !character.is_alphabetic() || after_small && character.is_uppercase() {
            words.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
        }
        if character.is_alphabetic() {
            // The Greek letter looks like the micro sign.
            let small = character.to_lowercase();
            word.extend(small.map(|small| if small == 'μ' { 'µ' } else { small }));
        }
        after_small = character.is_lowercase();
    }
    words.extend((!word.is_empty()).then_some(word));
    words
}

fn unit(word: &str) -> Option<TimeUnit> {
    let found = UNITS.iter().find(|(_, words)| words.contains(&word));
    found.map(|(unit, _)| *unit)
}

/// Returns the first word of a name that does not name a clock: `time` of `host_time`, `stamp` of `header.stamp`.
fn word_behind_clock(words: &[String]) -> Option<&String> {
    let mut behind = words.iter();
    behind
        .find(|word| !CLOCKS.contains(&word.as_str()))
        .or(words.first())
}

/// Returns true if a name says that it is a time, instead of only having the unit of one: `t_ms`, but not
/// `latency_ms`.
pub(in crate::formats::recording) fn is_named_time(name: &str) -> bool {
    word_behind_clock(&words(name)).is_some_and(|word| TIMES.contains(&word.as_str()))
}

/// Returns the role of a field by its name; None if the name is not a usual one.
pub(in crate::formats::recording) fn role(name: &str) -> Option<FieldRole> {
    let words = words(name);
    let first = words.first()?;
    let time = word_behind_clock(&words)?;
    // A letter with a number is one of several: `S00` is not a second.
    let has_number = name.contains(|character: char| character.is_ascii_digit());
    let is_one_of_several = |word: &str| has_number && word.chars().count() == 1;
    if is_one_of_several(first) || is_one_of_several(time) {
        return None;
    }
    // If there are several units, the smallest one counts.
    let unit = words.iter().filter_map(|word| unit(word)).min();
    let is_time = TIMES.contains(&time.as_str())
        || unit.is_some_and(|unit| match unit {
            TimeUnit::Minutes => false,
            TimeUnit::Seconds => self::unit(time) == Some(TimeUnit::Seconds),
            _ => true,
        });
    if is_time {
        Some(FieldRole::Time(unit))
    } else if LABELS.contains(&first.as_str()) {
        Some(FieldRole::Label)
    } else {
        None
    }
}

/// Returns the field with the rest of a time whose whole seconds are in the field `seconds`, and the unit of that
/// rest: `nanosec` beside `sec`. Only such names form a pair; `time_s` and `time_ns` may be the same time twice.
pub(in crate::formats::recording) fn rest_of_second(
    names: &[&str],
    seconds: usize,
) -> Option<(usize, TimeUnit)> {
    let own = words(names.get(seconds)?);
    let (last, stem) = own.split_last()?;
    if !["sec", "secs", "second", "seconds"].contains(&last.as_str()) {
        return None;
    }
    names.iter().enumerate().find_map(|(field, name)| {
        let other = words(name);
        let (last, own_stem) = other.split_last()?;
        let unit = unit(last).filter(|&unit| unit < TimeUnit::Milliseconds && last.len() > 2)?;
        (own_stem == stem).then_some((field, unit))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        let time = |unit| Some(FieldRole::Time(Some(unit)));
        let bare = Some(FieldRole::Time(None));
        for (name, expected) in [
            ("time", bare),
            ("t_ns", time(TimeUnit::Nanoseconds)),
            ("Time (ms)", time(TimeUnit::Milliseconds)),
            ("timestamp", bare),
            ("Time (\u{3bc}s)", time(TimeUnit::Microseconds)),
            ("Time [msecs]", time(TimeUnit::Milliseconds)),
            ("time_min", time(TimeUnit::Minutes)),
            ("Elapsed time (s)", time(TimeUnit::Seconds)),
            ("Time in seconds", time(TimeUnit::Seconds)),
            ("timeMs", time(TimeUnit::Milliseconds)),
            ("timestampMs", time(TimeUnit::Milliseconds)),
            ("ts", bare),
            ("%time", bare),
            ("unix_time", bare),
            ("host_time_us", time(TimeUnit::Microseconds)),
            ("header.stamp", bare),
            ("header.stamp.secs", time(TimeUnit::Seconds)),
            ("header.stamp.nsecs", time(TimeUnit::Nanoseconds)),
            ("sec", time(TimeUnit::Seconds)),
            ("nanosec", time(TimeUnit::Nanoseconds)),
            ("min", None),
            ("force in s", None),
            ("Frame", Some(FieldRole::Label)),
            ("frameNumber", Some(FieldRole::Label)),
            ("id 2", Some(FieldRole::Label)),
            ("t1_ms 2", None),
            ("ts1", bare),
            ("sensor_id", None),
            ("sensor s1", None),
            ("force", None),
            ("S00", None),
            ("T1", None),
            ("", None),
        ] {
            assert_eq!(role(name), expected, "{name}");
        }
    }

    #[test]
    fn a_second_may_have_its_rest_in_another_field() {
        let nanoseconds = Some((1, TimeUnit::Nanoseconds));
        for [first, second] in [
            ["sec", "nanosec"],
            ["secs", "nsecs"],
            ["header.stamp.sec", "header.stamp.nanosec"],
            ["seconds", "nanos"],
        ] {
            assert_eq!(rest_of_second(&[first, second], 0), nanoseconds, "{first}");
        }
        let microseconds = Some((1, TimeUnit::Microseconds));
        assert_eq!(rest_of_second(&["tv_sec", "tv_usec"], 0), microseconds);
        for [first, second] in [
            ["time_s", "time_ns"],
            ["start.sec", "end.nanosec"],
            ["time", "nanosec"],
            ["time_sec", "time_msec"],
        ] {
            assert_eq!(rest_of_second(&[first, second], 0), None, "{first}");
        }
    }
}
