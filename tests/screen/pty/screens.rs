//! The screen is the same as in a script, on every kind of terminal.

use taxel::tui::app::message::Message;
use taxel::tui::app::state::Options;
use taxel::tui::script::Session;

use super::program::{Program, Start, TAXEL};

pub(crate) fn session(ascii: bool, size: (u16, u16)) -> Session {
    started(Options::plain(ascii), size)
}

/// Starts a session with other options.
pub(crate) fn started(options: Options, size: (u16, u16)) -> Session {
    let world = taxel::tui::runtime::World::scratch().expect("a folder");
    Session::new(&options, world, size.0, size.1)
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
    for size in [(60, 20), (200, 60), (12, 3), (1, 1), (132, 24), (80, 24)] {
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

/// Parts of keys, as over a line that sends byte by byte.
#[test]
fn keys_may_come_in_pieces() {
    let mut program = Program::started(&Start::default());
    let mut script = session(false, (80, 24));
    for piece in [
        &b"\x1b["[..],
        b"1;",
        b"2",
        b"C\x1b[",
        b"C",
        b"\xc3",
        b"\xa9 ",
    ] {
        program.types(piece);
        program.read(std::time::Duration::from_millis(5));
    }
    script.keys("<S-Right><Right><Space>").expect("keys");
    program.agrees(&script);
    program.types(b"f");
    program.shows("Radius x");
    program.types(b"\x1b");
    script.keys("f<Esc>").expect("keys");
    program.agrees(&script);
}

#[test]
fn every_kind_of_terminal_is_supported() {
    let no_color = ("NO_COLOR", "1");
    let utf8 = ("LANG", "C.UTF-8");
    for (variables, ascii) in [
        (vec![("TERM", "dumb"), utf8], true),
        (vec![utf8], true),
        (vec![("TERM", "vt100"), utf8], true),
        (vec![("TERM", "linux"), utf8], false),
        (vec![("TERM", "linux"), utf8, no_color], false),
        (vec![("TERM", "xterm-256color"), utf8, no_color], false),
        (
            vec![("TERM", "xterm-256color"), utf8, ("COLORTERM", "truecolor")],
            false,
        ),
        (vec![("TERM", "xterm-256color")], true),
        (vec![("TERM", "tmux"), ("LANG", "C")], true),
    ] {
        let term = variables
            .iter()
            .find(|(name, _)| *name == "TERM")
            .map_or("", |(_, term)| term);
        let mut program = Program::started(&Start {
            variables: &variables,
            ..Start::default()
        });
        let mut script = session(ascii, (80, 24));
        program.types(b"f\x1b[C\t\r");
        program.shows("Region 1");
        script.keys("f<Right><Tab><CR>").expect("keys");
        if term.is_empty() || term == "dumb" {
            program.agrees_plainly(&script);
        } else {
            program.agrees(&script);
        }
        program.types(b"qy");
        program.ends_well(0);
        let sent = String::from_utf8_lossy(&program.bytes).into_owned();
        let has = |text: &str| sent.contains(text);
        assert!(
            !has("[6n") && !has("[c") && !has("]1"),
            "{term}: nothing is asked"
        );
        assert!(!ascii || sent.is_ascii(), "{term}");
        let colored = has("\x1b[32m") || has(";32m") || has("38;");
        match term {
            "" | "dumb" => assert!(!has("?") || !has("[?1"), "{term}: no modes"),
            "vt100" => {
                let bold = has("\x1b[1m") || has("\x1b[0;1m");
                assert!(!colored && bold && !has("\x1b[?1"), "{term}");
            }
            "linux" => assert!(!has("38;5") && !has("?2026") && !has("?1000"), "{term}"),
            _ => assert!(
                has("\x1b[?2026h") && has("\x1b[?1000h") && !has("?1003"),
                "{term}"
            ),
        }
        if variables.contains(&no_color) || term == "dumb" {
            assert!(!colored, "{term}");
        } else if term == "linux" {
            assert!(colored, "{term}");
        }
    }
}

/// A terminal without other features gets only cursor moves and characters.
#[test]
fn a_dumb_terminal_gets_only_moves_and_characters() {
    let mut program = Program::started(&Start {
        variables: &[("TERM", "dumb")],
        ..Start::default()
    });
    program.types(b"f\r?\x1b[6~qqy");
    program.ends_well(0);
    let mut rest = &program.bytes[..];
    while let Some(at) = rest.iter().position(|&byte| byte == 0x1b) {
        rest = &rest[at + 1..];
        let end = rest
            .iter()
            .position(u8::is_ascii_alphabetic)
            .expect("a sequence");
        assert!(
            b"ABCDHJKhl".contains(&rest[end]),
            "{:?}",
            String::from_utf8_lossy(&rest[..=end])
        );
        let mode = matches!(rest[end], b'h' | b'l');
        assert!(
            !mode || rest.starts_with(b"[?25"),
            "only the cursor is hidden and shown"
        );
        rest = &rest[end..];
    }
}

#[test]
fn a_terminal_without_a_size_gets_a_default_size() {
    let mut program = Program::started(&Start {
        size: (0, 0),
        ..Start::default()
    });
    program.agrees(&session(false, (80, 24)));
    let variables = [
        ("TERM", "xterm"),
        ("LANG", "C.UTF-8"),
        ("LINES", "20"),
        ("COLUMNS", "60"),
    ];
    let mut program = Program::start(&Start {
        size: (0, 0),
        variables: &variables,
        ..Start::default()
    });
    program.shows("quit");
    let script = session(false, (60, 20));
    let rows = script.screen();
    program.until("60 × 20", |program| program.rows() == rows.trim_end());
}

/// If the standard files are redirected, the program opens the terminal by its name.
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
