//! The screen is the same as in a script, on every kind of terminal; and what it costs a line.

use std::time::{Duration, Instant};

use taxel::tui::app::{Message, Mouse, MouseKind, Options};
use taxel::tui::script::Session;

use super::program::{Program, Start, TAXEL};

pub(crate) fn session(ascii: bool, size: (u16, u16)) -> Session {
    let world = taxel::tui::jobs::Jobs::scratch().expect("a folder");
    Session::new(&Options::plain(ascii), world, size.0, size.1)
}

/// Keys in notation, and the bytes that a terminal sends for them.
const KEYS: &[(&str, &[u8])] = &[
    ("f", b"f"),
    ("<Tab><Tab><Tab>1.99", b"\t\t\t1.99"),
    ("<Tab>1.47<Tab><Tab>2", b"\t1.47\t\t2"),
    (
        "<S-Tab><BS>9<Left>1<Home><Del>5",
        b"\x1b[Z\x7f9\x1b[D1\x1b[1~\x1b[3~5",
    ),
    ("<CR>", b"\r"),
    (
        "<Right><Right><Down><Up><Left>",
        b"\x1b[C\x1bOC\x1b[B\x1bOA\x1b[D",
    ),
    ("<S-Right><S-Down>", b"\x1b[1;2C\x1b[1;2B"),
    ("<Space><Tab>c", b" \tc"),
    ("c<End><PageDown>", b"c\x1b[F\x1b[6~"),
    ("?", b"?"),
    ("<PageDown><Down><PageUp>", b"\x1b[6~\x1b[B\x1b[5~"),
    ("<Esc>", b"\x1b\x1b"),
    ("<C-l>g+<Left>", b"\x0cg+\x1b[D"),
    ("<Esc>q", b"\x1bq"),
    ("n", b"n"),
    ("u", b"u"),
];

#[test]
fn a_script_and_a_terminal_show_the_same() {
    let mut program = Program::started(&Start::default());
    let mut script = session(false, (80, 24));
    program.agrees(&script);
    for (notation, bytes) in KEYS {
        program.types(bytes);
        script.keys(notation).expect("the keys of a test are right");
        program.agrees(&script);
    }
    for size in [(60, 20), (200, 60), (12, 3), (1, 1), (80, 24)] {
        program.resize(size);
        script.resize(size.0, size.1);
        program.agrees(&script);
    }
    program.types(b"f\t\x1b[200~2.5\r\n\x1b[201~");
    script.keys("f<Tab>").expect("keys");
    script.send(Message::Paste("2.5\n".to_owned()));
    program.agrees(&script);
    program.types(b"\x1b\x03y");
    script.keys("<Esc><C-c>").expect("keys");
    program.ends_well(0);
}

#[test]
fn every_kind_of_terminal_is_supported() {
    let utf8 = ("LANG", "C.UTF-8");
    for (term, other, ascii) in [
        ("dumb", utf8, true),
        ("vt100", utf8, true),
        ("linux", utf8, false),
        ("xterm-256color", ("NO_COLOR", "1"), true),
        ("xterm-256color", ("LANG", "de_DE.ISO-8859-1"), true),
        ("tmux", utf8, false),
    ] {
        let mut program = Program::started(&Start {
            variables: &[("TERM", term), other],
            ..Start::default()
        });
        let mut script = session(ascii, (80, 24));
        program.types(b"f\x1b[C\t\r");
        program.shows("Region 1");
        script.keys("f<Right><Tab><CR>").expect("keys");
        if term == "dumb" {
            let rows = script.screen();
            program.until("the rows", |program| program.rows() == rows.trim_end());
            only_moves(&program.bytes);
        } else {
            program.agrees(&script);
        }
        program.types(b"qy");
        program.ends_well(0);
        let sent = String::from_utf8_lossy(&program.bytes).into_owned();
        let has = |text: &str| sent.contains(text);
        assert!(
            !has("[6n") && !has("[5n") && !has("[c"),
            "{term}: nothing is asked"
        );
        assert!(!ascii || sent.is_ascii(), "{term}");
        let colors = ["[;32m", "38;5;"].map(has);
        let expected = match term {
            "linux" | "tmux" => [true, false],
            "xterm-256color" => [false, other.0 == "LANG"],
            _ => [false; 2],
        };
        assert_eq!(colors, expected, "{term} {other:?}");
        let modes = [has("\x1b[?1049h"), has("\x1b[?2026h"), has("\x1b[?1000h")];
        let expected = match term {
            "dumb" | "vt100" => [false; 3],
            "linux" => [true, false, false],
            _ => [true; 3],
        };
        assert_eq!(modes, expected, "{term}");
    }
}

/// Checks that the only sequences are moves, erasures, and the cursor hidden and shown.
fn only_moves(mut rest: &[u8]) {
    while let Some(at) = rest.iter().position(|&byte| byte == 0x1b) {
        rest = &rest[at + 1..];
        let end = rest.iter().position(u8::is_ascii_alphabetic);
        let end = end.expect("a sequence");
        let is_mode = matches!(rest[end], b'h' | b'l') && rest.starts_with(b"[?25");
        assert!(
            is_mode || b"ABCDHJK".contains(&rest[end]),
            "{:?}",
            String::from_utf8_lossy(&rest[..=end])
        );
        rest = &rest[end..];
    }
}

#[test]
fn a_terminal_without_a_size_gets_a_default_size() {
    let start = Start {
        size: (0, 0),
        ..Start::default()
    };
    let mut program = Program::started(&start);
    program.agrees(&session(false, (80, 24)));
    program.resize((100, 30));
    program.agrees(&session(false, (100, 30)));
    program.resize((0, 0));
    program.agrees(&session(false, (80, 24)));
    let variables = [
        ("TERM", "xterm"),
        ("LANG", "C.UTF-8"),
        ("LINES", "20"),
        ("COLUMNS", "60"),
    ];
    let mut program = Program::start(&Start {
        variables: &variables,
        ..start
    });
    let rows = session(false, (60, 20)).screen();
    program.until("60 × 20", |program| program.rows() == rows.trim_end());
}

#[test]
fn standard_files_may_be_redirected() {
    let command = ["sh", "-c", "\"$0\" </dev/null | cat; echo left", TAXEL];
    let mut program = Program::started(&Start {
        command: &command,
        ..Start::default()
    });
    program.agrees(&session(false, (80, 24)));
    program.types(b"q");
    program.shows("left");
    program.no_mode_is_on();
    // If there is no terminal, the program says so.
    let command = ["sh", "-c", "\"$0\" </dev/null 2>&1 | cat; echo left", TAXEL];
    let start = Start {
        command: &command,
        controlling: false,
        ..Start::default()
    };
    let mut program = Program::start(&start);
    program.shows("left");
    let said = program.screen().contents().replace('\n', "");
    assert!(
        said.contains("no terminal here; 'taxel figure' and")
            && said.contains("'taxel script' drives"),
        "{said}"
    );
}

#[test]
fn a_record_of_keys_shows_the_same_screen() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = folder.path().join("record.taxel");
    let name = record.to_str().expect("a name");
    let command = [TAXEL, "--record", name, "--columns", "12", "--rows", "10"];
    let start = Start {
        command: &command,
        ..Start::default()
    };
    let mut program = Program::started(&start);
    program.types(b"fr\t3.57\x1b[D\x7f\r");
    program.shows("rectangle length 3.70");
    let rows = program.rows();
    program.types(b"qy");
    program.ends_well(0);
    let script = std::fs::read_to_string(&record).expect("a record");
    let shown = script.replacen("Keys q\n", "Screen\nKeys q\n", 1) + "Quit\n";
    std::fs::write(&record, shown).expect("written");
    let output = std::process::Command::new(TAXEL)
        .args(["script", name])
        .output();
    let output = output.expect("it runs");
    assert!(output.status.success(), "{output:?}\n{script}");
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let screen = printed.split_once('\n').map_or("", |(_, screen)| screen);
    assert_eq!(screen.trim_end(), rows, "{script}");
    // A record is never replaced.
    let mut program = Program::start(&start);
    program.shows("already exists and is not replaced");
}

/// Reports of the mouse (SGR, positions from 1), and the text that goes to the terminal's clipboard.
#[test]
fn the_mouse_and_the_clipboard_work() {
    let mut program = Program::started(&Start::default());
    let mut script = session(false, (80, 24));
    program.types(b"\x1b[<0;14;8M\x1b[<0;14;8m");
    for kind in [MouseKind::Press, MouseKind::Release] {
        let (column, row) = (13, 7);
        script.send(Message::Mouse(Mouse { kind, column, row }));
    }
    program.agrees(&script);
    program.types(b"Y");
    program.shows("imprint sent to your terminal's clipboard (272 characters)");
    program.until("the imprint", |program| {
        program.count(b"\x1b]52;c;Li4u") == 1
    });
    program.types(b"qy");
    program.ends_well(0);
    // A terminal that would show the text does not get it.
    let mut program = Program::started(&Start {
        command: &[TAXEL, "--no-mouse"],
        variables: &[("TERM", "linux"), ("LANG", "C.UTF-8")],
        ..Start::default()
    });
    program.types(b"Y");
    program.shows("! this terminal has no clipboard; s saves");
    program.types(b"q");
    program.ends_well(0);
    assert_eq!(program.count(b"\x1b]52") + program.count(b"?1000h"), 0);
}

#[test]
fn an_idle_program_does_not_wake_up() {
    let mut program = Program::start(&Start::default());
    program.written(|program| program.shows("? Help"));
    let switches = |program: &Program| (program.wakeups(), program.cpu());
    // On a busy machine, the program may not be idle yet.
    let mut before = switches(&program);
    program.until("sleep", |program| {
        program.read(Duration::from_millis(500));
        let now = switches(program);
        std::mem::replace(&mut before, now) == now
    });
    let written = program.bytes.len();
    let end = Instant::now() + Duration::from_secs(5);
    while let Some(left) = end.checked_duration_since(Instant::now()) {
        program.read(left);
    }
    assert_eq!((switches(&program), program.bytes.len()), (before, written));
    // For the build of the tests: 1.3 MB were measured.
    assert!(program.status("RssAnon") <= 2 * 1024);
}
