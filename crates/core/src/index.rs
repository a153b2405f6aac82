//! Conversions between integers and indices. Those that can lose something are all here, each with its reason.
//!
//! A number that does not fit must never become another number that looks right. Where the types do not rule this
//! out, it becomes the largest `usize` or `u32`. That is beyond the end of every slice, so looking it up finds
//! nothing.

const _: () = assert!(
    usize::BITS >= u32::BITS,
    "a u32 is an index on every supported target"
);

/// Converts a `u32` to an index, without loss.
pub const fn wide(number: u32) -> usize {
    number as usize
}

/// Converts a `u64` to an index. A number beyond the address space becomes an index beyond every slice.
pub fn index(number: u64) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}

/// Converts a signed coordinate to an index. Coordinates before the first column or row become 0.
pub(crate) fn from_first(coordinate: i32) -> usize {
    wide(coordinate.max(0).unsigned_abs())
}

/// Converts a count or an index to four bytes. Tables of such numbers have fewer than 2³² entries; `u32::MAX` means
/// none.
pub fn narrow(number: impl TryInto<u32>) -> u32 {
    number.try_into().unwrap_or(u32::MAX)
}

/// Returns the lower 64 bits.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the upper word is dropped on purpose"
)]
pub(crate) const fn lower_word(number: u128) -> u64 {
    number as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coordinate_before_the_first_belongs_to_it() {
        assert_eq!([-3, 0, 5].map(from_first), [0, 0, 5]);
    }

    #[test]
    fn a_number_that_does_not_fit_is_beyond_every_slice() {
        assert_eq!((narrow(7_usize), narrow(1_u64 << 32)), (7, u32::MAX));
        assert_eq!((index(7), wide(7)), (7, 7));
        assert_eq!(lower_word((3 << 64) + 5), 5);
    }
}
