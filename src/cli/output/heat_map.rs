//! Draws values in shades, two characters per cell, without colours.
//! ```text
//!     0   2   4
//!  0  · · ░░░░·
//!  1  · ▒▒████░░
//!  2  · ░░████·
//! 0 ░▒▓█ 9 kPa
//! ```

use crate::cli::output::charset::Charset;
use crate::formats::value::{character, characters, fitting};
use crate::matrix::Matrix;

/// Draws the values of all cells, a line for each row, with numbers of columns and rows as beside imprints, and a
/// legend of the shades. A cell of 0 or less is a dot; a cell without a value is blank.
pub(crate) fn heat_map(values: &Matrix<f64>, unit: &str, charset: Charset) -> String {
    let largest = values.values().iter().copied().fold(0.0, f64::max);
    let ascii = charset == Charset::Ascii;
    let (zero, shades) = (character(0.0, ascii), &characters(ascii)[1..]);
    let ruler: Vec<String> = (0..values.columns())
        .step_by(2)
        .map(|column| format!("{column:<4}"))
        .collect();
    let mut text = format!("    {}\n", ruler.concat().trim_end());
    for row in 0..values.rows() {
        let mut line = format!("{row:>2}  ");
        for &value in values.row(row) {
            // If no value is above 0, there is no share.
            let shade = match value {
                value if value <= 0.0 => zero,
                value => character(value / largest, ascii),
            };
            line.extend([shade, if shade == zero { ' ' } else { shade }]);
        }
        text += line.trim_end();
        text.push('\n');
    }
    let scale: String = shades.iter().collect();
    text + &format!("0 {scale} {}{unit}\n", fitting(largest, 9))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::MatrixSize;

    #[test]
    fn shades_divide_the_range_evenly() {
        let mut values = Matrix::filled(MatrixSize::new(6, 1).expect("an allowed size"), 0.0);
        values
            .values_mut()
            .copy_from_slice(&[0.0, f64::NAN, 1.0, 25.0, 26.0, 100.0]);
        assert_eq!(
            heat_map(&values, " kPa", Charset::Unicode),
            "    0   2   4\n 0  ·   ░░░░▒▒██\n0 ░▒▓█ 100 kPa\n"
        );
        assert_eq!(
            heat_map(&values, "", Charset::Ascii),
            "    0   2   4\n 0  .   ::--==@@\n0 :-=+*#%@ 100\n"
        );
    }
}
