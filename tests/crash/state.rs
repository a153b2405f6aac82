//! A library before an act, and the states that it may be in afterwards.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use taxel::formats::{Name, StoredShape};
use taxel::imprint::Imprint;
use taxel::sensor::Sensor;
use taxel::storage::{Expected, Library, LibraryError, Orphan, ShapeOrigin};
use tempfile::TempDir;

/// The longest time that a start may take, even on the busiest machine.
const DEADLINE: Duration = Duration::from_secs(20);

/// Returns a shape whose taxels encode a number.
pub(crate) fn shape(name: &str, version: u32) -> StoredShape {
    let mut imprint = Imprint::empty(Sensor::default().size());
    for row in 0..16 {
        // Every second row holds the same half of the number, so no part of another file can pass for it.
        imprint.set_word(row, u64::from(version >> (row % 2 * 16) & 0xffff));
    }
    let name = Name::new(name).expect("a name");
    StoredShape::new(name, Sensor::default(), imprint, None).expect("16 x 16 both")
}

/// Returns the number that a shape encodes.
pub(crate) fn version(shape: &StoredShape) -> u32 {
    let word = |row: usize| u32::try_from(shape.imprint.words()[row]).expect("16 bits");
    let version = word(0) | word(1) << 16;
    assert_eq!(shape.imprint, self::shape("x", version).imprint, "torn");
    version
}

/// A library in a folder of its own: shape "one" with number 1, "two" with 2, and "gone" with 3 in the trash.
pub(crate) struct State {
    _folder: TempDir,
    pub(crate) folder: PathBuf,
    /// The path of a file outside of the library, with number 9 and another name.
    pub(crate) new: PathBuf,
}

impl State {
    pub(crate) fn new() -> Self {
        let outside = tempfile::tempdir().expect("there is a folder for temporary files");
        let folder = outside.path().join("library");
        fs::create_dir_all(folder.join(".trash")).expect("made");
        let put = |path: &Path, name, version| {
            fs::write(path, shape(name, version).write()).expect("written");
        };
        put(&folder.join("one.json"), "one", 1);
        put(&folder.join("two.json"), "two", 2);
        put(&folder.join(".trash/0000000001 gone.json"), "gone", 3);
        let new = outside.path().join("new.json");
        put(&new, "new", 9);
        Self {
            folder,
            new,
            _folder: outside,
        }
    }

    /// Adds the unsaved work of a dead program.
    pub(crate) fn with_orphan(self) -> Self {
        let journal = self.folder.join(".journal");
        fs::create_dir(&journal).expect("made");
        fs::write(journal.join("1-0.lock"), "").expect("written");
        fs::write(journal.join("1-0.json"), shape("work", 7).write()).expect("written");
        self
    }

    pub(crate) fn library(&self) -> Library {
        Library::open(self.folder.clone())
    }

    /// Returns the number of the shape with a name, if there is one. Fails if the shape is torn.
    pub(crate) fn version(&self, name: &str) -> Option<u32> {
        match self.library().load(name) {
            Ok(loaded) => Some(version(&loaded.shape)),
            Err(LibraryError::Unknown { .. }) => None,
            Err(error) => panic!("lost: {error}"),
        }
    }

    /// Returns the numbers of the unsaved work that is offered for recovery.
    pub(crate) fn orphans(&self) -> Vec<u32> {
        let orphans = Orphan::all(&self.library());
        orphans
            .iter()
            .map(|orphan| version(&orphan.shape))
            .collect()
    }

    /// Starts the program after the crash: it is not blocked, finds every file whole, cleans up, and can save again.
    pub(crate) fn starts(&self) {
        // Before the first save there may be no folder, which a check would report as missing.
        let reads = if self.folder.exists() {
            "check"
        } else {
            "list"
        };
        let check = taxel(&["library", reads], &self.folder);
        assert_eq!(
            check.status.code(),
            Some(0),
            "a start after the crash: {check:?}"
        );
        let left = self.library().leftovers().expect("the folder is read");
        let half = |(_, what): &&(PathBuf, &str)| what.contains("half-written");
        assert_eq!(left.iter().find(half), None, "swept");
        let expected = match self.library().load("after") {
            Ok(loaded) => Expected::Stamp(loaded.stamp),
            Err(_) => Expected::Nothing,
        };
        let saved = self.library().save(&shape("after", 5), expected);
        assert!(saved.is_ok(), "saving goes on: {saved:?}");
        let own = self.library().list().expect("listed").into_iter();
        for entry in own.filter(|entry| entry.origin == ShapeOrigin::Own) {
            assert!(self.version(&entry.name).is_some());
        }
    }
}

/// Returns the command that runs the program on a library.
pub(crate) fn program(arguments: &[&str], folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_taxel"));
    command
        .args(arguments)
        .arg("--library")
        .arg(folder)
        .env("LC_ALL", "C.UTF-8")
        .env("TAXEL_CONFIG", "/dev/null")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// Runs the program on a library, and fails if it does not end.
pub(crate) fn taxel(arguments: &[&str], folder: &Path) -> Output {
    finish(&mut program(arguments, folder))
}

/// Runs a command to its end; fails if it takes too long.
pub(crate) fn finish(command: &mut Command) -> Output {
    let mut child = command.spawn().expect("the program starts");
    let start = Instant::now();
    // The output fits into the buffer of a pipe, so it can be read at the end.
    while child.try_wait().expect("a child").is_none() {
        if start.elapsed() > DEADLINE {
            let _ = child.kill();
            panic!("blocked: {command:?}");
        }
        std::thread::sleep(Duration::from_micros(500));
    }
    child.wait_with_output().expect("a child")
}

/// Runs all jobs, one at a time on each core.
pub(crate) fn each<T: Sync>(jobs: &[T], run: impl Fn(&T) + Sync) {
    let next = AtomicUsize::new(0);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    run(job);
                }
            });
        }
    });
}
