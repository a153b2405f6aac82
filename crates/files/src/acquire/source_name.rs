//! The name of a source, as the user writes it.

use std::ffi::OsStr;
use std::fmt;
use std::path::PathBuf;

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

    /// Returns the name for messages, without folders.
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
