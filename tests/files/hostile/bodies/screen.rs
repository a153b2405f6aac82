//! The program on a screen in memory: its command line, its scripts, and everything that a user can do.
//!
//! Its world is a library in a scratch folder, which is emptied before each input. There is no journal, because its
//! thread would make a run depend on the clock. Sweeps and trainings are stopped early, as if the user did not wait
//! for them: their results are tested elsewhere.

use std::cell::LazyCell;
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use taxel::tui::app::{App, Message, Mouse, MouseKind, Options};
use taxel::tui::jobs::Jobs;
use taxel::tui::keys::{Arrow, Context, Key, Keymap, parse};
use taxel::tui::live::{LiveMessage, NamedSource};
use taxel::tui::prompt::commands::{complete, read as read_command};
use taxel::tui::script::Session;
use taxel::tui::script::runner::{ScriptOptions, Shown, run};
use taxel_files::storage::Library;
use tempfile::TempDir;

use super::refused;

/// Returns this thread's scratch folder, which contains [`FILES`].
fn folder() -> PathBuf {
    thread_local! {
        static SCRATCH: LazyCell<TempDir> = LazyCell::new(|| {
            let scratch = tempfile::tempdir().expect("a folder for temporary files");
            std::fs::create_dir_all(scratch.path().join(MODELS)).expect("it is ours");
            for (name, content) in FILES {
                std::fs::write(scratch.path().join(name), content).expect("it is ours");
            }
            scratch
        });
    }
    SCRATCH.with(|scratch| scratch.path().to_owned())
}

/// The folder of the models that can be used.
const MODELS: &str = "library/models";

/// A recording that can be watched, and a small model.
const FILES: [(&str, &[u8]); 2] = [
    (
        "touch.jsonl",
        include_bytes!("../seeds/recording/frames_jsonl"),
    ),
    (
        "library/models/bar.npz",
        include_bytes!("../seeds/model/bar.npz"),
    ),
];

/// Makes an empty library in the scratch folder; other files are written below it. Files of the last input are
/// removed.
fn world() -> Jobs {
    let folder = folder();
    let is_kept = |path: &Path| {
        let mut kept = FILES.iter().map(|(name, _)| folder.join(name));
        kept.any(|file| file.starts_with(path))
    };
    for inside in ["", "library", MODELS] {
        for entry in std::fs::read_dir(folder.join(inside)).expect("it is ours") {
            let path = entry.expect("it is ours").path();
            if !is_kept(&path) {
                remove(&path).expect("it is ours");
            }
        }
    }
    Jobs::for_script(Library::open(folder.join("library"))).confined_to(folder)
}

/// Removes a file or a folder.
fn remove(path: &Path) -> io::Result<()> {
    if path.is_dir() {
        std::fs::remove_dir_all(path)
    } else {
        std::fs::remove_file(path)
    }
}

/// The highest number of poses of a sweep or a training here.
const MOST_POSES: u64 = 20;

fn options() -> Options {
    Options::plain(false)
}

/// Starts the program with an empty screen of the usual size, and presses some keys.
pub(crate) fn session_of(keys: &str) -> Session {
    let mut session = Session::new(&options(), world(), 80, 24);
    session.keys(keys).expect("the keys are right");
    session
}

/// Checks the properties that hold in every state.
fn is_sound(app: &App) {
    let shown = app.shown();
    let (column, row) = app.cursor();
    assert!(column < shown.sensor.columns() && row < shown.sensor.rows());
    let seen = app.reading();
    assert_eq!(seen.imprint.columns(), shown.sensor.columns());
    assert_eq!(seen.imprint.rows(), shown.sensor.rows());
    // A form may show nothing for a while; when it is closed, the chosen region is there again.
    assert!(seen.regions.is_empty() || seen.region(app.chosen()).is_some());
}

/// Checks the properties of every screen: it has the right number of rows, all of visible characters.
fn shows_text(session: &Session) {
    let screen = session.screen();
    assert_eq!(screen.lines().count(), usize::from(session.size().1));
    let control = screen.chars().find(|c| c.is_control() && *c != '\n');
    assert_eq!(control, None, "a control character on the screen");
}

/// Reads a line of the command line. The first byte chooses the contents of the matrix.
pub(crate) fn command(bytes: &[u8]) -> bool {
    const STARTS: [&str; 3] = ["", "f<Enter>g", ":picture washer<Enter><Enter>"];
    let Some((&first, line)) = bytes.split_first() else {
        return false;
    };
    // The field accepts no more characters.
    let Some(line) = str::from_utf8(line)
        .ok()
        .filter(|line| line.chars().count() <= 200)
    else {
        return false;
    };
    let (completed, _) = complete(line, &[], Context::Matrix);
    assert!(completed.trim_start().starts_with(line.trim_start()));
    let mut session = session_of(STARTS[usize::from(first) % STARTS.len()]);
    match read_command(line, session.app()) {
        Ok(message) => {
            session.send(message);
            is_sound(session.app());
            true
        }
        Err(message) => refused(&message),
    }
}

/// The limit of work in a script here, in drawn cells, with a key counted as several cells, so that no input takes
/// long. The program itself need not refuse a longer script.
const MOST_WORK: u64 = 200_000;

/// The number of cells that are drawn in about the time that a key takes.
const CELLS_OF_A_KEY: u64 = 100;

/// Runs a script if it is valid; returns true if it runs to its end.
pub(crate) fn play(bytes: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    if work(text) > MOST_WORK {
        return false;
    }
    let settings = ScriptOptions {
        keymap: Keymap::default(),
        // A named library would be outside of this test's folder.
        is_confined: true,
        folder: folder(),
        update: false,
        options: options(),
        size: (80, 24),
        styles: true,
    };
    let (mut printed, mut world) = (String::new(), world());
    world.pose_limit = Some(MOST_POSES);
    let result = run(text, &[], &settings, world, &mut |shown: Shown<'_>| {
        printed.push_str(shown.text);
        ControlFlow::Continue(())
    });
    let ended = match result {
        Ok(()) => true,
        Err(failure) => refused(&failure.message),
    };
    let control = printed.chars().find(|c| c.is_control() && *c != '\n');
    assert_eq!(control, None, "a control character is printed");
    ended
}

/// Estimates the work of a script in drawn cells; what cannot be read costs nothing.
fn work(script: &str) -> u64 {
    let sides = |text: &str| {
        let numbers = text
            .split(['x', ',', ' '])
            .map(|side| side.parse().unwrap_or(0));
        numbers.collect::<Vec<u64>>()
    };
    let mut cells = 80 * 24;
    let mut all = 0;
    for line in script.lines() {
        let (word, rest) = line.trim().split_once(' ').unwrap_or((line, ""));
        all += match word {
            "Size" | "Resize" => {
                cells = sides(rest).iter().product();
                cells
            }
            "Keys" => parse(rest).map_or(0, |keys| keys.len() as u64) * CELLS_OF_A_KEY,
            "Type" => rest.len() as u64 * CELLS_OF_A_KEY,
            // A step of a drag visits the cells on its way.
            "Drag" => sides(rest).iter().map(|side| side + 2).sum::<u64>() * CELLS_OF_A_KEY,
            "Scroll" => 1000 * CELLS_OF_A_KEY,
            _ => 2 * cells,
        };
    }
    all
}

/// Keys that lead to different starting points, after a small model was used once: nothing, a ring drawn by hand, or a
/// finished sweep of a few poses, whose ranges are remembered; on the matrix or on one of the pages. So even a short
/// input reaches every part.
const STARTS: [&str; 11] = [
    "",
    "f<Enter>:explore --x0 5:5.5:0.5 --y0 5 --angle 0:90:45<Enter><Esc>",
    "S<C-u>8<Tab><C-u>8<Enter>f<Enter>:explore --x0 1 --y0 1:1.5:0.5 --angle 0<Enter><Esc>",
    ":picture washer<Enter><Enter>:explore --x0 1 --y0 1:1.5:0.5 --angle 0:90:45<Enter><Esc>g",
    "<Space><Right><Space><Right><Space><Down><Space><Down><Space><Left><Space><Left><Space><Up><Space>",
    "fr<Enter>:explore --x0 5:5.5:0.5 --y0 5 --angle 0:90:45<Enter>",
    "fr<Enter>:explore --x0 5:5.5:0.5 --y0 5 --angle 0:90:45<Enter>e",
    "f<Enter>f<Tab>",
    "l",
    "f<Enter>r",
    "f<Enter>rt",
];

/// Sends keys, pastes, mouse events, resizes and frames of a source, as the bytes say. The state is checked
/// throughout, and the screen when it is drawn. Any bytes are valid input.
pub(crate) fn session(bytes: &[u8]) -> bool {
    let mut bytes = Bytes(bytes);
    let start = STARTS[usize::from(bytes.next().unwrap_or_default()) % STARTS.len()];
    let number = bytes.next().unwrap_or_default();
    let (columns, rows) = bytes.size(number / 4);
    let mut session = session_of(&format!(":recognise bar<Enter><Esc>{start}"));
    session.answer(|app| app.jobs.pose_limit = Some(MOST_POSES));
    session.resize(columns, rows);
    for number in 0..300 {
        let Some(byte) = bytes.next() else {
            break;
        };
        act(&mut session, byte, &mut bytes);
        is_sound(session.app());
        if session.app().ended() {
            break;
        }
        // As in a terminal, input that arrives together is drawn together.
        if number % 32 == 31 || matches!(byte, 0xf0..0xf2) {
            shows_text(&session);
        }
    }
    shows_text(&session);
    // There is a way out of everything that is open.
    for _ in 0..4 {
        session.press(Key::Esc);
        is_sound(session.app());
    }
    shows_text(&session);
    true
}

/// Performs the action of a byte, which may use more bytes.
fn act(session: &mut Session, byte: u8, bytes: &mut Bytes<'_>) {
    match byte {
        b' '..=b'~' => session.press(Key::Char(byte.into())),
        0..0x20 => session.press(NAMED[usize::from(byte) % NAMED.len()]),
        0x7f..0x99 => session.press(Key::Ctrl((b'a' + byte - 0x7f).into())),
        0x99..0xa0 => session.press(Key::Char(FOREIGN[usize::from(byte - 0x99)])),
        0xa0..0xb0 => {
            let number = bytes.next().unwrap_or_default();
            let (columns, rows) = bytes.size(number / 4);
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
        0xf0..0xf2 => session.send(Message::Redraw),
        0xf2..0xf4 => {
            let recording = folder().join(FILES[0].0).display().to_string();
            let source = Box::new(NamedSource::new(recording));
            session.send(Message::Live(LiveMessage::Source(source)));
        }
        0xf4..0xf8 => {
            let _ = session.frames((byte - 0xf3).into());
        }
        0xf8..0xfc => session.send(Message::Suspend),
        _ => session.send(Message::Terminate),
    }
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

/// Letters, a wide one, one without width, a control character, and a right-to-left letter.
const FOREIGN: [char; 7] = ['é', '漢', '\u{301}', '\u{200d}', '\u{85}', 'ש', '👩'];

const MOUSE: [MouseKind; 5] = [
    MouseKind::Press,
    MouseKind::Drag,
    MouseKind::Release,
    MouseKind::ScrollUp,
    MouseKind::ScrollDown,
];

/// Sizes of terminals: usual, narrow and low ones, and those at which the layout changes.
const SIZES: [(u16, u16); 12] = [
    (80, 24),
    (100, 30),
    (80, 25),
    (132, 24),
    (60, 20),
    (40, 24),
    (80, 12),
    (40, 12),
    (50, 16),
    (120, 20),
    (30, 40),
    (24, 10),
];

/// Bytes that are consumed one by one; after the last one, there are zeros.
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

    /// Returns columns and rows for a number up to 63: mostly sizes of terminals, sometimes any from 1 to 64, 128 or
    /// 256.
    fn size(&mut self, number: u8) -> (u16, u16) {
        let most = match number {
            0..48 => return SIZES[usize::from(number) % SIZES.len()],
            48..60 => 64,
            60..63 => 128,
            _ => 256,
        };
        (self.number() % most + 1, self.number() % most + 1)
    }

    fn take(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        taken
    }
}
