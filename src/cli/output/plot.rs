//! Draws a curve in a terminal, in Braille or in ASCII strokes.
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
use crate::tui::widget::plot::{DOTS, DotCanvas, glyph};
use crate::tui::widget::theme::Theme;

const SIZE: (u16, u16) = (60, 12);

/// Draws the curve through points, with both axes named. The vertical axis begins at 0, the horizontal one at the
/// first value. It is empty for a single point, and if all values are 0.
pub(crate) fn lines(y: &str, x: &str, points: &[(f64, f64)], charset: Charset) -> String {
    let over = |of: fn(&(f64, f64)) -> f64| points.iter().map(of);
    let highest = over(|point| point.1).fold(0.0, f64::max);
    let left = over(|point| point.0).fold(f64::INFINITY, f64::min);
    let right = over(|point| point.0).fold(f64::NEG_INFINITY, f64::max);
    if points.is_empty() || right <= left || highest <= 0.0 {
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
    let rows = drawn(&canvas, charset);
    let (top, bottom) = (decimal(highest, 4), "0");
    let margin = top.len().max(y.len());
    let mut text = format!("{y:>margin$}\n");
    for (index, row) in rows.iter().enumerate() {
        let mark = match index {
            0 => top.as_str(),
            _ if index + 1 == rows.len() => bottom,
            _ => "",
        };
        text += &format!("{mark:>margin$} |{}\n", row.trim_end());
    }
    let (left, right) = (decimal(left, 6), decimal(right, 6));
    let room = usize::from(SIZE.0).saturating_sub(left.len() + right.len());
    let axis = format!("{left}{x:^room$}{right}");
    text + &format!("{:>margin$}  {}\n", "", axis)
}

fn drawn(canvas: &DotCanvas, charset: Charset) -> Vec<String> {
    let mut rows = vec![vec![' '; usize::from(SIZE.0)]; usize::from(SIZE.1)];
    for (column, row, dots) in canvas.characters() {
        rows[usize::from(row)][usize::from(column)] = character(dots, charset);
    }
    rows.into_iter()
        .map(|row| row.into_iter().collect())
        .collect()
}

pub(crate) fn character(dots: u8, charset: Charset) -> char {
    glyph(&Theme::plain(charset == Charset::Ascii), dots)
}

pub(crate) fn canvas_of_taxels(columns: u8, rows: u8) -> DotCanvas {
    let across = u16::from(columns) * (4 / DOTS.0);
    let down = u16::from(rows) * (4 / DOTS.1);
    DotCanvas::new(across, down)
}

/// Draws the values of all cells, a line for each row, with numbers of columns and rows as beside imprints, and a
/// legend of the shades. A cell of 0 or less is a dot; a cell without a value is blank.
pub(crate) fn heat_map(values: &Matrix<f64>, unit: &str, charset: Charset) -> String {
    let largest = values.values().iter().copied().fold(0.0, f64::max);
    let ascii = charset == Charset::Ascii;
    let (zero, shades) = (value::character(0.0, ascii), &characters(ascii)[1..]);
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
                value => value::character(value / largest, ascii),
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
        assert!(rows[1].len() < rows[12].len(), "{text}");
        let braille = |sign: char| ('\u{2801}'..'\u{2900}').contains(&sign);
        let dotted = lines("error", "scale", &points, Charset::Unicode);
        assert!(
            dotted.chars().filter(|&sign| braille(sign)).count() > 50,
            "{dotted}"
        );
        assert_eq!(lines("error", "scale", &[(1.0, 0.5)], Charset::Ascii), "");
    }

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
