//! Finds out what the name of a frame source refers to, and whether it can be watched.

use std::fs::{self, File};
use std::io::{self, IsTerminal};
use std::os::fd::AsFd;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use taxel_files::acquire::FrameSource;
use taxel_files::formats::recording::StreamCounts;
use taxel_files::formats::value::counted;
use taxel_files::storage::below_home;
use taxel_files::{ReadError, ReadErrorKind};

use crate::tui::runtime::disk::files::WriteAccess;

/// Returns what a source refers to, in which `~` is the home folder.
pub(in crate::tui::runtime) fn found(named: &FrameSource) -> FrameSource {
    let below = match named {
        FrameSource::File(path) => path.to_str().and_then(below_home),
        _ => None,
    };
    below
        .map_or_else(|| named.clone(), FrameSource::File)
        .found()
}

/// Returns the source of a name. A script from a stranger reads files only: a serial line would be set up and its
/// device reset, a connection made, a pipe waited for.
pub(in crate::tui::runtime) fn readable(
    named: &FrameSource,
    access: &WriteAccess,
) -> Result<FrameSource, String> {
    let source = found(named);
    let refused = |reason: &dyn std::fmt::Display| format!("{}: {reason}", source.name());
    if access.folder.is_some() && !is_file(&source) {
        return Err(refused(
            &"without --allow-outside, a script reads frames only from files",
        ));
    }
    check(&source).map_err(|reason| refused(&reason))?;
    Ok(source)
}

/// Refuses a source that cannot be read even if one waits, and the terminal whose keys control the screen: its reader
/// would take half of them.
pub fn check(source: &FrameSource) -> Result<(), String> {
    let is_own_terminal = match source {
        FrameSource::Standard => io::stdin().is_terminal(),
        FrameSource::Serial(path) => is_own_terminal(path),
        _ => false,
    };
    if is_own_terminal {
        return Err("this is your terminal; pipe frames into 'taxel watch -'".to_owned());
    }
    source.check().map_err(|error| error.to_string())
}

fn is_own_terminal(path: &Path) -> bool {
    let device = |file: fs::Metadata| file.rdev();
    let Ok(own) = fs::metadata(path).map(device) else {
        return false;
    };
    let (input, output, errors) = (io::stdin(), io::stdout(), io::stderr());
    let mut streams = [input.as_fd(), output.as_fd(), errors.as_fd()].into_iter();
    let controlling = fs::metadata("/dev/tty").map(device);
    controlling.is_ok_and(|controlling| controlling == own)
        || streams.any(|stream| {
            let metadata = stream
                .try_clone_to_owned()
                .and_then(|file| File::from(file).metadata());
            stream.is_terminal() && metadata.map(device).is_ok_and(|stream| stream == own)
        })
}

/// Returns true if the source is a file with content. Files of `/proc`, which may have to be waited for like pipes,
/// are empty. A missing file and a folder count as files with content: opening them reports the error.
fn is_file(source: &FrameSource) -> bool {
    match source {
        FrameSource::File(path) => path.metadata().map_or(true, |found| {
            found.is_dir() || (found.is_file() && found.len() > 0)
        }),
        _ => false,
    }
}

/// Returns the reason why a source cannot be read, and what helps.
pub(super) fn reason(source: &FrameSource, error: &ReadError) -> String {
    let hint = match (error.kind, source) {
        (ReadErrorKind::UnknownFormat, FrameSource::Standard) => {
            "; start again in the shell, with --format lines"
        }
        (ReadErrorKind::UnknownFormat, source) if !matches!(source, FrameSource::File(_)) => {
            "; after Esc, add one to :watch, as in --format lines"
        }
        (ReadErrorKind::Unsized, FrameSource::Standard) => {
            "; start again in the shell, with --rows R --columns C"
        }
        (ReadErrorKind::Unsized, _) => "; :size COLUMNSxROWS sets them",
        _ => "",
    };
    format!("{error}{hint}")
}

/// Returns the reason why no frame comes, given what is said of the silence. It stays true while the silence lasts: a
/// page on which nothing changes sends nothing.
pub(super) fn silence(source: &FrameSource, counts: &StreamCounts, what: &str) -> String {
    // A file has no baud, and sends nothing.
    if let (FrameSource::File(_), 0, 1..) = (source, counts.frames, counts.bytes) {
        let bytes = counted(counts.bytes, "byte");
        return format!("no frame yet: none in {bytes}; rows, columns or format?");
    }
    format!("no frame for more than 2 s: {what}")
}

/// Returns the reason why a stream came to its end without a frame; None if there was one.
pub(super) fn reason_at_end(counts: &StreamCounts) -> Option<String> {
    let hint = match counts.reason {
        None if counts.bytes > 0 => "; rows, columns or format?",
        _ => "",
    };
    Some(counts.no_frame()? + hint)
}
