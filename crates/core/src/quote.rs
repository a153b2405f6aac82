//! Shortens untrusted text for messages, and suggests the name that was meant. Text from files and arguments may be
//! megabytes long.

/// Shortens text that a message quotes, to at most 40 characters and `…`.
pub fn shortened(text: &str) -> String {
    cut(text, 40)
}

/// Shortens a message that quotes untrusted text in full, to at most 400 characters and `…`.
pub fn shortened_message(message: &str) -> String {
    cut(message, 400)
}

/// Writes a character for a message, in quotes; one that cannot be seen alone, such as an accent, by its code point.
pub fn quoted_character(character: char) -> String {
    match character {
        '\'' => "\"'\"".to_owned(),
        '"' | '\\' => format!("'{character}'"),
        other if other.escape_debug().count() > 1 || is_invisible(other) => {
            format!("U+{:04X}", u32::from(other))
        }
        other => format!("'{other}'"),
    }
}

/// Returns true for invisible characters: Unicode's format characters, which change the text around them, and letters
/// without a shape of their own, such as the Hangul filler. Untrusted text must not hide anything with them.
pub fn is_invisible(character: char) -> bool {
    matches!(
        character,
        '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}'..='\u{1160}' | '\u{17b4}'..='\u{17b5}'
            | '\u{180b}'..='\u{180f}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{3164}' | '\u{feff}' | '\u{ffa0}' | '\u{fff0}'..='\u{fffb}'
            | '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..='\u{e0fff}'
    )
}

/// Returns the end of a message about a wrong name: the one of `names` that was probably meant, or nothing if none is
/// similar enough. Among equally similar names it prefers the nearest length, then the first. Case is ignored.
pub fn did_you_mean<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let length = |text: &str| text.chars().count();
    if length(wrong) > LONGEST_NAME {
        return String::new();
    }
    let wrong = wrong.to_lowercase();
    let slips = |name: &'a str| {
        let slips = strsim::osa_distance(&wrong, &name.to_lowercase());
        let (typed, meant) = (length(&wrong), length(name));
        // One letter in three may differ.
        (3 * slips <= typed.max(meant)).then_some(((slips, typed.abs_diff(meant)), name))
    };
    let nearest = names.into_iter().filter_map(slips);
    match nearest.min_by_key(|(slips, _)| *slips) {
        Some((_, name)) => format!("; did you mean {name:?}?"),
        None => String::new(),
    }
}

/// Returns the message about a name that is not one of `names`: which they are, and which one was probably meant.
pub fn unknown_name(found: &str, names: &[&str]) -> String {
    let meant = did_you_mean(found, names.iter().copied());
    let (found, names) = (shortened(found), names.join(", "));
    format!("{found:?} is unknown, expected one of {names}{meant}")
}

/// Returns a hint for a word that means a figure but is not the name of one: "circle" or "square".
pub fn other_figure(word: &str) -> Option<&'static str> {
    match word.to_ascii_lowercase().as_str() {
        "circle" => Some("a circle is an ellipse with equal radii"),
        "square" => Some("a square is a rectangle with equal sides"),
        _ => None,
    }
}

/// Writes a word as it is typed on a command line: in single quotes if a shell would otherwise interpret it.
pub fn as_argument(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./,:=@%+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// Joins names as in a sentence: `a, b or c`, with `word` before the last.
pub fn joined(names: impl IntoIterator<Item: Into<String>>, word: &str) -> String {
    let names: Vec<String> = names.into_iter().map(Into::into).collect();
    match names.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} {word} {last}", others.join(", ")),
        None => String::new(),
    }
}

const LONGEST_NAME: usize = 64;

fn cut(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use crate::quote::{did_you_mean, quoted_character};

    #[test]
    fn a_character_is_quoted_as_it_is_typed() {
        let quoted = ['a', '\'', '"', '\\', '\u{301}', '\t', '\u{200b}'].map(quoted_character);
        let expected = ["'a'", "\"'\"", "'\"'", "'\\'", "U+0301", "U+0009", "U+200B"];
        assert_eq!(quoted, expected);
    }

    #[test]
    fn a_slip_of_the_keys_finds_the_name_that_was_meant() {
        let names = [
            "na",
            "nae",
            "ce",
            "roundness",
            "side_ratio",
            "gear",
            "Gerät",
        ];
        for (wrong, meant) in [
            ("nea", "nae"),
            ("NAE", "nae"),
            ("roundnes", "roundness"),
            ("side-ratio", "side_ratio"),
            ("gaer", "gear"),
            ("GERÄD", "Gerät"),
        ] {
            let expected = format!("; did you mean {meant:?}?");
            assert_eq!(did_you_mean(wrong, names), expected, "{wrong}");
        }
        for wrong in ["", "x", "weight", "no", &"na".repeat(50)] {
            assert_eq!(did_you_mean(wrong, names), "", "{wrong}");
        }
    }
}
