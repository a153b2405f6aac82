//! A library before an act, and what may be in it afterwards.

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

/// No start takes so long, on the busiest machine.
const DEADLINE: Duration = Duration::from_secs(20);

/// A shape that carries a number.
pub(crate) fn shape(name: &str, version: u32) -> StoredShape {
    let mut imprint = Imprint::empty(16, 16);
    for row in 0..16 {
        // Every row tells the number, so that no part of another file passes for it.
        imprint.set_word(row, u64::from(version >> (row % 2 * 16) & 0xffff));
    }
    let name = Name::new(name).expect("a name");
    StoredShape::new(name, Sensor::default(), imprint, None).expect("16 x 16 both")
}

/// The number that a shape carries.
pub(crate) fn version(shape: &StoredShape) -> u32 {
    let word = |row: usize| u32::try_from(shape.imprint.words()[row]).expect("16 bits");
    let version = word(0) | word(1) << 16;
    assert_eq!(shape.imprint, self::shape("x", version).imprint, "torn");
    version
}

/// A library in a folder of its own: "one" with number 1, "two" with 2, and "gone" with 3 in the trash.
pub(crate) struct State {
    _folder: TempDir,
    pub(crate) folder: PathBuf,
    /// A file outside with number 9, under another name.
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

    /// The unsaved work of a program that is dead.
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

    /// The number of a shape, if there is one of that name. A torn one is a failure.
    pub(crate) fn version(&self, name: &str) -> Option<u32> {
        match self.library().load(name) {
            Ok(loaded) => Some(version(&loaded.shape)),
            Err(LibraryError::Unknown { .. }) => None,
            Err(error) => panic!("lost: {error}"),
        }
    }

    /// The numbers of the work that is offered back.
    pub(crate) fn orphans(&self) -> Vec<u32> {
        let orphans = Orphan::all(&self.library());
        orphans
            .iter()
            .map(|orphan| version(&orphan.shape))
            .collect()
    }

    /// A start after the crash is not blocked, finds every file whole, and clears up; and saving goes on.
    pub(crate) fn starts(&self) {
        let check = taxel(&["library", "check"], &self.folder);
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

/// The program, for a library.
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

/// Runs it, and fails where it does not end.
pub(crate) fn taxel(arguments: &[&str], folder: &Path) -> Output {
    finish(&mut program(arguments, folder))
}

/// Runs a command to its end, which must come.
pub(crate) fn finish(command: &mut Command) -> Output {
    let mut child = command.spawn().expect("the program starts");
    let start = Instant::now();
    // What it says fits into a pipe.
    while child.try_wait().expect("a child").is_none() {
        if start.elapsed() > DEADLINE {
            let _ = child.kill();
            panic!("blocked: {command:?}");
        }
        std::thread::sleep(Duration::from_micros(500));
    }
    child.wait_with_output().expect("a child")
}

/// Runs all jobs, as many at a time as the machine has cores.
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
