//! The places of the taxels on the screen, and their size.
//!
//! ```text
//! Square(2)   four columns, two lines     where the whole matrix fits enlarged
//! Square(1)   two columns, one line       looks square
//! Narrow      one column, one line        coverage of a matrix that is too wide for two
//! Half        one column, half a line     a matrix that does not fit otherwise: two taxels a character
//! ```
//! If a matrix does not fit even then, a window shows a part of it. The window follows the cursor, or the described
//! region if that was changed last. It moves in steps of half its size, so that a move of the cursor changes only a
//! few characters, except when the window moves. Drawing and the mouse share this layout.

use std::ops::Range;

use ratatui::layout::Rect;
use taxel_core::imprint::{Bounds, Imprint};

use crate::tui::widget::write::{narrow, taxels};

pub const RULER: u16 = 3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaxelSize {
    Half,
    Narrow,
    Square(u16),
}

impl TaxelSize {
    /// Returns the largest size at which all taxels fit beside their rulers. If they do not fit as squares, two
    /// taxels share a character if `halves` allows it; otherwise they are as wide as the number of columns allows.
    pub(in crate::tui) fn fitting(imprint: &Imprint, area: Rect, halves: bool) -> Self {
        let columns = u16::from(imprint.columns());
        let across = area.width.saturating_sub(RULER);
        let lines = area.height.saturating_sub(1);
        match (across / (2 * columns)).min(lines / u16::from(imprint.rows())) {
            0 if halves => Self::Half,
            0 if across / 2 < columns && columns <= across => Self::Narrow,
            0 => Self::Square(1),
            times => Self::Square(times),
        }
    }

    pub(in crate::tui) fn is_large(self) -> bool {
        matches!(self, Self::Square(2..))
    }

    pub(in crate::tui) fn columns(self) -> u16 {
        match self {
            Self::Half | Self::Narrow => 1,
            Self::Square(times) => 2 * times,
        }
    }

    pub(in crate::tui) fn half_lines(self) -> u16 {
        match self {
            Self::Half => 1,
            Self::Narrow => 2,
            Self::Square(times) => 2 * times,
        }
    }

    pub(in crate::tui) fn matrix_width(self, imprint: &Imprint) -> u16 {
        RULER + self.columns() * u16::from(imprint.columns())
    }
}

#[derive(Clone, Copy, Debug)]
pub struct AxisWindow {
    pub first: u8,
    pub count: u8,
    all: u8,
}

impl AxisWindow {
    pub(in crate::tui) fn after(hidden: u16, cells: u8, room: u16) -> Self {
        let count = taxels(room).min(cells);
        let first = taxels(hidden).min(cells - count);
        Self {
            first,
            count,
            all: cells,
        }
    }

    /// Creates a window of at most `room` of `cells` cells that begins at a multiple of `step` and shows all of
    /// `seen`, or its beginning if it is too large. It moves by half of its size.
    pub(in crate::tui) fn showing(cells: u8, room: u16, seen: Range<u8>, step: u8) -> Self {
        let count = taxels(room).min(cells);
        let whole_steps = |number: u8| number / step * step;
        let stride = whole_steps(count / 2).max(step);
        let middle = seen.start + (seen.end - seen.start) / 2;
        let before = (middle / stride * stride).saturating_sub(whole_steps(count / 4));
        let ending = seen.end.saturating_sub(count).next_multiple_of(step);
        let before = before.max(ending).min(whole_steps(seen.start));
        let last = (cells - count).next_multiple_of(step);
        let first = if count < cells { before.min(last) } else { 0 };
        Self {
            first,
            count: count.min(cells - first),
            all: cells,
        }
    }

    pub fn visible(&self) -> impl Iterator<Item = (u16, u8)> {
        (0..self.count).map(|index| (u16::from(index), self.first + index))
    }

    pub fn is_whole(&self) -> bool {
        self.count == self.all
    }

    pub fn hidden(&self) -> (bool, bool) {
        (self.first > 0, self.first + self.count < self.all)
    }

    fn at(self, place: u16) -> Option<u8> {
        (place < u16::from(self.count)).then(|| self.first + taxels(place))
    }
}

#[derive(Clone, Copy, Debug)]
pub struct TaxelGrid {
    pub x: u16,
    pub y: u16,
    pub size: TaxelSize,
    pub columns: AxisWindow,
    pub rows: AxisWindow,
}

impl TaxelGrid {
    /// `halves` is whether two taxels may share a character.
    pub fn of(area: Rect, imprint: &Imprint, seen: Bounds, halves: bool) -> Self {
        let size = TaxelSize::fitting(imprint, area, halves);
        let (across, lines) = (
            area.width.saturating_sub(RULER),
            area.height.saturating_sub(1),
        );
        // The same two taxels share a line wherever the window is.
        let step = if size == TaxelSize::Half { 2 } else { 1 };
        let columns = AxisWindow::showing(
            imprint.columns(),
            across / size.columns(),
            seen.columns(),
            1,
        );
        let rows = narrow(2 * u32::from(lines) / u32::from(size.half_lines()));
        let rows = AxisWindow::showing(imprint.rows(), rows, seen.rows(), step);
        Self {
            x: area.x + RULER.min(area.width),
            y: area.y + 1,
            size,
            columns,
            rows,
        }
    }

    pub fn characters(&self) -> (u16, u16) {
        let (columns, rows) = (u16::from(self.columns.count), u16::from(self.rows.count));
        (
            columns * self.size.columns(),
            (rows * self.size.half_lines()).div_ceil(2),
        )
    }

    /// Two taxels that share a character have the same place.
    pub fn cell_rect(&self, column: u16, row: u16) -> Rect {
        let (width, half_lines) = (self.size.columns(), self.size.half_lines());
        Rect {
            x: self.x + column * width,
            y: self.y + row * half_lines / 2,
            width,
            height: half_lines.div_ceil(2),
        }
    }

    pub fn taxels(&self, x: u16, y: u16) -> impl Iterator<Item = (u8, u8)> {
        let place = x.checked_sub(self.x).zip(y.checked_sub(self.y));
        let found = move |half: u16| {
            let (x, y) = place?;
            let row = (2 * u32::from(y) + u32::from(half)) / u32::from(self.size.half_lines());
            Some((
                self.columns.at(x / self.size.columns())?,
                self.rows.at(narrow(row))?,
            ))
        };
        let second = u16::from(self.size == TaxelSize::Half);
        (0..=second).filter_map(found)
    }

    /// Returns the taxel that a click at a place of the screen means. If two share a character, this is the one with
    /// the cursor, otherwise the upper one.
    pub fn taxel(&self, x: u16, y: u16, cursor: (u8, u8)) -> Option<(u8, u8)> {
        let mut with_cursor = self.taxels(x, y).filter(|&taxel| taxel == cursor);
        with_cursor.next().or_else(|| self.taxels(x, y).next())
    }
}
