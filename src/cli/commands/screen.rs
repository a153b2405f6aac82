//! The screen on the terminal, recorded where that is asked for.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::cli::error::CliError;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::Charset;
use crate::cli::settings::resolved::Effective;
use crate::storage::{Library, Orphan, ShapeOrigin};
use crate::tui::app::state::{App, Options};
use crate::tui::runtime::World;
use crate::tui::script::record::Recorder;
use crate::tui::script::setting::{ScriptSetting, of_options};
use crate::tui::terminal;
use crate::tui::terminal::settings::{Flags, TerminalSettings};

/// Runs the program on the terminal; the exit status tells how it ended.
pub(crate) fn screen(
    settings: &Effective,
    size: Option<(u16, u16)>,
    record: Option<PathBuf>,
    shelf: &Shelf,
    charset: Charset,
) -> Result<u8, CliError> {
    // A locale without UTF-8 is as good as a flag; one with it does not speak for the terminal.
    let ascii = (charset == Charset::Ascii).then_some(true);
    let flags = Flags {
        color: settings.color(),
        palette: settings.theme(),
        ascii: settings.ascii().or(ascii),
        no_mouse: !settings.mouse(),
        size,
    };
    let terminal = TerminalSettings::from_environment(std::env::var_os, &flags);
    let options = Options {
        sensor: settings.sensor(),
        theme: terminal.theme(),
        mouse: terminal.mouse,
    };
    let library = shelf.library()?;
    let mut record = record
        .map(|path| ScreenRecord::begin(path, &options, &library))
        .transpose()?;
    let mut watch = |input: &terminal::input::Input| {
        if let Some(record) = &mut record {
            let lines = record.recorder.lines(input);
            record.write(&lines);
        }
    };
    let app = App::new(&options).with_keymap(settings.keymap().clone());
    let ended = terminal::run(app, World::new(library), &terminal, &mut watch);
    if let Some(record) = record {
        let name = record.path.to_string_lossy().into_owned();
        if let Err(error) = record.end(ended.as_ref().ok().copied()) {
            // The screen did what it should: its status stays.
            let message = format!("error: {name}: the record ends early: {error}");
            let _ = writeln!(io::stderr().lock(), "{}", charset.line(&message));
        }
    }
    Ok(ended.map_err(CliError::Screen)?.status())
}

/// A record that is being written.
struct ScreenRecord {
    path: PathBuf,
    /// Why nothing more is written, once something could not be.
    file: io::Result<File>,
    recorder: Recorder,
    begun: bool,
}

impl ScreenRecord {
    /// A new file: one that is there may be the record of something else.
    fn begin(path: PathBuf, options: &Options, library: &Library) -> Result<Self, CliError> {
        // All that may fail before there is a file, which would be in the way of the next try.
        let mut start = of_options(options);
        start.extend(found(library)?);
        let file = File::create_new(&path).map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => CliError::Recorded {
                name: path.to_string_lossy().into_owned(),
                free: free(&path).to_string_lossy().into_owned(),
            },
            _ => CliError::Record {
                name: path.to_string_lossy().into_owned(),
                error,
            },
        })?;
        Ok(Self {
            path,
            file: Ok(file),
            recorder: Recorder::new(&start),
            begun: false,
        })
    }

    fn write(&mut self, lines: &str) {
        self.begun |= !lines.is_empty();
        // A disk that is full must not end the program; the record ends instead, without a gap.
        if let Ok(file) = &mut self.file
            && let Err(error) = file.write_all(lines.as_bytes())
        {
            self.file = Err(error);
        }
    }

    /// The last lines; a record of nothing goes again.
    fn end(mut self, outcome: Option<terminal::Outcome>) -> io::Result<()> {
        if let Some(outcome) = outcome {
            let lines = self.recorder.end(outcome);
            self.write(&lines);
        }
        if !self.begun {
            // An empty file is left then, and told by nobody.
            let _ = fs::remove_file(&self.path);
        }
        self.file.map(drop)
    }
}

/// What the program finds at its start: the user's shapes, but for those that cannot be read, and unsaved work.
fn found(library: &Library) -> Result<Vec<ScriptSetting>, CliError> {
    let own = library.list()?;
    let own = own.iter().filter(|entry| entry.origin == ShapeOrigin::Own);
    let shapes = own.filter_map(|entry| library.load(&entry.name).ok());
    let shapes = shapes.map(|loaded| ScriptSetting::Shape(Box::new(loaded.shape)));
    let left = Orphan::all(library).into_iter();
    let left = left.map(|orphan| ScriptSetting::Leftover(Box::new(orphan.shape)));
    Ok(shapes.chain(left).collect())
}

/// A name like that of a file which is not there yet.
fn free(path: &Path) -> PathBuf {
    let last = path.with_extension("new");
    let Some(stem) = path.file_stem().map(|stem| stem.to_string_lossy()) else {
        return last;
    };
    let end = path.extension().map(|end| end.to_string_lossy());
    let end = end.map_or(String::new(), |end| format!(".{end}"));
    let names = (2..).map(|number| path.with_file_name(format!("{stem}-{number}{end}")));
    let is_free = |path: &PathBuf| {
        let there = fs::symlink_metadata(path);
        there.is_err_and(|error: io::Error| error.kind() == ErrorKind::NotFound)
    };
    names.take(1000).find(is_free).unwrap_or(last)
}
