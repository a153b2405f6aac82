//! Keys in notation.

use taxel::tui::keys::parse;

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
