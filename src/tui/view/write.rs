//! Writing text into the screen's buffer: by role, cut at the edge, in the characters that the terminal has.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::theme::{Role, Theme};

/// Writes pieces of text, each in its role, into the first line of an area; what does not fit is cut off.
/// Answers where the text ends.
pub fn line<'a>(
    buffer: &mut Buffer,
    area: Rect,
    theme: &Theme,
    pieces: impl IntoIterator<Item = (&'a str, Role)>,
) -> u16 {
    let mut x = area.x;
    if area.height == 0 || area.intersection(*buffer.area()).is_empty() {
        return x;
    }
    for (text, role) in pieces {
        let room = usize::from(area.right().saturating_sub(x));
        (x, _) = buffer.set_stringn(x, area.y, theme.text(text), room, theme.style(role));
    }
    x
}

/// The line of an area that lies `index` below its top; empty where the area ends before.
pub fn row(area: Rect, index: usize) -> Rect {
    let index = u16::try_from(index).unwrap_or(u16::MAX);
    let inside = index < area.height;
    Rect {
        y: area.y.saturating_add(if inside { index } else { 0 }),
        height: u16::from(inside),
        ..area
    }
}

/// The part of an area right of `x`.
pub fn right_of(area: Rect, x: u16) -> Rect {
    let x = x.clamp(area.x, area.right());
    Rect {
        x,
        width: area.right() - x,
        ..area
    }
}

/// Empties an area.
pub fn clear(buffer: &mut Buffer, area: Rect) {
    for position in area.intersection(*buffer.area()).positions() {
        buffer[position].reset();
    }
}

/// The part of an area that begins `lines` below its top.
pub fn below(area: Rect, lines: u16) -> Rect {
    let lines = lines.min(area.height);
    Rect {
        y: area.y + lines,
        height: area.height - lines,
        ..area
    }
}

/// Writes a text over as many lines as it needs, broken anywhere: paths have no spaces.
pub fn wrapped(buffer: &mut Buffer, area: Rect, theme: &Theme, text: &str, role: Role) {
    let characters: Vec<char> = text.chars().collect();
    for (index, piece) in characters
        .chunks(usize::from(area.width).max(1))
        .enumerate()
    {
        let piece: String = piece.iter().collect();
        line(buffer, row(area, index), theme, [(piece.as_str(), role)]);
    }
}
