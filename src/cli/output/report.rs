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
//! The number of a column is at its left edge, where x has this value. Regions that do not fit into 80 columns follow
//! in another block below. If the pitch is known, lengths and areas are in mm too.

use std::fmt::Display;
use std::iter;

use taxel_core::description::{
    DESCRIPTORS, Description, Descriptor, Dimension, RegionKind, regions,
};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_core::parameter::number::short;
use taxel_core::sensor::{MatrixSize, Sensor};
use taxel_core::source::Source;
use taxel_core::touch::reaches_beyond;
use taxel_files::formats::value::{self, characters, fitting};
use taxel_files::formats::{DescribedImprint, json};

use crate::cli::output::charset::Charset;
use crate::cli::output::table;

/// The width of a table, in characters. A single region is never split, even if it is wider.
const WIDTH: usize = 80;

pub(crate) fn json(imprint: &Imprint) -> String {
    json::text(&DescribedImprint(imprint)) + "\n"
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

/// Returns the whole report: the matrix, the lines `made` about its source, and the table of its regions.
pub(crate) fn table(imprint: &Imprint, made: &[String], pitch: Option<f64>) -> String {
    let (active, inactive) = Charset::current().taxels();
    let taxel = |column, row| {
        if imprint.get(column, row) {
            active
        } else {
            inactive
        }
    };
    let mut text = ruled(imprint.size(), taxel) + "\n";
    for line in made {
        text += &Charset::current().line(line);
        text.push('\n');
    }
    text.push('\n');
    let regions: Vec<Description> = regions(imprint).iter().map(Description::of).collect();
    if regions.is_empty() {
        return text + "no active taxels, so no regions to describe\n";
    }
    text + &region_table(&regions, pitch)
}

/// Draws a matrix with the numbers of its columns and rows. A cell takes two characters.
pub(crate) fn ruled<T: Display>(size: MatrixSize, cell: impl Fn(u8, u8) -> T) -> String {
    let mut text = String::from("    ");
    for column in (0..size.columns()).step_by(2) {
        text += &format!("{column:<4}");
    }
    text.truncate(text.trim_end().len());
    for row in 0..size.rows() {
        let cells: String = (0..size.columns())
            .map(|column| cell(column, row).to_string())
            .collect();
        text += format!("\n{row:>2}  {cells}").trim_end();
    }
    text + "\n"
}

/// Draws the values of all cells, with numbers of columns and rows as beside imprints, and a legend of the shades. A
/// cell of 0 or less is a dot; a cell without a value is blank.
pub(crate) fn heat_map(values: &Matrix<f64>, unit: &str, charset: Charset) -> String {
    let largest = values.values().iter().copied().fold(0.0, f64::max);
    let ascii = charset == Charset::Ascii;
    let zero = value::character(0.0, ascii);
    let map = ruled(values.size(), |column, row| {
        let shade = match values.row(row)[usize::from(column)] {
            // If no value is above 0, there is no share.
            value if value <= 0.0 => zero,
            value => value::character(value / largest, ascii),
        };
        [shade, if shade == zero { ' ' } else { shade }]
            .iter()
            .collect::<String>()
    });
    let scale: String = characters(ascii)[1..].iter().collect();
    map + &format!("0 {scale} {}{unit}\n", fitting(largest, 9))
}

/// A row of the table: its label, its descriptor, and the factor applied to the values (the pitch, or 100 for percent).
type Row = (String, &'static Descriptor, f64);

/// Returns the rows of the table. `holes` tells whether a region is a hole, whose taxels are not active.
fn table_rows(pitch: Option<f64>, holes: bool) -> Vec<Row> {
    let mut rows = Vec::new();
    for descriptor in DESCRIPTORS {
        let (factor, unit) = match descriptor.dimension {
            // An area is in taxels, as its name says.
            Dimension::Count | Dimension::Ratio | Dimension::Area => (1.0, ""),
            Dimension::Length => (1.0, ", cells"),
            Dimension::Direction => (1.0, ", degrees"),
            Dimension::Share => (100.0, ", %"),
        };
        let is_any = holes && descriptor.key == "na";
        let name = if is_any { "taxels" } else { descriptor.name };
        let label = format!("{:<5}  {name}{unit}", descriptor.symbol);
        rows.push((label, descriptor, factor));
        let metric = match (descriptor.dimension, pitch) {
            (Dimension::Length, Some(pitch)) => Some((pitch, "mm")),
            (Dimension::Area, Some(pitch)) => Some((pitch * pitch, "mm²")),
            _ => None,
        };
        rows.extend(
            metric.map(|(factor, unit)| (format!("{:<5}  in {unit}", ""), descriptor, factor)),
        );
    }
    rows
}

/// Returns the table: a row for each descriptor, a column for each region with a heading such as `hole 2`.
fn region_table(regions: &[Description], pitch: Option<f64>) -> String {
    let holes = regions.iter().any(|it| it.kind == RegionKind::Hole);
    let rows = table_rows(pitch, holes);
    let labels: Vec<String> = rows.iter().map(|row| row.0.clone()).collect();
    let labels = [vec![String::new()], labels].concat();
    let mut columns = Vec::new();
    for (index, region) in regions.iter().enumerate() {
        let same = |other: &&Description| other.kind == region.kind;
        let number = regions[..=index].iter().filter(same).count();
        let mut column = vec![format!("{} {number}", region.kind.name())];
        column.extend(rows.iter().map(|(_, descriptor, factor)| {
            let text = value::times((descriptor.measure)(region), *factor, 4);
            text.unwrap_or("–".to_owned())
        }));
        columns.push(column);
    }
    let widest = |cells: &mut dyn Iterator<Item = &String>| {
        let widths = cells.map(|cell| cell.chars().count());
        widths.max().unwrap_or(0)
    };
    let room = WIDTH.saturating_sub(widest(&mut labels.iter()));
    let most = room / (2 + widest(&mut columns.iter().flatten()));
    let block = |block: &[Vec<String>]| {
        let row = |(index, label): (usize, &String)| {
            let cells = block.iter().map(|column| column[index].clone());
            iter::once(label.clone()).chain(cells).collect()
        };
        let rows: Vec<Vec<String>> = labels.iter().enumerate().map(row).collect();
        table::table(&rows, &[0])
    };
    let blocks: Vec<String> = columns.chunks(most.max(1)).map(block).collect();
    blocks.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_of_many_regions_continues_below() {
        let imprint: Imprint = "#.#.#.#\n.......\n#.#.#.#".parse().expect("rows");
        let text = table(&imprint, &[], Some(2.5));
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        for index in 1..=8 {
            assert_eq!(text.matches(&format!("exterior {index}")).count(), 1);
        }
    }

    #[test]
    fn shades_divide_the_range_evenly() {
        let size = MatrixSize::new(6, 1).expect("an allowed size");
        let values = vec![0.0, f64::NAN, 1.0, 25.0, 26.0, 100.0];
        let values = Matrix::from_values(size, values).expect("as many");
        assert_eq!(
            heat_map(&values, " kPa", Charset::Unicode),
            "    0   2   4\n 0  ·   ░░░░▒▒██\n0 ░▒▓█ 100 kPa\n"
        );
        assert_eq!(
            heat_map(&values, "", Charset::Ascii),
            "    0   2   4\n 0  .   ::--==@@\n0 :-=+*#%@ 100\n"
        );
    }
}
