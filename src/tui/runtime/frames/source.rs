//! Finds out what the name of a frame source refers to, and whether it can be watched.

use std::ffi::OsStr;

use crate::acquire::FrameSource;
use crate::storage::location;
use crate::tui::runtime::disk::write_access::WriteAccess;

/// Returns the source of a name, which may begin with `~`.
pub(in crate::tui::runtime) fn named(name: &OsStr) -> FrameSource {
    let below = name.to_str().and_then(location::below_home);
    match below {
        Some(path) if name != "-" && !name.to_string_lossy().starts_with("tcp://") => {
            FrameSource::new(path.as_os_str())
        }
        _ => FrameSource::new(name),
    }
}

/// Returns the source of a name. A script from a stranger reads files only: a serial line would be set up and its
/// device reset, a connection made, a pipe waited for.
///
/// # Errors
/// Returns a sentence with the name if the source may not or cannot be read.
pub(in crate::tui::runtime) fn readable(
    name: &OsStr,
    access: &WriteAccess,
) -> Result<FrameSource, String> {
    let source = named(name);
    let refused = |reason: &dyn std::fmt::Display| format!("{}: {reason}", source.name());
    if access.is_confined() && !is_file(&source) {
        return Err(refused(
            &"without --allow-outside, a script reads frames only from files",
        ));
    }
    source.check().map_err(|error| refused(&error))?;
    Ok(source)
}

/// Returns true if the source is a file with content. Files of `/proc`, which may have to be waited for like pipes,
/// are empty. A missing file counts as a file with content: opening it reports the error.
fn is_file(source: &FrameSource) -> bool {
    match source {
        FrameSource::File(path) => path
            .metadata()
            .map_or(true, |metadata| metadata.is_file() && metadata.len() > 0),
        _ => false,
    }
}
