//! A failure of the program: one text for the user, and the exit status.
//!
//! `?` makes one of any error; [`Named`] puts the file or flag before it, and [`Failure::with_hint`] says what to do.

use std::any::Any;
use std::error::Error;
use std::fmt::Display;
use std::io::{self, ErrorKind};

use taxel_core::quote::shortened_message;
use taxel_files::formats::file::system_reason;
use taxel_files::storage::FileError;

use crate::cli::output::charset::Charset;

#[derive(Clone, Debug)]
pub(crate) struct Failure {
    /// What the user reads after `error: `; nothing is printed if it is empty.
    pub(crate) text: String,
    pub(crate) status: u8,
    /// Whether line breaks in the text are its own; if not, they come from a file or an argument and are escaped.
    has_lines: bool,
}

impl Failure {
    /// Wrong input: a file, a shape, a number out of range.
    pub(crate) fn new(text: impl Into<String>) -> Self {
        let text = text.into();
        Self {
            text,
            status: 1,
            has_lines: false,
        }
    }

    /// A wrong command line, script or settings file.
    pub(crate) fn usage(text: impl Into<String>) -> Self {
        Self::new(text).with_status(2)
    }

    /// Puts the flag that gave a file before the file's name.
    pub(crate) fn of_flag(mut self, flag: &str) -> Self {
        self.text = format!("{flag} {}", self.text);
        self
    }

    /// The answers cannot be written.
    pub(crate) fn of_output(error: io::Error) -> Self {
        let failure = Self::from(error);
        let text = format!("cannot write to standard output: {}", failure.text);
        Self { text, ..failure }
    }

    /// Only an exit status, after everything is said.
    pub(crate) fn silent(status: u8) -> Self {
        Self::new("").with_status(status)
    }

    pub(crate) fn with_status(self, status: u8) -> Self {
        Self { status, ..self }
    }

    pub(crate) fn with_lines(self) -> Self {
        Self {
            has_lines: true,
            ..self
        }
    }

    /// Appends a text such as `; --force replaces it`.
    pub(crate) fn with_hint(mut self, hint: impl AsRef<str>) -> Self {
        self.text += hint.as_ref();
        self
    }

    /// The lines for standard error. A closed pipe, as in `taxel batch | head -1`, is not an error.
    pub(crate) fn message(&self, charset: Charset) -> Option<String> {
        let text = if self.has_lines {
            charset.lines(&self.text)
        } else {
            charset.line(&self.text).into_owned()
        };
        (self.status != 0 && !text.is_empty()).then(|| format!("error: {text}\n"))
    }
}

impl<E: Error + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        let any: &dyn Any = &error;
        if let Some(error) = any.downcast_ref::<io::Error>() {
            let is_closed_pipe = error.kind() == ErrorKind::BrokenPipe;
            Self::new(system_reason(error)).with_status(u8::from(!is_closed_pipe))
        } else if let Some(error) = any.downcast_ref::<clap::Error>() {
            let text = error.render().to_string();
            let text = text.strip_prefix("error: ").unwrap_or(&text);
            Self::usage(text.trim_end()).with_lines()
        } else if let Some(error) = any.downcast_ref::<FileError>().filter(|own| own.exists()) {
            let path = error.path.to_string_lossy();
            Self::new(format!("{path:?} already exists; --force replaces it"))
        } else {
            Self::new(shortened_message(&error.to_string()))
        }
    }
}

pub(crate) trait Named<T> {
    /// Puts the name of a file, flag or line before the text of a failure.
    fn named(self, place: impl Display) -> Result<T, Failure>;
}

impl<T, E: Into<Failure>> Named<T> for Result<T, E> {
    fn named(self, place: impl Display) -> Result<T, Failure> {
        self.map_err(|error| {
            let failure = error.into();
            Failure {
                text: format!("{place}: {}", failure.text),
                // Only the pipe of the answers may be closed.
                status: failure.status.max(1),
                ..failure
            }
        })
    }
}
