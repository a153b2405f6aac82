//! An imprint as a table of numbers (CSV): one line per row, 1 for an active taxel, 0 for an inactive one.
//!
//! Tables are written with commas and without a heading. They are read as other programs write them: separated by
//! commas, semicolons, tabs or spaces, with or without quotes, with values such as `1`, `1.0`, `1.000e+00` or `true`;
//! any one value besides 0 may mean active. Around the values there may be a line `sep=;`, comment lines that begin
//! with `#`, a row of names, below it a first column without a name, and a separator after the last value of every
//! row. In errors, a column is one of the table.

use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::counted;
use taxel_core::quote::shortened;
use taxel_core::sensor::{MAX_SIDE, MatrixSize};

use crate::formats::imprint_file::Mask;

pub(super) fn read(text: &str) -> Result<Imprint, String> {
    let table = Table::of(text)?;
    let size = table.size()?;
    let mut imprint = Imprint::empty(size);
    let mut mask = Mask::new();
    for (row, cells) in (0..size.rows()).zip(&table.rows) {
        for (column, field) in (0..size.columns()).zip(&cells.fields) {
            let wrong = |expected: String| {
                let place = table.skipped + usize::from(column) + 1;
                format!(
                    "line {}, column {place}: found {:?}, expected 0 or {expected}",
                    cells.line,
                    shortened(field)
                )
            };
            let value = table.value(field).ok_or_else(|| wrong("1".to_owned()))?;
            let active = mask.take((value != 0.0).then_some(value));
            let active = active.map_err(|active| wrong(format!("{active} as before")))?;
            imprint.set(column, row, active);
        }
    }
    match mask.unclear(&[1.0, 255.0]) {
        None => Ok(imprint),
        Some(value) => Err(format!(
            "\"{value}\" everywhere, expected 0, 1 or 255, or two values of which one is 0"
        )),
    }
}

/// A line's fields, without the spaces and quotes around them.
struct LineFields<'a> {
    /// The line number in the file, from 1.
    line: usize,
    fields: Vec<&'a str>,
}

/// The rows of a table, without comments, names and row numbers.
struct Table<'a> {
    /// The separator between the fields of a line; None for spaces.
    mark: Option<char>,
    rows: Vec<LineFields<'a>>,
    /// The number of columns removed before the first.
    skipped: usize,
}

/// The most lines, and fields in a line: names, row numbers and a separator at the end add one each.
const MOST: usize = MAX_SIDE as usize + 2;

impl<'a> Table<'a> {
    fn of(text: &'a str) -> Result<Self, String> {
        // Leave out the blank lines at the end; the last line may end in a separator.
        let end = text.trim_end().len();
        let end = text[end..].find('\n').map_or(text.len(), |rest| end + rest);
        let lines = (1..).zip(text[..end].split('\n'));
        let lines = lines.filter(|(_, line)| !line.trim_start().starts_with('#'));
        let lines = lines.skip_while(|(_, line)| line.trim().is_empty());
        let found = lines.clone().count();
        // One more line, which may name the separator.
        let mut lines: Vec<(usize, &str)> = lines.take(MOST + 1).collect();
        let given = lines.first();
        let given = given.and_then(|(_, line)| named_separator(line.as_bytes()).map(char::from));
        if given.is_some() {
            lines.remove(0);
        }
        let found = found - usize::from(given.is_some());
        let Some((_, last)) = lines.last().filter(|_| found <= MOST) else {
            return Err(wrong_lines(found));
        };
        // The last line holds numbers; names may contain any character. Tabs come first: a comma
        // beside a tab or a semicolon is a decimal sign. Recordings, which are read line by line, have an order of
        // their own: see `recording::text`.
        let in_last = |mark: &char| last.contains(*mark);
        let in_any = |mark: &char| lines.iter().any(|(_, line)| line.contains(*mark));
        let marks = ['\t', ';', ','].into_iter();
        let mark = given.or(marks
            .clone()
            .find(in_last)
            .or_else(|| marks.clone().find(in_any)));
        let mut table = Self {
            mark,
            rows: Vec::with_capacity(found),
            skipped: 0,
        };
        for (line, text) in lines {
            let found = split(text, mark).count();
            if found > MOST {
                return Err(wrong_columns(line, found));
            }
            let fields = split(text, mark).map(bare).collect();
            table.rows.push(LineFields { line, fields });
        }
        table.drop_names();
        Ok(table)
    }

    /// Removes the row of names, the column without a name, and the empty field behind a separator at the end of every
    /// row.
    fn drop_names(&mut self) {
        let Some(first) = self.rows.first() else {
            return;
        };
        let named = self.rows.len() > 1 && self.are_names(&first.fields);
        let names = named.then(|| self.rows.remove(0));
        if self
            .rows
            .iter()
            .all(|row| row.fields.len() > 1 && row.fields.last() == Some(&""))
        {
            for row in &mut self.rows {
                row.fields.pop();
            }
        }
        let values = self.rows.first().map_or(0, |row| row.fields.len());
        // R writes one name fewer than there are columns.
        let numbered = names.is_some_and(|names| {
            names.fields.len() + 1 == values || names.fields.first() == Some(&"")
        });
        if numbered && self.rows.iter().all(|row| row.fields.len() > 1) {
            for row in &mut self.rows {
                row.fields.remove(0);
            }
            self.skipped = 1;
        }
    }

    /// Returns true if the fields of the first row are names: the first one has none, or none is a number.
    fn are_names(&self, fields: &[&str]) -> bool {
        match fields {
            ["", rest @ ..] => rest.iter().any(|field| !field.is_empty()),
            fields => fields
                .iter()
                .all(|field| self.value(field).is_none() && field.parse::<f64>().is_err()),
        }
    }

    /// Returns the size of the table. Returns an error if no imprint has this size, or if rows differ in length.
    fn size(&self) -> Result<MatrixSize, String> {
        let most = usize::from(MAX_SIDE);
        let found = self.rows.len();
        let one_column = MatrixSize::of_sides(1, found);
        let Some((first, one_column)) = self.rows.first().zip(one_column) else {
            return Err(wrong_lines(found));
        };
        let expected = first.fields.len();
        for row in &self.rows {
            let found = row.fields.len();
            if found > most {
                return Err(wrong_columns(row.line, found));
            }
            if found != expected {
                return Err(format!(
                    "line {}: found {}, expected {expected} as in line {}",
                    row.line,
                    counted(found as u64, "value"),
                    first.line
                ));
            }
        }
        MatrixSize::of_sides(expected, one_column.rows())
            .ok_or_else(|| wrong_columns(first.line, expected))
    }

    /// Returns the number in a field; None if it is not a number, or not finite. Rows of digits without separators are
    /// not numbers.
    fn value(&self, field: &str) -> Option<f64> {
        if field.eq_ignore_ascii_case("true") {
            return Some(1.0);
        }
        if field.eq_ignore_ascii_case("false") {
            return Some(0.0);
        }
        if matches!(field.as_bytes(), [b'0', b'0'..=b'9', ..]) {
            return None;
        }
        let number: Option<f64> = field.parse().ok();
        // Where the comma is not the separator, it is the decimal sign.
        let decimal = || field.replacen(',', ".", 1).parse().ok();
        let number = if self.mark == Some(',') {
            number
        } else {
            number.or_else(decimal)
        };
        number.filter(|number| number.is_finite())
    }
}

fn wrong_lines(found: usize) -> String {
    let found = counted(found as u64, "line");
    format!("found {found}, expected 1 to 64")
}

fn wrong_columns(line: usize, found: usize) -> String {
    let found = counted(found as u64, "value");
    format!("line {line}: found {found}, expected 1 to 64")
}

/// Returns the separator that a line `sep=;` names, as spreadsheet programs write it, also in quotes, or with the
/// separators of empty fields behind it. None for any other line.
pub(crate) fn named_separator(line: &[u8]) -> Option<u8> {
    let line = line.trim_ascii();
    let quoted = line.strip_prefix(b"\"").unwrap_or(line);
    let (key, marks) = quoted.split_at_checked(4)?;
    if !key.eq_ignore_ascii_case(b"sep=") {
        return None;
    }
    let marks = marks.strip_suffix(b"\"").unwrap_or(marks);
    // A tab at the end of the line was trimmed as a blank.
    let mark = marks.first().copied().unwrap_or(b'\t');
    let is_usual = matches!(mark, b',' | b';' | b'\t' | b'|');
    (is_usual && marks.iter().all(|&byte| byte == mark)).then_some(mark)
}

/// Splits a line into its fields, at the separator, or at spaces if there is none.
fn split(line: &str, mark: Option<char>) -> impl Iterator<Item = &str> {
    let marked = mark.map(|mark| line.split(mark));
    let spaced = mark.is_none().then(|| line.split_whitespace());
    // A blank line has one empty field, as it has with a separator.
    let blank = (mark.is_none() && line.trim().is_empty()).then_some("");
    marked
        .into_iter()
        .flatten()
        .chain(spaced.into_iter().flatten())
        .chain(blank)
}

/// Removes the spaces and the quotes around a field.
fn bare(field: &str) -> &str {
    let field = field.trim();
    let inner = field
        .strip_prefix('"')
        .and_then(|field| field.strip_suffix('"'));
    inner.unwrap_or(field).trim()
}

pub(super) fn write(imprint: &Imprint) -> String {
    let mut text = String::new();
    for row in 0..imprint.rows() {
        for column in 0..imprint.columns() {
            if column > 0 {
                text.push(',');
            }
            text.push(if imprint.get(column, row) { '1' } else { '0' });
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_other_programs_are_read() {
        let cup = Ok("#.#\n###".to_owned());
        for text in [
            // numpy.savetxt, and with its delimiter set.
            "1.000000000000000000e+00,0.000000000000000000e+00,1.000000000000000000e+00\n1e0,1e0,1e0\n",
            "True,False,True\nTRUE,true,True",
            "1\t0\t1\r\n1\t1\t1\r\n\r\n",
            " 1 ; 0 ; 1 \n1;1;1",
            // numpy.savetxt by itself, and with a header.
            "1.000e+00 0.000e+00 1.000e+00\n1.000e+00 1.000e+00 1.000e+00\n",
            "# a cup\n# of six\n1 0 1\n1 1 1\n# end\n",
            // pandas, with row numbers and without, with names and without.
            ",0,1,2\n0,1,0,1\n1,1,1,1\n",
            ",x,y,z\ntop,True,False,True\nbottom,True,True,True\n",
            "x,y,z\n1,0,1\n1,1,1\n",
            // R writes one name fewer than there are columns.
            "\"V1\" \"V2\" \"V3\"\n\"1\" 1 0 1\n\"2\" 1 1 1\n",
            "\"\",\"V1\",\"V2\",\"V3\"\n\"1\",1,0,1\n\"2\",1,1,1\n",
            // Spreadsheets.
            "sep=;\r\n1;0;1\r\n1;1;1\r\n",
            "SEP=|\n1|0|1\n1|1|1",
            "\"sep=;\"\n1;0;1\n1;1;1\n",
            "sep=,,,\n1,0,1\n1,1,1\n",
            "sep=\t\n1\t0\t1\n1\t1\t1\n",
            "1,0;0,0;1,0\n1,0;1,0;1,0\n",
            "1,0,1,\n1,1,1,\n",
            "a;b;c;\n1;0;1;\n1;1;1;\n",
            "a;b;c\n1;0;1;\n1;1;1;\n",
            // Masks.
            "255,0,255\n255,255,255\n",
            "0.5\t0\t0.5\n0.5\t0.5\t0.5\n",
            "-1 0 -1\n-1 -1 -1",
            "\n\n1,0,1\n1,1,1\n",
        ] {
            assert_eq!(read(text).map(|cup| cup.to_string()), cup, "{text:?}");
        }
        assert_eq!(
            read("1\n0\n").map(|bar| bar.to_string()),
            Ok("#\n.".to_owned())
        );
        let full = |text: &str| read(text).map(|full| full.count());
        assert_eq!(
            (full("255 255"), full("1"), full("0 0")),
            (Ok(2), Ok(1), Ok(0))
        );
    }

    #[test]
    fn errors_name_their_place() {
        let wrong =
            |text: &str, message: &str| assert_eq!(read(text), Err(message.to_owned()), "{text}");
        wrong("# only\n", "found 0 lines, expected 1 to 64");
        wrong(&"1\n".repeat(9999), "found 9,999 lines, expected 1 to 64");
        wrong(
            &"1,".repeat(65),
            "line 1: found 65 values, expected 1 to 64",
        );
        wrong(
            &"1,".repeat(999),
            "line 1: found 1,000 values, expected 1 to 64",
        );
        wrong(
            "1,0\n\n1,0",
            "line 2: found 1 value, expected 2 as in line 1",
        );
        wrong(
            "1,0\n1,2",
            "line 2, column 2: found \"2\", expected 0 or 1 as before",
        );
        wrong(
            ",a,b\n0,7,0\n1,8,7\n",
            "line 3, column 2: found \"8\", expected 0 or 7 as before",
        );
        // Neither a row of numbers nor a column of them is told from values by counting up.
        wrong(
            "0,1,2\n1,0,1\n1,1,1\n",
            "line 1, column 3: found \"2\", expected 0 or 1 as before",
        );
        wrong(
            "0,1,0\n1,0,1\n2,1,0\n",
            "line 3, column 1: found \"2\", expected 0 or 1 as before",
        );
        wrong("11\n01", "line 2, column 1: found \"01\", expected 0 or 1");
        wrong("1,NaN", "line 1, column 2: found \"NaN\", expected 0 or 1");
        wrong("1,inf", "line 1, column 2: found \"inf\", expected 0 or 1");
        wrong("a,b", "line 1, column 1: found \"a\", expected 0 or 1");
        wrong("a,b\n1,c", "line 2, column 2: found \"c\", expected 0 or 1");
        wrong(
            "7 7\n7 7",
            "\"7\" everywhere, expected 0, 1 or 255, or two values of which one is 0",
        );
    }
}
