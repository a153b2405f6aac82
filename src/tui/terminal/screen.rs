//! The screen of a terminal behind ratatui: the bytes of a frame, for one write.
//!
//! Ratatui's own backend is not used because it sends bytes for every frame, also if nothing has changed, and because
//! it makes reversed cells invisible where `NO_COLOR` is set. A key takes at most one network packet of 1,448 bytes, the
//! first screen at most 4,500.
//!
//! A character that some terminals may show wider than others is followed by a move to an absolute position.

use std::collections::BTreeMap;
use std::convert::Infallible;

use ratatui::backend::{Backend, ClearType, WindowSize};
use ratatui::buffer::Cell;
use ratatui::layout::{Position, Size};
use ratatui::style::{Color, Modifier};
use ratatui::text::Span;

use crate::tui::terminal::settings::Abilities;
use crate::tui::widget::write::narrow;

/// The size in bytes from which a frame is marked as synchronized. A smaller one fits into one network packet, so it
/// arrives in one piece without marks.
const SMALL_FRAME: usize = 256;

/// Makes the terminal hold back what it shows until the end of the frame (mode 2026).
const BEGIN_SYNCHRONIZED: &[u8] = b"\x1b[?2026h";
const END_SYNCHRONIZED: &[u8] = b"\x1b[?2026l";
const HIDE_CURSOR: &[u8] = b"\x1b[?25l";
const SHOW_CURSOR: &[u8] = b"\x1b[?25h";

#[derive(Debug)]
pub struct Screen {
    size: Size,
    abilities: Abilities,
    /// What the terminal shows, row by row.
    cells: Vec<Cell>,
    /// The position of the terminal's cursor; None if it is not certain, as after the last column.
    at: Option<Position>,
    style: CellStyle,
    visible: bool,
    /// The position at which to show the cursor; None to hide it.
    wanted: Option<Position>,
    asked: Position,
    /// The bytes of the frame so far.
    out: Vec<u8>,
}

/// The colours of the text and behind it, and the attributes.
type CellStyle = (Color, Color, Modifier);

const PLAIN: CellStyle = (Color::Reset, Color::Reset, Modifier::empty());

impl Screen {
    pub fn new(size: Size, abilities: Abilities) -> Self {
        Self {
            size,
            abilities,
            cells: empty(size),
            at: None,
            style: PLAIN,
            visible: true,
            wanted: None,
            asked: Position::ORIGIN,
            out: Vec::new(),
        }
    }

    /// Changes the size; the next frame is drawn on an empty screen.
    pub fn resize(&mut self, size: Size) {
        self.size = size;
        self.cells = empty(size);
        self.at = None;
    }

    fn index(&self, x: u16, y: u16) -> usize {
        usize::from(y) * usize::from(self.size.width) + usize::from(x)
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
        if let Some(wanted) = self.wanted {
            self.go(wanted);
        }
        let shown = self.wanted.is_some();
        let mut frame = std::mem::take(&mut self.out);
        let large = frame.len() > SMALL_FRAME;
        if large && shown && self.visible && !self.abilities.synchronized {
            // The moving cursor would be visible.
            frame.splice(0..0, HIDE_CURSOR.iter().copied());
            self.visible = false;
        }
        if shown != self.visible {
            frame.extend(if shown { SHOW_CURSOR } else { HIDE_CURSOR });
            self.visible = shown;
        }
        if large && self.abilities.synchronized {
            frame.splice(0..0, BEGIN_SYNCHRONIZED.iter().copied());
            frame.extend(END_SYNCHRONIZED);
        }
        frame
    }

    fn go(&mut self, to: Position) {
        let moved = match self.at {
            Some(at) if at == to => return,
            Some(at) if at.y == to.y && at.x < to.x => self.forward(at, to.x - at.x),
            _ => format!("\x1b[{};{}H", u32::from(to.y) + 1, u32::from(to.x) + 1),
        };
        self.out.extend(moved.as_bytes());
        self.at = Some(to);
    }

    /// Returns the move over cells to the right; a few blanks are written again, which is shorter.
    fn forward(&self, at: Position, count: u16) -> String {
        let first = self.index(at.x, at.y);
        let between = &self.cells[first..first + usize::from(count)];
        if count <= 4 && between.iter().all(is_blank) && !shows_on_blanks(self.style) {
            return " ".repeat(count.into());
        }
        format!("\x1b[{count}C")
    }

    fn set_style(&mut self, style: CellStyle) {
        if self.abilities.styles && style != self.style {
            self.out.extend(sgr(style, self.style == PLAIN).as_bytes());
            self.style = style;
        }
    }

    fn write(&mut self, cell: &Cell) {
        let style = (cell.fg, cell.bg, cell.modifier);
        if !is_blank(cell) || shows_on_blanks(self.style) {
            self.set_style(style);
        }
        // Ratatui leaves out control characters but not these two, which end a line or a paragraph.
        let symbol = match cell.symbol() {
            "\u{2028}" | "\u{2029}" => " ",
            symbol => symbol,
        };
        self.out.extend(symbol.as_bytes());
        // After the last column, terminals differ.
        let right = self.size.width;
        let at = (self.at).filter(|at| is_narrow(symbol) && at.x + 1 < right);
        self.at = at.map(|at| Position { x: at.x + 1, ..at });
    }

    /// Erases to the end of the row; the cursor stays.
    fn erase_from(&mut self, at: Position) {
        self.go(at);
        if shows_on_blanks(self.style) {
            self.set_style(PLAIN);
        }
        self.out.extend(b"\x1b[K");
    }
}

impl Backend for Screen {
    type Error = Infallible;

    fn draw<'a, I>(&mut self, content: I) -> Result<(), Self::Error>
    where
        I: Iterator<Item = (u16, u16, &'a Cell)>,
    {
        let mut rows = BTreeMap::<u16, (bool, Vec<u16>)>::new();
        for (x, y, cell) in content {
            if x >= self.size.width || y >= self.size.height {
                continue;
            }
            let (first, end) = (self.index(0, y), self.index(0, y + 1));
            let had_wide = || has_wide(&self.cells[first..end]);
            let row = rows.entry(y).or_insert_with(|| (had_wide(), Vec::new()));
            row.1.push(x);
            let index = first + usize::from(x);
            // Ratatui does not report the cell that a wide character covers.
            self.cells[index..end.min(index + columns(cell))].fill(Cell::default());
            self.cells[index] = cell.clone();
        }
        for (y, (had_wide, changed)) in rows {
            let row = self.cells[self.index(0, y)..self.index(0, y + 1)].to_vec();
            // Terminals differ in what they show of a wide character that is half overwritten.
            let changed = if had_wide || has_wide(&row) {
                (0..self.size.width).collect()
            } else {
                changed
            };
            let mut covered = 0;
            for x in changed.into_iter().map(usize::from) {
                if x < covered {
                    continue;
                }
                let at = Position::new(narrow(x), y);
                if row[x..].iter().all(is_blank) {
                    self.erase_from(at);
                    break;
                }
                self.go(at);
                self.write(&row[x]);
                covered = x + columns(&row[x]);
            }
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
        let plain = if self.abilities.styles { "\x1b[m" } else { "" };
        self.out = format!("{plain}\x1b[H\x1b[2J").into_bytes();
        self.cells = empty(self.size);
        (self.style, self.at) = (PLAIN, Some(Position::ORIGIN));
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

const ATTRIBUTES: [(Modifier, &str); 7] = [
    (Modifier::BOLD, "1"),
    (Modifier::DIM, "2"),
    (Modifier::ITALIC, "3"),
    (Modifier::UNDERLINED, "4"),
    (Modifier::SLOW_BLINK, "5"),
    (Modifier::REVERSED, "7"),
    (Modifier::CROSSED_OUT, "9"),
];

/// Returns the number of columns that a cell takes.
fn columns(cell: &Cell) -> usize {
    match cell.symbol() {
        symbol if is_narrow(symbol) => 1,
        symbol => Span::raw(symbol).width().max(1),
    }
}

fn has_wide(cells: &[Cell]) -> bool {
    !cells.iter().all(|cell| is_narrow(cell.symbol()))
}

fn empty(size: Size) -> Vec<Cell> {
    vec![Cell::default(); usize::from(size.width) * usize::from(size.height)]
}

/// Returns true if a cell looks like an erased one.
fn is_blank(cell: &Cell) -> bool {
    cell.symbol() == " " && !shows_on_blanks((cell.fg, cell.bg, cell.modifier))
}

/// Returns true if a blank in this style does not look like a plain one.
fn shows_on_blanks((_, back, attributes): CellStyle) -> bool {
    let seen = Modifier::REVERSED | Modifier::UNDERLINED | Modifier::CROSSED_OUT;
    back != Color::Reset || attributes.intersects(seen)
}

fn sgr((fore, back, attributes): CellStyle, is_plain: bool) -> String {
    let set = ATTRIBUTES
        .iter()
        .filter(|(own, _)| attributes.contains(*own));
    let mut steps: Vec<String> = set.map(|(_, number)| (*number).to_owned()).collect();
    for (color, base) in [(fore, 30), (back, 40)] {
        if color != Color::Reset {
            steps.push(color_parameters(color, base));
        }
    }
    if !is_plain {
        // Empty means 0, the reset.
        steps.insert(0, String::new());
    }
    format!("\x1b[{}m", steps.join(";"))
}

/// Returns a colour's parameters; `base` is 30 for text and 40 for the background. The sixteen colours have short
/// numbers that every terminal knows.
fn color_parameters(color: Color, base: u8) -> String {
    let sixteen = [
        Color::Black,
        Color::Red,
        Color::Green,
        Color::Yellow,
        Color::Blue,
        Color::Magenta,
        Color::Cyan,
        Color::Gray,
        Color::DarkGray,
        Color::LightRed,
        Color::LightGreen,
        Color::LightYellow,
        Color::LightBlue,
        Color::LightMagenta,
        Color::LightCyan,
        Color::White,
    ];
    match color {
        Color::Indexed(index) => format!("{};5;{index}", base + 8),
        Color::Rgb(red, green, blue) => format!("{};2;{red};{green};{blue}", base + 8),
        color => {
            let number = (0_u8..).zip(sixteen).find(|(_, own)| *own == color);
            let offset = match number {
                None => 9,
                Some((number @ 0..8, _)) => number,
                Some((number, _)) => 52 + number,
            };
            (base + offset).to_string()
        }
    }
}

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

/// After it has read the bytes, an emulator shows exactly what was drawn.
#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use ratatui::Terminal;
    use ratatui::buffer::Buffer;
    use ratatui::style::Style;

    const SIZE: Size = Size {
        width: 11,
        height: 5,
    };

    type Writing = (u16, u16, &'static str, Style);

    fn emulator(size: Size) -> vt100::Parser {
        let side = |side: u16| std::num::NonZeroU16::new(side).expect("not empty");
        vt100::Parser::new(side(size.height), side(size.width), 0)
    }

    /// The column and row of the cursor; None if it is hidden.
    type ScreenCursor = Option<(u16, u16)>;

    /// Draws frames, each made of texts and a cursor; after each, the emulator must show what ratatui drew.
    fn check(frames: &[(Vec<Writing>, ScreenCursor)], synchronized: bool) {
        let abilities = Abilities {
            styles: true,
            synchronized,
        };
        let Ok(mut terminal) = Terminal::new(Screen::new(SIZE, abilities));
        let mut emulator = emulator(SIZE);
        for (index, (writings, cursor)) in frames.iter().enumerate() {
            if index % 7 == 6 {
                let Ok(()) = terminal.clear();
            }
            let Ok(drawn) = terminal.draw(|frame| {
                for &(x, y, text, style) in writings {
                    let (room, buffer) = (usize::from(SIZE.width - x), frame.buffer_mut());
                    // Ratatui does not promise to draw a buffer with half of a wide character.
                    if x > 0 && Span::raw(buffer[(x - 1, y)].symbol()).width() > 1 {
                        buffer[(x - 1, y)].set_symbol(" ");
                    }
                    buffer.set_stringn(x, y, text, room, style);
                }
                if let Some(cursor) = cursor {
                    frame.set_cursor_position(*cursor);
                }
            });
            let buffer = drawn.buffer.clone();
            emulator.process(&terminal.backend_mut().take_frame());
            assert!(
                terminal.backend_mut().take_frame().is_empty(),
                "said once is enough"
            );
            let screen = emulator.screen();
            assert_eq!(screen.hide_cursor(), cursor.is_none());
            if let Some((x, y)) = *cursor {
                assert_eq!(screen.cursor_position(), (y, x));
            }
            shows(screen, &buffer, index);
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
            let reversed = (has(Modifier::REVERSED), has(Modifier::UNDERLINED));
            let found_reversed = (found.inverse(), found.underline());
            assert_eq!(reversed, found_reversed, "at {position}");
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
        let marks = vec![Modifier::REVERSED, Modifier::UNDERLINED];
        let marks = prop::sample::subsequence(marks, 0..=2);
        let colors = vec![
            Color::Reset,
            Color::Reset,
            Color::Red,
            Color::Indexed(114),
            Color::Rgb(1, 2, 3),
        ];
        let color = prop::sample::select(colors);
        (weight, marks, color.clone(), color).prop_map(|(weight, marks, fore, back)| {
            let attributes = marks.into_iter().fold(weight, Modifier::union);
            Style::reset().add_modifier(attributes).fg(fore).bg(back)
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
            0..SIZE.width,
            0..SIZE.height,
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
                    prop::option::of((0..SIZE.width, 0..SIZE.height)),
                ),
                1..12,
            ),
            synchronized: bool,
        ) {
            check(&frames, synchronized);
        }
    }

    #[test]
    fn characters_that_end_a_line_are_drawn_as_blanks() {
        let abilities = Abilities {
            styles: true,
            synchronized: false,
        };
        let Ok(mut terminal) = Terminal::new(Screen::new(SIZE, abilities));
        let Ok(_) = terminal.draw(|frame| {
            let buffer = frame.buffer_mut();
            buffer.set_string(0, 0, "a.b.", Style::new());
            buffer[(1, 0)].set_symbol("\u{2028}");
            buffer[(3, 0)].set_symbol("\u{2029}");
        });
        let frame = String::from_utf8(terminal.backend_mut().take_frame()).expect("text");
        assert!(frame.contains("a b "), "{frame:?}");
    }
}
