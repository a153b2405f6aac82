//! The rows of the form of ranges in its pane.
//!
//! With enough room each row has two lines, the second for errors; otherwise one. The row that has the focus is always
//! visible.

use ratatui::layout::Rect;

use crate::tui::explore::ranges::state::RangesForm;
use crate::tui::widget::number::narrow;

/// The lines of the form of ranges.
#[derive(Clone, Copy, Debug)]
pub struct RangeRows {
    /// The number of lines of a row: two if there is room for an error under it, otherwise one.
    pub spacing: u16,
    /// The index of the first visible row.
    first: usize,
    /// The number of visible rows, including the anchor.
    pub visible: usize,
    /// The number of rows, including the anchor.
    rows: usize,
}

impl RangeRows {
    /// Computes the rows of a form in its pane: the fields and the anchor, such that the row with the focus is
    /// visible. The title is above them; below them are three lines, or as many as the rows leave, but at least one.
    pub fn of(area: Rect, form: &RangesForm) -> Self {
        let rows = form.fields().len() + 1;
        let room = usize::from(area.height.saturating_sub(1));
        let room = room.saturating_sub(room.saturating_sub(rows).clamp(1, 3));
        let spacing = if room >= 2 * rows { 2 } else { 1 };
        let visible = (room / spacing).min(rows);
        let focus = form.focus().unwrap_or(rows - 1);
        Self {
            spacing: narrow(spacing),
            first: (focus + 1).saturating_sub(visible),
            visible,
            rows,
        }
    }

    /// Returns the visible rows by number, each with its line from the top of the pane.
    pub fn lines(&self) -> impl Iterator<Item = (usize, u16)> {
        let rows = *self;
        (0..rows.visible).map(move |index| (rows.first + index, 1 + narrow(index) * rows.spacing))
    }

    /// Returns the row at a line of the pane.
    pub fn row(&self, line: u16) -> Option<usize> {
        let index = usize::from(line.checked_sub(1)? / self.spacing);
        (index < self.visible && self.first + index < self.rows).then_some(self.first + index)
    }

    /// Returns the line below the last visible row.
    pub fn end(&self) -> u16 {
        1 + narrow(self.visible) * self.spacing
    }
}
