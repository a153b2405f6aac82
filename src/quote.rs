//! Foreign text in messages, which may be a megabyte long: so much of it that it can be read.

/// A foreign text, short enough to be quoted inside of a message: 40 characters at most.
pub(crate) fn shortened(text: &str) -> String {
    cut(text, 40)
}

/// A message that quotes foreign text in full, at a length that can be read: 400 characters at most.
#[cfg(feature = "json")]
pub(crate) fn legible(message: &str) -> String {
    cut(message, 400)
}

fn cut(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
