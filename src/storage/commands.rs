//! The commands that were typed on the screen, remembered between runs: a line each, the last one last.
//!
//! They are a convenience. What cannot be read is none, and what cannot be written is forgotten.

use std::fs;
use std::path::PathBuf;

use crate::storage::{Existing, Library, UnfinishedFile};

/// No more commands are remembered.
const MOST: usize = 100;

/// No longer file is read: one hundred commands of the longest kind are shorter.
const MOST_BYTES: u64 = 1 << 17;

/// The file of the commands.
#[derive(Clone, Debug)]
pub struct CommandFile(PathBuf);

impl CommandFile {
    /// The file in the folder of a library.
    pub fn of(library: &Library) -> Self {
        Self(library.folder().join(".commands"))
    }

    /// Returns the commands, the last one last; none if there is no such file.
    pub fn read(&self) -> Vec<String> {
        let small = fs::symlink_metadata(&self.0)
            .is_ok_and(|found| found.is_file() && found.len() <= MOST_BYTES);
        let text = small.then(|| fs::read_to_string(&self.0));
        let Some(Ok(text)) = text else {
            return Vec::new();
        };
        let clean = |line: &&str| !line.is_empty() && !line.contains(char::is_control);
        text.lines().filter(clean).map(str::to_owned).collect()
    }

    /// Remembers commands, the last hundred of them.
    pub fn write(&self, commands: &[String]) {
        let kept = &commands[commands.len().saturating_sub(MOST)..];
        let text: String = kept.iter().map(|line| format!("{line}\n")).collect();
        let written = UnfinishedFile::new(&self.0, Existing::Replaced).and_then(|mut file| {
            file.write(text.as_bytes())?;
            file.finish()?.persist()
        });
        // Without a folder, or on a full disk, the commands are not worth a message.
        drop(written);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_hundred_commands_come_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = CommandFile::of(&Library::open(folder.path().to_owned()));
        assert!(file.read().is_empty());
        let lines: Vec<String> = (0..150).map(|number| format!("turn {number}")).collect();
        file.write(&lines);
        assert_eq!(file.read(), lines[50..]);
        fs::write(folder.path().join(".commands"), "new\n\u{1b}[31m\n\ngrab\n").expect("written");
        assert_eq!(file.read(), ["new", "grab"]);
    }
}
