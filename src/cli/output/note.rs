//! Notes on standard error.

use std::io::{self, Write};

use crate::cli::output::charset::Charset;

/// Writes a note to standard error. If it cannot be written, it is dropped: it is not part of the answer.
pub(crate) fn note(text: &str, charset: Charset) {
    let _ = writeln!(io::stderr().lock(), "{}", charset.line(text));
}
