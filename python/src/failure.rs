//! Why a call fails: what Python raises.

use std::error::Error;
use std::io;
use std::path::Path;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use taxel_files::storage::FileError;
use taxel_files::{ReadError, ReadErrorKind};

pub(crate) type Result<T> = std::result::Result<T, Failure>;

/// What Python raises: an `OSError` if the system refused a file, otherwise a `ValueError`, with the program's sentence.
#[derive(Debug)]
pub(crate) struct Failure(pub(crate) Box<dyn Error + Send + Sync>);

impl Failure {
    /// The failure to read a file.
    pub(crate) fn of(path: impl AsRef<Path>, error: impl Into<ReadError>) -> Self {
        let (name, mut error) = (path.as_ref().to_string_lossy(), error.into());
        if !error.message.starts_with(&*name) {
            (error.message, error.line, error.column) = (format!("{name}: {error}"), None, None);
        }
        if error.kind == ReadErrorKind::Unsized {
            error.message += "; give rows= and columns=";
        }
        error.into()
    }
}

impl<E: Into<Box<dyn Error + Send + Sync>>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self(error.into())
    }
}

impl From<Failure> for PyErr {
    fn from(Failure(error): Failure) -> Self {
        let text = error.to_string();
        let kind = match error.downcast_ref::<ReadError>().map(|own| own.kind) {
            Some(ReadErrorKind::Io(kind)) => Some(kind),
            _ => error.downcast_ref().map(|own: &FileError| own.error.kind()),
        };
        match (error.downcast::<Self>(), kind) {
            (Ok(raised), _) => *raised,
            (_, Some(kind)) => io::Error::new(kind, text).into(),
            _ => PyValueError::new_err(text),
        }
    }
}
