//! The command line: `taxel COMMAND`, as defined in `arguments`. Without a command the screen opens.
//!
//! A command passes through the folders of this room, which are declared below in this order:
//! ```text
//! arguments -> clap (arguments/definitions) -> Request (arguments/request)
//!   + settings: flag, environment, file, default (settings/)
//!   -> Surroundings::run, below -> commands/, a file or folder each; shapes and files come from input/
//!   -> text or JSON (output/) -> standard output
//! CliError (error.rs) -> message on standard error, exit status
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

mod signals;

mod output;

mod input;

mod arguments;

pub mod settings;

mod commands;

use std::ffi::OsString;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};

use taxel_core::sensor::Sensor;
use taxel_core::source::Source;

use crate::tui::live::message::WatchRequest;
use arguments::definitions;
use arguments::flags::Form;
use arguments::frames::FramesArguments;
use arguments::library::LibraryCommand;
use arguments::model::ModelRequest;
use arguments::request::{self, Invocation, Request};
use arguments::sweep::{SweepArguments, Swept};
use arguments::touch::Kept;
use commands::export::{self, Exported};
use commands::frames::{self, FramesOutput};
use commands::recognise::{self, FrameNamer};
use commands::{
    Summary, confusion, library, man, model, noise, screen, script, separate, sweep, touch, watch,
};
use error::CliError;
use input::lines::LineInput;
use input::shapes::Shelf;
use output::charset::{Charset, note};
use output::progress::ProgressDisplay;
use settings::resolved::Effective;

/// Runs the program with the given arguments and returns its exit status. The first argument is the program's own name.
///
/// All output is written here or below: the answer to standard output, messages to standard error. If standard error
/// cannot be written to, the exit status still tells what happened.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    signals::outlive_file_limit();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let mut charset = Charset::of(&arguments, std::env::var_os);
    let failure = match perform(arguments, &mut charset) {
        Ok(status) => return status,
        Err(failure) => failure,
    };
    if let Some(message) = failure.message(charset) {
        // If not even this can be written, the exit status still tells.
        let _ = io::stderr().lock().write_all(message.as_bytes());
    }
    failure.status()
}

/// Reads the arguments and runs their command. Returns the exit status.
///
/// `characters` is the character set for messages. It starts as that of the locale and becomes that of the settings,
/// which are known only after the arguments are read.
fn perform(arguments: Vec<OsString>, characters: &mut Charset) -> Result<u8, CliError> {
    let Invocation {
        request,
        library_named,
        settings,
    } = request::read(arguments)?;
    let charset = settings.charset(*characters);
    *characters = charset;
    let shelf = Shelf::new(settings.library.clone(), library_named);
    let surroundings = Surroundings {
        settings,
        shelf,
        charset,
    };
    surroundings.run(request)
}

struct Surroundings {
    settings: Effective,
    shelf: Shelf,
    charset: Charset,
}

impl Surroundings {
    fn run(&self, request: Request) -> Result<u8, CliError> {
        let (shelf, charset) = (&self.shelf, self.charset);
        match request {
            Request::Screen(size, record) => return self.screen(size, record, None),
            // On a terminal, a page shows the frames; in a pipeline, they are answered in lines.
            Request::Watch(asked) if !asked.json && io::stdout().is_terminal() => {
                return self.screen(None, None, Some(watch::request(&asked, shelf)?));
            }
            Request::Watch(asked) => {
                return watch::watch(&asked, shelf, &mut |text| note(text, charset));
            }
            Request::Recognise(asked) => {
                recognise::recognise(&asked, shelf, charset, &mut io::stdout().lock())?;
            }
            Request::Figure(figure, sensor, form, kept) => {
                self.touch(&figure, sensor, form, &kept)?;
            }
            Request::Picture(what, given, form, kept) => {
                let (picture, sensor) = touch::picture(&what, &given, shelf)?;
                self.touch(&picture, sensor, form, &kept)?;
            }
            Request::Describe(what, form) => {
                print(&touch::content(&shelf.find(&what)?, form, charset))?;
            }
            Request::Export(what, export, pitch) => {
                match export::export(shelf, &what, &export, pitch)? {
                    Exported::Content(content) => write(&content)?,
                    Exported::Said(said) => print(&(charset.line(&said).into_owned() + "\n"))?,
                }
            }
            Request::Batch(file, sensor, jobs) => {
                let by_name = |name: &str| shelf.imprint(name).map_err(|error| error.to_string());
                let input = match file {
                    Some(path) => LineInput::at(path)?,
                    None => LineInput::standard()?,
                };
                touch::answer_lines(sensor, jobs, &by_name, input, io::stdout().lock())?;
            }
            Request::Sweep(asked) => self.sweep(*asked)?,
            Request::Merge(files, wanted) => {
                print_summary(sweep::merge(&files, &wanted, charset)?)?;
            }
            Request::Model(request) => self.model(request)?,
            Request::Frames(asked, form, kept) => self.frames(&asked, form, kept)?,
            Request::Library(asked) => self.library(asked)?,
            Request::Help(text) => print(&charset.lines(&text))?,
            Request::Settings => print(&self.settings.text(charset))?,
            Request::Script(asked) => script::run(&asked, &self.settings, shelf, charset)?,
            Request::Completions(shell) => {
                let mut script = Vec::new();
                clap_complete::generate(shell, &mut definitions::all(), "taxel", &mut script);
                write(&script)?;
            }
            Request::Man(None) => write(&man::main_page()?)?,
            Request::Man(Some(folder)) => {
                print(&(charset.line(&man::write(&folder)?).into_owned() + "\n"))?;
            }
        }
        Ok(0)
    }

    fn screen(
        &self,
        size: Option<(u16, u16)>,
        record: Option<PathBuf>,
        watched: Option<WatchRequest>,
    ) -> Result<u8, CliError> {
        let (shelf, charset) = (&self.shelf, self.charset);
        screen::screen(&self.settings, size, record, shelf, charset, watched)
    }

    fn touch(
        &self,
        source: &Source,
        sensor: Sensor,
        form: Form,
        kept: &Kept,
    ) -> Result<(), CliError> {
        let touched = touch::touch(source, sensor, form, kept, &self.shelf, self.charset)?;
        write(&touched.answer)?;
        for text in &touched.notes {
            note(text, self.charset);
        }
        Ok(())
    }

    /// Runs `taxel sweep`. Notes on standard error warn of ranges that were chosen because they were not given.
    fn sweep(&self, asked: SweepArguments) -> Result<(), CliError> {
        let (source, sensor) = match asked.what {
            Swept::Figure(figure, sensor) => (figure, sensor),
            Swept::Picture(what, given) => touch::picture(&what, &given, &self.shelf)?,
        };
        let (grid, taken) = sweep::grid(source, sensor, asked.anchor, &asked.ranges)?;
        if !asked.wanted.quiet {
            for text in &taken {
                note(text, self.charset);
            }
        }
        let (shard, jobs, wanted) = (asked.shard, asked.jobs, &asked.wanted);
        print_summary(sweep::sweep(&grid, shard, jobs, wanted, self.charset)?)
    }

    /// Runs `taxel frames`. If an error occurs, the answers made before it are still printed.
    fn frames(&self, asked: &FramesArguments, form: Form, kept: Kept) -> Result<(), CliError> {
        let processing = input::recording::processing(&asked.processing)?;
        let model = asked.naming.find(&self.shelf)?;
        let recording = frames::open(asked)?;
        let progress = |poses| ProgressDisplay::new(poses, false, self.charset);
        let model = model
            .map(|model| model::ready(model, &progress))
            .transpose()?;
        let noise = asked.naming.noise_with(processing.view.mask.as_ref());
        let mut answers = BufWriter::new(io::stdout().lock());
        let output = FramesOutput {
            form,
            kept,
            shelf: &self.shelf,
            charset: self.charset,
            namer: model
                .as_ref()
                .map(|model| FrameNamer::new(model, noise.as_ref())),
            answers: &mut answers,
            notes: &mut |text| note(text, self.charset),
        };
        let done = frames::frames(asked, recording, &processing, output);
        answers.flush().map_err(CliError::Write)?;
        done
    }

    fn model(&self, request: ModelRequest) -> Result<(), CliError> {
        let (shelf, charset) = (&self.shelf, self.charset);
        let text = match request {
            ModelRequest::Train(asked) => {
                return print_summary(model::train(&asked, shelf, charset)?);
            }
            ModelRequest::Show(which, json) => model::show(&which, json, shelf, charset)?,
            ModelRequest::List(json) => model::list(json, shelf, charset)?,
            ModelRequest::Delete(name) => charset.lines(&model::delete(&name, shelf)?),
            ModelRequest::Confusion(asked) => confusion::confusion(&asked, shelf, charset)?,
            ModelRequest::Touches(asked) => noise::touches(&asked, shelf, charset)?,
            ModelRequest::Separate(asked) => separate::separate(&asked, shelf, charset)?,
        };
        print(&text)
    }

    fn library(&self, asked: LibraryCommand) -> Result<(), CliError> {
        let (shelf, charset) = (&self.shelf, self.charset);
        let is_list = matches!(asked, LibraryCommand::List(_));
        if let Some(text) = library::missing(shelf).filter(|_| is_list) {
            note(&text, charset);
        }
        let text = match asked {
            LibraryCommand::List(json) => library::list(shelf, json, charset)?,
            LibraryCommand::Show(name, form) => library::show(shelf, name.as_str(), form, charset)?,
            LibraryCommand::Save(saving, what) => {
                charset.lines(&library::save(shelf, saving, &what)?)
            }
            LibraryCommand::Delete(name) => library::delete(shelf, name.as_str(), charset)?,
            LibraryCommand::Restore(name) => {
                charset.lines(&library::restore(shelf, name.as_str())?)
            }
            LibraryCommand::Path => {
                let folder = shelf.library()?.folder().to_owned();
                return write(&path_line(&folder, io::stdout().is_terminal(), charset));
            }
            LibraryCommand::Check(json) => {
                let (text, result) = library::check(shelf, json, charset)?;
                print(&text)?;
                return result;
            }
        };
        print(&text)
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

fn print(text: &str) -> Result<(), CliError> {
    write(text.as_bytes())
}

fn print_summary(summary: Summary) -> Result<(), CliError> {
    print(&summary.text)?;
    summary.written
}

fn write(bytes: &[u8]) -> Result<(), CliError> {
    let mut output = io::stdout().lock();
    output
        .write_all(bytes)
        .and_then(|()| output.flush())
        .map_err(CliError::Write)
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
