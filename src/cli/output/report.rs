//! An imprint and its descriptors as text: the matrix with rulers, the source, and a table of its regions.
//! ```text
//!     0   2
//!  0  ██████
//!  1  ██· ██
//!  2  ██████
//!
//! 3 × 3 taxels, NA 8 in all
//!
//!                                     exterior 1       hole 1
//! NA     active taxels                         8            1
//! NAE    filled taxels                         9            1
//! ```
//! The rulers count columns and rows from 0. The number of a column is at its left edge, where x has this value. In
//! the table a row is a descriptor and a column is a region; regions that do not fit into 80 columns follow in
//! another block below. Lengths are in cells; if the pitch is known, another row gives them in mm.

use std::fmt::Write;
use std::iter;

use taxel_core::description::{
    DESCRIPTORS, Description, Descriptor, Dimension, RegionKind, regions,
};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::short;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::touch::reaches_beyond;
use taxel_files::formats::{DescribedImprint, json, value};

use crate::cli::output::charset::Charset;

/// The width of a table, in characters. A single region is never split, even if it is wider.
const WIDTH: usize = 80;

pub(crate) fn json(imprint: &Imprint) -> String {
    let mut line = json::text(&DescribedImprint(imprint));
    line.push('\n');
    line
}

pub(crate) fn beyond(source: &Source, sensor: &Sensor) -> Option<String> {
    let noun = source.noun();
    reaches_beyond(source, sensor).then(|| format!("the {noun} reaches beyond the sensor"))
}

/// Returns the line with the size of the matrix, the pitch and the threshold if they are known, and the active
/// taxels: `16 × 16 taxels of 2.5 mm, threshold 0.5, NA 36 in all`.
pub(crate) fn size(imprint: &Imprint, sensor: Option<&Sensor>, pitch: Option<f64>) -> String {
    let cells = pitch.map_or(String::new(), |pitch| format!(" of {} mm", short(pitch)));
    let threshold = sensor.map_or(String::new(), |sensor| {
        format!(", threshold {}", short(sensor.threshold()))
    });
    let (columns, rows, na) = (imprint.columns(), imprint.rows(), imprint.count());
    format!("{columns} × {rows} taxels{cells}{threshold}, NA {na} in all")
}

/// Returns the whole report: the matrix, the lines `made` about its source, and the table of its regions. With
/// `pitch`, the side of a cell in mm, lengths and areas are given in mm and mm² too.
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
        &labels(&descriptions, pitch, charset),
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

fn line(text: &mut String, line: &str) {
    text.push_str(line.trim_end());
    text.push('\n');
}

/// A row of the table: a descriptor, the factor that is applied to its values (the pitch, or 100 for percent), and
/// the label on the left.
struct TableRow {
    descriptor: &'static Descriptor,
    factor: f64,
    label: String,
}

/// Returns the rows of the table. `holes` tells whether a region is a hole, whose taxels are not active. With a
/// pitch, each length is followed by the same length in mm, and each area by the same area in mm².
fn table_rows(pitch: Option<f64>, holes: bool) -> Vec<TableRow> {
    let mut all = Vec::new();
    for descriptor in DESCRIPTORS {
        let (factor, unit) = match descriptor.dimension {
            // An area is in taxels, as its name says.
            Dimension::Count | Dimension::Ratio | Dimension::Area => (1.0, ""),
            Dimension::Length => (1.0, ", cells"),
            Dimension::Direction => (1.0, ", degrees"),
            Dimension::Share => (100.0, ", %"),
        };
        let name = if holes && descriptor.key == "na" {
            "taxels"
        } else {
            descriptor.name
        };
        all.push(TableRow {
            descriptor,
            factor,
            label: format!("{:<5}  {name}{unit}", descriptor.symbol),
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

fn labels(descriptions: &[Description], pitch: Option<f64>, charset: Charset) -> Vec<String> {
    let holes = descriptions.iter().any(|it| it.kind == RegionKind::Hole);
    let rows = table_rows(pitch, holes);
    charset.column(iter::once("").chain(rows.iter().map(|row| &*row.label)))
}

fn widest(cells: &[String]) -> usize {
    let widths = cells.iter().map(|cell| cell.chars().count());
    widths.fold(0, usize::max)
}

/// Returns a column for each region, with a heading such as `hole 2` in the first cell. Each is padded to its own
/// width.
fn columns(descriptions: &[Description], pitch: Option<f64>, charset: Charset) -> Vec<Vec<String>> {
    let rows = table_rows(pitch, false);
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

/// Puts columns side by side, as many as fit into [`WIDTH`], and the others into further blocks below, each with the
/// labels.
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
                // Cannot fail: the text is kept in memory.
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
    fn a_table_of_many_regions_continues_below() {
        let imprint: Imprint = "#.#.#.#\n.......\n#.#.#.#".parse().expect("rows");
        let text = table(&imprint, &[], Some(2.5), Charset::Unicode);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        for index in 1..=8 {
            assert_eq!(text.matches(&format!("exterior {index}")).count(), 1);
        }
    }
}
