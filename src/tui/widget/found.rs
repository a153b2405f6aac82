//! How a text is found in a line, and marked.
//!
//! Letters find capitals, too, unless the text has a capital itself: `u` finds both, `U` only the one.
//!
//! ```
//! use taxel::tui::widget::found::{contains, marked};
//! use taxel::tui::widget::theme::Role;
//! assert!(contains("Home End", "home") && !contains("u", "U") && !contains("anything", ""));
//! let pieces = [("U", Role::Match), ("ndo", Role::Text)];
//! assert_eq!(marked("Undo", "u", Role::Text), pieces);
//! ```

use crate::tui::widget::theme::Role;

/// Whether a text has what is searched for. Nothing has the empty text.
pub fn contains(text: &str, wanted: &str) -> bool {
    first(text, wanted).is_some()
}

/// A text in pieces: what was searched for in the role of matches, the rest in a role of its own.
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

/// The bytes of a text where what is searched for stands first.
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

/// A search in a list that found something.
#[derive(Clone, Debug)]
pub struct Search {
    /// What is searched for.
    wanted: String,
    /// The entry of the list that one has come to.
    entry: usize,
}

impl Search {
    /// The search at the first entry that has it from `from` on, or else before that; None where no entry does. `matches`
    /// are the entries that have it, in ascending order, here and below.
    pub fn new(wanted: &str, matches: &[usize], from: usize) -> Option<Self> {
        let ahead = matches.iter().find(|&&entry| entry >= from);
        let &entry = ahead.or(matches.first())?;
        let wanted = wanted.to_owned();
        Some(Self { wanted, entry })
    }

    /// What is searched for.
    pub fn wanted(&self) -> &str {
        &self.wanted
    }

    /// The entry that one has come to.
    pub fn entry(&self) -> usize {
        self.entry
    }

    /// Goes from an entry to the next match, or to the previous one if `by` is negative; the first follows the last.
    /// Answers whether there is one.
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

    /// Which match one has come to, counted from 1, and of how many.
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
    fn matches_are_gone_through_round_and_round() {
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
