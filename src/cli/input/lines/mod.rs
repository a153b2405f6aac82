//! Answers lines by lines, in the same order, for `taxel batch` and `taxel recognise`.
//!
//! Lines are read, answered and written in blocks of whole lines (`block`), by one thread or several (`in_order`).
//! Memory does not grow with the number of lines. The answers of a block are written out at once, and a block ends
//! when the input pauses, so a program can send a line and wait for its answer. Blank lines are skipped, but count in
//! line numbers.
//! ```text
//! input -> BlockReader -> blocks -> workers: a line each to `answer` -> answers of a block -> output
//! ```

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard};

use taxel_core::lock::locked;
use taxel_files::formats::file::without_mark;
use taxel_files::formats::json;

use crate::cli::error::CliError;
use crate::cli::input::content::{self, InputSource};
use crate::cli::signals;

pub(crate) mod in_order;

pub(crate) struct LineInput {
    pub(crate) name: String,
    pub(crate) read: Box<dyn Read + Send>,
}

impl LineInput {
    pub(crate) fn standard() -> Result<Self, CliError> {
        let name = InputSource::Standard.name();
        match content::standard() {
            Ok(input) => Ok(Self {
                name,
                read: Box::new(input),
            }),
            Err(error) => Err(CliError::Read { name, error }),
        }
    }

    pub(crate) fn at(path: PathBuf) -> Result<Self, CliError> {
        match File::open(&path) {
            Ok(file) => Ok(Self::of_file(path, file)),
            Err(error) => {
                let name = InputSource::File(path).name();
                Err(CliError::Read { name, error })
            }
        }
    }

    pub(crate) fn of_file(path: PathBuf, file: File) -> Self {
        Self {
            name: InputSource::File(path).name(),
            read: Box::new(file),
        }
    }
}

/// Answers each line of `input`, with up to `jobs` threads (0 for the default, [`signals::count`]). The answers do not
/// depend on their number. Each thread uses a closure of its own, made by `answerer`, which appends the answer without a
/// line end, or returns what is wrong with the line. `noun` is what a line contains, for the message about a line that
/// is too long.
pub(crate) fn answer_all<A>(
    jobs: usize,
    input: LineInput,
    output: impl Write,
    noun: &str,
    answerer: impl Fn() -> A + Sync,
) -> Result<(), CliError>
where
    A: FnMut(&[u8], &mut Vec<u8>) -> Result<(), String>,
{
    // There are separate buffers for lines and for answers, which are longer.
    let (read, written) = (Arc::<Buffers>::default(), Buffers::default());
    let mut blocks = BlockReader::new(input.read, Arc::clone(&read));
    let mut output = AnswerWriter::new(output, input.name);
    in_order::in_order(
        signals::count(jobs),
        move || blocks.next_block(),
        || {
            let (read, written) = (&read, &written);
            let mut answer = answerer();
            move |block: io::Result<Block>| -> io::Result<_> {
                let block = block?;
                let answers = answer_block(&block, noun, written.take(), &mut answer);
                read.give_back(block.into_buffer());
                Ok(answers)
            }
        },
        |answers| {
            written.give_back(output.write(answers)?);
            Ok::<_, CliError>(())
        },
    )?;
    output.finish()
}

#[derive(Debug, Default)]
struct BlockAnswers {
    text: Vec<u8>,
    answered: u64,
    bad: u64,
}

fn answer_block(
    block: &Block,
    noun: &str,
    text: Vec<u8>,
    answer: &mut impl FnMut(&[u8], &mut Vec<u8>) -> Result<(), String>,
) -> BlockAnswers {
    let mut answers = BlockAnswers {
        text,
        ..BlockAnswers::default()
    };
    for (number, line) in block.lines() {
        let begin = answers.text.len();
        // Some programs start a text with a byte order mark.
        let line = line.map(|content| match number {
            1 => without_mark(content),
            _ => content,
        });
        let result = match line {
            Some(content) if content.trim_ascii().is_empty() => continue,
            Some(content) => answer(content, &mut answers.text),
            None => Err(format!("longer than 1 MiB, the limit for a {noun}")),
        };
        if let Err(message) = result {
            answers.bad += 1;
            answers.text.truncate(begin);
            refuse(&mut answers.text, &format!("line {number}: {message}"));
        }
        answers.answered += 1;
        answers.text.push(b'\n');
    }
    answers
}

fn refuse(answer: &mut Vec<u8>, message: &str) {
    json::extend_ascii(answer, &serde_json::json!({ "error": message }));
}

struct AnswerWriter<W> {
    input: String,
    output: W,
    answered: u64,
    bad: u64,
}

impl<W: Write> AnswerWriter<W> {
    fn new(output: W, input: String) -> Self {
        Self {
            input,
            output,
            answered: 0,
            bad: 0,
        }
    }

    fn write(&mut self, answers: io::Result<BlockAnswers>) -> Result<Vec<u8>, CliError> {
        let answers = answers.map_err(|error| CliError::Read {
            name: self.input.clone(),
            error,
        })?;
        self.answered += answers.answered;
        self.bad += answers.bad;
        let written = self.output.write_all(&answers.text);
        written
            .and_then(|()| self.output.flush())
            .map_err(CliError::Write)?;
        Ok(answers.text)
    }

    fn finish(self) -> Result<(), CliError> {
        if self.bad > 0 {
            return Err(CliError::Lines {
                bad: self.bad,
                lines: self.answered,
            });
        }
        Ok(())
    }
}

/// The longest line, in bytes. Longer lines are refused, so that none can use up all memory.
pub(crate) const MAX_LINE: usize = 1 << 20;

/// The number of bytes to read at a time at the start of the input: about a hundred lines, so that several threads
/// share even a short input.
const CHUNK: usize = 1 << 13;

/// The number of bytes to read at a time from a long input. Threads wake each other for every block, so larger blocks
/// save time.
const LARGE_CHUNK: usize = 1 << 15;

/// Blocks grow to at most this fraction of what has been read, 1/32, so that the threads end at about the same time.
const PART: u64 = 32;

#[derive(Debug)]
pub(crate) struct Block {
    /// The lines. Only the last line of the input may lack its line end.
    text: Vec<u8>,
    /// The number of its first line, counted from 1.
    first: u64,
    /// Whether the block stands for one line longer than [`MAX_LINE`], whose bytes were dropped.
    is_long: bool,
}

impl Block {
    pub(crate) fn lines(&self) -> impl Iterator<Item = (u64, Option<&[u8]>)> {
        let text = self.text.strip_suffix(b"\n").unwrap_or(&self.text);
        let lines = text.split(|&byte| byte == b'\n');
        let lines = lines.map(|line| (!self.is_long && line.len() <= MAX_LINE).then_some(line));
        (self.first..).zip(lines)
    }

    pub(crate) fn into_buffer(self) -> Vec<u8> {
        self.text
    }
}

/// Reads blocks. A block holds what one read returned, up to its last line end, so that lines that have arrived do
/// not wait for those that have not.
#[derive(Debug)]
pub(crate) struct BlockReader<R> {
    input: R,
    /// The bytes of the next block that have been read.
    rest: Vec<u8>,
    /// The number of bytes read in all.
    total: u64,
    number: u64,
    is_long: bool,
    buffers: Arc<Buffers>,
}

impl<R: Read> BlockReader<R> {
    pub(crate) fn new(input: R, buffers: Arc<Buffers>) -> Self {
        Self {
            input,
            rest: Vec::new(),
            total: 0,
            number: 1,
            is_long: false,
            buffers,
        }
    }

    pub(crate) fn next_block(&mut self) -> Option<io::Result<Block>> {
        let mut searched = 0;
        loop {
            let new = &self.rest[searched..];
            let end = if self.is_long {
                new.iter().position(|&byte| byte == b'\n')
            } else {
                new.iter().rposition(|&byte| byte == b'\n')
            };
            if let Some(end) = end {
                return Some(Ok(self.cut(searched + end + 1)));
            }
            if self.rest.len() > MAX_LINE {
                self.is_long = true;
            }
            if self.is_long {
                self.rest.clear();
            }
            searched = self.rest.len();
            match self.fill() {
                Err(error) => return Some(Err(error)),
                Ok(0) if self.rest.is_empty() && !self.is_long => return None,
                Ok(0) => return Some(Ok(self.cut(searched))),
                Ok(_) => {}
            }
        }
    }

    fn cut(&mut self, length: usize) -> Block {
        let mut rest = self.buffers.take();
        rest.extend_from_slice(&self.rest[length..]);
        self.rest.truncate(length);
        let mut text = std::mem::replace(&mut self.rest, rest);
        let (first, is_long) = (self.number, std::mem::take(&mut self.is_long));
        if is_long {
            text.clear();
            self.number += 1;
        } else {
            let ends = text.iter().map(|&byte| u64::from(byte == b'\n'));
            self.number += ends.sum::<u64>();
        }
        Block {
            text,
            first,
            is_long,
        }
    }

    fn fill(&mut self) -> io::Result<usize> {
        let old = self.rest.len();
        let part = usize::try_from(self.total / PART).unwrap_or(LARGE_CHUNK);
        self.rest.resize(old + part.clamp(CHUNK, LARGE_CHUNK), 0);
        let read = loop {
            match self.input.read(&mut self.rest[old..]) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                read => break read,
            }
        };
        let new = *read.as_ref().unwrap_or(&0);
        self.rest.truncate(old + new);
        self.total += new as u64;
        read
    }
}

/// The largest buffer that is kept, in bytes, so that a single long answer does not keep its memory to the end.
const LARGEST: usize = 1 << 20;

/// The unused buffers. There are never more than were in use at one time.
#[derive(Debug, Default)]
pub(crate) struct Buffers(Mutex<Vec<Vec<u8>>>);

impl Buffers {
    pub(crate) fn take(&self) -> Vec<u8> {
        let Some(buffer) = self.unused().pop() else {
            return Vec::new();
        };
        buffer
    }

    /// Keeps a buffer for later, unless it is larger than [`LARGEST`].
    pub(crate) fn give_back(&self, mut buffer: Vec<u8>) {
        if buffer.capacity() > 0 && buffer.capacity() <= LARGEST {
            buffer.clear();
            self.unused().push(buffer);
        }
    }

    /// Locks the buffers. No panic is possible while they are locked, so they are never damaged.
    fn unused(&self) -> MutexGuard<'_, Vec<Vec<u8>>> {
        locked(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use super::*;

    /// Answers each line with its number of bytes; a line with an `x` is wrong.
    fn answers(jobs: usize, input: &'static [u8]) -> (String, Option<(u64, u64)>) {
        let mut output = Vec::new();
        let input = LineInput {
            name: "a test".to_owned(),
            read: Box::new(input),
        };
        let done = answer_all(jobs, input, &mut output, "line", || {
            |line: &[u8], text: &mut Vec<u8>| {
                text.extend(line.len().to_string().bytes());
                if line.contains(&b'x') {
                    return Err("an x".to_owned());
                }
                Ok(())
            }
        });
        let wrong = match done {
            Err(CliError::Lines { bad, lines }) => Some((bad, lines)),
            _ => None,
        };
        (String::from_utf8(output).expect("text"), wrong)
    }

    #[test]
    fn answers_do_not_depend_on_the_number_of_threads() {
        let mut lines = String::new();
        for length in 0..20_000 {
            lines += &"a".repeat(length % 97);
            lines += if length % 1000 == 7 { "x\n" } else { "\n" };
        }
        let lines: &'static [u8] = lines.leak().as_bytes();
        let one = answers(1, lines);
        assert_eq!(one.1, Some((20, 20_000 - 206)));
        for jobs in [2, 3, 16] {
            assert_eq!(answers(jobs, lines), one, "{jobs} threads");
        }
    }

    #[test]
    fn the_last_line_needs_no_end() {
        for jobs in [1, 2] {
            assert_eq!(answers(jobs, b"abc\n\nab").0, "3\n2\n");
            assert_eq!(answers(jobs, b"").0, "");
            let wrong = answers(jobs, b"a\n\nx");
            assert_eq!(wrong.0, "1\n{\"error\":\"line 3: an x\"}\n");
            assert_eq!(wrong.1, Some((1, 2)));
        }
    }

    fn lines(pieces: &[&[u8]]) -> Vec<(u64, Option<Vec<u8>>)> {
        struct Pieces(VecDeque<Vec<u8>>);
        impl Read for Pieces {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                let Some(mut piece) = self.0.pop_front() else {
                    return Ok(0);
                };
                let length = piece.len().min(buffer.len());
                buffer[..length].copy_from_slice(&piece[..length]);
                let rest = piece.split_off(length);
                if !rest.is_empty() {
                    self.0.push_front(rest);
                }
                Ok(length)
            }
        }
        let pieces = pieces.iter().map(|piece| piece.to_vec()).collect();
        let mut blocks = BlockReader::new(Pieces(pieces), Arc::default());
        let mut lines = Vec::new();
        while let Some(block) = blocks.next_block() {
            let block = block.expect("read");
            let own = block.lines();
            lines.extend(own.map(|(number, line)| (number, line.map(<[u8]>::to_vec))));
        }
        lines
    }

    #[test]
    fn lines_are_numbered_however_they_arrive() {
        let expected = vec![
            (1, Some(b"a".to_vec())),
            (2, Some(Vec::new())),
            (3, Some(b"bc".to_vec())),
        ];
        for pieces in [
            &[&b"a\n\nbc\n"[..]][..],
            &[b"a\n\nbc"],
            &[b"a", b"\n", b"\nb", b"c"],
            &[b"a\n", b"\n", b"bc", b"\n"],
        ] {
            assert_eq!(lines(pieces), expected, "{pieces:?}");
        }
        assert_eq!(lines(&[]), []);
    }

    #[test]
    fn a_line_that_is_too_long_is_skipped() {
        let longest = vec![b'y'; MAX_LINE];
        let longer = vec![b'z'; MAX_LINE + 1];
        let found = lines(&[&longest, b"\n", &longer, b"\na\n", &longer, &longer]);
        let lengths: Vec<_> = found
            .iter()
            .map(|(number, line)| (*number, line.as_ref().map(Vec::len)))
            .collect();
        assert_eq!(
            lengths,
            [(1, Some(MAX_LINE)), (2, None), (3, Some(1)), (4, None)]
        );
    }
}
