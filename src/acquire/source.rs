//! The name of a source, and its kind.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Read};
use std::os::fd::AsFd;
use std::os::unix::fs::{FileTypeExt, MetadataExt};
use std::path::{Path, PathBuf};

use crate::acquire::event::{AcquireError, AcquireOptions};
use crate::acquire::recorder::RecorderError;
use crate::formats::recording::{ReadOptions, RecordingError, format_of};

/// Where frames come from.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FrameSource {
    /// Standard input, `-`.
    Standard,
    /// A connection to `HOST:PORT`, `tcp://HOST:PORT`.
    Tcp(String),
    /// A serial line.
    Serial(PathBuf),
    /// A pipe with a name.
    Fifo(PathBuf),
    /// A file: a recording, or bytes that may become more.
    File(PathBuf),
}

impl FrameSource {
    /// The source of that name. A path that does not exist counts as a file, but in `/dev` and `/dev/serial` as a serial
    /// line, which may be plugged in later.
    pub fn new(name: &OsStr) -> Self {
        if name == "-" {
            return Self::Standard;
        }
        if let Some(address) = name.to_str().and_then(|name| name.strip_prefix("tcp://")) {
            return Self::Tcp(address.to_owned());
        }
        let path = PathBuf::from(name);
        match fs::metadata(&path).map(|metadata| metadata.file_type()) {
            Ok(kind) if kind.is_char_device() => Self::Serial(path),
            Ok(kind) if kind.is_fifo() => Self::Fifo(path),
            Err(_) if is_for_devices(&path) => Self::Serial(path),
            _ => Self::File(path),
        }
    }

    /// Returns the file if it is played as a recording: of a known format, and no format of a stream was asked for. A file of
    /// another kind, such as an image, is returned, too, and refused when it is played.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn recording(&self, options: &AcquireOptions) -> io::Result<Option<&Path>> {
        let (Self::File(path), None) = (self, options.format) else {
            return Ok(None);
        };
        match format_of(File::open(path)?, ReadOptions::default()) {
            Ok(_) | Err(RecordingError::Foreign { .. }) => Ok(Some(path)),
            Err(RecordingError::Io(error)) => Err(error),
            Err(_) => Ok(None),
        }
    }

    /// Its name in messages.
    pub fn name(&self) -> String {
        match self {
            Self::Standard => "standard input".to_owned(),
            Self::Tcp(address) => format!("tcp://{address}"),
            Self::Serial(path) | Self::Fifo(path) | Self::File(path) => {
                path.to_string_lossy().into_owned()
            }
        }
    }

    /// Refuses a source that cannot be read however long one waits: a file that cannot be opened, an address without a
    /// port.
    ///
    /// # Errors
    /// [`AcquireError::Io`].
    pub fn check(&self) -> Result<(), AcquireError> {
        let checked = match self {
            Self::File(path) => File::open(path)
                .and_then(|mut file| file.read(&mut [0]))
                .map(drop),
            Self::Tcp(address) => check_address(address),
            Self::Standard | Self::Serial(_) | Self::Fifo(_) => Ok(()),
        };
        checked.map_err(|error| self.not_opened(error))
    }

    /// That it cannot be opened. A name that looks like that of a connection says how one is written.
    pub(super) fn not_opened(&self, error: io::Error) -> AcquireError {
        let name = self.name();
        let is_connection = matches!(self, Self::File(_))
            && error.kind() == io::ErrorKind::NotFound
            && !name.contains('/')
            && check_address(&name).is_ok();
        if !is_connection {
            return AcquireError::opening(error);
        }
        let text = format!("{error}; a connection is written tcp://{name}");
        AcquireError::opening(io::Error::new(error.kind(), text))
    }

    /// Refuses to record in the file that is watched, whatever its path, or to describe a recording in it.
    ///
    /// # Errors
    /// [`RecorderError::IsSource`].
    pub fn refuse_as_target(&self, target: &Path) -> Result<(), RecorderError> {
        let identity = |file: fs::Metadata| (file.dev(), file.ino());
        let source = match self {
            Self::Standard => io::stdin()
                .as_fd()
                .try_clone_to_owned()
                .and_then(|input| File::from(input).metadata()),
            Self::File(path) => fs::metadata(path),
            Self::Tcp(_) | Self::Serial(_) | Self::Fifo(_) => return Ok(()),
        };
        // What is not there is nothing that can be lost.
        let Ok(source) = source.map(identity) else {
            return Ok(());
        };
        let both = [target.to_owned(), target.with_extension("json")];
        for path in both {
            if fs::metadata(&path).is_ok_and(|found| identity(found) == source) {
                return Err(RecorderError::IsSource { path });
            }
        }
        Ok(())
    }

    /// Whether it comes back after it was lost, so that it is tried again.
    pub(super) fn comes_back(&self) -> bool {
        matches!(self, Self::Tcp(_) | Self::Serial(_))
    }
}

/// Whether a path is one where a device appears when it is plugged in.
fn is_for_devices(path: &Path) -> bool {
    path.parent() == Some(Path::new("/dev")) || path.starts_with("/dev/serial")
}

/// Refuses an address that is not a host with a port.
///
/// # Errors
/// [`io::ErrorKind::InvalidInput`].
pub(super) fn check_address(address: &str) -> io::Result<()> {
    let parts = address.rsplit_once(':');
    match parts.filter(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok()) {
        Some(_) => Ok(()),
        None => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "expected tcp://HOST:PORT with a port up to 65535",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_is_not_plugged_in_is_a_line_all_the_same() {
        for (name, is_line) in [
            ("/dev/ttyUSB9999", true),
            ("/dev/serial/by-id/usb-none", true),
            ("/dev/shm/none.npy", false),
            ("none.npy", false),
        ] {
            let source = FrameSource::new(OsStr::new(name));
            assert_eq!(matches!(source, FrameSource::Serial(_)), is_line, "{name}");
        }
    }
}
