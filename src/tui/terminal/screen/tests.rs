//! After it has read the bytes, an emulator shows exactly what was drawn.

use super::*;
use proptest::prelude::*;
use ratatui::Terminal;
use ratatui::buffer::Buffer;
use ratatui::style::{Color, Modifier, Style};

const SIZE: Size = Size {
    width: 11,
    height: 5,
};

/// A column, a row, and a text to write there in a style.
type Writing = (u16, u16, &'static str, Style);

fn emulator(size: Size) -> vt100::Parser {
    let side = |side: u16| std::num::NonZeroU16::new(side).expect("not empty");
    vt100::Parser::new(side(size.height), side(size.width), 0)
}

/// The column and row of the cursor; None if it is hidden.
type ScreenCursor = Option<(u16, u16)>;

/// Draws frames, each made of texts and a cursor; after each, the emulator must show what ratatui drew.
fn check(frames: &[(Vec<Writing>, ScreenCursor)], synchronized: bool, erases: bool) {
    let abilities = Abilities {
        styles: true,
        synchronized,
        erases,
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
                if x > 0 && columns(&buffer[(x - 1, y)]) > 1 {
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

/// Asserts that the emulator shows a buffer, cell by cell.
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
    /// The terminal shows each frame that is drawn, independent of the frames before it.
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
        erases: bool,
    ) {
        check(&frames, synchronized, erases);
    }
}

const EVERYTHING: Abilities = Abilities {
    styles: true,
    synchronized: true,
    erases: true,
};

fn frame(before: &[&str], after: &[&str]) -> String {
    frame_at(before, after, (0, 0))
}

fn frame_at(before: &[&str], after: &[&str], cursor: (u16, u16)) -> String {
    let size = Size {
        width: 80,
        height: 24,
    };
    let Ok(mut terminal) = Terminal::new(Screen::new(size, EVERYTHING));
    let mut last = Vec::new();
    for rows in [before, after] {
        let Ok(_) = terminal.draw(|frame| {
            for (y, row) in (0..).zip(rows) {
                frame.buffer_mut().set_string(0, y, row, Style::new());
            }
            frame.set_cursor_position(cursor);
        });
        last = terminal.backend_mut().take_frame();
    }
    String::from_utf8(last).expect("text")
}

#[test]
fn characters_that_end_a_line_are_drawn_as_blanks() {
    assert_eq!(frame(&["...."], &["a\u{2028}b\u{2029}"]), "a b \r");
}

#[test]
fn the_shortest_sequence_is_sent() {
    assert_eq!(frame(&["abc"], &["abc"]), "", "no change is no bytes");
    assert_eq!(frame(&["abcdef"], &["Abcdef"]), "A\r");
    // Writes the cells between again, rather than moving over them.
    assert_eq!(frame(&["abcdef"], &["AbcDef"]), "AbcD\r");
    assert_eq!(frame(&["a        f"], &["A        F"]), "A\x1b[8CF\r");
    assert_eq!(frame(&["a", "b"], &["A", "B"]), "A\r\nB\x1b[H");
    assert_eq!(frame(&["ab"], &["a"]), "a \r");
    assert_eq!(frame(&["a long line"], &["a"]), "a \x1b[K\r");
    // Blanks in the middle are erased where that is shorter.
    assert_eq!(frame(&["abcdefg h"], &["a       h"]), "a\x1b[6X\r");
    assert_eq!(frame(&["abcd h"], &["a    h"]), "a   \r");
    assert_eq!(frame(&["abcdefghijk x"], &["a        jk x"]), "a\x1b[8X\r");
    // Writes near the cursor first, then the rest in reading order.
    assert_eq!(
        frame_at(&["ab", "", "ab"], &["xb", "", "xb"], (0, 2)),
        "x\x1b[Hx\r\n\n"
    );
    // The terminal saves a position if that is shorter than moving back to it.
    let rows = |last| ["", "", "", "", "", "", "", "", "", "", last];
    assert_eq!(
        frame_at(&rows("abc"), &rows("abx"), (20, 0)),
        "\x1b7\x1b[11;3Hx\x1b8"
    );
    assert_eq!(frame_at(&["", "a"], &["b", "a"], (0, 1)), "\x1bMb\r\n");
}
