//! The live page in a terminal: recordings, a terminal that is not read for a while, and how often the page is drawn.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::program::{Program, Start, TAXEL};
use crate::array;
use crate::wait::{fifo, writer_of};

/// Returns frames of 4 × 4 whose first value is their number.
fn frames(numbers: std::ops::Range<u32>) -> String {
    numbers
        .map(|number| format!("{number} 1 3 2\n4 5 6 7\n8 9 10 11\n12 13 14 15\n\n"))
        .collect()
}

/// The program that watches a pipe in a folder.
pub(super) struct Watched {
    /// The program.
    pub(super) program: Program,
    /// The other end of the pipe.
    pub(super) pipe: fs::File,
    /// The folder that the program works in.
    folder: tempfile::TempDir,
}

impl Watched {
    /// Starts the program; None if there is no mkfifo.
    pub(super) fn start() -> Option<Self> {
        Self::started("", "")
    }

    /// Starts the program after shell commands, and with further arguments.
    pub(super) fn started(before: &str, arguments: &str) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("frames");
        fifo(&pipe).then_some(())?;
        let line = format!(
            "cd '{}' && {before} exec '{TAXEL}' watch frames --format lines --rows 4 --columns 4 --at-least 9 {arguments}",
            folder.path().display()
        );
        let program = Program::start(&Start {
            command: &["sh", "-c", &line],
            variables: &[
                ("TERM", "xterm-256color"),
                ("LANG", "C.UTF-8"),
                ("PATH", "/usr/bin:/bin"),
            ],
            ..Start::default()
        });
        // Waits until the program reads the pipe.
        let pipe = writer_of(&pipe);
        Some(Self {
            program,
            pipe,
            folder,
        })
    }

    /// Sends frames.
    pub(super) fn sends(&mut self, numbers: std::ops::Range<u32>) {
        let bytes = frames(numbers);
        self.pipe.write_all(bytes.as_bytes()).expect("it is read");
    }

    /// Sends the first frame, and waits until it is shown.
    fn shows_the_first_frame(&mut self) {
        self.sends(0..1);
        self.program.shows("frame 0");
    }

    /// Starts a recording and returns its file.
    fn records(&mut self) -> PathBuf {
        self.program.types(b"r");
        self.program.shows("recording in touch-1.npy");
        self.folder.path().join("touch-1.npy")
    }

    /// Leaves the page and the program.
    pub(super) fn ends(self) {
        let mut program = self.program;
        program.types(b"q");
        program.types(b"q");
        program.ends_well(0);
    }
}

/// Returns the number of records that the header of an array gives.
fn records(path: &Path) -> Option<usize> {
    array::records(&fs::read(path).ok()?)
}

/// A limit of the system acts as a full disk.
const FULL: &str = "trap '' XFSZ; ulimit -f 9;";

#[test]
fn a_recording_of_the_command_line_that_fails_is_an_error_at_the_end() {
    let Some(mut watched) = Watched::started(FULL, "--write a.npy") else {
        return;
    };
    watched.sends(0..4000);
    let failed = "a.npy: cannot record: File too large";
    watched.program.shows(&format!("! {failed}"));
    watched.program.types(b"q");
    watched.program.types(b"q");
    watched.program.ends_well(1);
    watched.program.shows(&format!("error: {failed}"));
}

/// Returns true if the metadata beside an array says that the recording has ended.
fn is_ended(path: &Path) -> bool {
    let beside = fs::read_to_string(path.with_extension("json")).expect("it is there");
    beside.contains("\"ended\":true") || beside.contains("\"ended\": true")
}

#[test]
fn ctrl_z_and_fg_leave_a_source_and_its_recording_as_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.npy");
    let source = fs::canonicalize("tests/scripts/touch.csv").expect("it is there");
    let line = format!(
        "set -m; cd '{}'; '{TAXEL}' watch '{}' --loop --write a.npy; echo stopped $?; read line; fg >/dev/null; echo ended $?; read line",
        folder.path().display(),
        source.display()
    );
    let mut program = Program::start(&Start {
        command: &["sh", "-c", &line],
        ..Start::default()
    });
    let shows_recorded = |program: &mut Program, name: &str, least: usize| {
        let before = format!("recording  {name}, ");
        program.until("a longer recording", |program| {
            let screen = program.screen().contents();
            let frames = screen.split_once(&before).map(|(_, rest)| rest);
            let frames = frames.and_then(|rest| rest.split_once(" frame")?.0.parse().ok());
            frames >= Some(least)
        });
    };
    shows_recorded(&mut program, "a.npy", 5);
    program.types(b"\x1a");
    program.shows("stopped");
    program.is_left();
    let before = records(&file).expect("a recording");
    assert!(before >= 5, "{before} frames are in the file");
    assert!(!is_ended(&file));
    program.forget();
    program.types(b"\n");
    shows_recorded(&mut program, "a.npy", before + 5);
    program.types(b"r");
    program.shows("frames recorded");
    assert!(records(&file) >= Some(before + 5) && is_ended(&file));
    // Another recording begins.
    program.types(b"r");
    shows_recorded(&mut program, "touch-1.npy", 1);
    program.types(b"q");
    program.types(b"q");
    program.shows("ended 0");
    program.is_left();
    assert!(is_ended(&folder.path().join("touch-1.npy")));
}

#[test]
fn a_terminal_that_is_not_read_does_not_delay_a_recording() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.shows_the_first_frame();
    let file = watched.records();
    // Nothing is read from the terminal while these frames come, which are far more than its buffers hold.
    for piece in 0..200 {
        watched.sends(piece * 20 + 1..piece * 20 + 21);
    }
    let start = Instant::now();
    while records(&file) != Some(4000) {
        assert!(
            start.elapsed() < Duration::from_secs(100),
            "{:?} records",
            records(&file)
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    // Now the newest picture comes.
    watched.program.shows("frame 4000");
    watched.program.types(b"r");
    watched.program.shows("4,000 frames recorded");
    watched.ends();
}

#[test]
fn the_page_is_drawn_at_most_thirty_times_a_second() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.shows_the_first_frame();
    // A picture with so few taxels comes in one piece.
    let before = watched.program.reads;
    let start = Instant::now();
    // 500 frames, at least two milliseconds apart.
    for number in 1..=500 {
        watched.sends(number..number + 1);
        watched.program.read(Duration::from_millis(2));
    }
    watched.program.shows("frame 500");
    let seconds = start.elapsed().as_secs_f64();
    let drawn = watched.program.reads - before;
    println!("{drawn} pictures of 500 frames in {seconds:.2} s");
    let drawn_f = f64::from(u32::try_from(drawn).expect("a few hundred"));
    assert!(
        drawn_f <= 30.0 * seconds + 2.0,
        "{drawn} pictures in {seconds:.2} s"
    );
    assert!(drawn >= 2, "{drawn}");
    watched.ends();
}

/// Starts a command that watches, in a folder.
fn watching(folder: &Path, arguments: &str) -> Program {
    let line = format!(
        "cd '{}' && exec '{TAXEL}' watch {arguments}",
        folder.display()
    );
    Program::start(&Start {
        command: &["sh", "-c", &line],
        ..Start::default()
    })
}

/// Its reader would take half of the keys.
#[test]
fn the_terminal_of_the_keys_is_not_watched() {
    let folder = tempfile::tempdir().expect("a folder");
    for (arguments, name, status) in [
        ("-", "standard input", 1),
        ("/dev/stdin --json", "/dev/stdin", 1),
        ("/dev/tty --at-least 3 | cat", "/dev/tty", 0),
        ("/dev/stderr < /dev/null | cat", "/dev/stderr", 0),
    ] {
        let mut program = watching(folder.path(), arguments);
        program.ends_well(status);
        program.shows(&format!(
            "error: {name}: this is your terminal; pipe frames"
        ));
        assert_eq!(program.count(b"\x1b[?1049h"), 0, "{arguments}");
    }
}
