//! Puts errors of the system in the words of messages.

use std::io::{Error, ErrorKind};
use std::sync::Arc;

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

/// Returns an error of the system that nobody else holds; otherwise one of its kind with its reason.
pub(crate) fn unshared(error: Arc<Error>) -> Error {
    Arc::try_unwrap(error).unwrap_or_else(|held| Error::new(held.kind(), system_reason(&held)))
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
    fn an_error_that_is_held_elsewhere_keeps_its_kind_and_reason() {
        let error = Arc::new(Error::from_raw_os_error(21));
        let other = unshared(Arc::clone(&error));
        assert_eq!(other.kind(), ErrorKind::IsADirectory);
        assert_eq!(system_reason(&other), "it is a folder");
        assert_eq!(unshared(error).raw_os_error(), Some(21));
    }
}
