//! An imprint as a table of numbers (CSV): one line per row, 1 for an active taxel, 0 for an inactive one.
//!
//! Tables are written with commas. Read are also tables with semicolons, tabs or blanks, and the ways in which programs
//! write these numbers: `1.0`, `1.000e+00`, `255`, `true`. Comments begin with `#`. Anything else is refused: a table of
//! other numbers would need a threshold, and names or numbers of rows would have to be guessed.

use taxel_core::imprint::Imprint;
use taxel_core::index::index;
use taxel_core::quote::shortened;

use crate::error::ReadError;
use crate::formats::imprint_file::{is_active, text};

pub(super) fn begins(bytes: &[u8]) -> bool {
    let Ok(text) = text(bytes) else { return false };
    let first = lines(text).next();
    first.is_some_and(|(_, line)| fields(line).next().is_some_and(is_number))
}

pub(super) fn read(bytes: &[u8]) -> Result<Imprint, ReadError> {
    let lines: Vec<_> = lines(text(bytes)?).collect();
    let rows: Vec<String> = lines.iter().map(row).collect::<Result<_, _>>()?;
    Imprint::from_rows(rows.iter().map(String::as_str)).map_err(|error| {
        let line = error.row.and_then(|row| lines.get(index(row) - 1));
        ReadError {
            line: line.map(|(number, _)| *number),
            ..error.into()
        }
    })
}

/// Returns a row of an imprint.
fn row((number, line): &(u64, &str)) -> Result<String, ReadError> {
    let taxels = fields(line).zip(1..).map(|(field, column)| {
        let active = active(field).ok_or_else(|| {
            let found = shortened(field);
            let error = ReadError::new(format!("found {found:?}, expected 0, 1 or 255"));
            error.in_line(*number).in_column(column)
        })?;
        Ok(if active { '#' } else { '.' })
    });
    taxels.collect()
}

/// The lines that are neither blank nor comments, with their numbers.
fn lines(text: &str) -> impl Iterator<Item = (u64, &str)> {
    let lines = text.split('\n').map(str::trim);
    (1..)
        .zip(lines)
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

/// The fields of a line. A separator at its end is no field.
pub(super) fn fields(line: &str) -> Box<dyn Iterator<Item = &str> + '_> {
    let found = ['\t', ';', ',']
        .into_iter()
        .find(|mark| line.contains(*mark));
    match found {
        Some(mark) => {
            let line = line.strip_suffix(mark).unwrap_or(line);
            Box::new(line.split(mark).map(str::trim))
        }
        None => Box::new(line.split_whitespace()),
    }
}

fn is_number(field: &str) -> bool {
    active(field).is_some() || field.parse::<f64>().is_ok()
}

/// Returns the state of a taxel. Rows of digits without separators, such as `0110`, are not numbers.
fn active(field: &str) -> Option<bool> {
    if let [b'0', b'0'..=b'9', ..] = field.as_bytes() {
        return None;
    }
    match field.to_ascii_lowercase().as_str() {
        "true" => Some(true),
        "false" => Some(false),
        number => is_active(number.parse().ok()?),
    }
}

pub(super) fn write(imprint: &Imprint) -> Vec<u8> {
    let mut text = String::new();
    for row in imprint.lines() {
        let fields = row.replace('#', "1,").replace('.', "0,");
        text += fields.trim_end_matches(',');
        text.push('\n');
    }
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_other_programs_are_read() {
        let cup = Ok("#.#\n###".to_owned());
        for text in [
            // numpy.savetxt by itself, and with its delimiter set.
            "1.000e+00 0.000e+00 1.000e+00\n1.000e+00 1.000e+00 1.000e+00\n",
            "1.000000000000000000e+00,0.000000000000000000e+00,1.000000000000000000e+00\n1e0,1e0,1e0\n",
            "True,False,True\nTRUE,true,True",
            "1\t0\t1\r\n1\t1\t1\r\n\r\n",
            " 1 ; 0 ; 1 \n1;1;1;",
            "# a cup\n# of six\n+1 -0 1\n1 1 1\n# end\n",
            "255,0,255\n255,255,255\n",
        ] {
            assert!(begins(text.as_bytes()), "{text:?}");
            let read = read(text.as_bytes()).map(|cup| cup.to_string());
            assert_eq!(read, cup, "{text:?}");
        }
    }

    #[test]
    fn errors_name_their_place() {
        for (text, message) in [
            ("# only\n", "expected 1 to 64 rows of '#' and '.'"),
            (&"1\n".repeat(99), "expected 1 to 64 rows of '#' and '.'"),
            (
                &"1,".repeat(65),
                "line 1: found 65 taxels, expected 1 to 64",
            ),
            (
                "1,0\n\n1",
                "line 3: found 1 taxel, expected 2 as in the first row",
            ),
            (
                "1,0\n1,2",
                "line 2, column 2: found \"2\", expected 0, 1 or 255",
            ),
            (
                "0110\n0110",
                "line 1, column 1: found \"0110\", expected 0, 1 or 255",
            ),
            (
                "1,NaN",
                "line 1, column 2: found \"NaN\", expected 0, 1 or 255",
            ),
            ("1,,1", "line 1, column 2: found \"\", expected 0, 1 or 255"),
        ] {
            let error = read(text.as_bytes()).expect_err(text);
            assert_eq!(error.to_string(), message, "{text:?}");
        }
    }
}
