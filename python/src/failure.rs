//! Why a call fails: what Python raises.

use std::any::Any;
use std::error::Error;
use std::io;
use std::path::Path;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use taxel_files::storage::FileError;
use taxel_files::{ReadError, ReadErrorKind};

pub(crate) type Result<T> = std::result::Result<T, Failure>;

/// An exception with the program's sentence: an `OSError` if the system refused a file, otherwise a `ValueError`.
#[derive(Debug)]
pub(crate) struct Failure(pub(crate) PyErr);

impl Failure {
    pub(crate) fn new(text: impl Into<String>) -> Self {
        Self(PyValueError::new_err(text.into()))
    }

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

impl<E: Error + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        let text = error.to_string();
        let mut error = Some(error);
        let any: &mut dyn Any = &mut error;
        if let Some(raised) = any.downcast_mut::<Option<PyErr>>().and_then(Option::take) {
            return Self(raised);
        }
        let kind = match any.downcast_ref::<Option<ReadError>>() {
            Some(Some(ReadError {
                kind: ReadErrorKind::Io(kind),
                ..
            })) => Some(*kind),
            _ => None,
        };
        let of_file = any
            .downcast_ref::<Option<FileError>>()
            .and_then(Option::as_ref);
        match kind.or(of_file.map(|own| own.error.kind())) {
            Some(kind) => Self(io::Error::new(kind, text).into()),
            None => Self::new(text),
        }
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        failure.0
    }
}
