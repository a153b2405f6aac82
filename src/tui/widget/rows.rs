//! The rows of a list: which one is selected, and which one a click is on.

use ratatui::layout::{Position, Rect};

use crate::tui::app::{Endpoint, Message};
use crate::tui::widget::Role;
use crate::tui::widget::write::first_of;

#[derive(Clone, Copy, Debug)]
pub struct ListRows {
    pub area: Rect,
    pub first: usize,
    pub count: usize,
}

impl ListRows {
    pub fn around(area: Rect, count: usize, selected: usize) -> Self {
        Self {
            area,
            first: first_of(area.height, count, selected),
            count,
        }
    }

    pub fn visible<T>(
        self,
        all: impl Iterator<Item = T>,
    ) -> impl Iterator<Item = (usize, Rect, T)> {
        let visible = all.enumerate().skip(self.first).zip(self.area.rows());
        visible.map(|((index, item), line)| (index, line, item))
    }

    pub fn position(&self, row: usize) -> Option<Position> {
        let line = self.area.rows().nth(row.checked_sub(self.first)?)?;
        (row < self.count).then(|| line.as_position())
    }

    pub fn hidden(&self) -> Option<String> {
        let last = self.first + usize::from(self.area.height);
        let (above, below) = (self.first, self.count.saturating_sub(last));
        (above + below > 0).then(|| format!("  {above} above, {below} below"))
    }

    pub fn at(&self, position: Position) -> Option<usize> {
        let row = self.first + usize::from(position.y.checked_sub(self.area.y)?);
        (self.area.contains(position) && row < self.count).then_some(row)
    }

    /// None beside the rows.
    pub fn click(&self, position: Position, selected: usize) -> Option<Message> {
        let row = self.at(position)?;
        Some(if row == selected {
            Message::Accept
        } else {
            Message::Select(row)
        })
    }
}

/// Returns the row that a message selects if `row` is selected now; None if it selects no row. The result may lie
/// beyond the last row, since only the list knows how many rows there are.
pub fn moved(row: usize, message: &Message) -> Option<usize> {
    match *message {
        Message::Scroll(lines) => Some(row.saturating_add_signed(lines.into())),
        Message::ScrollTo(Endpoint::First) => Some(0),
        Message::ScrollTo(Endpoint::Last) => Some(usize::MAX),
        Message::Select(row) => Some(row),
        _ => None,
    }
}

/// Returns true if a text contains the wanted text; the empty text is never found.
pub fn contains(text: &str, wanted: &str) -> bool {
    first(text, wanted).is_some()
}

pub fn marked<'a>(text: &'a str, wanted: &str, role: Role) -> Vec<(&'a str, Role)> {
    let (mut pieces, mut rest) = (Vec::new(), text);
    while let Some((start, end)) = first(rest, wanted) {
        pieces.push((&rest[..start], role));
        pieces.push((&rest[start..end], Role::Match));
        rest = &rest[end..];
    }
    pieces.push((rest, role));
    pieces.retain(|(piece, _)| !piece.is_empty());
    pieces
}

fn first(text: &str, wanted: &str) -> Option<(usize, usize)> {
    if wanted.is_empty() {
        return None;
    }
    let capitals = wanted.chars().any(char::is_uppercase);
    let same = |a: char, b: char| a == b || (!capitals && a.to_lowercase().eq(b.to_lowercase()));
    text.char_indices().find_map(|(start, _)| {
        let mut rest = text[start..].chars();
        let all = wanted
            .chars()
            .all(|wanted| rest.next().is_some_and(|own| same(own, wanted)));
        all.then(|| (start, text.len() - rest.as_str().len()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_letters_find_capitals_and_capitals_only_themselves() {
        for (text, wanted, found) in [
            ("Home End", "end", Some((5, 8))),
            ("Home End", "End", Some((5, 8))),
            ("append", "End", None),
            ("17° × 2", "×", Some((5, 7))),
            ("aab", "ab", Some((1, 3))),
            ("ab", "abc", None),
            ("ab", "", None),
            ("", "a", None),
        ] {
            assert_eq!(first(text, wanted), found, "{wanted:?} in {text:?}");
        }
    }
}
