//! Numbers of things on the screen: in the integer types of the terminal and of the matrix, and in circles.

/// A number of columns or lines of the screen, or the largest that a screen can have.
pub(in crate::tui) fn narrow(length: impl TryInto<u16>) -> u16 {
    length.try_into().unwrap_or(u16::MAX)
}

/// A number of taxels, or more than any matrix has.
pub(in crate::tui) fn taxels(length: impl TryInto<u8>) -> u8 {
    length.try_into().unwrap_or(u8::MAX)
}

/// The index `by` steps after `now` (before it if negative) among `count`, which must not be 0. The first follows the
/// last.
///
/// ```
/// use taxel::tui::widget::number::around;
/// assert_eq!([around(3, 1, 4), around(0, -1, 4), around(1, 6, 4)], [0, 3, 3]);
/// ```
pub fn around(now: usize, by: i8, count: usize) -> usize {
    let forward = usize::from(by.unsigned_abs()) % count;
    let step = if by < 0 { count - forward } else { forward };
    (now + step) % count
}
