//! An imprint with its descriptors as people read it: the matrix with rulers, what made it, a table of its regions.
//!
//! The rulers count columns and rows from 0; the number of a column stands at its left edge, so it is the plane's x
//! there. In the table a line is a descriptor and a column a region; where the regions do not fit beside each other
//! the table goes on below. Lengths are in sides of a cell, and in mm where a pitch is given.

use std::fmt::Write;

use crate::cli::output::charset::Charset;
use crate::description::{DESCRIPTORS, Description, Descriptor, Dimension, RegionKind, regions};
use crate::formats::{DescribedImprint, json, value};
use crate::imprint::Imprint;
use crate::parameter::number::short;
use crate::sensor::Sensor;
use crate::source::Source;
use crate::touch::reaches_beyond;

/// No line of a table is longer, unless a single region is.
const WIDTH: usize = 80;

/// The answer as one line of JSON.
pub(crate) fn json(imprint: &Imprint) -> String {
    let mut line = json::text(&DescribedImprint(imprint));
    line.push('\n');
    line
}

/// JSON that quotes what others wrote, with all but ASCII escaped: the same bytes in every locale, and safe on a
/// terminal.
pub(crate) fn ascii_json(json: &str) -> String {
    let mut ascii = String::with_capacity(json.len());
    for unit in json.encode_utf16() {
        match u8::try_from(unit) {
            Ok(byte @ b' '..=b'~') => ascii.push(char::from(byte)),
            // Cannot fail: a String takes everything.
            _ => drop(write!(ascii, "\\u{unit:04x}")),
        }
    }
    ascii
}

/// What made the imprint, and whether all of it is on the sensor.
pub(crate) fn made(source: &Source, sensor: &Sensor) -> Vec<String> {
    let mut lines = vec![source.to_string()];
    if reaches_beyond(source, sensor) {
        lines.push(format!("the {} reaches beyond the sensor", source.noun()));
    }
    lines
}

/// The size of the matrix, of its cells where a pitch is known, the sensor's threshold, and the active taxels.
pub(crate) fn size(imprint: &Imprint, sensor: Option<&Sensor>, pitch: Option<f64>) -> String {
    let cells = pitch.map_or(String::new(), |pitch| format!(" of {} mm", short(pitch)));
    let threshold = sensor.map_or(String::new(), |sensor| {
        format!(", threshold {}", short(sensor.threshold()))
    });
    let (columns, rows, na) = (imprint.columns(), imprint.rows(), imprint.count());
    format!("{columns} × {rows} taxels{cells}{threshold}, NA {na} in all")
}

/// The matrix, the lines that say what made it, and the table of its regions.
pub(crate) fn table(
    imprint: &Imprint,
    made: &[String],
    pitch: Option<f64>,
    charset: Charset,
) -> String {
    let mut text = matrix(imprint, charset);
    text.push('\n');
    for line in made {
        text += &charset.line(line);
        text.push('\n');
    }
    text.push('\n');
    let descriptions: Vec<Description> = regions(imprint).iter().map(Description::of).collect();
    if descriptions.is_empty() {
        text += "no active taxels, so no regions to describe\n";
        return text;
    }
    text + &blocks(
        &labels(pitch, charset),
        &columns(&descriptions, pitch, charset),
    )
}

fn matrix(imprint: &Imprint, charset: Charset) -> String {
    let (active, inactive) = charset.taxels();
    let ruler: Vec<String> = (0..imprint.columns())
        .step_by(2)
        .map(|column| format!("{column:<4}"))
        .collect();
    let mut text = String::from("    ");
    line(&mut text, &ruler.concat());
    for row in 0..imprint.rows() {
        let cell = |column| {
            if imprint.get(column, row) {
                active
            } else {
                inactive
            }
        };
        let cells: String = (0..imprint.columns()).map(cell).collect();
        line(&mut text, &format!("{row:>2}  {cells}"));
    }
    text
}

/// Adds a line without the spaces at its end.
fn line(text: &mut String, line: &str) {
    text.push_str(line.trim_end());
    text.push('\n');
}

/// A line of the table: a descriptor, and the factor that its values are shown times.
struct TableRow {
    descriptor: &'static Descriptor,
    factor: f64,
    label: String,
}

/// All lines; with a pitch, each length and area again in mm and mm².
fn table_rows(pitch: Option<f64>) -> Vec<TableRow> {
    let mut all = Vec::new();
    for descriptor in DESCRIPTORS {
        let (factor, unit) = match descriptor.dimension {
            Dimension::Count | Dimension::Ratio => (1.0, ""),
            Dimension::Length => (1.0, ", cells"),
            Dimension::Area => (1.0, ", cells²"),
            Dimension::Direction => (1.0, ", deg"),
            Dimension::Share => (100.0, ", %"),
        };
        all.push(TableRow {
            descriptor,
            factor,
            label: format!("{:<5}  {}{unit}", descriptor.symbol, descriptor.name),
        });
        let metric = match (descriptor.dimension, pitch) {
            (Dimension::Length, Some(pitch)) => Some((pitch, "mm")),
            (Dimension::Area, Some(pitch)) => Some((pitch * pitch, "mm²")),
            _ => None,
        };
        all.extend(metric.map(|(factor, unit)| TableRow {
            descriptor,
            factor,
            label: format!("{:<5}  in {unit}", ""),
        }));
    }
    all
}

/// The left column of the table, its heading first, all padded to one width.
fn labels(pitch: Option<f64>, charset: Charset) -> Vec<String> {
    let mut labels = vec![String::new()];
    labels.extend(
        table_rows(pitch)
            .iter()
            .map(|row| charset.line(&row.label).into_owned()),
    );
    let width = widest(&labels);
    labels
        .iter()
        .map(|label| format!("{label:<width$}"))
        .collect()
}

/// The width of the widest cell, in characters.
fn widest(cells: &[String]) -> usize {
    let widths = cells.iter().map(|cell| cell.chars().count());
    widths.fold(0, usize::max)
}

/// A column for each region, its heading first, padded to one width each.
fn columns(descriptions: &[Description], pitch: Option<f64>, charset: Charset) -> Vec<Vec<String>> {
    let rows = table_rows(pitch);
    let (mut exteriors, mut holes) = (0, 0);
    let column = |description: &Description| {
        let number = match description.kind {
            RegionKind::Exterior => &mut exteriors,
            RegionKind::Hole => &mut holes,
        };
        *number += 1;
        let mut column = vec![format!("{} {number}", description.kind.name())];
        column.extend(rows.iter().map(|row| {
            let value = (row.descriptor.measure)(description);
            let text = value::times(value, row.factor, 4);
            charset.line(text.as_deref().unwrap_or("–")).into_owned()
        }));
        let width = widest(&column);
        column
            .iter()
            .map(|cell| format!("{cell:>width$}"))
            .collect()
    };
    descriptions.iter().map(column).collect()
}

/// The columns beside each other, as many as fit, then the others below.
fn blocks(labels: &[String], mut columns: &[Vec<String>]) -> String {
    let width = |column: &[String]| column.first().map_or(0, |cell| cell.chars().count());
    let mut text = String::new();
    while !columns.is_empty() {
        let mut used = width(labels);
        let fitting = columns.iter().take_while(|column| {
            used += 2 + width(column);
            used <= WIDTH
        });
        let (block, rest) = columns.split_at(fitting.count().max(1));
        columns = rest;
        if !text.is_empty() {
            text.push('\n');
        }
        for (index, label) in labels.iter().enumerate() {
            let mut row = label.clone();
            for cell in block.iter().filter_map(|column| column.get(index)) {
                // Cannot fail: a String takes everything.
                let _ = write!(row, "  {cell}");
            }
            line(&mut text, &row);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_of_many_regions_goes_on_below() {
        let imprint: Imprint = "#.#.#.#\n.......\n#.#.#.#".parse().expect("rows");
        let text = table(&imprint, &[], Some(2.5), Charset::Unicode);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        for index in 1..=8 {
            assert_eq!(text.matches(&format!("exterior {index}")).count(), 1);
        }
    }
}
