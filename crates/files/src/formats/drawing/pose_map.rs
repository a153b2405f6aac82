//! A map of positions: the imprint at each x0 and y0, as areas with borders.
//!
//! Borders separate the areas; greys only help the eye, and a bad printer may lose them.

use crate::formats::drawing::plot::axis_marks;
use crate::formats::drawing::svg::{Axis, AxisMarks, Position, Stroke, Svg, line, rectangle};
use crate::formats::value::decimal;

const PLANE: f64 = 288.0;

/// The most cells along a side; more cannot be told apart in print.
const MOST: usize = 1024;

/// The greys of the imprints, in turn.
const GREYS: [u8; 5] = [255, 232, 209, 186, 163];

/// A map of positions to draw.
///
/// ```
/// use taxel_files::formats::PoseMap;
/// let ids = [Some(0), Some(0), Some(7), None];
/// let map = PoseMap::new((5.0, 5.1), (5.0, 5.1), 2, &ids).expect("two rows of two");
/// assert!(map.svg().contains(">x0 / cells</text>"));
/// ```
#[derive(Clone, Debug)]
pub struct PoseMap {
    /// The first and the last x0, then those of y0.
    ends: [(f64, f64); 2],
    columns: usize,
    ids: Vec<Option<u32>>,
    /// What stands above; only its first 100 characters are drawn.
    pub title: String,
}

impl PoseMap {
    /// Makes a map from the numbers of the imprints, row by row, at positions from the first x0 and y0 to the last;
    /// an entry of None is a position without an imprint. Returns None if the last row is not full, if a side has no
    /// cell or more than 1,024, or if an end is not finite.
    pub fn new(
        x0: (f64, f64),
        y0: (f64, f64),
        columns: usize,
        ids: &[Option<u32>],
    ) -> Option<Self> {
        let rows = ids.len().checked_div(columns)?;
        let drawn = 1..=MOST;
        let whole =
            rows * columns == ids.len() && drawn.contains(&rows) && drawn.contains(&columns);
        let finite = [x0.0, x0.1, y0.0, y0.1].into_iter().all(f64::is_finite);
        (whole && finite).then(|| Self {
            ends: [x0, y0],
            columns,
            ids: ids.to_vec(),
            title: String::new(),
        })
    }

    fn rows(&self) -> usize {
        self.ids.len() / self.columns
    }

    fn id(&self, column: usize, row: usize) -> Option<u32> {
        self.ids[row * self.columns + column]
    }

    /// The map as SVG 1.1.
    pub fn svg(&self) -> String {
        let (columns, rows) = (self.columns, self.rows());
        let side = PLANE / count(columns.max(rows));
        let place = |column: usize, row: usize| (count(column) * side, count(row) * side);
        let mut svg = Svg::new(place(columns, rows));
        for (path, grey) in self.areas(&place).iter().zip(GREYS) {
            svg.fill("imprints", path, grey);
        }
        svg.line("borders", &self.borders(&place), Stroke::black(0.5));
        let [x0, y0] = self.ends;
        let axis = |name: &str, ends: (f64, f64), cells: usize| Axis {
            title: format!("{name} / cells"),
            ends,
            // A position stands at the centre of its cell.
            span: (side / 2.0, (count(cells) - 0.5) * side),
            marks: marks_of(ends, cells),
        };
        let (across, along) = (axis("x0", x0, columns), axis("y0", y0, rows));
        svg.axes(AxisMarks::Outside, &across, &along);
        svg.finish("imprints of positions", &self.title)
    }

    /// The cells of each grey; neighbours in a row with the same imprint form one rectangle.
    fn areas(&self, place: &dyn Fn(usize, usize) -> Position) -> [String; GREYS.len()] {
        let mut areas = [const { String::new() }; GREYS.len()];
        for (row, ids) in self.ids.chunks(self.columns).enumerate() {
            let mut column = 0;
            for alike in ids.chunk_by(|one, other| one == other) {
                let end = column + alike.len();
                if let Some(id) = alike[0] {
                    let [grey, ..] = (id % 5).to_le_bytes();
                    areas[usize::from(grey)] += &rectangle(place(column, row), place(end, row + 1));
                }
                column = end;
            }
        }
        areas
    }

    /// The lines between cells of different imprints; adjoining ones form one line.
    fn borders(&self, place: &dyn Fn(usize, usize) -> Position) -> String {
        let (columns, rows) = (self.columns, self.rows());
        let mut lines = String::new();
        for row in 1..rows {
            let differs = |column: usize| self.id(column, row - 1) != self.id(column, row);
            for (from, to) in runs(columns, differs) {
                lines += &line(place(from, row), place(to, row));
            }
        }
        for column in 1..columns {
            let differs = |row: usize| self.id(column - 1, row) != self.id(column, row);
            for (from, to) in runs(rows, differs) {
                lines += &line(place(column, from), place(column, to));
            }
        }
        lines
    }
}

#[expect(clippy::cast_precision_loss, reason = "at most 1,024")]
fn count(cells: usize) -> f64 {
    cells as f64
}

/// The marks of an axis with a number of cells from one value to another; a single mark if both are the same.
fn marks_of((one, other): (f64, f64), cells: usize) -> Vec<(f64, String)> {
    let (low, high) = (one.min(other), one.max(other));
    if cells > 1 && low < high {
        axis_marks((low, high), 0.0, 6)
    } else {
        vec![(one, decimal(one, 6))]
    }
}

/// The runs of consecutive indices below `count` for which a condition holds, as half-open ranges.
fn runs(count: usize, holds: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for index in (0..count).filter(|&index| holds(index)) {
        match runs.last_mut() {
            Some((_, end)) if *end == index => *end += 1,
            _ => runs.push((index, index + 1)),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_value_has_one_mark() {
        let marks = marks_of;
        assert_eq!(marks((5.0, 5.0), 1), [(5.0, "5".to_owned())]);
        assert_eq!(marks((5.25, 5.25), 3), [(5.25, "5.25".to_owned())]);
        assert_eq!(marks((5.0, 6.0), 1), [(5.0, "5".to_owned())]);
        assert_eq!(marks((5.0, 6.0), 2).len(), 6);
    }
}
