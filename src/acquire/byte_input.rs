//! Bytes of a source, read without waiting longer than a moment.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::net::TcpStream;
use std::os::fd::{AsFd, BorrowedFd};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use crate::acquire::growing_file::{GrowingFile, ReadAnew};
use crate::acquire::serial;
use crate::acquire::source::{FrameSource, check_address};

/// How long a read waits for bytes.
const MOMENT: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 100_000_000,
};

/// How long a connection may take.
const CONNECTING: Duration = Duration::from_secs(5);

/// What a read has brought.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum ReadOutcome {
    /// How many bytes were read; 0 if none have come yet.
    Bytes(usize),
    /// Nothing yet: what comes now is from the start of a file again.
    Anew(ReadAnew),
    /// The end.
    End,
}

/// An open source of bytes.
#[derive(Debug)]
pub(super) enum ByteInput {
    Standard(io::Stdin),
    Tcp(TcpStream),
    /// A serial line or a pipe.
    Device(File),
    /// A file, to its end.
    File(File),
    /// A file that is waited for when it ends.
    Growing(GrowingFile),
}

impl ByteInput {
    /// Opens a source; a file is read to its end only, if asked for.
    ///
    /// # Errors
    /// What the system reports.
    pub(super) fn open(source: &FrameSource, baud: u32, once: bool) -> io::Result<Self> {
        Ok(match source {
            FrameSource::Standard => Self::Standard(io::stdin()),
            FrameSource::Tcp(address) => Self::Tcp(connect(address)?),
            FrameSource::Serial(path) => Self::Device(serial::open_line(path, baud)?),
            FrameSource::Fifo(path) => Self::Device(File::open(path)?),
            FrameSource::File(path) if once => Self::File(File::open(path)?),
            FrameSource::File(path) => Self::Growing(GrowingFile::open(path)?),
        })
    }

    /// What is waited for; none where bytes are read at once.
    fn fd(&self) -> Option<BorrowedFd<'_>> {
        match self {
            Self::Standard(input) => Some(input.as_fd()),
            Self::Tcp(stream) => Some(stream.as_fd()),
            Self::Device(file) => Some(file.as_fd()),
            Self::File(_) | Self::Growing(_) => None,
        }
    }

    /// Reads what is there; waits a moment where there is nothing.
    ///
    /// # Errors
    /// What the system reports.
    pub(super) fn read(&mut self, bytes: &mut [u8]) -> io::Result<ReadOutcome> {
        if let Some(fd) = self.fd() {
            let mut fds = [PollFd::from_borrowed_fd(fd, PollFlags::IN)];
            match poll(&mut fds, Some(&MOMENT)) {
                Ok(0) | Err(rustix::io::Errno::INTR) => return Ok(ReadOutcome::Bytes(0)),
                Ok(_) => {}
                Err(error) => return Err(error.into()),
            }
        }
        let read = match self {
            // Not through the buffer of the standard library, which would be polled past.
            Self::Standard(input) => rustix::io::read(&*input, bytes).map_err(io::Error::from),
            Self::Tcp(stream) => stream.read(bytes),
            Self::Device(file) | Self::File(file) => file.read(bytes),
            Self::Growing(file) => {
                if let Some(anew) = file.anew()? {
                    return Ok(ReadOutcome::Anew(anew));
                }
                return file.read(bytes).map(ReadOutcome::Bytes);
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

fn connect(address: &str) -> io::Result<TcpStream> {
    use std::net::ToSocketAddrs;
    check_address(address)?;
    let mut failure = io::Error::new(ErrorKind::NotFound, "no such host");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECTING) {
            Ok(stream) => return Ok(stream),
            Err(error) => failure = error,
        }
    }
    Err(failure)
}
