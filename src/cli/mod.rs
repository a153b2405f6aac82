//! The command line: `taxel COMMAND`. Without a command the screen opens.
//!
//! ```text
//! arguments -> clap -> Program (program.rs) -> its command, a file each in commands/
//!   + settings: flag, environment, file, default (settings.rs) -> Context
//!   -> its run(&Context); shapes and files come from input/ -> text or JSON (output/) -> standard output
//! Failure (failure.rs) -> message on standard error, exit status
//! ```
//!
//! Answers go to standard output. Messages go to standard error, one line each; those about failures start with
//! `error:`. The exit status is:
//!
//! | status | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | the input was wrong: a file, a shape, a line of a batch, a size, place, sensor or threshold out of range |
//! | 2 | the command, the settings or the script was wrong: an unknown flag, a value that a flag cannot take |
//! | 3 | the program ended before its script did |
//! | 128 + n | signal n ended the command |
//!
//! A closed pipe, as in `taxel batch | head -1`, is not an error: the program stops and returns 0. Escape codes are
//! written only by the screen, and by the progress bar of a sweep if standard error is a terminal.

pub(crate) mod failure;

mod signals;

mod program;

mod output;

pub(crate) mod input;

pub(crate) mod arguments;

pub mod settings;

pub(crate) mod commands;

use std::ffi::OsString;
use std::io::{self, Write};

use clap::FromArgMatches;

pub(crate) use failure::{Failure, Named};
use input::shapes::Shelf;
use output::charset::Charset;
use program::{Program, Subcommands};
use settings::{Choice, Settings};

/// Runs the program with the given arguments and returns its exit status. The first argument is the program's own name.
///
/// All output is written here or below: the answer to standard output, messages to standard error. If standard error
/// cannot be written to, the exit status still tells what happened.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    signals::outlive_file_limit();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    Charset::of(&arguments, std::env::var_os).set();
    let Err(failure) = perform(arguments) else {
        return 0;
    };
    if let Some(message) = failure.message(Charset::current()) {
        // If not even this can be written, the exit status still tells.
        let _ = io::stderr().lock().write_all(message.as_bytes());
    }
    failure.status
}

fn perform(arguments: Vec<OsString>) -> Result<(), Failure> {
    let matches = match program::read(arguments) {
        Ok(matches) => matches,
        Err(error) if error.use_stderr() => return Err(error.into()),
        Err(help) => {
            let help = help.render().to_string();
            return write(Charset::current().lines(&help).as_bytes());
        }
    };
    let program = Program::from_arg_matches(&matches)?;
    let global = program.global;
    let mut settings = match (&program.command, global.config) {
        // The output of these does not depend on settings.
        (Some(Subcommands::Completions(_) | Subcommands::Man(_)), _)
        | (Some(Subcommands::Script(_)), None) => Settings::default(),
        (_, asked) => Settings::find(asked)?,
    }
    .with_environment();
    if global.ascii {
        settings.charset = Choice::Made(Charset::Ascii);
    }
    let asked = global.library.is_some();
    settings.library = global.library.or(settings.library);
    if let Some(charset) = settings.charset.made() {
        charset.set();
    }
    let cx = Context {
        shelf: Shelf {
            folder: settings.library.clone(),
            asked,
            ..Shelf::default()
        },
        settings,
    };
    match program.command {
        Some(command) => command.run(&cx),
        None => program.screen.run(&cx),
    }
}

/// What every command has at hand.
#[derive(Debug)]
pub(crate) struct Context {
    pub(crate) settings: Settings,
    pub(crate) shelf: Shelf,
}

#[expect(clippy::unused_self, reason = "output is at hand with the context")]
impl Context {
    /// Prints lines of text to standard output.
    pub(crate) fn print(&self, text: &str) -> Result<(), Failure> {
        self.write(Charset::current().lines(text).as_bytes())
    }

    pub(crate) fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        write(bytes)
    }

    pub(crate) fn note(&self, text: &str) {
        note(text);
    }
}

/// Writes a line to standard error. If it cannot be written, it is dropped: it is not part of the answer.
fn note(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", Charset::current().line(text));
}

fn write(bytes: &[u8]) -> Result<(), Failure> {
    let mut output = io::stdout().lock();
    let written = output.write_all(bytes).and_then(|()| output.flush());
    written.map_err(Failure::of_output)
}
