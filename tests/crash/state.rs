//! A library and a recording before a deed, and the states that they may be in afterwards.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

use taxel_core::imprint::Imprint;
use taxel_core::sensor::Sensor;
use taxel_files::formats::recording::RecordingMetadata;
use taxel_files::formats::{Name, StoredShape};
use taxel_files::storage::{Expected, Library, LibraryError, LoadedShape, Orphan, ShapeOrigin};
use tempfile::TempDir;

/// The longest time that a program may take, even on the busiest machine.
const DEADLINE: Duration = Duration::from_secs(20);

/// A shape whose taxels encode a number.
pub(crate) fn shape(name: &str, version: u32) -> StoredShape {
    let mut imprint = Imprint::empty(Sensor::default().size());
    for row in 0..16 {
        // Every second row holds the same half of the number, so no part of another file can pass for it.
        imprint.set_word(row, u64::from(version >> (row % 2 * 16) & 0xffff));
    }
    let name = Name::new(name).expect("a name");
    StoredShape::new(name, Sensor::default(), imprint, None).expect("16 x 16 both")
}

/// The number that a shape encodes.
fn version(shape: &StoredShape) -> u32 {
    let word = |row: usize| u32::try_from(shape.imprint.words()[row]).expect("16 bits");
    let version = word(0) | word(1) << 16;
    assert_eq!(shape.imprint, self::shape("x", version).imprint, "torn");
    version
}

/// A folder with a recording, frames to record, a shape with number 9, and a library: shape "one" with number 1, "two"
/// with 2, and "gone" with 3 in the trash.
pub(crate) struct State {
    place: TempDir,
    pub(crate) folder: PathBuf,
}

impl State {
    pub(crate) fn new() -> Self {
        let place = tempfile::tempdir().expect("there is a folder for temporary files");
        let folder = place.path().join("library");
        fs::create_dir_all(folder.join(".trash")).expect("made");
        let state = Self { place, folder };
        for (file, name, version) in [
            ("library/one.json", "one", 1),
            ("library/two.json", "two", 2),
            ("library/.trash/gone-1.json", "gone", 3),
            ("new.json", "new", 9),
        ] {
            state.put(file, shape(name, version).write());
        }
        state.put("new.txt", "0,1\n2,3\n\n4,5\n6,7\n\n8,9\n1,2\n\n");
        state.put("touch.npy", old_array());
        let metadata = RecordingMetadata {
            source: "old.txt".to_owned(),
            ended: Some(true),
            ..RecordingMetadata::default()
        };
        state.put("touch.json", metadata.text());
        state
    }

    fn put(&self, file: &str, content: impl AsRef<[u8]>) {
        fs::write(self.place.path().join(file), content).expect("written");
    }

    pub(crate) fn place(&self) -> &Path {
        self.place.path()
    }

    pub(crate) fn path(&self, file: &str) -> String {
        self.place.path().join(file).to_string_lossy().into_owned()
    }

    pub(crate) fn library(&self) -> Library {
        Library::open(self.folder.clone())
    }

    pub(crate) fn load(&self, name: &str) -> Result<LoadedShape, LibraryError> {
        self.library().load(name)
    }

    /// The number of the shape with a name, if there is one. Fails if the shape is torn.
    pub(crate) fn version(&self, name: &str) -> Option<u32> {
        match self.load(name) {
            Ok(loaded) => Some(version(&loaded.shape)),
            Err(LibraryError::Unknown { .. }) => None,
            Err(error) => panic!("lost: {error}"),
        }
    }

    /// The numbers of the unsaved work that is offered for recovery.
    pub(crate) fn orphans(&self) -> Vec<u32> {
        let orphans = Orphan::all(&self.library()).into_iter();
        orphans.map(|orphan| version(&orphan.shape)).collect()
    }

    /// The number of half-written files.
    pub(crate) fn temporary_files(&self) -> usize {
        let folders = ["", "library", "library/.trash", "library/.journal"];
        let files = folders.map(|folder| fs::read_dir(self.place.path().join(folder)));
        let names = files.into_iter().flatten().flatten().flatten();
        let is_temporary = |name: &str| name.starts_with(".taxel-");
        let names = names.map(|file| file.file_name().to_string_lossy().into_owned());
        names.filter(|name| is_temporary(name)).count()
    }

    /// The next program is not blocked, finds every shape whole, and can save again.
    pub(crate) fn goes_on(&self, context: &str) {
        let list = finish(&mut program(&["library", "list"], self));
        assert!(list.status.success(), "{list:?} {context}");
        let expected = match self.load("after") {
            Ok(loaded) => Expected::Stamp(loaded.stamp),
            Err(_) => Expected::Nothing,
        };
        let saved = self.library().save(&shape("after", 5), expected);
        assert!(saved.is_ok(), "{saved:?} {context}");
        let own = self.library().list().expect("listed").into_iter();
        for entry in own.filter(|entry| entry.origin == ShapeOrigin::Own) {
            assert!(self.version(&entry.name).is_some(), "{context}");
        }
        assert_eq!(self.version("two"), Some(2), "{context}");
    }
}

/// An array as taxel records it, of one frame with the values 1 to 4.
fn old_array() -> Vec<u8> {
    let descr = "[('time', '<f8'), ('number', '<u8'), ('values', '<f8', (2, 2))]";
    let text = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': (1,), }}");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(246_u16.to_le_bytes());
    bytes.extend(format!("{text:<245}\n").bytes());
    bytes.extend([0; 16]);
    bytes.extend(
        [1.0_f64, 2.0, 3.0, 4.0]
            .iter()
            .flat_map(|v| v.to_le_bytes()),
    );
    bytes
}

/// The command that runs taxel on the library of a state.
pub(crate) fn program(arguments: &[&str], state: &State) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_taxel"));
    command
        .args(arguments)
        .arg("--library")
        .arg(&state.folder)
        .env("LC_ALL", "C.UTF-8")
        .env("TAXEL_CONFIG", "/dev/null");
    piped(&mut command);
    command
}

pub(crate) fn piped(command: &mut Command) {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
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
        thread::sleep(Duration::from_micros(500));
    }
    child.wait_with_output().expect("a child")
}
