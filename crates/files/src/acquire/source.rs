//! The name of a source, and its kind.

use crate::error::{ReadError, ReadErrorKind};
use std::ffi::OsStr;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read};
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};

use crate::acquire::event::{AcquireError, AcquireOptions, Playback};
use crate::acquire::recorder::RecorderError;
use crate::formats::file::system_reason;
use crate::formats::recording::{ReadOptions, RecordingFormat, old_format_of};
use crate::storage::FileId;

#[derive(Debug)]
pub(super) struct OpenRecording<'a> {
    pub(super) path: &'a Path,
    /// The file in which the format was found, at any position: another one may have its name by now.
    pub(super) file: File,
    /// The format, or the reason why the file is refused.
    pub(super) format: Result<RecordingFormat, ReadError>,
}

/// A source of frames.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum FrameSource {
    /// Standard input, named `-`.
    Standard,
    /// A connection to `HOST:PORT`, named `tcp://HOST:PORT`. If the other end closes it, taxel waits for it to return,
    /// except with [`Playback::Once`](crate::acquire::Playback::Once).
    Tcp(String),
    /// A serial line. If it is unplugged, taxel waits for it to return, except with
    /// [`Playback::Once`](crate::acquire::Playback::Once).
    Serial(PathBuf),
    /// A named pipe.
    Fifo(PathBuf),
    /// A file: a recording, or bytes that may grow.
    File(PathBuf),
}

impl FrameSource {
    /// The source of that name. A path that does not exist counts as a file, except in `/dev` and
    /// `/dev/serial`: there it counts as a serial line, which may be plugged in later.
    pub fn new(name: &OsStr) -> Self {
        Self::named(SourceName::new(name))
    }

    /// The source of that name; see [`Self::new`].
    pub fn named(name: SourceName) -> Self {
        let path = match name {
            SourceName::Standard => return Self::Standard,
            SourceName::Tcp(address) => return Self::Tcp(address),
            SourceName::Path(path) => path,
        };
        match fs::metadata(&path).map(|metadata| metadata.file_type()) {
            Ok(kind) if kind.is_char_device() => Self::Serial(path),
            Ok(kind) if kind.is_fifo() => Self::Fifo(path),
            Err(_) if is_for_devices(&path) => Self::Serial(path),
            _ => Self::File(path),
        }
    }

    /// The file if it is played as a recording: if it has a known format, and `options` names no format of a
    /// stream. A file of another kind, such as an image, is returned, too, and refused when it is played.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn recording(&self, options: &AcquireOptions) -> io::Result<Option<&Path>> {
        let recording = self.open_recording(options)?;
        Ok(recording.map(|recording| recording.path))
    }

    pub(super) fn open_recording(
        &self,
        options: &AcquireOptions,
    ) -> io::Result<Option<OpenRecording<'_>>> {
        let (Self::File(path), None) = (self, options.format) else {
            return Ok(None);
        };
        let file = File::open(path)?;
        match old_format_of(&file, &ReadOptions::default()) {
            Err(error) => match error.kind {
                ReadErrorKind::Io(kind) => Err(kind.into()),
                ReadErrorKind::Invalid => Ok(Some(OpenRecording {
                    path,
                    file,
                    format: Err(error),
                })),
                ReadErrorKind::UnknownFormat | ReadErrorKind::Unsized => Ok(None),
            },
            format @ Ok(_) => Ok(Some(OpenRecording { path, file, format })),
        }
    }

    /// The name for messages.
    pub fn name(&self) -> String {
        let name = match self {
            Self::Standard => SourceName::Standard,
            Self::Tcp(address) => SourceName::Tcp(address.clone()),
            Self::Serial(path) | Self::Fifo(path) | Self::File(path) => {
                SourceName::Path(path.clone())
            }
        };
        name.to_string()
    }

    /// Refuses a source that cannot be read even later: a file that cannot be opened, or an address without a port.
    ///
    /// # Errors
    /// Returns [`AcquireError::Io`].
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

    /// Returns why bits per second have no effect on the source, in words that follow the name of the flag; None if
    /// they have an effect, or if the source may be a serial line that is not plugged in.
    pub fn unused_baud(&self) -> Option<String> {
        match self {
            Self::Serial(_) => None,
            Self::File(path) if !path.exists() => None,
            _ => Some(format!("on {}: it is for serial lines", self.name())),
        }
    }

    /// Creates the error for a source that cannot be opened. If the name looks like a connection, the message says
    /// how one is written.
    pub(super) fn not_opened(&self, error: io::Error) -> AcquireError {
        let name = self.name();
        let is_connection = matches!(self, Self::File(_))
            && error.kind() == io::ErrorKind::NotFound
            && !name.contains('/')
            && check_address(&name).is_ok();
        if !is_connection {
            return AcquireError::opening(error);
        }
        let text = format!(
            "{}; a connection is written {}",
            system_reason(&error),
            SourceName::Tcp(name)
        );
        AcquireError::opening(io::Error::new(error.kind(), text))
    }

    /// Refuses to record in the file that is watched, under any path, or to describe a recording in it.
    ///
    /// # Errors
    /// Returns [`RecorderError::IsSource`].
    pub fn refuse_as_target(&self, target: &Path) -> Result<(), RecorderError> {
        let source = match self {
            Self::Standard => FileId::of_stream(io::stdin()),
            Self::File(path) => FileId::behind(path),
            Self::Tcp(_) | Self::Serial(_) | Self::Fifo(_) => return Ok(()),
        };
        // A source that does not exist cannot be overwritten.
        let Ok(source) = source else {
            return Ok(());
        };
        let both = [target.to_owned(), target.with_extension("json")];
        for path in both {
            if FileId::behind(&path).is_ok_and(|found| found == source) {
                return Err(RecorderError::IsSource { path });
            }
        }
        Ok(())
    }

    /// Whether the source is a file that was moved or removed: no file has its name.
    pub(super) fn has_vanished(&self) -> bool {
        matches!(self, Self::File(path) if has_no_file(path))
    }

    /// Whether its bytes are in a file, where they can be read again.
    pub fn is_in_file(&self) -> bool {
        match self {
            Self::Standard => {
                use std::os::fd::AsFd;
                let input = io::stdin().as_fd().try_clone_to_owned();
                let metadata = input.and_then(|input| File::from(input).metadata());
                metadata.is_ok_and(|found| found.is_file())
            }
            Self::File(_) => true,
            Self::Tcp(_) | Self::Serial(_) | Self::Fifo(_) => false,
        }
    }

    /// Whether all its frames arrive while they are read. Those in a file came before, and standard input or a
    /// FIFO that is read as fast as possible may hold a file.
    pub fn arrives(&self, playback: Playback) -> bool {
        match self {
            Self::Tcp(_) | Self::Serial(_) => true,
            Self::Standard | Self::Fifo(_) => playback != Playback::Once,
            Self::File(_) => false,
        }
    }

    /// Whether the source may come back after it was lost, so that taxel tries again.
    pub(super) fn comes_back(&self) -> bool {
        matches!(self, Self::Tcp(_) | Self::Serial(_))
    }

    /// Whether its first byte is the first one that was sent or written; false if it is joined anywhere.
    pub(super) fn begins(&self) -> bool {
        !self.comes_back()
    }
}

pub(super) fn has_no_file(path: &Path) -> bool {
    !path.is_file()
}

/// Whether a device may appear at a path when it is plugged in.
fn is_for_devices(path: &Path) -> bool {
    path.parent() == Some(Path::new("/dev")) || path.starts_with("/dev/serial")
}

/// Refuses an address that is not a host with a port.
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

/// The beginning of the name of a connection.
const TCP: &str = "tcp://";

/// The name of a source. Its text is the name for messages.
///
/// ```
/// use taxel_files::acquire::SourceName;
/// assert_eq!(SourceName::new("-"), SourceName::Standard);
/// assert_eq!(SourceName::new("tcp://robot:7000"), SourceName::Tcp("robot:7000".to_owned()));
/// assert_eq!(SourceName::new("runs/touch.npy").short(), "touch.npy");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum SourceName {
    /// Standard input, written `-`.
    Standard,
    /// The address of a connection, written `tcp://HOST:PORT`.
    Tcp(String),
    /// The path of anything else: a file, a FIFO or a serial line.
    Path(PathBuf),
}

impl SourceName {
    /// Reads a name.
    pub fn new(name: impl AsRef<OsStr>) -> Self {
        let name = name.as_ref();
        if name == "-" {
            return Self::Standard;
        }
        match name.to_str().and_then(|name| name.strip_prefix(TCP)) {
            Some(address) => Self::Tcp(address.to_owned()),
            None => Self::Path(name.into()),
        }
    }

    /// The name for messages, without folders.
    pub fn short(&self) -> String {
        match self {
            Self::Path(path) => {
                let path = path.to_string_lossy();
                path.rsplit('/').next().unwrap_or(&path).to_owned()
            }
            name => name.to_string(),
        }
    }
}

impl fmt::Display for SourceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard => f.write_str("standard input"),
            Self::Tcp(address) => write!(f, "{TCP}{address}"),
            Self::Path(path) => f.write_str(&path.to_string_lossy()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_serial_line_that_is_not_plugged_in_is_still_a_serial_line() {
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
