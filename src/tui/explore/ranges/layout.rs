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
    /// Lines a row has: two where there is room for an error under it.
    pub spacing: u16,
    /// The index of the first visible row.
    first: usize,
    /// How many rows are visible, the anchor among them.
    pub visible: usize,
    /// How many rows there are, the anchor among them.
    rows: usize,
}

impl RangeRows {
    /// The rows of a form in its pane: the fields and the anchor, the one that has the focus visible. A title stands
    /// above them, and three lines below, or as many as the rows leave, but one at least.
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

    /// The visible rows by number, each with its line from the top of the pane.
    pub fn lines(&self) -> impl Iterator<Item = (usize, u16)> {
        let rows = *self;
        (0..rows.visible).map(move |index| (rows.first + index, 1 + narrow(index) * rows.spacing))
    }

    /// The row at a line of the pane.
    pub fn row(&self, line: u16) -> Option<usize> {
        let index = usize::from(line.checked_sub(1)? / self.spacing);
        (index < self.visible && self.first + index < self.rows).then_some(self.first + index)
    }

    /// The line below the last visible row.
    pub fn end(&self) -> u16 {
        1 + narrow(self.visible) * self.spacing
    }
}
