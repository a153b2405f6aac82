//! What all files have in common: the system's errors in words, the byte order mark, the ending of a name.

use std::io::{Error, ErrorKind};
use std::path::Path;

/// Returns the reason of the system for refusing something, without the number of the error. Files and folders are
/// called so, not directories.
pub fn system_reason(error: &Error) -> String {
    let Some(number) = error.raw_os_error() else {
        return error.to_string();
    };
    match error.kind() {
        ErrorKind::NotFound => "no such file or folder".to_owned(),
        ErrorKind::IsADirectory => "it is a folder".to_owned(),
        ErrorKind::NotADirectory => "not a folder".to_owned(),
        _ => {
            let text = error.to_string();
            let number = format!(" (os error {number})");
            text.strip_suffix(&number).unwrap_or(&text).to_owned()
        }
    }
}

/// Returns true if a file does not exist, also because a file is where its folder is expected.
pub fn is_missing(error: &Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// Returns the reason of the system for refusing to write a file. If it does not find the file, its folder is missing.
pub fn write_reason(error: &Error) -> String {
    match error.kind() {
        ErrorKind::NotFound if error.raw_os_error().is_some() => "no such folder".to_owned(),
        _ => system_reason(error),
    }
}

pub(crate) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Returns a text without the mark at its start, if it has one.
pub fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text)
}

/// Returns true if a file's name has this extension, in upper or lower case. The rest of the name need not be UTF-8.
pub fn has_ending(path: impl AsRef<Path>, ending: &str) -> bool {
    let own = path.as_ref().extension();
    own.is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_reason_has_no_number() {
        let reasons = |number| {
            let error = Error::from_raw_os_error(number);
            [system_reason(&error), write_reason(&error)]
        };
        assert_eq!(reasons(2), ["no such file or folder", "no such folder"]);
        assert_eq!(reasons(21), ["it is a folder"; 2]);
        assert_eq!(reasons(28), ["No space left on device"; 2]);
        let own = Error::other("the disk does not answer");
        assert_eq!(system_reason(&own), "the disk does not answer");
    }

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

    #[test]
    fn an_ending_is_found_in_upper_and_lower_case() {
        assert!(has_ending("a.csv", "csv") && has_ending("a/b.c.CSV", "csv"));
        assert!(
            !has_ending("csv", "csv")
                && !has_ending(".csv", "csv")
                && !has_ending("a.csv.gz", "csv")
        );
    }
}
