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

/// Splits a text into pieces: every match has the role [`Role::Match`], the rest the given role.
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

/// Returns the byte range of the first match in a text.
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

/// A search in a list, at one of its matches.
#[derive(Clone, Debug)]
pub struct Search {
    /// The text that is searched for.
    wanted: String,
    /// The index of the entry at which the search is.
    entry: usize,
}

impl Search {
    /// Creates a search at the first match from the entry `from` on, or else at the first match of all; None if there
    /// is no match. `matches` are the indices of the matching entries, in ascending order, here and below.
    pub fn new(wanted: &str, matches: &[usize], from: usize) -> Option<Self> {
        let ahead = matches.iter().find(|&&entry| entry >= from);
        let &entry = ahead.or(matches.first())?;
        let wanted = wanted.to_owned();
        Some(Self { wanted, entry })
    }

    /// Returns the text that is searched for.
    pub fn wanted(&self) -> &str {
        &self.wanted
    }

    /// Returns the index of the entry at which the search is.
    pub fn entry(&self) -> usize {
        self.entry
    }

    /// Goes from an entry to the next match, or to the previous one if `by` is negative; after the last match comes
    /// the first. Returns false if there is no match.
    pub fn go(&mut self, from: usize, by: i8, matches: &[usize]) -> bool {
        let next = if by > 0 {
            let ahead = matches.iter().find(|&&entry| entry > from);
            ahead.or(matches.first())
        } else {
            let back = matches.iter().rev().find(|&&entry| entry < from);
            back.or(matches.last())
        };
        if let Some(&entry) = next {
            self.entry = entry;
        }
        next.is_some()
    }

    /// Returns the number of the match at which the search is, from 1, and the number of all matches.
    pub fn number(&self, matches: &[usize]) -> (usize, usize) {
        let before = matches.iter().filter(|&&entry| entry < self.entry);
        (before.count() + 1, matches.len())
    }
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
        let mut search = Search::new("x", &matches, 6).expect("found");
        assert_eq!((search.entry(), search.number(&matches)), (9, (3, 3)));
        let mut gone = Vec::new();
        for by in [1, 1, -1, -1] {
            assert!(search.go(search.entry(), by, &matches));
            gone.push(search.entry());
        }
        assert_eq!(gone, [2, 5, 2, 9]);
        assert!(!search.go(9, 1, &[]) && Search::new("x", &[], 0).is_none());
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
