//! The program in a pseudo-terminal, with an emulator at the other end.
//!
//! A child process has to make the pseudo-terminal its controlling terminal before it becomes the program, which safe
//! Rust cannot do between fork and exec. So the test's own binary is started first, as [`launch`], and then replaced.

use std::env;
use std::fmt::Write as _;
use std::num::NonZeroU16;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags};
use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Termios, Winsize, tcgetattr, tcsetwinsize};
use taxel::tui::script::Session;
use taxel::tui::widget::theme;

/// The path of the real binary.
pub(crate) const TAXEL: &str = env!("CARGO_BIN_EXE_taxel");

/// The longest wait, even on the busiest machine. Only failing tests wait that long.
const DEADLINE: Duration = Duration::from_secs(120);
/// After this time without output, the output is considered complete and its bytes are counted.
const SILENCE: Duration = Duration::from_millis(60);

/// The options for starting a program.
pub(crate) struct Start<'a> {
    pub(crate) command: &'a [&'a str],
    pub(crate) variables: &'a [(&'a str, &'a str)],
    /// Columns and rows.
    pub(crate) size: (u16, u16),
    /// Whether the pseudo-terminal becomes its controlling terminal.
    pub(crate) controlling: bool,
    /// The library; None for an empty one that is deleted with the program.
    pub(crate) library: Option<&'a Path>,
}

impl Default for Start<'_> {
    fn default() -> Self {
        Self {
            command: &[TAXEL],
            variables: &[("TERM", "xterm-256color"), ("LANG", "C.UTF-8")],
            size: (80, 24),
            controlling: true,
            library: None,
        }
    }
}

/// A running program.
pub(crate) struct Program {
    child: Child,
    /// None after a hang-up.
    master: Option<OwnedFd>,
    slave: OwnedFd,
    before: Termios,
    emulator: vt100::Parser,
    /// The library, which is deleted with the program.
    _library: tempfile::TempDir,
    /// All bytes that the program has written.
    pub(crate) bytes: Vec<u8>,
    /// The number of these bytes that the emulator has processed.
    shown: usize,
    /// The number of reads that this took.
    pub(crate) reads: usize,
}

/// The part that runs in the child. As a test without its variables, it does nothing.
pub(crate) fn launch() {
    let Ok(command) = env::var("PTY_COMMAND") else {
        return;
    };
    let stdin = std::io::stdin();
    rustix::process::setsid().expect("a new session");
    if env::var("PTY_CONTROLLING").is_ok() {
        rustix::process::ioctl_tiocsctty(&stdin).expect("a controlling terminal");
    }
    let file = || Stdio::from(stdin.as_fd().try_clone_to_owned().expect("a file"));
    let mut words = command.split('\x1f');
    let error = Command::new(words.next().expect("a command"))
        .args(words)
        .env_remove("PTY_COMMAND")
        .env_remove("PTY_CONTROLLING")
        .stdout(file())
        .stderr(file())
        .exec();
    panic!("{command}: {error}");
}

impl Program {
    pub(crate) fn start(start: &Start<'_>) -> Self {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).expect("a pseudo-terminal");
        grantpt(&master).expect("granted");
        unlockpt(&master).expect("unlocked");
        let name = ptsname(&master, Vec::new()).expect("a name");
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let slave = rustix::fs::open(name, flags, Mode::empty()).expect("its other end");
        rustix::io::fcntl_setfd(&master, rustix::io::FdFlags::CLOEXEC).expect("not inherited");
        set_size(&master, start.size);
        let before = tcgetattr(&slave).expect("attributes");
        let library = tempfile::tempdir().expect("a folder");
        let mut command = Command::new(env::current_exe().expect("this test"));
        command
            .args(["--exact", "pty::launcher", "--ignored", "--nocapture"])
            .env_clear()
            .envs(start.variables.iter().copied())
            .env("TAXEL_LIBRARY", start.library.unwrap_or(library.path()))
            .env("TAXEL_CONFIG", "/dev/null")
            .env("XDG_CACHE_HOME", library.path().join("cache"))
            .env("PTY_COMMAND", start.command.join("\x1f"))
            .stdin(slave.try_clone().expect("a file"))
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        if start.controlling {
            command.env("PTY_CONTROLLING", "1");
        }
        let child = command.spawn().expect("started");
        let (columns, rows) = known(start.size);
        Self {
            _library: library,
            child,
            master: Some(master),
            slave,
            before,
            emulator: emulator(columns, rows),
            bytes: Vec::new(),
            shown: 0,
            reads: 0,
        }
    }

    /// Starts the program and waits for its first screen.
    pub(crate) fn started(start: &Start<'_>) -> Self {
        let mut program = Self::start(start);
        program.shows("? Help");
        program
    }

    pub(crate) fn pid(&self) -> Pid {
        Pid::from_child(&self.child)
    }

    pub(crate) fn signal(&self, signal: Signal) {
        kill_process(self.pid(), signal).expect("it runs");
    }

    pub(crate) fn screen(&self) -> &vt100::Screen {
        self.emulator.screen()
    }

    /// Types bytes, which must be few.
    pub(crate) fn types(&self, bytes: &[u8]) {
        let master = self.master.as_ref().expect("a terminal");
        assert_eq!(rustix::io::write(master, bytes), Ok(bytes.len()));
    }

    pub(crate) fn resize(&mut self, size: (u16, u16)) {
        set_size(self.master.as_ref().expect("a terminal"), size);
        let (columns, rows) = known(size);
        self.emulator.set_size(side(rows), side(columns));
    }

    /// Makes the emulator forget its screen, as if another program had drawn on it.
    pub(crate) fn forget(&mut self) {
        let (rows, columns) = self.screen().size();
        self.emulator = emulator(columns.get(), rows.get());
    }

    /// Reads the output within a time; returns true if there was any.
    pub(crate) fn read(&mut self, time: Duration) -> bool {
        let master = self.master.as_ref().expect("a terminal");
        let mut fds = [PollFd::new(master, PollFlags::IN)];
        let time = Timespec::try_from(time).expect("short");
        if poll(&mut fds, Some(&time)).unwrap_or(0) == 0 {
            return false;
        }
        let mut buffer = [0; 1 << 14];
        let count = rustix::io::read(master, &mut buffer).unwrap_or(0);
        self.bytes.extend(&buffer[..count]);
        // The emulator loses a character that comes in two pieces.
        let waiting = &self.bytes[self.shown..];
        let whole = std::str::from_utf8(waiting).map_or_else(|error| error.valid_up_to(), str::len);
        self.emulator.process(&waiting[..whole]);
        self.shown += whole;
        self.reads += 1;
        count > 0
    }

    /// Reads until a condition holds.
    pub(crate) fn until(&mut self, what: &str, mut holds: impl FnMut(&mut Self) -> bool) {
        let start = Instant::now();
        while !holds(self) {
            assert!(
                start.elapsed() < DEADLINE,
                "waited in vain for {what}, modes {:?}, on\n{}",
                self.modes_on(),
                self.screen().contents()
            );
            self.read(Duration::from_millis(5));
        }
    }

    pub(crate) fn shows(&mut self, text: &str) {
        self.until(text, |program| program.screen().contents().contains(text));
    }

    /// Returns the rows of the screen like a script prints them.
    pub(crate) fn rows(&self) -> String {
        let (_, columns) = self.screen().size();
        let rows = self.screen().rows(0, columns.get());
        let rows: String = rows.map(|row| row.trim_end().to_owned() + "\n").collect();
        rows.trim_end().to_owned()
    }

    /// Reads until the screen is that of a script: characters, styles, and the cursor if it is visible.
    pub(crate) fn agrees(&mut self, session: &Session) {
        let expected = of_session(session);
        let start = Instant::now();
        let mut agrees = of_emulator(self.screen()) == expected;
        while !agrees {
            assert!(
                start.elapsed() < DEADLINE,
                "expected\n{expected}\nfound\n{}",
                of_emulator(self.screen())
            );
            // Without new output, the screen is still the same.
            if self.read(Duration::from_millis(5)) {
                agrees = of_emulator(self.screen()) == expected;
            }
        }
    }

    /// Returns the number of bytes that the program writes during `act` and until it falls silent.
    pub(crate) fn written(&mut self, act: impl FnOnce(&mut Self)) -> usize {
        let before = self.bytes.len();
        act(self);
        while self.read(SILENCE) {}
        self.bytes.len() - before
    }

    /// Cuts the line.
    pub(crate) fn hang_up(&mut self) {
        self.master = None;
    }

    /// Returns the state of the process, for example running, sleeping or stopped.
    pub(crate) fn state(&self) -> char {
        let file = format!("/proc/{}/stat", self.child.id());
        let text = std::fs::read_to_string(file).expect("it runs");
        let (_, rest) = text.rsplit_once(") ").expect("a name");
        rest.chars().next().expect("a state")
    }

    /// Waits for the end; returns the exit status and the time.
    pub(crate) fn ends(&mut self) -> (ExitStatus, Duration) {
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().expect("a child") {
                let took = start.elapsed();
                while self.master.is_some() && self.read(Duration::ZERO) {}
                return (status, took);
            }
            assert!(start.elapsed() < DEADLINE, "it does not end");
            if self.master.is_none() || !self.read(Duration::from_millis(2)) {
                sleep(Duration::from_millis(1));
            }
        }
    }

    /// Waits for the end, reading nothing.
    pub(crate) fn ends_unread(&mut self) -> ExitStatus {
        let line = self.master.take();
        let (status, _) = self.ends();
        drop(line);
        status
    }

    /// Waits for the end with an exit status, and checks that the terminal is as it was before.
    pub(crate) fn ends_well(&mut self, status: i32) {
        let (ended, _) = self.ends();
        assert_eq!((ended.code(), ended.signal()), (Some(status), None));
        self.is_left();
    }

    /// Checks that the terminal's attributes are as before, and that no mode is left on.
    pub(crate) fn is_left(&mut self) {
        self.no_mode_is_on();
        let now = tcgetattr(&self.slave).expect("attributes");
        assert_eq!(format!("{now:?}"), format!("{:?}", self.before));
    }

    /// Checks that no mode is left on. When the program has ended, its last bytes may still be in transit.
    pub(crate) fn no_mode_is_on(&mut self) {
        self.until("no mode to be on", |program| program.modes_on().is_empty());
    }

    /// Returns the modes that are on.
    fn modes_on(&self) -> Vec<&'static str> {
        let screen = self.screen();
        let mouse = screen.mouse_protocol_mode() != vt100::MouseProtocolMode::None
            || screen.mouse_protocol_encoding() != vt100::MouseProtocolEncoding::Default;
        let keys = screen.application_cursor() || screen.application_keypad();
        let plain = [screen.bold(), screen.dim(), screen.inverse()] == [false; 3]
            && screen.fgcolor() == vt100::Color::Default;
        // The emulator does not know this mode, so its begins and ends are counted.
        let held = self.count(b"\x1b[?2026l") < self.count(b"\x1b[?2026h");
        [
            ("second screen", screen.alternate_screen()),
            ("hidden cursor", screen.hide_cursor()),
            ("marked paste", screen.bracketed_paste()),
            ("other keys", keys),
            ("mouse", mouse),
            ("style", !plain),
            ("held frame", held),
        ]
        .into_iter()
        .filter_map(|(name, on)| on.then_some(name))
        .collect()
    }

    /// Returns how often the program has written some bytes.
    pub(crate) fn count(&self, mark: &[u8]) -> usize {
        count(&self.bytes, mark)
    }

    /// Returns a number from /proc/PID/status.
    pub(crate) fn status(&self, name: &str) -> u64 {
        number(&format!("/proc/{}/status", self.child.id()), name)
    }

    /// Returns how often any of its threads has woken up.
    pub(crate) fn wakeups(&self) -> u64 {
        let folder = format!("/proc/{}/task", self.child.id());
        let threads = std::fs::read_dir(folder).expect("it runs");
        let ids = threads.map(|thread| thread.expect("a thread").file_name());
        ids.map(|id| {
            number(
                &format!("/proc/{}/status", id.display()),
                "voluntary_ctxt_switches",
            )
        })
        .sum()
    }

    /// Returns the processor time in hundredths of a second.
    pub(crate) fn cpu(&self) -> u64 {
        let file = format!("/proc/{}/stat", self.child.id());
        let text = std::fs::read_to_string(file).expect("it runs");
        let fields = text.rsplit_once(')').expect("a name").1.split_whitespace();
        fields
            .skip(11)
            .take(2)
            .map(|field| field.parse::<u64>().expect("a number"))
            .sum()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // The program has ended already, or its test has failed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Returns a number from a status file in /proc.
fn number(file: &str, name: &str) -> u64 {
    let text = std::fs::read_to_string(file).expect("it runs");
    let line = text.lines().find_map(|line| line.strip_prefix(name));
    let number = line.and_then(|rest| rest.trim_start_matches(':').split_whitespace().next());
    number
        .and_then(|number| number.parse().ok())
        .expect("a number")
}

/// Counts how often the bytes contain `mark`.
fn count(bytes: &[u8], mark: &[u8]) -> usize {
    let found = bytes.windows(mark.len()).filter(|found| *found == mark);
    found.count()
}

fn set_size(master: &OwnedFd, (columns, rows): (u16, u16)) {
    let size = Winsize {
        ws_row: rows,
        ws_col: columns,
        ws_xpixel: 0,
        ws_ypixel: 0,
    };
    tcsetwinsize(master, size).expect("a size");
}

/// Returns the size that the program takes for a terminal that does not know its own.
fn known(size: (u16, u16)) -> (u16, u16) {
    if size == (0, 0) { (80, 24) } else { size }
}

fn emulator(columns: u16, rows: u16) -> vt100::Parser {
    vt100::Parser::new(side(rows), side(columns), 0)
}

fn side(number: u16) -> NonZeroU16 {
    NonZeroU16::new(number).expect("not empty")
}

/// Returns a screen as text: the rows, the styles of everything that is not blank, the cursor.
fn of_session(session: &Session) -> String {
    let mut text = String::new();
    for (row, styles) in session.screen().lines().zip(session.styles().lines()) {
        // Blanks at the end of a row are cut off, but they may be reversed.
        let row = row.chars().chain(std::iter::repeat(' '));
        let cells: Vec<(char, char)> = row.zip(styles.chars()).collect();
        write_row(&mut text, &cells);
    }
    let cursor = session.cursor().map(|cursor| (cursor.x, cursor.y));
    write!(text, "cursor {cursor:?}").expect("a string");
    text
}

fn of_emulator(screen: &vt100::Screen) -> String {
    let (rows, columns) = screen.size();
    let mut text = String::new();
    for row in 0..rows.get() {
        let cells: Vec<(char, char)> = (0..columns.get())
            .filter_map(|column| screen.cell(row, column))
            .filter(|cell| !cell.is_wide_continuation())
            .map(|cell| (cell.contents().chars().next().unwrap_or(' '), letter(cell)))
            .collect();
        write_row(&mut text, &cells);
    }
    let (row, column) = screen.cursor_position();
    let cursor = (!screen.hide_cursor()).then_some((column, row));
    write!(text, "cursor {cursor:?}").expect("a string");
    text
}

fn letter(cell: &vt100::Cell) -> char {
    use ratatui::style::{Modifier, Style};
    assert!(!cell.underline(), "nothing is underlined");
    let attributes = [
        (cell.inverse(), Modifier::REVERSED),
        (cell.bold(), Modifier::BOLD),
        (cell.dim(), Modifier::DIM),
    ];
    let set = attributes
        .into_iter()
        .filter(|(set, _)| *set)
        .map(|(_, attribute)| attribute);
    theme::letter(&Style::new().add_modifier(set.collect()))
}

/// The style of a blank only matters if it is reversed.
fn write_row(text: &mut String, cells: &[(char, char)]) {
    let row: String = cells.iter().map(|(character, _)| *character).collect();
    let styles: String = cells
        .iter()
        .map(|&(character, style)| {
            if character == ' ' && style != 'R' {
                '.'
            } else {
                style
            }
        })
        .collect();
    writeln!(text, "{}\n{}", row.trim_end(), styles.trim_end_matches('.')).expect("a string");
}
