//! A matrix of cells on the screen, with rulers: the matrix, comparisons, heat maps and thumbnails.
//!
//! ```text
//! Square(2)   four columns, two lines     where all cells fit enlarged, or twice as large again, and so on
//! Square(1)   two columns, one line       looks square
//! Narrow      one column, one line        a matrix that is too wide for two
//! Half        one column, half a line     two cells a character, one above the other
//! Number      six columns, one line       values of up to four digits with a mark
//! ```
//! If not all cells fit, a window shows a part of them. It follows what is to be seen, in steps of half its size, so
//! that a move of the cursor changes only a few characters. Drawing and the mouse share this layout.

use std::ops::Range;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use taxel_core::imprint::{Bounds, Imprint};

use crate::tui::widget::write::{self, narrow, taxels};
use crate::tui::widget::{Role, Theme};

/// The columns of the ruler of rows.
pub const RULER: u16 = 3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellSize {
    Half,
    Narrow,
    Square(u16),
    Number,
}

impl CellSize {
    /// Returns the largest size at which all cells fit into an area. If they do not fit as squares, two share a
    /// character if `halves` allows it; otherwise they are as wide as the number of columns allows.
    pub fn fitting((columns, rows): (u8, u8), area: Rect, halves: bool) -> Self {
        let columns = u16::from(columns);
        match (area.width / (2 * columns)).min(area.height / u16::from(rows)) {
            0 if halves => Self::Half,
            0 if area.width / 2 < columns && columns <= area.width => Self::Narrow,
            0 => Self::Square(1),
            times => Self::Square(times),
        }
    }

    pub fn is_large(self) -> bool {
        matches!(self, Self::Square(2..))
    }

    pub fn columns(self) -> u16 {
        match self {
            Self::Half | Self::Narrow => 1,
            Self::Square(times) => 2 * times,
            Self::Number => 6,
        }
    }

    pub fn half_lines(self) -> u16 {
        match self {
            Self::Half => 1,
            Self::Narrow | Self::Number => 2,
            Self::Square(times) => 2 * times,
        }
    }

    /// The rows that share a line.
    fn rows(self) -> u8 {
        if self == Self::Half { 2 } else { 1 }
    }
}

/// The visible cells along one axis.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    pub first: u8,
    pub count: u8,
    all: u8,
}

impl Window {
    /// A window that begins at a given cell, or earlier so that it is full.
    pub fn after(hidden: u16, all: u8, room: u16) -> Self {
        let count = taxels(room).min(all);
        let first = taxels(hidden).min(all - count);
        Self { first, count, all }
    }

    /// A window that begins at a multiple of `step` and shows all of `seen`, or its beginning if it is too large.
    pub fn showing(all: u8, room: u16, seen: Range<u8>, step: u8) -> Self {
        let count = taxels(room).min(all);
        let whole_steps = |number: u8| number / step * step;
        let stride = whole_steps(count / 2).max(step);
        let middle = seen.start + (seen.end - seen.start) / 2;
        let before = (middle / stride * stride).saturating_sub(whole_steps(count / 4));
        let ending = seen.end.saturating_sub(count).next_multiple_of(step);
        let last = (all - count).next_multiple_of(step);
        let first = before.max(ending).min(whole_steps(seen.start)).min(last);
        let count = count.min(all - first);
        Self { first, count, all }
    }

    /// The visible cells: place in the window, and number.
    pub fn visible(&self) -> impl Iterator<Item = (u16, u8)> + use<> {
        (0..).zip(self.first..self.first + self.count)
    }

    /// Whether cells are hidden before and after the window.
    pub fn hidden(&self) -> (bool, bool) {
        (self.first > 0, self.first + self.count < self.all)
    }

    fn at(self, place: u16) -> Option<u8> {
        (place < u16::from(self.count)).then(|| self.first + taxels(place))
    }
}

/// How a cell is drawn: two signs in its middle, of which a cell of one column has the first, in a field of `fill`.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    pub signs: [char; 2],
    pub fill: char,
    pub style: Style,
}

#[derive(Clone, Copy, Debug)]
pub struct Grid {
    pub x: u16,
    pub y: u16,
    pub size: CellSize,
    pub columns: Window,
    pub rows: Window,
}

/// Returns the part of an area that rulers leave.
pub fn beside_rulers(area: Rect) -> Rect {
    write::below(write::right_of(area, area.x + RULER.min(area.width)), 1)
}

impl Grid {
    /// A grid in an area, without its rulers, whose window shows the cells `seen`.
    pub fn new(area: Rect, size: CellSize, (columns, rows): (u8, u8), seen: Bounds) -> Self {
        // The same two cells share a line wherever the window is.
        let step = size.rows();
        let lines = 2 * u32::from(area.height) / u32::from(size.half_lines());
        let room = area.width / size.columns();
        Self {
            x: area.x,
            y: area.y,
            size,
            columns: Window::showing(columns, room, seen.columns(), 1),
            rows: Window::showing(rows, narrow(lines), seen.rows(), step),
        }
    }

    /// Whether all cells are visible.
    pub fn is_whole(&self) -> bool {
        self.columns.count == self.columns.all && self.rows.count == self.rows.all
    }

    /// The columns and lines of the screen that the window takes.
    pub fn characters(&self) -> (u16, u16) {
        let (columns, rows) = (u16::from(self.columns.count), u16::from(self.rows.count));
        let lines = (rows * self.size.half_lines()).div_ceil(2);
        (columns * self.size.columns(), lines)
    }

    fn rect(&self, column: u16, row: u16) -> Rect {
        let (width, half_lines) = (self.size.columns(), self.size.half_lines());
        Rect {
            x: self.x + column * width,
            y: self.y + row * half_lines / 2,
            width,
            height: half_lines.div_ceil(2),
        }
    }

    /// Returns the place of a visible cell. Two that share a character have the same place.
    pub fn place(&self, column: u8, row: u8) -> Option<Rect> {
        let mut columns = self.columns.visible().filter(|(_, own)| *own == column);
        let mut rows = self.rows.visible().filter(|(_, own)| *own == row);
        Some(self.rect(columns.next()?.0, rows.next()?.0))
    }

    /// The visible cells with their places; of two that share a character, the upper one.
    pub fn cells(&self) -> impl Iterator<Item = (Rect, (u8, u8))> {
        let rows = self.rows.visible().step_by(self.size.rows().into());
        rows.flat_map(move |(y, row)| {
            let columns = self.columns.visible();
            columns.map(move |(x, column)| (self.rect(x, y), (column, row)))
        })
    }

    /// Returns the one or two cells at a place of the screen, the upper one first.
    pub fn at(&self, x: u16, y: u16) -> impl Iterator<Item = (u8, u8)> {
        let place = x.checked_sub(self.x).zip(y.checked_sub(self.y));
        (0..u32::from(self.size.rows())).filter_map(move |half| {
            let (x, y) = place?;
            let row = (2 * u32::from(y) + half) / u32::from(self.size.half_lines());
            let column = self.columns.at(x / self.size.columns())?;
            Some((column, self.rows.at(narrow(row))?))
        })
    }

    pub fn draw(&self, buffer: &mut Buffer, look: impl Fn(u8, u8) -> Look) {
        let screen = *buffer.area();
        for (place, (column, row)) in self.cells() {
            let look = look(column, row);
            let middle = ((place.width.max(2) - 2) / 2, (place.height - 1) / 2);
            for position in place.intersection(screen).positions() {
                let sign = match (position.x - place.x, position.y - place.y) {
                    at if at == middle => look.signs[0],
                    at if at == (middle.0 + 1, middle.1) => look.signs[1],
                    _ => look.fill,
                };
                buffer[position].set_char(sign).set_style(look.style);
            }
        }
    }

    /// Draws the numbers of columns and rows, with arrows where there are more cells.
    pub fn draw_rulers(&self, theme: &Theme, buffer: &mut Buffer) {
        let [above, below, left, right] = theme.more();
        let (more_above, more_below) = self.rows.hidden();
        let (more_left, more_right) = self.columns.hidden();
        let (width, height) = self.characters();
        // Numbers end before an arrow.
        let room = width.saturating_sub(more_right.into());
        let columns = self.columns.visible();
        let cell = self.size.columns();
        let every = match cell {
            1 => 5,
            2 => 2,
            _ => 1,
        };
        for (index, column) in columns.filter(|(_, column)| column % every == 0) {
            let text = column.to_string();
            let length = narrow(text.len());
            let inside = match self.size {
                // Its number ends where its values end.
                CellSize::Number => 4 - length,
                _ => (cell.max(2) - 2) / 2,
            };
            let x = index * cell + inside;
            if x + length <= room {
                let place = Rect::new(self.x + x, self.y.saturating_sub(1), length, 1);
                write::text(buffer, place, theme, &text, Role::Quiet);
            }
        }
        for (index, row) in self.rows.visible().step_by(self.size.rows().into()) {
            let cell = self.rect(0, index);
            let y = cell.y + (cell.height - 1) / 2;
            let place = Rect::new(self.x.saturating_sub(RULER), y, RULER - 1, 1);
            write::text(buffer, place, theme, &format!("{row:>2}"), Role::Quiet);
        }
        let (before, line) = (self.x.saturating_sub(1), self.y.saturating_sub(1));
        let marks = [
            (more_above, before, self.y, above),
            (more_below, before, self.y + height.max(1) - 1, below),
            (more_left, before, line, left),
            (more_right, self.x + width.max(1) - 1, line, right),
        ];
        for (_, x, y, mark) in marks.into_iter().filter(|(more, ..)| *more) {
            let place = Rect::new(x, y, 1, 1);
            write::text(buffer, place, theme, &mark.to_string(), Role::Key);
        }
    }
}

/// Returns the columns and lines of a small picture of an imprint: half a character a taxel, in ASCII a whole one.
pub fn thumbnail_size(theme: &Theme, imprint: &Imprint) -> (u16, u16) {
    let rows = u16::from(imprint.rows());
    let lines = if theme.ascii { rows } else { rows.div_ceil(2) };
    (imprint.columns().into(), lines)
}

pub fn draw_thumbnail(theme: &Theme, imprint: &Imprint, buffer: &mut Buffer, area: Rect) {
    let size = theme.pick(CellSize::Narrow, CellSize::Half);
    let seen = imprint.bounds().unwrap_or(Bounds::of_taxel(0, 0));
    let grid = Grid::new(area, size, (imprint.columns(), imprint.rows()), seen);
    let style = theme.style(Role::Chosen);
    grid.draw(buffer, |column, row| {
        let lower = size == CellSize::Half && imprint.get(column, row + 1);
        let sign = theme.half(imprint.get(column, row), lower);
        Look {
            signs: [sign; 2],
            fill: sign,
            style,
        }
    });
}

#[cfg(test)]
mod tests {
    use taxel_core::sensor::MatrixSize;

    use super::*;

    #[test]
    fn the_last_of_an_odd_number_of_rows_is_drawn() {
        let mut imprint = Imprint::empty(MatrixSize::new(3, 63).expect("an allowed size"));
        imprint.set(1, 62, true);
        for (ascii, height, sign) in [(false, 22, "▀"), (true, 22, "#")] {
            let area = Rect::new(0, 0, 3, height);
            let mut buffer = Buffer::empty(area);
            draw_thumbnail(&Theme::plain(ascii), &imprint, &mut buffer, area);
            let lines = 0..height;
            let symbols = lines.map(|y| buffer.cell((1, y)).map(|cell| cell.symbol().to_owned()));
            let drawn = symbols.flatten().any(|symbol| symbol == sign);
            assert!(drawn, "ascii: {ascii}");
        }
    }
}
