//! `taxel` without a command: opens the screen, and with `--record` records what is typed as a script.
//!
//! A record is a script (`taxel script`) that does the same again: first the sensor, the look and unsaved work, then
//! every key and every change of the screen's size. A shape of the user's is recorded after the key that used it; for
//! shapes that were only listed, the name is enough. The record is written as things happen, so that it survives a
//! crash, and never replaces a file.

use std::cell::RefCell;
use std::fs::{self, File};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use crate::cli::error::CliError;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::Charset;
use crate::cli::output::note::note;
use crate::cli::output::record_writer::RecordWriter;
use crate::cli::settings::resolved::Effective;
use crate::formats::file::system_reason;
use crate::storage::{Library, ModelCache, Orphan};
use crate::tui::app::message::Message;
use crate::tui::app::state::{App, Options};
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::live::message::LiveMessage;
use crate::tui::live::request::WatchRequest;
use crate::tui::runtime::World;
use crate::tui::runtime::mailbox::{self, Sender};
use crate::tui::script::record::Recorder;
use crate::tui::script::setting::{ScriptSetting, of_options};
use crate::tui::terminal;
use crate::tui::terminal::settings::{Flags, TerminalSettings};

/// Runs the screen until the user quits, and returns the exit status.
///
/// With `watched`, it starts with the frames of this source.
pub(crate) fn screen(
    settings: &Effective,
    size: Option<(u16, u16)>,
    record: Option<PathBuf>,
    shelf: &Shelf,
    charset: Charset,
    watched: Option<WatchRequest>,
) -> Result<u8, CliError> {
    let terminal = terminal_settings(settings, size, charset);
    let options = Options {
        sensor: settings.sensor,
        theme: terminal.theme(),
        // A different seed each time.
        seed: RandomState::new().hash_one(0),
    };
    let library = shelf.library()?;
    let (sender, mailbox) = mailbox::new().map_err(CliError::Screen)?;
    let record = record
        .map(|path| ScreenRecord::begin(path, &options, &library, sender.clone()))
        .transpose()?;
    // Inputs and shapes reach the record from two places.
    let record = Rc::new(RefCell::new(record));
    let mut watch = |event: terminal::SessionEvent<'_>| {
        if let Some(record) = &mut *record.borrow_mut() {
            let lines = record.recorder.lines(event);
            record.writer.write(lines);
        }
    };
    let app = App::new(&options)
        .with_keymap(settings.keymap().clone())
        .with_watch_settings(settings.sensors().request());
    let mut world = World::new(library).with_model_cache(ModelCache::of_user());
    if record.borrow().is_some() {
        let record = Rc::clone(&record);
        let log = move |shape| {
            if let Some(record) = &mut *record.borrow_mut() {
                let line = record.recorder.shape(shape);
                record.writer.write(line);
            }
        };
        world = world.without_reminders().with_shape_log(Box::new(log));
    }
    let first = watched.map(|request| Message::Live(LiveMessage::Watch(Arc::new(request))));
    let ended = terminal::run(app, first, world, &terminal, (sender, mailbox), &mut watch);
    let outcome = ended.as_ref().ok().copied();
    let record = record.take();
    let is_whole = record.is_none_or(|record| is_whole(record, outcome, charset));
    match ended.map_err(CliError::Screen)?.status() {
        0 => Ok(u8::from(!is_whole)),
        // The reason that ended the program takes precedence.
        status => Ok(status),
    }
}

fn is_whole(record: ScreenRecord, outcome: Option<terminal::Outcome>, charset: Charset) -> bool {
    let name = record.path.to_string_lossy().into_owned();
    let ended = record.end(outcome);
    if let Err(error) = &ended {
        let reason = system_reason(error);
        let text = format!("error: {name}: the record ends early: {reason}");
        note(&text, charset);
    }
    ended.is_ok()
}

fn terminal_settings(
    settings: &Effective,
    size: Option<(u16, u16)>,
    charset: Charset,
) -> TerminalSettings {
    // A locale that is not UTF-8 means ASCII; a UTF-8 locale tells nothing about the terminal's font.
    let ascii = (charset == Charset::Ascii).then_some(true);
    let flags = Flags {
        color: settings.color,
        palette: settings.theme,
        ascii: settings.ascii.or(ascii),
        no_mouse: !settings.mouse,
        size,
    };
    TerminalSettings::from_environment(std::env::var_os, &flags)
}

struct ScreenRecord {
    path: PathBuf,
    writer: RecordWriter,
    /// The recorder, which turns events into lines of a script.
    recorder: Recorder,
}

impl ScreenRecord {
    /// Creates the file, which must not exist: it may be another record.
    fn begin(
        path: PathBuf,
        options: &Options,
        library: &Library,
        sender: Sender,
    ) -> Result<Self, CliError> {
        // The file comes last: if something else failed, it would be left behind and prevent the next try.
        let mut start = of_options(options);
        start.extend(found(library));
        let name = path.to_string_lossy().into_owned();
        let file = File::create_new(&path).map_err(|error| {
            let name = name.clone();
            match error.kind() {
                ErrorKind::AlreadyExists => CliError::Recorded {
                    name,
                    free: free(&path).to_string_lossy().into_owned(),
                },
                _ => CliError::Record { name, error },
            }
        })?;
        let on_failure = move |error: &io::Error| {
            let reason = format!("{name}: the record ends here: {}", system_reason(error));
            sender.send(Message::Worker(WorkerEvent::Refused(reason)));
        };
        Ok(Self {
            writer: RecordWriter::start(path.clone(), file, Arc::new(on_failure)),
            path,
            recorder: Recorder::new(&start),
        })
    }

    fn end(mut self, outcome: Option<terminal::Outcome>) -> io::Result<()> {
        if let Some(outcome) = outcome {
            let lines = self.recorder.end(outcome);
            self.writer.write(lines);
        }
        self.writer.finish()
    }
}

fn found(library: &Library) -> impl Iterator<Item = ScriptSetting> {
    let left = Orphan::all(library).into_iter();
    left.map(|orphan| ScriptSetting::Leftover(Box::new(orphan.shape)))
}

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
