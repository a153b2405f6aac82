//! Draws a curve in a terminal, in Braille or in ASCII strokes, and the values of a frame in shades.
//!
//! ```text
//! 0.62 ⠉⠢⢄
//!         ⠈⠑⠢⢄⡀
//!    0        ⠈⠉⠒⠤
//!      0.5        2
//! ```

use taxel_core::matrix::Matrix;
use taxel_files::formats::value::{self, characters, decimal, fitting};

use crate::cli::output::charset::Charset;
use crate::cli::output::report::ruled;
use crate::tui::widget::{DotCanvas, Theme, glyph};

const SIZE: (u16, u16) = (60, 12);

/// Draws the curve through points, with both axes named. The vertical axis begins at 0, the horizontal one at the
/// first value. It is empty for a single point, and if all values are 0.
pub(crate) fn lines(y: &str, x: &str, points: &[(f64, f64)], charset: Charset) -> String {
    let over = |of: fn(&(f64, f64)) -> f64| points.iter().map(of);
    let highest = over(|point| point.1).fold(0.0, f64::max);
    let left = over(|point| point.0).fold(f64::INFINITY, f64::min);
    let right = over(|point| point.0).fold(f64::NEG_INFINITY, f64::max);
    if right <= left || highest <= 0.0 {
        return String::new();
    }
    let mut canvas = DotCanvas::new(SIZE.0, SIZE.1);
    let (width, height) = canvas.size();
    let place = |&(x, y): &(f64, f64)| {
        (
            (x - left) / (right - left) * (width - 1.0) + 0.5,
            (1.0 - y / highest) * (height - 1.0) + 0.5,
        )
    };
    for pair in points.windows(2) {
        canvas.line(place(&pair[0]), place(&pair[1]));
    }
    let mut rows = vec![vec![' '; usize::from(SIZE.0)]; usize::from(SIZE.1)];
    draw_over(&mut rows, &canvas, charset);
    let top = decimal(highest, 4);
    let margin = top.len().max(y.len());
    let mut text = format!("{y:>margin$}\n");
    for (index, row) in rows.iter().enumerate() {
        let mark = match index {
            0 => &top,
            _ if index + 1 == rows.len() => "0",
            _ => "",
        };
        let row: String = row.iter().collect();
        text += &format!("{mark:>margin$} |{}\n", row.trim_end());
    }
    let (left, right) = (decimal(left, 6), decimal(right, 6));
    let room = usize::from(SIZE.0).saturating_sub(left.len() + right.len());
    text + &format!("{:>margin$}  {left}{x:^room$}{right}\n", "")
}

/// Draws the dots of a canvas over rows of characters, as far as they reach.
pub(crate) fn draw_over(rows: &mut [Vec<char>], canvas: &DotCanvas, charset: Charset) {
    let theme = Theme::plain(charset == Charset::Ascii);
    for (column, row, dots) in canvas.characters() {
        let row = rows.get_mut(usize::from(row));
        if let Some(place) = row.and_then(|row| row.get_mut(usize::from(column))) {
            *place = glyph(&theme, dots);
        }
    }
}

/// Draws the values of all cells, with numbers of columns and rows as beside imprints, and a legend of the shades. A
/// cell of 0 or less is a dot; a cell without a value is blank.
pub(crate) fn heat_map(values: &Matrix<f64>, unit: &str, charset: Charset) -> String {
    let largest = values.values().iter().copied().fold(0.0, f64::max);
    let ascii = charset == Charset::Ascii;
    let zero = value::character(0.0, ascii);
    let map = ruled(values.size(), |column, row| {
        let shade = match values.row(row)[usize::from(column)] {
            // If no value is above 0, there is no share.
            value if value <= 0.0 => zero,
            value => value::character(value / largest, ascii),
        };
        [shade, if shade == zero { ' ' } else { shade }]
            .iter()
            .collect::<String>()
    });
    let scale: String = characters(ascii)[1..].iter().collect();
    map + &format!("0 {scale} {}{unit}\n", fitting(largest, 9))
}

#[cfg(test)]
mod tests {
    use taxel_core::sensor::MatrixSize;

    use super::*;

    #[test]
    fn a_falling_error_is_a_falling_line() {
        let points = [(0.5, 0.6), (1.0, 0.3), (2.0, 0.0)];
        let text = lines("error", "scale", &points, Charset::Ascii);
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(rows.len(), usize::from(SIZE.1) + 2, "{text}");
        assert!(text.is_ascii());
        assert!(rows[1].starts_with("  0.6 |\\"), "{text}");
        assert!(rows[12].starts_with("    0 |   "), "{text}");
        assert!(
            rows[13].trim().starts_with("0.5") && rows[13].ends_with('2'),
            "{text}"
        );
        assert_eq!(lines("error", "scale", &[(1.0, 0.5)], Charset::Ascii), "");
    }

    #[test]
    fn shades_divide_the_range_evenly() {
        let size = MatrixSize::new(6, 1).expect("an allowed size");
        let values = vec![0.0, f64::NAN, 1.0, 25.0, 26.0, 100.0];
        let values = Matrix::from_values(size, values).expect("as many");
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
