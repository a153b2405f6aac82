//! The screen driven by a script, without a terminal.

use std::fs;
use std::io::{self, Write};
use std::ops::ControlFlow;

use super::effective::Effective;
use super::export;
use super::failure::Failure;
use super::input::Place;
use super::locale::Charset;
use super::program::Script;
use super::shelf::Shelf;
use crate::formats::name::Name;
use crate::tui::app::Options;
use crate::tui::effect::World;
use crate::tui::key::parse;
use crate::tui::script::command::ScriptError;
use crate::tui::script::runner::{self, Settings as Running, Shown};
use crate::tui::theme::{ColorDepth, Palette, Theme};

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
    let plain = Theme::plain(charset == Charset::Ascii);
    let options = Options {
        sensor: settings.sensor(),
        theme: match asked.drawings {
            // Drawings have colours unless the script says otherwise. They change nothing of what is printed.
            Some(_) => Theme {
                depth: ColorDepth::True,
                palette: Palette::Dark,
                ..plain
            },
            None => plain,
        },
        mouse: true,
    };
    let running = Running {
        options,
        size: asked.size,
        styles: asked.styles,
        json: asked.json,
        keymap: settings.keymap().clone(),
    };
    let (mut output, mut lost) = (io::stdout().lock(), None);
    let mut screens = 0;
    let mut show = |shown: Shown<'_>| {
        let done = match (shown, &asked.drawings) {
            (Shown::Text(text), _) => {
                let written = output.write_all(text.as_bytes());
                written
                    .and_then(|()| output.flush())
                    .map_err(Failure::Write)
            }
            (Shown::Screen(name, session), Some(folder)) => {
                screens += 1;
                let name = file_name(name, screens);
                let path = folder.join(format!("{name}.svg"));
                export::put(&path, session.svg(&name).as_bytes(), asked.force)
            }
            _ => Ok(()),
        };
        match done {
            Ok(()) => ControlFlow::Continue(()),
            Err(failure) => {
                lost = Some(failure);
                ControlFlow::Break(())
            }
        }
    };
    let result = runner::run_shown(&script, &keys, &running, world, &mut show);
    match lost {
        Some(failure) => Err(failure),
        None => result.map_err(|failure| Failure::Script { name, failure }),
    }
}

/// The name of a screen as that of a file: what cannot be in a name is a dash. One without a name has its number.
fn file_name(name: &str, number: usize) -> String {
    let fits = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    let name: String = name
        .chars()
        .map(|c| if fits(c) { c } else { '-' })
        .collect();
    match Name::new(&name) {
        Ok(name) => name.to_string(),
        Err(_) => format!("screen-{number}"),
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
