//! Escapes text for XML.

/// Escapes the characters that have a meaning in XML, and replaces control characters and those that XML does not
/// allow. For the content of an element and for values in double quotes.
pub fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => safe.push('\u{fffd}'),
            control if control.is_control() => safe.push('\u{fffd}'),
            other => safe.push(other),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn text_does_not_become_markup() {
        let text = "a<b> & \"c\" \u{1b}\u{ffff}é";
        assert_eq!(
            escaped(text),
            "a&lt;b&gt; &amp; &quot;c&quot; \u{fffd}\u{fffd}é"
        );
    }
}
