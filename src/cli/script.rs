//! The screen driven by a script, without a terminal.

use std::fs;
use std::io::{self, Write};
use std::ops::ControlFlow;

use super::arguments::Script;
use super::effective::Effective;
use super::failure::Failure;
use super::input::Place;
use super::locale::Charset;
use super::shelf::Shelf;
use crate::tui::app::Options;
use crate::tui::effect::World;
use crate::tui::key::parse;
use crate::tui::script::command::ScriptError;
use crate::tui::script::runner::{self, Settings as Running};
use crate::tui::theme::Theme;

/// Runs a script, and prints what it asks for as it comes.
pub(super) fn run(
    asked: &Script,
    settings: &Effective,
    shelf: &Shelf,
    charset: Charset,
) -> Result<(), Failure> {
    let name = asked.place.as_ref().map(Place::name);
    let script = match &asked.place {
        Some(place) => text(place).map_err(|error| Failure::NoScript {
            name: place.name(),
            error: error.into(),
        })?,
        None => String::new(),
    };
    let keys = parse(asked.keys.as_deref().unwrap_or("")).map_err(|error| Failure::Script {
        name: None,
        failure: runner::Failure::Script(ScriptError {
            line: 0,
            message: error.to_string(),
        }),
    })?;
    let world = match shelf.named()? {
        Some(library) => World::quiet(library),
        None => World::scratch().map_err(Failure::Screen)?,
    };
    let options = Options {
        sensor: settings.sensor(),
        theme: Theme::plain(charset == Charset::Ascii),
    };
    let running = Running {
        options,
        size: asked.size,
        styles: asked.styles,
        json: asked.json,
        keymap: settings.keymap().clone(),
    };
    let (mut output, mut lost) = (io::stdout().lock(), None);
    let print = |text: &str| {
        let written = output.write_all(text.as_bytes());
        match written.and_then(|()| output.flush()) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                lost = Some(error);
                ControlFlow::Break(())
            }
        }
    };
    let result = runner::run(&script, &keys, &running, world, print);
    match lost {
        Some(error) => Err(Failure::Write(error)),
        None => result.map_err(|failure| Failure::Script { name, failure }),
    }
}

/// Any text, however long: a record of a library holds all of it. What is not UTF-8 is replaced.
fn text(place: &Place) -> io::Result<String> {
    let bytes = match place {
        Place::File(path) => fs::read(path)?,
        Place::Standard => {
            let mut bytes = Vec::new();
            io::Read::read_to_end(&mut io::stdin().lock(), &mut bytes)?;
            bytes
        }
    };
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
