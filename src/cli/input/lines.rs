//! Lines answered one by one, as `taxel batch` and `taxel recognise` do.
//!
//! Memory does not grow with the number of lines: only one line and its answer are held at a time. Answers are
//! buffered, but all of them are written out before any read that may have to wait for more input: so a program that
//! sends a line and waits for its answer gets it. Blank lines are skipped, but count in line numbers.

use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};

use crate::cli::error::CliError;
use crate::cli::output::report;

/// The longest line, in bytes. Longer ones are refused, so that a line cannot use up all memory.
pub(crate) const MAX_LINE: usize = 1 << 20;

/// The number of bytes to read and write at a time.
const CHUNK: usize = 1 << 16;

/// Answers each line of `input`: `answer` appends its answer, without a line end, or says what is wrong with the line.
/// `noun` is what a line holds, for the message about one that is too long.
///
/// # Errors
/// [`CliError::Lines`] at the end if some lines were wrong; [`CliError::Read`] or [`CliError::Write`] at once.
pub(crate) fn answer_each(
    input: impl Read,
    output: impl Write,
    noun: &str,
    mut answer: impl FnMut(&[u8], &mut Vec<u8>) -> Result<(), String>,
) -> Result<(), CliError> {
    let mut lines = Lines::new(input);
    let mut output = BufWriter::with_capacity(CHUNK, output);
    let mut text = Vec::new();
    let (mut number, mut answered, mut bad) = (0_u64, 0_u64, 0_u64);
    while let Some(line) = lines.next(|| output.flush().map_err(CliError::Write))? {
        number += 1;
        text.clear();
        let result = match line {
            Line::Content(content) if content.trim_ascii().is_empty() => continue,
            Line::Content(content) => answer(content, &mut text),
            Line::Long => Err(format!("longer than 1 MiB, which no {noun} is")),
        };
        if let Err(message) = result {
            bad += 1;
            text.clear();
            refuse(&mut text, &format!("line {number}: {message}"));
        }
        answered += 1;
        text.push(b'\n');
        output.write_all(&text).map_err(CliError::Write)?;
    }
    output.flush().map_err(CliError::Write)?;
    if bad > 0 {
        return Err(CliError::Lines {
            bad,
            lines: answered,
        });
    }
    Ok(())
}

/// Writes the answer to a wrong line.
fn refuse(answer: &mut Vec<u8>, message: &str) {
    let json = serde_json::json!({ "error": message }).to_string();
    answer.extend(report::ascii_json(&json).bytes());
}

/// Reads lines of any bytes, one by one.
struct Lines<R> {
    /// Where bytes come from, in large pieces.
    input: BufReader<R>,
    /// The line being read; its memory is used again.
    line: Vec<u8>,
}

/// A line without its line end.
enum Line<'a> {
    /// A complete line.
    Content(&'a [u8]),
    /// A line longer than [`MAX_LINE`], which has been skipped.
    Long,
}

impl<R: Read> Lines<R> {
    /// Reads nothing yet.
    fn new(input: R) -> Self {
        Self {
            input: BufReader::with_capacity(CHUNK, input),
            line: Vec::new(),
        }
    }

    /// Returns the next line; None at the end. Calls `pause` before each read that may have to wait.
    fn next(
        &mut self,
        mut pause: impl FnMut() -> Result<(), CliError>,
    ) -> Result<Option<Line<'_>>, CliError> {
        self.line.clear();
        let mut any = false;
        let mut long = false;
        loop {
            if self.input.buffer().is_empty() {
                pause()?;
            }
            let bytes = match self.input.fill_buf() {
                Ok(bytes) => bytes,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(CliError::Read(error)),
            };
            if bytes.is_empty() {
                break;
            }
            any = true;
            let end = bytes.iter().position(|&byte| byte == b'\n');
            let part = &bytes[..end.unwrap_or(bytes.len())];
            long |= part.len() > MAX_LINE - self.line.len();
            if !long {
                self.line.extend_from_slice(part);
            }
            let used = end.map_or(bytes.len(), |end| end + 1);
            self.input.consume(used);
            if end.is_some() {
                break;
            }
        }
        Ok(match (any, long) {
            (false, _) => None,
            (true, true) => Some(Line::Long),
            (true, false) => Some(Line::Content(&self.line)),
        })
    }
}
