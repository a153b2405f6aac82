//! The command line: `taxel figure`, `picture`, `describe`, `export`, `batch`, `sweep`, `merge` and `library`; the
//! screen if no command is given; and `script`, `config`, `completions` and `man`.
//!
//! The way of a command through the folders of this room, which are listed below in this order:
//! ```text
//! arguments -> clap (arguments/definitions) -> Request (arguments/request)
//!   + settings: flag, environment, file, default (settings/)
//!   -> perform(), below -> commands/*.rs, one file each; shapes and files come from input/
//!   -> text or JSON (output/) -> standard output
//! CliError (error.rs) -> message on standard error, exit status
//! ```
//!
//! Answers go to standard output. Messages go to standard error, one line each; those about failures start with
//! `error:`. The exit status:
//!
//! | status | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | the input was wrong: a file, a shape, a line of a batch |
//! | 2 | the command, the settings or the script was wrong |
//! | 3 | the program ended before its script did; an answer is not the expected one |
//! | 128 + n | signal n ended the command |
//!
//! A closed pipe, as in `taxel batch | head -1`, is not an error: the program stops and returns 0. Only the screen
//! writes escape codes, and the progress bar of a sweep, if standard error is a terminal.

mod error;

mod signals;

mod output;

mod input;

mod arguments;

pub mod settings;

mod commands;

use std::ffi::OsString;
use std::io::{self, BufWriter, IsTerminal, Write};

use arguments::definitions;
use arguments::recognition::ModelRequest;
use arguments::request::{self, Asked, Chore, Request, Swept};
use commands::export::Exported;
use commands::frames::FramesOutput;
use commands::touch::Touched;
use commands::{
    batch, completions, confusion, describe, export, frames, library, man, model, noise, recognise,
    screen, script, separate, sweep, touch, watch,
};
use error::CliError;
use input::shapes::Shelf;
use output::charset::Charset;

/// Runs the program with the given arguments and returns its exit status. The first argument is the program's own name.
///
/// Everything the user sees is written here or below: the answer to standard output, messages to standard error. If
/// standard error cannot be written to, the exit status still tells what happened.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let mut charset = Charset::of(&arguments, std::env::var_os);
    let failure = match perform(arguments, &mut charset) {
        Ok(status) => return status,
        Err(failure) => failure,
    };
    if let Some(message) = failure.message(charset) {
        // Where not even this can be written, the exit status still tells.
        let _ = io::stderr().lock().write_all(message.as_bytes());
    }
    failure.status()
}

/// Reads the arguments and runs the command that they ask for.
///
/// `characters` is the character set for messages: at first that of the locale, then that of the settings, which are
/// known only once the arguments are read.
fn perform(arguments: Vec<OsString>, characters: &mut Charset) -> Result<u8, CliError> {
    let Asked {
        request,
        library_named,
        settings,
    } = request::read(arguments)?;
    let charset = settings.charset(*characters);
    *characters = charset;
    let shelf = Shelf::new(settings.library().cloned(), library_named);
    match request {
        Request::Settings => print(&settings.text(charset))?,
        Request::Help(text) => print(&charset.lines(&text))?,
        Request::Screen(size, record) => {
            return screen::screen(&settings, size, record, &shelf, charset, None);
        }
        Request::Script(asked) => script::run(&asked, &settings, &shelf, charset)?,
        Request::Figure(figure, sensor, form, kept) => {
            let touched = touch::touch(*figure, sensor, form, kept, &shelf, charset)?;
            answer(&touched, charset)?;
        }
        Request::Picture(what, given, form, kept) => {
            let (picture, sensor) = touch::picture(&what, &given, &shelf)?;
            let touched = touch::touch(picture, sensor, form, kept, &shelf, charset)?;
            answer(&touched, charset)?;
        }
        Request::Describe(what, form) => {
            print(&describe::content(&shelf.find(&what)?, form, charset))?;
        }
        Request::Export(what, export, pitch) => {
            match export::export(&shelf, &what, &export, pitch)? {
                Exported::Content(content) => write(&content)?,
                Exported::Said(said) => print(&(charset.line(&said).into_owned() + "\n"))?,
            }
        }
        Request::Batch(sensor) => {
            let by_name = |name: &str| shelf.imprint(name).map_err(|error| error.to_string());
            batch::answer_lines(sensor, &by_name, io::stdin().lock(), io::stdout().lock())?;
        }
        Request::Sweep(asked) => {
            let (source, sensor) = match asked.what {
                Swept::Figure(figure, sensor) => (figure, sensor),
                Swept::Picture(what, given) => touch::picture(&what, &given, &shelf)?,
            };
            let (grid, taken) = sweep::grid(source, sensor, asked.anchor, &asked.ranges)?;
            if !asked.wanted.quiet {
                for note in &taken {
                    self::note(note, charset);
                }
            }
            let (shard, jobs) = (asked.shard, asked.jobs);
            print(&sweep::sweep(&grid, shard, jobs, &asked.wanted, charset)?)?;
        }
        Request::Completions(shell) => write(&completions::script(shell, definitions::all()))?,
        Request::Man(None) => write(&man::main_page()?)?,
        Request::Man(Some(folder)) => man::write(&folder)?,
        Request::Merge(files, wanted) => print(&sweep::merge(&files, &wanted, charset)?)?,
        Request::Model(request) => run_model(request, &shelf, charset)?,
        Request::Recognise(asked) => {
            return recognise::recognise(&asked, &shelf, charset, &mut io::stdout().lock());
        }
        // On a terminal the frames are looked at; in a pipeline they are answered.
        Request::Watch(asked) if !asked.json && io::stdout().is_terminal() => {
            let watched = watch::request(&asked)?;
            return screen::screen(&settings, None, None, &shelf, charset, Some(watched));
        }
        Request::Watch(asked) => {
            return watch::watch(&asked, &mut |text| note(text, charset));
        }
        Request::Frames(asked, form, kept) => {
            let mut answers = BufWriter::new(io::stdout().lock());
            let output = FramesOutput {
                form,
                kept,
                shelf: &shelf,
                charset,
                answers: &mut answers,
                notes: &mut |text| note(text, charset),
            };
            let done = frames::frames(&asked, output);
            answers.flush().map_err(CliError::Write)?;
            done?;
        }
        Request::Library(chore) => self::chore(chore, &shelf, charset)?,
    }
    Ok(0)
}

/// Runs a subcommand of `taxel model`.
fn run_model(request: ModelRequest, shelf: &Shelf, charset: Charset) -> Result<(), CliError> {
    let text = match request {
        ModelRequest::Train(asked) => model::train(&asked, shelf, charset)?,
        ModelRequest::Show(which, json) => model::show(&which, json, shelf, charset)?,
        ModelRequest::List(json) => model::list(json, shelf, charset)?,
        ModelRequest::Delete(name) => charset.lines(&model::delete(&name, shelf)?),
        ModelRequest::Confusion(asked) => confusion::confusion(&asked, shelf, charset)?,
        ModelRequest::Touches(asked) => noise::touches(&asked, shelf, charset)?,
        ModelRequest::Separate(asked) => separate::separate(&asked, shelf, charset)?,
    };
    print(&text)
}

/// Runs a subcommand of `taxel library`.
fn chore(chore: Chore, shelf: &Shelf, charset: Charset) -> Result<(), CliError> {
    match chore {
        Chore::Names => print(&library::names(shelf)?),
        Chore::List(json) => print(&library::list(shelf, json, charset)?),
        Chore::Show(name, form) => print(&library::show(shelf, name.as_str(), form, charset)?),
        Chore::Save(saving, what) => print(&charset.lines(&library::save(shelf, saving, &what)?)),
        Chore::Delete(name) => print(&charset.lines(&library::delete(shelf, name.as_str())?)),
        Chore::Restore(name) => print(&charset.lines(&library::restore(shelf, name.as_str())?)),
        Chore::Path => {
            // As the system has it, so that other programs find it whatever its bytes are.
            let folder = shelf.library()?.folder().to_owned();
            write(&[folder.as_os_str().as_encoded_bytes(), b"\n"].concat())
        }
        Chore::Check => {
            let (text, broken, shapes) = library::check(shelf, charset)?;
            print(&text)?;
            match broken {
                0 => Ok(()),
                _ => Err(CliError::Shapes { broken, shapes }),
            }
        }
    }
}

/// Prints what a touch answers, and its notes to standard error.
fn answer(touched: &Touched, charset: Charset) -> Result<(), CliError> {
    write(&touched.answer)?;
    touched.notes.iter().for_each(|text| note(text, charset));
    Ok(())
}

/// Writes a note to standard error. A note that cannot be written is dropped: it is not part of the answer.
fn note(text: &str, charset: Charset) {
    let _ = writeln!(io::stderr().lock(), "{}", charset.line(text));
}

/// Writes text to standard output.
fn print(text: &str) -> Result<(), CliError> {
    write(text.as_bytes())
}

/// Writes bytes to standard output, at once.
///
/// # Errors
/// [`CliError::Write`], which is not reported if the pipe was closed at its other end.
fn write(bytes: &[u8]) -> Result<(), CliError> {
    let mut output = io::stdout().lock();
    output
        .write_all(bytes)
        .and_then(|()| output.flush())
        .map_err(CliError::Write)
}
