//! `taxel batch`: lines of JSON in, lines of JSON out, in the same order.
//!
//! Memory does not grow with the number of lines: one line and its answer are held at a time. Answers are collected
//! and written together, but never held back while the program waits: before a read that may have to wait for more
//! input, everything is written out. Blank lines are skipped, though counted in the numbers of lines.

use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};

use crate::cli::error::CliError;
use crate::cli::output::report;
use crate::formats::{DescribedImprint, Job};
use crate::imprint::Imprint;
use crate::quote::legible;
use crate::sensor::Sensor;
use crate::touch::Plane;

/// A longer line is refused; so one line cannot take all memory.
const MAX_LINE: usize = 1 << 20;

/// Bytes read and written at a time.
const CHUNK: usize = 1 << 16;

/// Answers each line of `input`; pictures by name are looked up.
pub(crate) fn answer_lines(
    sensor: Sensor,
    lookup: &dyn Fn(&str) -> Result<Imprint, String>,
    input: impl Read,
    output: impl Write,
) -> Result<(), CliError> {
    let mut lines = Lines::new(input);
    let mut output = BufWriter::with_capacity(CHUNK, output);
    let mut plane = Plane::new(sensor);
    let mut answer = Vec::new();
    let (mut number, mut answered, mut bad) = (0_u64, 0_u64, 0_u64);
    while let Some(line) = lines.next(|| output.flush().map_err(CliError::Write))? {
        number += 1;
        let result = match line {
            Line::Content(content) if content.trim_ascii().is_empty() => continue,
            Line::Content(content) => Job::read(content, sensor, lookup)
                .map(|job| job.imprint(&mut plane))
                .map_err(|error| legible(&error.to_string())),
            Line::Long => Err("longer than 1 MiB, which no pose is".to_owned()),
        };
        answer.clear();
        match result {
            Ok(imprint) => serde_json::to_writer(&mut answer, &DescribedImprint(&imprint))
                .map_err(|error| CliError::Write(error.into()))?,
            Err(message) => {
                bad += 1;
                refuse(&mut answer, &format!("line {number}: {message}"));
            }
        }
        answered += 1;
        answer.push(b'\n');
        output.write_all(&answer).map_err(CliError::Write)?;
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

/// The answer to a bad line.
fn refuse(answer: &mut Vec<u8>, message: &str) {
    let json = serde_json::json!({ "error": message }).to_string();
    answer.extend(report::ascii_json(&json).bytes());
}

/// Lines of any bytes, read one by one.
struct Lines<R> {
    input: BufReader<R>,
    line: Vec<u8>,
}

/// A line without its end.
enum Line<'a> {
    /// All of it.
    Content(&'a [u8]),
    /// Longer than [`MAX_LINE`], and read over.
    Long,
}

impl<R: Read> Lines<R> {
    fn new(input: R) -> Self {
        Self {
            input: BufReader::with_capacity(CHUNK, input),
            line: Vec::new(),
        }
    }

    /// The next line; none at the end. `pause` is called before each read that may have to wait.
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
