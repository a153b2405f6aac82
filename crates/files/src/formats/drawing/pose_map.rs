//! A map of positions: the imprint at each x0 and y0, as areas with borders.
//!
//! Borders separate the areas; greys only help the eye, and a bad printer may lose them.

use crate::formats::drawing::plots::Ticks;
use crate::formats::drawing::plots::{AxisMarks, axes, left_of};
use crate::formats::drawing::svg;
use crate::formats::drawing::svg::{
    DrawingPage, Element, MARGIN, Position, ROW, Segment, Stroke, TEXT, TextAnchor, cut, label,
    path_of, rectangle, width,
};
use crate::formats::value::decimal;

const PLANE: f64 = 288.0;

/// The most cells along a side; more cannot be told apart in print.
const MOST: usize = 1024;

const GREYS: [u8; 5] = [255, 232, 209, 186, 163];

const X_TITLE: &str = "x0 / cells";
const Y_TITLE: &str = "y0 / cells";

const BORDER: Stroke = Stroke::black(0.5);

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
    title: String,
    chosen: Option<(usize, usize)>,
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
            chosen: None,
        })
    }

    /// Adds a title above; only its first 100 characters are kept.
    #[must_use]
    pub fn with_title(mut self, title: &str) -> Self {
        self.title = cut(title);
        self
    }

    /// Adds a frame around a cell, given by column and row.
    #[must_use]
    pub fn with_chosen(mut self, column: usize, row: usize) -> Self {
        self.chosen = Some((column, row)).filter(|_| column < self.columns && row < self.rows());
        self
    }

    fn rows(&self) -> usize {
        self.ids.len() / self.columns
    }

    fn id(&self, column: usize, row: usize) -> Option<u32> {
        let index = row * self.columns + column;
        self.ids.get(index).copied().flatten()
    }

    /// The map as SVG 1.1.
    pub fn svg(&self) -> String {
        svg::write(&self.page())
    }

    fn page(&self) -> DrawingPage {
        let side = PLANE / count(self.columns.max(self.rows()));
        let [x0, y0] = self.ends;
        let across = ticks(x0, self.columns);
        let along = ticks(y0, self.rows());
        let above = if self.title.is_empty() { 0.0 } else { ROW };
        // The titles of the axes are centred, and may be longer than the axes.
        let title = width(X_TITLE.len().max(Y_TITLE.len())) / 2.0;
        let middle = |cells: usize| count(cells) * side / 2.0;
        let (half_width, half_height) = (middle(self.columns), middle(self.rows()));
        let top = MARGIN + above + TEXT * 3.0 + 4.0;
        let corner = (
            left_of(&along).max(MARGIN + title - half_width),
            top.max(MARGIN + above + title - half_height),
        );
        let place = |column: usize, row: usize| {
            (
                corner.0 + count(column) * side,
                corner.1 + count(row) * side,
            )
        };
        let end = place(self.columns, self.rows());
        let mut marks = vec![label(
            &self.title,
            (corner.0, MARGIN + TEXT),
            TextAnchor::Start,
        )];
        marks.extend(self.areas(&place));
        marks.push(path_of("borders", self.borders(&place), BORDER));
        if let Some((column, row)) = self.chosen {
            let cell = rectangle(place(column, row), place(column + 1, row + 1));
            marks.push(path_of("chosen", cell, Stroke::black(2.0)));
        }
        marks.extend(axes(
            AxisMarks::Outside,
            [X_TITLE, Y_TITLE],
            (&across, &along),
            (corner, end),
            |(x, y)| {
                let x = cells_before(x, x0, self.columns) * side;
                let y = cells_before(y, y0, self.rows()) * side;
                (corner.0 + x, corner.1 + y)
            },
        ));
        let right = end.0.max(corner.0 + width(self.title.chars().count()));
        // A mark stands at the centre of a cell, half a cell from the end of the axis.
        let mark = width(across.width()) / 2.0 - side / 2.0;
        let right = right.max(end.0 + mark).max(end.0 - half_width + title);
        let bottom = (end.1 + TEXT).max(end.1 - half_height + title);
        DrawingPage {
            size: (right + MARGIN, bottom + MARGIN),
            plane: (corner, end),
            title: "imprints of positions".to_owned(),
            marks,
        }
    }

    /// Returns the cells of each grey; neighbours in a row with the same imprint form one rectangle.
    fn areas(&self, place: &dyn Fn(usize, usize) -> Position) -> Vec<Element> {
        let mut areas: Vec<Vec<(Position, Position)>> = vec![Vec::new(); GREYS.len()];
        for row in 0..self.rows() {
            let mut column = 0;
            while column < self.columns {
                let id = self.id(column, row);
                let alike = (column..self.columns).take_while(|&other| self.id(other, row) == id);
                let end = column + alike.count();
                if let Some(id) = id {
                    let area = (place(column, row), place(end, row + 1));
                    areas[shade(id)].push(area);
                }
                column = end;
            }
        }
        let areas = areas.into_iter().zip(GREYS);
        let filled = areas.filter(|(rectangles, _)| !rectangles.is_empty());
        let fill = |(rectangles, grey)| Element::Fill {
            what: "imprints",
            rectangles,
            grey,
        };
        filled.map(fill).collect()
    }

    /// Returns the lines between cells of different imprints; adjoining ones form one line.
    fn borders(&self, place: &dyn Fn(usize, usize) -> Position) -> Vec<Segment> {
        let mut lines = Vec::new();
        let mut line = |from: Position, to: Position| {
            lines.extend([Segment::Move(from), Segment::Line(to)]);
        };
        let (columns, rows) = (self.columns, self.rows());
        for row in 1..rows {
            let differs = |column: usize| self.id(column, row - 1) != self.id(column, row);
            for (from, to) in runs(columns, differs) {
                line(place(from, row), place(to, row));
            }
        }
        for column in 1..columns {
            let differs = |row: usize| self.id(column - 1, row) != self.id(column, row);
            for (from, to) in runs(rows, differs) {
                line(place(column, from), place(column, to));
            }
        }
        lines
    }
}

/// Returns the position of a value along an axis, in cells: the ends of the axis are centres of cells.
fn cells_before(value: f64, (low, high): (f64, f64), cells: usize) -> f64 {
    let last = count(cells.saturating_sub(1));
    let share = if high == low {
        0.0
    } else {
        (value - low) / (high - low)
    };
    share * last + 0.5
}

#[expect(clippy::cast_precision_loss, reason = "at most 1,024")]
fn count(cells: usize) -> f64 {
    cells as f64
}

fn shade(id: u32) -> usize {
    // The remainder fits into one byte.
    let [shade, ..] = (id % 5).to_le_bytes();
    shade.into()
}

/// Returns the marks of an axis with a number of cells from one value to another; a single mark if both are the same.
fn ticks((one, other): (f64, f64), cells: usize) -> Ticks {
    let (low, high) = (one.min(other), one.max(other));
    if cells > 1 && low < high {
        Ticks::between((low, high), 0.0, 6.0)
    } else {
        Ticks(vec![(one, decimal(one, 6))])
    }
}

/// Returns the runs of consecutive indices below `count` for which a condition holds, as half-open ranges.
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
        let marks = |ends, cells| ticks(ends, cells).0;
        assert_eq!(marks((5.0, 5.0), 1), [(5.0, "5".to_owned())]);
        assert_eq!(marks((5.25, 5.25), 3), [(5.25, "5.25".to_owned())]);
        assert_eq!(marks((5.0, 6.0), 1), [(5.0, "5".to_owned())]);
        assert_eq!(marks((5.0, 6.0), 2).len(), 6);
    }

    #[test]
    fn the_page_holds_all_texts_of_narrow_and_flat_maps() {
        for (columns, rows) in [(1, 1), (1, 100), (100, 1), (3, 200), (1024, 1)] {
            let ids = vec![Some(1); columns * rows];
            for title in ["", "a title"] {
                let map = PoseMap::new((5.0, 5.99), (5.0, 5.99), columns, &ids);
                let page = map.expect("few cells").with_title(title).page();
                for mark in &page.marks {
                    let Element::Text {
                        text,
                        place: (x, y),
                        anchor,
                        upright,
                    } = mark
                    else {
                        continue;
                    };
                    let length = width(text.chars().count());
                    let before = match anchor {
                        TextAnchor::Start => 0.0,
                        TextAnchor::Middle => length / 2.0,
                        TextAnchor::End => length,
                    };
                    let (low, high, size) = if *upright {
                        (y - length + before, y + before, page.size.1)
                    } else {
                        (x - before, x - before + length, page.size.0)
                    };
                    assert!(low >= 0.0 && high <= size, "{text} {columns} {rows}");
                }
            }
        }
    }
}
