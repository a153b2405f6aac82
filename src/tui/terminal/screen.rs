//! The screen of a terminal behind ratatui, kept up to date with few bytes.
//!
//! It gathers what has changed until the frame is taken, and writes it in that order of two which needs fewer bytes:
//! as one reads, or first what is near the cursor. A frame that changes nothing is no bytes.

use std::convert::Infallible;

use ratatui::backend::{Backend, ClearType, WindowSize};
use ratatui::buffer::Cell;
use ratatui::layout::{Position, Size};

use crate::tui::terminal::pen::{CellStyle, PLAIN};
use crate::tui::terminal::settings::Abilities;
use crate::tui::terminal::writer::{Run, Writer, columns, is_narrow};

/// A frame of fewer bytes is one packet of a network or less: it arrives in one piece anyhow, and goes without the
/// marks that keep it together.
const SMALL_FRAME: usize = 256;

/// With more pieces than these, their order does not matter any more.
const FEW: usize = 64;

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
    pen: CellStyle,
    /// Whether the terminal shows its cursor.
    visible: bool,
    /// Where the cursor shall be seen.
    wanted: Option<Position>,
    /// The position that ratatui reads back.
    asked: Position,
    abilities: Abilities,
    out: Vec<u8>,
}

impl Screen {
    /// An empty screen with a visible cursor.
    pub fn new(size: Size, abilities: Abilities) -> Self {
        let mut screen = Self {
            size,
            cells: Vec::new(),
            stale: Vec::new(),
            at: None,
            pen: PLAIN,
            visible: true,
            wanted: None,
            asked: Position::ORIGIN,
            abilities,
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
        let shown = self.wanted.is_some();
        let mut out = self.write();
        let large = out.len() > SMALL_FRAME;
        if large && shown && self.visible && !self.abilities.synchronized {
            // Else it could be seen running about.
            out.splice(0..0, HIDE_CURSOR.iter().copied());
            self.visible = false;
        }
        if shown != self.visible {
            out.extend(if shown { SHOW_CURSOR } else { HIDE_CURSOR });
            self.visible = shown;
        }
        if large && self.abilities.synchronized {
            out.splice(0..0, BEGIN_SYNCHRONIZED.iter().copied());
            out.extend(END_SYNCHRONIZED);
        }
        out
    }

    /// Brings the terminal up to date.
    fn write(&mut self) -> Vec<u8> {
        let runs = Run::all(&self.stale, self.size.width);
        let writer = Writer {
            size: self.size,
            abilities: self.abilities,
            cells: &self.cells,
            stale: std::mem::take(&mut self.stale),
            at: self.at,
            pen: self.pen,
            out: std::mem::take(&mut self.out),
        };
        let mut near = runs.clone();
        near.sort_by_key(
            |run| match (run.distance(self.at), run.distance(self.wanted)) {
                (Some(distance), _) => (0, distance),
                (_, Some(distance)) => (1, distance),
                _ => (2, 0),
            },
        );
        let other = (runs.len() <= FEW && near != runs)
            .then(|| writer.clone().write_all(&near, self.wanted));
        let read = writer.write_all(&runs, self.wanted);
        let best = match other {
            Some(other) if other.out.len() < read.out.len() => other,
            _ => read,
        };
        (self.stale, self.at, self.pen) = (best.stale, best.at, best.pen);
        best.out
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
            if self.abilities.styles {
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
