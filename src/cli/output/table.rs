//! Tables: cells in columns and bars for people, records for JSON.

use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::cli::output::charset::Charset;
use crate::tui::widget::write::width;

/// A row of fixed cells, such as the titles.
pub(crate) fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

/// Lines of cells in columns two spaces apart. Cells end on the right of their column, or begin on its left where
/// `left` has its number.
pub(crate) fn table(rows: &[Vec<String>], left: &[usize]) -> String {
    let cells = rows.iter().map(|row| {
        let cells = row.iter().map(|cell| Charset::current().line(cell));
        cells.collect::<Vec<_>>()
    });
    let cells: Vec<_> = cells.collect();
    let mut widths = Vec::new();
    for row in &cells {
        widths.resize(row.len().max(widths.len()), 0);
        for (widest, cell) in widths.iter_mut().zip(row) {
            *widest = width(cell).max(*widest);
        }
    }
    let mut text = String::new();
    for row in &cells {
        let begin = text.len();
        for (column, (cell, widest)) in row.iter().zip(&widths).enumerate() {
            let gap = if column > 0 { "  " } else { "" };
            let missing = " ".repeat(widest - width(cell));
            let [first, last] = if left.contains(&column) {
                [&**cell, &missing]
            } else {
                [&*missing, cell]
            };
            text.extend([gap, first, last]);
        }
        text.truncate(begin + text[begin..].trim_end().len());
        text.push('\n');
    }
    text
}

/// Named values, which JSON has as an object in this order.
pub(crate) struct Record<'a, V = Value>(pub(crate) Vec<(&'a str, V)>);

impl<V: Serialize> Serialize for Record<'_, V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

/// Draws a bar for a share, of at most `width` characters. The length is rounded, so a small share may have no bar.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "a share is from 0 to 1, a width that of a terminal"
)]
pub(crate) fn bar(share: f64, width: usize) -> String {
    let full = match Charset::current() {
        Charset::Ascii => "#",
        Charset::Unicode => "█",
    };
    full.repeat((share * width as f64).round() as usize)
}
