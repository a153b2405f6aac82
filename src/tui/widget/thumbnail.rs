//! A small picture of an imprint, with one column per taxel. A line shows two rows by half blocks, in ASCII one row.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::imprint::Imprint;
use crate::tui::widget::number::taxels;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

pub fn size(theme: &Theme, imprint: &Imprint) -> (u16, u16) {
    let rows = u16::from(imprint.rows());
    let lines = if theme.ascii { rows } else { rows.div_ceil(2) };
    (imprint.columns().into(), lines)
}

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
        let from = |middle: u8, seen: u8, all: u8, step: u8| {
            let last = (all - seen).next_multiple_of(step);
            (middle.saturating_sub(seen / 2) / step * step).min(last)
        };
        left = from(middle(bounds.left, bounds.right), width, columns, 1);
        // The same rows share a line as in the whole imprint.
        top = from(middle(bounds.top, bounds.bottom), height, rows, step);
    }
    for (line, row) in (top..rows).step_by(step.into()).enumerate() {
        let half = |column: u8| {
            let lower = step == 2 && imprint.get(column, row + 1);
            theme.half(imprint.get(column, row), lower)
        };
        let text: String = (left..left + width).map(half).collect();
        let place = write::row(area, line);
        write::text(buffer, place, theme, &text, Role::Chosen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::MatrixSize;

    #[test]
    fn the_last_of_an_odd_number_of_rows_is_drawn() {
        let mut imprint = Imprint::empty(MatrixSize::new(3, 63).expect("an allowed size"));
        imprint.set(1, 62, true);
        for (ascii, height) in [(false, 22), (true, 22)] {
            let area = Rect::new(0, 0, 3, height);
            let mut buffer = Buffer::empty(area);
            draw(&Theme::plain(ascii), &imprint, &mut buffer, area);
            let last = buffer
                .cell((1, height - 1))
                .map(|cell| cell.symbol().to_owned());
            let sign = if ascii { "#" } else { "▀" };
            assert_eq!(last.as_deref(), Some(sign), "ascii: {ascii}");
        }
    }
}
