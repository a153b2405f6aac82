//! The characters that may be written, and the conversion of text to them.
//!
//! In a locale that is not UTF-8, or with `--ascii`, all output is ASCII: known signs get a spelling (`°` becomes `
//! deg`), everything else a Rust escape (`\u{e9}`). In either character set control characters are escaped, because
//! text from files and arguments must not be able to control the terminal.

use std::borrow::Cow;
use std::ffi::OsString;
use std::iter;
use std::sync::atomic::{AtomicBool, Ordering};

use taxel_core::quote::is_invisible;

use crate::tui::widget::spelling;
use crate::tui::widget::write::width;

/// Whether all output is ASCII; set once the arguments are read.
static ASCII: AtomicBool = AtomicBool::new(false);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Charset {
    Ascii,
    Unicode,
}

impl Charset {
    /// The character set of all output. Functions that make text ask for it here, so that it is not passed on.
    pub(crate) fn current() -> Self {
        if ASCII.load(Ordering::Relaxed) {
            Self::Ascii
        } else {
            Self::Unicode
        }
    }

    pub(crate) fn set(self) {
        ASCII.store(self == Self::Ascii, Ordering::Relaxed);
    }

    /// Returns ASCII if an argument is `--ascii` or the locale is not UTF-8.
    ///
    /// This looks for `--ascii` before the arguments are parsed, so that a message about wrong arguments is in ASCII
    /// too. As POSIX defines, the first of `LC_ALL`, `LC_CTYPE` and `LANG` that is set and not empty decides; if none
    /// is, the locale is `C`.
    pub(crate) fn of(
        arguments: &[OsString],
        variable: impl Fn(&'static str) -> Option<OsString>,
    ) -> Self {
        let mut set = ["LC_ALL", "LC_CTYPE", "LANG"]
            .into_iter()
            .filter_map(variable);
        let locale = set.find(|value| !value.is_empty()).unwrap_or_default();
        let locale = locale.to_string_lossy().to_ascii_lowercase();
        // language_COUNTRY.codeset@modifier, or only the codeset, as on macOS.
        let name = locale.split('@').next().unwrap_or_default();
        let codeset = name
            .split_once('.')
            .map_or(&*locale, |(_, codeset)| codeset);
        let ascii = arguments.iter().any(|argument| argument == "--ascii");
        if ascii || !matches!(codeset, "utf-8" | "utf8") {
            Self::Ascii
        } else {
            Self::Unicode
        }
    }

    /// Returns an active and an inactive taxel. Each takes two columns of the terminal, so that cells look square.
    pub(crate) fn taxels(self) -> (&'static str, &'static str) {
        match self {
            Self::Ascii => ("# ", ". "),
            Self::Unicode => ("██", "· "),
        }
    }

    pub(crate) fn line(self, text: &str) -> Cow<'_, str> {
        if text.chars().all(|character| self.has(character)) {
            return Cow::Borrowed(text);
        }
        let mut line = String::with_capacity(text.len() + 8);
        for character in text.chars() {
            if self.has(character) {
                line.push(character);
            } else if let Some(spelling) = spelling(character) {
                line.push_str(spelling);
            } else {
                line.extend(character.escape_unicode());
            }
        }
        Cow::Owned(line)
    }

    pub(crate) fn lines(self, text: &str) -> String {
        let lines = text.split('\n').map(|line| self.line(line));
        lines.collect::<Vec<_>>().join("\n")
    }

    /// Converts the cells of a column and pads them on the right to one width. A wide character, as in `字`, takes two
    /// columns of the terminal.
    pub(crate) fn column<'a>(self, cells: impl IntoIterator<Item = &'a str>) -> Vec<String> {
        let converted = cells.into_iter().map(|cell| self.line(cell).into_owned());
        let mut column: Vec<String> = converted.collect();
        let widest = column.iter().map(|cell| width(cell)).max();
        for cell in &mut column {
            let missing = widest.map_or(0, |widest| widest - width(cell));
            cell.extend(iter::repeat_n(' ', missing));
        }
        column
    }

    pub(crate) fn has(self, character: char) -> bool {
        match self {
            Self::Ascii => matches!(character, ' '..='~'),
            Self::Unicode => !character.is_control() && !is_invisible(character),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn charset(arguments: &[&str], variables: &[(&str, &str)]) -> Charset {
        let arguments: Vec<OsString> = arguments.iter().map(OsString::from).collect();
        Charset::of(&arguments, |name| {
            let found = variables.iter().find(|(own, _)| *own == name);
            found.map(|(_, value)| OsString::from(value))
        })
    }

    #[test]
    fn the_first_variable_that_is_set_decides() {
        let unicode = |variables: &[(&str, &str)]| charset(&[], variables) == Charset::Unicode;
        assert!(!unicode(&[]));
        assert!(unicode(&[("LANG", "en_GB.UTF-8")]));
        assert!(unicode(&[("LANG", "ro_RO.utf8@euro")]));
        assert!(unicode(&[
            ("LC_ALL", ""),
            ("LC_CTYPE", "C.UTF-8"),
            ("LANG", "C")
        ]));
        assert!(!unicode(&[("LC_ALL", "C"), ("LANG", "en_GB.UTF-8")]));
        assert!(!unicode(&[("LC_CTYPE", "POSIX"), ("LANG", "en_GB.UTF-8")]));
        assert!(!unicode(&[("LANG", "ro_RO.ISO-8859-2")]));
    }

    #[test]
    fn the_flag_overrides_the_locale() {
        let utf8 = [("LANG", "C.UTF-8")];
        assert_eq!(charset(&["taxel", "--ascii"], &utf8), Charset::Ascii);
    }

    #[test]
    fn text_keeps_to_the_characters() {
        assert_eq!(
            Charset::Ascii.line("45° × 2 – 4π·NAE/P²"),
            "45 deg x 2 - 4pi*NAE/P^2"
        );
        assert_eq!(Charset::Ascii.line("é\u{1b}"), "\\u{e9}\\u{1b}");
        assert_eq!(
            Charset::Unicode.line("é°\u{1b}\u{202e}\n"),
            "é°\\u{1b}\\u{202e}\\u{a}"
        );
        assert_eq!(
            Charset::Unicode.line("a\u{61c}\u{ad}\u{206e}\u{fff9}\u{e0041}\u{3164}"),
            "a\\u{61c}\\u{ad}\\u{206e}\\u{fff9}\\u{e0041}\\u{3164}"
        );
        assert_eq!(Charset::Ascii.lines("a\nb…\n"), "a\nb...\n");
    }

    #[test]
    fn the_cells_of_a_column_are_equally_wide() {
        let column = |charset: Charset| charset.column(["字", "bar", ""]);
        assert_eq!(column(Charset::Unicode), ["字 ", "bar", "   "]);
        assert_eq!(
            column(Charset::Ascii),
            ["\\u{5b57}", "bar     ", "        "]
        );
        assert_eq!(Charset::Ascii.column([]), [""; 0]);
    }
}
