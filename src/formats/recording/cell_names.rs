//! Finds the fields of a table that are cells, by the names in its header: `S0_0`, `r3c12`, or 0, 1, 2 and so on.
//!
//! | names | are |
//! |---|---|
//! | `r0c0,r0c1,r1c0,r1c1`, `S3_12`, `pad2[0][1]` | rows and columns: the last two numbers of each name; the rest is the same in all |
//! | `c0r0`, `col0_row0`, `x0y0` | the same, but columns and rows |
//! | `0,1,2,3`, `v1,v2,v3` | cells one after the other; their rows and columns are not known |
//! | `frame`, `index`, `id`, … or an empty first name | the frame's label in the recording |
//! | `time`, `t_ns`, `Time (ms)`, `host_time`, `timestampMs`, … | the frame's time, with its unit if there is one |
//! | `sec` beside `nanosec`, `header.stamp.secs` beside `header.stamp.nsecs` | the whole seconds of the frame's time, and the rest |
//!
//! Numbers of rows and columns may start anywhere, but none may be missing: otherwise the names do not describe
//! cells.

use crate::formats::recording::frame_time::TimeUnit;
use crate::frame::FrameSize;

/// The cells that the header of a table names.
#[derive(Debug, PartialEq)]
pub(crate) enum NamedCells {
    /// The size of a frame, and the field of each cell in reading order.
    Grid(FrameSize, Vec<usize>),
    /// Consecutive fields that count up: the first of them and their number.
    Counted(usize, usize),
    /// The size of a frame, and the number of its cells that the header names: not all of them.
    Incomplete(FrameSize, usize),
}

/// The role of a field that is not a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FieldRole {
    /// The frame's label.
    Label,
    /// The frame's time, and the unit if the name gives one.
    Time(Option<TimeUnit>),
}

/// The most patterns of names that are distinguished.
const MOST_PATTERNS: usize = 64;

/// Returns the cells that the names describe; None if they do not describe any.
pub(crate) fn cells(names: &[&str]) -> Option<NamedCells> {
    let (named, counted) = (largest_grid(names), counted(names));
    let in_row = match counted {
        Some(NamedCells::Counted(_, length)) => length,
        _ => 0,
    };
    // Each row of a grid counts up, too. If fewer names have a pair of numbers than count up, the pairs are chance.
    if named.len() < in_row {
        counted
    } else {
        grid(&named)
    }
}

/// Splits the last `N` numbers off a name; returns the text around them and the numbers. `pad2[0][1]` split for two
/// numbers is `pad2[#][#]` and 0, 1. None if there are fewer numbers.
fn split<const N: usize>(name: &str) -> Option<(String, [u32; N])> {
    let mut numbers = [0; N];
    let mut skeleton = String::new();
    let mut rest = name;
    for number in numbers.iter_mut().rev() {
        let end = rest.rfind(|character: char| character.is_ascii_digit())? + 1;
        let start = rest[..end].rfind(|character: char| !character.is_ascii_digit());
        let start = start.map_or(0, |start| {
            start + rest[start..].chars().next().map_or(1, char::len_utf8)
        });
        *number = rest[start..end].parse().ok()?;
        skeleton = format!("#{}{skeleton}", &rest[end..]);
        rest = &rest[..start];
    }
    Some((format!("{rest}{skeleton}"), numbers))
}

/// Returns true if a pattern such as `pad_col#_row#` names the column before the row. Without words for both, the row
/// comes first.
fn is_column_first(skeleton: &str) -> bool {
    let mut before = skeleton.rsplit('#').skip(1).map(|text| {
        let text = text.trim_end_matches(|character: char| !character.is_alphanumeric());
        let word = text.rsplit(|character: char| !character.is_alphabetic());
        word.take(1).collect::<String>().to_lowercase()
    });
    let (second, first) = (before.next(), before.next());
    let is_column = |word: String| ["c", "col", "column", "x"].contains(&word.as_str());
    let is_row = |word: String| ["r", "row", "y"].contains(&word.as_str());
    first.is_some_and(is_column) && second.is_some_and(is_row)
}

/// The index of a field, and its row and column: the last two numbers of its name.
type NumberedField = (usize, [u32; 2]);

/// Returns the fields whose names have two numbers, with their rows and columns, for the most frequent pattern.
fn largest_grid(names: &[&str]) -> Vec<NumberedField> {
    let split = names.iter().map(|name| split::<2>(name)).enumerate();
    let mut patterns: Vec<(String, Vec<NumberedField>)> = Vec::new();
    for (field, found) in split {
        let Some((skeleton, numbers)) = found else {
            continue;
        };
        let is_full = patterns.len() == MOST_PATTERNS;
        match patterns.iter_mut().find(|(own, _)| *own == skeleton) {
            Some((_, fields)) => fields.push((field, numbers)),
            // A table of cells has few patterns; one of words and dates may have a pattern for each name.
            None if is_full => {}
            None => patterns.push((skeleton, vec![(field, numbers)])),
        }
    }
    // Of equally frequent patterns the last counts, since cells come after the other fields of a frame.
    let most = patterns.into_iter().max_by_key(|(_, fields)| fields.len());
    let (skeleton, mut fields) = most.unwrap_or_default();
    if is_column_first(&skeleton) {
        for (_, numbers) in &mut fields {
            numbers.swap(0, 1);
        }
    }
    fields
}

/// Returns the cells named by row and column; there must be exactly one for each position. None if the names are
/// cells by chance at most: half of them or more are missing, or one occurs twice.
fn grid(named: &[NumberedField]) -> Option<NamedCells> {
    let range = |part: usize| {
        let numbers = named.iter().map(|(_, numbers)| numbers[part]);
        numbers.clone().min().zip(numbers.max())
    };
    let ((top, bottom), (left, right)) = range(0).zip(range(1))?;
    let side = |low: u32, high: u32| u16::try_from(high - low).ok()?.checked_add(1);
    let size = FrameSize::of_sides(side(left, right), side(top, bottom))?;
    let mut fields = vec![None; size.cells()];
    if named.len() < 2 || named.len() > fields.len() {
        return None;
    }
    if named.len() < fields.len() {
        let found = named.len();
        return (2 * found > fields.len()).then_some(NamedCells::Incomplete(size, found));
    }
    for &(field, [row, column]) in named {
        // Both are below 512.
        let index = (row - top) * u32::from(size.columns()) + (column - left);
        fields[usize::try_from(index).ok()?] = Some(field);
    }
    let fields: Option<Vec<usize>> = fields.into_iter().collect();
    Some(NamedCells::Grid(size, fields?))
}

/// Returns the longest run of names that count up from 0 or 1; it must have at least three.
fn counted(names: &[&str]) -> Option<NamedCells> {
    let named = |name: &&str| split::<1>(name);
    let mut best: Option<(usize, usize)> = None;
    let mut start = 0;
    while start < names.len() {
        let Some((skeleton, [first])) = named(&names[start]).filter(|(_, [first])| *first < 2)
        else {
            start += 1;
            continue;
        };
        let follows = |(index, name): &(usize, &&str)| {
            let expected = u32::try_from(*index)
                .ok()
                .and_then(|index| first.checked_add(index));
            named(name).is_some_and(|(own, [number])| own == skeleton && Some(number) == expected)
        };
        let length = names[start..]
            .iter()
            .enumerate()
            .take_while(follows)
            .count();
        if best.is_none_or(|(_, most)| length > most) {
            best = Some((start, length));
        }
        start += length.max(1);
    }
    best.filter(|(_, length)| *length > 2)
        .map(|(start, length)| NamedCells::Counted(start, length))
}

/// Returns the roles of a header's fields by their names. A first field without a name is an index, as pandas writes
/// it.
pub(crate) fn roles(names: &[&str]) -> Vec<Option<FieldRole>> {
    let mut roles: Vec<_> = names.iter().map(|name| role(name)).collect();
    if let ([first, _, ..], [own, ..]) = (names, &mut roles[..])
        && first.is_empty()
    {
        *own = Some(FieldRole::Label);
    }
    roles
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

/// The words for a time.
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

/// The words for the clock of a time.
const CLOCKS: [&str; 17] = [
    "header", "field", "msg", "ros", "unix", "host", "log", "system", "sys", "device", "sensor",
    "recv", "received", "utc", "cpu", "wall", "tv",
];

/// The words for a frame's label.
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

/// Returns the unit of time that a text names, such as `ms` or `[s]`.
pub(crate) fn time_unit(text: &str) -> Option<TimeUnit> {
    words(text).first().and_then(|word| unit(word))
}

/// Returns the unit of time that a word names.
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
pub(crate) fn is_named_time(name: &str) -> bool {
    word_behind_clock(&words(name)).is_some_and(|word| TIMES.contains(&word.as_str()))
}

/// Returns the role of a field by its name; None if the name is not a usual one.
pub(crate) fn role(name: &str) -> Option<FieldRole> {
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
pub(crate) fn rest_of_second(names: &[&str], seconds: usize) -> Option<(usize, TimeUnit)> {
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
    fn names_of_cells_are_found() {
        let grid = |rows, columns, fields: &[usize]| {
            Some(NamedCells::Grid(
                FrameSize::of(columns, rows),
                fields.to_vec(),
            ))
        };
        assert_eq!(cells(&["time", "S0_0", "S0_1"]), grid(1, 2, &[1, 2]));
        assert_eq!(
            cells(&["r1c1", "r2c1", "r1c2", "r2c2"]),
            grid(2, 2, &[0, 2, 1, 3])
        );
        assert_eq!(cells(&["pad2[0][0]", "pad2[1][0]"]), grid(2, 1, &[0, 1]));
        // The letters show which of the two is the column.
        for [column, between, behind] in [
            ["c", "r", ""],
            ["col", "_row", ""],
            ["C", "_R", ""],
            ["x", "y", ""],
            ["pad_Column ", ", Row ", ""],
            ["pad[x", "][y", "]"],
        ] {
            let name = |(x, y): (u8, u8)| format!("{column}{x}{between}{y}{behind}");
            let names = [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)].map(name);
            let names = names.each_ref().map(String::as_str);
            assert_eq!(cells(&names), grid(2, 3, &[0, 1, 2, 3, 4, 5]), "{names:?}");
        }
        let row_first = ["y0x0", "y0x1", "y0x2", "y1x0", "y1x1", "y1x2"];
        assert_eq!(cells(&row_first), grid(2, 3, &[0, 1, 2, 3, 4, 5]));
        assert_eq!(
            cells(&["frame", "time", "0", "1", "2", "3"]),
            Some(NamedCells::Counted(2, 4))
        );
        assert_eq!(
            cells(&["v1", "v2", "v3", "note"]),
            Some(NamedCells::Counted(0, 3))
        );
        // A cell is missing, and no names count up.
        let incomplete = |rows, columns, found| {
            Some(NamedCells::Incomplete(FrameSize::of(columns, rows), found))
        };
        assert_eq!(cells(&["r0c0", "r0c1", "r1c0"]), incomplete(2, 2, 3));
        assert_eq!(
            cells(&["r0c0", "r0c1", "r0c2", "r0c4"]),
            incomplete(1, 5, 4)
        );
        // Half of the cells are too few.
        assert_eq!(cells(&["r0c0", "r1c1"]), None);
        // One cell is there twice.
        assert_eq!(cells(&["r0c0", "r0c1", "r0c1"]), None);
        assert_eq!(cells(&["a", "b"]), None);
        // Other fields of the frame may come after its cells.
        let named = [
            "S0_0", "S0_1", "S0_2", "S1_0", "S1_1", "S1_2", "total", "run_1_2",
        ];
        assert_eq!(cells(&named), grid(2, 3, &[0, 1, 2, 3, 4, 5]));
        let label = cells(&["S0_0", "S0_1", "S0_2", "S1_0", "label"]);
        assert_eq!(label, incomplete(2, 3, 4));
        // A pair of numbers is not a cell if more names count up.
        let counted = Some(NamedCells::Counted(2, 4));
        for [first, second] in [["a_1_1", "a_1_2"], ["x_2024_01", "x_2025_02"]] {
            assert_eq!(cells(&[first, second, "c0", "c1", "c2", "c3"]), counted);
        }
        assert_eq!(cells(&["s0_0", "s0_4294967295"]), None);
        // The names of a single row count up, too, but they are pairs.
        assert_eq!(cells(&["S0_0", "S0_1", "S0_2"]), grid(1, 3, &[0, 1, 2]));
        // Of two runs of the same length, the first counts.
        assert_eq!(
            cells(&["a1", "a2", "a3", "b1", "b2", "b3"]),
            Some(NamedCells::Counted(0, 3))
        );
    }

    #[test]
    fn names_of_cells_have_at_most_512_rows_and_columns() {
        let row = |length: u16| -> Vec<String> {
            (0..length).map(|column| format!("r0c{column}")).collect()
        };
        let sides = |names: &[String]| {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            match cells(&names) {
                Some(NamedCells::Grid(size, _)) => Some((size.rows(), size.columns())),
                _ => None,
            }
        };
        assert_eq!(sides(&row(512)), Some((1, 512)));
        assert_eq!(sides(&row(513)), None);
    }

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
