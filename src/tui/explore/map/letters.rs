//! Letters for the imprints of a map: the same letter wherever an imprint occurs, different letters for neighbours.
//!
//! This is a colouring of the graph of imprints that touch each other on the map, also across corners. There are 62
//! letters. The imprints with the most neighbours choose first: a letter that is not used yet, otherwise a letter
//! that no neighbour has. An imprint with more than 61 neighbours may have to share a letter with one of them.

use std::collections::{BTreeMap, BTreeSet};

pub const LETTERS: u8 = 62;

/// Returns the letter of each cell of a map as a number from 0, or None where there is no imprint. `width` is the
/// number of cells in a row. Different imprints have different letters until all are used; then letters are repeated,
/// but not for cells that touch, also across corners. Only around an imprint that touches more than 61 others can
/// letters run out. By default the imprint's number decides, so that most letters stay when the map moves.
///
/// ```
/// use taxel::tui::explore::map::letters::letters;
/// // 62 would have the letter of 0.
/// assert_eq!(letters(&[Some(0), Some(62), None, Some(3)], 2), [Some(0), Some(1), None, Some(3)]);
/// ```
pub fn letters(ids: &[Option<u32>], width: usize) -> Vec<Option<u8>> {
    signs(ids, width, LETTERS)
}

pub fn signs(ids: &[Option<u32>], width: usize, count: u8) -> Vec<Option<u8>> {
    let width = width.max(1);
    let mut neighbours: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    let mut touch = |one: u32, other: usize| {
        let own = neighbours.entry(one).or_default();
        if let Some(&Some(other)) = ids.get(other)
            && other != one
        {
            own.insert(other);
            neighbours.entry(other).or_default().insert(one);
        }
    };
    for (index, id) in ids.iter().enumerate() {
        let Some(id) = *id else { continue };
        let column = index % width;
        touch(id, index + width);
        if column + 1 < width {
            touch(id, index + 1);
            touch(id, index + width + 1);
        }
        if column > 0 {
            touch(id, index + width - 1);
        }
    }
    // Imprints with the most neighbours come first: an imprint with fewer neighbours than there are letters always
    // finds one.
    let mut order: Vec<u32> = neighbours.keys().copied().collect();
    order.sort_by_key(|id| std::cmp::Reverse(neighbours[id].len()));
    let mut chosen: BTreeMap<u32, u8> = BTreeMap::new();
    let mut used: BTreeSet<u8> = BTreeSet::new();
    for id in order {
        let taken = |letter: &u8| {
            let mut around = neighbours[&id].iter();
            around.any(|other| chosen.get(other) == Some(letter))
        };
        // The remainder has one byte.
        let [own, ..] = (id % u32::from(count)).to_le_bytes();
        let others = || (0..count).map(|step| (own + step) % count);
        let unused = |letter: &u8| !used.contains(letter);
        let letter = others()
            .find(unused)
            .or_else(|| others().find(|letter| !taken(letter)));
        let letter = letter.unwrap_or(own);
        used.insert(letter);
        chosen.insert(id, letter);
    }
    ids.iter()
        .map(|id| chosen.get(id.as_ref()?).copied())
        .collect()
}

pub fn letter(number: u8) -> char {
    let (first, number) = match number {
        0..26 => (b'a', number),
        26..52 => (b'A', number - 26),
        _ => (b'0', (number - 52).min(9)),
    };
    char::from(first + number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_differ_and_an_imprint_has_one_letter() {
        // These numbers would all have the same letter.
        for (width, height) in [(1, 9), (9, 1), (7, 8), (40, 30)] {
            let id = |x: usize, y: usize| {
                let block = (x / 3 * 7 + y / 2 * 5) % 23;
                (block % 6 != 5).then(|| u32::try_from(block * 62).expect("small"))
            };
            let places = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let ids: Vec<_> = places().map(|(x, y)| id(x, y)).collect();
            let found = letters(&ids, width);
            let at = |x: usize, y: usize| (ids[y * width + x], found[y * width + x]);
            for (x, y) in places() {
                let (own, letter) = at(x, y);
                assert_eq!(own.is_some(), letter.is_some());
                for (other_x, other_y) in places() {
                    let (other, other_letter) = at(other_x, other_y);
                    let near = x.abs_diff(other_x) <= 1 && y.abs_diff(other_y) <= 1;
                    if own.is_some() && own == other {
                        assert_eq!(letter, other_letter);
                    } else if near && own.is_some() && other.is_some() {
                        assert_ne!(letter, other_letter, "{x},{y} and {other_x},{other_y}");
                    }
                }
            }
        }
        assert_eq!(letters(&[], 0), []);
        let all: String = (0..LETTERS).map(letter).collect();
        assert!(
            all.starts_with("abc") && all.ends_with("XYZ0123456789"),
            "{all}"
        );
        // As many imprints as there are letters: no letter twice, whatever their numbers.
        let ids: Vec<_> = (0..u32::from(LETTERS)).map(|id| Some(id * 31)).collect();
        let different: BTreeSet<_> = letters(&ids, 8).into_iter().flatten().collect();
        assert_eq!(different.len(), ids.len());
    }
}
