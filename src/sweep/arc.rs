//! The angle of a sine and a cosine, three times as fast as the arc tangent of the two: areas of arcs need nothing else.

use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

/// Sines, cosines and angles of the places from which [`angle`] goes on.
static ANGLES: LazyLock<[[f64; 3]; 25]> = LazyLock::new(|| {
    std::array::from_fn(|index| {
        let sine = f64::from(u32::try_from(index).unwrap_or(0)) / 32.0;
        [sine, ((1.0 - sine) * (1.0 + sine)).sqrt(), sine.asin()]
    })
});

/// The angle in [−π/2, π/2] of a sine, given with its cosine, which is not negative; error below 1e-15.
///
/// The arc sine alone would lose half of the digits at the ends. The smaller of the two numbers is the sine of an angle
/// `a` up to π/4; with `b` the nearest one in the table, `sin(a − b) = sin a · cos b − cos a · sin b` is below 0.023, where
/// four terms of the arc sine's series are enough.
pub(super) fn angle(sine: f64, cosine: f64) -> f64 {
    let steep = sine.abs() > cosine;
    let (small, large) = if steep {
        (cosine, sine.abs())
    } else {
        (sine.abs(), cosine)
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 to 23: the smaller of a sine and a cosine is at most 0.708"
    )]
    let index = (small * 32.0 + 0.5) as usize;
    let [near_sine, near_cosine, near] = ANGLES[index.min(24)];
    let apart = small * near_cosine - large * near_sine;
    let square = apart * apart;
    let series = square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * (15.0 / 336.0)));
    let angle = near + apart + apart * series;
    let angle = if steep { FRAC_PI_2 - angle } else { angle };
    angle.copysign(sine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_arc_tangent() {
        for step in -1000..=1000 {
            let expected = f64::from(step) / 1000.0 * FRAC_PI_2;
            let found = angle(expected.sin(), expected.cos().max(0.0));
            assert!((found - expected).abs() < 1e-15, "{found}, {expected}");
        }
    }
}
