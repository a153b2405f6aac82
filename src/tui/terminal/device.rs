//! The terminal's two files: standard input and output if these are terminals, otherwise the controlling terminal.
//!
//! Reading never blocks. Writing waits while the terminal takes nothing, until a signal ends the wait or, at the end
//! of the program, a time limit: a line that hangs must not keep the program from ending.

use std::io::{self, stdin, stdout};
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, OwnedFd};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, open};
use rustix::io::{Errno, read, write};
use rustix::termios::{isatty, tcgetwinsize};

const LAST_WRITE: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 100_000_000,
};

/// The largest size, in columns and rows; a larger one is a mistake and would cost gigabytes.
const LARGEST: (u16, u16) = (1000, 500);

#[derive(Debug)]
pub(in crate::tui) struct Device {
    input: OwnedFd,
    output: OwnedFd,
}

#[derive(Debug, PartialEq, Eq)]
pub(in crate::tui) enum WriteOutcome {
    /// All bytes are written.
    All,
    /// Something else needs attention; an unknown part of the bytes is written.
    Interrupted,
}

impl Device {
    /// Opens the terminal.
    ///
    /// The output is opened a second time, non-blocking, so that a line that takes nothing cannot keep the program
    /// from ending. If that is not allowed, as after `su`, the file is used as it is.
    pub(in crate::tui) fn open() -> io::Result<Self> {
        let input = match stdin() {
            file if isatty(&file) => file.as_fd().try_clone_to_owned()?,
            _ => controlling(OFlags::RDONLY)?,
        };
        let output = match stdout() {
            file if isatty(&file) => file.as_fd().try_clone_to_owned()?,
            _ => controlling(OFlags::WRONLY)?,
        };
        let anew = open(
            format!("/proc/self/fd/{}", output.as_raw_fd()),
            OFlags::WRONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC,
            Mode::empty(),
        );
        let output = anew.ok().filter(|file| isatty(file)).unwrap_or(output);
        Ok(Self { input, output })
    }

    pub(in crate::tui) fn input(&self) -> BorrowedFd<'_> {
        self.input.as_fd()
    }

    /// Reads the available bytes and returns their number; None if the terminal is gone.
    pub(in crate::tui) fn read(&self, buffer: &mut [u8]) -> io::Result<Option<usize>> {
        match read(&self.input, buffer) {
            Ok(0) => Ok(None),
            Ok(count) => Ok(Some(count)),
            Err(Errno::AGAIN | Errno::INTR) => Ok(Some(0)),
            Err(error) => Err(error.into()),
        }
    }

    /// Reads and drops bytes up to and including `end`; gives up after `patience`.
    pub(in crate::tui) fn skip_past(&self, end: &[u8], patience: Duration) {
        let deadline = Instant::now() + patience;
        let (mut buffer, mut read) = ([0; 256], Vec::<u8>::new());
        while !read.windows(end.len()).any(|found| found == end) {
            let left = deadline.saturating_duration_since(Instant::now());
            let Ok(left) = Timespec::try_from(left) else {
                return;
            };
            let mut fds = [PollFd::new(&self.input, PollFlags::IN)];
            match poll(&mut fds, Some(&left)) {
                Ok(1..) => {}
                Err(Errno::INTR) => continue,
                Ok(0) | Err(_) => return,
            }
            match self.read(&mut buffer) {
                Ok(Some(count)) => read.extend(&buffer[..count]),
                // The terminal is gone.
                Ok(None) | Err(_) => return,
            }
        }
    }

    /// Writes all bytes, unless `attention` becomes readable while the terminal takes nothing.
    pub(in crate::tui) fn write(
        &self,
        bytes: &[u8],
        attention: BorrowedFd<'_>,
    ) -> io::Result<WriteOutcome> {
        let wait = || {
            let mut fds = [
                PollFd::new(&self.output, PollFlags::OUT),
                PollFd::from_borrowed_fd(attention, PollFlags::IN),
            ];
            match poll(&mut fds, None) {
                Ok(_) | Err(Errno::INTR) => Ok(fds[1].revents().is_empty()),
                Err(error) => Err(error),
            }
        };
        self.write_waiting(bytes, wait)
    }

    /// Writes the last bytes of the program; gives up if the terminal takes none within `LAST_WRITE`.
    pub(in crate::tui) fn write_last(&self, bytes: &[u8]) -> io::Result<WriteOutcome> {
        let wait = || {
            let mut fds = [PollFd::new(&self.output, PollFlags::OUT)];
            poll(&mut fds, Some(&LAST_WRITE)).map(|ready| ready > 0)
        };
        self.write_waiting(bytes, wait)
    }

    /// Writes bytes; while the terminal takes none, calls `wait`, and stops if it returns false.
    fn write_waiting(
        &self,
        bytes: &[u8],
        wait: impl Fn() -> Result<bool, Errno>,
    ) -> io::Result<WriteOutcome> {
        let mut rest = bytes;
        while !rest.is_empty() {
            match write(&self.output, rest) {
                Ok(count) => rest = &rest[count..],
                Err(Errno::INTR) => {}
                Err(Errno::AGAIN) => {
                    if !wait()? {
                        return Ok(WriteOutcome::Interrupted);
                    }
                }
                Err(error) => return Err(error.into()),
            }
        }
        Ok(WriteOutcome::All)
    }

    /// Returns columns and rows; a side that the terminal does not know is taken from `fallback`.
    pub(in crate::tui) fn size(&self, fallback: (u16, u16)) -> (u16, u16) {
        let known = tcgetwinsize(&self.output).map_or((0, 0), |size| (size.ws_col, size.ws_row));
        let side = |known: u16, otherwise: u16, most: u16| {
            if known == 0 { otherwise } else { known }.clamp(1, most)
        };
        (
            side(known.0, fallback.0, LARGEST.0),
            side(known.1, fallback.1, LARGEST.1),
        )
    }

    pub(in crate::tui) fn try_clone(&self) -> io::Result<Self> {
        Ok(Self {
            input: self.input.try_clone()?,
            output: self.output.try_clone()?,
        })
    }
}

fn controlling(access: OFlags) -> io::Result<OwnedFd> {
    let none = "there is no terminal here; 'taxel figure' and the other commands work without one, \
                and 'taxel script' drives the screen without one";
    open("/dev/tty", access | OFlags::CLOEXEC, Mode::empty()).map_err(|_| io::Error::other(none))
}
