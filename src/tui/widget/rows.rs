//! The rows of a list: which one is selected, and which one a click is on.

use ratatui::layout::{Position, Rect};

use crate::tui::app::{Endpoint, Message};
use crate::tui::widget::write::first_of;

#[derive(Clone, Copy, Debug)]
pub struct ListRows {
    pub area: Rect,
    pub first: usize,
    pub count: usize,
}

impl ListRows {
    pub fn around(area: Rect, count: usize, selected: usize) -> Self {
        Self {
            area,
            first: first_of(area.height, count, selected),
            count,
        }
    }

    pub fn visible<T>(
        self,
        all: impl Iterator<Item = T>,
    ) -> impl Iterator<Item = (usize, Rect, T)> {
        let visible = all.enumerate().skip(self.first).zip(self.area.rows());
        visible.map(|((index, item), line)| (index, line, item))
    }

    pub fn position(&self, row: usize) -> Option<Position> {
        let line = self.area.rows().nth(row.checked_sub(self.first)?)?;
        (row < self.count).then(|| line.as_position())
    }

    pub fn hidden(&self) -> Option<String> {
        let last = self.first + usize::from(self.area.height);
        let (above, below) = (self.first, self.count.saturating_sub(last));
        (above + below > 0).then(|| format!("  {above} above, {below} below"))
    }

    pub fn at(&self, position: Position) -> Option<usize> {
        let row = self.first + usize::from(position.y.checked_sub(self.area.y)?);
        (self.area.contains(position) && row < self.count).then_some(row)
    }

    /// None beside the rows.
    pub fn click(&self, position: Position, selected: usize) -> Option<Message> {
        let row = self.at(position)?;
        Some(if row == selected {
            Message::Accept
        } else {
            Message::Select(row)
        })
    }
}

/// Returns the row that a message selects if `row` is selected now; None if it selects no row. The result may lie
/// beyond the last row, since only the list knows how many rows there are.
pub fn moved(row: usize, message: &Message) -> Option<usize> {
    match *message {
        Message::Scroll(lines) => Some(row.saturating_add_signed(lines.into())),
        Message::ScrollTo(Endpoint::First) => Some(0),
        Message::ScrollTo(Endpoint::Last) => Some(usize::MAX),
        Message::Select(row) => Some(row),
        _ => None,
    }
}
