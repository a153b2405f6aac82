//! The live page in a terminal: recording by a key, a disk that hangs meanwhile, a terminal that is not read for a
//! while, and how often the page is drawn.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rustix::process::Signal;
use taxel::storage::{Journal, Library};

use super::program::{Program, Start, TAXEL};
use super::record::shape;
use super::tracer::Tracer;
use crate::array;
use crate::wait::{connection, fifo, writer_of};

/// Returns frames of 4 × 4 whose first value is their number.
fn frames(numbers: std::ops::Range<u32>) -> String {
    numbers
        .map(|number| format!("{number} 1 2 3\n4 5 6 7\n8 9 10 11\n12 13 14 15\n\n"))
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
            "cd '{}' && {before} exec '{TAXEL}' watch frames --format lines --at-least 9 {arguments}",
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

    /// Starts a recording and returns its file. The file includes the first frame, because it was only confirmed as a
    /// frame when the second came.
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

#[test]
fn a_recording_without_a_frame_leaves_no_file() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    // Neither before the very first frame, nor after it.
    for _ in 0..2 {
        let file = watched.records();
        watched.program.types(b"r");
        let said = "touch-1.npy: no frame came, so nothing was written";
        watched.program.shows(said);
        assert!(!file.exists() && !file.with_extension("json").exists());
        watched.shows_the_first_frame();
    }
    watched.ends();
}

/// A limit of the system acts as a full disk.
const FULL: &str = "trap '' XFSZ; ulimit -f 9;";

#[test]
fn a_recording_that_fails_replaces_the_notice_of_its_start() {
    let Some(mut watched) = Watched::started(FULL, "") else {
        return;
    };
    watched.program.resize((60, 20));
    watched.shows_the_first_frame();
    watched.records();
    watched.sends(1..4000);
    let failed = "! touch-1.npy: cannot record: File too large";
    watched.program.shows(failed);
    let screen = watched.program.rows();
    assert!(!screen.contains("recording in"), "{screen}");
    // The error remains while there is no recording, and a key does not hide it.
    watched.program.types(b"T");
    watched.program.shows("! there is no tare; touch-1.npy:");
    watched.ends();
}

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

/// Starts watching and recording a source on a disk that then hangs.
fn recorded_on_a_hanging_disk() -> Option<(Watched, PathBuf, Tracer)> {
    let mut watched = Watched::start()?;
    watched.shows_the_first_frame();
    let file = watched.records();
    watched.sends(1..21);
    watched.program.shows("frame 20");
    let hanging = Tracer::hang(&mut watched.program, "?fsync,?fdatasync", &[])?;
    Some((watched, file, hanging))
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
fn leaving_the_page_says_what_was_recorded() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.shows_the_first_frame();
    let file = watched.records();
    watched.sends(1..6);
    watched.program.shows("frame 5");
    watched.program.types(b"\x1b");
    watched.program.shows("touch-1.npy: 6 frames recorded");
    assert_eq!(records(&file), Some(6));
    watched.program.types(b"q");
    watched.program.ends_well(0);
}

#[test]
fn a_device_that_is_not_a_serial_line_is_refused_at_once() {
    let mut program = Program::start(&Start::default());
    program.types(b":watch /dev/urandom\r");
    program.shows("! cannot open: it is not a serial line");
    program.types(b"\x1b");
    program.shows("? Help");
    program.types(b"q");
    program.ends_well(0);
}

/// Its reader would take half of the keys.
#[test]
fn the_terminal_of_the_keys_is_not_watched() {
    let mut program = Program::start(&Start::default());
    for (source, name) in [
        ("-", "standard input"),
        ("/dev/tty", "/dev/tty"),
        ("/dev/stdout", "/dev/stdout"),
    ] {
        program.types(format!(":watch {source}\r").as_bytes());
        program.shows(&format!("! {name}: this is your terminal; pipe frames"));
        program.types(b"\x1b");
        program.shows("? Help");
    }
    program.types(b"q");
    program.ends_well(0);
    let folder = tempfile::tempdir().expect("a folder");
    let said = "error: standard input: this is your terminal; pipe frames into 'taxel watch -'";
    is_refused(folder.path(), "-", said);
    // Set up as a serial line, the terminal would keep its echo off, and Ctrl-C would be a byte of a frame.
    for (arguments, name, status) in [
        ("/dev/stdin --json", "/dev/stdin", 1),
        ("/dev/tty --at-least 3 | cat", "/dev/tty", 0),
        ("/dev/stderr < /dev/null | cat", "/dev/stderr", 0),
    ] {
        let mut program = watching(folder.path(), arguments);
        program.ends_well(status);
        program.shows(&format!(
            "error: {name}: this is your terminal; pipe frames"
        ));
    }
}

#[test]
fn frames_are_recorded_while_a_hanging_disk_takes_a_mark() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.program.types(b"r");
    watched.program.shows("recording in touch-1.npy");
    watched.sends(1..11);
    watched.program.shows("touch-1.npy, 10 frames");
    let Some(hanging) = Tracer::hang(&mut watched.program, "?fsync", &[]) else {
        return;
    };
    watched.program.types(b"m");
    watched.program.shows("frame 9: marked");
    watched.sends(11..21);
    watched.program.shows("touch-1.npy, 20 frames");
    hanging.end();
    watched.program.types(b"r");
    watched.program.shows("touch-1.npy: 20 frames recorded");
    let beside = fs::read(watched.folder.path().join("touch-1.json")).expect("written");
    let beside: serde_json::Value = serde_json::from_slice(&beside).expect("JSON");
    assert_eq!(beside["marks"][0]["number"], 9, "{beside}");
    watched.program.types(b"q");
    watched.program.types(b"q");
    watched.program.ends_well(0);
}

#[test]
fn keys_go_on_while_a_hanging_disk_takes_a_recording() {
    for leaves in [false, true] {
        let Some((mut watched, file, hanging)) = recorded_on_a_hanging_disk() else {
            return;
        };
        watched.program.types(if leaves { b"\x1b" } else { b"r" });
        (watched.program).shows("Saving touch-1.npy: waiting for the disk");
        if leaves {
            watched.program.types(b" ");
            watched.program.shows("NA 1 in all");
        } else {
            watched.sends(21..31);
            watched.program.shows("frame 30");
        }
        hanging.end();
        watched.program.shows("touch-1.npy: 21 frames recorded");
        assert_eq!(records(&file), Some(21), "none of those after the key");
        assert!(is_ended(&file));
        // The drawing is given up; on the page of a source, a first q leaves the page.
        let keys: [&[u8]; 2] = if leaves { [b"q", b"y"] } else { [b"q", b"q"] };
        for key in keys {
            watched.program.types(key);
        }
        watched.program.ends_well(0);
    }
}

#[test]
fn the_end_does_not_wait_for_a_recording_on_a_hanging_disk() {
    // The cases run together, because they mostly wait for that disk.
    std::thread::scope(|scope| {
        for (keys, signal, status) in [
            (&b"qq"[..], None, 0),
            (b"", Some(Signal::TERM), 143),
            (b"", Some(Signal::HUP), 129),
        ] {
            scope.spawn(move || ends_before_its_recording(keys, signal, status));
        }
    });
}

fn ends_before_its_recording(keys: &[u8], signal: Option<Signal>, status: i32) {
    let Some((mut watched, file, hanging)) = recorded_on_a_hanging_disk() else {
        return;
    };
    let begun = Instant::now();
    for key in keys {
        watched.program.types(&[*key]);
    }
    if let Some(signal) = signal {
        watched.program.signal(signal);
    }
    let why = "Saving touch-1.npy: not done yet, because the disk does not answer";
    watched.program.shows(why);
    watched.program.is_left();
    println!("the shell has the terminal after {:?}", begun.elapsed());
    // The system waits for the tracer.
    hanging.end();
    let (ended, _) = watched.program.ends();
    assert_eq!(ended.code(), Some(status));
    assert_eq!(records(&file), Some(21), "written, though not synced");
}

#[test]
fn frames_are_shown_while_a_hanging_disk_creates_a_recording() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.shows_the_first_frame();
    let Some(hanging) = Tracer::hang(&mut watched.program, "?fsync,?fdatasync", &[]) else {
        return;
    };
    watched.program.types(b"r");
    (watched.program).shows("Starting a recording: waiting for the disk");
    watched.sends(1..11);
    watched.program.shows("frame 10");
    watched.program.types(b"r");
    watched.program.shows("a recording is already starting");
    hanging.end();
    watched.program.shows("recording in touch-1.npy");
    watched.sends(11..14);
    watched.program.shows("frame 13");
    watched.program.types(b"r");
    watched.program.shows("touch-1.npy: 3 frames recorded");
    watched.ends();
}

#[test]
fn frames_are_recorded_if_no_more_threads_can_be_started() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.shows_the_first_frame();
    let Some(_tracer) = Tracer::refuse_threads(&mut watched.program, "1+") else {
        return;
    };
    // There is no thread for the disk, and none for syncing.
    let file = watched.records();
    watched.sends(1..6);
    watched.program.shows("frame 5");
    watched.program.types(b"r");
    watched.program.shows("touch-1.npy: 6 frames recorded");
    assert_eq!(records(&file), Some(6));
    assert!(is_ended(&file));
    // There is no thread for naming imprints, either.
    watched.program.types(b"n");
    watched.program.shows("cannot start a thread");
    watched.sends(6..8);
    watched.program.shows("frame 7");
    watched.ends();
}

#[test]
fn a_source_without_a_thread_is_reported_as_not_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let source = folder.path().join("touch.txt");
    fs::write(&source, frames(0..3)).expect("written");
    let mut program = Program::started(&Start::default());
    let Some(tracer) = Tracer::refuse_threads(&mut program, "1+") else {
        return;
    };
    program.types(format!(":watch {}\r", source.display()).as_bytes());
    program.shows("cannot start a thread");
    program.types(b"\x1b");
    program.shows("? Help");
    // The source is read once there are threads again.
    tracer.end();
    program.types(b"w");
    program.shows("frame 2");
    program.types(b"q");
    program.types(b"q");
    program.ends_well(0);
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
    while records(&file) != Some(4001) {
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
    watched.program.shows("4,001 frames recorded");
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

/// Checks that the command ends with an error on the terminal, without opening a page.
fn is_refused(folder: &Path, arguments: &str, said: &str) {
    let mut program = watching(folder, arguments);
    program.ends_well(1);
    program.shows(said);
    assert_eq!(program.count(b"\x1b[?1049h"), 0, "{arguments}");
}

#[test]
fn a_source_that_cannot_be_opened_opens_no_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let missing = "error: nope.csv: cannot open: no such file or folder";
    is_refused(folder, "nope.csv", missing);
    let connection = "; a connection is written tcp://robot:7000";
    is_refused(folder, "robot:7000", connection);
    let is_folder = "error: .: cannot open: it is a folder";
    is_refused(folder, ".", is_folder);
    let no_port = "error: tcp://robot: cannot open: expected tcp://HOST:PORT";
    is_refused(folder, "tcp://robot", no_port);
}

#[test]
fn a_connection_that_is_not_there_yet_is_waited_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    drop(listener);
    let mut program = watching(folder.path(), &format!("tcp://{address} --at-least 9"));
    program.shows(&format!("waiting for tcp://{address}, trying again each"));
    let listener = std::net::TcpListener::bind(address).expect("the same port");
    let mut connection = connection(&listener);
    let sent = connection.write_all(frames(0..3).as_bytes());
    sent.expect("it reads");
    // The first frame may have been incomplete.
    program.shows("frame 1");
    program.types(b"q");
    program.types(b"q");
    program.ends_well(0);
}

#[test]
fn the_notice_of_a_connection_gap_stays_until_a_key_is_pressed() {
    let folder = tempfile::tempdir().expect("a folder");
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    let mut program = watching(folder.path(), &format!("tcp://{address} --at-least 9"));
    for frame in ["frame 2", "frame 5"] {
        let mut connection = connection(&listener);
        // The first frame may have been incomplete.
        let sent = connection.write_all(frames(0..4).as_bytes());
        sent.expect("it reads");
        program.shows(frame);
        if frame == "frame 2" {
            program.types(b"t");
            program.shows("tare of the last");
        }
    }
    program.shows("! no frames for 1");
    program.shows(" s, of which the connection was lost for 1");
    program.shows("gaps       1, 1");
    program.types(b"T");
    program.shows("tare removed");
    program.until("no gap", |program| {
        let screen = program.screen().contents();
        !screen.contains("no frames for") && screen.contains("gaps       1, 1")
    });
    program.types(b"q");
    program.types(b"q");
    program.ends_well(0);
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

#[test]
fn a_recording_that_cannot_be_started_opens_no_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    fs::write(folder.join("touch.txt"), frames(0..3)).expect("written");
    fs::write(folder.join("old.npy"), "mine").expect("written");
    let there = "error: \"old.npy\" already exists; --force replaces it";
    is_refused(folder, "touch.txt --write old.npy", there);
    let missing = "error: no/new.npy: cannot record: no such folder";
    is_refused(folder, "touch.txt --write no/new.npy", missing);
    // The file to be replaced is kept until the first frame comes, and no other file appears.
    fs::write(folder.join("empty.txt"), "").expect("written");
    let mut program = watching(folder, "empty.txt --write old.npy --force");
    program.shows("recording  old.npy, 0 frames");
    program.types(b"q");
    program.types(b"q");
    program.ends_well(0);
    let old = fs::read_to_string(folder.join("old.npy")).expect("it is there");
    assert_eq!(old, "mine");
    assert_eq!(fs::read_dir(folder).expect("it is there").count(), 3);
}

#[test]
fn a_reopened_page_does_not_change_its_recording() {
    for force in ["", "--force"] {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        let rows = "time,r0c0,r0c1\n0.0,1,2\n0.1,3,4\n0.2,5,6\n";
        fs::write(folder.join("touch.csv"), rows).expect("written");
        let file = folder.join("a.npy");
        let mut program = watching(folder, &format!("touch.csv --write a.npy {force}"));
        program.shows("ended");
        program.types(b"\x1b");
        program.shows("a.npy: 3 frames recorded");
        assert_eq!(records(&file), Some(3));
        // These contents differ from those that a second recording would write.
        fs::write(&file, "mine").expect("written");
        program.types(b"w");
        program.shows("ended");
        let screen = program.rows();
        assert!(!screen.contains("recording"), "{screen}");
        program.types(b"q");
        program.types(b"q");
        program.ends_well(0);
        assert_eq!(fs::read_to_string(&file).expect("it is there"), "mine");
    }
}

/// For example after a lost connection: keys belong to the page, and the question comes when the page is left.
#[test]
fn unsaved_work_from_last_time_does_not_prevent_recording() {
    for answer in [b"y", b"n"] {
        let folder = tempfile::tempdir().expect("a folder");
        let (folder, place) = (folder.path(), folder.path().join("library"));
        Journal::new(&Library::open(place.clone()))
            .keep(&shape("lost", ".#.#.#......"))
            .expect("kept");
        fs::write(
            folder.join("touch.csv"),
            "time,r0c0,r0c1\n0.0,1,2\n0.1,3,4\n0.2,5,6\n",
        )
        .expect("written");
        let [source, file] = ["touch.csv", "a.npy"].map(|name| folder.join(name));
        let text = |path: &Path| path.to_str().expect("UTF-8").to_owned();
        let mut program = Program::start(&Start {
            command: &[TAXEL, "watch", &text(&source), "--write", &text(&file)],
            library: Some(&place),
            ..Start::default()
        });
        program.shows("There is unsaved work from last time: lost, 3 taxels");
        program.shows("ended");
        program.types(b" ");
        program.shows("frozen");
        program.types(b"\x1b");
        program.shows("Restore it? (y: yes, n: to the trash");
        program.shows("a.npy: 3 frames recorded");
        program.types(answer);
        program.shows(if answer == b"y" {
            "restored"
        } else {
            "in the trash"
        });
        assert_eq!(records(&file), Some(3));
        program.types(b"q");
        if answer == b"y" {
            program.types(b"y");
        }
        program.ends_well(0);
    }
}

#[test]
fn the_reason_why_nothing_is_recorded_stays_on_the_page() {
    let Some(mut watched) = Watched::start() else {
        return;
    };
    watched.shows_the_first_frame();
    fs::remove_dir_all(watched.folder.path()).expect("removed");
    watched.program.types(b"r");
    watched.program.shows("cannot record: no such folder");
    watched.sends(1..5);
    watched.program.shows("frame 4");
    watched.program.shows("recording  none: ");
    watched.ends();
}
