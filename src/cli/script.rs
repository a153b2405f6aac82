//! The screen: on the terminal, recorded where that is asked for, or driven by a script without a terminal.

use std::fs::File;
use std::io::Write;
use std::path::PathBuf;

use super::arguments::Script;
use super::failure::Failure;
use super::input;
use super::locale::Charset;
use super::shelf::Shelf;
use crate::sensor::Sensor;
use crate::tui::app::{App, Options};
use crate::tui::effect::World;
use crate::tui::key::parse;
use crate::tui::script::command::ScriptError;
use crate::tui::script::record::Recorder;
use crate::tui::script::runner::{self, Settings as Running};
use crate::tui::terminal;
use crate::tui::terminal::settings::{Flags, Settings};
use crate::tui::theme::Theme;

/// Runs the program on the terminal; the exit status tells how it ended.
pub(super) fn screen(
    sensor: Sensor,
    flags: Flags,
    record: Option<PathBuf>,
    shelf: &Shelf,
    charset: Charset,
) -> Result<u8, Failure> {
    let flags = Flags {
        ascii: charset == Charset::Ascii,
        ..flags
    };
    let settings = Settings::from_environment(std::env::var_os, &flags);
    let app = App::new(&Options {
        sensor,
        theme: settings.theme(),
    });
    let world = World::new(shelf.library()?);
    let file = record
        .map(File::create)
        .transpose()
        .map_err(Failure::Write)?;
    let mut recorder = Recorder::default();
    let mut watch = |input: &terminal::input::Input| {
        if let Some(mut file) = file.as_ref() {
            // A disk that is full must not end the program; the record ends instead.
            let _ = file.write_all(recorder.line(input).as_bytes());
        }
    };
    let outcome = terminal::run(app, world, &settings, &mut watch).map_err(Failure::Screen)?;
    Ok(outcome.status())
}

/// Runs a script; answers what it prints, and whether all of it held: what was printed before something did not tells how
/// it came to that.
pub(super) fn run(
    asked: &Script,
    shelf: &Shelf,
    charset: Charset,
) -> Result<(String, Result<(), runner::Failure>), Failure> {
    let script = match &asked.place {
        Some(place) => input::text(place).map_err(|error| Failure::NoScript {
            name: place.name(),
            error,
        })?,
        None => String::new(),
    };
    let keys = parse(asked.keys.as_deref().unwrap_or(""));
    let keys = keys.map_err(|error| {
        runner::Failure::Script(ScriptError {
            line: 0,
            message: error.to_string(),
        })
    })?;
    let world = match shelf.named()? {
        Some(library) => World::quiet(library),
        None => World::scratch().map_err(Failure::Screen)?,
    };
    let options = Options {
        sensor: Sensor::default(),
        theme: Theme::plain(charset == Charset::Ascii),
    };
    let running = Running {
        options,
        size: asked.size,
        styles: asked.styles,
        json: asked.json,
    };
    let mut printed = String::new();
    let result = runner::run(&script, &keys, &running, world, |text| {
        printed.push_str(text);
    });
    Ok((printed, result))
}
