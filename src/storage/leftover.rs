//! What lies in a library and is no shape: files of others, what died programs left, work that waits.

use std::path::PathBuf;

use crate::storage::LibraryError;
use crate::storage::file::names;
use crate::storage::library::{Library, TEMPORARY, name_of};

impl Library {
    /// Everything in the folder that is neither a shape nor in its usual place, with what it is, by path. None of it
    /// does harm.
    ///
    /// # Errors
    /// Where the folder is there but cannot be read.
    pub fn leftovers(&self) -> Result<Vec<(PathBuf, &'static str)>, LibraryError> {
        let mut found = Vec::new();
        for name in names(self.folder())? {
            let what = match name.to_str() {
                Some(".lock" | ".trash" | ".journal") => continue,
                Some(name) if name.starts_with(TEMPORARY) => {
                    "half-written by a program that died, or being written"
                }
                Some(name) if name_of(name).is_some() => continue,
                _ => "no shape: its name is not NAME.json",
            };
            found.push((self.folder().join(name), what));
        }
        let journal = self.folder().join(".journal");
        for name in names(&journal)? {
            let path = journal.join(name);
            let what = match path.extension().and_then(|end| end.to_str()) {
                Some("json") => "unsaved work, of a running program or of one that died",
                Some("lock" | "tmp") => continue,
                _ => "no journal",
            };
            found.push((path, what));
        }
        found.sort();
        Ok(found)
    }
}
