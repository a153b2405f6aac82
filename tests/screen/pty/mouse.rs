//! The mouse and the clipboard as bytes: the reports of a terminal, and the requests to it.

use taxel::tui::app::message::{Message, Mouse, MouseKind};
use taxel::tui::script::Session;

use super::live::Watched;
use super::program::{Program, Start};
use super::screens::session;

/// Sends the same to both: to the program a terminal's report (SGR, places from 1), and to the script its meaning.
fn point(program: &mut Program, script: &mut Session, kind: MouseKind, column: u16, row: u16) {
    let (button, end) = match kind {
        MouseKind::Press => (0, 'M'),
        MouseKind::Drag => (32, 'M'),
        MouseKind::Release => (0, 'm'),
        MouseKind::ScrollUp => (64, 'M'),
        MouseKind::ScrollDown => (65, 'M'),
    };
    let report = format!("\x1b[<{button};{};{}{end}", column + 1, row + 1);
    program.types(report.as_bytes());
    script.send(Message::Mouse(Mouse { kind, column, row }));
    program.agrees(script);
}

#[test]
fn the_mouse_clicks_drags_and_scrolls() {
    use MouseKind::{Drag, Press, Release, ScrollDown, ScrollUp};
    let mut program = Program::started(&Start::default());
    let mut script = session(false, (80, 24));
    assert_eq!(program.count(b"\x1b[?1000h\x1b[?1002h\x1b[?1006h"), 1);
    let mut act = |acts: &[(MouseKind, u16, u16)], shown: &str| {
        for &(kind, column, row) in acts {
            point(&mut program, &mut script, kind, column, row);
        }
        assert!(script.screen().contains(shown), "{}", script.screen());
    };
    // A taxel: the ruler has three columns; menu, title and the other ruler have three rows.
    act(
        &[(Press, 3 + 2 * 5, 3 + 4), (Release, 13, 7)],
        "NA 1 in all",
    );
    // From there, a few reported places, with lines between them.
    act(
        &[
            (Press, 13, 8),
            (Drag, 17, 8),
            (Drag, 17, 12),
            (Release, 17, 12),
        ],
        "NA 8 in all",
    );
    // The button was released: moving does nothing.
    act(&[(Drag, 25, 15)], "NA 8 in all");
    // Outside of everything, and at a place that no terminal has.
    act(
        &[(Press, 79, 23), (Release, 79, 23), (Press, 999, 999)],
        "NA 8 in all",
    );
    // The menu's Load, a row, and the wheel.
    act(&[(Press, 10, 0), (Release, 10, 0)], "filter:");
    act(
        &[(ScrollDown, 5, 8), (ScrollDown, 5, 8), (ScrollUp, 5, 8)],
        "filter:",
    );
    act(&[(Press, 5, 4), (Release, 5, 4)], "filter:");
    act(&[(Press, 5, 4)], "loaded");
    // The old format of reports, from terminals that do not know the new one.
    program.types(b"\x1b[M \x24\x25\x1b[M#\x24\x25");
    for kind in [Press, Release] {
        script.send(Message::Mouse(Mouse {
            kind,
            column: 3,
            row: 4,
        }));
    }
    program.agrees(&script);
    program.types(b"qy");
    program.ends_well(0);
}

#[test]
fn the_mouse_can_be_left_to_the_terminal() {
    let mut program = Program::started(&Start::default());
    assert_eq!(
        program.screen().mouse_protocol_mode(),
        vt100::MouseProtocolMode::ButtonMotion
    );
    program.types(b"q");
    program.ends_well(0);
    let mut program = Program::started(&Start {
        command: &[super::program::TAXEL, "--no-mouse"],
        ..Start::default()
    });
    program.types(b"q");
    program.ends_well(0);
    assert_eq!(program.count(b"?1000h"), 0);
    let Some(mut watched) = Watched::started("", "--no-mouse") else {
        return;
    };
    watched.program.shows("no frame yet");
    assert_eq!(watched.program.count(b"?1000h"), 0);
}

/// Returns the decoded text between the marks of OSC 52.
fn copied(program: &Program) -> Option<String> {
    let text = String::from_utf8_lossy(&program.bytes).into_owned();
    let (_, rest) = text.rsplit_once("\x1b]52;c;")?;
    let (code, _) = rest.split_once('\x07')?;
    let digit = |letter: u8| match letter {
        b'A'..=b'Z' => Some(letter - b'A'),
        b'a'..=b'z' => Some(letter - b'a' + 26),
        b'0'..=b'9' => Some(letter - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let mut bytes = Vec::new();
    let (mut held, mut bits) = (0_u32, 0);
    for six in code.bytes().map_while(digit) {
        held = held << 6 | u32::from(six);
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.extend((held >> bits).to_be_bytes().last());
        }
    }
    String::from_utf8(bytes).ok()
}

#[test]
fn copied_text_goes_to_the_clipboard_of_the_terminal() {
    let mut program = Program::started(&Start::default());
    let mut script = session(false, (80, 24));
    program.types(b"f\rY");
    program.shows("imprint sent to your terminal's clipboard (272 characters)");
    script.keys("f<CR>").expect("keys");
    let imprint = script.app().reading().imprint.to_string() + "\n";
    program.until("the imprint", |program| {
        copied(program).as_ref() == Some(&imprint)
    });
    program.types(b"y");
    program.until("the descriptors", |program| {
        copied(program).is_some_and(|text| text.starts_with("na\t52\nnae\t52\n"))
    });
    let lines = copied(&program).map(|text| text.lines().count());
    assert_eq!(lines, Some(taxel::description::DESCRIPTORS.len()));
    program.types(b"qy");
    program.ends_well(0);
}

/// A terminal that would show the text does not get it; a notice says so.
#[test]
fn nothing_is_copied_if_the_terminal_has_no_clipboard() {
    for term in ["dumb", "vt100", "linux"] {
        let mut program = Program::started(&Start {
            variables: &[("TERM", term), ("LANG", "C.UTF-8")],
            ..Start::default()
        });
        program.types(b"Y");
        program.shows("! this terminal has no clipboard; s saves");
        program.types(b"q");
        program.ends_well(0);
        assert_eq!(program.count(b"\x1b]52"), 0, "{term}");
    }
}
