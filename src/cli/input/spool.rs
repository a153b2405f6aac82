//! Makes standard input or a pipe readable again: everything that is read is also copied to a temporary file.
//!
//! Nothing is read ahead, so an endless input is refused as soon as something in it is wrong.

use std::fmt;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::os::unix::fs::FileExt;

use crate::formats::file::system_reason;

/// The most that is copied, in bytes, so that an endless input does not fill the disk.
const MOST: u64 = 4 << 30;

pub(crate) struct SpooledInput {
    /// The input that has not been read yet; None at its end.
    rest: Option<Box<dyn Read>>,
    copy: File,
    /// The length of the copy, in bytes.
    length: u64,
    /// The position at which reading continues, in bytes.
    place: u64,
    /// The most that is copied, in bytes.
    most: u64,
}

impl SpooledInput {
    pub(crate) fn new(input: impl Read + 'static) -> io::Result<Self> {
        Ok(Self {
            rest: Some(Box::new(input)),
            copy: tempfile::tempfile().map_err(|error| not_copied(&error))?,
            length: 0,
            place: 0,
            most: MOST,
        })
    }

    fn advance(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let Some(rest) = &mut self.rest else {
            return Ok(0);
        };
        let count = rest.read(bytes)?;
        if count == 0 && !bytes.is_empty() {
            self.rest = None;
        }
        let copied = self.copy.write_all_at(&bytes[..count], self.length);
        copied.map_err(|error| not_copied(&error))?;
        self.length += count as u64;
        if self.length > self.most {
            return Err(io::Error::other(
                "more than 4 GiB; save it to a file and read that, or use taxel watch for endless input",
            ));
        }
        Ok(count)
    }
}

fn not_copied(error: &io::Error) -> io::Error {
    let folder = std::env::temp_dir();
    let text = format!(
        "cannot keep a copy in {} (TMPDIR): {}",
        folder.display(),
        system_reason(error)
    );
    io::Error::new(error.kind(), text)
}

impl fmt::Debug for SpooledInput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SpooledInput")
            .field("length", &self.length)
            .field("place", &self.place)
            .finish_non_exhaustive()
    }
}

impl Read for SpooledInput {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = if self.place < self.length {
            self.copy.read_at(bytes, self.place)?
        } else {
            self.advance(bytes)?
        };
        self.place += count as u64;
        Ok(count)
    }
}

impl Seek for SpooledInput {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let present = self.place;
        let place = |length: u64| match to {
            SeekFrom::Start(place) => Some(place),
            SeekFrom::Current(by) => present.checked_add_signed(by),
            SeekFrom::End(by) => length.checked_add_signed(by),
        };
        let mut wanted = place(self.length);
        let mut bytes = vec![0; 1 << 16];
        while self.rest.is_some()
            && (matches!(to, SeekFrom::End(_)) || wanted.is_some_and(|to| to > self.length))
        {
            self.advance(&mut bytes)?;
            wanted = place(self.length);
        }
        self.place = wanted.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Input that comes in pieces can be read again from any place, and no more is read than requested.
    #[test]
    fn input_can_be_read_again() {
        let input = (&b"abc"[..]).chain(&b"defg"[..]).chain(&b"hij"[..]);
        let mut input = SpooledInput::new(input).expect("a file");
        let mut read = |to: SeekFrom, count: usize| {
            let place = input.seek(to).expect("sought");
            let mut bytes = vec![0; count];
            input.read_exact(&mut bytes).expect("read");
            (place, String::from_utf8(bytes).expect("text"), input.length)
        };
        let start = SeekFrom::Start(0);
        assert_eq!(read(start, 2), (0, "ab".to_owned(), 2));
        assert_eq!(read(start, 4), (0, "abcd".to_owned(), 4));
        assert_eq!(read(SeekFrom::Current(-1), 2), (3, "de".to_owned(), 5));
        assert_eq!(read(SeekFrom::Start(8), 1), (8, "i".to_owned(), 10));
        assert_eq!(read(SeekFrom::End(-3), 3), (7, "hij".to_owned(), 10));
    }

    #[test]
    fn an_endless_input_is_refused() {
        let mut input = SpooledInput::new(io::repeat(b'1')).expect("a file");
        input.most = 1 << 20;
        let read = io::copy(&mut input, &mut io::sink());
        assert!(read.is_err_and(|error| error.to_string().contains("more than 4 GiB")));
    }
}
