//! Helpers of the old decoder, which goes.

use crate::formats::recording::time::{Moment, read_moment};

pub(super) const SEPARATORS: [u8; 3] = *b";,\t";

pub(super) const ABOVE_ROWS: &str =
    "found one value above rows of numbers; if it is the time of a frame, begin such lines with #";

pub(super) fn is_alone(line: &[u8]) -> bool {
    !line.iter().any(|byte| b",;".contains(byte)) && read_moment(line).is_some()
}

/// Splits a line into the timestamp at its beginning and the numbers after it; None if either is missing. A comma
/// separates cells. If they are not separated by commas, as in `12:00:00,125 7 3`, there is no timestamp.
pub(super) fn leading(line: &[u8]) -> Option<(Moment, &[u8])> {
    let mark = if line.contains(&b';') { b';' } else { b',' };
    let line = line.trim_ascii_start();
    let end_of = |from: usize| {
        let is_end = |&byte: &u8| byte == mark || byte.is_ascii_whitespace();
        let end = line[from..].iter().position(is_end);
        end.map(|end| from + end)
    };
    let first = end_of(0)?;
    let is_clock = line[..first].contains(&b':');
    if !is_clock && !line[..first].contains(&b'-') && !line[..first].contains(&b'/') {
        return None;
    }
    // The timestamp may be a date, a blank and a time.
    let end = if is_clock { first } else { end_of(first + 1)? };
    let moment = read_moment(&line[..end])?;
    let rest = line[end..].trim_ascii_start();
    let Some(cells) = rest.strip_prefix(&[mark]) else {
        return Some((moment, rest)).filter(|_| !rest.is_empty());
    };
    let digits = cells
        .iter()
        .take_while(|digit| digit.is_ascii_digit())
        .count();
    let may_be_fraction = mark == b',' && digits > 0 && !cells[digits..].contains(&b',');
    (!may_be_fraction && !cells.trim_ascii().is_empty()).then_some((moment, cells))
}
