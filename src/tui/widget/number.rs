//! Numbers for the screen: lengths in the integer types of the terminal and of the matrix, and indices and items
//! that wrap around.

pub(in crate::tui) fn narrow(length: impl TryInto<u16>) -> u16 {
    length.try_into().unwrap_or(u16::MAX)
}

pub(in crate::tui) fn taxels(length: impl TryInto<u8>) -> u8 {
    length.try_into().unwrap_or(u8::MAX)
}

/// Returns the index `by` steps after `now` (before it if negative) among `count` indices; `count` must not be 0.
/// After the last index comes the first.
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

/// Returns the item `by` places after the chosen one, or after one that `failed` when it was chosen since; after the
/// last item comes the first. An item that is no longer in the list counts as its last.
///
/// ```
/// use taxel::tui::widget::number::other;
/// let all = || vec!["one", "broken", "two"];
/// assert_eq!(other(all(), &"one", None, 1), "broken");
/// assert_eq!(other(all(), &"one", Some(&"broken"), 1), "two");
/// assert_eq!(other(all(), &"one", Some(&"broken"), -1), "two");
/// ```
pub fn other<T: PartialEq + Clone>(mut all: Vec<T>, chosen: &T, failed: Option<&T>, by: i8) -> T {
    let from = failed.unwrap_or(chosen);
    if !all.contains(from) {
        all.push(from.clone());
    }
    let before = all.iter().take_while(|item| *item != from);
    let mut next = around(before.count(), by, all.len());
    // The chosen one is there already: a step from one that failed goes past it.
    if all[next] == *chosen && from != chosen {
        next = around(next, by, all.len());
    }
    all.swap_remove(next)
}
