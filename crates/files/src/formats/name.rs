//! Names of shapes: the same rules on every file system, so that a library can move.

use std::fmt;
use std::str::FromStr;

use taxel_core::quote::{is_invisible, quoted_character};

/// The most characters of a name.
pub const LONGEST: usize = 64;

/// The most bytes of a name: file systems allow 255, of which `.json` and a number in the trash take some.
const MOST_BYTES: usize = 200;

/// A name that a file can have on every Unix-like system: 1 to 64 visible letters, digits, spaces, `-`, `_`, `.`; not
/// starting with `.` or a space, not ending with a space.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name(String);

/// The error for text that is not a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NameError {
    /// The text is empty.
    Empty,
    /// The text has more than [`LONGEST`] characters; their number.
    Long(usize),
    /// The text is too long for a file name; the number of its bytes in UTF-8.
    Bytes(usize),
    /// A character that some file systems do not allow.
    Character(char),
    /// The first character, a dot or a space: a dot would make a hidden file, a space cannot be seen.
    Start(char),
    /// The text ends with a space, which cannot be seen.
    End,
}

impl fmt::Display for NameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("a name is missing"),
            Self::Long(found) => write!(
                f,
                "a name has at most {LONGEST} characters, this has {found}"
            ),
            Self::Bytes(found) => write!(
                f,
                "a name has at most {MOST_BYTES} bytes in UTF-8, this has {found}"
            ),
            Self::Character(found) => write!(
                f,
                "{} cannot be in a name, only letters, digits, space, - _ .",
                quoted_character(*found)
            ),
            Self::Start(found) => {
                write!(f, "a name cannot start with {}", quoted_character(*found))
            }
            Self::End => f.write_str("a name cannot end with a space"),
        }
    }
}

impl std::error::Error for NameError {}

impl Name {
    /// Makes a name from a text that follows the rules.
    ///
    /// # Errors
    /// Returns the first rule that the text breaks.
    pub fn new(text: &str) -> Result<Self, NameError> {
        let first = text.chars().next().ok_or(NameError::Empty)?;
        let fits =
            |c: char| matches!(c, ' ' | '-' | '_' | '.') || c.is_alphanumeric() && !is_invisible(c);
        if let Some(character) = text.chars().find(|&character| !fits(character)) {
            return Err(NameError::Character(character));
        }
        match (first, text.chars().count()) {
            ('.' | ' ', _) => Err(NameError::Start(first)),
            (_, count) if count > LONGEST => Err(NameError::Long(count)),
            _ if text.len() > MOST_BYTES => Err(NameError::Bytes(text.len())),
            _ if text.ends_with(' ') => Err(NameError::End),
            _ => Ok(Self(text.to_owned())),
        }
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
    /// # Ok::<(), taxel_files::formats::NameError>(())
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

impl AsRef<str> for Name {
    fn as_ref(&self) -> &str {
        &self.0
    }
}

impl FromStr for Name {
    type Err = NameError;

    fn from_str(text: &str) -> Result<Self, NameError> {
        Self::new(text)
    }
}
