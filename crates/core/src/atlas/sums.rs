//! Sums of whole numbers, which are the same in any order, wide enough never to overflow.
//!
//! Threads, shards and symmetries change the order in which a sweep adds up, and sums of `f64` would change in their
//! last digits with it. So a value counts as the nearest multiple of 2⁻⁴⁰ (an error below 5e-13). Values are below 2¹⁸
//! and poses at most 10¹² < 2⁴⁰, so a sum of values takes 98 bits and a sum of squares 156.

use std::ops::{AddAssign, Sub};

use crate::geometry::Real;
use crate::index::lower_word;

/// The number one in fixed point.
pub(crate) const ONE: f64 = 1_099_511_627_776.0;

/// Returns a number in [0, 2²³) in fixed point: the nearest multiple of 2⁻⁴⁰, as a whole number. Negative numbers
/// become 0.
#[expect(clippy::cast_possible_truncation, reason = "below 2^63")]
pub(crate) fn fixed(value: f64) -> i64 {
    // Not `round`, which is a function call unless the processor is known to have the instruction.
    Real::max(value * ONE + 0.5, 0.0) as i64
}

#[expect(clippy::cast_possible_truncation, reason = "at most 2^40")]
pub(crate) fn signed(value: f64) -> i64 {
    (value * ONE).round() as i64
}

/// Returns the mean of `count` fixed-point numbers with this sum.
#[expect(clippy::cast_precision_loss, reason = "the nearest f64 is wanted")]
pub(crate) fn mean(sum: u128, count: u64) -> f64 {
    let (whole, rest) = (sum / u128::from(count), sum % u128::from(count));
    (whole as f64 + rest as f64 / count as f64) / ONE
}

#[expect(clippy::cast_precision_loss, reason = "the nearest f64 is wanted")]
pub(crate) fn signed_mean(sum: i128, count: u64) -> f64 {
    sum as f64 / count as f64 / ONE
}

/// A whole number from 0 to 2¹⁹² − 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Wide {
    high: u64,
    low: u128,
}

impl Wide {
    pub(crate) fn of(low: u128) -> Self {
        Self { high: 0, low }
    }

    /// Creates the number `lower + upper · 2⁶⁴`.
    pub(crate) fn joined([lower, upper]: [u128; 2]) -> Self {
        let (low, carry) = (upper << 64).overflowing_add(lower);
        // This is below 2⁶⁴, as the number is below 2¹⁹².
        let high = (upper >> 64) + u128::from(carry);
        Self {
            high: lower_word(high),
            low,
        }
    }

    /// Returns the product of a number below 2¹²⁸ and one below 2⁶⁴.
    pub(crate) fn product(value: u128, times: u64) -> Self {
        if times < 1 << 12 && value < 1 << 116 {
            return Self::of(value * u128::from(times));
        }
        let times = u128::from(times);
        Self::joined([
            (value & u128::from(u64::MAX)) * times,
            (value >> 64) * times,
        ])
    }

    pub(crate) fn times(self, times: u64) -> Self {
        let low = Self::product(self.low, times);
        Self {
            high: low.high.wrapping_add(self.high.wrapping_mul(times)),
            ..low
        }
    }

    /// Returns `⌊sum² / count⌋`, for a sum of at most 2⁴⁰ numbers below 2⁵⁸.
    ///
    /// With `sum = count·m + r`, it is `count·m² + 2·m·r + ⌊r²/count⌋`.
    pub(crate) fn square_over(sum: u128, count: u64) -> Self {
        let (mean, rest) = (sum / u128::from(count), sum % u128::from(count));
        let mut all = Self::product(mean * mean, count);
        all += Self::of(2 * mean * rest);
        all += Self::of(rest * rest / u128::from(count));
        all
    }

    /// Returns the root of the mean of `count` squares of fixed-point numbers, whose sum this is.
    #[expect(clippy::cast_precision_loss, reason = "the nearest f64 is wanted")]
    pub(crate) fn root_mean(self, count: u64) -> f64 {
        let sum = self.high as f64 * 2_f64.powi(128) + self.low as f64;
        (sum / count as f64).sqrt() / ONE
    }

    /// Rounds a number from 0 to 2¹²⁷.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "saturates"
    )]
    pub(crate) fn rounded(value: f64) -> Self {
        Self::of(value.round() as u128)
    }

    /// Returns the mean of `count` fixed-point numbers, whose sum this is; it must be below 2¹²⁸.
    pub(crate) fn mean(self, count: u64) -> f64 {
        mean(self.low, count)
    }

    pub(crate) fn words(self) -> [u64; 3] {
        [lower_word(self.low), lower_word(self.low >> 64), self.high]
    }

    pub(crate) fn from_words([first, second, high]: [u64; 3]) -> Self {
        Self {
            high,
            low: u128::from(first) | u128::from(second) << 64,
        }
    }
}

impl AddAssign for Wide {
    fn add_assign(&mut self, other: Self) {
        let (low, carry) = self.low.overflowing_add(other.low);
        self.low = low;
        self.high = self
            .high
            .wrapping_add(other.high)
            .wrapping_add(u64::from(carry));
    }
}

impl Sub for Wide {
    type Output = Self;
    /// Returns the difference, or 0 if it is negative: the numbers may then only differ by what was rounded down.
    fn sub(self, other: Self) -> Self {
        let (low, borrow) = self.low.overflowing_sub(other.low);
        let high = i128::from(self.high) - i128::from(other.high) - i128::from(borrow);
        u64::try_from(high).map_or_else(|_| Self::default(), |high| Self { high, low })
    }
}
