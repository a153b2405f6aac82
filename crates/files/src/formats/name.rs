//! Names of shapes: the same rules on every file system, so that a library can move.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use taxel_core::quote::{is_invisible, quoted_character};

use crate::error::ReadError;

/// The most characters of a name.
pub const LONGEST: usize = 64;

/// The most bytes of a name: file systems allow 255, of which `.json` and a number in the trash take some.
const MOST_BYTES: usize = 200;

/// A name that a file can have on every Unix-like system: 1 to 64 visible letters, digits, spaces, `-`, `_`, `.`; not
/// starting with `.` or a space, not ending with a space.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String")]
pub struct Name(String);

impl Name {
    /// Makes a name from a text that follows the rules.
    ///
    /// # Errors
    /// Returns the first rule that the text breaks.
    pub fn new(text: &str) -> Result<Self, ReadError> {
        let fits =
            |c: char| matches!(c, ' ' | '-' | '_' | '.') || c.is_alphanumeric() && !is_invisible(c);
        let count = text.chars().count();
        let broken = if text.is_empty() {
            "a name is missing".to_owned()
        } else if let Some(found) = text.chars().find(|&character| !fits(character)) {
            let found = quoted_character(found);
            format!("{found} cannot be in a name, only letters, digits, space, - _ .")
        } else if let Some(first) = text.chars().next().filter(|first| " .".contains(*first)) {
            format!("a name cannot start with {}", quoted_character(first))
        } else if count > LONGEST {
            format!("a name has at most {LONGEST} characters, this has {count}")
        } else if text.len() > MOST_BYTES {
            let bytes = text.len();
            format!("a name has at most {MOST_BYTES} bytes in UTF-8, this has {bytes}")
        } else if text.ends_with(' ') {
            "a name cannot end with a space".to_owned()
        } else {
            return Ok(Self(text.to_owned()));
        };
        Err(ReadError::new(broken))
    }

    /// Returns the text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Returns true if two names are the same on a file system that ignores case.
    ///
    /// ```
    /// use taxel_files::formats::Name;
    /// let name = Name::new("ΟΔΟΣ.2")?;
    /// assert!(name.same("οδοσ.2") && name.same("οδος.2") && !name.same("οδος"));
    /// assert!(Name::new("straße")?.same("STRAẞE"));
    /// # Ok::<(), taxel_files::ReadError>(())
    /// ```
    pub fn same(&self, other: &str) -> bool {
        folded(&self.0) == folded(other)
    }
}

/// Returns the case-folded form of a text. Names with the same folded form are the same name.
///
/// The text is mapped to upper case and back, since some letters have two lower-case forms (`Σ` has `σ` and `ς`), and
/// before that to lower case, since some have two upper-case forms (`ß` has `SS` and `ẞ`): all forms of a letter are
/// folded into one. This is done character by character, since the lower case of a whole text depends on neighbouring
/// letters.
pub fn folded(text: &str) -> String {
    if text.is_ascii() {
        // The same result, only faster: a library of 100,000 shapes is sorted by this.
        return text.to_ascii_lowercase();
    }
    let lower = text.chars().flat_map(char::to_lowercase);
    let upper = lower.flat_map(char::to_uppercase);
    upper.flat_map(char::to_lowercase).collect()
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl FromStr for Name {
    type Err = ReadError;

    fn from_str(text: &str) -> Result<Self, ReadError> {
        Self::new(text)
    }
}

impl TryFrom<String> for Name {
    type Error = ReadError;

    fn try_from(text: String) -> Result<Self, ReadError> {
        Self::new(&text)
    }
}
