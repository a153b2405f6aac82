//! The byte order mark, with which some programs begin a text in UTF-8.

/// The bytes of the mark.
pub(crate) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Returns a text without the mark at its start, if it has one.
pub fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_whole_mark_at_the_start_is_left_out() {
        for (text, expected) in [
            ("\u{feff}1 2", &b"1 2"[..]),
            ("1\u{feff}", b"1\xef\xbb\xbf"),
            ("\u{feff}\u{feff}", b"\xef\xbb\xbf"),
        ] {
            assert_eq!(without_mark(text.as_bytes()), expected, "{text:?}");
        }
        assert_eq!(without_mark(b"\xef\xbb"), b"\xef\xbb");
    }
}
