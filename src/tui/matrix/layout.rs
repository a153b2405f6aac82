//! Where the taxels are on the screen.
//!
//! A taxel is two characters wide, so that it looks square; one where the matrix fits only so; or a multiple of two
//! where all taxels fit enlarged. Drawing and the mouse share this layout.

use ratatui::layout::Rect;

use crate::imprint::Imprint;
use crate::tui::widget::number::taxels;

/// Columns of the row ruler.
pub const RULER: u16 = 3;

/// How many times taxels can be enlarged so that all of them fit; 1 if they do not fit even unenlarged.
pub(in crate::tui) fn scale(imprint: &Imprint, width: u16, height: u16) -> u16 {
    let across = width.saturating_sub(RULER) / (2 * u16::from(imprint.columns()));
    let down = height.saturating_sub(1) / u16::from(imprint.rows());
    across.min(down).max(1)
}

/// The width of the whole matrix with its ruler.
pub(in crate::tui) fn matrix_width(imprint: &Imprint, cell: u16) -> u16 {
    RULER + cell * u16::from(imprint.columns())
}

/// Which part of one axis of the matrix is visible.
#[derive(Clone, Copy, Debug)]
pub struct AxisWindow {
    /// The first cell.
    pub first: u8,
    /// How many.
    pub count: u8,
}

impl AxisWindow {
    /// `cells` of which `room` can be seen, the cursor as near to the middle as the ends allow.
    pub(in crate::tui) fn new(cells: u8, room: u16, cursor: u8) -> Self {
        let count = taxels(room).min(cells);
        Self {
            first: cursor.saturating_sub(count / 2).min(cells - count),
            count,
        }
    }

    /// The visible cells, each with its place from the first one.
    pub fn visible(&self) -> impl Iterator<Item = (u16, u8)> {
        (0..self.count).map(|index| (u16::from(index), self.first + index))
    }

    /// The cell at a place counted from the first visible one.
    fn at(self, place: u16) -> Option<u8> {
        (place < u16::from(self.count)).then(|| self.first + taxels(place))
    }
}

/// Where the taxels are.
#[derive(Clone, Copy, Debug)]
pub struct TaxelGrid {
    /// The column of the screen where the first visible taxel begins.
    pub x: u16,
    /// The row of the screen where it begins.
    pub y: u16,
    /// Columns of the screen that a taxel has: 2 or a multiple, or 1 where the matrix fits only so.
    pub cell: u16,
    /// Rows of the screen that a taxel has.
    pub lines: u16,
    /// Visible columns.
    pub columns: AxisWindow,
    /// Visible rows.
    pub rows: AxisWindow,
    /// Whether all taxels are visible.
    pub whole: bool,
}

impl TaxelGrid {
    /// The taxels of a matrix in its pane, with the cursor at a taxel.
    pub fn of(area: Rect, imprint: &Imprint, cursor: (u8, u8)) -> Self {
        let (columns, rows) = (imprint.columns(), imprint.rows());
        let room = area.width.saturating_sub(RULER);
        let fits_narrow_only = u16::from(columns) > room / 2 && u16::from(columns) <= room;
        let lines = scale(imprint, area.width, area.height);
        let cell = if fits_narrow_only { 1 } else { 2 * lines };
        let columns_seen = AxisWindow::new(columns, room / cell, cursor.0);
        let rows_seen = AxisWindow::new(rows, area.height.saturating_sub(1) / lines, cursor.1);
        let whole = columns_seen.count == columns && rows_seen.count == rows;
        Self {
            x: area.x + RULER.min(area.width),
            y: area.y + 1,
            cell,
            lines,
            columns: columns_seen,
            rows: rows_seen,
            whole,
        }
    }

    /// The taxel at a place of the screen.
    pub fn taxel(&self, x: u16, y: u16) -> Option<(u8, u8)> {
        let (x, y) = (x.checked_sub(self.x)?, y.checked_sub(self.y)?);
        Some((
            self.columns.at(x / self.cell)?,
            self.rows.at(y / self.lines)?,
        ))
    }
}
