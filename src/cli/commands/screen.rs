//! `taxel` without a command: opens the screen, and with `--record` records what is typed as a script.
//!
//! A record is a script (`taxel script`): the sensor, the seed and the screen's size, then every key. It is written as
//! things happen, so that it survives a crash, and never replaces a file.

use std::fs::File;
use std::hash::{BuildHasher, RandomState};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use taxel_core::sensor::SENSOR_PARAMETERS;
use taxel_files::formats::file::{system_reason, write_reason};
use taxel_files::storage::ModelCache;

use crate::cli::arguments::parameters::SensorFlags;
use crate::cli::output::charset::Charset;
use crate::cli::settings::{Choice, Choosable, Settings};
use crate::cli::{Context, Failure};
use crate::tui::app::{App, Message, Options};
use crate::tui::jobs::Jobs;
use crate::tui::live::{LiveMessage, WatchRequest};
use crate::tui::script::runner::size;
use crate::tui::terminal;
use crate::tui::terminal::input::Input;
use crate::tui::terminal::settings::{Flags, TerminalSettings};
use crate::tui::widget::{ColorDepth, Palette};

/// How the screen looks, for terminals that do not describe themselves well.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct Look {
    /// Colours: auto, never, 16, 256 or true
    #[arg(long, value_parser = choice::<ColorDepth>(), value_name = "COLOR", hide_possible_values = true, help_heading = "Terminal")]
    pub(crate) color: Option<Choice<ColorDepth>>,
    /// Theme: auto, dark, light or mono
    #[arg(long, value_parser = choice::<Palette>(), value_name = "THEME", hide_possible_values = true, help_heading = "Terminal")]
    pub(crate) theme: Option<Choice<Palette>>,
    /// Leave the mouse to the terminal
    #[arg(long, help_heading = "Terminal")]
    pub(crate) no_mouse: bool,
}

fn choice<T: Choosable>() -> impl TypedValueParser<Value = Choice<T>> {
    PossibleValuesParser::new(Choice::<T>::names())
        .map(|name| Choice::named(&name).unwrap_or_default())
}

#[derive(Debug, clap::Args)]
pub(crate) struct Screen {
    #[command(flatten)]
    sensor: SensorFlags,
    #[command(flatten)]
    look: Look,
    /// Columns and rows of the screen
    #[arg(long, value_name = "CxR", value_parser = size, help_heading = "Terminal")]
    size: Option<(u16, u16)>,
    /// Record the keys that you type as a script in a new file
    #[arg(long, value_name = "FILE", help_heading = "Terminal")]
    record: Option<PathBuf>,
}

impl Screen {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let settings = cx.settings.with(&self.look, &self.sensor)?;
        open(cx, &settings, self.size, self.record, None)
    }
}

/// Runs the screen until the user quits; with a source, its live page is open.
pub(crate) fn open(
    cx: &Context,
    settings: &Settings,
    size: Option<(u16, u16)>,
    record: Option<PathBuf>,
    watched: Option<WatchRequest>,
) -> Result<(), Failure> {
    let flags = Flags {
        color: settings.color.made(),
        palette: settings.theme.made(),
        // A locale that is not UTF-8 means ASCII; a UTF-8 locale tells nothing about the terminal's font.
        ascii: match settings.charset {
            Choice::Made(charset) => Some(charset == Charset::Ascii),
            Choice::Auto => (Charset::current() == Charset::Ascii).then_some(true),
        },
        no_mouse: !settings.mouse,
        size,
    };
    let terminal = TerminalSettings::from_environment(std::env::var_os, &flags);
    let options = Options {
        sensor: settings.sensor.sensor,
        theme: terminal.theme,
        // A different seed each time.
        seed: RandomState::new().hash_one(0),
    };
    let world = Jobs::new(cx.shelf.library()?).with_model_cache(ModelCache::of_user());
    let mut app = App::new(&options);
    app.keymap = settings.keymap().clone();
    app.watch_settings = settings.watch_request();
    let first = watched.map(|request| Message::Live(LiveMessage::Watch(Arc::new(request))));
    let record = record.map(|path| Record::begin(&path, &options));
    let mut record = record.transpose()?;
    let mut watch = |input: &Input| {
        if let Some(record) = &mut record {
            record.add(input);
        }
    };
    let status = terminal::run(app, first, world, &terminal, &mut watch)?;
    match record.map(|record| (record.name, record.written)) {
        Some((name, Err(error))) => {
            let reason = system_reason(&error);
            cx.note(&format!("error: {name}: the record ends early: {reason}"));
            // The reason that ended the program takes precedence.
            Err(Failure::silent(if status == 0 { 1 } else { status }))
        }
        _ if status == 0 => Ok(()),
        _ => Err(Failure::silent(status)),
    }
}

struct Record {
    /// Its name, for messages.
    name: String,
    file: File,
    is_sized: bool,
    /// After an error nothing more is written, so that there is no gap.
    written: io::Result<()>,
}

impl Record {
    /// Creates the file, which must not exist: it may be another record.
    fn begin(path: &Path, options: &Options) -> Result<Self, Failure> {
        let name = path.to_string_lossy().into_owned();
        let mut file = match File::create_new(path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                return Err(Failure::new(format!(
                    "{name:?} already exists and is not replaced"
                )));
            }
            Err(error) => {
                let reason = write_reason(&error);
                return Err(Failure::new(format!("{name}: cannot record: {reason}")));
            }
        };
        let mut head = format!("Seed {}\n", options.seed);
        for &parameter in SENSOR_PARAMETERS {
            if let Some(value) = options.sensor.get(parameter) {
                head += &format!("Set {} {value}\n", parameter.flag());
            }
        }
        let written = file.write_all(head.as_bytes());
        Ok(Self {
            name,
            file,
            is_sized: false,
            written,
        })
    }

    fn add(&mut self, input: &Input) {
        let line = match input {
            Input::Key(key) => format!("Keys {key}\n"),
            Input::Size(columns, rows) if !self.is_sized => {
                self.is_sized = true;
                format!("Size {columns}x{rows}\n")
            }
            _ => return,
        };
        if self.written.is_ok() {
            self.written = self.file.write_all(line.as_bytes());
        }
    }
}
