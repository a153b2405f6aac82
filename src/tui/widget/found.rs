//! Finds a text in a line, and marks it.
//!
//! Small letters also find capitals, unless the wanted text has a capital itself: `u` finds both, `U` only `U`.
//!
//! ```
//! use taxel::tui::widget::found::{contains, marked};
//! use taxel::tui::widget::theme::Role;
//! assert!(contains("Home End", "home") && !contains("u", "U") && !contains("anything", ""));
//! let pieces = [("U", Role::Match), ("ndo", Role::Text)];
//! assert_eq!(marked("Undo", "u", Role::Text), pieces);
//! ```

use crate::tui::widget::theme::Role;

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

#[derive(Clone, Debug, Default)]
pub struct Search {
    wanted: String,
    entry: usize,
}

impl Search {
    /// Searches for a text from the entry `from` on, then from the start. Returns the entry of the first match; if
    /// there is none, the search ends. `matches` are the indices of the matching entries, in ascending order, here
    /// and below.
    pub fn begin(&mut self, wanted: &str, matches: &[usize], from: usize) -> Option<usize> {
        self.end();
        let ahead = matches.iter().find(|&&entry| entry >= from);
        self.entry = *ahead.or(matches.first())?;
        wanted.clone_into(&mut self.wanted);
        Some(self.entry)
    }

    pub fn end(&mut self) {
        *self = Self::default();
    }

    pub fn wanted(&self) -> &str {
        &self.wanted
    }

    pub fn entry(&self) -> Option<usize> {
        (!self.wanted.is_empty()).then_some(self.entry)
    }

    /// Goes from an entry to the next match, or to the previous one if `by` is negative; after the last match comes
    /// the first. Returns its entry; None if there is no match.
    pub fn go(&mut self, from: usize, by: i8, matches: &[usize]) -> Option<usize> {
        let next = if by > 0 {
            let ahead = matches.iter().find(|&&entry| entry > from);
            ahead.or(matches.first())
        } else {
            let back = matches.iter().rev().find(|&&entry| entry < from);
            back.or(matches.last())
        };
        self.entry = *next?;
        Some(self.entry)
    }
}

pub fn number(entry: usize, matches: &[usize]) -> Option<(usize, usize)> {
    let before = matches.binary_search(&entry).ok()?;
    Some((before + 1, matches.len()))
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

    #[test]
    fn after_the_last_match_comes_the_first() {
        let matches = [2, 5, 9];
        let mut search = Search::default();
        assert_eq!(search.begin("x", &matches, 6), Some(9));
        assert_eq!(number(9, &matches), Some((3, 3)));
        let mut at = 9;
        let gone = [1, 1, -1, -1].map(|by| {
            at = search.go(at, by, &matches).expect("a match");
            at
        });
        assert_eq!(gone, [2, 5, 2, 9]);
        assert_eq!((search.entry(), search.go(9, 1, &[])), (Some(9), None));
        assert_eq!((search.begin("y", &[], 0), search.entry()), (None, None));
    }

    #[test]
    fn every_match_of_a_line_is_marked() {
        let pieces = marked("a, A and b", "a", Role::Text);
        let text: String = pieces.iter().map(|(piece, _)| *piece).collect();
        assert_eq!(text, "a, A and b");
        let matches = pieces.iter().filter(|(_, role)| *role == Role::Match);
        assert_eq!(matches.map(|(piece, _)| *piece).collect::<String>(), "aAa");
        assert_eq!(marked("ab", "", Role::Key), [("ab", Role::Key)]);
    }
}
