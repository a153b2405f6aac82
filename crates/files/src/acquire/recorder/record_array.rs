//! A growing array of records: a file that numpy and taxel can open at any moment, even after the program was killed.
//!
//! A record has a time in seconds (NaN if it is unknown), a number, and values. The header has spare room and states
//! the number of records in the file. The records are written first and their number after them, at least twice a
//! second, so a killed program loses less than half a second. A power cut may lose what the system has not written yet,
//! and may leave a number that is too large; then taxel reads the complete records, and numpy refuses the file. Values
//! are f64, as every format of frames is read: nothing is rounded.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::time::{Duration, Instant};

use taxel_core::frame::{Frame, FrameSize, LARGEST_VALUE};
use taxel_core::index::index;

use crate::formats::numpy::{BEFORE_TEXT, header_of};
use crate::storage::FileId;

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

#[derive(Debug)]
pub(super) struct RecordArray {
    file: File,
    size: FrameSize,
    buffer: Vec<u8>,
    /// The number of records in the file and in the buffer.
    records: u64,
    in_file: u64,
    written: Instant,
}

impl RecordArray {
    /// Takes a file that holds a header without records, for frames of this size.
    pub(super) fn new(file: File, size: FrameSize) -> Self {
        Self {
            file,
            size,
            buffer: Vec::new(),
            records: 0,
            in_file: 0,
            written: Instant::now(),
        }
    }

    /// The identity of the file; None if the system does not tell.
    pub(super) fn id(&self) -> Option<FileId> {
        FileId::of(&self.file).ok()
    }

    pub(super) fn size(&self) -> FrameSize {
        self.size
    }

    pub(super) fn records(&self) -> u64 {
        self.records
    }

    /// Adds a frame of the size of all frames, with its time in seconds.
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

    pub(super) fn tick(&mut self) -> io::Result<()> {
        if self.written.elapsed() < WRITTEN_OUT {
            return Ok(());
        }
        self.write_out()
    }

    /// Writes out all records, then their count. Records for which the disk has no room are given up.
    pub(super) fn write_out(&mut self) -> io::Result<()> {
        if self.buffer.is_empty() {
            return Ok(());
        }
        let record = RECORD_HEAD + 8 * self.size.cells() as u64;
        let start = HEADER + self.in_file * record;
        self.file.seek(SeekFrom::Start(start))?;
        let written = self.file.write_all(&self.buffer);
        self.buffer.clear();
        if let Err(error) = written {
            // The file ends after a whole record. The first error is the one that is reported.
            let end = self.file.metadata().map_or(start, |found| found.len());
            let whole = end.saturating_sub(start) / record;
            self.records = self.records.min(self.in_file + whole);
            let _ = self.file.set_len(HEADER + self.records * record);
            let _ = self.count();
            return Err(error);
        }
        self.written = Instant::now();
        self.count()
    }

    /// Writes the header with the number of records, in one piece.
    fn count(&mut self) -> io::Result<()> {
        self.in_file = self.records;
        self.file.seek(SeekFrom::Start(0))?;
        self.file.write_all(&header(self.size, self.records))
    }

    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.write_out()?;
        self.file.sync_all()
    }
}

/// Whether a file begins like an array of records that taxel has written.
pub(super) fn is_own(start: &[u8]) -> bool {
    let own = header(FrameSize::SMALLEST, 0);
    start.starts_with(&own[..BEFORE_TEXT + DESCRIPTION.len()])
}

pub(super) fn header(size: FrameSize, records: u64) -> Vec<u8> {
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
