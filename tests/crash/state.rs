//! A library and a recording before a deed, and what they may be afterwards.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{env, fs, thread};

use taxel_core::imprint::Imprint;
use taxel_core::sensor::Sensor;
use taxel_files::acquire::metadata_beside;
use taxel_files::formats::recording::RecordingMetadata;
use taxel_files::formats::{Name, StoredShape};
use taxel_files::storage::{Expected, Library, LibraryError, Orphan, ShapeOrigin};
use tempfile::TempDir;

use super::array;

/// The variable that makes this binary perform an act.
pub(crate) const ACT: &str = "TAXEL_CRASH_ACT";

/// A shape whose rows all encode a number.
pub(crate) fn shape(name: &str, version: u32) -> StoredShape {
    let mut imprint = Imprint::empty(Sensor::default().size());
    (0..16).for_each(|row| imprint.set_word(row, version.into()));
    let name = Name::new(name).expect("a name");
    StoredShape::new(name, Sensor::default(), imprint, None).expect("16 x 16 both")
}

fn version(shape: &StoredShape) -> u32 {
    let words = shape.imprint.words();
    assert!(words[..16].iter().all(|word| *word == words[0]), "torn");
    u32::try_from(words[0]).expect("16 bits")
}

/// A folder with a recording, frames to record, a shape with number 9, and a library: shape "one" with number 1 and
/// "two" with 2.
pub(crate) struct State(TempDir);

impl State {
    pub(crate) fn new() -> Self {
        let place = tempfile::tempdir().expect("there is a folder for temporary files");
        fs::create_dir(place.path().join("library")).expect("made");
        let put = |file: &str, content: &[u8]| {
            fs::write(place.path().join(file), content).expect("written");
        };
        for (file, version) in [("library/one", 1), ("library/two", 2), ("new", 9)] {
            put(
                &format!("{file}.json"),
                shape("any", version).write().as_bytes(),
            );
        }
        put("new.txt", b"5,1\n2,3\n\n4,5\n6,7\n\n8,9\n1,2\n\n");
        put(
            "touch.npy",
            &array::array("(1, 2, 2)", false, &[1.0, 2.0, 3.0, 4.0]),
        );
        let metadata = RecordingMetadata {
            source: "old.txt".to_owned(),
            ..RecordingMetadata::default()
        };
        put("touch.json", &metadata.text());
        Self(place)
    }

    pub(crate) fn place(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn library(&self) -> Library {
        Library::open(self.place().join("library"))
    }

    /// The command that runs taxel on the library.
    pub(crate) fn taxel(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_taxel"));
        command.args(arguments).args(["--library", "library"]);
        command
            .current_dir(self.place())
            .env("TAXEL_CONFIG", "/dev/null");
        command
    }

    /// The command that starts this binary to perform an act.
    pub(crate) fn act(&self, act: &str) -> Command {
        let mut command = Command::new(env::current_exe().expect("this binary"));
        let folder = self.library().folder().display().to_string();
        command.env(ACT, format!("{act}:{folder}"));
        command
    }

    /// The number of the shape with a name, if there is one. Fails if the shape is torn.
    pub(crate) fn version(&self, name: &str) -> Option<u32> {
        match self.library().load(name) {
            Ok(loaded) => Some(version(&loaded.shape)),
            Err(LibraryError::Unknown(_)) => None,
            Err(error) => panic!("lost: {error}"),
        }
    }

    /// The numbers of the unsaved work that is offered for recovery.
    pub(crate) fn orphans(&self) -> Vec<u32> {
        let orphans = Orphan::all(&self.library()).into_iter();
        orphans.map(|orphan| version(&orphan.shape)).collect()
    }

    /// The number of frames in the array, and whether it is described. Checks that the frames are whole, and that the
    /// description is that of the array.
    pub(crate) fn recorded(&self) -> (usize, bool) {
        let path = self.place().join("touch.npy");
        let array = fs::read(&path).expect("there is always one");
        let frames = array::records(&array).expect("a header");
        let start = array::start(&array).expect("a header");
        let is_new = String::from_utf8_lossy(&array[..start]).contains("'number'");
        // A record of a recording begins with its time and its number, 8 bytes each.
        let record = 4 * 8 + if is_new { 16 } else { 0 };
        assert!(array.len() >= start + frames * record);
        let metadata = metadata_beside(&path).expect("whole");
        if let Some(metadata) = &metadata {
            assert_eq!(metadata.source.ends_with("new.txt"), is_new);
        }
        (frames, metadata.is_some())
    }

    /// Kills a program some time after its first save. Returns the last numbers that it printed after "saved" and
    /// "kept".
    pub(crate) fn churned(&self, after: Duration) -> (u32, u32) {
        let mut churn = self.act("churn");
        let mut child = churn.stdout(Stdio::piped()).spawn().expect("it starts");
        let mut output = BufReader::new(child.stdout.take().expect("piped"));
        let mut said = String::new();
        // On a busy machine, the start alone may take longer than these moments.
        while !said.contains("saved") {
            let read = output.read_line(&mut said).expect("text");
            assert!(read > 0, "it ended before it saved: {said}");
        }
        thread::sleep(after);
        child.kill().expect("killed");
        child.wait().expect("a child");
        output.read_to_string(&mut said).expect("text");
        let last = |word: &str| {
            let number = said.lines().rev().find_map(|line| line.strip_prefix(word));
            number.map_or(1, |number| number.trim().parse().expect("a number"))
        };
        (last("saved"), last("kept"))
    }

    /// The next program is not blocked, finds every shape whole, and can save again.
    pub(crate) fn goes_on(&self) {
        let list = self
            .taxel(&["library", "list"])
            .output()
            .expect("it starts");
        assert!(list.status.success(), "{list:?}");
        let saved = self.library().save(&shape("after", 5), Expected::Anything);
        saved.expect("saved");
        let all = self.library().list().expect("listed").into_iter();
        for entry in all.filter(|entry| entry.origin == ShapeOrigin::Own) {
            assert!(self.version(&entry.name).is_some());
        }
        assert_eq!(self.version("two"), Some(2));
    }
}
