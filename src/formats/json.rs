//! Values as JSON text, and the messages of its parser without the position that callers report themselves.

use serde::Serialize;

use crate::quote::legible;

/// A value on one line.
#[cfg(feature = "tui")]
pub(crate) fn text(value: &(impl Serialize + ?Sized)) -> String {
    serde_json::to_string(value).unwrap_or_else(|error| failure(&error))
}

/// A value over several lines.
pub(crate) fn pretty(value: &(impl Serialize + ?Sized)) -> String {
    serde_json::to_string_pretty(value).unwrap_or_else(|error| failure(&error))
}

/// What is written for a value that has no JSON form. All of ours have one: their keys are texts and their numbers
/// finite. Should one not, the error stands in its place, as in the answers of a batch, and is not mistaken for an
/// empty answer.
fn failure(error: &serde_json::Error) -> String {
    format!("{{\"error\":{:?}}}", error.to_string())
}

/// A JSON error's text without its position.
pub(crate) fn message(error: &serde_json::Error) -> String {
    legible(without_position(&error.to_string()))
}

/// An error's text without the position at its end.
pub(crate) fn without_position(text: &str) -> &str {
    text.rfind(" at line ").map_or(text, |end| &text[..end])
}

#[cfg(all(test, feature = "tui"))]
mod tests {
    use super::*;

    #[test]
    fn a_value_without_a_json_form_is_an_error_object() {
        let no_text_key = std::collections::BTreeMap::from([((1, 2), 3)]);
        assert_eq!(text(&no_text_key), r#"{"error":"key must be a string"}"#);
        assert_eq!(text(&[1, 2]), "[1,2]");
    }
}
