//! The imprint: which taxels are active, stored as one `u64` per row.
//!
//! Bit `i` of a row is the taxel in column `i`. Bits beyond the last column and rows beyond the last one are always
//! zero. So `count_ones` counts active taxels, shifts yield neighbours, and imprints with equal words are equal.

use std::fmt;
use std::ops::Range;

use crate::parameter::number::counted;
use crate::quote::quoted_character;
use crate::sensor::{MAX_SIDE, MatrixSize};

/// A binary matrix of 1 × 1 to 64 × 64 taxels.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Imprint {
    size: MatrixSize,
    words: [u64; MAX_SIDE as usize],
}

impl Imprint {
    /// Creates an imprint without active taxels.
    pub fn empty(size: MatrixSize) -> Self {
        Self {
            size,
            words: [0; MAX_SIDE as usize],
        }
    }

    /// Returns the number of columns and rows.
    pub fn size(&self) -> MatrixSize {
        self.size
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> u8 {
        self.size.columns()
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> u8 {
        self.size.rows()
    }

    /// Returns the rows from the top, with column `i` in bit `i`.
    pub fn words(&self) -> &[u64] {
        &self.words[..usize::from(self.size.rows())]
    }

    /// Returns the rows for writing. The caller must leave the bits beyond the last column at 0.
    pub(crate) fn words_mut(&mut self) -> &mut [u64] {
        &mut self.words[..usize::from(self.size.rows())]
    }

    /// Sets a whole row. Drops bits beyond the last column, and does nothing beyond the last row.
    pub fn set_word(&mut self, row: usize, word: u64) {
        let mask = self.mask();
        if let Some(slot) = self.words[..usize::from(self.size.rows())].get_mut(row) {
            *slot = word & mask;
        }
    }

    /// Returns a row in which all taxels are active.
    pub fn mask(&self) -> u64 {
        u64::MAX >> (MAX_SIDE - self.columns())
    }

    /// Returns true if a taxel is active; false beyond the matrix.
    pub fn get(&self, column: u8, row: u8) -> bool {
        column < self.columns()
            && row < self.rows()
            && self.words[usize::from(row)] >> column & 1 == 1
    }

    /// Makes a taxel active or inactive; does nothing beyond the matrix.
    pub fn set(&mut self, column: u8, row: u8, active: bool) {
        if column < self.columns() && row < self.rows() {
            let word = &mut self.words[usize::from(row)];
            *word = *word & !(1 << column) | u64::from(active) << column;
        }
    }

    /// Toggles a taxel; does nothing beyond the matrix.
    pub fn toggle(&mut self, column: u8, row: u8) {
        self.set(column, row, !self.get(column, row));
    }

    /// Returns the number of active taxels.
    pub fn count(&self) -> u32 {
        self.words().iter().map(|word| word.count_ones()).sum()
    }

    /// Returns true if no taxel is active.
    pub fn is_empty(&self) -> bool {
        self.words().iter().all(|&word| word == 0)
    }

    /// Returns the smallest rectangle of whole taxels around the active ones; None for an empty imprint.
    pub fn bounds(&self) -> Option<Bounds> {
        let mut rows = self.words();
        while let [0, below @ ..] = rows {
            rows = below;
        }
        let top = self.words().len() - rows.len();
        while let [above @ .., 0] = rows {
            rows = above;
        }
        let across = rows.iter().fold(0, |across, word| across | word);
        Bounds::around(across, top, rows.len())
    }

    /// Returns true if a taxel in the first or last row or column is active, so that the shape may be cut off.
    pub fn touches_rim(&self) -> bool {
        self.bounds().is_some_and(|bounds| {
            bounds.left == 0
                || bounds.top == 0
                || bounds.right == self.columns()
                || bounds.bottom == self.rows()
        })
    }

    /// Iterates over the active taxels as (column, row), in reading order.
    pub fn active(&self) -> impl DoubleEndedIterator<Item = (u8, u8)> {
        (0..self.rows()).flat_map(move |row| {
            let word = self.words[usize::from(row)];
            (0..self.columns())
                .filter(move |column| word >> column & 1 == 1)
                .map(move |column| (column, row))
        })
    }

    fn combined(mut self, other: &Self, with: impl Fn(u64, u64) -> u64) -> Self {
        let mask = self.mask();
        for (word, other) in self.words_mut().iter_mut().zip(other.words) {
            *word = with(*word, other) & mask;
        }
        self
    }

    /// Returns the taxels in which two imprints differ, on the matrix of this one.
    #[must_use]
    pub fn differing(&self, other: &Self) -> Self {
        self.combined(other, |own, other| own ^ other)
    }

    /// Returns the taxels that are active in this imprint, in the other, or in both, on the matrix of this one.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        self.combined(other, |own, other| own | other)
    }

    /// Returns the taxels that are active in both imprints, on the matrix of this one.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        self.combined(other, |own, other| own & other)
    }

    /// Returns the taxels that are active in this imprint but not in the other, on the matrix of this one.
    #[must_use]
    pub fn without(&self, other: &Self) -> Self {
        self.combined(other, |own, other| own & !other)
    }

    /// Returns the same imprint on a matrix of another size; active taxels beyond it are dropped.
    #[must_use]
    pub fn resized(&self, size: MatrixSize) -> Self {
        Self::empty(size).union(self)
    }
}

/// A rectangle of whole taxels, given by its edges: columns `left..right`, rows `top..bottom`.
// Aligned, because the four bytes at an odd address (as in an enum) would be copied in parts, which takes longer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[repr(align(4))]
pub struct Bounds {
    /// First column.
    pub left: u8,
    /// First row.
    pub top: u8,
    /// One past the last column.
    pub right: u8,
    /// One past the last row.
    pub bottom: u8,
}

impl Bounds {
    /// Creates the bounds of the columns whose bits are set in `across` and of `rows` rows from `top` on; None if no
    /// bit is set.
    pub(crate) fn around(across: u64, top: usize, rows: usize) -> Option<Self> {
        let side = |count: u32| u8::try_from(count).unwrap_or(MAX_SIDE);
        let row = |row: usize| u8::try_from(row).unwrap_or(MAX_SIDE);
        (across != 0).then(|| Self {
            left: side(across.trailing_zeros()),
            top: row(top),
            right: MAX_SIDE - side(across.leading_zeros()),
            bottom: row(top + rows),
        })
    }

    /// Creates the bounds of a single taxel. They are empty beyond column or row 254.
    pub fn of_taxel(column: u8, row: u8) -> Self {
        Self {
            left: column,
            top: row,
            right: column.saturating_add(1),
            bottom: row.saturating_add(1),
        }
    }

    /// Returns the columns of the rectangle.
    pub fn columns(&self) -> Range<u8> {
        self.left..self.right
    }

    /// Returns the rows of the rectangle.
    pub fn rows(&self) -> Range<u8> {
        self.top..self.bottom
    }

    /// Returns the rows of an imprint within the rectangle.
    pub(crate) fn words(self, imprint: &Imprint) -> &[u64] {
        &imprint.words()[usize::from(self.top)..usize::from(self.bottom)]
    }

    /// Returns the number of taxels in the rectangle; 0 if left and right, or top and bottom, are the wrong way
    /// round.
    pub fn area(&self) -> u32 {
        let columns = self.right.saturating_sub(self.left);
        let rows = self.bottom.saturating_sub(self.top);
        u32::from(columns) * u32::from(rows)
    }
}

impl fmt::Display for Imprint {
    /// Writes one line per row, `#` for active and `.` for inactive, without a line end after the last row.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.lines().collect::<Vec<_>>().join("\n"))
    }
}

impl fmt::Debug for Imprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Imprint {}x{}\n{self}", self.columns(), self.rows())
    }
}

impl Imprint {
    /// Iterates over the rows as text: `#` for active, `.` for inactive.
    pub fn lines(&self) -> impl DoubleEndedIterator<Item = String> + ExactSizeIterator {
        (0..self.rows()).map(|row| {
            (0..self.columns())
                .map(|column| if self.get(column, row) { '#' } else { '.' })
                .collect()
        })
    }

    /// Reads an imprint from rows of `#` and `.`, at most 64 × 64, all of the same length.
    ///
    /// # Errors
    /// Returns an error if a row differs in length from the first, contains another character, or a side is not from 1
    /// to 64.
    pub fn from_rows<'a>(rows: impl IntoIterator<Item = &'a str>) -> Result<Self, ImprintError> {
        let (mut read, mut count) = (None, 0_u8);
        for text in rows {
            let wrong = |column, message| ImprintError {
                row: Some(u64::from(count) + 1),
                column,
                message,
            };
            if count == MAX_SIDE {
                return Err(ImprintError::rows());
            }
            let foreign = |character: char| !matches!(character, '#' | '.');
            if let Some((column, found)) = text.chars().enumerate().find(|(_, own)| foreign(*own)) {
                let found = quoted_character(found);
                let message = format!("found {found}, expected '#' or '.'");
                return Err(wrong(Some(column as u64 + 1), message));
            }
            let found = || counted(text.len() as u64, "taxel");
            let size = MatrixSize::of_sides(text.len(), MAX_SIDE)
                .ok_or_else(|| wrong(None, format!("found {}, expected 1 to 64", found())))?;
            let imprint = read.get_or_insert_with(|| Self::empty(size));
            if imprint.size != size {
                let expected = imprint.columns();
                let message = format!("found {}, expected {expected} as in the first row", found());
                return Err(wrong(None, message));
            }
            let active = text.bytes().map(|byte| u64::from(byte == b'#'));
            imprint.words[usize::from(count)] =
                active.rev().fold(0, |word, active| word << 1 | active);
            count += 1;
        }
        let imprint = read.ok_or_else(ImprintError::rows)?;
        let size = MatrixSize::new(imprint.columns(), count).map_err(|_| ImprintError::rows())?;
        Ok(Self { size, ..imprint })
    }
}

impl std::str::FromStr for Imprint {
    type Err = ImprintError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::from_rows(text.lines())
    }
}

/// The error for text that is not an imprint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImprintError {
    /// The row, from 1; None if there are too many rows or none.
    pub row: Option<u64>,
    /// The column of a wrong character, from 1.
    pub column: Option<u64>,
    /// What was found and what was expected.
    pub message: String,
}

impl ImprintError {
    fn rows() -> Self {
        Self {
            row: None,
            column: None,
            message: "expected 1 to 64 rows of '#' and '.'".to_owned(),
        }
    }
}

impl fmt::Display for ImprintError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.row, self.column) {
            (Some(row), Some(column)) => write!(f, "row {row}, column {column}: ")?,
            (Some(row), None) => write!(f, "row {row}: ")?,
            _ => {}
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for ImprintError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_the_wrong_way_round_have_an_area_of_0() {
        let bounds = Bounds {
            left: 5,
            top: 0,
            right: 2,
            bottom: 9,
        };
        assert_eq!((bounds.area(), Bounds::of_taxel(255, 0).area()), (0, 0));
        assert_eq!(Bounds::of_taxel(254, 0).area(), 1);
    }

    #[test]
    fn two_imprints_are_combined_on_the_matrix_of_the_first() {
        let imprint: Imprint = ".##.\n#..#\n.##.".parse().expect("rows");
        assert_eq!(
            (imprint.columns(), imprint.rows(), imprint.count()),
            (4, 3, 6)
        );
        assert!(imprint.get(1, 0) && !imprint.get(1, 1) && !imprint.get(9, 9));
        let [one, other] =
            ["##.\n...", ".###\n#..."].map(|text| text.parse::<Imprint>().expect("an imprint"));
        assert_eq!(one.union(&other).to_string(), "###\n#..");
        assert_eq!(one.differing(&other).to_string(), "#.#\n#..");
        assert_eq!(one.intersection(&other).to_string(), ".#.\n...");
        assert_eq!(one.without(&other).to_string(), "#..\n...");
    }
}
