//! A small picture of an imprint: a column for each taxel, two rows in a line by half blocks, or a row in a line in
//! ASCII.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::imprint::Imprint;
use crate::tui::widget::number::taxels;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// Columns and lines that an imprint takes.
pub fn size(theme: &Theme, imprint: &Imprint) -> (u16, u16) {
    let rows = u16::from(imprint.rows());
    let lines = if theme.ascii { rows } else { rows.div_ceil(2) };
    (imprint.columns().into(), lines)
}

/// Draws an imprint from the top left corner of an area on; of one that is larger, the part around its active taxels.
pub fn draw(theme: &Theme, imprint: &Imprint, buffer: &mut Buffer, area: Rect) {
    let step: u8 = if theme.ascii { 1 } else { 2 };
    let (columns, rows) = (imprint.columns(), imprint.rows());
    let (width, height) = (
        taxels(area.width).min(columns),
        taxels(area.height.saturating_mul(step.into())).min(rows),
    );
    let (mut left, mut top) = (0, 0);
    if let Some(bounds) = imprint.bounds() {
        let middle = |low: u8, high: u8| low + (high - low) / 2;
        let from = |middle: u8, seen: u8, all: u8| middle.saturating_sub(seen / 2).min(all - seen);
        left = from(middle(bounds.left, bounds.right), width, columns);
        // Rows stay paired as they are in the whole.
        top = from(middle(bounds.top, bounds.bottom), height, rows) / step * step;
    }
    for (line, row) in (top..rows).step_by(step.into()).enumerate() {
        let half = |column: u8| {
            let lower = step == 2 && imprint.get(column, row + 1);
            theme.half(imprint.get(column, row), lower)
        };
        let text: String = (left..left + width).map(half).collect();
        let place = write::row(area, line);
        write::line(buffer, place, theme, [(text.as_str(), Role::Chosen)]);
    }
}
