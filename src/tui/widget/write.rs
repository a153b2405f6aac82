//! Writing text into the screen's buffer.
//!
//! Text has a [`Role`], from which the theme decides its style and characters. Text is cut at the edge of its area,
//! and an ellipsis shows that something is missing. All functions accept any area, also an empty one or one beyond
//! the buffer.

use std::borrow::Cow;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use ratatui::text::Span;

use crate::tui::widget::{Role, TextField, Theme};

/// Writes pieces of text, each in its role, into the first line of an area. The first piece that does not fit is cut
/// short with an ellipsis, and the following ones are left out. Returns the column after the text.
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
        let text = theme.text(text);
        let fitting = fitted(&text, room, theme);
        (x, _) = buffer.set_stringn(x, area.y, &fitting, room, theme.style(role));
        if fitting != text {
            break;
        }
    }
    x
}

/// Writes a character; does nothing beyond the buffer.
pub fn sign(buffer: &mut Buffer, (x, y): (u16, u16), sign: char, style: Style) {
    if let Some(cell) = buffer.cell_mut((x, y)) {
        cell.set_char(sign).set_style(style);
    }
}

/// Writes a text into the first line of an area. If it does not fit, it is cut short with an ellipsis. Returns the
/// column after it.
pub fn text(buffer: &mut Buffer, area: Rect, theme: &Theme, text: &str, role: Role) -> u16 {
    line(buffer, area, theme, [(text, role)])
}

/// Fits a text into a number of columns: unchanged if it fits without the spaces at its end, otherwise shortened with
/// an ellipsis.
pub fn fitted<'a>(text: &'a str, room: usize, theme: &Theme) -> Cow<'a, str> {
    if width(text) <= room {
        return Cow::Borrowed(text);
    }
    let trimmed = text.trim_end();
    if width(trimmed) <= room {
        return Cow::Borrowed(head(text, room));
    }
    let ellipsis = Some(theme.text("…")).filter(|ellipsis| width(ellipsis) <= room);
    let ellipsis = ellipsis.unwrap_or_default();
    let kept = head(trimmed, room - width(&ellipsis));
    Cow::Owned(format!("{}{ellipsis}", kept.trim_end()))
}

pub fn row(area: Rect, index: usize) -> Rect {
    let below = below(area, narrow(index));
    let height = below.height.min(1);
    Rect { height, ..below }
}

/// Returns the index of the first visible row, so that the selected row is as near to the middle as the ends allow.
pub(in crate::tui) fn first_of(visible: u16, rows: usize, selected: usize) -> usize {
    let visible = usize::from(visible);
    selected
        .saturating_sub(visible / 2)
        .min(rows.saturating_sub(visible))
}

pub fn below(area: Rect, lines: u16) -> Rect {
    let lines = lines.min(area.height);
    Rect {
        y: area.y + lines,
        height: area.height - lines,
        ..area
    }
}

pub fn right_of(area: Rect, x: u16) -> Rect {
    let x = x.clamp(area.x, area.right());
    Rect {
        x,
        width: area.right() - x,
        ..area
    }
}

pub fn left_of(area: Rect, x: u16) -> Rect {
    let width = x.saturating_sub(area.x).min(area.width);
    Rect { width, ..area }
}

/// Returns the part of a text that a field of `room` columns shows so that the cursor is visible, and the column of
/// the cursor in that part. An ellipsis at its start stands for the hidden text before. The part extends to the end
/// of the text: the caller shortens it at the right, which never hides the character under the cursor.
pub fn field_text(text: &str, cursor: usize, room: usize, theme: &Theme) -> (String, usize) {
    let ellipsis = theme.text("…");
    let mark = width(&ellipsis);
    let is_visible = |hidden: usize, before: usize| {
        let is_cut = before + width(text) - hidden > room;
        cursor + before - hidden + if is_cut { mark } else { 0 } < room
    };
    if room <= 2 * mark || is_visible(0, 0) {
        return (text.to_owned(), cursor);
    }
    let (mut rest, mut hidden) = (text.chars(), 0);
    while (hidden == 0 || !is_visible(hidden, mark))
        && let Some(character) = rest.next()
    {
        hidden += width(character.encode_utf8(&mut [0; 4]));
    }
    (
        format!("{ellipsis}{}", rest.as_str()),
        cursor + mark - hidden,
    )
}

pub fn prompt(
    buffer: &mut Buffer,
    area: Rect,
    theme: &Theme,
    label: &str,
    field: &TextField,
    remark: &str,
) -> Position {
    clear(buffer, area);
    let before = width(label);
    let room = usize::from(area.width).saturating_sub(before);
    let (shown, column) = field_text(field.text(), field.cursor(), room, theme);
    let pieces = [label, &shown, remark].map(|piece| (piece, Role::Text));
    line(buffer, area, theme, pieces);
    let column = narrow(before + column).min(area.width.saturating_sub(1));
    Position::new(area.x.saturating_add(column), area.y)
}

pub fn clear(buffer: &mut Buffer, area: Rect) {
    for position in area.intersection(*buffer.area()).positions() {
        buffer[position].reset();
    }
}

/// If the area has fewer, the text ends in an ellipsis.
pub fn wrapped(buffer: &mut Buffer, area: Rect, theme: &Theme, text: &str, role: Role) -> usize {
    let text = theme.text(text);
    let room = usize::from(area.width);
    let lines = broken(&text, room);
    let last = usize::from(area.height).min(lines.len()).saturating_sub(1);
    for (index, &piece) in lines.iter().enumerate().take(last) {
        line(buffer, row(area, index), theme, [(piece, role)]);
    }
    // The whole rest makes the last line too long, so that it ends in an ellipsis.
    let rest = lines[last..].join(" ");
    line(buffer, row(area, last), theme, [(&*rest, role)]);
    lines.len()
}

pub fn width(text: &str) -> usize {
    if is_plain(text) {
        return text.len();
    }
    Span::raw(text).width()
}

fn is_plain(text: &str) -> bool {
    text.bytes().all(|byte| matches!(byte, b' '..=b'~'))
}

pub(in crate::tui) fn head(text: &str, room: usize) -> &str {
    if is_plain(text) {
        return &text[..room.min(text.len())];
    }
    let ends = text
        .char_indices()
        .map(|(at, character)| at + character.len_utf8());
    let fits = |end: &usize| width(&text[..*end]) <= room;
    &text[..ends.take_while(fits).last().unwrap_or(0)]
}

pub fn broken(text: &str, room: usize) -> Vec<&str> {
    let mut lines = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let fits = head(rest, room.max(1));
        let end = if fits.len() == rest.len() {
            rest.len()
        } else {
            // A character that is wider than the room still takes a line.
            let first = rest.chars().next().map_or(1, char::len_utf8);
            let space =
                rest[..fits.len() + usize::from(rest[fits.len()..].starts_with(' '))].rfind(' ');
            space.filter(|&at| at > 0).unwrap_or(fits.len()).max(first)
        };
        let (piece, after) = rest.split_at(end);
        lines.push(piece.trim_end());
        rest = after.trim_start();
    }
    lines
}

pub(in crate::tui) fn narrow(length: impl TryInto<u16>) -> u16 {
    length.try_into().unwrap_or(u16::MAX)
}

/// Returns a length on the screen without its fraction.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a screen is smaller; anything else ends at a bound"
)]
pub(in crate::tui) fn whole(length: f64) -> u16 {
    length as u16
}

pub(in crate::tui) fn taxels(length: impl TryInto<u8>) -> u8 {
    length.try_into().unwrap_or(u8::MAX)
}

/// Returns the index `by` steps after `now` (before it if negative) among `count` indices; `count` must not be 0.
/// After the last index comes the first.
///
/// ```
/// use taxel::tui::widget::write::around;
/// assert_eq!([around(3, 1, 4), around(0, -1, 4), around(1, 6, 4)], [0, 3, 3]);
/// ```
pub fn around(now: usize, by: i8, count: usize) -> usize {
    let forward = usize::from(by.unsigned_abs()) % count;
    let step = if by < 0 { count - forward } else { forward };
    (now + step) % count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_is_too_long_ends_in_an_ellipsis() {
        let (unicode, ascii) = (Theme::plain(false), Theme::plain(true));
        for (text, room, expected) in [
            ("washer", 6, "washer"),
            ("washer", 5, "wash…"),
            ("a  washer", 3, "a…"),
            ("washer  ", 7, "washer "),
            ("字字字", 5, "字字…"),
            ("字字字", 4, "字…"),
            ("washer", 1, "…"),
            ("washer", 0, ""),
            ("", 0, ""),
        ] {
            let fitting = fitted(text, room, &unicode);
            assert_eq!(fitting, expected, "{text} in {room}");
            assert!(width(&fitting) <= room);
        }
        assert_eq!(fitted("washer", 5, &ascii), "wa...");
        assert_eq!(fitted("washer", 2, &ascii), "wa");
    }

    #[test]
    fn the_cursor_in_a_field_is_always_visible() {
        for (text, cursor, expected) in [
            ("1234", 4, ("1234", 4)),
            ("12345", 5, ("…345", 4)),
            ("12345", 0, ("12345", 0)),
            ("123456789", 5, ("…456789", 3)),
            ("字字字", 6, ("…字", 3)),
            ("字字字", 2, ("字字字", 2)),
            ("", 0, ("", 0)),
        ] {
            let (shown, column) = field_text(text, cursor, 5, &Theme::plain(false));
            assert_eq!((shown.as_str(), column), expected, "{text} at {cursor}");
        }
    }

    #[test]
    fn lines_break_at_spaces_and_inside_long_words() {
        assert_eq!(
            broken("one two  three", 7),
            ["one two", "three"],
            "at the space that just fits no more"
        );
        assert_eq!(broken("one two", 6), ["one", "two"]);
        assert_eq!(broken("/a/long/path x", 5), ["/a/lo", "ng/pa", "th x"]);
        assert_eq!(broken("字字", 1), ["字", "字"]);
        assert!(broken("  ", 4).is_empty());
    }
}
