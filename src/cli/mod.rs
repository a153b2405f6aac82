//! The command line: `taxel COMMAND`, as defined in `arguments`. Without a command the screen opens.
//!
//! ```text
//! arguments -> clap -> Program, below -> Command, a struct each in commands/
//!   + settings: flag, environment, file, default (settings/) -> Context
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
//! | 3 | the program ended before its script did; an answer is not the expected one |
//! | 128 + n | signal n ended the command |
//!
//! A closed pipe, as in `taxel batch | head -1`, is not an error: the program stops and returns 0. Escape codes are
//! written only by the screen, and by the progress bar of a sweep if standard error is a terminal.

mod error;

pub(crate) mod failure;

mod signals;

mod output;

mod input;

pub(crate) mod arguments;

pub mod settings;

mod commands;

use std::ffi::OsString;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use clap::FromArgMatches;

use arguments::help::{ABOUT, EXAMPLES};
use arguments::library::LibraryCommand;
use arguments::parameters::Given;
use arguments::request::{self, Request};
use commands::batch::Batch;
use commands::completions::Completions;
use commands::config::Config;
use commands::describe::Describe;
use commands::export::ExportCommand;
use commands::figure::Figure;
use commands::frames::Frames;
use commands::library;
use commands::man::Man;
use commands::merge::Merge;
use commands::model::ModelCommand;
use commands::picture::Picture;
use commands::recognise::Recognise;
use commands::screen::{Look, Screen};
use commands::script::Script;
use commands::sweep::Sweep;
use commands::watch::Watch;
use error::CliError;
use failure::Failure;
use input::shapes::Shelf;
use output::charset::Charset;
use settings::{Choice, Settings};

#[derive(Debug, clap::Parser)]
#[command(name = "taxel", version = env!("TAXEL_VERSION"), about = ABOUT, after_help = EXAMPLES)]
struct Program {
    #[command(flatten)]
    screen: Screen,
    #[command(flatten)]
    global: Global,
    #[command(subcommand)]
    command: Option<Command>,
}

/// The flags of all commands.
#[derive(Debug, clap::Args)]
struct Global {
    /// The library's folder
    #[arg(long, global = true, value_name = "DIR", help_heading = "Library")]
    library: Option<PathBuf>,
    /// Use this settings file instead of your own
    #[arg(long, global = true, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Use ASCII only, as if the locale were not UTF-8
    #[arg(long, global = true)]
    ascii: bool,
}

/// The commands; those that are still read by hand are in `arguments/request.rs`.
#[derive(Debug, clap::Subcommand)]
enum Command {
    Figure(Figure),
    Picture(Picture),
    Describe(Describe),
    #[command(name = "export")]
    Export(ExportCommand),
    Batch(Batch),
    Sweep(Box<Sweep>),
    Merge(Merge),
    Model(ModelCommand),
    #[command(alias = "recognize")]
    Recognise(Recognise),
    Frames(Box<Frames>),
    Watch(Box<Watch>),
    Config(Config),
    Completions(Completions),
    Man(Man),
    Script(Script),
}

impl Command {
    fn run(self, cx: &Context) -> Result<(), Failure> {
        match self {
            Self::Figure(command) => command.run(cx),
            Self::Picture(command) => command.run(cx),
            Self::Describe(command) => command.run(cx),
            Self::Export(command) => command.run(cx),
            Self::Batch(command) => command.run(cx),
            Self::Sweep(command) => command.run(cx),
            Self::Merge(command) => command.run(cx),
            Self::Model(command) => command.run(cx),
            Self::Recognise(command) => command.run(cx),
            Self::Frames(command) => command.run(cx),
            Self::Watch(command) => command.run(cx),
            Self::Config(command) => command.run(cx),
            Self::Completions(command) => command.run(cx),
            Self::Man(command) => command.run(cx),
            Self::Script(command) => command.run(cx),
        }
    }
}

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
    let matches = match request::read(arguments) {
        Ok(read) => read,
        Err(error) if error.use_stderr() => return Err(error.into()),
        Err(help) => {
            let help = help.render().to_string();
            return write(Charset::current().lines(&help).as_bytes());
        }
    };
    let global = Global::from_arg_matches(&matches)?;
    let mut settings = match (matches.subcommand_name(), global.config) {
        // The output of these does not depend on settings.
        (Some("completions" | "man"), _) | (Some("script"), None) => Settings::default(),
        (_, asked) => Settings::find(asked)?,
    }
    .with_environment();
    if global.ascii {
        settings.charset = Choice::Made(Charset::Ascii);
    }
    let is_library_named = global.library.is_some();
    settings.library = global.library.or(settings.library);
    let by_hand = matches
        .subcommand()
        .filter(|(name, _)| !<Command as clap::Subcommand>::has_subcommand(name));
    if let Some((_, own)) = by_hand {
        settings = settings.with(&Look::default(), &Given::of(own))?;
    }
    let charset = settings.charset.made().unwrap_or(Charset::current());
    charset.set();
    let shelf = Shelf::new(settings.library.clone(), is_library_named);
    let cx = Context {
        settings,
        shelf,
        charset,
    };
    if let Some((name, own)) = by_hand {
        let request = request::request(name, own, &cx.settings)?;
        return Ok(cx.run(request)?);
    }
    let program = Program::from_arg_matches(&matches)?;
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
    pub(crate) charset: Charset,
}

impl Context {
    /// Prints lines of text to standard output.
    pub(crate) fn print(&self, text: &str) -> Result<(), Failure> {
        self.write(self.charset.lines(text).as_bytes())
    }

    pub(crate) fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        write(bytes)
    }

    /// Writes a line to standard error. If it cannot be written, it is dropped: it is not part of the answer.
    pub(crate) fn note(&self, text: &str) {
        output::charset::note(text, self.charset);
    }
}

fn write(bytes: &[u8]) -> Result<(), Failure> {
    let mut output = io::stdout().lock();
    let written = output.write_all(bytes).and_then(|()| output.flush());
    written.map_err(Failure::of_output)
}

// The commands that are still read by hand.
impl Context {
    fn run(&self, request: Request) -> Result<(), CliError> {
        match request {
            Request::Library(asked) => self.library(asked)?,
        }
        Ok(())
    }

    fn library(&self, asked: LibraryCommand) -> Result<(), CliError> {
        let (shelf, charset) = (&self.shelf, self.charset);
        let is_list = matches!(asked, LibraryCommand::List(_));
        if let Some(text) = library::missing(shelf).filter(|_| is_list) {
            self.note(&text);
        }
        let text = match asked {
            LibraryCommand::List(json) => library::list(shelf, json, charset)?,
            LibraryCommand::Show(name, form) => library::show(shelf, name.as_str(), form, charset)?,
            LibraryCommand::Save(name, existing, what) => {
                charset.lines(&library::save(shelf, name, existing, &what)?)
            }
            LibraryCommand::Delete(name) => library::delete(shelf, name.as_str(), charset)?,
            LibraryCommand::Restore(name) => {
                charset.lines(&library::restore(shelf, name.as_str())?)
            }
            LibraryCommand::Path => {
                let folder = shelf.library()?.folder().to_owned();
                return Ok(self.write(&path_line(&folder, io::stdout().is_terminal(), charset))?);
            }
            LibraryCommand::Check(json) => {
                let (text, result) = library::check(shelf, json, charset)?;
                self.print(&text)?;
                return result;
            }
        };
        Ok(self.print(&text)?)
    }
}

/// Returns a path as a line of output: byte for byte, so that other programs find the file, but escaped like other text
/// on a terminal.
fn path_line(path: &Path, on_terminal: bool, charset: Charset) -> Vec<u8> {
    let path = path.as_os_str();
    let shown = on_terminal.then(|| charset.line(&path.to_string_lossy()).into_owned());
    let bytes = shown
        .as_ref()
        .map_or(path.as_encoded_bytes(), String::as_bytes);
    [bytes, b"\n"].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_escaped_on_a_terminal_only() {
        let path = Path::new("/é/\u{1b}]0;title\u{7}\u{202e}");
        let line = |on_terminal| {
            let line = path_line(path, on_terminal, Charset::Unicode);
            String::from_utf8(line).expect("UTF-8")
        };
        assert_eq!(line(false), format!("{}\n", path.display()));
        assert_eq!(line(true), "/é/\\u{1b}]0;title\\u{7}\\u{202e}\n");
    }
}
