//! Descriptor values as people read them: at most four decimals, shares in percent, directions in degrees.

use taxel_core::description::{Dimension, Value};
use taxel_core::recognition::{AngleEstimate, PoseEstimate};

pub use taxel_core::parameter::number::{counted, grouped, time_in_words};

/// Formats a value; None if the value does not exist.
///
/// ```
/// use taxel_core::description::{Dimension, Value};
/// use taxel_files::formats::value::text;
/// assert_eq!(text(Value::Number(9.0 / 14.0), Dimension::Share).as_deref(), Some("64.29 %"));
/// assert_eq!(text(Value::Number(5.5), Dimension::Length).as_deref(), Some("5.5"));
/// assert_eq!(text(Value::None, Dimension::Length), None);
/// ```
pub fn text(value: Value, unit: Dimension) -> Option<String> {
    match unit {
        Dimension::Direction => times(value, 1.0, 2).map(|text| format!("{text}°")),
        Dimension::Share => times(value, 100.0, 2).map(|text| format!("{text} %")),
        _ => times(value, 1.0, 4),
    }
}

/// Formats a length in mm or an area in mm²; None for any other dimension, or if the value does not exist.
pub fn in_millimetres(value: Value, unit: Dimension, pitch_mm: f64) -> Option<String> {
    match unit {
        Dimension::Length => times(value, pitch_mm, 4).map(|text| format!("{text} mm")),
        Dimension::Area => times(value, pitch_mm * pitch_mm, 4).map(|text| format!("{text} mm²")),
        _ => None,
    }
}

/// Formats the numbers of a value times a factor, with at most `decimals` decimals, or as many more as a factor below 1
/// takes away; None if the value does not exist.
///
/// ```
/// use taxel_core::description::Value;
/// use taxel_files::formats::value::times;
/// assert_eq!([0.5, 1e-4].map(|pitch| times(Value::Number(3.25), pitch, 4).unwrap()), ["1.625", "0.000325"]);
/// ```
pub fn times(value: Value, factor: f64, decimals: usize) -> Option<String> {
    let lost = (1..=12).take_while(|&power| factor <= 1.0 / 10_f64.powi(power));
    let decimals = decimals + lost.count();
    let number = |number: f64| decimal(number * factor, decimals);
    match value {
        Value::None => None,
        Value::Count(count) => Some(number(f64::from(count))),
        Value::Number(value) => Some(number(value)),
        Value::Point(point) => Some(format!("{}, {}", number(point.x), number(point.y))),
        Value::Pair([first, second]) => Some(format!("{}, {}", number(first), number(second))),
        Value::Rect(rect) => {
            let sides = [rect.left, rect.right, rect.top, rect.bottom];
            let [left, right, top, bottom] = sides.map(|side| number(side.into()));
            Some(format!("{left}..{right} × {top}..{bottom}"))
        }
    }
}

/// Formats a number with as many decimals as fit into `width` characters, at most four, without trailing zeros. The
/// text is longer if even the whole number does not fit.
///
/// ```
/// use taxel_files::formats::value::fitting;
/// assert_eq!([23.656_854, 123.456_78, 131_072.5].map(|number| fitting(number, 7)), ["23.6569", "123.457", "131072"]);
/// ```
pub fn fitting(number: f64, width: usize) -> String {
    let mut texts = (1..=4).rev().map(|decimals| decimal(number, decimals));
    let fits = texts.find(|text| text.len() <= width);
    fits.unwrap_or_else(|| decimal(number, 0))
}

/// Formats a measured value, like [`fitting`]. A value nearer to 0 than 0.01 gets three significant digits;
/// if these do not fit, a power of ten with as many digits as fit; and if no power of ten fits, "0".
///
/// ```
/// use taxel_files::formats::value::measured;
/// assert_eq!([23.656_854, 0.000_55, 5.5e-7].map(|number| measured(number, 7)), ["23.6569", "0.00055", "5.5e-7"]);
/// assert_eq!([0.5, 0.005_7, 5.5e-10].map(|number| measured(number, 4)), ["0.5", "6e-3", "0"]);
/// ```
pub fn measured(number: f64, width: usize) -> String {
    let size = number.abs();
    if !(f64::MIN_POSITIVE..0.01).contains(&size) {
        return fitting(number, width);
    }
    let rounded = |digits: usize| {
        let text = format!("{number:.digits$e}");
        text.parse::<f64>().unwrap_or(number)
    };
    let powers = [2, 1, 0].map(|digits| format!("{:e}", rounded(digits)));
    let mut texts = std::iter::once(rounded(2).to_string()).chain(powers);
    let fits = texts.find(|text| text.len() <= width);
    fits.unwrap_or_else(|| fitting(number, width))
}

/// Formats a share as percent, with one decimal. A share that is not exactly 0 or 1 is not shown as 0 or 100 %.
///
/// ```
/// use taxel_files::formats::value::percent;
/// assert_eq!([0.0, 1e-5, 0.984, 0.9999, 1.0].map(percent), ["0.0 %", "<0.1 %", "98.4 %", ">99.9 %", "100.0 %"]);
/// ```
pub fn percent(share: f64) -> String {
    format!("{} %", percentage(share, 1))
}

/// Formats a share as a number of percent, with this number of decimals. A share that is not exactly 0 or 1 is not shown
/// as 0 or 100.
///
/// ```
/// use taxel_files::formats::value::percentage;
/// assert_eq!([0.0, 1e-5, 0.5, 0.99999, 1.0].map(|share| percentage(share, 2)), ["0.00", "<0.01", "50.00", ">99.99", "100.00"]);
/// assert_eq!([0.0, 0.004, 0.5, 0.996, 1.0].map(|share| percentage(share, 0)), ["0", "<1", "50", ">99", "100"]);
/// ```
pub fn percentage(share: f64, decimals: usize) -> String {
    let [text, none, all] =
        [100.0 * share, 0.0, 100.0].map(|percent| format!("{percent:.decimals$}"));
    if share > 0.0 && text == none {
        format!("<{}", last_place(decimals))
    } else if share < 1.0 && text == all {
        let nines = format!(">99.{}", "9".repeat(decimals));
        nines.trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// The smallest number above 0 with that many decimals.
fn last_place(decimals: usize) -> String {
    match decimals {
        0 => "1".to_owned(),
        _ => format!("0.{:0>decimals$}", 1),
    }
}

/// Formats a number with at most `decimals` decimals, without trailing zeros, and without a minus before a zero.
pub fn decimal(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" { "0" } else { text }.to_owned()
}

/// Formats a standard deviation with at most `decimals` decimals. If it would be rounded to 0, the text says that it
/// is less than one in the last decimal: `<0.01`.
///
/// ```
/// use taxel_files::formats::value::deviation;
/// assert_eq!([0.0, 0.0049, 0.006, 1.5].map(|spread| deviation(spread, 2)), ["0", "<0.01", "0.01", "1.5"]);
/// assert_eq!((deviation(0.04, 1), deviation(0.3, 0)), ("<0.1".to_owned(), "<1".to_owned()));
/// ```
pub fn deviation(number: f64, decimals: usize) -> String {
    match decimal(number, decimals) {
        zero if zero == "0" && number > 0.0 => format!("<{}", last_place(decimals)),
        text => text,
    }
}

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

/// Returns a line of comma-separated values. A field with a comma, a quotation mark or a line break is quoted (RFC 4180).
pub fn csv_line(fields: impl IntoIterator<Item: AsRef<str>>) -> String {
    let quoted = fields.into_iter().map(|field| {
        let field = field.as_ref();
        if field.contains([',', '"', '\r', '\n']) {
            format!("\"{}\"", field.replace('"', "\"\""))
        } else {
            field.to_owned()
        }
    });
    quoted.collect::<Vec<_>>().join(",") + "\n"
}

/// Escapes the characters that have a meaning in XML, and replaces control characters and those that XML does not
/// allow. For the content of an element and for values in double quotes.
pub fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' | '\0'..='\x1f' | '\x7f'..='\u{9f}' => safe.push('\u{fffd}'),
            other => safe.push(other),
        }
    }
    safe
}

/// Returns x and y of the centre, each with its standard deviation, multiplied by `factor`: 1 for cells, the pitch
/// for mm. Decimals are never dropped, so that lines keep their width while a shape is moved.
pub fn pose_centre(pose: &PoseEstimate, factor: f64) -> String {
    let ([x, y], [dx, dy]) = (pose.position, pose.standard_deviation);
    let of = |at: f64, spread: f64| {
        let spread = pose_spread(spread * factor, 2);
        format!("{:.2} ± {spread}", at * factor)
    };
    format!("{}, {}", of(x, dx), of(y, dy))
}

/// Formats a standard deviation with all its decimals.
pub fn pose_spread(number: f64, decimals: usize) -> String {
    match deviation(number, decimals) {
        little if little.starts_with('<') => little,
        _ => format!("{number:.decimals$}"),
    }
}

/// Returns after how many degrees the shape looks the same, in brackets after a space; empty for a full turn.
pub fn pose_repeats(angle: &AngleEstimate) -> String {
    match decimal(angle.period, 2) {
        turn if turn == "360" => String::new(),
        period => format!(" (repeats every {period}°)"),
    }
}

/// Returns the fewest whole degrees that hold 95 % of the poses, as in `95 % of 66 poses: 27°..32°`: the first and the
/// last degree, or the only one.
pub fn pose_arc(angle: &AngleEstimate, poses: u64) -> String {
    let poses = counted(poses, "pose");
    match angle.ends() {
        (first, last) if first == last => format!("95 % of {poses}: {first}°"),
        (first, last) => format!("95 % of {poses}: {first}°..{last}°"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_more_decimals_than_they_need() {
        let shown =
            [0.0, -0.000_01, 10.0, 23.656_854, -0.5, 1234.0].map(|number| decimal(number, 4));
        assert_eq!(shown, ["0", "0", "10", "23.6569", "-0.5", "1234"]);
        assert_eq!(decimal(100.0, 0), "100");
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

    #[test]
    fn text_does_not_become_markup() {
        let text = "a<b> & \"c\" \u{1b}\u{ffff}é";
        assert_eq!(
            escaped(text),
            "a&lt;b&gt; &amp; &quot;c&quot; \u{fffd}\u{fffd}é"
        );
    }

    fn angle(shortest_arc: (u32, u32)) -> AngleEstimate {
        AngleEstimate {
            period: 180.0,
            mean: Some(27.0),
            standard_deviation: Some(0.0),
            shortest_arc,
        }
    }

    #[test]
    fn a_single_degree_is_written_once() {
        let arcs = [(27, 1), (27, 6), (178, 5)].map(|degrees| pose_arc(&angle(degrees), 66));
        assert_eq!(
            arcs,
            [
                "95 % of 66 poses: 27°",
                "95 % of 66 poses: 27°..32°",
                "95 % of 66 poses: -2°..2°"
            ]
        );
    }

    #[test]
    fn each_coordinate_has_its_deviation() {
        let pose = PoseEstimate {
            poses: 2,
            position: [3.0, 2.5],
            standard_deviation: [0.125, 0.001],
            angle: None,
        };
        assert_eq!(pose_centre(&pose, 1.0), "3.00 ± 0.12, 2.50 ± <0.01");
        assert_eq!(pose_centre(&pose, 2.0), "6.00 ± 0.25, 5.00 ± <0.01");
    }
}
