//! `taxel` without a command: opens the screen, and with `--record` records what is typed as a script.
//!
//! A record is a script (`taxel script`): the sensor and the look, then every key, every act of the mouse and every
//! change of the screen's size. It has no shapes of the library and no frames. It is written as things happen, so that
//! it survives a crash, and never replaces a file.

use std::fs::File;
use std::hash::{BuildHasher, RandomState};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use taxel_files::formats::file::system_reason;
use taxel_files::storage::ModelCache;

use crate::cli::error::CliError;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::{Charset, note};
use crate::cli::settings::resolved::Effective;
use crate::tui::app::message::{Message, WorkerEvent};
use crate::tui::app::state::{App, Options};
use crate::tui::live::message::{LiveMessage, WatchRequest};
use crate::tui::runtime::World;
use crate::tui::runtime::mailbox::{self, Sender};
use crate::tui::script::command::of_options;
use crate::tui::script::record::Recorder;
use crate::tui::terminal;
use crate::tui::terminal::input::Input;
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
    let world = World::new(shelf.library()?).with_model_cache(ModelCache::of_user());
    let (sender, mailbox) = mailbox::new().map_err(CliError::Screen)?;
    let app = App::new(&options)
        .with_keymap(settings.keymap().clone())
        .with_watch_settings(settings.sensors().request());
    let first = watched.map(|request| Message::Live(LiveMessage::Watch(Arc::new(request))));
    // What earlier runs remembered is not in a record.
    let (world, mut record) = match record {
        Some(path) => {
            let record = ScreenRecord::begin(&path, &options, sender.clone())?;
            (world.without_reminders(), Some(record))
        }
        None => (world, None),
    };
    let mut watch = |input: &Input| {
        if let Some(record) = &mut record {
            record.input(input);
        }
    };
    let ended = terminal::run(app, first, world, &terminal, (sender, mailbox), &mut watch);
    let is_whole = record.is_none_or(|record| record.end(charset));
    match ended.map_err(CliError::Screen)?.status() {
        0 => Ok(u8::from(!is_whole)),
        // The reason that ended the program takes precedence.
        status => Ok(status),
    }
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
    /// Its name, for messages.
    name: String,
    file: File,
    recorder: Recorder,
    /// Where the screen is told that the record has failed.
    sender: Sender,
    /// The error that ended the record: after it nothing more is written, so that there is no gap.
    failed: Option<io::Error>,
}

impl ScreenRecord {
    /// Creates the file, which must not exist: it may be another record.
    fn begin(path: &Path, options: &Options, sender: Sender) -> Result<Self, CliError> {
        let name = path.to_string_lossy().into_owned();
        let file = match File::create_new(path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                return Err(CliError::Recorded { name });
            }
            Err(error) => return Err(CliError::Record { name, error }),
        };
        let recorder = Recorder::new(&of_options(options));
        Ok(Self {
            name,
            file,
            recorder,
            sender,
            failed: None,
        })
    }

    fn input(&mut self, input: &Input) {
        let lines = self.recorder.lines(input);
        self.write(&lines);
    }

    fn write(&mut self, lines: &str) {
        if self.failed.is_some() {
            return;
        }
        if let Err(error) = self.file.write_all(lines.as_bytes()) {
            let reason = system_reason(&error);
            let reason = format!("{}: the record ends here: {reason}", self.name);
            self.sender
                .send(Message::Worker(WorkerEvent::Refused(reason)));
            self.failed = Some(error);
        }
    }

    /// Writes the last line, and returns true if the record is whole. If it is not, a note says why.
    fn end(mut self, charset: Charset) -> bool {
        let last = self.recorder.end();
        self.write(&last);
        if let Some(error) = &self.failed {
            let reason = system_reason(error);
            let text = format!("error: {}: the record ends early: {reason}", self.name);
            note(&text, charset);
        }
        self.failed.is_none()
    }
}
