//! An open source as an input that waits: reading it takes as long as bytes need to come. Meanwhile the session ticks.

use std::cell::RefCell;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read};
use std::net::{TcpStream, ToSocketAddrs};
use std::os::fd::OwnedFd;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use crate::acquire::clock::TICK;
use crate::acquire::event::AcquireOptions;
use crate::acquire::session::Session;
use crate::acquire::source::{FrameSource, check_address};
use crate::acquire::unix;

const CHUNK: usize = 1 << 16;

/// The time that making a connection may take.
const CONNECTING: Duration = Duration::from_secs(5);

/// The pause at the end of a file before it is checked for growth again.
const GROWTH: Duration = Duration::from_millis(50);

/// An open source.
pub(super) enum OpenSource {
    /// What is waited for by its descriptor.
    Device(File),
    /// A file, and the number of bytes that were read of it.
    File { file: File, offset: u64 },
}

/// The reason why an input has ended.
#[derive(Debug)]
pub(super) enum InputEnd {
    /// It is complete, or the other end has closed it.
    Closed,
    /// No more is wanted.
    Stopped,
    Lost(io::Error),
}

impl OpenSource {
    /// Opens a source. None if no more is wanted before it is open.
    pub(super) fn open(
        source: &FrameSource,
        session: &mut Session<'_, '_>,
    ) -> io::Result<Option<Self>> {
        let device = match source {
            FrameSource::Standard => unix::standard_input()?,
            FrameSource::Tcp(address) => match connect_unless_stopped(address, session)? {
                Some(stream) => OwnedFd::from(stream).into(),
                None => return Ok(None),
            },
            FrameSource::Serial(path) => {
                let baud = session.options.baud.unwrap_or(AcquireOptions::BAUD);
                unix::open_line(path, baud)?
            }
            FrameSource::Fifo(path) => unix::open_fifo(path)?,
            FrameSource::File(path) => return Ok(Some(Self::file(File::open(path)?))),
        };
        Ok(Some(Self::Device(device)))
    }

    pub(super) fn file(file: File) -> Self {
        Self::File { file, offset: 0 }
    }
}

/// A source that is read as it comes; see the module.
pub(super) struct WaitingInput<'s, 'a, 'b> {
    source: OpenSource,
    session: &'s RefCell<Session<'a, 'b>>,
    /// Why it has ended; None if it was not read to its end.
    pub(super) end: Option<InputEnd>,
}

impl<'s, 'a, 'b> WaitingInput<'s, 'a, 'b> {
    pub(super) fn new(
        source: OpenSource,
        session: &'s RefCell<Session<'a, 'b>>,
    ) -> BufReader<Self> {
        let end = None;
        let input = Self {
            source,
            session,
            end,
        };
        BufReader::with_capacity(CHUNK, input)
    }

    /// Waits for bytes. Returns their number, or why no more come.
    fn wait(&mut self, bytes: &mut [u8]) -> Result<usize, InputEnd> {
        loop {
            let mut session = self.session.borrow_mut();
            if session.tick().is_break() {
                return Err(InputEnd::Stopped);
            }
            let count = match &mut self.source {
                OpenSource::Device(device) => match unix::read(device, bytes, TICK) {
                    Ok(Some(0)) => return Err(InputEnd::Closed),
                    Ok(count) => count.unwrap_or(0),
                    Err(error) => return Err(InputEnd::Lost(error)),
                },
                OpenSource::File { file, offset } => {
                    let count = match file.read(bytes) {
                        // Without bytes, a read that a signal interrupted would count as the end of the file.
                        Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                        read => read.map_err(InputEnd::Lost)?,
                    };
                    *offset += count as u64;
                    if count == 0 {
                        if file.metadata().map_err(InputEnd::Lost)?.len() < *offset {
                            let cut = io::Error::other("it was truncated meanwhile");
                            return Err(InputEnd::Lost(cut));
                        }
                        if !session.may_go_on() {
                            return Err(InputEnd::Closed);
                        }
                        drop(session);
                        std::thread::sleep(GROWTH);
                        continue;
                    }
                    count
                }
            };
            if count > 0 {
                session.counts.bytes += count as u64;
                return Ok(count);
            }
        }
    }
}

impl Read for WaitingInput<'_, '_, '_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.end.is_none() {
            match self.wait(bytes) {
                Ok(count) => return Ok(count),
                Err(end) => self.end = Some(end),
            }
        }
        match self.end {
            // What was sent may have been cut off anywhere, but a file ends where it ends.
            Some(InputEnd::Closed) if self.session.borrow().is_read_to_its_end() => Ok(0),
            _ => Err(ErrorKind::UnexpectedEof.into()),
        }
    }
}

/// Connects on a thread of its own. The thread is abandoned if the connection is no longer wanted, because looking up
/// the addresses of a name and waiting for an answer cannot be interrupted.
fn connect_unless_stopped(
    address: &str,
    session: &mut Session<'_, '_>,
) -> io::Result<Option<TcpStream>> {
    let (send, connected) = channel();
    let own = address.to_owned();
    std::thread::Builder::new().spawn(move || send.send(connect(&own)))?;
    loop {
        match connected.recv_timeout(TICK) {
            Ok(stream) => return stream.map(Some),
            Err(RecvTimeoutError::Timeout) if session.beat().is_break() => return Ok(None),
            Err(RecvTimeoutError::Timeout) => {}
            // The thread does not panic.
            Err(RecvTimeoutError::Disconnected) => return Err(ErrorKind::NotConnected.into()),
        }
    }
}

fn connect(address: &str) -> io::Result<TcpStream> {
    check_address(address)?;
    let mut failure = io::Error::new(ErrorKind::NotFound, "no such host");
    for address in address.to_socket_addrs()? {
        let connected = TcpStream::connect_timeout(&address, CONNECTING);
        match connected.and_then(|stream| unix::keep_alive(&stream).map(|()| stream)) {
            Ok(stream) => return Ok(stream),
            Err(error) => failure = error,
        }
    }
    Err(failure)
}
