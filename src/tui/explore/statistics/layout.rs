//! The table of statistics: rows and columns that there is room for.

use ratatui::layout::{Position, Rect};

use crate::atlas::{STATISTIC_COLUMNS, features};
use crate::tui::app::layout::{below, first_of};
use crate::tui::explore::results::Results;

/// The table of statistics.
#[derive(Clone, Copy, Debug)]
pub struct StatisticsTable {
    /// How many poses and imprints there are; empty where there is no room.
    pub totals: Rect,
    /// The headings.
    pub head: Rect,
    /// The rows.
    pub rows: Rect,
    /// The row that comes first.
    pub first: usize,
    /// Characters of a name.
    pub name: usize,
    /// Characters of a column.
    pub column: usize,
    /// The column that comes first, and how many there is room for.
    pub columns: (usize, usize),
}

impl StatisticsTable {
    /// The table on its page.
    pub fn of(page: Rect, results: &Results) -> Self {
        let (name, count) = (17, STATISTIC_COLUMNS.len());
        let room = usize::from(page.width).saturating_sub(name);
        // Eight columns fit into 80 characters.
        let column = (room / count).clamp(7, 10);
        let visible = (room / column).min(count);
        let totals = Rect {
            height: if page.height > 6 { 2 } else { 0 },
            ..page
        };
        let table = below(page, totals.height);
        let rows = below(table, 1);
        Self {
            totals,
            head: Rect {
                height: table.height.min(1),
                ..table
            },
            first: first_of(rows.height, features().len(), results.feature_number()),
            rows,
            name,
            column,
            columns: (results.column().min(count - visible), visible),
        }
    }

    /// The row at a place of the screen.
    pub fn row(&self, place: Position) -> Option<usize> {
        let row = self.first + usize::from(place.y.checked_sub(self.rows.y)?);
        (self.rows.contains(place) && row < features().len()).then_some(row)
    }
}
