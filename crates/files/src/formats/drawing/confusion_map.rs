//! A confusion matrix as a heat map with its numbers: a row per true shape, a column per name.
//!
//! A cell holds a number of touches and its share of the row; the larger the share, the darker the cell. The numbers
//! are there for readers who cannot tell the shades apart.

use taxel_core::parameter::number::share;

use crate::formats::drawing::svg::{
    Axis, AxisMarks, CELLS, Stroke, Svg, TEXT, TextAnchor, rectangle, width,
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
/// let labels = ["disc", "bar"].map(str::to_owned);
/// let map = ConfusionMap::new(&labels, [vec![9, 1], vec![0, 10]]).expect("few shapes");
/// assert!(map.svg().contains(">90 %</text>"));
/// ```
#[derive(Clone, Debug)]
pub struct ConfusionMap {
    labels: Vec<String>,
    /// The touches by true shape and by the name given.
    counts: Vec<Vec<u128>>,
    /// What stands above; only its first 100 characters are drawn.
    pub title: String,
}

impl ConfusionMap {
    /// Makes the matrix of some shapes: `counts[i][j]` touches of shape i are named j; missing counts are 0. None if
    /// there are no shapes, or more than 64.
    pub fn new(labels: &[String], counts: impl IntoIterator<Item = Vec<u128>>) -> Option<Self> {
        if !(1..=MOST).contains(&labels.len()) {
            return None;
        }
        let mut counts: Vec<Vec<u128>> = counts.into_iter().collect();
        counts.resize(labels.len(), Vec::new());
        for row in &mut counts {
            row.resize(labels.len(), 0);
        }
        let cut = |label: &String| label.chars().take(LONGEST).collect();
        Some(Self {
            labels: labels.iter().map(cut).collect(),
            counts,
            title: String::new(),
        })
    }

    /// The matrix as SVG 1.1.
    #[expect(clippy::cast_precision_loss, reason = "at most 64 cells")]
    pub fn svg(&self) -> String {
        let shapes = self.labels.len();
        let most = self.counts.iter().flatten().max();
        let digits = most.map_or(0.0, |most| width(&most.to_string()));
        let cell = (digits.max(width("<0.1 % ")) + 8.0, TEXT * 2.0 + 8.0);
        let place = |row: usize, column: usize| (cell.0 * column as f64, cell.1 * row as f64);
        let mut svg = Svg::new(place(shapes, shapes));
        let (mut cells, mut diagonal, mut numbers) = (String::new(), String::new(), Vec::new());
        for (row, counts) in self.counts.iter().enumerate() {
            let sum = counts
                .iter()
                .fold(0, |sum: u128, &own| sum.saturating_add(own));
            for (column, &count) in counts.iter().enumerate() {
                let (low, high) = (place(row, column), place(row + 1, column + 1));
                let outline = rectangle(low, high);
                let share = share(count, sum);
                let x = f64::midpoint(low.0, high.0);
                if count > 0 {
                    svg.fill("cell", &outline, grey(share));
                    let percent = percent(share).replace(".0 %", " %");
                    numbers.push((count.to_string(), (x, low.1 + TEXT + 3.0)));
                    numbers.push((percent, (x, low.1 + TEXT * 2.0 + 4.0)));
                } else {
                    numbers.push(("·".to_owned(), (x, low.1 + TEXT * 1.5)));
                }
                if column == row {
                    diagonal += &outline;
                }
                cells += &outline;
            }
        }
        svg.line("cells", &cells, CELLS);
        // The right answers have a frame.
        svg.line("diagonal", &diagonal, Stroke::black(1.1));
        for (text, place) in numbers {
            svg.text(&text, place, TextAnchor::Middle);
        }
        let axis = |title: &str, side: f64| Axis {
            title: title.to_owned(),
            ends: (0.0, 1.0),
            span: (side / 2.0, side * 1.5),
            marks: (0..)
                .map(f64::from)
                .zip(self.labels.iter().cloned())
                .collect(),
        };
        let across = axis("named", cell.0);
        let along = axis("true shape", cell.1);
        svg.axes(AxisMarks::Outside, &across, &along);
        let below = (0.0, svg.below());
        let note = "touches, and their share of the true shape's";
        svg.text(note, below, TextAnchor::Start);
        svg.finish_named("confusion matrix", &self.title)
    }
}

/// The grey of a share: white for 0, the darkest grey for 1.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share is from 0 to 1"
)]
fn grey(share: f64) -> u8 {
    (255.0 - (255.0 - DARKEST) * share).round() as u8
}
