//! Writes frames to a file that numpy and taxel can open at any moment, even after the program was killed.
//!
//! `touch.npy` is an array of records: a time in seconds (NaN if it is unknown), a number, and values in f64, as every
//! format of frames is read, so nothing is rounded. Its header has spare room and states the number of records. The
//! records are written and synced first and their number after them, about once a second: whoever is killed, or loses
//! power, loses less than a second. A full disk ends a recording after its last whole record.
//!
//! Beside it, `touch.json` states where the frames are from, how they were processed, and whether the recording was
//! ended, which is false if the program was killed. The two never contradict each other. No file appears or is replaced
//! until the first frame arrives. Then both are written under temporary names; the array, still without records, gets
//! its name first, the metadata second, and only then records follow. If another program replaces the array meanwhile,
//! the metadata is left to that program.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use taxel_core::frame::{Frame, FrameSize, LARGEST_VALUE};
use taxel_core::index::index;

use crate::ReadError;
use crate::formats::file::{has_ending, system_reason};
use crate::formats::numpy::{BEFORE_TEXT, header_of};
use crate::formats::recording::RecordingMetadata;
use crate::storage::{self, Existing, FileError, FileId, NewFile, check_writable};

/// The beginning of the header's text, before the rows and columns of a frame.
const DESCRIPTION: &str = "{'descr': [('time', '<f8'), ('number', '<u8'), ('values', '<f8', (";

/// The end of the header's text before the first record.
const EMPTY: &[u8] = b"'shape': (0,)";

/// The number of bytes before the first record. The longest text of a header has about 150.
const HEADER: u64 = 256;

/// The time after which the records and their number are written at the latest. Ticks come each tenth of a second.
const WRITTEN: Duration = Duration::from_millis(800);

/// The number of waiting bytes at which records are written at once.
const MOST_WAITING: usize = 1 << 18;

const LARGEST_METADATA: u64 = 1 << 22;

/// A recorder that writes frames to a file, until [`Self::finish`] ends the recording and reports errors.
///
/// If it is dropped before that, it writes the waiting frames, as far as the system allows, and the metadata does not
/// say that the recording was ended.
///
/// ```
/// use taxel_files::acquire::{FrameRecorder, metadata_beside};
/// use taxel_files::formats::recording::RecordingMetadata;
/// use taxel_core::frame::{Frame, FrameSize};
/// use taxel_files::storage::Existing;
/// # let folder = tempfile::tempdir()?;
/// let path = folder.path().join("touch.npy");
/// let mut metadata = RecordingMetadata::default();
/// metadata.unit = Some("kPa".to_owned());
/// let mut recorder = FrameRecorder::create(&path, Existing::Kept, &metadata)?;
/// recorder.add(&Frame::new(FrameSize::new(16, 16)?), Some(0.0))?;
/// assert_eq!(recorder.finish()?, 1);
/// assert_eq!(metadata_beside(&path)?.unwrap().ended, Some(true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct FrameRecorder {
    path: PathBuf,
    existing: Existing,
    metadata: RecordingMetadata,
    /// The array; None before the first frame, and after a failure.
    file: Option<File>,
    size: Option<FrameSize>,
    /// The records that are not in the file yet.
    waiting: Vec<u8>,
    /// The number of frames that were recorded.
    pub frames: u64,
    /// The number of frames that were left out because their size is not that of the first one: an array has one size.
    pub left_out: u64,
    /// The number of records in the header.
    counted: u64,
    written: Instant,
}

impl FrameRecorder {
    /// Prepares a recording in a file whose name ends in `.npy`, with a `.json` file beside it. They appear with the
    /// first frame; files that they replace stay until then.
    ///
    /// # Errors
    /// If the name ends otherwise, if one of the two files exists and must be kept, if the file under the second name
    /// is not metadata, or if they cannot be created.
    pub fn create(
        path: &Path,
        existing: Existing,
        metadata: &RecordingMetadata,
    ) -> Result<Self, RecorderError> {
        let refused = |path: &Path, why: &str| {
            Err(RecorderError::Refused(format!("{}{why}", path.display())))
        };
        if !has_ending(path, "npy") {
            return refused(path, ": expected a file that ends in .npy");
        }
        let beside = path.with_extension("json");
        let is_foreign = |bytes: Vec<u8>| RecordingMetadata::read(&bytes).is_none();
        let found = beginning(&beside, LARGEST_METADATA + 1);
        if existing == Existing::Replaced && found.is_ok_and(is_foreign) {
            let why = " does not belong to a recording: record to another name";
            return refused(&beside, why);
        }
        check_writable(path, existing)?;
        check_writable(&beside, existing)?;
        let mut metadata = metadata.clone();
        metadata.ended = Some(false);
        Ok(Self {
            path: path.to_owned(),
            existing,
            metadata,
            file: None,
            size: None,
            waiting: Vec::new(),
            frames: 0,
            counted: 0,
            written: Instant::now(),
            left_out: 0,
        })
    }

    /// Changes the metadata, also in the file once there is one.
    ///
    /// # Errors
    /// If the file cannot be written, or if another program has replaced the recording.
    pub fn describe(
        &mut self,
        change: impl FnOnce(&mut RecordingMetadata),
    ) -> Result<(), RecorderError> {
        change(&mut self.metadata);
        let described = self.write_metadata();
        self.noted(described)
    }

    /// Keeps the reason why the recording ends early for the metadata, if it is the first.
    pub fn note_reason(&mut self, reason: &str) {
        let kept = &mut self.metadata.ended_by;
        kept.get_or_insert_with(|| reason.to_owned());
    }

    /// Records a frame, with its time in seconds. A frame of another size than the first is left out and counted.
    ///
    /// # Errors
    /// If the frame cannot be written, or if the files cannot get their names with the first one.
    pub fn add(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), RecorderError> {
        let added = self.take(frame, time);
        self.noted(added)
    }

    /// Writes the frames if they have waited too long; to be called now and then.
    ///
    /// # Errors
    /// The system's error.
    pub fn tick(&mut self) -> Result<(), RecorderError> {
        if self.written.elapsed() < WRITTEN {
            return Ok(());
        }
        self.flush()
    }

    /// Writes and syncs all waiting frames, and their number; for a source that pauses, perhaps for ever.
    ///
    /// # Errors
    /// The system's error.
    pub fn flush(&mut self) -> Result<(), RecorderError> {
        let written = self.write_records().and_then(|()| self.count());
        self.noted(written)
    }

    /// Writes everything, and returns the number of frames. Without a frame, no file appears, and the files that would
    /// have been replaced stay as they are.
    ///
    /// # Errors
    /// The system's error. Even then, the records in the file are complete.
    pub fn finish(mut self) -> Result<u64, RecorderError> {
        let written = self.flush();
        self.metadata.ended = Some(true);
        let described = self.write_metadata();
        written.and(described).map(|()| self.frames)
    }

    fn take(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), RecorderError> {
        let size = *self.size.get_or_insert(frame.size());
        if size != frame.size() {
            self.left_out += 1;
            return Ok(());
        }
        if self.frames == 0 {
            self.begin(size)?;
        }
        let time = time.unwrap_or(f64::NAN);
        self.waiting.extend(time.to_le_bytes());
        self.waiting.extend(frame.number.to_le_bytes());
        // Readers refuse infinite values and too large ones; they are written as NaN.
        let allowed = |value: &f64| value.abs() <= LARGEST_VALUE;
        let values = frame.values().iter();
        let values = values.map(|value| Some(*value).filter(allowed).unwrap_or(f64::NAN));
        self.waiting.extend(values.flat_map(f64::to_le_bytes));
        self.frames += 1;
        if self.waiting.len() >= MOST_WAITING {
            self.write_records()?;
        }
        self.tick()
    }

    fn begin(&mut self, size: FrameSize) -> Result<(), RecorderError> {
        let array = NewFile::with_content(&self.path, &header(size, 0), self.existing)?;
        let metadata = NewFile::with_content(&self.beside(), &self.metadata.text(), self.existing)?;
        let file = array.persist()?;
        if let Err(error) = metadata.persist() {
            // Another program has taken the name: the array would be beside its file.
            if self.existing == Existing::Kept {
                let _ = fs::remove_file(&self.path);
            }
            return Err(error.into());
        }
        self.file = Some(file);
        Ok(())
    }

    fn beside(&self) -> PathBuf {
        self.path.with_extension("json")
    }

    /// Writes the metadata beside the array, if there is one, unless its name now belongs to another file.
    fn write_metadata(&self) -> Result<(), RecorderError> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        if FileId::of(file).is_ok_and(|own| !own.is_at(&self.path)) {
            return Err(RecorderError::Refused(format!(
                "{}: replaced, moved or removed while frames were recorded in it; the .json file beside it is left as it is",
                self.path.display()
            )));
        }
        Ok(storage::write(
            &self.beside(),
            &self.metadata.text(),
            Existing::Replaced,
        )?)
    }

    /// Writes the waiting records. Those for which the disk has no room are given up: the file ends after a whole one,
    /// and its header says so.
    fn write_records(&mut self) -> Result<(), RecorderError> {
        let (Some(file), Some(size)) = (&mut self.file, self.size) else {
            return Ok(());
        };
        let record = 16 + 8 * size.cells() as u64;
        let start = HEADER + self.frames * record - self.waiting.len() as u64;
        let written = file
            .seek(SeekFrom::Start(start))
            .and_then(|_| file.write_all(&self.waiting));
        self.waiting.clear();
        let Err(error) = written else {
            return Ok(());
        };
        let end = file.metadata().map_or(start, |found| found.len());
        self.frames = end.saturating_sub(HEADER) / record;
        let _ = file.set_len(HEADER + self.frames * record);
        let _ = self.count();
        Err(self.failed(error))
    }

    /// Syncs the records, and writes the header with their number in one piece.
    fn count(&mut self) -> Result<(), RecorderError> {
        self.written = Instant::now();
        let (Some(file), Some(size)) = (&mut self.file, self.size) else {
            return Ok(());
        };
        if self.counted != self.frames {
            let header = header(size, self.frames);
            let counted = file
                .sync_data()
                .and_then(|()| file.seek(SeekFrom::Start(0)))
                .and_then(|_| file.write_all(&header));
            counted.map_err(|error| self.failed(error))?;
            self.counted = self.frames;
        }
        Ok(())
    }

    fn failed(&self, error: io::Error) -> RecorderError {
        FileError::cannot("record", &self.path)(error).into()
    }

    /// Keeps the first failure for the metadata.
    fn noted<T>(&mut self, result: Result<T, RecorderError>) -> Result<T, RecorderError> {
        match &result {
            Err(RecorderError::Io(failed)) => self.note_reason(&system_reason(&failed.error)),
            Err(error) => self.note_reason(&error.to_string()),
            Ok(_) => {}
        }
        result
    }
}

impl Drop for FrameRecorder {
    fn drop(&mut self) {
        let _ = self.flush();
    }
}

/// Whether a file begins like an array of records that taxel has written.
fn is_own(start: &[u8]) -> bool {
    let own = header(FrameSize::SMALLEST, 0);
    start.starts_with(&own[..BEFORE_TEXT + DESCRIPTION.len()])
}

fn header(size: FrameSize, records: u64) -> Vec<u8> {
    let (rows, columns) = (size.rows(), size.columns());
    let text = format!(
        "{DESCRIPTION}{rows}, {columns}))], 'fortran_order': False, 'shape': ({records},), }}"
    );
    header_of(&text, index(HEADER))
}

/// The beginning of a regular file; nothing of a pipe, whose writer would have to be waited for.
fn beginning(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if path.metadata()?.is_file() {
        File::open(path)?.take(most).read_to_end(&mut bytes)?;
    }
    Ok(bytes)
}

/// Reads the metadata beside an array: `touch.json` for `touch.npy`. None if an array of another program has no metadata
/// beside it, or if one that taxel has just begun has no frames that it could be about.
///
/// # Errors
/// If the metadata is damaged, of another version, larger than 4 MiB or cannot be read; or if there is none although
/// taxel has recorded the array. The message names the file.
pub fn metadata_beside(path: &Path) -> Result<Option<RecordingMetadata>, ReadError> {
    if !has_ending(path, "npy") {
        return Ok(None);
    }
    let start = beginning(path, HEADER).unwrap_or_default();
    let is_recorded = is_own(&start);
    if is_recorded && start.windows(EMPTY.len()).any(|part| part == EMPTY) {
        return Ok(None);
    }
    let beside = path.with_extension("json");
    let unknown = |what: &str| {
        let (name, end) = (
            beside.display(),
            "the recording's threshold and tare are unknown",
        );
        Err(ReadError::new(format!("{name}: {what}; {end}")))
    };
    let bytes = match beginning(&beside, LARGEST_METADATA + 1) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            return unknown(&format!("cannot read: {}", system_reason(&error)));
        }
        Err(_) if is_recorded => return unknown("missing"),
        Err(_) => return Ok(None),
    };
    match RecordingMetadata::read(&bytes) {
        Some(_) if bytes.len() as u64 > LARGEST_METADATA => {
            unknown("larger than 4 MiB, the limit for metadata")
        }
        Some(Ok(metadata)) => Ok(Some(metadata)),
        Some(Err(error)) => unknown(&error.to_string()),
        None if is_recorded => unknown("empty or not written by taxel"),
        None => Ok(None),
    }
}

/// Why frames cannot be recorded.
#[derive(Debug, thiserror::Error)]
pub enum RecorderError {
    /// The system cannot write the file.
    #[error(transparent)]
    Io(FileError),
    /// The file exists already.
    #[error("{:?} already exists", _0.to_string_lossy())]
    Exists(PathBuf),
    /// The file is not one to record in, in words that name it: its name ends otherwise, another program's file is
    /// beside it or has taken its name meanwhile, or it is the source.
    #[error("{0}")]
    Refused(String),
}

impl From<FileError> for RecorderError {
    fn from(error: FileError) -> Self {
        let doing = "record";
        if error.exists() {
            Self::Exists(error.path)
        } else {
            Self::Io(FileError { doing, ..error })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn begun(path: &Path) -> FrameRecorder {
        let metadata = RecordingMetadata::default();
        FrameRecorder::create(path, Existing::Kept, &metadata).expect("begun")
    }

    fn beside(path: &Path) -> RecordingMetadata {
        metadata_beside(path).expect("read").expect("there")
    }

    fn numbered(number: u64) -> Frame {
        let mut frame = Frame::default();
        frame.number = number;
        frame
    }

    #[test]
    fn metadata_that_is_too_large_is_not_called_damaged() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let text = RecordingMetadata::default().text();
        for (size, is_read) in [(1 << 22, true), ((1 << 22) + 1, false)] {
            let blanks = vec![b' '; size - text.len()];
            let written = [&blanks[..], &text].concat();
            fs::write(path.with_extension("json"), written).expect("written");
            let read = metadata_beside(&path).map_err(|error| error.to_string());
            let is_too_large = read.is_err_and(|said| said.contains("larger than 4 MiB"));
            assert_eq!(is_too_large, !is_read);
        }
    }

    /// Another program has replaced the recording, with its metadata.
    #[test]
    fn a_recording_that_was_replaced_leaves_the_new_metadata_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let mut old = begun(&path);
        old.add(&Frame::default(), None).expect("recorded");
        let metadata = RecordingMetadata {
            unit: Some("kPa".to_owned()),
            ..RecordingMetadata::default()
        };
        let new = FrameRecorder::create(&path, Existing::Replaced, &metadata);
        let mut new = new.expect("begun");
        new.add(&Frame::default(), None).expect("recorded");
        new.finish().expect("finished");
        let files =
            || [&path, &path.with_extension("json")].map(|path| fs::read(path).expect("there"));
        let before = files();
        let refused = |done: Result<(), RecorderError>| {
            let said = done.expect_err("replaced").to_string();
            assert!(said.contains("replaced, moved or removed"), "{said}");
        };
        refused(old.describe(|own| own.unit = None));
        refused(old.finish().map(drop));
        assert_eq!(files(), before);
    }

    #[test]
    fn a_recorder_that_is_dropped_leaves_its_frames_but_no_end() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let mut recorder = begun(&path);
        for number in 0..3 {
            recorder.add(&numbered(number), None).expect("recorded");
        }
        drop(recorder);
        let bytes = fs::read(&path).expect("there");
        assert_eq!(bytes[..256], header(FrameSize::SMALLEST, 3));
        assert_eq!(bytes.len(), 256 + 3 * 24);
        assert_eq!(beside(&path).ended, Some(false));
        // Before its first frame, none of its files is there.
        drop(begun(&folder.path().join("b.npy")));
        assert_eq!(fs::read_dir(folder.path()).expect("read").count(), 2);
    }

    #[test]
    fn a_file_that_came_meanwhile_is_kept() {
        for (name, other) in [("a.npy", "a.json"), ("b.json", "b.npy")] {
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join(name);
            let mut recorder = begun(&path.with_extension("npy"));
            fs::write(&path, "mine").expect("written");
            let added = recorder.add(&Frame::default(), None);
            assert!(matches!(added, Err(RecorderError::Exists(_))));
            assert_eq!(fs::read_to_string(&path).expect("read"), "mine");
            assert!(!folder.path().join(other).exists());
            assert_eq!(recorder.finish().expect("nothing was recorded"), 0);
        }
    }

    #[test]
    fn only_metadata_is_replaced_beside_an_array() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let beside = path.with_extension("json");
        let record = |path: &Path| {
            let metadata = RecordingMetadata::default();
            let mut recorder = FrameRecorder::create(path, Existing::Replaced, &metadata)?;
            recorder.add(&Frame::default(), None)
        };
        fs::write(&beside, "{\"mine\":1}").expect("written");
        assert!(matches!(record(&path), Err(RecorderError::Refused(_))));
        let kept = fs::read_to_string(&beside).expect("read");
        assert_eq!((kept.as_str(), path.exists()), ("{\"mine\":1}", false));
        fs::remove_file(&beside).expect("removed");
        for _ in 0..2 {
            record(&path).expect("its own");
        }
        assert!(matches!(record(&beside), Err(RecorderError::Refused(_))));
    }

    #[test]
    fn a_value_that_a_reader_would_refuse_is_recorded_as_none() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let mut recorder = begun(&path);
        let mut frame = Frame::new(FrameSize::new(3, 1).expect("an allowed size"));
        let values = [1e300, 1.1e300, f64::NEG_INFINITY];
        frame.values_mut().copy_from_slice(&values);
        recorder.add(&frame, None).expect("recorded");
        recorder.finish().expect("finished");
        let bytes = fs::read(&path).expect("there");
        let words = bytes[256 + 16..].chunks_exact(8);
        let value = |word: &[u8]| f64::from_le_bytes(word.try_into().expect("eight bytes"));
        let found: Vec<f64> = words.map(value).collect();
        assert!(found[0] == 1e300 && found[1..].iter().all(|value| value.is_nan()));
    }
}
