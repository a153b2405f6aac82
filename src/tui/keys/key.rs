//! Keys, and their notation: `f<Right><Tab>4.00<Enter>`.
//!
//! There are only keys that arrive from every terminal: no Alt, no Ctrl with a digit. A character is written as
//! itself, but `<` as `<lt>`. Named keys and Ctrl are written in angle brackets, and so is a character given by its
//! number, `<U+3000>`. `<3x:Down>` and `<3x:+>` repeat a key.

use std::fmt;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrow {
    Left,
    Right,
    Up,
    Down,
}

impl Arrow {
    pub fn step(self) -> (i8, i8) {
        match self {
            Self::Left => (-1, 0),
            Self::Right => (1, 0),
            Self::Up => (0, -1),
            Self::Down => (0, 1),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    Char(char),
    Ctrl(char),
    Arrow(Arrow),
    ShiftArrow(Arrow),
    Home,
    End,
    PageUp,
    PageDown,
    Enter,
    Esc,
    Tab,
    BackTab,
    Backspace,
    Delete,
    Function(u8),
}

/// The names in angle brackets. If a key has several, the first one is written. The names with `C-` are those of keys
/// that a terminal cannot tell from the letter with Ctrl.
const NAMES: [(&str, Key); 26] = [
    ("Left", Key::Arrow(Arrow::Left)),
    ("Right", Key::Arrow(Arrow::Right)),
    ("Up", Key::Arrow(Arrow::Up)),
    ("Down", Key::Arrow(Arrow::Down)),
    ("S-Left", Key::ShiftArrow(Arrow::Left)),
    ("S-Right", Key::ShiftArrow(Arrow::Right)),
    ("S-Up", Key::ShiftArrow(Arrow::Up)),
    ("S-Down", Key::ShiftArrow(Arrow::Down)),
    ("Home", Key::Home),
    ("End", Key::End),
    ("PageUp", Key::PageUp),
    ("PageDown", Key::PageDown),
    ("Enter", Key::Enter),
    ("CR", Key::Enter),
    ("Esc", Key::Esc),
    ("Tab", Key::Tab),
    ("S-Tab", Key::BackTab),
    ("BS", Key::Backspace),
    ("Del", Key::Delete),
    ("Space", Key::Char(' ')),
    ("lt", Key::Char('<')),
    ("gt", Key::Char('>')),
    ("C-h", Key::Backspace),
    ("C-i", Key::Tab),
    ("C-j", Key::Enter),
    ("C-m", Key::Enter),
];

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (*self, NAMES.iter().find(|(_, key)| key == self)) {
            (Self::Char('>'), _) => f.write_str(">"),
            (_, Some((name, _))) => write!(f, "<{name}>"),
            (Self::Ctrl(letter), _) => write!(f, "<C-{letter}>"),
            (Self::Function(number), _) => write!(f, "<F{number}>"),
            // At the end of a script's line, blanks are ignored.
            (Self::Char(blank), _) if blank.is_whitespace() || blank.is_control() => {
                write!(f, "<U+{:04X}>", u32::from(blank))
            }
            (Self::Char(character), _) => write!(f, "{character}"),
            _ => Ok(()),
        }
    }
}

impl Key {
    pub fn label(self) -> String {
        match self {
            Self::Char(' ') => "Space".to_owned(),
            Self::Char(character) => character.to_string(),
            Self::Ctrl(letter) => format!("Ctrl-{}", letter.to_ascii_uppercase()),
            Self::BackTab => "Shift-Tab".to_owned(),
            Self::Backspace => "Backspace".to_owned(),
            Self::Delete => "Delete".to_owned(),
            Self::ShiftArrow(arrow) => format!("Shift-{arrow:?}"),
            other => other.to_string().trim_matches(['<', '>']).to_owned(),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KeyError {
    #[error("key {found:?} at character {at} is unknown; write a single '<' as <lt>")]
    Unknown { at: usize, found: String },
    /// There are too many keys; they would take hours.
    #[error(
        "key {found:?} at character {at}: a key repeats at most 10,000 times, and all keys together are at most 200,000"
    )]
    TooMany { at: usize, found: String },
}

/// The greatest number of keys from one repetition: a typing mistake must not take hours.
const MOST_REPEATED: usize = 10_000;
const MOST_KEYS: usize = 200_000;

/// Reads the keys of a text in notation.
///
/// ```
/// use taxel::tui::keys::key::{Key, Arrow, parse};
/// assert_eq!(parse("f<2x:Down><C-r>").unwrap(),
///     [Key::Char('f'), Key::Arrow(Arrow::Down), Key::Arrow(Arrow::Down), Key::Ctrl('r')]);
/// ```
///
/// # Errors
/// Returns an error for the first name in brackets that is unknown, or if there are too many keys.
pub fn parse(text: &str) -> Result<Vec<Key>, KeyError> {
    let mut keys = Vec::new();
    let (mut rest, mut at) = (text, 1);
    while let Some(first) = rest.chars().next() {
        let mut used = first.len_utf8();
        if first == '<' {
            let end = rest.find('>');
            used = end.map_or(rest.len(), |end| end + 1);
            let found = || rest[..used].chars().take(24).collect();
            let unknown = || KeyError::Unknown { at, found: found() };
            let name = &rest[1..end.ok_or_else(unknown)?];
            let (times, key) = match name.split_once("x:") {
                Some((times, name)) => (
                    times,
                    name.parse()
                        .map_or_else(|_| named(name), |own| Some(Key::Char(own))),
                ),
                None => ("1", named(name)),
            };
            let key = key.ok_or_else(unknown)?;
            if times.is_empty() || !times.bytes().all(|digit| digit.is_ascii_digit()) {
                return Err(unknown());
            }
            // A number too large to be read is too many, too.
            let times = times.parse().unwrap_or(usize::MAX);
            if times > MOST_REPEATED || keys.len() + times > MOST_KEYS {
                return Err(KeyError::TooMany { at, found: found() });
            }
            keys.extend(std::iter::repeat_n(key, times));
        } else {
            keys.push(Key::Char(first));
        }
        at += rest[..used].chars().count();
        rest = &rest[used..];
    }
    Ok(keys)
}

fn named(name: &str) -> Option<Key> {
    let ctrl = || {
        let letter = name
            .strip_prefix("C-")
            .or_else(|| name.strip_prefix("c-"))?;
        let letter = letter.parse().ok().filter(char::is_ascii_alphabetic)?;
        Some(Key::Ctrl(letter.to_ascii_lowercase()))
    };
    let function = || {
        let number = name.strip_prefix(['F', 'f'])?;
        let number = (1..=12).find(|own: &u8| own.to_string() == number)?;
        Some(Key::Function(number))
    };
    let numbered = || {
        let number = u32::from_str_radix(name.strip_prefix("U+")?, 16).ok()?;
        char::from_u32(number).map(Key::Char)
    };
    let mut listed = NAMES.iter();
    let listed = listed.find(|(known, _)| known.eq_ignore_ascii_case(name));
    let listed = listed.map(|&(_, key)| key);
    listed.or_else(ctrl).or_else(function).or_else(numbered)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_read_as_they_were_written() {
        let named = NAMES.iter().map(|&(_, key)| key);
        let others = [
            'a', '<', '>', '#', '"', '\u{3000}', '\u{2028}', '\t', '\u{7f}', '你',
        ];
        let keys: Vec<Key> = named
            .chain(others.map(Key::Char))
            .chain([Key::Ctrl('r'), Key::Function(1), Key::Function(12)])
            .collect();
        for &key in &keys {
            let written = key.to_string();
            assert_eq!(parse(&written), Ok(vec![key]), "{written}");
            assert_eq!(written.trim(), written, "blanks at an end may be lost");
        }
        // A terminal sends the same byte for both.
        assert_eq!(parse("<C-i><C-m>"), Ok(vec![Key::Tab, Key::Enter]));
        assert_eq!(Key::Char('\u{3000}').to_string(), "<U+3000>");
        for wrong in ["<U+110000>", "<U+>", "<F0>", "<F13>", "<F01>"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn every_key_can_be_repeated() {
        for (text, key) in [
            ("<3x:+>", Key::Char('+')),
            ("<3x:a>", Key::Char('a')),
            ("<3x:x>", Key::Char('x')),
            ("<3x:lt>", Key::Char('<')),
            ("<3x:U+3E>", Key::Char('>')),
            ("<3x:C-r>", Key::Ctrl('r')),
            ("<3x:Down>", Key::Arrow(Arrow::Down)),
        ] {
            assert_eq!(parse(text), Ok(vec![key; 3]), "{text}");
        }
        // Without a number, it is no repetition, and a character alone needs no brackets.
        assert!(parse("<a>").is_err() && parse("<x:a>").is_err() && parse("<3x:>").is_err());
    }
}
