//! Sines, cosines and angles in `f64`, in radians. They use only arithmetic, so they are the same on every machine.
//!
//! The functions use tables, and Taylor series for the small rest. Errors stay below 5e-16.

use std::f64::consts::FRAC_PI_2;

/// Returns the sine and the cosine of an angle: whole degrees from 0 to 360, plus a rest of at most half a degree, in
/// radians. They are exactly 0 and ±1 at multiples of 90°.
///
/// A table has those of whole degrees; the rest is so small that short series are enough.
pub(crate) fn sin_cos(degrees: i32, rest: f64) -> (f64, f64) {
    #[expect(clippy::cast_sign_loss, reason = "0 to 360")]
    let (sin, cos) = WHOLE_DEGREES[degrees as usize % WHOLE_DEGREES.len()];
    // Since |rest| < 0.009, the next terms are below 1e-18.
    let square = rest * rest;
    let rest_sin = rest + rest * square * (square * (1.0 / 120.0) - 1.0 / 6.0);
    let rest_cos_less_1 = square * (square * (1.0 / 24.0 - square * (1.0 / 720.0)) - 0.5);
    (
        sin + (cos * rest_sin + sin * rest_cos_less_1),
        cos + (cos * rest_cos_less_1 - sin * rest_sin),
    )
}

/// The sines and cosines of whole degrees, from 0 to 360. The rest of the table lets nine bits index it.
static WHOLE_DEGREES: [(f64, f64); 512] = whole_degrees();

const fn whole_degrees() -> [(f64, f64); 512] {
    let mut table = [(0.0, 1.0); 512];
    let mut degrees = 0_u16;
    while degrees <= 360 {
        let quarter = (degrees + 45) / 90;
        let rest = degrees as f64 - 90.0 * quarter as f64;
        let Node { sin, cos, .. } = Node::at(rest.to_radians());
        table[degrees as usize] = match quarter {
            0 | 4 => (sin, cos),
            1 => (cos, 0.0 - sin),
            2 => (0.0 - sin, 0.0 - cos),
            _ => (0.0 - cos, sin),
        };
        degrees += 1;
    }
    table
}

/// Returns the angle with this sine and this cosine, from −π/2 to π/2: the cosine is not negative.
///
/// The angle is first turned back by a nearly equal angle from a table; the rest is so small that its arc sine is a
/// short series. The sine selects the entry of the table, so that nothing has to wait for the cosine, which is often a
/// root still being computed.
pub(crate) fn angle(sin: f64, cos: f64) -> f64 {
    let size = sin.abs();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 to 64"
    )]
    let number = (size * 64.0) as i32 as usize;
    let Node {
        sin: node_sin,
        cos: node_cos,
        angle,
    } = NODES[number % NODES.len()];
    let rest = size * node_cos - cos * node_sin;
    // Since |rest| < 0.09, the next term is below 3e-18. Terms are added in pairs, so that a processor can work on
    // several at once.
    let square = rest * rest;
    let fourth = square * square;
    let low = 1.0 / 6.0 + square * (3.0 / 40.0);
    let middle = 5.0 / 112.0 + square * (35.0 / 1152.0);
    let high = 63.0 / 2816.0 + square * (231.0 / 13312.0);
    let series = low + fourth * (middle + fourth * high);
    (angle + (rest + rest * square * series)).copysign(sin)
}

/// An angle of the table.
#[derive(Clone, Copy)]
struct Node {
    sin: f64,
    cos: f64,
    angle: f64,
}

/// The table of angles. Entry n below 64 is the angle halfway between the arc sines of n/64 and (n+1)/64. All others
/// are a right angle: entry 64 is for a sine of 1, and the rest lets seven bits index the table.
static NODES: [Node; 128] = nodes();

const fn nodes() -> [Node; 128] {
    let mut nodes = [Node::at(FRAC_PI_2); 128];
    let (mut number, mut sine, mut from) = (0, 0.0, 0.0);
    while number < 64 {
        sine += 1.0 / 64.0;
        // Newton's method. Starting at the angle of the previous, smaller sine, it never overshoots except the last
        // time, where the slope is zero.
        let (mut to, mut step) = (from, 0);
        while step < 9 && number < 63 {
            let near = Node::at(to);
            to += (sine - near.sin) / near.cos;
            step += 1;
        }
        if number == 63 {
            to = FRAC_PI_2;
        }
        nodes[number] = Node::at(f64::midpoint(from, to));
        (number, from) = (number + 1, to);
    }
    nodes
}

impl Node {
    const fn at(angle: f64) -> Self {
        let (mut sin, mut cos, mut term, mut power) = (0.0, 0.0, 1.0, 0.0);
        // From the 28th power on, terms are below 1e-23.
        while power < 28.0 {
            cos += term;
            term *= angle / (power + 1.0);
            sin += term;
            term *= -angle / (power + 2.0);
            power += 2.0;
        }
        Self { sin, cos, angle }
    }
}
