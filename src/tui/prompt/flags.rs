//! Flags of a `:` command, as on the command line: `--side 3` or `--side=3`.
//!
//! ```
//! use taxel::tui::prompt::flags::read;
//! let sides = |flag: &str| (flag == "--side").then_some(1);
//! assert_eq!(read(&["--side=3"], &["--side"], sides), Ok(vec![("--side", 1, "3")]));
//! assert_eq!(read(&["--side"], &["--side"], sides), Err("--side needs a value".to_owned()));
//! ```

use crate::quote::{did_you_mean, shortened};

pub type Flag<'a, T> = (&'a str, T, &'a str);

/// Reads flags, each with its value and none twice. `known` returns the meaning of a flag; None if it is unknown. An
/// error lists `names`, the first one as an example.
pub fn read<'a, T: PartialEq>(
    words: &[&'a str],
    names: &[impl AsRef<str>],
    known: impl Fn(&str) -> Option<T>,
) -> Result<Vec<Flag<'a, T>>, String> {
    let mut flags: Vec<Flag<'a, T>> = Vec::new();
    let mut words = words.iter().copied().peekable();
    while let Some(word) = words.next() {
        if !word.starts_with("--") {
            let (example, found) = (names.first().map_or("--", AsRef::as_ref), shortened(word));
            return Err(format!("expected a flag like {example}, found {found}"));
        }
        let (flag, value) = match word.split_once('=') {
            Some((flag, value)) => (flag, Some(value)),
            None => (word, None),
        };
        let what = known(flag).ok_or_else(|| unknown(flag, names))?;
        if flags.iter().any(|(_, own, _)| *own == what) {
            return Err(format!("{flag} is given twice"));
        }
        // A number may begin with a minus; a flag in place of the value means that it was left out.
        let value = value.or_else(|| words.next_if(|next| !next.starts_with("--")));
        let value = value.filter(|value| !value.is_empty());
        let value = value.ok_or_else(|| format!("{flag} needs a value"))?;
        flags.push((flag, what, value));
    }
    Ok(flags)
}

fn unknown(flag: &str, names: &[impl AsRef<str>]) -> String {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    format!(
        "{} is unknown, expected one of {}{}",
        shortened(flag),
        names.join(", "),
        did_you_mean(flag, names)
    )
}

pub(super) fn lacks_value(words: &[&str]) -> bool {
    words
        .iter()
        .fold(false, |lacks, word| !lacks && !word.contains('='))
}

pub(super) fn is_given(flag: &str, words: &[&str]) -> bool {
    words
        .iter()
        .any(|word| word.split('=').next() == Some(flag))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_read_with_a_blank_or_an_equals_sign() {
        let all = ["--side", "--x0"];
        let known = |flag: &str| all.iter().position(|own| *own == flag);
        let given = |line: &'static str| {
            let words: Vec<&str> = line.split_whitespace().collect();
            read(&words, &all, known)
        };
        let both = Ok(vec![("--side", 0, "3.5"), ("--x0", 1, "-2")]);
        assert_eq!(given("--side=3.5 --x0=-2"), both);
        assert_eq!(given("--side 3.5 --x0 -2"), both);
        assert_eq!(given(""), Ok(Vec::new()));
        for (line, error) in [
            ("--side", "--side needs a value"),
            ("--side=", "--side needs a value"),
            ("--side --x0 3", "--side needs a value"),
            ("--side=1 --side 2", "--side is given twice"),
            (
                "--sid=3",
                "--sid is unknown, expected one of --side, --x0; did you mean \"--side\"?",
            ),
            (
                "--angle=3",
                "--angle is unknown, expected one of --side, --x0",
            ),
            ("side=3", "expected a flag like --side, found side=3"),
        ] {
            assert_eq!(given(line), Err(error.to_owned()), "{line}");
        }
        assert!(lacks_value(&["--side=3", "--x0"]) && !lacks_value(&["--side=3"]));
    }
}
