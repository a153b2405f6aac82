//! The small files in the library's folder in which the screen keeps its memory between runs: one entry per line, the
//! newest last.
//!
//! Errors are ignored: a file that cannot be read counts as empty, and lines that cannot be written are dropped.

use std::fs;
use std::path::PathBuf;

use crate::storage::folder;
use crate::storage::library::{COMMANDS, RECOGNISED_SET};
use crate::storage::{Existing, FinishedFile, Library};

/// The size, in bytes, beyond which a file is not read: a hundred commands of the longest kind are shorter.
const MOST_BYTES: u64 = 1 << 17;

/// A file of lines that the screen remembers.
#[derive(Clone, Debug)]
pub struct RememberedFile {
    path: PathBuf,
    /// The largest number of lines that the file keeps.
    most: usize,
}

impl RememberedFile {
    /// Returns the file with the commands that were typed.
    pub fn commands(library: &Library) -> Self {
        Self::of(library, COMMANDS, 100)
    }

    /// Returns the file with the name of the set of shapes that was recognised last.
    pub fn recognised_set(library: &Library) -> Self {
        Self::of(library, RECOGNISED_SET, 1)
    }

    /// Returns the file of that name in the folder of a library.
    fn of(library: &Library, name: &str, most: usize) -> Self {
        Self {
            path: library.folder().join(name),
            most,
        }
    }

    /// Returns the lines, the newest last, without empty lines and lines with control characters; empty if there is
    /// no such file.
    pub fn read(&self) -> Vec<String> {
        let small = fs::symlink_metadata(&self.path)
            .is_ok_and(|found| found.is_file() && found.len() <= MOST_BYTES);
        let text = small.then(|| fs::read_to_string(&self.path));
        let Some(Ok(text)) = text else {
            return Vec::new();
        };
        let clean = |line: &&str| !line.is_empty() && !line.contains(char::is_control);
        let lines: Vec<&str> = text.lines().filter(clean).collect();
        let first = lines.len().saturating_sub(self.most);
        lines[first..].iter().map(|&line| line.to_owned()).collect()
    }

    /// Adds lines to those of the file, which another program may have changed, and keeps only the last ones if there
    /// are too many.
    pub fn add(&self, lines: Vec<String>) {
        let mut all = self.read();
        all.extend(lines);
        self.write(&all);
    }

    /// Replaces the lines of the file, and keeps only the last ones if there are too many. Makes the folder if there
    /// is none.
    pub fn write(&self, lines: &[String]) {
        if let Some(folder) = self.path.parent() {
            // Without the folder nothing can be written, which does no harm.
            let _ = folder::make(folder);
        }
        let kept = &lines[lines.len().saturating_sub(self.most)..];
        let text: String = kept.iter().map(|line| format!("{line}\n")).collect();
        let written = FinishedFile::new(&self.path, text.as_bytes(), Existing::Replaced)
            .and_then(FinishedFile::persist);
        // On a full disk, it is not worth a message.
        drop(written);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_lines_come_back_and_nonsense_is_left_out() {
        let folder = tempfile::tempdir().expect("a folder");
        let library = Library::open(folder.path().join("new"));
        let file = RememberedFile::commands(&library);
        assert!(file.read().is_empty());
        let lines: Vec<String> = (0..150).map(|number| format!("turn {number}")).collect();
        file.write(&lines);
        assert_eq!(file.read(), lines[50..]);
        let path = library.folder().join(".commands");
        fs::write(path, "new\n\u{1b}[31m\n\ngrab\n").expect("written");
        assert_eq!(file.read(), ["new", "grab"]);
        // Another program has written meanwhile.
        file.add(vec!["turn 20".to_owned()]);
        assert_eq!(file.read(), ["new", "grab", "turn 20"]);
        let set = RememberedFile::recognised_set(&library);
        set.write(&["my parts".to_owned()]);
        assert_eq!(
            (set.read(), file.read().len()),
            (vec!["my parts".to_owned()], 3)
        );
        let path = library.folder().join(".recognise");
        fs::write(path, "x".repeat(1 << 18)).expect("written");
        assert!(set.read().is_empty());
    }
}
