//! What `serde_json` says, without the place that it says it of.

use crate::quote::legible;

/// A JSON error's text without its place, which is told in another way.
pub(crate) fn message(error: &serde_json::Error) -> String {
    legible(without_place(&error.to_string()))
}

/// An error's text without the place at its end.
pub(crate) fn without_place(text: &str) -> &str {
    text.rfind(" at line ").map_or(text, |end| &text[..end])
}
