//! Numbers as text: one way to read them and one to show them, for forms, flags, files and messages.

/// The number in a text, spaces around it aside; none where it is no decimal number or not finite.
///
/// ```
/// use taxel::parameter::number::read;
/// assert_eq!(read(" 1.5 "), Some(1.5));
/// assert_eq!((read("2,5"), read("inf"), read("")), (None, None, None));
/// ```
pub fn read(text: &str) -> Option<f64> {
    let number = text.trim().parse::<f64>().ok();
    number.filter(|number| number.is_finite())
}

/// A number with as few digits as tell it from all others, and in powers of ten where it has many zeros.
///
/// ```
/// use taxel::parameter::number::short;
/// assert_eq!([16.0, -0.25, 1e300, 2.5e-9].map(short), ["16", "-0.25", "1e300", "2.5e-9"]);
/// ```
pub fn short(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 || (1e-6..1e15).contains(&size) {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
}

/// What is said of a text that is no number; of one that would be with a decimal point, how to write it.
///
/// ```
/// use taxel::parameter::number::complaint;
/// assert_eq!(complaint("wide"), "not a number");
/// assert_eq!(complaint("2,5"), "not a number; write 2.5");
/// ```
pub fn complaint(text: &str) -> String {
    let with_point = text.trim().replace(',', ".");
    match read(&with_point) {
        Some(_) if with_point != text.trim() => format!("not a number; write {with_point}"),
        _ => "not a number".to_owned(),
    }
}
