//! Finds the fields of a table that are cells, by the names in its header: `S0_0`, `r3c12`, or 0, 1, 2 and so on.
//!
//! | names | are |
//! |---|---|
//! | `r0c0,r0c1,r1c0,r1c1`, `S3_12`, `pad2[0][1]` | rows and columns: the last two numbers of each name; the rest is the same in all |
//! | `c0r0`, `col0_row0`, `x0y0` | the same, but columns and rows |
//! | `0,1,2,3`, `v1,v2,v3` | cells one after the other; their rows and columns are not known |
//!
//! Numbers of rows and columns may start anywhere, but none may be missing: otherwise the names do not describe
//! cells.

use crate::frame::FrameSize;

/// The cells that the header of a table names.
#[derive(Debug, PartialEq)]
pub(super) enum NamedCells {
    /// The size of a frame, and the field of each cell in reading order.
    Grid(FrameSize, Vec<usize>),
    /// Consecutive fields that count up: the first of them and their number.
    Counted(usize, usize),
    /// The size of a frame, and the number of its cells that the header names: not all of them.
    Incomplete(FrameSize, usize),
}

/// The most patterns of names that are distinguished.
const MOST_PATTERNS: usize = 64;

/// Returns the cells that the names describe; None if they do not describe any.
pub(super) fn cells(names: &[&str]) -> Option<NamedCells> {
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

/// Returns true if a name is that of the first cell of a sensor: `S0_0` or `r1c1`.
pub(in crate::formats::recording) fn is_first_cell(name: &str) -> bool {
    let is_first = matches!(split::<2>(name), Some((_, [0, 0] | [1, 1])));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_cells_are_found() {
        let grid = |rows, columns, fields: &[usize]| {
            Some(NamedCells::Grid(
                FrameSize::new(columns, rows).expect("an allowed size"),
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
            Some(NamedCells::Incomplete(
                FrameSize::new(columns, rows).expect("an allowed size"),
                found,
            ))
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
}
