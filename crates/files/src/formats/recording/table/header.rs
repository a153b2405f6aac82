//! Reads the header of a table: decides whether the first line holds names or values, and finds the lines that hold
//! neither, the units and the time.

use std::io::BufRead;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::table::cell_names::{NamedCells, cells, is_first_cell};
use crate::formats::recording::table::clock::TimeFields;
use crate::formats::recording::text::lines::{TextLines, is_blank};
use crate::formats::recording::text::separator::{Separator, is_comment, is_none};
use crate::formats::recording::time::field_role::{
    FieldRole, is_named_time, rest_of_second, role, roles, time_unit,
};
use crate::formats::recording::time::moment;
use crate::frame::FrameSize;

/// The most fields beside the cells.
pub(super) const MOST_BESIDE: usize = 16;

/// Returns the first line that is neither blank nor a comment.
///
/// # Errors
/// Returns [`RecordingError::Unknown`] if there is no such line.
pub(super) fn first_line(lines: &mut TextLines<impl BufRead>) -> Result<Vec<u8>, RecordingError> {
    while lines.advance_to_content()? && is_comment(lines.line()) {}
    let first = lines.line();
    if is_blank(first) || is_comment(first) {
        return Err(RecordingError::Unknown);
    }
    Ok(first.to_owned())
}

/// Splits a line into the text of the timestamp at its beginning and the numbers after it; None if anything else is
/// there.
pub(super) fn moment_of_row(separator: Separator, line: &[u8]) -> Option<(&[u8], &[u8])> {
    let (_, row) = moment::leading(line)?;
    let moment = line[..line.len() - row.len()].trim_ascii();
    let moment = moment.strip_suffix(b",").unwrap_or(moment);
    let moment = moment.strip_suffix(b";").unwrap_or(moment);
    let mut fields = separator.fields(row);
    fields
        .all(|field| separator.is_numeric(field))
        .then_some((moment.trim_ascii(), row))
}

/// The header of a table: the lines above its values. It is read from the first line, which may turn out to hold
/// values.
#[derive(Debug)]
pub(super) struct TableHeader<'a> {
    /// The names of the fields.
    pub(super) names: Vec<&'a str>,
    /// The cells that the names describe; None if they do not describe any.
    pub(super) cells: Option<NamedCells>,
    /// The line number of the names.
    pub(super) number: u64,
    /// The line number of the units, and the unit of each field.
    pub(super) units: Option<(u64, Vec<String>)>,
}

impl<'a> TableHeader<'a> {
    /// Finds the cells that the names in line `number` describe.
    pub(super) fn new(names: Vec<&'a str>, number: u64) -> Self {
        Self {
            cells: cells(&names).or_else(|| only_cell(&names)),
            names,
            number,
            units: None,
        }
    }

    /// Returns the number of cells if the names are those of cells counted from 0, and no others except the first
    /// `others`. After these, one name may be empty: pandas writes it above its index.
    pub(super) fn count_from_0(&self, others: usize) -> Option<usize> {
        let &NamedCells::Counted(start, length) = self.cells.as_ref()? else {
            return None;
        };
        let before = self.names.get(others..start)?;
        let all = matches!(before, [] | [""]) && start + length == self.names.len();
        (all && self.names[start] == "0").then_some(length)
    }

    /// Returns the unit of a field; None if it has none.
    fn unit(&self, field: usize) -> Option<&str> {
        let unit = self.units.as_ref()?.1.get(field)?;
        let inner = unit.trim_matches(['[', ']', '(', ')']).trim();
        // A dash means that there is no unit, as do the words for a missing value.
        let is_none = inner == "-" || is_none(inner.as_bytes());
        (!is_none).then_some(inner)
    }

    /// Returns the unit of these fields; None if they do not all have the same.
    pub(super) fn unit_of_all(&self, fields: &[usize]) -> Option<&str> {
        let units = fields.iter().map(|&field| self.unit(field));
        let same = units.reduce(|one, other| one.filter(|_| one == other));
        same.flatten()
    }

    /// Returns the first of these fields that is a time, together with its other field if the time is split into two.
    pub(super) fn time<'r>(
        &self,
        fields: impl Iterator<Item = (usize, &'r Option<FieldRole>)>,
    ) -> Option<TimeFields> {
        let times = fields.filter_map(|(field, role)| match role {
            Some(FieldRole::Time(unit)) => {
                let below = || self.unit(field).and_then(time_unit);
                Some(TimeFields {
                    field,
                    unit: unit.or_else(below),
                    rest: rest_of_second(&self.names, field),
                })
            }
            _ => None,
        });
        // More fields than these are hardly times, and each is compared with all names.
        let times: Vec<TimeFields> = times.take(MOST_BESIDE).collect();
        // A field that has only the unit of a time may be a duration, such as `latency_ms`.
        let is_named = |time: &&TimeFields| is_named_time(self.names[time.field]);
        let first = times.iter().find(is_named).or(times.first())?;
        let has_first = |time: &&TimeFields| time.rest.is_some_and(|(rest, _)| rest == first.field);
        Some(*times.iter().find(has_first).unwrap_or(first))
    }
}

/// Returns the cell of a sensor that has only one: the only field without another role, if its name is that of a first
/// cell. Among other fields, such a name may be chance.
fn only_cell(names: &[&str]) -> Option<NamedCells> {
    if names.len() > MOST_BESIDE {
        return None;
    }
    let roles = roles(names);
    let mut others = (0..names.len()).filter(|&field| roles[field].is_none());
    let (cell, only) = (others.next()?, others.next().is_none());
    let is_cell = only && is_first_cell(names[cell]);
    is_cell.then(|| NamedCells::Grid(FrameSize::SMALLEST, vec![cell]))
}

/// Returns true if a line with words is a frame like the next line, with a date or a label beside its cells: words
/// and numbers are in the same fields. Otherwise it holds the names of the fields, such as `label,0,1,2,3` above
/// `cup,7,5,9,3`: its numbers count up, from 0 or beside a word that is a usual name.
pub(super) fn is_like_next(header: &TableHeader<'_>, separator: Separator, next: &[u8]) -> bool {
    let names = &header.names;
    let next = separator.fields_of(next, names.len());
    let next: Vec<&[u8]> = next.take(names.len() + 1).collect();
    let is_word = |field: &[u8]| !separator.is_numeric(field);
    let mut pairs = names.iter().zip(&next);
    let same = pairs.all(|(own, next)| is_word(own.as_bytes()) == is_word(next));
    if next.len() != names.len() || !same {
        return false;
    }
    let words = || {
        let pairs = names.iter().zip(&next);
        pairs.filter(|(_, next)| is_word(next))
    };
    let repeats = words().all(|(own, next)| own.as_bytes() == *next);
    let is_name = |name: &str| name.starts_with(char::is_alphabetic) && role(name).is_some();
    let is_named = words().any(|(own, _)| is_name(own));
    let numbers = names.len() - words().count();
    let counts = matches!(
        header.cells,
        Some(NamedCells::Counted(start, length)) if length == numbers && (names[start] == "0" || is_named)
    );
    repeats || !counts
}

/// Returns the field of a wrong value, such as `1O`, `inf`, `4mV` or `>255`, among numbers; None if the line may hold
/// names or texts. A single such field does not make a line of values a header: names that are numbers count up, or
/// have a word with a known role or at their beginning.
pub(super) fn wrong_value(header: &TableHeader<'_>, separator: Separator) -> Option<usize> {
    let names = &header.names;
    let mut words =
        (0..names.len()).filter(|&field| !separator.is_numeric(names[field].as_bytes()));
    let (word, only) = (words.next()?, words.next().is_none());
    let name = names[word];
    let is_name = name.starts_with(char::is_alphabetic) && (word == 0 || role(name).is_some());
    // Cells that are counted from 0 have names, and so has the field before them.
    let is_header = word == 0 && header.count_from_0(1).is_some();
    let is_no_name = header.cells.is_none() && !is_name && !is_date(name);
    let is_wrong = is_like_number(name) || is_no_name;
    (only && names.len() > 2 && !is_header && is_wrong).then_some(word)
}

/// Returns true if a field may be a date or a time of day.
fn is_date(word: &str) -> bool {
    let begins = word.starts_with(|first: char| first.is_ascii_digit());
    begins && word.contains(['/', ':', '-']) || moment::read(word.as_bytes()).is_some()
}

/// Returns true if a word begins as a number does, or is infinite. Dates and times of day are not meant as numbers.
fn is_like_number(word: &str) -> bool {
    let bare = word.trim_start_matches(['+', '-']);
    let is_infinite = ["inf", "infinity"]
        .iter()
        .any(|name| bare.eq_ignore_ascii_case(name));
    let digits = bare.strip_prefix('.').unwrap_or(bare);
    is_infinite || !is_date(word) && digits.starts_with(|first: char| first.is_ascii_digit())
}

/// Returns true if at least half of the fields of a line are numbers.
pub(super) fn is_mostly_numeric(separator: Separator, line: &[u8]) -> bool {
    let (mut all, mut numeric) = (0, 0);
    for field in separator.fields(line) {
        all += 1;
        numeric += usize::from(separator.is_numeric(field));
    }
    numeric > 0 && 2 * numeric >= all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_above_equal_words_are_values() {
        let is_frame = |names: &[&str], next: &str| {
            let header = TableHeader::new(names.to_vec(), 1);
            is_like_next(&header, Separator::Byte(b','), next.as_bytes())
        };
        assert!(is_frame(&["cup", "7", "5", "9"], "cup,7,4,9"));
        assert!(!is_frame(&["label", "0", "1", "2"], "cup,7,5,9"));
        assert!(!is_frame(&["a", "b", "c"], "1,2,3"));
    }

    #[test]
    fn names_may_count_from_0() {
        for (names, alone, after_another) in [
            (&["0", "1", "2"][..], Some(3), None),
            (&["", "0", "1", "2"], Some(3), Some(3)),
            (&["label", "0", "1", "2"], None, Some(3)),
            (&["label", "", "0", "1", "2"], None, Some(3)),
            (&["a", "b", "0", "1", "2"], None, None),
            (&["1", "2", "3"], None, None),
            (&["0", "1", "2", "sum"], None, None),
            (&["a", "b"], None, None),
        ] {
            let header = TableHeader::new(names.to_vec(), 1);
            let found = [0, 1].map(|others| header.count_from_0(others));
            assert_eq!(found, [alone, after_another], "{names:?}");
        }
    }

    #[test]
    fn a_sensor_of_one_cell_has_a_name_like_any_other() {
        for (names, cell) in [
            (&["t", "S0_0"][..], Some(1)),
            (&["frame", "r1c1", "time"], Some(1)),
            (&["", "pad[0][0]"], Some(1)),
            (&["S0_0"], Some(0)),
            // Another field may be the cell, or it is not the first cell.
            (&["x1", "S0_0"], None),
            (&["t", "force", "run_1_1"], None),
            (&["t", "S0_1"], None),
            (&["t", "S0"], None),
            (&["", "1.1"], None),
        ] {
            let header = TableHeader::new(names.to_vec(), 1);
            let expected = cell.map(|cell| NamedCells::Grid(FrameSize::SMALLEST, vec![cell]));
            assert_eq!(header.cells, expected, "{names:?}");
        }
    }

    #[test]
    fn a_wrong_value_does_not_make_a_header() {
        let found = |line: &str| {
            let header = TableHeader::new(line.split(',').collect(), 1);
            wrong_value(&header, Separator::Byte(b','))
        };
        for line in [
            "1,inf,3,4",
            "12,13,1O,14",
            "1,2,3,1e301",
            "4mV,1,2",
            "-Inf,3,4",
            "1,>255,3,4",
            "1,-,3,4",
            "?,2,3,4",
            "7,2,ERR,4",
            "9,2,3,x",
        ] {
            assert!(found(line).is_some(), "{line}");
        }
        for line in [
            "label,0,1,2",
            "2024_run1,0,1,2",
            "3D force,0,1,2",
            "0,1,2,sum",
            "time,0.5,1,1.5",
            "10,20,30,time",
            "a,b,c",
            "1a,1b,1c",
            "01/02/2024,1,2",
            "12:00:00,1,2",
            "2024-05-01,7,5",
            "1,2,3",
        ] {
            assert_eq!(found(line), None, "{line}");
        }
    }

    #[test]
    fn a_timestamp_may_stand_before_numbers() {
        let row = moment_of_row(Separator::Spaces, b"12:00:00.25 0 11 8");
        assert_eq!(row, Some((&b"12:00:00.25"[..], &b"0 11 8"[..])));
        assert_eq!(moment_of_row(Separator::Spaces, b"12:00:00.25 a b"), None);
        assert!(is_mostly_numeric(Separator::Spaces, b"a 1"));
        assert!(!is_mostly_numeric(Separator::Spaces, b"a b 1"));
    }
}
