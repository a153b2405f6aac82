//! Keys in notation, and the bytes that a terminal sends.

use taxel::tui::keys::key::parse;
use taxel::tui::terminal::input::{Input, InputReader};

use super::refused;

/// Reads keys in notation.
pub(crate) fn keys(bytes: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    match parse(text) {
        // Writing more keys and reading them again would take too long, and test nothing new.
        Ok(keys) if keys.len() > 10_000 => true,
        Ok(keys) => {
            let written: String = keys.iter().map(ToString::to_string).collect();
            assert_eq!(parse(&written).as_ref(), Ok(&keys), "{written:?}");
            true
        }
        Err(error) => refused(&error.to_string()),
    }
}

/// Reads input from a terminal: it must be the same in one piece and byte by byte. Any bytes are valid input.
pub(crate) fn terminal(bytes: &[u8]) -> bool {
    let mut reader = InputReader::default();
    let mut whole = reader.read(bytes);
    let patience = reader.patience(false);
    whole.extend(reader.on_timeout(false));
    assert_eq!(
        reader.patience(false),
        None,
        "nothing is waited for any more"
    );

    let mut reader = InputReader::default();
    let mut pieces = Vec::new();
    for byte in bytes.chunks(1) {
        pieces.extend(reader.read(byte));
    }
    assert_eq!(reader.patience(false), patience);
    pieces.extend(reader.on_timeout(false));
    assert_eq!(pieces, whole);

    for input in whole {
        if let Input::Paste(text) = input {
            // Each byte that is not text becomes a character of three bytes.
            assert!(text.len() <= 3 * bytes.len() && !text.contains('\r'));
        }
    }
    true
}
