//! Descriptor values as people read them: at most four decimals, shares in percent, directions in degrees.

use crate::description::{Dimension, Value};

pub use crate::parameter::number::{counted, grouped, time_in_words};

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
    let lost = [
        1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12,
    ];
    let lost = lost.into_iter().take_while(|&power| factor <= power);
    let decimals = decimals + lost.count();
    let number = |number: f64| decimal(number * factor, decimals);
    match value {
        Value::None => None,
        Value::Count(count) => Some(number(f64::from(count))),
        Value::Number(value) => Some(number(value)),
        Value::Point(point) => Some(format!("{}, {}", number(point.x), number(point.y))),
        Value::Pair([first, second]) => Some(format!("{}, {}", number(first), number(second))),
        Value::Rect(rect) => {
            let side = |low: u8, high: u8| {
                format!("{}..{}", number(f64::from(low)), number(f64::from(high)))
            };
            Some(format!(
                "{} × {}",
                side(rect.left, rect.right),
                side(rect.top, rect.bottom)
            ))
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
    let texts = (0..=4).rev().map(|decimals| decimal(number, decimals));
    texts
        .into_iter()
        .find(|text| text.len() <= width)
        .unwrap_or_else(|| decimal(number, 0))
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
    std::iter::once(rounded(2).to_string())
        .chain(powers)
        .find(|text| text.len() <= width)
        .unwrap_or_else(|| fitting(number, width))
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

/// Formats a share as a number of percent, with this number of decimals, at most 1,074. A share that is not exactly 0 or
/// 1 is not shown as 0 or 100.
///
/// ```
/// use taxel_files::formats::value::percentage;
/// assert_eq!([0.0, 1e-5, 0.5, 0.99999, 1.0].map(|share| percentage(share, 2)), ["0.00", "<0.01", "50.00", ">99.99", "100.00"]);
/// assert_eq!([0.0, 0.004, 0.5, 0.996, 1.0].map(|share| percentage(share, 0)), ["0", "<1", "50", ">99", "100"]);
/// ```
pub fn percentage(share: f64, decimals: usize) -> String {
    let decimals = decimals.min(MOST_DECIMALS);
    let text = format!("{:.decimals$}", share * 100.0);
    let is_shown_as = |percent: f64| text == format!("{percent:.decimals$}");
    if share > 0.0 && is_shown_as(0.0) {
        match decimals {
            0 => "<1".to_owned(),
            _ => format!("<0.{:0>decimals$}", 1),
        }
    } else if share < 1.0 && is_shown_as(100.0) {
        match decimals {
            0 => ">99".to_owned(),
            _ => format!(">99.{}", "9".repeat(decimals)),
        }
    } else {
        text
    }
}

/// The number of decimals of the smallest positive f64.
const MOST_DECIMALS: usize = 1074;

/// Formats a number with at most `decimals` decimals, without trailing zeros, and without a minus before a zero.
pub fn decimal(number: f64, decimals: usize) -> String {
    // No number has more decimals, and a format string takes no more than 65,535.
    let decimals = decimals.min(MOST_DECIMALS);
    let text = format!("{number:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

/// Formats a standard deviation with at most `decimals` decimals. If it would be rounded to 0, the text says that it
/// is less than one in the last decimal: `<0.01`.
///
/// ```
/// use taxel_files::formats::value::deviation;
/// assert_eq!([0.0, 0.004, 0.5].map(|spread| deviation(spread, 2)), ["0", "<0.01", "0.5"]);
/// ```
pub fn deviation(number: f64, decimals: usize) -> String {
    match decimal(number, decimals) {
        zero if zero == "0" && number > 0.0 => match decimals {
            0 => "<1".to_owned(),
            _ => format!("<0.{:0>width$}", 1, width = decimals.min(MOST_DECIMALS)),
        },
        text => text,
    }
}

#[cfg(test)]
mod tests {
    use super::{decimal, deviation, percentage};

    #[test]
    fn a_deviation_above_0_does_not_look_like_0() {
        let shown = [0.0, 0.0049, 0.006, 1.5].map(|number| deviation(number, 2));
        assert_eq!(shown, ["0", "<0.01", "0.01", "1.5"]);
        assert_eq!(
            (deviation(0.04, 1), deviation(0.3, 0)),
            ("<0.1".into(), "<1".into())
        );
    }

    #[test]
    fn any_number_of_decimals_can_be_asked_for() {
        for decimals in [1074, 65_536, usize::MAX] {
            assert_eq!(decimal(0.25, decimals), "0.25");
            assert_eq!(deviation(0.25, decimals), "0.25");
            assert_eq!(decimal(5e-324, decimals).len(), 2 + 1074);
            assert_eq!(percentage(0.5, decimals).len(), 3 + 1074);
        }
    }

    #[test]
    fn numbers_have_no_more_decimals_than_they_need() {
        let shown =
            [0.0, -0.000_01, 10.0, 23.656_854, -0.5, 1234.0].map(|number| decimal(number, 4));
        assert_eq!(shown, ["0", "0", "10", "23.6569", "-0.5", "1234"]);
        assert_eq!(decimal(100.0, 0), "100");
    }
}
