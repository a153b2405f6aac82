//! The screen of a terminal behind ratatui: the bytes of a frame, for one write.
//!
//! Ratatui's own backend is not used because it sends bytes for every frame, also if nothing has changed, because it
//! makes reversed cells invisible where `NO_COLOR` is set, and because it sends the sixteen colours in a form that old
//! terminals misread. A key takes at most one network packet of 1,448 bytes, the first screen at most 4,500.

use std::convert::Infallible;

use ratatui::backend::{Backend, ClearType, WindowSize};
use ratatui::buffer::Cell;
use ratatui::layout::{Position, Size};
use ratatui::style::{Color, Modifier};
use ratatui::text::Span;

use crate::tui::terminal::settings::Abilities;

/// The size in bytes from which a frame is held back until its end (mode 2026), or drawn without a cursor. A smaller
/// one fits into one network packet, so it arrives in one piece.
const SMALL_FRAME: usize = 256;

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
    is_visible: bool,
    /// The position at which to show the cursor; None to hide it.
    wanted: Option<Position>,
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
            is_visible: true,
            wanted: None,
            out: Vec::new(),
        }
    }

    /// Changes the size; the next frame is drawn on an empty screen.
    pub(super) fn resize(&mut self, size: Size) {
        if size != self.size {
            (self.size, self.cells, self.at) = (size, empty(size), None);
        }
    }

    /// Forgets cursor and style, because another program has had the terminal.
    pub(super) fn forget(&mut self) {
        (self.at, self.style, self.is_visible) = (None, PLAIN, false);
        self.out = HIDE_CURSOR.to_vec();
    }

    /// Adds a sequence that draws nothing.
    pub(super) fn send(&mut self, sequence: &str) {
        self.out.extend(sequence.as_bytes());
    }

    /// Returns the bytes of the frame, for one write; empty if nothing has changed.
    pub fn take_frame(&mut self) -> Vec<u8> {
        if let Some(wanted) = self.wanted {
            self.go(wanted);
        }
        let mut frame = std::mem::take(&mut self.out);
        let is_large = frame.len() > SMALL_FRAME;
        if is_large && self.abilities.synchronized {
            frame.splice(0..0, BEGIN_SYNCHRONIZED.iter().copied());
        } else if is_large && self.is_visible {
            frame.splice(0..0, HIDE_CURSOR.iter().copied());
            self.is_visible = false;
        }
        if self.wanted.is_some() != self.is_visible {
            self.is_visible = !self.is_visible;
            frame.extend(if self.is_visible {
                SHOW_CURSOR
            } else {
                HIDE_CURSOR
            });
        }
        if is_large && self.abilities.synchronized {
            frame.extend(END_SYNCHRONIZED);
        }
        frame
    }

    fn index(&self, Position { x, y }: Position) -> usize {
        usize::from(y) * usize::from(self.size.width) + usize::from(x)
    }

    fn go(&mut self, to: Position) {
        let moved = match self.at {
            Some(at) if at == to => return,
            Some(at) if at.y == to.y && at.x < to.x => {
                let between = &self.cells[self.index(at)..self.index(to)];
                // A few blanks are shorter than a move over them.
                if between.len() <= 4
                    && between.iter().all(is_blank)
                    && !shows_on_blanks(self.style)
                {
                    " ".repeat(between.len())
                } else {
                    format!("\x1b[{}C", between.len())
                }
            }
            _ => format!("\x1b[{};{}H", u32::from(to.y) + 1, u32::from(to.x) + 1),
        };
        self.out.extend(moved.as_bytes());
        self.at = Some(to);
    }

    fn set_style(&mut self, style: CellStyle) {
        if self.abilities.styles && style != self.style {
            self.out.extend(sgr(style).as_bytes());
            self.style = style;
        }
    }

    fn write(&mut self, cell: &Cell, at: Position) {
        self.go(at);
        if !is_blank(cell) || shows_on_blanks(self.style) {
            self.set_style((cell.fg, cell.bg, cell.modifier));
        }
        self.out.extend(cell.symbol().as_bytes());
        // After the last column, and after a character that some terminals may show wider, the next move is absolute.
        let is_certain = is_narrow(cell.symbol()) && at.x + 1 < self.size.width;
        self.at = is_certain.then_some(Position { x: at.x + 1, ..at });
    }
}

impl Backend for Screen {
    type Error = Infallible;

    fn draw<'a, I>(&mut self, content: I) -> Result<(), Self::Error>
    where
        I: Iterator<Item = (u16, u16, &'a Cell)>,
    {
        let mut changed = Vec::new();
        for (x, y, cell) in
            content.filter(|(x, y, _)| *x < self.size.width && *y < self.size.height)
        {
            let at = Position { x, y };
            let (first, end) = (self.index(at), self.index(Position { x: 0, y: y + 1 }));
            // A wide character covers cells that ratatui does not mention.
            self.cells[first..end.min(first + columns(cell))].fill(Cell::default());
            self.cells[first] = cell.clone();
            changed.push(at);
        }
        for row in changed.chunk_by(|one, other| one.y == other.y) {
            let begin = self.index(Position { x: 0, ..row[0] });
            let cells = self.cells[begin..][..usize::from(self.size.width)].to_vec();
            let text = cells.iter().rposition(|cell| !is_blank(cell));
            for &at in row {
                if text.is_none_or(|last| usize::from(at.x) > last) {
                    self.go(at);
                    if shows_on_blanks(self.style) {
                        self.set_style(PLAIN);
                    }
                    self.out.extend(b"\x1b[K");
                    break;
                }
                self.write(&cells[usize::from(at.x)], at);
            }
        }
        Ok(())
    }

    fn hide_cursor(&mut self) -> Result<(), Self::Error> {
        self.wanted = None;
        Ok(())
    }

    /// Does nothing: ratatui sets the position next.
    fn show_cursor(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    fn get_cursor_position(&mut self) -> Result<Position, Self::Error> {
        Ok(self.wanted.unwrap_or_default())
    }

    fn set_cursor_position<P: Into<Position>>(&mut self, position: P) -> Result<(), Self::Error> {
        self.wanted = Some(position.into());
        Ok(())
    }

    fn clear(&mut self) -> Result<(), Self::Error> {
        self.clear_region(ClearType::All)
    }

    /// Clears the whole screen whatever the type, because the program uses all of it.
    fn clear_region(&mut self, _: ClearType) -> Result<(), Self::Error> {
        let plain = if self.abilities.styles { "\x1b[m" } else { "" };
        self.out.extend(format!("{plain}\x1b[H\x1b[2J").as_bytes());
        (self.cells, self.style, self.at) = (empty(self.size), PLAIN, Some(Position::ORIGIN));
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

fn empty(size: Size) -> Vec<Cell> {
    vec![Cell::default(); usize::from(size.width) * usize::from(size.height)]
}

/// Returns true if a cell looks like an erased one.
fn is_blank(cell: &Cell) -> bool {
    cell.symbol() == " " && !shows_on_blanks((cell.fg, cell.bg, cell.modifier))
}

/// Returns true if a blank in this style does not look like a plain one.
fn shows_on_blanks((_, back, attributes): CellStyle) -> bool {
    back != Color::Reset || attributes.intersects(Modifier::REVERSED | Modifier::UNDERLINED)
}

const ATTRIBUTES: [(Modifier, u8); 4] = [
    (Modifier::BOLD, 1),
    (Modifier::DIM, 2),
    (Modifier::UNDERLINED, 4),
    (Modifier::REVERSED, 7),
];

/// Returns the sequence that sets a style, whatever was set before.
fn sgr((fore, back, attributes): CellStyle) -> String {
    let mut sequence = String::from("\x1b[");
    for (_, number) in ATTRIBUTES
        .iter()
        .filter(|(own, _)| attributes.contains(*own))
    {
        sequence += &format!(";{number}");
    }
    for (color, base) in [(fore, 30), (back, 40)] {
        match color {
            Color::Reset => {}
            Color::Indexed(index) => sequence += &format!(";{};5;{index}", base + 8),
            Color::Rgb(red, green, blue) => {
                sequence += &format!(";{};2;{red};{green};{blue}", base + 8)
            }
            named => {
                let number = (0_u8..).zip(SIXTEEN).find(|(_, own)| *own == named);
                // The bright ones follow at 90 and 100.
                let offset =
                    number.map_or(9, |(number, _)| number + if number < 8 { 0 } else { 52 });
                sequence += &format!(";{}", base + offset);
            }
        }
    }
    sequence + "m"
}

const SIXTEEN: [Color; 16] = [
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

/// Returns the number of columns that a cell takes.
fn columns(cell: &Cell) -> usize {
    match cell.symbol() {
        symbol if is_narrow(symbol) => 1,
        symbol => Span::raw(symbol).width().max(1),
    }
}

/// Returns true for a character that takes one column on every terminal.
fn is_narrow(symbol: &str) -> bool {
    let mut characters = symbol.chars();
    let first = characters.next();
    // Latin and Greek; dashes and dots; arrows; lines, blocks and shades; Braille.
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
}
