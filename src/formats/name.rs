//! Names of shapes: the same rules on every file system, so that a library can move.

use std::fmt;
use std::str::FromStr;

use crate::quote::is_invisible;

/// The longest name.
pub const LONGEST: usize = 64;

/// The most bytes of a name: file systems take 255, and `.json` and a number in the trash come to them.
const MOST_BYTES: usize = 200;

/// A name that a file can have on every Unix-like system: 1 to 64 visible letters, digits, spaces, `-`, `_`, `.`; not starting
/// with `.` or a space, not ending with a space.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name(String);

/// The error for text that is not a name.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NameError {
    /// It is empty.
    Empty,
    /// It is too long.
    Long(usize),
    /// It is too long for a file name, which is counted in bytes.
    Bytes(usize),
    /// A character that some file systems do not allow.
    Character(char),
    /// It starts with a dot, which would make a hidden file.
    Start(char),
    /// It starts or ends with a space, which cannot be seen.
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
                "{found:?} cannot be in a name, only letters, digits, space, - _ ."
            ),
            Self::Start(found) => write!(f, "a name cannot start with {found:?}"),
            Self::End => f.write_str("a name cannot end with a space"),
        }
    }
}

impl std::error::Error for NameError {}

impl Name {
    /// Checks a name.
    ///
    /// # Errors
    /// The first rule that it breaks.
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

    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Whether two names are the same on a file system that ignores case.
    ///
    /// ```
    /// use taxel::formats::Name;
    /// let name = Name::new("ΟΔΟΣ.2")?;
    /// assert!(name.same("οδοσ.2") && name.same("οδος.2") && !name.same("οδος"));
    /// assert!(Name::new("straße")?.same("STRAẞE"));
    /// # Ok::<(), taxel::formats::NameError>(())
    /// ```
    pub fn same(&self, other: &str) -> bool {
        folded(&self.0) == folded(other)
    }
}

/// The case-folded form of a text. Names with the same folded form are the same name.
///
/// By way of upper case, since some letters have two lower ones (`Σ` has `σ` and `ς`), and before that of lower case, since
/// some have two upper ones (`ß` has `SS` and `ẞ`): all of these are one letter. A character at a time, since lower case of
/// a whole text chooses by the letters around.
pub fn folded(text: &str) -> String {
    if text.is_ascii() {
        // The same, at once: a library of 100,000 shapes is sorted by this.
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
