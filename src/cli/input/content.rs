//! Opens a file or standard input, and reads an imprint in any format, or a stored shape, from it. The format is
//! recognised by the content, never by the file's name.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use taxel_files::ReadError;
use taxel_files::formats::imprint_file::MAX_BYTES;

use taxel_files::formats::recording::may_be_recording;
use taxel_files::formats::{Content, is_svg, read_content};

use crate::cli::failure::{Failure, Named};

/// What messages call a file, or standard input for `-`.
pub(crate) fn input_name(path: &Path) -> String {
    if path.as_os_str() == "-" {
        "standard input".to_owned()
    } else {
        path.to_string_lossy().into_owned()
    }
}

/// Opens a file, or standard input for `-`.
pub(crate) fn open(path: &Path) -> io::Result<Box<dyn Read>> {
    Ok(if path.as_os_str() == "-" {
        Box::new(io::stdin())
    } else {
        Box::new(File::open(path)?)
    })
}

/// An open file or standard input.
pub(crate) struct Input {
    pub(crate) name: String,
    pub(crate) read: Box<dyn Read>,
}

impl Input {
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let name = input_name(path);
        let read = open(path).map_err(ReadError::from).named(&name)?;
        Ok(Self { name, read })
    }

    /// Reads everything, or a byte more than `most`, which is then too much.
    pub(crate) fn bytes(self, most: usize) -> Result<Vec<u8>, Failure> {
        let mut bytes = Vec::new();
        let read = self.read.take(most as u64 + 1).read_to_end(&mut bytes);
        read.map_err(ReadError::from).named(&self.name)?;
        Ok(bytes)
    }

    /// Reads an imprint or a stored shape.
    pub(crate) fn content(self) -> Result<Content, Failure> {
        let name = self.name.clone();
        content(&self.bytes(MAX_BYTES)?, &name)
    }
}

/// Reads an imprint or a stored shape from the bytes of the file of that name.
pub(crate) fn content(bytes: &[u8], name: &str) -> Result<Content, Failure> {
    read_content(bytes).named(name).map_err(|failure| {
        failure.with_hint(if is_svg(bytes) {
            "; if this is an outline, use taxel picture"
        } else if may_be_recording(bytes) {
            "; if this is a recording, use taxel frames"
        } else {
            ""
        })
    })
}
