//! The name of a source, and its kind.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use crate::acquire::event::Playback;
use crate::acquire::recorder::RecorderError;
use crate::acquire::unix;
use crate::formats::file::system_reason;
use crate::storage::FileId;
use crate::{ReadError, ReadErrorKind};

/// A source of frames.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum FrameSource {
    /// Standard input, named `-`.
    Standard,
    /// A connection to `HOST:PORT`, named `tcp://HOST:PORT`. If the other end closes it, taxel waits for it to return,
    /// except with [`Playback::Once`].
    Tcp(String),
    /// A serial line. If it is unplugged, taxel waits for it to return, except with [`Playback::Once`].
    Serial(PathBuf),
    /// A named pipe.
    Fifo(PathBuf),
    /// A file: a recording, or bytes that may grow.
    File(PathBuf),
}

impl FrameSource {
    /// The source of that name, as it is found. A path that does not exist counts as a file, except in `/dev` and
    /// `/dev/serial`: there it counts as a serial line, which may be plugged in later.
    pub fn new(name: impl AsRef<OsStr>) -> Self {
        Self::named(name).found()
    }

    /// The source of that name, without a look at the disk: each path counts as a file.
    ///
    /// ```
    /// use taxel_files::acquire::FrameSource;
    /// assert_eq!(FrameSource::named("-"), FrameSource::Standard);
    /// let robot = FrameSource::Tcp("robot:7000".to_owned());
    /// assert_eq!(FrameSource::named("tcp://robot:7000"), robot);
    /// ```
    pub fn named(name: impl AsRef<OsStr>) -> Self {
        let name = name.as_ref();
        if name == "-" {
            return Self::Standard;
        }
        match name.to_str().and_then(|name| name.strip_prefix(TCP)) {
            Some(address) => Self::Tcp(address.to_owned()),
            None => Self::File(name.into()),
        }
    }

    /// What a path refers to now; see [`Self::new`].
    #[must_use]
    pub fn found(self) -> Self {
        let Self::File(path) = self else {
            return self;
        };
        match fs::metadata(&path).map(|metadata| metadata.file_type()) {
            Ok(kind) if unix::is_serial(kind) => Self::Serial(path),
            Ok(kind) if unix::is_fifo(kind) => Self::Fifo(path),
            // A device may appear there when it is plugged in.
            Err(_)
                if path.parent() == Some(Path::new("/dev")) || path.starts_with("/dev/serial") =>
            {
                Self::Serial(path)
            }
            _ => Self::File(path),
        }
    }

    /// The name for messages.
    pub fn name(&self) -> String {
        match self {
            Self::Standard => "standard input".to_owned(),
            Self::Tcp(address) => format!("{TCP}{address}"),
            Self::Serial(path) | Self::Fifo(path) | Self::File(path) => {
                path.to_string_lossy().into_owned()
            }
        }
    }

    /// Refuses a source that cannot be read even later: a file that cannot be opened, or an address without a port.
    ///
    /// # Errors
    /// The system's error, and an address without a port.
    pub fn check(&self) -> Result<(), ReadError> {
        let checked = match self {
            Self::File(path) => File::open(path)
                .and_then(|mut file| file.read(&mut [0]))
                .map(drop),
            Self::Tcp(address) => check_address(address),
            Self::Standard | Self::Serial(_) | Self::Fifo(_) => Ok(()),
        };
        checked.map_err(|error| self.not_opened(&error))
    }

    /// Why bits per second have no effect on the source, in words that follow the name of the flag; None if they have
    /// an effect, or if the source may be a serial line that is not plugged in.
    pub fn unused_baud(&self) -> Option<String> {
        match self {
            Self::Serial(_) => None,
            Self::File(path) if !path.exists() => None,
            _ => Some(format!("on {}: it is for serial lines", self.name())),
        }
    }

    /// The error for a source that cannot be opened. If the name looks like a connection, the message says how one is
    /// written.
    pub(super) fn not_opened(&self, error: &io::Error) -> ReadError {
        let (name, reason) = (self.name(), system_reason(error));
        let is_connection = matches!(self, Self::File(_))
            && error.kind() == ErrorKind::NotFound
            && !name.contains('/')
            && check_address(&name).is_ok();
        let hint = if is_connection {
            format!("; a connection is written {TCP}{name}")
        } else {
            String::new()
        };
        ReadError::new(format!("cannot open: {reason}{hint}"))
            .of_kind(ReadErrorKind::Io(error.kind()))
    }

    /// Refuses to record in the file that is watched, under any path, or to describe a recording in it.
    ///
    /// # Errors
    /// [`RecorderError::Refused`].
    pub fn refuse_as_target(&self, target: &Path) -> Result<(), RecorderError> {
        let source = match self {
            Self::Standard => unix::standard_input().and_then(|input| FileId::of(&input)),
            Self::File(path) => FileId::behind(path),
            Self::Tcp(_) | Self::Serial(_) | Self::Fifo(_) => return Ok(()),
        };
        // A source that does not exist cannot be overwritten.
        let Ok(source) = source else {
            return Ok(());
        };
        for path in [target.to_owned(), target.with_extension("json")] {
            if FileId::behind(&path).is_ok_and(|found| found == source) {
                let name = path.display();
                return Err(RecorderError::Refused(format!(
                    "{name} is the source being watched: record to another file"
                )));
            }
        }
        Ok(())
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
}

/// Refuses an address that is not a host with a port.
pub(super) fn check_address(address: &str) -> io::Result<()> {
    let parts = address.rsplit_once(':');
    match parts.filter(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok()) {
        Some(_) => Ok(()),
        None => Err(io::Error::new(
            ErrorKind::InvalidInput,
            "expected tcp://HOST:PORT with a port up to 65535",
        )),
    }
}

/// The beginning of the name of a connection.
const TCP: &str = "tcp://";

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
