//! Frames into a file that numpy and taxel can open at every moment, also after the program was killed.
//!
//! An array of records: time in seconds (NaN where it is not known), number, values. The header has room to spare and
//! counts the records that are in the file already: they are written first, the count after them, at least twice a second.
//! Beside `touch.npy` lies `touch.json`, which says where the frames are from and how they were looked at.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::formats::recording::SetRule;
use crate::frame::{Frame, Tare};
use crate::storage::{Existing, UnfinishedFile};

/// Bytes of the header's text: with the ten before it, 256. The longest has about 150.
const HEADER_TEXT: u16 = 246;

/// Records are written out after this time at the latest.
const WRITTEN_OUT: Duration = Duration::from_millis(400);

/// Or when they are so many bytes.
const BUFFER: usize = 1 << 18;

/// What `touch.json` says.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RecordingMetadata {
    /// The source's name.
    pub source: String,
    /// The unit of the values.
    pub unit: Option<String>,
    /// The distance of two cells, in mm, along x and along y.
    pub pitch_mm: Option<[f64; 2]>,
    /// The rule of the imprints that were shown meanwhile.
    pub rule: Option<SetRule>,
    /// How many frames the tare was made of.
    pub tare_frames: Option<u64>,
    /// What it takes off, row by row; null where there is no cell.
    pub tare: Option<Vec<Vec<Option<f64>>>>,
}

impl RecordingMetadata {
    /// With a tare.
    #[must_use]
    pub fn with_tare(mut self, tare: &Tare) -> Self {
        let baseline = tare.baseline();
        let row = |row| {
            let values = baseline.row(row).iter();
            values
                .map(|&value| (!value.is_nan()).then_some(value))
                .collect()
        };
        self.tare_frames = Some(tare.frames());
        self.tare = Some((0..baseline.rows()).map(row).collect());
        self
    }
}

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

/// Writes frames to a file.
#[derive(Debug)]
pub struct FrameRecorder {
    path: PathBuf,
    file: File,
    shape: Option<(u16, u16)>,
    buffer: Vec<u8>,
    /// Records in the file and in the buffer.
    records: u64,
    written: Instant,
}

impl FrameRecorder {
    /// Creates the file, and `.json` beside it.
    ///
    /// # Errors
    /// If there is a file that is to be kept, or it cannot be created.
    pub fn create(
        path: &Path,
        existing: Existing,
        metadata: &RecordingMetadata,
    ) -> Result<Self, RecorderError> {
        let mut options = File::options();
        options.write(true);
        match existing {
            Existing::Replaced => options.create(true).truncate(true),
            _ => options.create_new(true),
        };
        let file = options.open(path).map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => RecorderError::Exists {
                path: path.to_owned(),
            },
            _ => RecorderError::Io {
                path: path.to_owned(),
                error,
            },
        })?;
        let mut recorder = Self {
            path: path.to_owned(),
            file,
            shape: None,
            buffer: Vec::new(),
            records: 0,
            written: Instant::now(),
        };
        recorder.describe(metadata)?;
        recorder.count()?;
        Ok(recorder)
    }

    /// Writes the description beside the file anew.
    ///
    /// # Errors
    /// What the system reports.
    pub fn describe(&self, metadata: &RecordingMetadata) -> Result<(), RecorderError> {
        let path = self.path.with_extension("json");
        let refuse = |error: io::Error| RecorderError::Io {
            path: path.clone(),
            error,
        };
        let described = Described {
            format: "taxel-touch/1",
            metadata,
        };
        let json = serde_json::to_vec_pretty(&described).map_err(|error| refuse(error.into()))?;
        let write = || {
            let mut file = UnfinishedFile::new(&path, Existing::Replaced)?;
            file.write(&json)?;
            file.finish()?.persist()
        };
        write().map_err(|error| refuse(error.into_io()))
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
        self.count()
    }

    fn refused(&self, error: io::Error) -> RecorderError {
        let path = self.path.clone();
        RecorderError::Io { path, error }
    }

    /// Writes the header with the number of records, in one piece.
    fn count(&mut self) -> Result<(), RecorderError> {
        // Until the first frame comes: no records of one cell, which numpy opens too.
        let (rows, columns) = self.shape.unwrap_or((1, 1));
        let records = self.records;
        let text = format!(
            "{{'descr': [('time', '<f8'), ('number', '<u8'), ('values', '<f8', ({rows}, {columns}))], \
             'fortran_order': False, 'shape': ({records},), }}"
        );
        let mut header = b"\x93NUMPY\x01\x00".to_vec();
        header.extend(HEADER_TEXT.to_le_bytes());
        let width = usize::from(HEADER_TEXT) - 1;
        header.extend(format!("{text:<width$}\n").bytes());
        let written = self
            .file
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.file.write_all(&header));
        written.map_err(|error| self.refused(error))
    }

    /// Writes out everything, and syncs the file.
    ///
    /// # Errors
    /// What the system reports.
    pub fn finish(mut self) -> Result<u64, RecorderError> {
        self.write_out()?;
        self.file.sync_all().map_err(|error| self.refused(error))?;
        Ok(self.records)
    }
}

#[derive(Serialize)]
struct Described<'a> {
    format: &'static str,
    #[serde(flatten)]
    metadata: &'a RecordingMetadata,
}
