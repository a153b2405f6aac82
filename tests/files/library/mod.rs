//! The library: obstacles, names, stamps, the trash, the journal, the shipped shapes.

mod in_the_way;
mod journal;
mod shapes;
mod shipped;
mod trash;

use std::path::{Path, PathBuf};

use taxel_core::imprint::Imprint;
use taxel_core::sensor::Sensor;
use taxel_files::formats::{Name, StoredShape};
use taxel_files::storage::{Expected, Library, LibraryError, ShapeOrigin};
use tempfile::TempDir;

/// A library in a temporary folder.
struct Scratch {
    _outside: TempDir,
    folder: PathBuf,
    library: Library,
}

impl Scratch {
    fn new() -> Self {
        let outside = tempfile::tempdir().expect("there is a folder for temporary files");
        let folder = outside.path().join("library");
        std::fs::create_dir(&folder).expect("made");
        Self {
            library: Library::open(folder.clone()),
            folder,
            _outside: outside,
        }
    }

    /// Makes a library with shapes of these names, numbered from 1.
    fn with(names: &[&str]) -> Self {
        let scratch = Self::new();
        for (index, name) in names.iter().enumerate() {
            scratch.save(name, index + 1);
        }
        scratch
    }

    fn path(&self, file: &str) -> PathBuf {
        self.folder.join(file)
    }

    /// Saves a shape under a new name.
    fn save(&self, name: &str, number: usize) -> u64 {
        let saved = self.library.save(&shape(name, number), Expected::Nothing);
        saved.expect("a new name")
    }

    /// Writes a file like another program would.
    fn put(&self, file: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(file), content).expect("written");
    }

    /// The number of a shape.
    fn number(&self, name: &str) -> Option<usize> {
        let loaded = self.library.load(name).ok()?;
        let word = loaded.shape.imprint.words()[0];
        usize::try_from(word).ok()
    }

    /// The names of the user's own shapes, as listed.
    fn own(&self) -> Vec<String> {
        let entries = self.library.list().expect("listed").into_iter();
        let own = entries.filter(|entry| entry.origin == ShapeOrigin::Own);
        own.map(|entry| entry.name).collect()
    }
}

/// the names of the files in a folder, sorted.
fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// a shape that encodes a number below 65,536.
fn shape(name: &str, number: usize) -> StoredShape {
    let mut imprint = Imprint::empty(Sensor::default().size());
    imprint.set_word(0, u64::try_from(number).expect("small"));
    let name = Name::new(name).expect("a name");
    StoredShape::new(name, Sensor::default(), imprint, None).expect("16 x 16 both")
}

/// the message of a refusal, with FOLDER for the folder.
fn refusal<T: std::fmt::Debug>(result: Result<T, LibraryError>, scratch: &Scratch) -> String {
    let message = result.expect_err("refused").to_string();
    message.replace(&scratch.folder.display().to_string(), "FOLDER")
}

/// Whether this user is root, whom permissions do not stop.
#[cfg(unix)]
fn is_root() -> bool {
    rustix::process::geteuid().is_root()
}
