//! The numbers that geometry computes with: [`f64`] for speed, [`Double`] to decide what `f64` cannot.
//!
//! Outlines and areas are written once, for any [`Real`]. A touch computes in `f64`, with errors below 1e-11. A
//! coverage that lies within ten times that error of the threshold is computed again as a [`Double`], a pair of `f64`
//! with about 106 bits. There, a difference below 1e-20 counts as zero ([`Real::TIE`]).
//!
//! **A parameter means the decimal number that is displayed.** `0.1` as an `f64` is not one tenth, so a figure that
//! should cover exactly half of a cell would miss it by 1e-17. [`Real::decimal`] therefore takes the shortest decimal
//! that reads back as the given `f64`, which is what a user typed. A `Double` holds that decimal to 32 digits.
//!
//! Double-double arithmetic after T. J. Dekker, *A floating-point technique for extending the available
//! precision*, Numerische Mathematik 18 (1971), and D. E. Knuth, *The Art of Computer Programming*, vol. 2, 4.2.2.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::index::from_first;

mod sealed {
    /// Prevents other modules from implementing [`Real`](super::Real).
    pub trait Sealed {}
}

impl sealed::Sealed for f64 {}

impl sealed::Sealed for Double {}

/// The operations that geometry needs, of [`f64`] and [`Double`] only (the trait is sealed). None of them panics;
/// callers keep divisors away from zero.
pub trait Real:
    sealed::Sealed
    + Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// One half.
    const HALF: Self;
    /// A right angle in radians.
    const QUARTER_TURN: Self;
    /// Two areas (in cells) whose difference is below this count as equal.
    const TIE: Self;

    /// Returns the shortest decimal that reads back as `value`; `value` itself if the type has no more digits than
    /// `f64`.
    fn decimal(value: f64) -> Self;
    /// Returns the number of this type that is nearest to one of 32 digits.
    fn from_double(value: Double) -> Self;
    /// Returns the nearest `f64`.
    fn to_f64(self) -> f64;
    /// Converts a whole number.
    fn whole(value: i32) -> Self;
    /// Returns the largest whole number that is not above this number. Saturates beyond the range of `i32`.
    fn floor(self) -> i32;
    /// Returns the unit interval that contains a number from 0 to below 2²⁰: its index, and its lower end. For a whole
    /// number, it may be either of the two that meet there.
    fn cell(self) -> (usize, Self);
    /// Returns the square root; 0 for a negative number, since a difference that should vanish may be −1e-17.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Returns sine and cosine of an angle in degrees; exactly 0 and ±1 at multiples of 90°.
    fn sin_cos_degrees(self) -> (Self, Self);
    /// Returns the angle in radians with this sine and this cosine, from −π/2 to π/2: the cosine is not negative.
    fn angle(sin: Self, cos: Self) -> Self;

    /// Returns the smaller of two numbers.
    #[must_use]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// Returns the larger of two numbers.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
    /// Returns the absolute value.
    #[must_use]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }
}

/// 1.5 · 2⁵². Adding a number to it rounds that number to a whole one, which then stands in the lowest bits. A cast
/// takes three times as long, because it has to saturate.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// Returns the whole number nearest to a number from −2³¹ to below 2³¹; the even one if two are equally near.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the lowest bits are wanted"
)]
pub(crate) fn nearest(number: f64) -> i32 {
    (number + WHOLE).to_bits() as i32
}

fn from_right_angle(degrees: f64) -> (i32, f64) {
    // A full turn more or less makes no difference.
    let degrees = degrees % 360.0;
    let quarter = nearest(degrees / 90.0);
    (quarter, degrees - 90.0 * f64::from(quarter))
}

/// Returns sine and cosine of an angle that is larger by some right angles. No zero becomes negative.
fn turned<T: Real>(quarter: i32, (sin, cos): (T, T)) -> (T, T) {
    match quarter & 3 {
        0 => (sin, cos),
        1 => (cos, T::ZERO - sin),
        2 => (T::ZERO - sin, T::ZERO - cos),
        _ => (T::ZERO - cos, sin),
    }
}

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const HALF: Self = 0.5;
    const QUARTER_TURN: Self = FRAC_PI_2;
    const TIE: Self = 1e-12;

    fn decimal(value: f64) -> Self {
        value
    }
    fn from_double(value: Double) -> Self {
        value.high
    }
    fn to_f64(self) -> f64 {
        self
    }
    fn whole(value: i32) -> Self {
        Self::from(value)
    }
    #[expect(
        clippy::cast_possible_truncation,
        reason = "saturating is what the contract asks for"
    )]
    fn floor(self) -> i32 {
        // Not `f64::floor`, which is a function call unless the processor is known to have the instruction.
        let towards_zero = self as i32;
        towards_zero.saturating_sub(i32::from(Self::from(towards_zero) > self))
    }
    fn cell(self) -> (usize, Self) {
        let moved = (self - 0.5) + WHOLE;
        ((moved.to_bits() & 0xf_ffff) as usize, moved - WHOLE)
    }
    fn sqrt(self) -> Self {
        f64::sqrt(f64::max(self, 0.0))
    }
    fn abs(self) -> Self {
        f64::abs(self)
    }
    fn sin_cos_degrees(self) -> (Self, Self) {
        let (quarter, rest) = from_right_angle(self);
        turned(quarter, libm::sincos(rest.to_radians()))
    }
    fn angle(sin: Self, cos: Self) -> Self {
        libm::atan2(sin, cos)
    }
}

/// An unevaluated sum of two `f64`, the second at most half a last place of the first.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Double {
    high: f64,
    low: f64,
}

/// π to 32 digits.
const PI: Double = Double::new(std::f64::consts::PI, 1.224_646_799_147_353_2e-16);

fn two_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    let part = high - a;
    Double::new(high, (a - (high - part)) + (b - part))
}

/// Returns a sum and its rounding error, like [`two_sum`], if `a` is known to be the larger number.
fn quick_two_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    Double::new(high, b - (high - a))
}

fn two_product(a: f64, b: f64) -> Double {
    let high = a * b;
    Double::new(high, a.mul_add(b, -high))
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = two_sum(self.high, other.high);
        let low = two_sum(self.low, other.low);
        let sum = quick_two_sum(high.high, high.low + low.high);
        quick_two_sum(sum.high, sum.low + low.low)
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.high, -self.low)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        quick_two_sum(
            product.high,
            product.low + (self.high * other.low + self.low * other.high),
        )
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        // Long division with three digits of 53 bits each.
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        let third = rest.high / other.high;
        quick_two_sum(first, second) + Self::from(third)
    }
}

impl From<f64> for Double {
    /// Converts exactly this binary number. For the number that a user meant, see [`Real::decimal`].
    fn from(value: f64) -> Self {
        Self::new(value, 0.0)
    }
}

impl Real for Double {
    const ZERO: Self = Self::new(0.0, 0.0);
    const ONE: Self = Self::new(1.0, 0.0);
    const HALF: Self = Self::new(0.5, 0.0);
    // Halving is exact.
    const QUARTER_TURN: Self = Self::new(0.5 * PI.high, 0.5 * PI.low);
    const TIE: Self = Self::new(1e-20, 0.0);

    fn decimal(value: f64) -> Self {
        // The power of ten below would overflow. The error of the binary number is smaller than any tie.
        if value.abs() < 1e-200 {
            return Self::from(value);
        }
        // `{:e}` prints the shortest digits that read back as the same number: "2.35e-1".
        let text = format!("{value:e}");
        let Some((digits, exponent)) = text.split_once('e') else {
            return Self::from(value);
        };
        let places = digits
            .split_once('.')
            .map_or(0, |(_, fraction)| fraction.len());
        let (Ok(exponent), Ok(places)) = (exponent.parse::<i32>(), i32::try_from(places)) else {
            return Self::from(value);
        };
        // There are at most 17 digits, so the number is exact, and so are the powers of ten up to 10^46.
        let mut number = Self::ZERO;
        for digit in digits.bytes().filter(u8::is_ascii_digit) {
            number = number * Self::from(10.0) + Self::from(f64::from(digit - b'0'));
        }
        let number = if value < 0.0 { -number } else { number };
        let shift = exponent - places;
        let power = (0..shift.unsigned_abs()).fold(Self::ONE, |power, _| power * Self::from(10.0));
        if shift < 0 {
            number / power
        } else {
            number * power
        }
    }
    fn from_double(value: Double) -> Self {
        value
    }
    fn to_f64(self) -> f64 {
        self.high + self.low
    }
    fn whole(value: i32) -> Self {
        Self::from(f64::from(value))
    }
    fn floor(self) -> i32 {
        let floor = Real::floor(self.high);
        // A whole high part with a negative low part lies just below that whole number.
        floor.saturating_sub(i32::from(Self::whole(floor) > self))
    }
    fn cell(self) -> (usize, Self) {
        let floor = self.floor();
        (from_first(floor), Self::whole(floor))
    }
    fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        // One Newton step from the f64 root doubles its digits; a second step corrects the last ones.
        let step = |root: Self| (root + self / root) * Self::HALF;
        step(step(Self::from(self.high.sqrt())))
    }
    fn sin_cos_degrees(self) -> (Self, Self) {
        let (quarter, rest) = from_right_angle(self.high);
        let rest = Self::from(rest) + Self::from(self.low);
        turned(quarter, (rest * PI / Self::whole(180)).sin_cos())
    }
    fn angle(sin: Self, cos: Self) -> Self {
        // The error of the f64 angle is so small that it equals its own sine.
        let near = Self::from(libm::atan2(sin.high, cos.high));
        let (near_sin, near_cos) = near.sin_cos();
        near + (sin * near_cos - cos * near_sin)
    }
}

impl Double {
    const fn new(high: f64, low: f64) -> Self {
        Self { high, low }
    }

    fn sin_cos(self) -> (Self, Self) {
        // Taylor's series; the terms fall below 1e-33 before the 36th power.
        let (mut sin, mut cos, mut term) = (Self::ZERO, Self::ZERO, Self::ONE);
        for power in (0..36).step_by(2) {
            cos = cos + term;
            term = term * self / Self::whole(power + 1);
            sin = sin + term;
            term = -(term * self / Self::whole(power + 2));
        }
        (sin, cos)
    }
}
