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
use std::sync::Arc;

use crate::cli::error::CliError;
use crate::cli::input::content::{self, InputSource};
use crate::cli::input::lines::block::{Block, BlockReader};
use crate::cli::input::lines::buffers::Buffers;
use crate::cli::threads;
use crate::formats::file::without_mark;
use crate::formats::json;

pub(crate) mod block;
mod buffers;
pub(crate) mod in_order;

pub(crate) use block::MAX_LINE;

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

/// Answers each line of `input`, with up to `jobs` threads (0 for the default, [`threads::count`]). The answers do not
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
        threads::count(jobs),
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

#[cfg(test)]
mod tests {
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
}
