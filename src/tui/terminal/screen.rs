//! The screen of a terminal behind ratatui, kept up to date with few bytes.
//!
//! Bytes of a frame at 80 × 24 beside ratatui's own backend (`CrosstermBackend` into one buffer), measured by
//! `tests/screen/frames.rs`:
//! ```text
//!                             this   stock
//! first frame                 2116    2970
//! cursor move                   23      72
//! cursor move on a figure       26      65
//! first toggle                 166     329
//! toggle that makes a hole      54     105
//! a form opens                 666    1491
//! a tab of Explore            1498    2504
//! nothing has changed            0      25
//! ```
//! The budgets are 2200 bytes for the first frame, 60 for a cursor move and 0 for no change (a line of 9600 baud
//! takes 960 bytes a second); the stock backend exceeds them. The savings come from five things: the shortest of
//! several cursor moves is sent, short unchanged stretches are written again instead of jumped over, blanks are
//! erased at once, styles are changed by their difference, and of several orders of writing the shortest is sent.
//!
//! The terminal is assumed to behave like a VT100: a character in the last column leaves the cursor there, and a line
//! feed keeps the column (in raw mode). A character that some terminals may show wider than others is followed by a
//! move to an absolute position.

use std::convert::Infallible;
use std::ops::Range;

use ratatui::backend::{Backend, ClearType, WindowSize};
use ratatui::buffer::Cell;
use ratatui::layout::{Position, Size};
use ratatui::text::Span;

use crate::tui::terminal::settings::Abilities;
use crate::tui::terminal::style::{CellStyle, PLAIN};
use crate::tui::widget::number::narrow;

/// The size in bytes from which a frame is marked as synchronized. A smaller one fits into one network packet, so it
/// arrives in one piece without marks.
const SMALL_FRAME: usize = 256;

/// Makes the terminal hold back what it shows until the end of the frame (mode 2026).
const BEGIN_SYNCHRONIZED: &[u8] = b"\x1b[?2026h";
/// Makes the terminal show the frame.
const END_SYNCHRONIZED: &[u8] = b"\x1b[?2026l";
/// Hides the cursor (mode 25).
const HIDE_CURSOR: &[u8] = b"\x1b[?25l";
/// Shows the cursor.
const SHOW_CURSOR: &[u8] = b"\x1b[?25h";
/// Erases from the cursor to the end of the line.
const ERASE_TO_END: &[u8] = b"\x1b[K";

/// Saves the cursor position and the style (DECSC).
const SAVE_CURSOR: &[u8] = b"\x1b7";
/// Restores both (DECRC).
const RESTORE_CURSOR: &[u8] = b"\x1b8";
/// Moves the cursor up by a row (RI).
const REVERSE_INDEX: &[u8] = b"\x1bM";

/// The greatest number of stretches for which several ways of writing are tried. A frame with more is long in any
/// case, and few of its bytes are cursor moves.
const MOST_TRIED: usize = 40;

/// A terminal's screen, as a backend of ratatui; it finds out what has changed.
#[derive(Debug)]
pub struct Screen {
    /// Columns and rows.
    size: Size,
    /// The cells that the screen shows once none is stale.
    cells: Vec<Cell>,
    /// Whether each cell differs from what the terminal shows.
    stale: Vec<bool>,
    /// The position of the terminal's cursor; None if it is not certain. A column beyond the last one means the last
    /// one, after a character was written there.
    at: Option<Position>,
    /// The style that is switched on.
    style: CellStyle,
    /// Whether the terminal shows its cursor.
    visible: bool,
    /// The position at which to show the cursor; None to hide it.
    wanted: Option<Position>,
    /// The position that ratatui set last and reads back.
    asked: Position,
    /// The abilities of the terminal.
    abilities: Abilities,
    /// The bytes of the frame so far.
    out: Vec<u8>,
}

impl Screen {
    /// Creates an empty screen with a visible cursor.
    pub fn new(size: Size, abilities: Abilities) -> Self {
        let mut screen = Self {
            size,
            cells: Vec::new(),
            stale: Vec::new(),
            at: None,
            style: PLAIN,
            visible: true,
            wanted: None,
            asked: Position::ORIGIN,
            abilities,
            out: Vec::new(),
        };
        screen.resize(size);
        screen
    }

    /// Changes the size; the next frame is drawn on an empty screen.
    pub fn resize(&mut self, size: Size) {
        let cells = usize::from(size.width) * usize::from(size.height);
        self.size = size;
        self.cells = vec![Cell::default(); cells];
        self.stale = vec![false; cells];
        self.at = None;
    }

    /// Forgets cursor and style, because another program has had the terminal.
    pub fn forget(&mut self) {
        self.at = None;
        self.style = PLAIN;
        self.visible = true;
        self.out.clear();
    }

    /// Returns the bytes of the frame, for one write; empty if nothing has changed.
    pub fn take_frame(&mut self) -> Vec<u8> {
        let shown = self.wanted.is_some();
        let mut out = std::mem::take(&mut self.out);
        let attempt = self.shortest();
        out.extend(attempt.out);
        (self.at, self.style) = (attempt.at, attempt.style);
        self.stale.fill(false);
        let large = out.len() > SMALL_FRAME;
        if large && shown && self.visible && !self.abilities.synchronized {
            // The moving cursor would be visible.
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

    /// Returns the shortest way to write the stale cells. If there are few stretches, several ways are tried.
    fn shortest(&self) -> Attempt<'_> {
        let runs = self.runs();
        let first = Attempt::new(self).written(&runs, false);
        if runs.len() > MOST_TRIED || runs.is_empty() {
            return first;
        }
        let near = |run: &&Run| self.at.is_some_and(|at| run.is_near(at));
        let (near, far): (Vec<&Run>, Vec<&Run>) = runs.iter().partition(near);
        let near_first: Vec<Run> = near.iter().chain(&far).copied().cloned().collect();
        let near_last: Vec<Run> = far.iter().chain(&near).copied().cloned().collect();
        let tries = [
            (&runs, true),
            (&near_first, false),
            (&near_first, true),
            (&near_last, false),
        ];
        let tries = tries.map(|(runs, saves)| Attempt::new(self).written(runs, saves));
        tries.into_iter().fold(first, |one, other| {
            if other.out.len() < one.out.len() {
                other
            } else {
                one
            }
        })
    }

    /// Returns the index of a cell.
    fn index(&self, x: u16, y: u16) -> usize {
        usize::from(y) * usize::from(self.size.width) + usize::from(x)
    }

    /// Returns the indices of the cells of a row.
    fn row(&self, y: u16) -> Range<usize> {
        self.index(0, y)..self.index(self.size.width, y)
    }

    /// Marks a row as stale if it has a wide character: terminals differ in what they show of one that is half
    /// overwritten.
    fn renew_wide_row(&mut self, y: u16) {
        let row = self.row(y);
        if self.cells[row.clone()]
            .iter()
            .any(|cell| !is_narrow(cell.symbol()))
        {
            self.stale[row].fill(true);
        }
    }

    /// Returns the stretches of stale cells in all rows, in reading order.
    fn runs(&self) -> Vec<Run> {
        let mut runs = Vec::new();
        for y in 0..self.size.height {
            let mut x = 0;
            while x < self.size.width {
                let stale = |&x: &u16| self.stale[self.index(x, y)];
                let end = (x..self.size.width).find(|x| !stale(x));
                let columns = x..end.unwrap_or(self.size.width);
                x = columns.end + 1;
                if !columns.is_empty() {
                    runs.push(Run { y, columns });
                }
            }
        }
        runs
    }
}

/// A try to write the stale cells in a certain order.
#[derive(Debug)]
struct Attempt<'a> {
    /// The screen whose cells are written.
    screen: &'a Screen,
    /// Whether each cell still differs from what the terminal shows.
    stale: Vec<bool>,
    /// The position of the terminal's cursor; see [`Screen`].
    at: Option<Position>,
    /// The style that is switched on.
    style: CellStyle,
    /// The style that was saved together with the wanted cursor position; None if it was not saved.
    saved: Option<CellStyle>,
    /// The bytes so far.
    out: Vec<u8>,
}

impl<'a> Attempt<'a> {
    /// Creates an attempt that has written nothing yet.
    fn new(screen: &'a Screen) -> Self {
        Self {
            screen,
            stale: screen.stale.clone(),
            at: screen.at,
            style: screen.style,
            saved: None,
            out: Vec::new(),
        }
    }

    /// Writes stretches in this order and leaves the cursor at the wanted position. If `saves`, the terminal saves
    /// the cursor when it passes that position, and restores it at the end.
    fn written(mut self, runs: &[Run], saves: bool) -> Self {
        self.save(saves);
        for run in runs {
            self.write_run(run, saves);
        }
        if let Some(wanted) = self.screen.wanted {
            match self.saved {
                Some(style) if self.at != Some(wanted) => {
                    self.out.extend(RESTORE_CURSOR);
                    (self.at, self.style) = (Some(wanted), style);
                }
                _ => self.go(wanted.x, wanted.y),
            }
        }
        self
    }

    /// Makes the terminal save the cursor and its style, if `saves` and the cursor is at the wanted position.
    fn save(&mut self, saves: bool) {
        if saves && self.saved.is_none() && self.at.is_some() && self.at == self.screen.wanted {
            self.out.extend(SAVE_CURSOR);
            self.saved = Some(self.style);
        }
    }

    /// Writes changed cells that stand side by side, and blanks after them that have changed.
    fn write_run(&mut self, run: &Run, saves: bool) {
        let row = self.screen.row(run.y);
        let cells = &self.screen.cells;
        let ink = cells[row.clone()].iter().rposition(|cell| !is_blank(cell));
        let end_of_ink = row.start + ink.map_or(0, |last| last + 1);
        for x in run.columns.clone() {
            let index = self.screen.index(x, run.y);
            if !self.stale[index] {
                continue;
            }
            self.go(x, run.y);
            self.save(saves);
            let left = self.stale[index..row.end].iter().filter(|stale| **stale);
            if index >= end_of_ink && left.count() > ERASE_TO_END.len() {
                self.erase(ERASE_TO_END);
                self.stale[index..row.end].fill(false);
                return;
            }
            let blanks = self.blanks(index..row.end);
            let erasure = csi(narrow(blanks), 'X');
            // Erasing does not move the cursor: if more follows in this row, that costs a move.
            let more = self.stale[index + blanks..row.end].contains(&true);
            let moved = if more { 4 } else { 0 };
            if self.screen.abilities.erases && erasure.len() + moved < blanks {
                self.erase(&erasure);
                self.stale[index..index + blanks].fill(false);
                continue;
            }
            self.write(index);
            let end = index + columns(&cells[index]);
            self.stale[index..end.min(row.end)].fill(false);
        }
    }

    /// Returns the number of blank cells at the start of `cells`, up to the last stale one among them.
    fn blanks(&self, cells: Range<usize>) -> usize {
        let blank = |index: &usize| is_blank(&self.screen.cells[*index]);
        let stretch: Vec<usize> = cells.take_while(blank).collect();
        let last = stretch.iter().rposition(|&index| self.stale[index]);
        last.map_or(0, |last| last + 1)
    }

    /// Erases with the sequence `how`; erased cells are blank and have no style.
    fn erase(&mut self, how: &[u8]) {
        if !self.style.leaves_blanks_plain() {
            self.change_style(PLAIN);
        }
        self.out.extend(how);
    }

    /// Switches to another style.
    fn change_style(&mut self, style: CellStyle) {
        if self.screen.abilities.styles {
            style.change(self.style, &mut self.out);
        }
        self.style = style;
    }

    /// Writes a cell at the cursor.
    fn write(&mut self, index: usize) {
        let style = CellStyle::of(&self.screen.cells[index]);
        let blank = self.screen.cells[index].symbol() == " ";
        let plain = self.style.leaves_blanks_plain() && style.leaves_blanks_plain();
        if !(blank && plain) {
            self.change_style(style);
        }
        let symbol = self.screen.cells[index].symbol();
        self.out.extend(symbol.as_bytes());
        self.at = self
            .at
            .filter(|_| is_narrow(symbol))
            .map(|at| Position { x: at.x + 1, ..at });
    }

    /// Moves the cursor with as few bytes as possible.
    fn go(&mut self, x: u16, y: u16) {
        let target = Position { x, y };
        if self.at == Some(target) {
            return;
        }
        let mut best = absolute(target);
        if let Some(at) = self.at {
            let down = usize::from(y.saturating_sub(at.y));
            let vertical = match at.y.checked_sub(y) {
                Some(1) => REVERSE_INDEX.to_vec(),
                Some(up) if up > 0 => csi(up, 'A'),
                _ => shorter(b"\n".repeat(down), csi(y - at.y.min(y), 'B')),
            };
            let returned = [vec![b'\r'], vertical.clone(), self.forward(0, x, y)].concat();
            best = shorter(best, returned);
            // After the last column, only a carriage return or an absolute position is reliable.
            if at.x < self.screen.size.width {
                let horizontal = match at.x.checked_sub(x) {
                    Some(left) => shorter(b"\x08".repeat(usize::from(left)), csi(left, 'D')),
                    None => self.forward(at.x, x, y),
                };
                best = shorter(best, [vertical, horizontal].concat());
            }
        }
        self.out.extend(best);
        self.at = Some(target);
    }

    /// Moves right from column `from` to column `to` of a row: by a move, or by writing the cells between again if
    /// they have the current style.
    fn forward(&self, from: u16, to: u16, y: u16) -> Vec<u8> {
        let moved = csi(to - from, 'C');
        let between = self.screen.index(from, y)..self.screen.index(to, y);
        // The first cell may be the second half of a wide character.
        let half = from > 0 && !is_narrow(self.screen.cells[between.start - 1].symbol());
        if between.len() > moved.len() || half {
            return moved;
        }
        let mut over = Vec::new();
        for index in between {
            let cell = &self.screen.cells[index];
            let style = CellStyle::of(cell);
            let blank = is_blank(cell) && self.style.leaves_blanks_plain();
            let same = !self.screen.abilities.styles || style == self.style;
            if self.stale[index] || !is_narrow(cell.symbol()) || !(same || blank) {
                return moved;
            }
            over.extend(cell.symbol().as_bytes());
        }
        shorter(over, moved)
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
                // Ratatui does not report the cell that a wide character covers.
                self.cells[index..end].fill(Cell::default());
                self.cells[index] = cell.clone();
                // Ratatui leaves out control characters but not these two, which end a line or a paragraph.
                if matches!(cell.symbol(), "\u{2028}" | "\u{2029}") {
                    self.cells[index].set_symbol(" ");
                }
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

    /// Clears the whole screen whatever the type, because the program uses all of it.
    fn clear_region(&mut self, _: ClearType) -> Result<(), Self::Error> {
        self.resize(self.size);
        self.out.clear();
        self.style = PLAIN;
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

    /// Does nothing: the frame waits for [`Screen::take_frame`].
    fn flush(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

/// A stretch of stale cells in a row.
#[derive(Clone, Debug)]
struct Run {
    /// The row.
    y: u16,
    /// The columns.
    columns: Range<u16>,
}

impl Run {
    /// Returns true if a position is at most one row and four columns away from the start.
    fn is_near(&self, at: Position) -> bool {
        self.y.abs_diff(at.y) <= 1 && self.columns.start.abs_diff(at.x) <= 4
    }
}

/// Returns the shorter of two sequences; the first if they are equally long.
fn shorter(first: Vec<u8>, second: Vec<u8>) -> Vec<u8> {
    if second.len() < first.len() {
        second
    } else {
        first
    }
}

/// Returns `ESC [ count final`, without a count of 1; empty for 0.
fn csi(count: u16, last: char) -> Vec<u8> {
    match count {
        0 => Vec::new(),
        1 => format!("\x1b[{last}").into_bytes(),
        _ => format!("\x1b[{count}{last}").into_bytes(),
    }
}

/// Returns the move to an absolute position, `ESC [ row ; column H`, which every terminal knows.
fn absolute(target: Position) -> Vec<u8> {
    let (row, column) = (u32::from(target.y) + 1, u32::from(target.x) + 1);
    match (row, column) {
        (1, 1) => "\x1b[H".to_owned(),
        (1, _) => format!("\x1b[;{column}H"),
        (_, 1) => format!("\x1b[{row}H"),
        _ => format!("\x1b[{row};{column}H"),
    }
    .into_bytes()
}

/// Returns true if a cell looks like an erased one.
fn is_blank(cell: &Cell) -> bool {
    cell.symbol() == " " && CellStyle::of(cell).leaves_blanks_plain()
}

/// Returns the number of columns that a cell takes.
fn columns(cell: &Cell) -> usize {
    match cell.symbol() {
        narrow if is_narrow(narrow) => 1,
        other => Span::raw(other).width().max(1),
    }
}

/// Returns true if every terminal gives the symbol one column.
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

#[cfg(test)]
mod tests;
