//! A serial line: raw bytes at any speed, for this program alone.

use std::fs::File;
use std::io;
use std::os::fd::OwnedFd;
use std::path::Path;

use rustix::fs::{FlockOperation, Mode, OFlags, flock, open};
use rustix::io::Errno;
use rustix::termios::{
    ControlModes, OptionalActions, QueueSelector, ioctl_tiocexcl, tcflush, tcgetattr, tcsetattr,
};

/// Returns the error for a source that must not have two readers.
fn busy() -> io::Error {
    io::Error::new(io::ErrorKind::ResourceBusy, "another program has it open")
}

/// Locks a line or a pipe until it is closed. Not every system locks devices: then two programs may read them.
///
/// # Errors
/// Returns an error of the kind [`io::ErrorKind::ResourceBusy`] if another program has locked it.
pub(super) fn lock(file: &OwnedFd) -> io::Result<()> {
    match flock(file, FlockOperation::NonBlockingLockExclusive) {
        Err(Errno::WOULDBLOCK) => Err(busy()),
        _ => Ok(()),
    }
}

/// Opens a line at a speed in bits per second. Many boards restart when a line is opened; bytes that they sent before
/// are discarded.
///
/// # Errors
/// Returns an error of the kind [`io::ErrorKind::ResourceBusy`] if another program has it open, or of the kind
/// [`io::ErrorKind::InvalidInput`] if it is another kind of device, which trying again does not change; otherwise the
/// system's error.
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
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
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
