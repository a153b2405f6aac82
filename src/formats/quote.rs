//! What messages quote of JSON that is none, which may be a megabyte long: so much that it can be read.

/// A JSON error's text without its place, which is told in another way. What it quotes may be a megabyte long.
pub(super) fn message(error: &serde_json::Error) -> String {
    const LONGEST: usize = 400;
    let text = error.to_string();
    let text = without_place(&text);
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// An error's text without the place at its end.
pub(super) fn without_place(text: &str) -> &str {
    text.rfind(" at line ").map_or(text, |end| &text[..end])
}
