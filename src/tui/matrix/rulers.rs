//! The rulers of the matrix: the numbers of columns above it and of rows on its left, and arrows at the ends beyond
//! which more cells are hidden.
//!
//! ```text
//!   ←10   15   20   25  →        columns 8 to 27; there are more on both sides
//!  8↑· · · ·                     the first line; there are rows above it
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::matrix::layout::{TaxelGrid, TaxelSize};
use crate::tui::widget::number::narrow;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

pub(super) fn draw(theme: &Theme, grid: &TaxelGrid, buffer: &mut Buffer, area: Rect) {
    let [above, below, left, right] = theme.more();
    let ((more_above, more_below), (more_left, more_right)) =
        (grid.rows.hidden(), grid.columns.hidden());
    let (width, height) = grid.characters();
    let before = grid.x.saturating_sub(1);
    // Numbers end before an arrow.
    let end = grid.x + width.saturating_sub(more_right.into());
    let line = write::left_of(write::row(area, 0), end);
    draw_columns(theme, grid, buffer, line);
    draw_rows(theme, grid, buffer, area);
    let marks = [
        (more_above, before, grid.y, above),
        (more_below, before, grid.y + height.max(1) - 1, below),
        (more_left, before, area.y, left),
        (more_right, grid.x + width.max(1) - 1, area.y, right),
    ];
    for (_, x, y, mark) in marks.into_iter().filter(|(more, ..)| *more) {
        let place = Rect::new(x, y, 1, 1).intersection(area);
        write::text(buffer, place, theme, &mark.to_string(), Role::Key);
    }
}

pub(in crate::tui) fn draw_columns(
    theme: &Theme,
    grid: &TaxelGrid,
    buffer: &mut Buffer,
    line: Rect,
) {
    let cell = grid.size.columns();
    let every = match cell {
        1 => 5,
        2 => 2,
        _ => 1,
    };
    for (index, column) in grid
        .columns
        .visible()
        .filter(|(_, column)| column % every == 0)
    {
        let x = grid.x + index * cell + (cell.max(2) - 2) / 2;
        let text = column.to_string();
        if x + narrow(text.len()) <= line.right() {
            let place = write::right_of(line, x);
            write::text(buffer, place, theme, &text, Role::Quiet);
        }
    }
}

pub(in crate::tui) fn draw_rows(theme: &Theme, grid: &TaxelGrid, buffer: &mut Buffer, area: Rect) {
    let rows = if grid.size == TaxelSize::Half { 2 } else { 1 };
    for (index, row) in grid.rows.visible().step_by(rows) {
        let place = grid.cell_rect(0, index);
        let y = place.y + (place.height - 1) / 2;
        let line = write::row(area, usize::from(y - area.y));
        let text = format!("{row:>2}");
        write::text(buffer, line, theme, &text, Role::Quiet);
    }
}
