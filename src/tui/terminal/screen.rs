//! The screen of a terminal: cells of ratatui, and the bytes of a frame, for one write.
//!
//! Ratatui's own backends are not used because they send bytes for every frame, also if nothing has changed, because
//! they make reversed cells invisible where `NO_COLOR` is set, and because they send the sixteen colours in a form that
//! old terminals misread. A key takes at most one network packet of 1,448 bytes, the first screen at most 4,500.

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::{Position, Rect};
use ratatui::style::{Color, Modifier};

use crate::tui::widget::write::{self, narrow};

/// The size in bytes from which a frame is held back until its end (mode 2026), or drawn without a cursor. A smaller
/// one fits into one network packet, so it arrives in one piece.
const SMALL_FRAME: usize = 256;

const BEGIN_SYNCHRONIZED: &str = "\x1b[?2026h";
pub(super) const END_SYNCHRONIZED: &str = "\x1b[?2026l";
const HIDE_CURSOR: &str = "\x1b[?25l";
pub(super) const SHOW_CURSOR: &str = "\x1b[?25h";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Abilities {
    pub styles: bool,
    /// Whether it can hold back a frame until all of it has arrived (mode 2026).
    pub synchronized: bool,
}

#[derive(Debug)]
pub struct Screen {
    abilities: Abilities,
    /// What the terminal shows.
    shown: Buffer,
    next: Buffer,
    /// The position of the terminal's cursor; None if it is not certain, as after the last column.
    at: Option<Position>,
    style: CellStyle,
    has_cursor: bool,
    /// The bytes of the frame so far.
    out: String,
}

/// The colour of the text and of what is behind it, and the attributes.
type CellStyle = (Color, Color, Modifier);

const PLAIN: CellStyle = (Color::Reset, Color::Reset, Modifier::empty());

impl Screen {
    /// A screen of some columns and rows; its first frame clears the terminal.
    pub fn new((width, height): (u16, u16), abilities: Abilities) -> Self {
        let empty = Buffer::empty(Rect::new(0, 0, width, height));
        let plain = if abilities.styles { "\x1b[m" } else { "" };
        Self {
            abilities,
            shown: empty.clone(),
            next: empty,
            at: Some(Position::ORIGIN),
            style: PLAIN,
            has_cursor: false,
            out: format!("{HIDE_CURSOR}{plain}\x1b[H\x1b[2J"),
        }
    }

    /// Adds a sequence that draws nothing to the next frame.
    pub(super) fn send(&mut self, sequence: &str) {
        self.out += sequence;
    }

    /// Returns the bytes of a frame; none if it shows what is shown already. `draw` draws it on an empty buffer and
    /// returns the position of the cursor, None to hide it.
    pub fn frame(&mut self, draw: impl FnOnce(&mut Buffer) -> Option<Position>) -> Vec<u8> {
        let mut next = std::mem::take(&mut self.next);
        next.reset();
        let cursor = draw(&mut next);
        let shown = std::mem::take(&mut self.shown);
        for (y, (old, new)) in (0..).zip(rows(&shown).zip(rows(&next))) {
            if old != new {
                self.draw_row(y, old, new);
            }
        }
        (self.shown, self.next) = (next, shown);
        if let Some(cursor) = cursor {
            self.go(cursor);
        }
        let mut frame = std::mem::take(&mut self.out);
        let is_large = frame.len() > SMALL_FRAME;
        if is_large && self.has_cursor && !self.abilities.synchronized {
            frame.insert_str(0, HIDE_CURSOR);
            self.has_cursor = false;
        }
        if cursor.is_some() != self.has_cursor {
            self.has_cursor = cursor.is_some();
            frame += if self.has_cursor {
                SHOW_CURSOR
            } else {
                HIDE_CURSOR
            };
        }
        if is_large && self.abilities.synchronized {
            frame = [BEGIN_SYNCHRONIZED, &frame, END_SYNCHRONIZED].concat();
        }
        frame.into_bytes()
    }

    /// Draws the changed cells of a row. If only blanks follow, the rest of the row is erased.
    fn draw_row(&mut self, y: u16, old: &[Cell], new: &[Cell]) {
        // Terminals differ in what they show of a wide character that is half overwritten.
        let has_wide = old.iter().chain(new).any(|cell| columns(cell) > 1);
        let last = new.iter().rposition(|cell| !is_blank(cell));
        let mut covered = 0;
        for (x, cell) in new.iter().enumerate() {
            if x < covered || (!has_wide && old[x] == *cell) {
                continue;
            }
            covered = x + columns(cell);
            let to = Position::new(narrow(x), y);
            let gap = self.at.filter(|at| at.y == y && usize::from(at.x) < x);
            let gap = gap.map(|at| &new[usize::from(at.x)..x]);
            // A few blanks are shorter than a move over them.
            match gap.filter(|gap| gap.len() <= 4 && gap.iter().all(is_blank)) {
                Some(gap) if !shows_on_blanks(self.style) => self.out += &" ".repeat(gap.len()),
                _ => self.go(to),
            }
            self.at = Some(to);
            if last.is_none_or(|last| x > last) {
                if shows_on_blanks(self.style) {
                    self.set_style(PLAIN);
                }
                self.out += "\x1b[K";
                return;
            }
            if !is_blank(cell) || shows_on_blanks(self.style) {
                self.set_style((cell.fg, cell.bg, cell.modifier));
            }
            self.out += cell.symbol();
            // After the last column, and after a character that some terminals may show wider, the next move is absolute.
            let is_certain = is_narrow(cell.symbol()) && x + 1 < new.len();
            self.at = is_certain.then_some(Position { x: to.x + 1, y });
        }
    }

    fn go(&mut self, to: Position) {
        match self.at {
            Some(at) if at == to => {}
            Some(at) if at.y == to.y && at.x < to.x => {
                self.out += &format!("\x1b[{}C", to.x - at.x);
            }
            _ => self.out += &format!("\x1b[{};{}H", u32::from(to.y) + 1, u32::from(to.x) + 1),
        }
        self.at = Some(to);
    }

    fn set_style(&mut self, style: CellStyle) {
        if self.abilities.styles && style != self.style {
            self.out += &sgr(style);
            self.style = style;
        }
    }
}

fn rows(buffer: &Buffer) -> impl Iterator<Item = &[Cell]> {
    buffer.content.chunks(usize::from(buffer.area.width).max(1))
}

/// Returns the number of columns that a cell takes.
fn columns(cell: &Cell) -> usize {
    match cell.symbol() {
        symbol if is_narrow(symbol) => 1,
        symbol => write::width(symbol).max(1),
    }
}

/// Returns true if a cell looks like an erased one.
fn is_blank(cell: &Cell) -> bool {
    cell.symbol() == " " && !shows_on_blanks((cell.fg, cell.bg, cell.modifier))
}

/// Returns true if a blank in this style does not look like a plain one.
fn shows_on_blanks((_, back, attributes): CellStyle) -> bool {
    back != Color::Reset || attributes.contains(Modifier::REVERSED)
}

/// Returns the sequence that sets a style, whatever was set before.
fn sgr((fore, back, attributes): CellStyle) -> String {
    let mut sequence = String::from("\x1b[");
    for (attribute, number) in [
        (Modifier::BOLD, 1),
        (Modifier::DIM, 2),
        (Modifier::REVERSED, 7),
    ] {
        if attributes.contains(attribute) {
            sequence += &format!(";{number}");
        }
    }
    for (color, base) in [(fore, 30), (back, 40)] {
        let named = match color {
            Color::Reset => continue,
            Color::Indexed(index) => format!("{};5;{index}", base + 8),
            Color::Rgb(red, green, blue) => format!("{};2;{red};{green};{blue}", base + 8),
            Color::Red => (base + 1).to_string(),
            Color::Green => (base + 2).to_string(),
            Color::Yellow => (base + 3).to_string(),
            Color::Blue => (base + 4).to_string(),
            Color::Magenta => (base + 5).to_string(),
            Color::Cyan => (base + 6).to_string(),
            // The theme has no other colours.
            _ => (base + 9).to_string(),
        };
        sequence += &format!(";{named}");
    }
    sequence + "m"
}

/// Returns true for a character that takes one column on every terminal: Latin and Greek; dashes and dots; arrows;
/// lines, blocks and shades; Braille.
fn is_narrow(symbol: &str) -> bool {
    let mut characters = symbol.chars();
    let first = characters.next();
    characters.next().is_none()
        && first.is_some_and(|first| {
            matches!(first, ' '..='~' | '\u{a1}'..='\u{ac}' | '\u{ae}'..='\u{2ff}' | '\u{370}'..='\u{3ff}'
                | '\u{2010}'..='\u{2027}' | '\u{2190}'..='\u{2193}' | '\u{2500}'..='\u{259f}'
                | '\u{2800}'..='\u{28ff}')
        })
}

/// After it has read the bytes, an emulator shows exactly what was drawn.
#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use ratatui::style::Style;
    use ratatui::text::Span;

    const SIZE: (u16, u16) = (11, 5);

    type Writing = (u16, u16, &'static str, Style);

    fn emulator((columns, rows): (u16, u16)) -> vt100::Parser {
        let side = |side: u16| std::num::NonZeroU16::new(side).expect("not empty");
        vt100::Parser::new(side(rows), side(columns), 0)
    }

    /// The column and row of the cursor; None if it is hidden.
    type ScreenCursor = Option<(u16, u16)>;

    /// Draws frames, each made of texts and a cursor; after each, the emulator must show what was drawn.
    fn check(frames: &[(Vec<Writing>, ScreenCursor)], synchronized: bool) {
        let abilities = Abilities {
            styles: true,
            synchronized,
        };
        let mut screen = Screen::new(SIZE, abilities);
        let mut emulator = emulator(SIZE);
        for (index, (writings, cursor)) in frames.iter().enumerate() {
            if index % 7 == 6 {
                screen = Screen::new(SIZE, abilities);
            }
            let cursor = cursor.map(Position::from);
            let mut drawn = Buffer::default();
            let bytes = screen.frame(|buffer| {
                for &(x, y, text, style) in writings {
                    let room = usize::from(SIZE.0 - x);
                    // Ratatui does not promise to draw a buffer with half of a wide character.
                    if x > 0 && Span::raw(buffer[(x - 1, y)].symbol()).width() > 1 {
                        buffer[(x - 1, y)].set_symbol(" ");
                    }
                    buffer.set_stringn(x, y, text, room, style);
                }
                drawn = buffer.clone();
                cursor
            });
            emulator.process(&bytes);
            let again = screen.frame(|buffer| {
                *buffer = drawn.clone();
                cursor
            });
            assert!(again.is_empty(), "said once is enough");
            let screen = emulator.screen();
            assert_eq!(screen.hide_cursor(), cursor.is_none());
            if let Some(at) = cursor {
                assert_eq!(screen.cursor_position(), (at.y, at.x));
            }
            shows(screen, &drawn, index);
        }
    }

    fn shows(screen: &vt100::Screen, buffer: &Buffer, frame: usize) {
        for position in buffer.area.positions() {
            let (expected, found) = (&buffer[position], screen.cell(position.y, position.x));
            let found = found.expect("a cell");
            if found.is_wide_continuation() {
                continue;
            }
            let symbol = if found.has_contents() {
                found.contents()
            } else {
                " "
            };
            assert_eq!(expected.symbol(), symbol, "at {position} of frame {frame}");
            let has = |attribute| expected.modifier.contains(attribute);
            assert_eq!(has(Modifier::REVERSED), found.inverse(), "at {position}");
            if symbol != " " {
                let weight = (has(Modifier::BOLD), has(Modifier::DIM));
                assert_eq!(weight, (found.bold(), found.dim()), "at {position}");
                assert_eq!(color_of(expected.fg), found.fgcolor(), "at {position}");
            }
            assert_eq!(color_of(expected.bg), found.bgcolor(), "at {position}");
        }
    }

    fn color_of(color: Color) -> vt100::Color {
        match color {
            Color::Red => vt100::Color::Idx(1),
            Color::Indexed(index) => vt100::Color::Idx(index),
            Color::Rgb(red, green, blue) => vt100::Color::Rgb(red, green, blue),
            _ => vt100::Color::Default,
        }
    }

    fn style() -> impl Strategy<Value = Style> {
        // The emulator has bold or dim, not both.
        let weight = prop::sample::select(vec![Modifier::empty(), Modifier::BOLD, Modifier::DIM]);
        let marks = prop::sample::select(vec![Modifier::empty(), Modifier::REVERSED]);
        let colors = vec![
            Color::Reset,
            Color::Reset,
            Color::Red,
            Color::Indexed(114),
            Color::Rgb(1, 2, 3),
        ];
        let color = prop::sample::select(colors);
        (weight, marks, color.clone(), color).prop_map(|(weight, marks, fore, back)| {
            Style::reset()
                .add_modifier(weight | marks)
                .fg(fore)
                .bg(back)
        })
    }

    fn writing() -> impl Strategy<Value = Writing> {
        let texts = [
            "a",
            "b c",
            "· · ·",
            "██",
            "    ",
            "hello world",
            "你好",
            "é–²",
            "x       y",
        ];
        (
            0..SIZE.0,
            0..SIZE.1,
            prop::sample::select(texts.to_vec()),
            prop_oneof![2 => Just(Style::reset()), 3 => style()],
        )
    }

    proptest! {
        #[test]
        fn a_terminal_shows_what_is_drawn(
            frames in prop::collection::vec(
                (
                    prop::collection::vec(writing(), 0..8),
                    prop::option::of((0..SIZE.0, 0..SIZE.1)),
                ),
                1..12,
            ),
            synchronized: bool,
        ) {
            check(&frames, synchronized);
        }
    }
}
