//! The exact values of descriptors, by which they are compared.

/// The value of a descriptor as whole numbers, so that equal values compare as equal: ratios in lowest terms, lengths
/// as numbers of steps. None if the value does not exist.
pub type ExactValue = Option<[i64; 4]>;

pub(super) fn whole<const N: usize>(numbers: [u32; N]) -> [i64; 4] {
    let mut exact = [0; 4];
    for (slot, number) in exact.iter_mut().zip(numbers) {
        *slot = i64::from(number);
    }
    exact
}

/// Returns two ratios with the same positive denominator, each in lowest terms.
pub(super) fn ratios(numerators: [i64; 2], denominator: i64) -> [i64; 4] {
    let [one, other] = numerators.map(|numerator| {
        // The divisor is 0 only if fields of the description were changed.
        let common = gcd(numerator.unsigned_abs(), denominator.unsigned_abs()).max(1);
        [numerator / common, denominator / common]
    });
    [one[0], one[1], other[0], other[1]]
}

/// Returns the direction of a vector in lowest terms; None if its length is 0.
pub(super) fn direction([x, y]: [i64; 2]) -> ExactValue {
    let common = gcd(x.unsigned_abs(), y.unsigned_abs());
    (common > 0).then(|| [x / common, y / common, 0, 0])
}

/// Returns the greatest common divisor of numbers far below 2⁶³; 0 for two zeros.
fn gcd(one: u64, other: u64) -> i64 {
    let (mut one, mut other) = (one, other);
    while other > 0 {
        (one, other) = (other, one % other);
    }
    one.cast_signed()
}
