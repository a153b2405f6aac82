//! The shades of heat maps: one for values up to 0, the others divide the range from 0 to the largest value evenly.

/// Returns the shade of a share of the largest value, from 0 to `shades` - 1: 0 for shares up to 0 and for NaN, the
/// last one for shares of 1 and more. Upper bounds are included.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "a share above 0, up to 1, and few shades"
)]
pub fn shade(share: f64, shades: usize) -> usize {
    if share > 0.0 {
        let last = shades - 1;
        ((share.min(1.0) * last as f64).ceil() as usize).clamp(1, last)
    } else {
        0
    }
}

/// Returns the characters of the shades.
pub fn characters(ascii: bool) -> &'static [char] {
    if ascii {
        &['.', ':', '-', '=', '+', '*', '#', '%', '@']
    } else {
        &['·', '░', '▒', '▓', '█']
    }
}

/// Returns the character of a share of the largest value; a blank for NaN, a cell that does not exist.
pub fn character(share: f64, ascii: bool) -> char {
    let characters = characters(ascii);
    if share.is_nan() {
        ' '
    } else {
        characters[shade(share, characters.len())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shades_divide_the_range_evenly() {
        let shares = [f64::NAN, -1.0, 0.0, 0.01, 0.25, 0.26, 0.75, 0.76, 1.0, 9.0];
        let found = shares.map(|share| shade(share, 5));
        assert_eq!(found, [0, 0, 0, 1, 1, 2, 3, 4, 4, 4]);
    }

    #[test]
    fn each_shade_has_a_character() {
        let shown = |ascii| {
            let shares = [f64::NAN, -1.0, 0.0, 0.01, 0.25, 0.26, 0.75, 0.76, 1.0, 9.0];
            shares
                .map(|share| character(share, ascii))
                .iter()
                .collect::<String>()
        };
        assert_eq!(shown(false), " ··░░▒▓███");
        assert_eq!(shown(true), " ..:-=#%@@");
    }
}
