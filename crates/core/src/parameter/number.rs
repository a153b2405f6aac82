//! Numbers as text: functions that read and write them in the same way in forms, flags, files and messages.

/// Reads a decimal number, ignoring spaces around it. None if the text is not a number, or the number is not finite.
pub fn read(text: &str) -> Option<f64> {
    let number = text.trim().parse::<f64>().ok();
    number.filter(|number| number.is_finite())
}

/// Formats a number with the fewest digits that read back as the same number. Numbers with many zeros are written in
/// scientific notation.
pub fn short(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 || (1e-6..1e15).contains(&size) {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
}

#[expect(clippy::cast_precision_loss, reason = "a share has no more digits")]
/// Returns a part divided by the whole; 0 if the whole is 0, as in a shard without poses.
pub fn share(part: u128, whole: u128) -> f64 {
    if whole == 0 {
        return 0.0;
    }
    part as f64 / whole as f64
}

/// Rounds a number to some decimals, so that rounding errors in the last digits neither show nor add up: 0.1 + 0.2
/// becomes 0.3. The result is never a negative zero. A number that is too large to have such decimals stays as it is.
pub fn to_decimals(value: f64, decimals: i32) -> f64 {
    // From here on, floats are whole, so neighbours of `value` are at least one unit of the last decimal apart: `value`
    // is the float nearest to the rounded number.
    const WHOLE: f64 = 9_007_199_254_740_992.0;
    let parts = 10_f64.powi(decimals);
    let scaled = value * parts;
    if scaled.abs() < WHOLE {
        scaled.round() / parts + 0.0
    } else {
        value
    }
}

/// Returns the message for text that [`read`] refuses. If a decimal comma is the reason, the message shows the right
/// spelling.
pub fn complaint(text: &str) -> String {
    // Digits that no float can hold are read as infinity.
    let is_too_large =
        |number: f64| number.is_infinite() && text.contains(|c: char| c.is_ascii_digit());
    if text.trim().parse().is_ok_and(is_too_large) {
        return "too large".to_owned();
    }
    with_point(text).map_or_else(
        || "not a number".to_owned(),
        |number| format!("not a number; write {number}"),
    )
}

/// Returns a number that was written with a decimal comma with a point instead; None for any other text.
pub(crate) fn with_point(text: &str) -> Option<String> {
    let with_point = text.trim().replace(',', ".");
    let is_number = with_point != text.trim() && read(&with_point).is_some();
    is_number.then_some(with_point)
}

/// Formats a count with its digits in groups of three.
pub fn grouped(count: impl Into<u128>) -> String {
    let digits = count.into().to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Formats a count and its noun, in the singular or the plural.
pub fn counted(count: impl Into<u128>, noun: &str) -> String {
    let count = count.into();
    let ending = match count {
        1 => "",
        _ if noun.ends_with("ch") => "es",
        _ => "s",
    };
    format!("{} {noun}{ending}", grouped(count))
}

/// Formats a time in seconds in the largest unit of which there are two or more, rounded.
pub fn time_in_words(seconds: f64) -> String {
    let units = [(86_400.0, "day"), (3600.0, "hour"), (60.0, "minute")];
    let unit = units
        .into_iter()
        .find(|(length, _)| seconds >= 2.0 * length);
    let (length, unit) = unit.unwrap_or((1.0, "second"));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number for a message"
    )]
    let count = (seconds / length).round() as u64;
    counted(count, unit)
}

/// Formats the number of taxels in which two imprints differ.
pub fn differing(taxels: impl Into<u128>) -> String {
    match taxels.into() {
        0 => "no taxels differ".to_owned(),
        1 => "1 taxel differs".to_owned(),
        taxels => format!("{} differ", counted(taxels, "taxel")),
    }
}

#[cfg(test)]
mod tests {
    use super::{counted, differing, grouped, time_in_words};
    use crate::parameter::number;

    #[test]
    fn numbers_are_read_and_written_as_people_do() {
        assert_eq!(number::read(" 1.5 "), Some(1.5));
        assert_eq!(
            (number::read("2,5"), number::read("inf"), number::read("")),
            (None, None, None)
        );
        assert_eq!(
            [16.0, -0.25, 1e300, 2.5e-9].map(number::short),
            ["16", "-0.25", "1e300", "2.5e-9"]
        );
        assert_eq!(
            [0.1 + 0.2, -1e-12, 1e300].map(|value| number::to_decimals(value, 9)),
            [0.3, 0.0, 1e300]
        );
        assert_eq!(number::to_decimals(969_838_786.727, 9), 969_838_786.727);
        assert_eq!(number::complaint("wide"), "not a number");
        assert_eq!(number::complaint("2,5"), "not a number; write 2.5");
        assert_eq!(number::complaint("1e400"), "too large");
        assert_eq!(
            [7_u32, 999, 1000, 3_600_000].map(grouped),
            ["7", "999", "1,000", "3,600,000"]
        );
        assert_eq!(
            [0_u8, 1, 200].map(|count| counted(count, "pose")),
            ["0 poses", "1 pose", "200 poses"]
        );
        assert_eq!(counted(2000_u64, "touch"), "2,000 touches");
        assert_eq!(
            [1.0, 119.4, 120.0, 7300.0].map(time_in_words),
            ["1 second", "119 seconds", "2 minutes", "2 hours"]
        );
        assert_eq!(
            [0_u8, 1, 2].map(differing),
            ["no taxels differ", "1 taxel differs", "2 taxels differ"]
        );
    }
}
