//! Reads keys of many terminals, in pieces and whole.

use super::*;
use crate::tui::keys::key;
use MouseKind::{Drag, Press, Release, ScrollDown, ScrollUp};
use proptest::prelude::*;

fn read(bytes: &[u8]) -> Vec<Input> {
    let mut reader = InputReader::default();
    let mut found = reader.read(bytes);
    found.extend(reader.on_timeout(false));
    found
}

fn keys(notation: &str) -> Vec<Input> {
    let keys = key::parse(notation).expect("the keys of a test are right");
    keys.into_iter().map(Input::Key).collect()
}

#[test]
fn keys_of_many_terminals_are_read() {
    for (bytes, notation) in [
        ("aZ\u{e9}\u{4f60} <", "aZ\u{e9}\u{4f60} <lt>"),
        ("\r\n\t\x08\x7f", "<CR><CR><Tab><BS><BS>"),
        ("\x03\x1a\x0c", "<C-c><C-z><C-l>"),
        ("\x1b[A\x1bOB\x1b[1;2C\x1b[d", "<Up><Down><S-Right><S-Left>"),
        // Other modifiers are ignored.
        ("\x1b[1;5A\x1b[1;6A\x1b[1;1A", "<Up><S-Up><Up>"),
        (
            "\x1b[H\x1bOF\x1b[1~\x1b[4~\x1b[7~\x1b[8~",
            "<Home><End><Home><End><Home><End>",
        ),
        (
            "\x1b[3~\x1b[5~\x1b[6~\x1b[Z",
            "<Del><PageUp><PageDown><S-Tab>",
        ),
        (
            "\x1bOP\x1b[11~\x1b[[A\x1b[1;2P\x1b[P",
            "<F1><F1><F1><F1><Del>",
        ),
        (
            "\x1bOQ\x1bOR\x1bOS\x1b[[B\x1b[[E\x1b[12~\x1b[15~\x1b[17~\x1b[21~\x1b[23~\x1b[24~\x1b[15;2~\x1b[1;5S",
            "<F2><F3><F4><F2><F5><F2><F5><F6><F10><F11><F12><F5><F4>",
        ),
        ("\x1bOM\x1b[27u\x1b[9;2u\x1b[13u", "<CR><Esc><S-Tab><CR>"),
        // Keys that are released; unknown keys and bytes.
        ("\x1b[[F\x1b[16~\x1b[25~\x1b[2~\x1b[1;1:3Aq\0\x1c\x1f", "q"),
        ("\x1b", "<Esc>"),
        ("\x1b\x1b", "<Esc>"),
        ("\x1b\x1b[A", "<Up>"),
        ("\x1bq\x1b\r", "<Esc>q<Esc><CR>"),
        // Sequences that the next one breaks off.
        ("\x1b[12\x1b[A\x1b[5\rq", "<Up><CR>q"),
        // Answers to an earlier program.
        (
            "\x1b]11;rgb:0000/ffff/0000\x1b\\\x1b[?62;22c\x1b]10;x\x07q\x1b[24;80R",
            "q",
        ),
    ] {
        assert_eq!(read(bytes.as_bytes()), keys(notation), "{bytes:?}");
    }
    assert_eq!(read(b"\xff\xc3(\xc2\x9b\xed\xa0\x80q"), keys("(q"));
}

#[test]
fn an_esc_has_a_time_limit_and_a_sequence_has_none() {
    let mut reader = InputReader::default();
    assert_eq!(reader.read(b"\x1b"), []);
    assert_eq!(reader.patience(false), Some(MOMENT));
    assert_eq!(reader.on_timeout(false), keys("<Esc>"));
    assert_eq!(reader.patience(false), None);
    assert_eq!(reader.read(b"\x1b["), []);
    assert_eq!(reader.patience(false), None);
    assert_eq!(reader.read(b"A"), keys("<Up>"));
}

#[test]
fn the_status_of_the_terminal_is_no_key_wherever_it_is_cut() {
    const STATUS: &[u8] = b"\x1b[0n";
    for cut in 0..STATUS.len() {
        let mut reader = InputReader::default();
        let mut found = reader.read(b"a");
        found.extend(reader.read(&STATUS[..cut]));
        assert!(!reader.take_status());
        // No more bytes come for a while.
        if reader.patience(true).is_some() {
            found.extend(reader.on_timeout(true));
        }
        assert_eq!(reader.patience(true), None);
        found.extend(reader.read(&STATUS[cut..]));
        assert!(reader.take_status() && !reader.take_status());
        found.extend(reader.read(b"b"));
        assert_eq!(found, keys("ab"), "{cut}");
    }
    // A status that nobody has asked for is no key either.
    assert_eq!(read(b"\x1b[0nb\x1b[3nc"), keys("bc"));
}

#[test]
fn esc_before_the_status_of_the_terminal_is_a_key() {
    for bytes in ["\x1b\x1b[0n", "\x1b\x1b\x1b[0n"] {
        let mut reader = InputReader::default();
        assert_eq!(reader.read(bytes.as_bytes()), keys("<Esc>"), "{bytes:?}");
        assert!(reader.take_status());
    }
    // The ESC comes long before the status, or before another key.
    for (bytes, notation) in [
        ("\x1b[0n", "<Esc>"),
        ("\x1b[A", "<Esc><Up>"),
        ("\x1b\x1b[A", "<Esc><Up>"),
        ("j", "<Esc>j"),
        ("", "<Esc>"),
    ] {
        let mut reader = InputReader::default();
        let mut found = reader.read(b"\x1b");
        found.extend(reader.on_timeout(true));
        assert_eq!(found, []);
        found.extend(reader.read(bytes.as_bytes()));
        // No answer is pending any more.
        assert_eq!(reader.patience(false), bytes.is_empty().then_some(MOMENT));
        found.extend(reader.on_timeout(false));
        assert_eq!(found, keys(notation), "{bytes:?}");
    }
}

#[test]
fn pasted_text_is_not_read_as_keys() {
    let text = |text: &str| vec![Input::Paste(text.to_owned())];
    assert_eq!(
        read(b"\x1b[200~q\x1b[Ay\r\nz\r\x1b[201~"),
        text("q\x1b[Ay\nz\n")
    );
    assert_eq!(read(b"\x1b[200~\x1b[201~"), text(""));
    // The end mark is missing.
    assert_eq!(read(b"\x1b[200~1.5"), text("1.5"));
    let long = [
        b"\x1b[200~".to_vec(),
        vec![b'x'; LONGEST_PASTE + 5000],
        PASTE_END.to_vec(),
    ]
    .concat();
    assert_eq!(read(&long), text(&"x".repeat(LONGEST_PASTE)));
}

#[test]
fn the_mouse_is_read_in_both_forms() {
    let mouse = |kind, column, row| Input::Mouse(Mouse { kind, column, row });
    for (bytes, expected) in [
        ("\x1b[<0;13;6M", mouse(Press, 12, 5)),
        ("\x1b[<4;13;6M", mouse(Press, 12, 5)),
        ("\x1b[<0;13;6m", mouse(Release, 12, 5)),
        ("\x1b[<32;13;6M", mouse(Drag, 12, 5)),
        ("\x1b[<64;1;1M", mouse(ScrollUp, 0, 0)),
        ("\x1b[<65;1;1M", mouse(ScrollDown, 0, 0)),
        // Nothing lies left of the first column.
        ("\x1b[<0;0;0M", mouse(Press, 0, 0)),
        ("\x1b[<0;70000;-4M", mouse(Press, 0, 0)),
        ("\x1b[M -&", mouse(Press, 12, 5)),
        ("\x1b[M#-&", mouse(Release, 12, 5)),
        ("\x1b[M   ", mouse(Press, 0, 0)),
    ] {
        assert_eq!(read(bytes.as_bytes()), [expected], "{bytes:?}");
    }
    assert_eq!(read(b"\x1b[<2;13;6M\x1b[<35;1;1M"), []);
}

proptest! {
    /// The events do not depend on where the bytes are cut, and no bytes cause a panic.
    #[test]
    fn bytes_in_pieces_give_the_same_events(
        pieces in prop::collection::vec(
            prop_oneof![
                Just(b"\x1b[A".to_vec()), Just(b"\x1b".to_vec()), Just(b"\x1b[200~".to_vec()),
                Just(PASTE_END.to_vec()), Just(b"\x1b[<0;13;6M".to_vec()), Just(b"\x1b]1;".to_vec()),
                Just(b"\x1b[M".to_vec()), Just(b"\x1b[0n".to_vec()), prop::collection::vec(any::<u8>(), 0..6),
            ], 0..12)
    ) {
        let bytes = pieces.concat();
        let mut reader = InputReader::default();
        let mut found: Vec<_> = bytes.iter().flat_map(|&byte| reader.read(&[byte])).collect();
        found.extend(reader.on_timeout(false));
        prop_assert_eq!(found, read(&bytes));
    }
}
