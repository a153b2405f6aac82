//! A confusion matrix as a heat map with its numbers: a row per true shape, a column per name.
//!
//! A cell holds a number of touches and its share of the row; the larger the share, the darker the cell. The numbers
//! are there for readers who cannot tell the shades apart.

use taxel_core::parameter::number::share;

use crate::formats::drawing::svg::{
    self, CELLS, DrawingPage, Element, MARGIN, Position, Stroke, TEXT, TextAnchor, cut, label,
    path_of, rectangle, upright_title, width,
};
use crate::formats::value::percent;

/// The most shapes; more would make a page too large to print.
const MOST: usize = 64;

/// The most characters of a name; longer ones are cut.
const LONGEST: usize = 30;

/// The grey of a cell that holds its whole row: black text on it is still readable.
const DARKEST: f64 = 160.0;

/// A confusion matrix to draw.
///
/// ```
/// use taxel_files::formats::ConfusionMap;
/// let map = ConfusionMap::new(&["disc".into(), "bar".into()], [vec![9, 1], vec![0, 10]]).expect("few shapes");
/// assert!(map.svg().contains(">90 %</text>"));
/// ```
#[derive(Clone, Debug)]
pub struct ConfusionMap {
    labels: Vec<String>,
    /// The touches by true shape and by the name given.
    counts: Vec<Vec<u128>>,
    title: Option<String>,
}

impl ConfusionMap {
    /// Makes the matrix of some shapes: `counts[i][j]` touches of shape i are named j; missing counts are 0. None if
    /// there are no shapes, or more than 64.
    pub fn new(labels: &[String], counts: impl IntoIterator<Item = Vec<u128>>) -> Option<Self> {
        if labels.is_empty() || labels.len() > MOST {
            return None;
        }
        let cut = |label: &String| label.chars().take(LONGEST).collect();
        Some(Self {
            labels: labels.iter().map(cut).collect(),
            counts: counts.into_iter().collect(),
            title: None,
        })
    }

    /// Adds a title above; only its first 100 characters are kept.
    #[must_use]
    pub fn with_title(mut self, title: &str) -> Self {
        self.title = Some(cut(title));
        self
    }

    fn count(&self, row: usize, column: usize) -> u128 {
        let cell = self.counts.get(row).and_then(|row| row.get(column));
        cell.copied().unwrap_or_default()
    }

    /// The matrix as SVG 1.1.
    pub fn svg(&self) -> String {
        svg::write(&self.page())
    }

    fn page(&self) -> DrawingPage {
        let longest = |texts: &mut dyn Iterator<Item = usize>| texts.max().unwrap_or_default();
        let names = longest(&mut self.labels.iter().map(|label| label.chars().count()));
        let shapes = 0..self.labels.len();
        let digits = shapes
            .clone()
            .flat_map(|row| shapes.clone().map(move |column| (row, column)));
        let digits = longest(&mut digits.map(|(row, column)| {
            let count = self.count(row, column);
            count.to_string().len()
        }));
        let cell = (width(digits.max(7)) + 8.0, TEXT * 2.0 + 8.0);
        // Names wider than a cell are written upwards.
        let upright = width(names) + 4.0 > cell.0;
        let heading = if upright { width(names) } else { TEXT };
        let title = self.title.as_ref().map_or(0.0, |_| TEXT + 6.0);
        let corner = (
            MARGIN + TEXT + 6.0 + width(names) + 6.0,
            MARGIN + title + TEXT + 6.0 + heading + 6.0,
        );
        let mut layout = MapLayout {
            map: self,
            marks: Vec::new(),
            corner,
            cell,
        };
        layout.cells();
        layout.names(upright);
        let end = layout.position(self.labels.len(), self.labels.len());
        let note = "touches, and their share of the true shape's";
        let note_end = corner.0 + width(note.chars().count());
        layout.text(note, (corner.0, end.1 + TEXT + 6.0), TextAnchor::Start);
        let mut right = end.0.max(note_end);
        if let Some(title) = &self.title {
            layout.text(title, (corner.0, MARGIN + TEXT), TextAnchor::Start);
            right = right.max(corner.0 + width(title.chars().count()));
        }
        DrawingPage {
            size: (right + MARGIN, end.1 + TEXT * 1.3 + 6.0 + MARGIN),
            plane: (corner, end),
            title: self
                .title
                .clone()
                .unwrap_or_else(|| "confusion matrix".to_owned()),
            marks: layout.marks,
        }
    }
}

struct MapLayout<'a> {
    map: &'a ConfusionMap,
    marks: Vec<Element>,
    corner: Position,
    cell: Position,
}

impl MapLayout<'_> {
    #[expect(clippy::cast_precision_loss, reason = "at most 64 cells")]
    fn position(&self, row: usize, column: usize) -> Position {
        (
            self.corner.0 + self.cell.0 * column as f64,
            self.corner.1 + self.cell.1 * row as f64,
        )
    }

    fn text(&mut self, text: &str, place: Position, anchor: TextAnchor) {
        self.marks.push(label(text, place, anchor));
    }

    /// Draws the cells: shades first, then lines, then numbers.
    fn cells(&mut self) {
        let shapes = self.map.labels.len();
        let (mut lines, mut numbers) = (Vec::new(), Vec::new());
        for row in 0..shapes {
            let counts = (0..shapes).map(|column| self.map.count(row, column));
            let sum = counts.fold(0, u128::saturating_add);
            for column in 0..shapes {
                let count = self.map.count(row, column);
                let (low, high) = (
                    self.position(row, column),
                    self.position(row + 1, column + 1),
                );
                let share = share(count, sum);
                if count > 0 {
                    self.marks.push(Element::Fill {
                        what: "cell",
                        rectangles: vec![(low, high)],
                        grey: grey(share),
                    });
                }
                lines.extend(rectangle(low, high));
                let x = f64::midpoint(low.0, high.0);
                let said = match count {
                    0 => vec![("·".to_owned(), (x, low.1 + TEXT * 1.5))],
                    _ => vec![
                        (count.to_string(), (x, low.1 + TEXT + 3.0)),
                        (
                            percent(share).replace(".0 %", " %"),
                            (x, low.1 + TEXT * 2.0 + 4.0),
                        ),
                    ],
                };
                numbers.extend(said);
            }
        }
        self.marks.push(path_of("cells", lines, CELLS));
        // The diagonal, where touches are named correctly, has a frame.
        let right = (0..shapes).flat_map(|shape| {
            rectangle(
                self.position(shape, shape),
                self.position(shape + 1, shape + 1),
            )
        });
        let stroke = Stroke::black(1.1);
        self.marks
            .push(path_of("diagonal", right.collect(), stroke));
        for (text, place) in numbers {
            self.text(&text, place, TextAnchor::Middle);
        }
    }

    fn names(&mut self, upright: bool) {
        let (shapes, map) = (self.map.labels.len(), self.map);
        for (index, label) in map.labels.iter().enumerate() {
            let (left, top) = self.position(index, 0);
            let y = top + self.cell.1 / 2.0 + TEXT * 0.35;
            self.text(label, (left - 6.0, y), TextAnchor::End);
            let (left, top) = self.position(0, index);
            let x = left + self.cell.0 / 2.0;
            if upright {
                self.marks.push(Element::Text {
                    text: label.clone(),
                    place: (x + TEXT * 0.35, top - 6.0),
                    anchor: TextAnchor::Start,
                    upright: true,
                });
            } else {
                self.text(label, (x, top - 6.0), TextAnchor::Middle);
            }
        }
        let end = self.position(shapes, shapes);
        let title = map.title.as_ref().map_or(0.0, |_| TEXT + 6.0);
        let middle = f64::midpoint(self.corner.0, end.0);
        self.text("named", (middle, MARGIN + title + TEXT), TextAnchor::Middle);
        let middle = f64::midpoint(self.corner.1, end.1);
        self.marks.push(upright_title("true shape", middle));
    }
}

/// Returns the grey of a share: white for 0, the darkest grey for 1.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share is from 0 to 1"
)]
fn grey(share: f64) -> u8 {
    (255.0 - (255.0 - DARKEST) * share).round() as u8
}
