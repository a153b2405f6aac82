//! The scripts of `tests/scripts` on the real program in a pseudo-terminal; its screens must equal those of the script
//! runner.

use std::path::Path;
use std::thread::ScopedJoinHandle;

use taxel::tui::app::message::{Message, Mouse, MouseKind};
use taxel::tui::app::state::Options;
use taxel::tui::keys::key::{Arrow, Key};
use taxel::tui::script::Session;
use taxel::tui::script::command::{ScriptCommand, read};
use taxel::tui::script::setting::ScriptSetting;

use super::program::{Program, Start, TAXEL};
use super::screens::started;

/// Returns the bytes that a terminal sends for a key.
fn bytes(key: Key) -> Vec<u8> {
    let arrow = |arrow: Arrow| match arrow {
        Arrow::Up => 'A',
        Arrow::Down => 'B',
        Arrow::Right => 'C',
        Arrow::Left => 'D',
    };
    match key {
        Key::Char(character) => character.to_string().into_bytes(),
        Key::Ctrl(letter) => vec![letter as u8 & 0x1f],
        Key::Arrow(to) => format!("\x1b[{}", arrow(to)).into_bytes(),
        Key::ShiftArrow(to) => format!("\x1b[1;2{}", arrow(to)).into_bytes(),
        Key::Home => b"\x1b[H".to_vec(),
        Key::End => b"\x1b[F".to_vec(),
        Key::PageUp => b"\x1b[5~".to_vec(),
        Key::PageDown => b"\x1b[6~".to_vec(),
        Key::Enter => b"\r".to_vec(),
        // Esc is sent by its code: it is recognised at once, and is never combined with a key before or after it.
        Key::Esc => b"\x1b[27u".to_vec(),
        Key::Tab => b"\t".to_vec(),
        Key::BackTab => b"\x1b[Z".to_vec(),
        Key::Backspace => b"\x7f".to_vec(),
        Key::Delete => b"\x1b[3~".to_vec(),
        Key::Function(number) => {
            let code = number + 10 + u8::from(number > 5) + u8::from(number > 10);
            format!("\x1b[{code}~").into_bytes()
        }
    }
}

/// The program and the script session, which are sent the same input.
struct Pair {
    program: Program,
    session: Session,
}

impl Pair {
    fn press(&mut self, key: Key) {
        self.program.types(&bytes(key));
        self.session.press(key);
    }

    fn mouse(&mut self, kind: MouseKind, (column, row): (u16, u16)) {
        let (code, end) = match kind {
            MouseKind::Press => (0, 'M'),
            MouseKind::Drag => (32, 'M'),
            MouseKind::Release => (0, 'm'),
            MouseKind::ScrollUp => (64, 'M'),
            MouseKind::ScrollDown => (65, 'M'),
        };
        self.program
            .types(format!("\x1b[<{code};{};{}{end}", column + 1, row + 1).as_bytes());
        self.session
            .send(Message::Mouse(Mouse { kind, column, row }));
    }

    fn act(&mut self, command: &ScriptCommand) {
        match command {
            ScriptCommand::Keys(keys) => keys.iter().for_each(|&key| self.press(key)),
            ScriptCommand::Type(text) => text
                .chars()
                .for_each(|character| self.press(Key::Char(character))),
            ScriptCommand::Paste(text) => {
                self.program
                    .types(format!("\x1b[200~{text}\x1b[201~").as_bytes());
                self.session.send(Message::Paste(text.clone()));
            }
            ScriptCommand::Resize(columns, rows) => {
                self.program.resize((*columns, *rows));
                self.session.resize(*columns, *rows);
                self.program.agrees(&self.session);
            }
            ScriptCommand::Click(place) => self.click(*place),
            ScriptCommand::ClickText(text) => {
                let screen = self.session.screen();
                let found = screen
                    .lines()
                    .enumerate()
                    .find_map(|(row, line)| Some((row, line[..line.find(text)?].chars().count())));
                let (row, column) = found.expect("the runner has found it");
                self.click((
                    u16::try_from(column).expect("small"),
                    u16::try_from(row).expect("small"),
                ));
            }
            // A terminal reports some places on the way; the program draws the lines between them.
            ScriptCommand::Drag(places) => {
                self.mouse(MouseKind::Press, places[0]);
                for &place in &places[1..] {
                    self.mouse(MouseKind::Drag, place);
                }
                self.mouse(MouseKind::Release, places[places.len() - 1]);
            }
            ScriptCommand::Scroll(place, turns) => {
                let kind = if *turns < 0 {
                    MouseKind::ScrollUp
                } else {
                    MouseKind::ScrollDown
                };
                (0..turns.unsigned_abs()).for_each(|_| self.mouse(kind, *place));
            }
            // The expected time of a sweep is only shown on a terminal.
            ScriptCommand::Screen(name) if name.starts_with("timed") => {}
            // A script finishes its work before the next key; for the program, the test has to wait.
            ScriptCommand::Screen(_) | ScriptCommand::Wait if !self.session.app().ended() => {
                self.program.agrees(&self.session);
            }
            _ => {}
        }
    }

    fn click(&mut self, place: (u16, u16)) {
        self.mouse(MouseKind::Press, place);
        self.mouse(MouseKind::Release, place);
    }
}

#[test]
fn every_script_shows_its_screens_on_a_terminal() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts");
    let files = std::fs::read_dir(folder)
        .expect("the folder is there")
        .flatten()
        .map(|file| file.path());
    let scripts: Vec<_> = files
        .filter(|path| path.extension().is_some_and(|end| end == "taxel"))
        .collect();
    // Four programs at a time, because each test mostly waits for its program.
    let shown: usize = std::thread::scope(|scope| {
        let quarters = scripts.chunks(scripts.len().div_ceil(4));
        let running: Vec<_> = quarters
            .map(|paths| scope.spawn(|| paths.iter().filter(|path| is_shown_alike(path)).count()))
            .collect();
        let counts = running.into_iter().map(ScopedJoinHandle::join);
        counts.map(|count| count.expect("all screens agree")).sum()
    });
    println!("{shown} scripts show the same screens on a terminal");
    assert!(shown >= 30);
}

/// Runs a script on the program, whose screens must equal those of the script runner. Returns false if the script gets
/// frames by its own commands: on a terminal, the tests in `live` show the same pages with a pipe.
fn is_shown_alike(path: &Path) -> bool {
    let script = std::fs::read_to_string(path).expect("a script can be read");
    let commands = read(&script).expect("the scripts are right");
    let of_frames = |(_, command): &(_, ScriptCommand)| {
        matches!(command, ScriptCommand::Source(_) | ScriptCommand::Frames(_))
    };
    if commands.iter().any(of_frames) {
        return false;
    }
    let (mut size, mut options) = ((80, 24), Options::plain(false));
    for (_, command) in &commands {
        match command {
            ScriptCommand::Set(ScriptSetting::Size(columns, rows)) => size = (*columns, *rows),
            ScriptCommand::Set(ScriptSetting::Ascii(on)) => options.theme.ascii = *on,
            ScriptCommand::Set(other) => panic!("{}: {other}", path.display()),
            _ => {}
        }
    }
    let variables = [
        ("TERM", "xterm-256color"),
        ("NO_COLOR", "1"),
        ("LANG", if options.theme.ascii { "C" } else { "C.UTF-8" }),
    ];
    let program = Program::start(&Start {
        command: &[TAXEL],
        size,
        variables: &variables,
        ..Start::default()
    });
    let mut pair = Pair {
        program,
        session: started(options, size),
    };
    pair.program.agrees(&pair.session);
    for (_, command) in &commands {
        pair.act(command);
    }
    if pair.session.app().ended() {
        pair.program.ends_well(0);
    }
    true
}
