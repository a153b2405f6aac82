//! The screen of a terminal, kept up to date with few bytes.
//!
//! It knows what the terminal shows, so that it can write over characters in between where that is shorter than a
//! move, and erase the end of a line at once. Moves are the shortest of several, styles are told by their difference,
//! and a frame that changes nothing is no bytes.
//!
//! What is taken for granted is what a VT100 does: a character in the last column leaves the cursor there, and a line
//! feed keeps the column (in raw mode). Characters that some terminals may show wider than others are followed by a
//! move that says exactly where the next one stands.

use std::convert::Infallible;

use ratatui::backend::{Backend, ClearType, WindowSize};
use ratatui::buffer::Cell;
use ratatui::layout::{Position, Size};
use ratatui::text::Span;

use super::pen::{PLAIN, Pen};

/// A frame of fewer bytes is one packet of a network or less: it arrives in one piece anyhow, and goes without the
/// marks that keep it together.
const SMALL_FRAME: usize = 256;

const BEGIN_SYNCHRONIZED: &[u8] = b"\x1b[?2026h";
const END_SYNCHRONIZED: &[u8] = b"\x1b[?2026l";
const HIDE_CURSOR: &[u8] = b"\x1b[?25l";
const SHOW_CURSOR: &[u8] = b"\x1b[?25h";

/// A terminal's screen behind ratatui, which finds out what has changed.
#[derive(Debug)]
pub struct Screen {
    size: Size,
    /// What is or will be on the screen.
    cells: Vec<Cell>,
    /// Which of it is not there yet.
    stale: Vec<bool>,
    /// Where the terminal's cursor is; none where that is not certain. A column beyond the last one stands for the
    /// last one after a character was written there.
    at: Option<Position>,
    pen: Pen,
    /// Whether the terminal shows its cursor.
    visible: bool,
    /// Where the cursor shall be seen.
    wanted: Option<Position>,
    /// The position that ratatui reads back.
    asked: Position,
    styles: bool,
    synchronized: bool,
    out: Vec<u8>,
}

impl Screen {
    /// An empty screen with a visible cursor. `styles` is whether it has any, `synchronized` whether it knows marks
    /// that keep a frame together.
    pub fn new(size: Size, styles: bool, synchronized: bool) -> Self {
        let mut screen = Self {
            size,
            cells: Vec::new(),
            stale: Vec::new(),
            at: None,
            pen: PLAIN,
            visible: true,
            wanted: None,
            asked: Position::ORIGIN,
            styles,
            synchronized,
            out: Vec::new(),
        };
        screen.resize(size);
        screen
    }

    /// Gives it another size. Drawing clears it then.
    pub fn resize(&mut self, size: Size) {
        let cells = usize::from(size.width) * usize::from(size.height);
        self.size = size;
        self.cells = vec![Cell::default(); cells];
        self.stale = vec![false; cells];
        self.at = None;
    }

    /// The terminal was somebody else's: nothing is known of its cursor and its style.
    pub fn forget(&mut self) {
        self.at = None;
        self.pen = PLAIN;
        self.visible = true;
        self.out.clear();
    }

    /// The bytes of the frame, to be written at once; none where nothing has changed.
    pub fn take_frame(&mut self) -> Vec<u8> {
        if let Some(wanted) = self.wanted {
            self.go(wanted.x, wanted.y);
        }
        let shown = self.wanted.is_some();
        let mut out = std::mem::take(&mut self.out);
        let large = out.len() > SMALL_FRAME;
        if large && shown && self.visible && !self.synchronized {
            // Else it could be seen running about.
            out.splice(0..0, HIDE_CURSOR.iter().copied());
            self.visible = false;
        }
        if shown != self.visible {
            out.extend(if shown { SHOW_CURSOR } else { HIDE_CURSOR });
            self.visible = shown;
        }
        if large && self.synchronized {
            out.splice(0..0, BEGIN_SYNCHRONIZED.iter().copied());
            out.extend(END_SYNCHRONIZED);
        }
        out
    }

    fn index(&self, x: u16, y: u16) -> usize {
        usize::from(y) * usize::from(self.size.width) + usize::from(x)
    }

    fn row(&self, y: u16) -> std::ops::Range<usize> {
        self.index(0, y)..self.index(0, y) + usize::from(self.size.width)
    }

    /// A row with a character of two columns is written as a whole: terminals differ in what is left of one that is
    /// half written over.
    fn renew_wide_row(&mut self, y: u16) {
        let row = self.row(y);
        if self.cells[row.clone()]
            .iter()
            .any(|cell| !is_narrow(cell.symbol()))
        {
            self.stale[row].fill(true);
        }
    }

    fn update_row(&mut self, y: u16) {
        let width = self.size.width;
        let row = self.row(y);
        let blank = |cell: &Cell| cell.symbol() == " " && Pen::of(cell).leaves_blanks_plain();
        let ink = self.cells[row.clone()]
            .iter()
            .rposition(|cell| !blank(cell));
        let end = row.start + ink.map_or(0, |last| last + 1);
        for index in row.clone() {
            if !self.stale[index] {
                continue;
            }
            let x = u16::try_from(index - row.start).unwrap_or(width);
            self.go(x, y);
            let rest = self.stale[index..row.end].iter().filter(|stale| **stale);
            if index >= end && rest.count() > b"\x1b[K".len() {
                if !self.pen.leaves_blanks_plain() {
                    self.take(PLAIN);
                }
                self.out.extend(b"\x1b[K");
                self.stale[index..row.end].fill(false);
                return;
            }
            self.write(index);
            let end = index + columns(&self.cells[index]);
            self.stale[index..end.min(row.end)].fill(false);
        }
    }

    fn take(&mut self, pen: Pen) {
        if self.styles {
            pen.change(self.pen, &mut self.out);
        }
        self.pen = pen;
    }

    /// Writes a cell where the cursor is.
    fn write(&mut self, index: usize) {
        let cell = &self.cells[index];
        let pen = Pen::of(cell);
        let (narrow, symbol) = (is_narrow(cell.symbol()), cell.symbol().to_owned());
        let any_pen = symbol == " " && self.pen.leaves_blanks_plain() && pen.leaves_blanks_plain();
        if !any_pen {
            self.take(pen);
        }
        self.out.extend(symbol.as_bytes());
        self.at = self
            .at
            .filter(|_| narrow)
            .map(|at| Position { x: at.x + 1, ..at });
    }

    /// Brings the cursor to a place, the shortest way.
    fn go(&mut self, x: u16, y: u16) {
        let target = Position { x, y };
        if self.at == Some(target) {
            return;
        }
        let mut way = absolute(target);
        if let Some(at) = self.at {
            let down = usize::from(y.saturating_sub(at.y));
            let vertical = match at.y.checked_sub(y) {
                Some(up) if up > 0 => csi(up, 'A'),
                _ => shorter(b"\n".repeat(down), csi(y - at.y.min(y), 'B')),
            };
            let returned = [vec![b'\r'], vertical.clone(), self.forward(0, x, y)].concat();
            way = shorter(way, returned);
            // After the last column only a return or a full move is sure.
            if at.x < self.size.width {
                let horizontal = match at.x.checked_sub(x) {
                    Some(left) => shorter(b"\x08".repeat(usize::from(left)), csi(left, 'D')),
                    None => self.forward(at.x, x, y),
                };
                way = shorter(way, [vertical, horizontal].concat());
            }
        }
        self.out.extend(way);
        self.at = Some(target);
    }

    /// From column `from` to column `to` of a row: by a move, or over what stands between if that looks the same now.
    fn forward(&self, from: u16, to: u16, y: u16) -> Vec<u8> {
        let moved = csi(to - from, 'C');
        let between = self.index(from, y)..self.index(to, y);
        // The first cell may be the second half of a wide character.
        let half = from > 0 && !is_narrow(self.cells[between.start - 1].symbol());
        if between.len() > moved.len() || half {
            return moved;
        }
        let mut over = Vec::new();
        for index in between {
            let cell = &self.cells[index];
            let pen = Pen::of(cell);
            let blank =
                cell.symbol() == " " && pen.leaves_blanks_plain() && self.pen.leaves_blanks_plain();
            let same = !self.styles || pen == self.pen;
            if self.stale[index] || !is_narrow(cell.symbol()) || !(same || blank) {
                return moved;
            }
            over.extend(cell.symbol().as_bytes());
        }
        shorter(over, moved)
    }
}

/// The shorter one, the first of equals.
fn shorter(first: Vec<u8>, second: Vec<u8>) -> Vec<u8> {
    if second.len() < first.len() {
        second
    } else {
        first
    }
}

/// `ESC [ count final`, the count left out where it is one, all where it is none.
fn csi(count: u16, last: char) -> Vec<u8> {
    match count {
        0 => Vec::new(),
        1 => format!("\x1b[{last}").into_bytes(),
        _ => format!("\x1b[{count}{last}").into_bytes(),
    }
}

fn absolute(target: Position) -> Vec<u8> {
    let (row, column) = (u32::from(target.y) + 1, u32::from(target.x) + 1);
    match (row, column) {
        (1, 1) => "\x1b[H".to_owned(),
        (_, 1) => format!("\x1b[{row}H"),
        _ => format!("\x1b[{row};{column}H"),
    }
    .into_bytes()
}

/// How many columns a cell takes.
fn columns(cell: &Cell) -> usize {
    match cell.symbol() {
        narrow if is_narrow(narrow) => 1,
        other => Span::raw(other).width().max(1),
    }
}

/// Whether every terminal gives it one column.
fn is_narrow(symbol: &str) -> bool {
    let mut characters = symbol.chars();
    let first = characters.next();
    // Latin and Greek; dashes and dots; lines, blocks and shades.
    characters.next().is_none()
        && first.is_some_and(|first| {
            matches!(first, ' '..='~' | '\u{a1}'..='\u{ac}' | '\u{ae}'..='\u{2ff}' | '\u{370}'..='\u{3ff}'
                | '\u{2010}'..='\u{2027}' | '\u{2190}'..='\u{2193}' | '\u{2500}'..='\u{259f}')
        })
}

impl Backend for Screen {
    type Error = Infallible;

    fn draw<'a, I>(&mut self, content: I) -> Result<(), Self::Error>
    where
        I: Iterator<Item = (u16, u16, &'a Cell)>,
    {
        let mut rows = vec![false; usize::from(self.size.height)];
        for (x, y, cell) in content {
            if x < self.size.width && y < self.size.height {
                let touched = std::mem::replace(&mut rows[usize::from(y)], true);
                if !touched {
                    self.renew_wide_row(y);
                }
                let index = self.index(x, y);
                let end = (index + columns(cell)).min(self.row(y).end);
                // What a wide character covers is not told.
                self.cells[index..end].fill(Cell::default());
                self.cells[index] = cell.clone();
                self.stale[index] = true;
            }
        }
        for y in (0..self.size.height).filter(|&y| rows[usize::from(y)]) {
            self.renew_wide_row(y);
            self.update_row(y);
        }
        Ok(())
    }

    fn hide_cursor(&mut self) -> Result<(), Self::Error> {
        self.wanted = None;
        Ok(())
    }

    fn show_cursor(&mut self) -> Result<(), Self::Error> {
        self.wanted = Some(self.asked);
        Ok(())
    }

    fn get_cursor_position(&mut self) -> Result<Position, Self::Error> {
        Ok(self.asked)
    }

    fn set_cursor_position<P: Into<Position>>(&mut self, position: P) -> Result<(), Self::Error> {
        self.asked = position.into();
        self.wanted = self.wanted.map(|_| self.asked);
        Ok(())
    }

    fn clear(&mut self) -> Result<(), Self::Error> {
        self.clear_region(ClearType::All)
    }

    /// Everything, whatever is asked for: the program has the whole screen.
    fn clear_region(&mut self, _: ClearType) -> Result<(), Self::Error> {
        self.resize(self.size);
        self.out.clear();
        self.pen = PLAIN;
        self.out.extend(
            if self.styles {
                "\x1b[m\x1b[H\x1b[2J"
            } else {
                "\x1b[H\x1b[2J"
            }
            .as_bytes(),
        );
        self.at = Some(Position::ORIGIN);
        Ok(())
    }

    fn size(&self) -> Result<Size, Self::Error> {
        Ok(self.size)
    }

    fn window_size(&mut self) -> Result<WindowSize, Self::Error> {
        Ok(WindowSize {
            columns_rows: self.size,
            pixels: Size::default(),
        })
    }

    /// The frame waits for [`Screen::take_frame`].
    fn flush(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

#[cfg(test)]
mod tests;
