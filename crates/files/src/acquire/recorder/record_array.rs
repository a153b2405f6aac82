//! A growing array of records: a file that numpy and taxel can open at any moment, even after the program was killed.
//!
//! A record has a time in seconds (NaN if it is unknown), a number, and values. The header has spare room and states
//! the number of records in the file. The records are written first and their number after them, at least twice a
//! second, so a killed program loses less than half a second. A thread syncs the file each second, so a power cut loses
//! hardly more. A power cut may leave a number that is too large; then taxel reads the complete records, and numpy
//! refuses the file. Values are f64, as every format of frames is read: nothing is rounded.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::time::{Duration, Instant};

use crate::acquire::recorder::syncer::Syncer;
use crate::formats::npy::{BEFORE_TEXT, header_of};
use crate::frame::{Frame, FrameSize, LARGEST_VALUE};
use crate::index::index;

/// The beginning of the header's text, before the rows and columns of a frame.
const DESCRIPTION: &str = "{'descr': [('time', '<f8'), ('number', '<u8'), ('values', '<f8', (";

/// The number of bytes before the first record. The longest text of a header has about 150.
pub(super) const HEADER: u64 = 256;

/// The number of bytes of time and number before the values of a record.
const RECORD_HEAD: u64 = 16;

/// The time after which records are written out at the latest.
const WRITTEN_OUT: Duration = Duration::from_millis(400);

/// The number of waiting bytes at which records are written out at once.
const BUFFER: usize = 1 << 18;

/// An array in a file, and the records that wait to be written into it.
#[derive(Debug)]
pub(super) struct RecordArray {
    file: File,
    /// The size of the frames; None before the first one.
    size: Option<FrameSize>,
    buffer: Vec<u8>,
    /// The number of records in the file and in the buffer.
    records: u64,
    /// The number of records in the file.
    in_file: u64,
    written: Instant,
    syncer: Syncer,
}

impl RecordArray {
    /// Creates an array without records, in a file that holds [`empty`].
    pub(super) fn new(file: File) -> Self {
        Self {
            size: None,
            buffer: Vec::new(),
            records: 0,
            in_file: 0,
            written: Instant::now(),
            syncer: Syncer::new(&file),
            file,
        }
    }

    /// Continues in another file with the same content.
    pub(super) fn move_to(&mut self, file: File) {
        self.syncer = Syncer::new(&file);
        self.file = file;
    }

    /// Returns the size of the frames; None before the first one.
    pub(super) fn size(&self) -> Option<FrameSize> {
        self.size
    }

    /// Notes the size of the first frame, which all frames have.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(super) fn begin(&mut self, size: FrameSize) -> io::Result<()> {
        self.size = Some(size);
        self.count()
    }

    /// Returns the number of records.
    pub(super) fn records(&self) -> u64 {
        self.records
    }

    /// Returns true if no record waits to be written out.
    pub(super) fn is_written_out(&self) -> bool {
        self.buffer.is_empty()
    }

    /// Drops the records that wait to be written out.
    pub(super) fn give_up(&mut self) {
        self.buffer.clear();
    }

    /// Adds a frame of the size of all frames, with its time in seconds.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(super) fn add(&mut self, frame: &Frame, time: Option<f64>) -> io::Result<()> {
        let time = time.unwrap_or(f64::NAN);
        self.buffer.extend(time.to_le_bytes());
        self.buffer.extend(frame.number.to_le_bytes());
        // Readers refuse infinite values and too large ones; they are written as NaN.
        let written = |&value: &f64| {
            if value.abs() <= LARGEST_VALUE {
                value
            } else {
                f64::NAN
            }
        };
        let values = frame.values().iter().map(written);
        self.buffer.extend(values.flat_map(f64::to_le_bytes));
        self.records += 1;
        if self.buffer.len() >= BUFFER {
            return self.write_out();
        }
        self.tick()
    }

    /// Writes out the records if they have waited too long.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(super) fn tick(&mut self) -> io::Result<()> {
        if self.buffer.is_empty() || self.written.elapsed() < WRITTEN_OUT {
            return Ok(());
        }
        self.write_out()
    }

    /// Writes out all records, then their count. Records for which the disk has no room stay in the buffer.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(super) fn write_out(&mut self) -> io::Result<()> {
        let size = self.record_bytes();
        let start = HEADER + self.in_file * size;
        let written = self
            .file
            .seek(SeekFrom::Start(start))
            .and_then(|_| self.file.write_all(&self.buffer));
        if let Err(error) = written {
            // The first error is the one that is reported.
            let _ = self.keep_whole(start, size);
            return Err(error);
        }
        self.buffer.clear();
        self.in_file = self.records;
        self.written = Instant::now();
        self.count()?;
        self.syncer.tick()
    }

    /// Waits until everything that was written out is on the disk.
    ///
    /// # Errors
    /// Returns the system's error, from this call or from the thread that syncs.
    pub(super) fn end(&mut self) -> io::Result<()> {
        let earlier = self.syncer.end();
        earlier.and(self.file.sync_all())
    }

    /// Waits until everything that was written out is on the disk, but lets the thread go on: more records may come.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    /// Cuts off a torn record after `start`, and counts the complete ones.
    fn keep_whole(&mut self, start: u64, size: u64) -> io::Result<()> {
        let end = self.file.metadata()?.len();
        let whole = end.saturating_sub(start) / size;
        let whole = whole.min(self.records - self.in_file);
        self.file.set_len(start + whole * size)?;
        let bytes = index(whole * size);
        self.buffer.drain(..bytes.min(self.buffer.len()));
        self.in_file += whole;
        self.count()
    }

    /// Returns the number of bytes of a record.
    fn record_bytes(&self) -> u64 {
        let size = self.size.unwrap_or(FrameSize::SMALLEST);
        RECORD_HEAD + 8 * size.cells() as u64
    }

    /// Writes the header with the number of records in the file, in one piece.
    fn count(&mut self) -> io::Result<()> {
        let header = header(self.size, self.in_file);
        self.file.seek(SeekFrom::Start(0))?;
        self.file.write_all(&header)
    }
}

/// Returns the content of a file before the first frame comes: no records of one cell, which numpy opens too.
pub(super) fn empty() -> Vec<u8> {
    header(None, 0)
}

/// Returns true if a file begins like an array of records that taxel has written.
pub(super) fn is_own(start: &[u8]) -> bool {
    start.starts_with(&empty()[..BEFORE_TEXT + DESCRIPTION.len()])
}

/// Returns the header of an array of records.
pub(super) fn header(size: Option<FrameSize>, records: u64) -> Vec<u8> {
    let size = size.unwrap_or(FrameSize::SMALLEST);
    let (rows, columns) = (size.rows(), size.columns());
    let text = format!(
        "{DESCRIPTION}{rows}, {columns}))], 'fortran_order': False, 'shape': ({records},), }}"
    );
    header_of(&text, index(HEADER))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::acquire::recorder::FrameRecorder;
    use crate::formats::recording::RecordingMetadata;
    use crate::storage::Existing;

    #[test]
    fn a_value_that_a_reader_would_refuse_is_recorded_as_none() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let recorder = FrameRecorder::create(&path, Existing::Kept, &RecordingMetadata::default());
        let mut recorder = recorder.expect("begun");
        let mut frame = Frame::new(FrameSize::new(3, 1).expect("an allowed size"));
        let values = [1e300, 1.1e300, f64::NEG_INFINITY];
        frame.values_mut().copy_from_slice(&values);
        recorder.add(&frame, None).expect("recorded");
        recorder.finish().expect("finished");
        let bytes = std::fs::read(&path).expect("there");
        let words = bytes[256 + 16..].chunks_exact(8);
        let found: Vec<String> = words
            .map(|word| f64::from_le_bytes(word.try_into().expect("eight bytes")).to_string())
            .collect();
        assert_eq!(
            found,
            [1e300.to_string(), "NaN".to_owned(), "NaN".to_owned()]
        );
    }
}
