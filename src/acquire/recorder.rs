//! Frames into a file that numpy and taxel can open at every moment, also after the program was killed.
//!
//! An array of records: time in seconds (NaN where it is not known), number, values. The header has room to spare and
//! counts the records that are in the file already: they are written first, the count after them, at least twice a second,
//! so a killed program loses less than half a second. A thread syncs the file each second, so a power cut loses hardly more;
//! it never holds up the frames. Values are f64, as every form of frame is read: nothing is rounded.
//! Beside `touch.npy` lies `touch.json`, which says where the frames are from and how they were looked at. The two get
//! their names together, so there is never one of these beside an older one of the other. `touch.json` says whether the
//! recording was ended; that of a killed program does not.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::formats::recording::{FrameMark, RecordingMetadata};
use crate::frame::Frame;
use crate::storage::{Existing, FileError, FinishedFile, UnfinishedFile, persist_pair};

/// Bytes of the header's text: with the ten before it, 256. The longest has about 150.
const HEADER_TEXT: u16 = 246;

/// Records are written out after this time at the latest.
const WRITTEN_OUT: Duration = Duration::from_millis(400);

/// The file is synced after this time.
const SYNCED: Duration = Duration::from_millis(900);

/// Or when they are so many bytes.
const BUFFER: usize = 1 << 18;

/// Why frames cannot be recorded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecorderError {
    /// The system refuses.
    #[error("{}: cannot record: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system reports.
        error: io::Error,
    },
    /// There is a file already.
    #[error("{} is there already; --force replaces it", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A frame of another size than those before it.
    #[error("a frame of {found_rows} × {found_columns} cells, expected {rows} × {columns} as before", found_rows = found.0, found_columns = found.1, rows = expected.0, columns = expected.1)]
    Size {
        /// Its rows and columns.
        found: (u16, u16),
        /// Those of the first frame.
        expected: (u16, u16),
    },
}

/// No description is longer.
const LARGEST_DESCRIPTION: u64 = 1 << 22;

/// Writes frames to a file.
#[derive(Debug)]
pub struct FrameRecorder {
    path: PathBuf,
    metadata: RecordingMetadata,
    file: File,
    shape: Option<(u16, u16)>,
    buffer: Vec<u8>,
    /// Records in the file and in the buffer.
    records: u64,
    written: Instant,
    /// The times of the first frame and of the last one.
    times: Option<(f64, f64)>,
    syncer: Syncer,
}

/// Syncs a file on a thread of its own.
#[derive(Debug)]
struct Syncer {
    ask: Option<SyncSender<()>>,
    thread: Option<JoinHandle<()>>,
    last: Instant,
}

impl Syncer {
    fn new(file: &File) -> Self {
        let (ask, asked) = sync_channel::<()>(1);
        let thread = file.try_clone().and_then(|file| {
            std::thread::Builder::new().spawn(move || {
                while asked.recv().is_ok() {
                    // What the disk refuses is reported by the next write, or at the end.
                    let _ = file.sync_data();
                }
            })
        });
        // Without it the file is synced at its end.
        let thread = thread.ok();
        Self {
            ask: thread.is_some().then_some(ask),
            thread,
            last: Instant::now(),
        }
    }

    /// Has the file synced if that was long ago, and does not wait for it.
    fn tick(&mut self) {
        if self.last.elapsed() >= SYNCED {
            self.last = Instant::now();
            let asked = self.ask.as_ref().map(|ask| ask.try_send(()));
            // It is still at the last one.
            let _ = asked;
        }
    }
}

impl Drop for Syncer {
    fn drop(&mut self) {
        self.ask = None;
        if let Some(thread) = self.thread.take() {
            // It does not panic.
            let _ = thread.join();
        }
    }
}

impl FrameRecorder {
    /// Creates the file, and `.json` beside it: both, or none.
    ///
    /// # Errors
    /// If one of the two is there and is to be kept, or they cannot be created.
    pub fn create(
        path: &Path,
        existing: Existing,
        metadata: &RecordingMetadata,
    ) -> Result<Self, RecorderError> {
        let mut metadata = metadata.clone();
        metadata.ended = Some(false);
        let array = || {
            let mut array = UnfinishedFile::new(path, existing)?;
            array.write(&header(None, 0))?;
            Ok((array.handle()?, array.finish()?))
        };
        let (file, array) = array().map_err(refused)?;
        let description = prepared(path, existing, &metadata)?;
        persist_pair(array, description).map_err(refused)?;
        Ok(Self {
            path: path.to_owned(),
            metadata,
            syncer: Syncer::new(&file),
            times: None,
            file,
            shape: None,
            buffer: Vec::new(),
            records: 0,
            written: Instant::now(),
        })
    }

    /// Writes the description beside the file anew.
    ///
    /// # Errors
    /// What the system reports.
    pub fn describe(&mut self, metadata: &RecordingMetadata) -> Result<(), RecorderError> {
        self.metadata.clone_from(metadata);
        self.metadata.ended = Some(false);
        self.write_description()
    }

    /// Replaces the marks in the description.
    ///
    /// # Errors
    /// What the system reports.
    pub fn mark(&mut self, marks: Vec<FrameMark>) -> Result<(), RecorderError> {
        self.metadata.marks = marks;
        self.write_description()
    }

    fn write_description(&self) -> Result<(), RecorderError> {
        let file = prepared(&self.path, Existing::Replaced, &self.metadata)?;
        file.persist().map_err(refused)
    }

    /// Number of frames that were recorded.
    pub fn frames(&self) -> u64 {
        self.records
    }

    /// Records a frame, with its time in seconds.
    ///
    /// # Errors
    /// If it is of another size than the first one, or cannot be written.
    pub fn add(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), RecorderError> {
        let found = (frame.rows(), frame.columns());
        if self.shape.is_none() {
            self.shape = Some(found);
            self.count()?;
        }
        if let Some(expected) = self.shape.filter(|shape| *shape != found) {
            return Err(RecorderError::Size { found, expected });
        }
        if let Some(time) = time {
            let first = self.times.map_or(time, |(first, _)| first);
            self.times = Some((first, time));
        }
        let time = time.unwrap_or(f64::NAN);
        self.buffer.extend(time.to_le_bytes());
        self.buffer.extend(frame.number.to_le_bytes());
        let values = frame.values().iter();
        self.buffer
            .extend(values.flat_map(|value| value.to_le_bytes()));
        self.records += 1;
        if self.buffer.len() >= BUFFER {
            return self.write_out();
        }
        self.tick()
    }

    /// Writes out what waits for too long; to be called now and then.
    ///
    /// # Errors
    /// What the system reports.
    pub fn tick(&mut self) -> Result<(), RecorderError> {
        if self.buffer.is_empty() || self.written.elapsed() < WRITTEN_OUT {
            return Ok(());
        }
        self.write_out()
    }

    /// Writes out all records, then their count.
    fn write_out(&mut self) -> Result<(), RecorderError> {
        let written = self
            .file
            .seek(SeekFrom::End(0))
            .and_then(|_| self.file.write_all(&self.buffer));
        written.map_err(|error| self.refused(error))?;
        self.buffer.clear();
        self.written = Instant::now();
        self.count()?;
        self.syncer.tick();
        Ok(())
    }

    fn refused(&self, error: io::Error) -> RecorderError {
        let path = self.path.clone();
        RecorderError::Io { path, error }
    }

    /// Writes the header with the number of records, in one piece.
    fn count(&mut self) -> Result<(), RecorderError> {
        let header = header(self.shape, self.records);
        let written = self
            .file
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.file.write_all(&header));
        written.map_err(|error| self.refused(error))
    }

    /// The mean time from a frame to the next.
    fn step(&self) -> Option<f64> {
        let (first, last) = self.times?;
        #[expect(clippy::cast_precision_loss, reason = "a mean")]
        let steps = self.records.checked_sub(1).filter(|&steps| steps > 0)? as f64;
        Some((last - first) / steps).filter(|&step| step > 0.0)
    }

    /// Writes out everything, and syncs the file.
    ///
    /// # Errors
    /// What the system reports.
    pub fn finish(mut self) -> Result<u64, RecorderError> {
        self.write_out()?;
        self.file.sync_all().map_err(|error| self.refused(error))?;
        if let Some(step) = self.step()
            && self.metadata.seconds_per_frame.is_none()
        {
            self.metadata.seconds_per_frame = Some(step);
        }
        self.metadata.ended = Some(true);
        self.write_description()?;
        Ok(self.records)
    }
}

/// The header of an array of records. Before the first frame comes: no records of one cell, which numpy opens too.
fn header(shape: Option<(u16, u16)>, records: u64) -> Vec<u8> {
    let (rows, columns) = shape.unwrap_or((1, 1));
    let text = format!(
        "{{'descr': [('time', '<f8'), ('number', '<u8'), ('values', '<f8', ({rows}, {columns}))], \
         'fortran_order': False, 'shape': ({records},), }}"
    );
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend(HEADER_TEXT.to_le_bytes());
    let width = usize::from(HEADER_TEXT) - 1;
    header.extend(format!("{text:<width$}\n").bytes());
    header
}

/// The description beside an array, on disk but without its name.
///
/// # Errors
/// What the system reports.
fn prepared(
    array: &Path,
    existing: Existing,
    metadata: &RecordingMetadata,
) -> Result<FinishedFile, RecorderError> {
    let path = array.with_extension("json");
    let json = metadata.text().map_err(|error| RecorderError::Io {
        path: path.clone(),
        error: error.into(),
    })?;
    let prepare = || {
        let mut file = UnfinishedFile::new(&path, existing)?;
        file.write(&json)?;
        file.finish()
    };
    prepare().map_err(refused)
}

/// What the system refuses of a file.
fn refused(error: FileError) -> RecorderError {
    let path = error.path.clone();
    match error.into_io() {
        exists if exists.kind() == io::ErrorKind::AlreadyExists => RecorderError::Exists { path },
        error => RecorderError::Io { path, error },
    }
}

/// The description beside an array, `touch.json` of `touch.npy`. None where there is none, or the file is something else.
///
/// # Errors
/// What is wrong with it.
pub fn description_beside(path: &Path) -> Option<Result<RecordingMetadata, String>> {
    let is_array = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("npy"));
    if !is_array {
        return None;
    }
    let beside = path.with_extension("json");
    if !beside.metadata().ok()?.is_file() {
        return None;
    }
    let mut bytes = Vec::new();
    let file = File::open(&beside).ok()?;
    file.take(LARGEST_DESCRIPTION)
        .read_to_end(&mut bytes)
        .ok()?;
    let name = || beside.display().to_string();
    Some(RecordingMetadata::read(&bytes)?.map_err(|error| format!("{}: {error}", name())))
}
