//! Reads the bytes of a source without waiting longer than a moment.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::net::TcpStream;
use std::ops::ControlFlow;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FlockOperation, Mode, OFlags, flock, open};
use rustix::io::Errno;
use rustix::net::sockopt;
use rustix::termios::{
    ControlModes, OptionalActions, QueueSelector, ioctl_tiocexcl, tcflush, tcgetattr, tcsetattr,
};

use crate::acquire::clocks::TICK;
use crate::acquire::event::{AcquireOptions, Playback};
use crate::acquire::followed_file::{self, GrowingFile, Growth, ReadAnew};
use crate::acquire::source::{FrameSource, check_address};

/// The number of times that a pipe that is still open is tried again before it counts as another program's.
const RELEASES: u32 = 5;

/// The time that making a connection may take.
const CONNECTING: Duration = Duration::from_secs(5);

/// The silence of a connection after which the system probes its other end; below, the time that an answer may take,
/// and the number of answers that may be missing.
const SILENT: Duration = Duration::from_secs(15);
const BETWEEN_PROBES: Duration = Duration::from_secs(5);
const PROBES: u32 = 3;

/// The outcome of a read.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum ReadOutcome {
    /// The number of bytes that were read; 0 if none have come yet.
    Bytes(usize),
    /// No bytes yet: the next ones are from the start of a file again.
    Anew(ReadAnew),
    /// The end of the source.
    End,
}

/// An open source of bytes.
#[derive(Debug)]
pub(super) enum ByteInput {
    Standard(io::Stdin),
    Tcp(TcpStream),
    /// A serial line or a pipe.
    Device(File),
    /// A file that is read to its end.
    File(File),
    /// A file at whose end reading waits for more: always, or as long as the file may grow.
    Growing(GrowingFile, Option<Growth>),
}

impl ByteInput {
    /// Opens a source. With [`Playback::Once`], a file is read only to its end; if a format is given, reading always
    /// waits for more. While opening takes long, `waiting` is called ten times a second; returns None if it breaks.
    pub(super) fn open(
        source: &FrameSource,
        options: &AcquireOptions,
        waiting: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> io::Result<Option<Self>> {
        Ok(Some(match source {
            FrameSource::Standard => Self::Standard(io::stdin()),
            FrameSource::Tcp(address) => match connect_unless(address, waiting)? {
                Some(stream) => Self::Tcp(stream),
                None => return Ok(None),
            },
            FrameSource::Serial(path) => Self::Device(open_line(path, options.baud)?),
            FrameSource::Fifo(path) => match open_fifo_unless(path, waiting)? {
                Some(pipe) => Self::Device(pipe),
                None => return Ok(None),
            },
            FrameSource::File(path) if options.playback == Playback::Once => {
                Self::File(File::open(path)?)
            }
            FrameSource::File(path) => {
                let (file, growth) = followed_file::of(path, File::open(path)?)?;
                Self::Growing(file, options.format.is_none().then_some(growth))
            }
        }))
    }

    /// The descriptor to wait for; None if bytes are read at once.
    fn fd(&self) -> Option<BorrowedFd<'_>> {
        match self {
            Self::Standard(input) => Some(input.as_fd()),
            Self::Tcp(stream) => Some(stream.as_fd()),
            Self::Device(file) => Some(file.as_fd()),
            Self::File(_) | Self::Growing(..) => None,
        }
    }

    /// Reads the bytes that are there; waits a moment if there are none.
    pub(super) fn read(&mut self, bytes: &mut [u8]) -> io::Result<ReadOutcome> {
        if let Some(fd) = self.fd() {
            let mut fds = [PollFd::from_borrowed_fd(fd, PollFlags::IN)];
            let moment = Timespec {
                tv_sec: 0,
                tv_nsec: TICK.subsec_nanos().into(),
            };
            match poll(&mut fds, Some(&moment)) {
                Ok(0) | Err(Errno::INTR) => return Ok(ReadOutcome::Bytes(0)),
                Ok(_) => {}
                Err(error) => return Err(error.into()),
            }
        }
        let read = match self {
            // Not through the buffer of the standard library: `poll` would not see the bytes in it.
            Self::Standard(input) => rustix::io::read(&*input, bytes).map_err(io::Error::from),
            Self::Tcp(stream) => stream.read(bytes),
            Self::Device(file) | Self::File(file) => file.read(bytes),
            Self::Growing(file, growth) => {
                if let Some(anew) = file.anew()? {
                    *growth = None;
                    return Ok(ReadOutcome::Anew(anew));
                }
                let count = file.read(bytes)?;
                if count == 0 && growth.as_ref().is_some_and(|growth| !growth.may_go_on()) {
                    return Ok(ReadOutcome::End);
                }
                return Ok(ReadOutcome::Bytes(count));
            }
        };
        match read {
            Ok(0) => Ok(ReadOutcome::End),
            Ok(count) => Ok(ReadOutcome::Bytes(count)),
            Err(error) => match error.kind() {
                ErrorKind::Interrupted | ErrorKind::WouldBlock => Ok(ReadOutcome::Bytes(0)),
                _ => Err(error),
            },
        }
    }
}

/// Opens a named pipe. A watch that has just ended may still have it open.
fn open_fifo_unless(
    path: &Path,
    waiting: &mut dyn FnMut() -> ControlFlow<()>,
) -> io::Result<Option<File>> {
    for _ in 0..RELEASES {
        match open_fifo(path) {
            Err(error) if error.kind() == ErrorKind::ResourceBusy => {}
            opened => return opened.map(Some),
        }
        if waiting().is_break() {
            return Ok(None);
        }
        std::thread::sleep(TICK);
    }
    open_fifo(path).map(Some)
}

/// Opens a named pipe. Opening it in the usual way would wait for a writer, and no signal could end the wait. Of two
/// readers, each would get some of the bytes, so the pipe is locked for this one.
fn open_fifo(path: &Path) -> io::Result<File> {
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let pipe = open(path, flags, Mode::empty())?;
    lock(&pipe)?;
    Ok(pipe.into())
}

/// Connects on a separate thread. The thread is abandoned if the connection is no longer wanted, because looking up the
/// addresses of a name and waiting for an answer cannot be interrupted.
fn connect_unless(
    address: &str,
    waiting: &mut dyn FnMut() -> ControlFlow<()>,
) -> io::Result<Option<TcpStream>> {
    let (send, connected) = channel();
    let own = address.to_owned();
    let body = move || send.send(connect(&own));
    if std::thread::Builder::new().spawn(body).is_err() {
        return connect(address).map(Some);
    }
    loop {
        match connected.recv_timeout(TICK) {
            Ok(stream) => return stream.map(Some),
            Err(RecvTimeoutError::Timeout) if waiting().is_break() => return Ok(None),
            Err(RecvTimeoutError::Timeout) => {}
            // The thread does not panic.
            Err(RecvTimeoutError::Disconnected) => return Err(ErrorKind::NotConnected.into()),
        }
    }
}

fn connect(address: &str) -> io::Result<TcpStream> {
    use std::net::ToSocketAddrs;
    check_address(address)?;
    let mut failure = io::Error::new(ErrorKind::NotFound, "no such host");
    for address in address.to_socket_addrs()? {
        let connected = TcpStream::connect_timeout(&address, CONNECTING);
        match connected.and_then(|stream| kept_alive(&stream).map(|()| stream)) {
            Ok(stream) => return Ok(stream),
            Err(error) => failure = error,
        }
    }
    Err(failure)
}

/// Lets the system probe the other end when nothing comes. Nothing is ever sent to a sensor, so without probes nobody
/// would notice that it has lost power. Without an answer, reading fails after half a minute, and the connection is
/// made again.
fn kept_alive(stream: &TcpStream) -> io::Result<()> {
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
pub(super) fn lock(file: &OwnedFd) -> io::Result<()> {
    match flock(file, FlockOperation::NonBlockingLockExclusive) {
        Err(Errno::WOULDBLOCK) => Err(busy()),
        _ => Ok(()),
    }
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

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::process::Command;

    use super::*;

    #[test]
    fn a_connection_that_is_not_made_is_waited_for_a_moment_at_a_time() {
        // A full queue of connections: the next one gets no answer.
        let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("bound");
        let address = listener.local_addr().expect("an address");
        rustix::net::listen(&listener, 0).expect("shortened");
        let mut queue = Vec::new();
        while let Ok(stream) = TcpStream::connect_timeout(&address, TICK) {
            queue.push(stream);
        }
        let begun = std::time::Instant::now();
        let source = FrameSource::Tcp(address.to_string());
        let waiting = &mut || ControlFlow::Break(());
        let opened = ByteInput::open(&source, &AcquireOptions::default(), waiting);
        let opened = opened.expect("no error");
        assert!(opened.is_none() && begun.elapsed() < CONNECTING);
    }

    #[test]
    fn a_pipe_without_a_writer_is_waited_for_a_moment_at_a_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("pipe");
        let made = Command::new("mkfifo").arg(&path).status();
        assert!(made.expect("mkfifo starts").success());
        let source = FrameSource::new(path.as_os_str());
        let waiting = &mut || ControlFlow::Continue(());
        let input = ByteInput::open(&source, &AcquireOptions::default(), waiting);
        let mut input = input.expect("opened").expect("wanted");
        let mut bytes = [0; 8];
        let mut read = || input.read(&mut bytes).expect("read");
        assert_eq!(read(), ReadOutcome::Bytes(0));
        let mut writer = File::options().write(true).open(&path).expect("opened");
        assert_eq!(read(), ReadOutcome::Bytes(0));
        writer.write_all(b"1 2").expect("written");
        assert_eq!(read(), ReadOutcome::Bytes(3));
        let second = open_fifo(&path).expect_err("it is read already");
        assert_eq!(second.kind(), ErrorKind::ResourceBusy);
        drop(writer);
        assert_eq!(read(), ReadOutcome::End);
        drop(input);
        assert!(open_fifo(&path).is_ok());
    }
}
