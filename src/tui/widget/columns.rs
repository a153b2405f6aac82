//! The width of text in terminal columns; a character may take two columns, or none.
//!
//! ```
//! use taxel::tui::widget::columns::{broken, width, window};
//! assert_eq!(width("字a"), 3);
//! assert_eq!(window("a long text", 11, 5), ("text", 4));
//! assert_eq!(broken("breaks at spaces", 9), ["breaks at", "spaces"]);
//! ```

use ratatui::text::Span;

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
    let mut ends = text
        .char_indices()
        .map(|(at, character)| at + character.len_utf8());
    let mut kept = "";
    while let Some(end) = ends.next().filter(|&end| width(&text[..end]) <= room) {
        kept = &text[..end];
    }
    kept
}

/// Returns the part of a text that a field of `room` columns shows so that the cursor is visible, from its first
/// character to the end of the text, and the column of the cursor in that part.
pub fn window(text: &str, cursor: usize, room: usize) -> (&str, usize) {
    let (mut shown, mut column) = (text, cursor);
    while column >= room.max(1)
        && let Some(first) = shown.chars().next()
    {
        let (hidden, rest) = shown.split_at(first.len_utf8());
        column = column.saturating_sub(width(hidden));
        shown = rest;
    }
    (shown, column)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cursor_in_a_field_is_always_visible() {
        for (text, cursor, expected) in [
            ("1234", 4, ("1234", 4)),
            ("12345", 5, ("2345", 4)),
            ("12345", 0, ("12345", 0)),
            ("字字字", 6, ("字字", 4)),
            ("字字字", 2, ("字字字", 2)),
            ("", 0, ("", 0)),
        ] {
            assert_eq!(window(text, cursor, 5), expected, "{text} at {cursor}");
        }
        assert_eq!(window("ab", 2, 0), ("", 0));
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
