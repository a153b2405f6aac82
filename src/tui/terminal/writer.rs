//! The bytes that bring a terminal's screen up to date: moves, characters, styles, as few as are needed.
//!
//! It knows what the terminal shows, so that it can write over characters in between where that is shorter than a
//! move, and erase blanks at once. Moves are the shortest of several, styles are told by their difference.
//!
//! What is taken for granted is what a VT100 does: a character in the last column leaves the cursor there, and a line
//! feed keeps the column (in raw mode). Characters that some terminals may show wider than others are followed by a
//! move that says exactly where the next one stands.

use std::ops::Range;

use ratatui::buffer::Cell;
use ratatui::layout::{Position, Size};
use ratatui::text::Span;

use crate::tui::terminal::pen::{CellStyle, PLAIN};
use crate::tui::terminal::settings::Abilities;

/// Writes cells where they are not on the screen yet.
#[derive(Clone, Debug)]
pub(in crate::tui) struct Writer<'a> {
    pub(in crate::tui) size: Size,
    pub(in crate::tui) abilities: Abilities,
    /// What is or will be on the screen.
    pub(in crate::tui) cells: &'a [Cell],
    /// Which of it is not there yet.
    pub(in crate::tui) stale: Vec<bool>,
    /// Where the terminal's cursor is; none where that is not certain. A column beyond the last one stands for the
    /// last one after a character was written there.
    pub(in crate::tui) at: Option<Position>,
    pub(in crate::tui) pen: CellStyle,
    pub(in crate::tui) out: Vec<u8>,
}

impl Writer<'_> {
    /// Writes the stale cells of some pieces of rows, then goes where the cursor shall be.
    pub(in crate::tui) fn write_all(mut self, runs: &[Run], wanted: Option<Position>) -> Self {
        for run in runs {
            self.write_run(run);
        }
        if let Some(wanted) = wanted {
            self.go(wanted.x, wanted.y);
        }
        self
    }

    fn index(&self, x: u16, y: u16) -> usize {
        usize::from(y) * usize::from(self.size.width) + usize::from(x)
    }

    fn write_run(&mut self, run: &Run) {
        let row = self.index(0, run.y)..self.index(0, run.y) + usize::from(self.size.width);
        let ink = self.cells[row.clone()]
            .iter()
            .rposition(|cell| !is_blank(cell));
        let end_of_ink = row.start + ink.map_or(0, |last| last + 1);
        for index in run.cells.clone() {
            if !self.stale[index] {
                continue;
            }
            self.go(run.column(index), run.y);
            let left = self.stale[index..row.end].iter().filter(|stale| **stale);
            if index >= end_of_ink && left.count() > b"\x1b[K".len() {
                self.erase(b"\x1b[K".to_vec());
                self.stale[index..row.end].fill(false);
                return;
            }
            let blanks = self.blanks(index..run.cells.end);
            let erasure = csi(blanks, 'X');
            let after = index + usize::from(blanks);
            // Erasing does not move the cursor: where more is to come, a move is to be paid for.
            let moved = if after < run.cells.end { 4 } else { 0 };
            if self.abilities.erases && erasure.len() + moved < usize::from(blanks) {
                self.erase(erasure);
                self.stale[index..after].fill(false);
                continue;
            }
            self.write(index);
            let end = index + columns(&self.cells[index]);
            self.stale[index..end.min(row.end)].fill(false);
        }
    }

    /// How many cells at the head of a piece are stale and blank.
    fn blanks(&self, cells: Range<usize>) -> u16 {
        let blank = |&index: &usize| self.stale[index] && is_blank(&self.cells[index]);
        u16::try_from(cells.take_while(blank).count()).unwrap_or(0)
    }

    fn erase(&mut self, how: Vec<u8>) {
        if !self.pen.leaves_blanks_plain() {
            self.take(PLAIN);
        }
        self.out.extend(how);
    }

    fn take(&mut self, pen: CellStyle) {
        if self.abilities.styles {
            pen.change(self.pen, &mut self.out);
        }
        self.pen = pen;
    }

    /// Writes a cell where the cursor is.
    fn write(&mut self, index: usize) {
        let cell = &self.cells[index];
        let pen = CellStyle::of(cell);
        let (narrow, symbol) = (is_narrow(cell.symbol()), cell.symbol());
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
            let pen = CellStyle::of(cell);
            let blank = is_blank(cell) && self.pen.leaves_blanks_plain();
            let same = !self.abilities.styles || pen == self.pen;
            if self.stale[index] || !is_narrow(cell.symbol()) || !(same || blank) {
                return moved;
            }
            over.extend(cell.symbol().as_bytes());
        }
        shorter(over, moved)
    }
}

/// A piece of a row, all of it stale: which row, and which cells by their place in reading order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::tui) struct Run {
    y: u16,
    row: usize,
    cells: Range<usize>,
}

impl Run {
    /// All pieces of a screen of so many columns, in reading order.
    pub(in crate::tui) fn all(stale: &[bool], width: u16) -> Vec<Self> {
        let width = usize::from(width).max(1);
        let mut runs: Vec<Self> = Vec::new();
        for (index, _) in stale.iter().enumerate().filter(|(_, stale)| **stale) {
            let row = index - index % width;
            match runs.last_mut() {
                Some(last) if last.row == row && last.cells.end == index => last.cells.end += 1,
                _ => runs.push(Self {
                    y: u16::try_from(index / width).unwrap_or(u16::MAX),
                    row,
                    cells: index..index + 1,
                }),
            }
        }
        runs
    }

    fn column(&self, index: usize) -> u16 {
        u16::try_from(index - self.row).unwrap_or(u16::MAX)
    }

    /// How many columns from a place it begins; none where that is far, or in another row.
    pub(in crate::tui) fn distance(&self, place: Option<Position>) -> Option<u16> {
        let place = place.filter(|place| place.y == self.y)?;
        Some(self.column(self.cells.start).abs_diff(place.x)).filter(|&distance| distance <= 4)
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

/// Whether a cell looks as if nothing had been written there.
fn is_blank(cell: &Cell) -> bool {
    cell.symbol() == " " && CellStyle::of(cell).leaves_blanks_plain()
}

/// How many columns a cell takes.
pub(in crate::tui) fn columns(cell: &Cell) -> usize {
    match cell.symbol() {
        narrow if is_narrow(narrow) => 1,
        other => Span::raw(other).width().max(1),
    }
}

/// Whether every terminal gives it one column.
pub(in crate::tui) fn is_narrow(symbol: &str) -> bool {
    let mut characters = symbol.chars();
    let first = characters.next();
    // Latin and Greek; dashes and dots; lines, blocks and shades.
    characters.next().is_none()
        && first.is_some_and(|first| {
            matches!(first, ' '..='~' | '\u{a1}'..='\u{ac}' | '\u{ae}'..='\u{2ff}' | '\u{370}'..='\u{3ff}'
                | '\u{2010}'..='\u{2027}' | '\u{2190}'..='\u{2193}' | '\u{2500}'..='\u{259f}')
        })
}
