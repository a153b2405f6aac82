//! `taxel script`: runs the screen without a terminal, driven by scripts.
//!
//! The program is the same as on a terminal, except that keys come from the script, only the screens that it asks for
//! are drawn, and the library is an empty one of its own unless `--library` is given. So scripts are tests (those in
//! `tests/scripts`), demonstrations, and records of `taxel --record`. They print the same in every locale.
//!
//! A script ends at its first error; the output before remains. Its commands are those of
//! [`runner`](crate::tui::script::runner).
//!
//! A script answers the program's questions itself, and may come from a stranger. So it cannot choose a library of
//! the user's, and writes only below its own folder, unless `--allow-outside` is given.

use std::io::{self, Read, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use taxel_files::formats::Name;
use taxel_files::formats::file::without_mark;
use taxel_files::storage;

use crate::cli::commands::export;
use crate::cli::input::content::{input_name, open};
use crate::cli::output::charset::Charset;
use crate::cli::{Context, Failure, Named};
use crate::tui::app::Options;
use crate::tui::jobs::Jobs;
use crate::tui::keys::{Key, parse};
use crate::tui::script::runner::{self, ScriptFailure, ScriptOptions, Shown, size};
use crate::tui::widget::{ColorDepth, Palette, Theme};

const EXAMPLES: &str = r#"One command per line; positions are column,row of the screen, from 0:
  Size 80x24          Set ascii on        Set theme light   Set columns 8
  Set library "DIR"   Set shape {...}     Set leftover {}
  Resize 100x30       Seed 7 (of random touches)
  Keys f<Right><Tab>4.00<Enter>           <lt> for '<'; <3x:Down> three times
  Type "text"         Paste "1.5"         Click 12,5   Click "Figure"
  Drag 3,4 9,9        Scroll 12,5 -3      Wait   Quit
  Screen [name]       State [json-pointer]
  Expect /re/         ExpectNot /re/      ExpectScreen FILE
  Source touch.csv    Frames 3  (watch a recording, and take its next 3 frames)
Quit checks that the program has ended. Source fails if the file cannot be
read; Frames fails if there are too few frames. ExpectScreen compares the screen
with a file in the script's folder, which --update writes. Without --library,
the script starts with an empty library. It writes files only below its own
folder, and replaces only files that it wrote itself. If you trust a script,
--allow-outside lets it write anywhere and set a library.

Exit status: 0 all expectations held, 1 an expectation failed, 2 the script is
wrong, 3 taxel exited before the script finished.

Examples:
  taxel script test.taxel
  taxel script tests/*.taxel --update
  taxel script -k 'f<Enter>' --size 60x20 --styles
  taxel script test.taxel --svg . --force
  echo 'State /regions/0/f' | taxel script -k 'fh<Enter>' -"#;

/// The longest script, in bytes.
const MOST_BYTES: u64 = 16 << 20;

/// Drive the screen without a terminal
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag")]
pub(crate) struct Script {
    /// Scripts to run, one after the other; '-' for standard input
    #[arg(value_name = "FILE")]
    file: Vec<PathBuf>,
    /// Keys to press first; without a script, print the screen
    #[arg(short, long, value_name = "KEYS")]
    keys: Option<String>,
    /// Columns and rows of the screen
    #[arg(long, value_name = "CxR", value_parser = size, default_value = "80x24", hide_default_value = true, help_heading = "Terminal")]
    size: (u16, u16),
    /// Add a grid of style letters to screens
    #[arg(long)]
    styles: bool,
    /// Draw each screen into this folder too, as NAME.svg
    #[arg(long, value_name = "DIR")]
    svg: Option<PathBuf>,
    /// Replace existing drawings
    #[arg(long, requires = "svg")]
    force: bool,
    /// Write the files of ExpectScreen instead of comparing
    #[arg(long)]
    update: bool,
    /// Let the script write anywhere and set a library
    #[arg(long)]
    allow_outside: bool,
}

impl Script {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        // Whatever the locale: a script, its screens and its messages are the same everywhere.
        cx.settings.charset.made().unwrap_or(Charset::Unicode).set();
        let keys = parse(self.keys.as_deref().unwrap_or(""));
        let keys = keys.map_err(|error| Failure::usage(format!("-k: {error}")))?;
        if let Some(folder) = &self.svg {
            export::make_folder(folder)?;
        }
        let mut sources = self.file.clone();
        if sources.is_empty() && self.keys.is_none() {
            sources.push("-".into());
        }
        let mut drawn = 0;
        let mut run = |source: Option<&PathBuf>| {
            self.play(cx, source.map(PathBuf::as_path), &keys, &mut drawn)
        };
        match &sources[..] {
            [] => run(None),
            [source] => run(Some(source)),
            // Each is run, whatever became of the others.
            _ => {
                let mut status = 0;
                for failure in sources.iter().filter_map(|source| run(Some(source)).err()) {
                    if let Some(message) = failure.message(Charset::current()) {
                        let _ = io::stderr().write_all(message.as_bytes());
                    }
                    status = failure.status.max(status);
                }
                match status {
                    0 => Ok(()),
                    status => Err(Failure::silent(status)),
                }
            }
        }
    }

    fn play(
        &self,
        cx: &Context,
        source: Option<&Path>,
        keys: &[Key],
        drawn: &mut u32,
    ) -> Result<(), Failure> {
        let folder = source.map_or(Path::new("."), storage::folder_of);
        let ascii = Charset::current() == Charset::Ascii;
        let plain = Theme::plain(ascii);
        let theme = match self.svg {
            // Drawings have colours unless the script says otherwise; printed screens stay the same.
            Some(_) => Theme {
                depth: ColorDepth::True,
                palette: Palette::Dark,
                ..plain
            },
            None => plain,
        };
        let options = ScriptOptions {
            options: Options {
                sensor: cx.settings.sensor.sensor,
                theme,
                seed: 0,
            },
            size: self.size,
            styles: self.styles,
            keymap: cx.settings.keymap().clone(),
            folder: folder.to_owned(),
            // Keys alone are the user's own.
            is_confined: source.is_some() && !self.allow_outside,
            update: self.update,
        };
        let world = match cx.shelf.named()? {
            Some(library) => Jobs::for_script(library),
            None => Jobs::scratch()?,
        };
        let name = source.map(input_name).unwrap_or_default();
        let script = match source {
            Some(source) => bytes(source)
                .map_err(|error| Failure::usage(taxel_files::ReadError::from(error).to_string()))
                .named(&name)?,
            None => Vec::new(),
        };
        let mut lost = None;
        let mut show = |shown: Shown<'_>| match self.write(&shown, drawn) {
            Ok(()) => ControlFlow::Continue(()),
            Err(failure) => {
                lost = Some(failure);
                ControlFlow::Break(())
            }
        };
        let result =
            text(&script).and_then(|script| runner::run(script, keys, &options, world, &mut show));
        match (lost, result) {
            (Some(failure), _) => Err(failure),
            (None, Err(error)) => {
                let failure = Failure::new(format!("{name}: {error}")).with_status(error.status);
                Err(failure.with_lines())
            }
            (None, Ok(())) => Ok(()),
        }
    }

    /// Prints what a script shows. The drawing of a screen has its name, with `-` for characters that are not valid, or
    /// its number.
    fn write(&self, shown: &Shown<'_>, drawn: &mut u32) -> Result<(), Failure> {
        if let (Some((name, session)), Some(folder)) = (shown.screen, &self.svg) {
            *drawn += 1;
            let fits = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
            let name: String = name
                .chars()
                .map(|c| if fits(c) { c } else { '-' })
                .collect();
            let name = Name::new(&name).map_or(format!("screen-{drawn}"), |own| own.to_string());
            let path = folder.join(format!("{name}.svg"));
            let existing = export::replacing(self.force);
            storage::write(&path, session.svg(&name).as_bytes(), existing)?;
        }
        let mut output = io::stdout().lock();
        output.write_all(shown.text.as_bytes())?;
        Ok(output.flush()?)
    }
}

fn text(script: &[u8]) -> Result<&str, ScriptFailure> {
    let script = without_mark(script);
    str::from_utf8(script).map_err(|error| {
        let before = script[..error.valid_up_to()].split(|&byte| byte == b'\n');
        ScriptFailure::malformed(before.count(), "not UTF-8")
    })
}

fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut input = open(path)?.take(MOST_BYTES + 1);
    input.read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST_BYTES {
        let text = "larger than 16 MiB, the limit for a script";
        return Err(io::Error::other(text));
    }
    Ok(bytes)
}
