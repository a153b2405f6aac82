//! What messages quote of their input, which may be a megabyte long: so much that it can be read.

/// No more characters of a foreign text are quoted.
const LONGEST: usize = 40;

/// A foreign text, short enough for a message.
pub(crate) fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
