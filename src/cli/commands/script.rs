//! `taxel script`: runs the screen without a terminal, driven by a script.
//!
//! The program is the same as on a terminal, except that keys come from the script, only the screens that it asks for
//! are drawn, and the library is an empty one of its own unless `--library` is given. So scripts are tests (those in
//! `tests/scripts`), demonstrations, and records of `taxel --record`.
//!
//! ```text
//! $ taxel script -k 'f<Enter>' rest.taxel            keys first, then the script
//! $ taxel script demo.taxel --svg pictures           pictures/NAME.svg for each 'Screen NAME'
//! ```
//! A script ends at its first error; the output before remains. Its commands are those of
//! [`command`](crate::tui::script::command).
//!
//! A script answers the program's questions itself, and may come from a stranger. So it cannot choose a library of
//! the user's, and writes only below its own folder, unless `--allow-outside` is given.

use std::collections::{HashMap, HashSet};
use std::io::{self, Read, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;

use taxel_files::formats::Name;
use taxel_files::formats::file::without_mark;
use taxel_files::formats::name::folded;
use taxel_files::storage;

use crate::cli::arguments::program::Script;
use crate::cli::commands::export;
use crate::cli::error::CliError;
use crate::cli::input::content::InputSource;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::Charset;
use crate::cli::settings::resolved::Effective;
use crate::tui::app::state::Options;
use crate::tui::keys::key::parse;
use crate::tui::runtime::World;
use crate::tui::script::command::ScriptError;
use crate::tui::script::runner::{self, ScriptOptions, ScriptOutput};
use crate::tui::widget::theme::{ColorDepth, Palette, Theme};

/// The longest script, in bytes.
const MOST_BYTES: u64 = 16 << 20;

pub(crate) fn run(
    asked: &Script,
    settings: &Effective,
    shelf: &Shelf,
    charset: Charset,
) -> Result<(), CliError> {
    let name = asked.source.as_ref().map(InputSource::name);
    let script = match &asked.source {
        Some(source) => bytes(source).map_err(|error| CliError::NoScript {
            name: source.name(),
            error: error.into(),
        })?,
        None => Vec::new(),
    };
    let script = text(&script).map_err(|error| CliError::Script {
        name: name.clone(),
        failure: error.into(),
    })?;
    let keys = parse(asked.keys.as_deref().unwrap_or("")).map_err(|error| CliError::Script {
        name: None,
        failure: runner::ScriptFailure::Script(ScriptError {
            line: 0,
            message: error.to_string(),
        }),
    })?;
    let world = match shelf.named()? {
        Some(library) => World::for_script(library),
        None => World::scratch().map_err(CliError::Screen)?,
    };
    let running = options(asked, settings, charset);
    if let Some(folder) = &asked.drawings {
        export::make_folder(folder)?;
    }
    let (mut output, mut names, mut lost) = (io::stdout().lock(), Names::default(), None);
    let mut show = |shown: ScriptOutput<'_>| match write(shown, asked, &mut output, &mut names) {
        Ok(()) => ControlFlow::Continue(()),
        Err(failure) => {
            lost = Some(failure);
            ControlFlow::Break(())
        }
    };
    let result = runner::run_shown(script, &keys, &running, world, &mut show);
    match lost {
        Some(failure) => Err(failure),
        None => result.map_err(|failure| CliError::Script { name, failure }),
    }
}

fn options(asked: &Script, settings: &Effective, charset: Charset) -> ScriptOptions {
    let plain = Theme::plain(charset == Charset::Ascii);
    let theme = match asked.drawings {
        // Drawings have colours unless the script says otherwise; printed screens stay the same.
        Some(_) => Theme {
            depth: ColorDepth::True,
            palette: Palette::Dark,
            ..plain
        },
        None => plain,
    };
    ScriptOptions {
        options: Options {
            sensor: settings.sensor,
            theme,
            seed: 0,
        },
        size: asked.size,
        styles: asked.styles,
        json: asked.json,
        keymap: settings.keymap().clone(),
        folder: folder_of(asked),
    }
}

/// Returns the folder that a script may write below: that of its file, or the current one for a script from standard
/// input. None with `--allow-outside`, and for keys alone, which are the user's own.
fn folder_of(asked: &Script) -> Option<PathBuf> {
    let source = asked.source.as_ref().filter(|_| !asked.allow_outside)?;
    Some(match source {
        InputSource::File(path) => storage::folder_of(path).to_owned(),
        InputSource::Standard => PathBuf::from("."),
    })
}

fn write(
    shown: ScriptOutput<'_>,
    asked: &Script,
    output: &mut impl Write,
    names: &mut Names,
) -> Result<(), CliError> {
    match (shown, &asked.drawings) {
        (ScriptOutput::Text(text), _) => {
            let written = output.write_all(text.as_bytes());
            let flushed = written.and_then(|()| output.flush());
            flushed.map_err(CliError::Write)
        }
        (ScriptOutput::Screen(name, session), Some(folder)) => {
            let name = names.next(name);
            let path = folder.join(format!("{name}.svg"));
            export::put(&path, session.svg(&name).as_bytes(), asked.existing)
        }
        _ => Ok(()),
    }
}

/// The names of the drawings so far, which must all differ.
#[derive(Debug, Default)]
struct Names {
    taken: HashSet<String>,
    last: HashMap<String, u32>,
}

impl Names {
    /// Returns the file name of a screen's drawing, without extension. Characters that are not valid become `-`, a
    /// screen without a name gets its number, and a number is added to a name that is taken.
    fn next(&mut self, name: &str) -> String {
        let fits = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
        let name: String = name
            .chars()
            .map(|c| if fits(c) { c } else { '-' })
            .collect();
        let name = match Name::new(&name) {
            Ok(name) => name.to_string(),
            Err(_) => format!("screen-{}", self.taken.len() + 1),
        };
        let mut free = name.clone();
        while !self.taken.insert(folded(&free)) {
            // The last number is kept because a script may have a million screens of one name.
            let number = self.last.entry(folded(&name)).or_insert(1);
            *number += 1;
            free = format!("{name}-{number}");
        }
        free
    }
}

fn text(script: &[u8]) -> Result<&str, ScriptError> {
    let script = without_mark(script);
    str::from_utf8(script).map_err(|error| ScriptError {
        line: script[..error.valid_up_to()]
            .split(|&byte| byte == b'\n')
            .count(),
        message: "not UTF-8".to_owned(),
    })
}

/// Reads a script. It may be long, since a record contains a whole library.
fn bytes(source: &InputSource) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut input = source.open()?.take(MOST_BYTES + 1);
    input.read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(io::Error::other(
            "larger than 16 MiB, the limit for a script",
        ));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::Names;

    #[test]
    fn each_drawing_has_a_name_of_its_own() {
        let mut names = Names::default();
        let screens = ["a b", "", "a-b", "A b", "../x", ""];
        let drawn = screens.map(|screen| names.next(screen));
        assert_eq!(
            drawn,
            ["a-b", "screen-2", "a-b-2", "A-b-3", "screen-5", "screen-6"]
        );
    }
}
