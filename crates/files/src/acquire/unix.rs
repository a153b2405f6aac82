//! What only Unix has: sources that are waited for by their descriptors, serial lines, named pipes, connections that are
//! kept alive. Another system needs the same functions.

use std::fs::{File, FileType};
use std::io::{self, ErrorKind, Read};
use std::net::TcpStream;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::fs::FileTypeExt;
use std::path::Path;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FlockOperation, Mode, OFlags, flock, open};
use rustix::io::Errno;
use rustix::net::sockopt;
use rustix::termios::{
    ControlModes, OptionalActions, QueueSelector, ioctl_tiocexcl, tcflush, tcgetattr, tcsetattr,
};

/// The silence of a connection after which the system probes its other end; below, the time that an answer may take,
/// and the number of answers that may be missing.
const SILENT: Duration = Duration::from_secs(15);
const BETWEEN_PROBES: Duration = Duration::from_secs(5);
const PROBES: u32 = 3;

/// Reads the bytes of a device that are there, waiting for them no longer than this. None if there are none yet, 0 at
/// the end.
pub(super) fn read(
    device: &mut File,
    bytes: &mut [u8],
    wait: Duration,
) -> io::Result<Option<usize>> {
    let mut fds = [PollFd::new(device, PollFlags::IN)];
    let wait = Timespec {
        tv_sec: 0,
        tv_nsec: wait.subsec_nanos().into(),
    };
    match poll(&mut fds, Some(&wait)) {
        Ok(0) | Err(Errno::INTR) => return Ok(None),
        Ok(_) => {}
        Err(error) => return Err(error.into()),
    }
    match device.read(bytes) {
        Ok(count) => Ok(Some(count)),
        Err(error) => match error.kind() {
            ErrorKind::Interrupted | ErrorKind::WouldBlock => Ok(None),
            _ => Err(error),
        },
    }
}

/// Whether a device of this kind is read as a serial line.
pub(super) fn is_serial(kind: FileType) -> bool {
    kind.is_char_device()
}

/// Whether this is a named pipe.
pub(super) fn is_fifo(kind: FileType) -> bool {
    kind.is_fifo()
}

/// Standard input as a file. It is not read through the buffer of the standard library: `poll` would not see the bytes
/// in it.
pub(super) fn standard_input() -> io::Result<File> {
    io::stdin().as_fd().try_clone_to_owned().map(File::from)
}

/// Opens a named pipe. Opening it in the usual way would wait for a writer, and no signal could end the wait. Of two
/// readers, each would get some of the bytes, so the pipe is locked for this one.
pub(super) fn open_fifo(path: &Path) -> io::Result<File> {
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let pipe = open(path, flags, Mode::empty())?;
    lock(&pipe)?;
    Ok(pipe.into())
}

/// Opens a line at a speed in bits per second. Many boards restart when a line is opened; bytes that they sent before
/// are discarded.
pub(super) fn open_line(path: &Path, baud: u32) -> io::Result<File> {
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let line: OwnedFd = match open(path, flags, Mode::empty()) {
        Err(Errno::BUSY) => return Err(busy()),
        opened => opened?,
    };
    lock(&line)?;
    let mut settings = match tcgetattr(&line) {
        // Devices that do not know this request report one or the other.
        Err(Errno::NOTTY | Errno::INVAL) => {
            let reason = "it is not a serial line; 'taxel watch -' reads it from standard input";
            return Err(io::Error::new(ErrorKind::InvalidInput, reason));
        }
        settings => settings?,
    };
    settings.make_raw();
    settings.control_modes |= ControlModes::CREAD | ControlModes::CLOCAL;
    settings.set_speed(baud)?;
    tcsetattr(&line, OptionalActions::Now, &settings)?;
    // A pseudo-terminal has no such mode.
    let _ = ioctl_tiocexcl(&line);
    tcflush(&line, QueueSelector::IFlush)?;
    Ok(File::from(line))
}

/// Lets the system probe the other end when nothing comes. Nothing is ever sent to a sensor, so without probes nobody
/// would notice that it has lost power. Without an answer, reading fails after half a minute.
pub(super) fn keep_alive(stream: &TcpStream) -> io::Result<()> {
    sockopt::set_socket_keepalive(stream, true)?;
    sockopt::set_tcp_keepidle(stream, SILENT)?;
    sockopt::set_tcp_keepintvl(stream, BETWEEN_PROBES)?;
    sockopt::set_tcp_keepcnt(stream, PROBES)?;
    Ok(())
}

fn busy() -> io::Error {
    io::Error::new(ErrorKind::ResourceBusy, "another program has it open")
}

/// Locks a line or a pipe until it is closed. Not every system locks devices: then two programs may read them.
fn lock(file: &OwnedFd) -> io::Result<()> {
    match flock(file, FlockOperation::NonBlockingLockExclusive) {
        Err(Errno::WOULDBLOCK) => Err(busy()),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::process::Command;

    use super::*;

    #[test]
    fn a_pipe_without_a_writer_is_waited_for_a_moment_at_a_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("pipe");
        let made = Command::new("mkfifo").arg(&path).status();
        assert!(made.expect("mkfifo starts").success());
        let mut input = open_fifo(&path).expect("opened");
        let mut bytes = [0; 8];
        let mut found = || {
            let moment = Duration::from_millis(1);
            read(&mut input, &mut bytes, moment).expect("read")
        };
        assert_eq!(found(), None);
        let mut writer = File::options().write(true).open(&path).expect("opened");
        assert_eq!(found(), None);
        writer.write_all(b"1 2").expect("written");
        assert_eq!(found(), Some(3));
        let second = open_fifo(&path).expect_err("it is read already");
        assert_eq!(second.kind(), ErrorKind::ResourceBusy);
        drop(writer);
        assert_eq!(found(), Some(0));
        drop(input);
        assert!(open_fifo(&path).is_ok());
    }
}
