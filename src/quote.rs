//! Truncates untrusted text for messages. Text from files and arguments may be a megabyte long.

/// Text to be quoted inside a message: at most 40 characters, then `…`.
pub(crate) fn shortened(text: &str) -> String {
    cut(text, 40)
}

/// A message that quotes untrusted text in full: at most 400 characters, then `…`.
#[cfg(feature = "json")]
pub(crate) fn legible(message: &str) -> String {
    cut(message, 400)
}

/// The first `longest` characters of a text, with `…` behind them if there are more.
fn cut(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
