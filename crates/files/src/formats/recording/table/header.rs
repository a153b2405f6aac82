//! Reads the header of a table: decides whether the first line holds names or values, and finds the lines that hold
//! neither, the units, the time and the cells.
//!
//! | names | are |
//! |---|---|
//! | `r0c0,r0c1,r1c0,r1c1`, `S3_12`, `pad2[0][1]` | rows and columns: the last two numbers of each name; the rest is the same in all |
//! | `c0r0`, `col0_row0`, `x0y0` | the same, but columns and rows |
//! | `0,1,2,3`, `v1,v2,v3` | cells one after the other; their rows and columns are not known |
//!
//! Numbers of rows and columns may start anywhere, but none may be missing: otherwise the names do not describe
//! cells.

use crate::formats::recording::error::unknown_format;
use std::io::BufRead;

use taxel_core::frame::FrameSize;

use crate::error::ReadError;
use crate::formats::recording::table::delimited::TimeFields;
use crate::formats::recording::text::{Separator, TextLines, is_blank, is_comment, is_none};
use crate::formats::recording::time;
use crate::formats::recording::time::field_role::{
    FieldRole, is_named_time, rest_of_second, role, roles, time_unit,
};

/// The most fields beside the cells.
pub(super) const MOST_BESIDE: usize = 16;

pub(super) fn first_line(lines: &mut TextLines<impl BufRead>) -> Result<Vec<u8>, ReadError> {
    while lines.advance_to_content()? && is_comment(lines.line()) {}
    let first = lines.line();
    if is_blank(first) || is_comment(first) {
        return Err(unknown_format());
    }
    Ok(first.to_owned())
}

/// Splits a line into the text of the timestamp at its beginning and the numbers after it; None if anything else is
/// there.
pub(super) fn moment_of_row(separator: Separator, line: &[u8]) -> Option<(&[u8], &[u8])> {
    let (_, row) = time::leading(line)?;
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
    pub(super) names: Vec<&'a str>,
    /// The cells that the names describe; None if they do not describe any.
    pub(super) cells: Option<NamedCells>,
    pub(super) number: u64,
    pub(super) units: Option<(u64, Vec<String>)>,
}

impl<'a> TableHeader<'a> {
    /// Finds the cells that the names in line `number` describe.
    pub(super) fn new(names: Vec<&'a str>, number: u64) -> Self {
        Self {
            cells: named_cells(&names).or_else(|| only_cell(&names)),
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

fn is_date(word: &str) -> bool {
    let begins = word.starts_with(|first: char| first.is_ascii_digit());
    begins && word.contains(['/', ':', '-']) || time::read_moment(word.as_bytes()).is_some()
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

pub(super) fn is_mostly_numeric(separator: Separator, line: &[u8]) -> bool {
    let (mut all, mut numeric) = (0, 0);
    for field in separator.fields(line) {
        all += 1;
        numeric += usize::from(separator.is_numeric(field));
    }
    numeric > 0 && 2 * numeric >= all
}

#[derive(Debug, PartialEq)]
pub(super) enum NamedCells {
    Grid(FrameSize, Vec<usize>),
    /// Consecutive fields that count up: the first of them and their number.
    Counted(usize, usize),
    /// The size of a frame, and the number of its cells that the header names: not all of them.
    Incomplete(FrameSize, usize),
}

/// The most patterns of names that are distinguished.
const MOST_PATTERNS: usize = 64;

/// Returns the cells that the names describe; None if they do not describe any.
pub(super) fn named_cells(names: &[&str]) -> Option<NamedCells> {
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
fn split_numbers<const N: usize>(name: &str) -> Option<(String, [u32; N])> {
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

/// Returns true if a name is that of the first cell of a sensor: `S0_0` or `r1c1`.
pub(in crate::formats::recording) fn is_first_cell(name: &str) -> bool {
    let is_first = matches!(split_numbers::<2>(name), Some((_, [0, 0] | [1, 1])));
    is_first && name.starts_with(char::is_alphabetic)
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
    let split = names
        .iter()
        .map(|name| split_numbers::<2>(name))
        .enumerate();
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
    let named = |name: &&str| split_numbers::<1>(name);
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

#[cfg(test)]
mod tests {
    use super::*;

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
    fn names_of_cells_are_found() {
        let grid = |rows, columns, fields: &[usize]| {
            Some(NamedCells::Grid(
                FrameSize::new(columns, rows).expect("an allowed size"),
                fields.to_vec(),
            ))
        };
        assert_eq!(named_cells(&["time", "S0_0", "S0_1"]), grid(1, 2, &[1, 2]));
        assert_eq!(
            named_cells(&["r1c1", "r2c1", "r1c2", "r2c2"]),
            grid(2, 2, &[0, 2, 1, 3])
        );
        assert_eq!(
            named_cells(&["pad2[0][0]", "pad2[1][0]"]),
            grid(2, 1, &[0, 1])
        );
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
            assert_eq!(
                named_cells(&names),
                grid(2, 3, &[0, 1, 2, 3, 4, 5]),
                "{names:?}"
            );
        }
        let row_first = ["y0x0", "y0x1", "y0x2", "y1x0", "y1x1", "y1x2"];
        assert_eq!(named_cells(&row_first), grid(2, 3, &[0, 1, 2, 3, 4, 5]));
        assert_eq!(
            named_cells(&["frame", "time", "0", "1", "2", "3"]),
            Some(NamedCells::Counted(2, 4))
        );
        assert_eq!(
            named_cells(&["v1", "v2", "v3", "note"]),
            Some(NamedCells::Counted(0, 3))
        );
        // A cell is missing, and no names count up.
        let incomplete = |rows, columns, found| {
            Some(NamedCells::Incomplete(
                FrameSize::new(columns, rows).expect("an allowed size"),
                found,
            ))
        };
        assert_eq!(named_cells(&["r0c0", "r0c1", "r1c0"]), incomplete(2, 2, 3));
        assert_eq!(
            named_cells(&["r0c0", "r0c1", "r0c2", "r0c4"]),
            incomplete(1, 5, 4)
        );
        // Half of the cells are too few.
        assert_eq!(named_cells(&["r0c0", "r1c1"]), None);
        // One cell is there twice.
        assert_eq!(named_cells(&["r0c0", "r0c1", "r0c1"]), None);
        assert_eq!(named_cells(&["a", "b"]), None);
        // Other fields of the frame may come after its cells.
        let named = [
            "S0_0", "S0_1", "S0_2", "S1_0", "S1_1", "S1_2", "total", "run_1_2",
        ];
        assert_eq!(named_cells(&named), grid(2, 3, &[0, 1, 2, 3, 4, 5]));
        let label = named_cells(&["S0_0", "S0_1", "S0_2", "S1_0", "label"]);
        assert_eq!(label, incomplete(2, 3, 4));
        // A pair of numbers is not a cell if more names count up.
        let counted = Some(NamedCells::Counted(2, 4));
        for [first, second] in [["a_1_1", "a_1_2"], ["x_2024_01", "x_2025_02"]] {
            assert_eq!(
                named_cells(&[first, second, "c0", "c1", "c2", "c3"]),
                counted
            );
        }
        assert_eq!(named_cells(&["s0_0", "s0_4294967295"]), None);
        // The names of a single row count up, too, but they are pairs.
        assert_eq!(
            named_cells(&["S0_0", "S0_1", "S0_2"]),
            grid(1, 3, &[0, 1, 2])
        );
        // Of two runs of the same length, the first counts.
        assert_eq!(
            named_cells(&["a1", "a2", "a3", "b1", "b2", "b3"]),
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
            match named_cells(&names) {
                Some(NamedCells::Grid(size, _)) => Some((size.rows(), size.columns())),
                _ => None,
            }
        };
        assert_eq!(sides(&row(512)), Some((1, 512)));
        assert_eq!(sides(&row(513)), None);
    }
}
