//! The terminal's two files: standard input and output if these are terminals, otherwise the controlling terminal.
//!
//! Reading never blocks. Writing waits while the terminal takes nothing, but a signal or, at the end of the program, a
//! time limit ends the wait: a line that hangs must not keep the program from ending.

use std::io::{self, stdin, stdout};
use std::os::fd::{AsFd, AsRawFd, BorrowedFd, OwnedFd};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, open};
use rustix::io::{Errno, read, write};
use rustix::termios::{isatty, tcgetwinsize};

/// The last write of the program is given up after this time if the terminal does not take it.
const LAST_WRITE: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 100_000_000,
};

/// Larger sizes are mistakes, which would cost gigabytes.
const LARGEST: (u16, u16) = (1000, 500);

/// Where bytes come from and go to.
#[derive(Debug)]
pub(in crate::tui) struct Device {
    /// Where keys come from.
    input: OwnedFd,
    /// Where the screen goes.
    output: OwnedFd,
}

/// What became of a write.
#[derive(Debug, PartialEq, Eq)]
pub(in crate::tui) enum WriteOutcome {
    /// All is out.
    All,
    /// Something else wants attention, and an unknown part is out.
    Interrupted,
}

impl Device {
    /// Opens it.
    ///
    /// The output is opened anew without blocking, so that a line that takes nothing cannot keep the program from
    /// its end. Where that is not allowed, as after `su`, the file is used as it is.
    ///
    /// # Errors
    /// Where there is no terminal.
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

    /// Where keys come from.
    pub(in crate::tui) fn input(&self) -> BorrowedFd<'_> {
        self.input.as_fd()
    }

    /// Reads what is there; none where the terminal is gone.
    pub(in crate::tui) fn read(&self, buffer: &mut [u8]) -> io::Result<Option<usize>> {
        match read(&self.input, buffer) {
            Ok(0) => Ok(None),
            Ok(count) => Ok(Some(count)),
            Err(Errno::AGAIN | Errno::INTR) => Ok(Some(0)),
            Err(error) => Err(error.into()),
        }
    }

    /// Reads up to these bytes and drops what it reads; for a while at most, if they do not come.
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

    /// Writes all of it, unless `attention` becomes readable while the terminal takes nothing.
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

    /// The same for last words, which a terminal that takes nothing does not get.
    pub(in crate::tui) fn write_last(&self, bytes: &[u8]) -> io::Result<WriteOutcome> {
        let wait = || {
            let mut fds = [PollFd::new(&self.output, PollFlags::OUT)];
            poll(&mut fds, Some(&LAST_WRITE)).map(|ready| ready > 0)
        };
        self.write_waiting(bytes, wait)
    }

    /// Writes bytes; waits while the terminal takes none, as long as `wait` allows.
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

    /// Columns and rows; `fallback` for a side that the terminal does not know.
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

    /// A second pair of names for the same files.
    pub(in crate::tui) fn try_clone(&self) -> io::Result<Self> {
        Ok(Self {
            input: self.input.try_clone()?,
            output: self.output.try_clone()?,
        })
    }
}

/// Opens the controlling terminal.
fn controlling(access: OFlags) -> io::Result<OwnedFd> {
    let none = "there is no terminal here; 'taxel figure' and the other commands need none, \
                'taxel script' drives the screen without one";
    open("/dev/tty", access | OFlags::CLOEXEC, Mode::empty()).map_err(|_| io::Error::other(none))
}
