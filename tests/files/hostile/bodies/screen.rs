//! The program on a screen in memory: its command line, its scripts, and all that a user can do.
//!
//! The world is a library in a scratch folder, which is emptied before each input. No journal is kept, whose thread
//! would make a run depend on the clock.

use std::cell::RefCell;
use std::ops::ControlFlow;

use taxel::storage::Library;
use taxel::tui::app::message::{Message, Mouse, MouseKind};
use taxel::tui::app::state::{App, Options};
use taxel::tui::app::update::update;
use taxel::tui::keys::key::{Arrow, Key};
use taxel::tui::keys::keymap::Keymap;
use taxel::tui::prompt::commands::complete;
use taxel::tui::prompt::read::read as read_command;
use taxel::tui::runtime::World;
use taxel::tui::script::Session;
use taxel::tui::script::command::{ScriptCommand, read};
use taxel::tui::script::runner::{ScriptFailure, ScriptOptions, run};
use taxel::tui::script::setting::ScriptSetting;
use tempfile::TempDir;

use super::refused;

/// An empty library in this thread's scratch folder.
fn world() -> World {
    thread_local! {
        static SCRATCH: RefCell<Option<TempDir>> = const { RefCell::new(None) };
    }
    SCRATCH.with_borrow_mut(|scratch| {
        let scratch = scratch
            .get_or_insert_with(|| tempfile::tempdir().expect("a folder for temporary files"));
        let folder = scratch.path().join("library");
        if folder.exists() {
            std::fs::remove_dir_all(&folder).expect("it is ours");
        }
        World::quiet(Library::open(folder))
    })
}

fn options() -> Options {
    Options::plain(false)
}

/// The program on an empty screen of usual size, after some keys.
pub(crate) fn session_of(keys: &str) -> Session {
    let mut session = Session::new(&options(), world(), 80, 24);
    session.keys(keys).expect("the keys are right");
    session
}

/// What must hold of every state.
fn is_sound(app: &App) {
    let shown = app.shown();
    let (column, row) = app.cursor();
    assert!(column < shown.sensor.columns() && row < shown.sensor.rows());
    let seen = app.reading();
    assert_eq!(seen.imprint.columns(), shown.sensor.columns());
    assert_eq!(seen.imprint.rows(), shown.sensor.rows());
    assert!(app.chosen().is_none() || seen.region(app.chosen()).is_some());
}

/// What must hold of every screen: as many rows as it has, each of what can be seen.
fn shows_text(session: &Session) {
    let screen = session.screen();
    assert_eq!(screen.lines().count(), usize::from(session.size().1));
    let control = screen.chars().find(|c| c.is_control() && *c != '\n');
    assert_eq!(control, None, "a control character on the screen");
}

/// A line of the command line. The first byte chooses what is on the matrix.
pub(crate) fn command(bytes: &[u8]) -> bool {
    thread_local! {
        static APPS: [App; 3] = ["", "f<Enter>g", ":picture washer<Enter><Enter>"].map(|keys| {
            session_of(keys).app().clone()
        });
    }
    let Some((&first, line)) = bytes.split_first() else {
        return false;
    };
    // The field takes no more.
    let Some(line) = str::from_utf8(line)
        .ok()
        .filter(|line| line.chars().count() <= 200)
    else {
        return false;
    };
    let (completed, _) = complete(line, &[]);
    assert!(completed.trim_start().starts_with(line.trim_start()));
    APPS.with(|apps| {
        let app = &apps[usize::from(first) % apps.len()];
        match read_command(line, app) {
            Ok(message) => {
                let mut app = app.clone();
                // What is wished of the world is not done here.
                let _ = update(&mut app, message);
                is_sound(&app);
                true
            }
            Err(message) => refused(&message),
        }
    })
}

/// A script that is read only.
pub(crate) fn script(bytes: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    read(text).map_or_else(|error| refused(&error.to_string()), |_| true)
}

/// The most cells that a script may draw here, so that no input takes long. A script that is longer is none that the
/// program must refuse: it takes as long as it says.
const MOST_DRAWN: u64 = 2_000_000;

/// A script that is run, to its end if it is read.
pub(crate) fn play(bytes: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    let commands = match read(text) {
        Ok(commands) => commands,
        Err(error) => return refused(&error.to_string()),
    };
    // A library that is named is one of the world outside.
    let outside = |(_, command): &(usize, ScriptCommand)| {
        matches!(command, ScriptCommand::Set(ScriptSetting::Library(_)))
    };
    if drawn(&commands) > MOST_DRAWN || commands.iter().any(outside) {
        return false;
    }
    let settings = ScriptOptions {
        keymap: Keymap::default(),
        folder: None,
        options: options(),
        size: (80, 24),
        styles: true,
        json: text.len() % 2 == 0,
    };
    let mut printed = String::new();
    let result = run(text, &[], &settings, world(), |text| {
        printed.push_str(text);
        ControlFlow::Continue(())
    });
    let ended = match result {
        Ok(()) => true,
        Err(ScriptFailure::Expectation { message, .. }) => refused(&message),
        Err(failure) => refused(&failure.to_string()),
    };
    let control = printed.chars().find(|c| c.is_control() && *c != '\n');
    assert_eq!(control, None, "a control character is printed");
    ended
}

/// How many cells a script draws.
fn drawn(commands: &[(usize, ScriptCommand)]) -> u64 {
    let mut cells = 80 * 24;
    let mut all = 0;
    for (_, command) in commands {
        let times = match command {
            ScriptCommand::Set(ScriptSetting::Size(columns, rows))
            | ScriptCommand::Resize(columns, rows) => {
                cells = u64::from(*columns) * u64::from(*rows);
                1
            }
            ScriptCommand::Keys(keys) => keys.len() as u64,
            ScriptCommand::Type(text) => text.chars().count() as u64,
            ScriptCommand::Drag(places) => {
                let way = |pair: &[(u16, u16)]| {
                    let [from, to] = [pair[0], pair[1]];
                    u64::from(from.0.abs_diff(to.0).max(from.1.abs_diff(to.1)))
                };
                2 + places.windows(2).map(way).sum::<u64>()
            }
            ScriptCommand::Scroll(_, turns) => turns.unsigned_abs().into(),
            _ => 2,
        };
        all += times * cells;
    }
    all
}

/// Keys, pastes, the mouse and new sizes, as bytes say; the state and the screen must hold throughout. Any bytes are some
/// input.
pub(crate) fn session(bytes: &[u8]) -> bool {
    let mut bytes = Bytes(bytes);
    let (columns, rows) = bytes.size();
    let mut session = Session::new(&options(), world(), columns, rows);
    for _ in 0..300 {
        let Some(byte) = bytes.next() else {
            break;
        };
        match byte {
            b' '..=b'~' => session.press(Key::Char(byte.into())),
            0..0x20 => session.press(NAMED[usize::from(byte) % NAMED.len()]),
            0x7f..0x99 => session.press(Key::Ctrl((b'a' + byte - 0x7f).into())),
            0x99..0xa0 => session.press(Key::Char(FOREIGN[usize::from(byte - 0x99)])),
            0xa0..0xb0 => {
                let (columns, rows) = bytes.size();
                session.resize(columns, rows);
            }
            0xb0..0xe0 => {
                let kind = MOUSE[usize::from(byte) % MOUSE.len()];
                let (column, row) = (bytes.number(), bytes.number());
                session.send(Message::Mouse(Mouse { kind, column, row }));
            }
            0xe0..0xf0 => {
                let length = bytes.number();
                let text = bytes.take(length.into());
                session.send(Message::Paste(String::from_utf8_lossy(text).into_owned()));
            }
            0xf0..0xf8 => session.send(Message::Redraw),
            0xf8..0xfc => session.send(Message::Suspend),
            _ => session.send(Message::Terminate),
        }
        is_sound(session.app());
        if session.app().ended() {
            break;
        }
    }
    shows_text(&session);
    // Whatever is open, there is a way out of it.
    for _ in 0..4 {
        session.press(Key::Esc);
    }
    is_sound(session.app());
    shows_text(&session);
    true
}

const NAMED: [Key; 16] = [
    Key::Arrow(Arrow::Left),
    Key::Arrow(Arrow::Right),
    Key::Arrow(Arrow::Up),
    Key::Arrow(Arrow::Down),
    Key::ShiftArrow(Arrow::Left),
    Key::ShiftArrow(Arrow::Down),
    Key::Home,
    Key::End,
    Key::PageUp,
    Key::PageDown,
    Key::Enter,
    Key::Esc,
    Key::Tab,
    Key::BackTab,
    Key::Backspace,
    Key::Delete,
];

/// Letters, a wide one, one without a width, a control character, one from the right to the left.
const FOREIGN: [char; 7] = ['é', '漢', '\u{301}', '\u{200d}', '\u{85}', 'ש', '👩'];

const MOUSE: [MouseKind; 5] = [
    MouseKind::Press,
    MouseKind::Drag,
    MouseKind::Release,
    MouseKind::ScrollUp,
    MouseKind::ScrollDown,
];

/// Bytes that are used up one by one; after the last one there are zeros.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn next(&mut self) -> Option<u8> {
        let (&first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(first)
    }

    fn number(&mut self) -> u16 {
        self.next().unwrap_or(0).into()
    }

    /// Columns and rows, 1 to 256 each; a first byte of 0 stands for 80 × 24.
    fn size(&mut self) -> (u16, u16) {
        match self.number() {
            0 => (80, 24),
            columns => (columns, self.number() + 1),
        }
    }

    fn take(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        taken
    }
}
