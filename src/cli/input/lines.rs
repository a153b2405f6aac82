//! Answers lines by lines, in the same order, for `taxel batch` and `taxel recognise`.
//!
//! A block of lines is read, answered by all threads and written, then the next one. A block is what one read returned,
//! up to its last line end: so a program can send a line and wait for its answer, and memory does not grow with the
//! number of lines. Blank lines are skipped, but count in line numbers.

use std::io::{self, ErrorKind, Read, Write};

use rayon::iter::{IndexedParallelIterator, ParallelIterator};
use rayon::slice::ParallelSlice;
use taxel_files::ReadError;
use taxel_files::formats::file::without_mark;
use taxel_files::formats::json;
use taxel_files::formats::value::counted;

use crate::cli::failure::{Failure, Named};
use crate::cli::input::content::Input;
use crate::cli::signals;

/// The longest line, in bytes. Longer lines are refused, so that none can use up all memory.
pub(crate) const MAX_LINE: usize = 1 << 20;

/// The fewest and the most bytes to read at once: a slow command soon writes its first answers, and a quick one does
/// not wait for its threads too often.
const ROOM: [u64; 2] = [1 << 13, 1 << 18];

/// The answers to some lines, one after the other.
#[derive(Default)]
struct Answers {
    text: Vec<u8>,
    answered: u64,
    bad: u64,
}

/// Answers each line of `input`, with up to `jobs` threads (0 for one per core). The answers do not depend on their
/// number. A closure made by `answerer` appends the answer without a line end, or returns what is wrong with the
/// line. `noun` is what a line contains, for the message about a line that is too long.
pub(crate) fn answer_all<A>(
    jobs: usize,
    mut input: Input,
    mut output: impl Write,
    noun: &str,
    answerer: impl Fn() -> A + Sync,
) -> Result<(), Failure>
where
    A: FnMut(&[u8], &mut Vec<u8>) -> Result<(), String>,
{
    let pool = signals::pool(jobs)?;
    let (mut text, mut read, mut number) = (Vec::new(), 0, 1);
    let (mut answered, mut bad) = (0, 0);
    // Their memory is used again.
    let mut pieces: Vec<Answers> = Vec::new();
    loop {
        let old = text.len();
        let room = usize::try_from((read / 8).clamp(ROOM[0], ROOM[1])).unwrap_or(MAX_LINE);
        let new = fill(&mut *input.read, &mut text, room);
        let new = new.map_err(ReadError::from).named(&input.name)?;
        read += new as u64;
        let end = match text[old..].iter().rposition(|&byte| byte == b'\n') {
            Some(end) => old + end,
            None if new == 0 && text.is_empty() => break,
            // The last line may lack its line end.
            None if new == 0 => text.len(),
            None => {
                // Of a line that is too long, this is enough to know it.
                text.truncate(MAX_LINE + 1);
                continue;
            }
        };
        let lines: Vec<&[u8]> = text[..end].split(|&byte| byte == b'\n').collect();
        // Small enough that the threads end together, large enough that they seldom meet.
        let piece = (lines.len() / (8 * pool.current_num_threads())).clamp(1, 64);
        let count = lines.len().div_ceil(piece);
        pieces.resize_with(count.max(pieces.len()), Answers::default);
        pool.install(|| {
            let pieces = lines.par_chunks(piece).zip(&mut pieces).enumerate();
            pieces.for_each_init(&answerer, |answer, (index, (lines, own))| {
                own.answer(lines, number + index * piece, noun, answer);
            });
        });
        for piece in &pieces[..count] {
            output.write_all(&piece.text).map_err(Failure::of_output)?;
            answered += piece.answered;
            bad += piece.bad;
        }
        output.flush().map_err(Failure::of_output)?;
        number += lines.len();
        text.drain(..text.len().min(end + 1));
        if new == 0 {
            break;
        }
    }
    if bad > 0 {
        let lines = counted(answered, "line");
        let text = format!("{bad} of {lines} could not be answered");
        return Err(Failure::new(text));
    }
    Ok(())
}

/// Appends the next bytes, at most `room`; returns their number, 0 at the end.
fn fill(input: &mut dyn Read, text: &mut Vec<u8>, room: usize) -> io::Result<usize> {
    let old = text.len();
    text.resize(old + room, 0);
    let read = loop {
        match input.read(&mut text[old..]) {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            read => break read,
        }
    };
    text.truncate(old + read.as_ref().unwrap_or(&0));
    read
}

impl Answers {
    /// Answers some lines; `first` is the number of the first one, from 1.
    fn answer(
        &mut self,
        lines: &[&[u8]],
        first: usize,
        noun: &str,
        answer: &mut impl FnMut(&[u8], &mut Vec<u8>) -> Result<(), String>,
    ) {
        self.text.clear();
        (self.answered, self.bad) = (0, 0);
        for (number, &line) in (first..).zip(lines) {
            // Some programs start a text with a byte order mark.
            let line = without_mark(line);
            if line.trim_ascii().is_empty() {
                continue;
            }
            let begin = self.text.len();
            let result = if line.len() > MAX_LINE {
                Err(format!("longer than 1 MiB, the limit for a {noun}"))
            } else {
                answer(line, &mut self.text)
            };
            if let Err(message) = result {
                self.bad += 1;
                self.text.truncate(begin);
                let error = format!("line {number}: {message}");
                json::extend_ascii(&mut self.text, &serde_json::json!({ "error": error }));
            }
            self.answered += 1;
            self.text.push(b'\n');
        }
    }
}
