//! Where the library is.

use std::ffi::OsString;
use std::path::PathBuf;

use super::error::LibraryError;

/// The variable that names the folder.
pub const VARIABLE: &str = "TAXEL_LIBRARY";

/// The folder: the one asked for, else that of the variable, else `taxel` in the user's data folder.
///
/// # Errors
/// Where there is none of these.
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
