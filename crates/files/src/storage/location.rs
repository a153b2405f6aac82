//! The location of the library.

use std::ffi::OsString;
use std::path::PathBuf;

use crate::storage::LibraryError;

/// The environment variable that names the folder.
pub const VARIABLE: &str = "TAXEL_LIBRARY";

/// The folder: the one asked for, else that of the variable, else `taxel/library` in the user's data folder.
///
/// # Errors
/// Returns [`LibraryError::NoPlace`] if there is none of these.
pub fn folder(asked: Option<PathBuf>, variable: Option<OsString>) -> Result<PathBuf, LibraryError> {
    let named = asked.or_else(|| {
        variable
            .filter(|value| !value.is_empty())
            .map(PathBuf::from)
    });
    let own = || {
        directories::ProjectDirs::from("", "", "taxel").map(|own| own.data_dir().join("library"))
    };
    named.or_else(own).ok_or(LibraryError::NoPlace)
}

/// Replaces `~/` at the start of a path by the user's home folder; None if that is not known.
pub fn below_home(path: &str) -> Option<PathBuf> {
    match path.strip_prefix("~/") {
        Some(rest) => directories::BaseDirs::new().map(|own| own.home_dir().join(rest)),
        None => Some(PathBuf::from(path)),
    }
}
