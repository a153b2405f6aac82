//! The live page in a terminal: recordings, a terminal that is not read for a while, and how often the page is drawn.

use std::fs;
use std::io::Write;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rustix::process::Signal;

use super::program::{Program, Start, TAXEL};
use crate::array;
use crate::wait::{connection, fifo, writer_of};

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

#[test]
fn a_key_starts_and_ends_a_recording() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.sends(0..3);
    watched.program.shows("frame 2");
    let file = watched.records();
    watched.sends(3..23);
    watched.program.shows("frame 22");
    watched.program.types(b"m");
    watched.program.shows("frame 22: marked");
    watched.program.types(b"r");
    watched.program.shows("touch-1.npy: 20 frames recorded");
    assert_eq!(records(&file), Some(20));
    let beside = fs::read_to_string(file.with_extension("json")).expect("it is there");
    let beside: serde_json::Value = serde_json::from_str(&beside).expect("JSON");
    assert_eq!(beside["marks"][0]["number"], 22, "{beside}");
    assert_eq!(beside["rule"]["at_least"], 9, "{beside}");
    watched.ends();
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
fn the_recording_of_a_source_that_has_ended_is_on_the_disk() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let rows = "time,r0c0,r0c1\n0.0,1,2\n0.1,3,4\n0.2,5,6\n";
    fs::write(folder.join("touch.csv"), rows).expect("written");
    let file = folder.join("a.npy");
    let mut program = watching(folder, "touch.csv --write a.npy");
    program.shows("ended");
    program.until("the frames", |_| records(&file) == Some(3));
    // A mark that is set later is written, too.
    program.types(b"m");
    program.shows("frame 2: marked");
    program.until("the mark", |_| {
        let beside = fs::read_to_string(file.with_extension("json")).expect("it is there");
        beside.contains("\"number\":2") || beside.contains("\"number\": 2")
    });
    program.signal(Signal::KILL);
    program.ends();
    assert_eq!(records(&file), Some(3));
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

#[test]
fn a_connection_is_waited_for_and_its_gap_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    drop(listener);
    let mut program = watching(folder.path(), &format!("tcp://{address} --at-least 9"));
    program.shows(&format!("waiting for tcp://{address}, trying again each"));
    let listener = TcpListener::bind(address).expect("the same port");
    for frame in ["frame 2", "frame 5"] {
        // The first frame may have been incomplete.
        let mut connection = connection(&listener);
        let sent = connection.write_all(frames(0..4).as_bytes());
        sent.expect("it reads");
        program.shows(frame);
    }
    program.shows("connection was lost for 1");
    program.shows("gaps       1, 1");
    program.types(b"qq");
    program.ends_well(0);
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

#[test]
fn a_file_that_grows_is_not_read_again_by_key_and_its_recording_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    fs::write(folder.join("touch.txt"), frames(0..3)).expect("written");
    let mut file = fs::File::options()
        .append(true)
        .open(folder.join("touch.txt"))
        .expect("it is there");
    let mut grows = |numbers| file.write_all(frames(numbers).as_bytes()).expect("written");
    let mut program = watching(folder, "touch.txt --at-least 9 --write a.npy");
    program.shows("frame 2");
    grows(3..6);
    program.shows("frame 5");
    program.types(b"w");
    program.shows("the source has not ended yet");
    grows(6..9);
    program.shows("frame 8");
    program.types(b"qq");
    program.ends_well(0);
    assert_eq!(records(&folder.join("a.npy")), Some(9));
}
