//! The set of shapes that was chosen last for recognition on the screen, remembered between runs: its name on a line.
//!
//! It is a convenience. What cannot be read is none, and what cannot be written is forgotten.

use std::fs;
use std::path::PathBuf;

use crate::formats::Name;
use crate::storage::{Existing, Library, UnfinishedFile};

/// No longer file is read: a name is shorter.
const MOST_BYTES: u64 = 1024;

/// The file of the set.
#[derive(Clone, Debug)]
pub struct ChosenSetFile(PathBuf);

impl ChosenSetFile {
    /// The file in the folder of a library.
    pub fn of(library: &Library) -> Self {
        Self(library.folder().join(".recognise"))
    }

    /// Returns the name of the set; None if there is no such file, or no name in it.
    pub fn read(&self) -> Option<Name> {
        let found = fs::symlink_metadata(&self.0).ok()?;
        let small = found.is_file() && found.len() <= MOST_BYTES;
        let text = small.then(|| fs::read_to_string(&self.0).ok())??;
        Name::new(text.trim_end()).ok()
    }

    /// Remembers a set by its name, in a new folder if there is none.
    pub fn write(&self, name: &str) {
        if let Some(folder) = self.0.parent() {
            // Without it nothing can be written, which is no matter.
            let _ = fs::create_dir_all(folder);
        }
        let written = UnfinishedFile::new(&self.0, Existing::Replaced).and_then(|mut file| {
            file.write(format!("{name}\n").as_bytes())?;
            file.finish()?.persist()
        });
        // On a full disk, it is not worth a message.
        drop(written);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_set_comes_back_and_nonsense_is_none() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = ChosenSetFile::of(&Library::open(folder.path().to_owned()));
        assert_eq!(file.read(), None);
        file.write("my parts");
        assert_eq!(file.read().as_ref().map(Name::as_str), Some("my parts"));
        for nonsense in ["", "\n", "a/b\n", "\u{1b}[31m\n", &"x".repeat(2000)] {
            fs::write(folder.path().join(".recognise"), nonsense).expect("written");
            assert_eq!(file.read(), None, "{nonsense:?}");
        }
    }
}
