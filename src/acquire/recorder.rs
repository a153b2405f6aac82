//! Writes frames to a file that numpy and taxel can open at any moment, even after the program was killed.
//!
//! An array of records: time in seconds (NaN where it is not known), number, values. The header has room to spare and
//! counts the records that are in the file already: they are written first, the count after them, at least twice a second,
//! so a killed program loses less than half a second. A thread syncs the file each second and never holds up the frames: a
//! power cut loses hardly more. It may leave a count beyond the records; then taxel reads the whole records, and
//! numpy refuses the file. Values are f64, as every format of frame is read: nothing is rounded.
//! Beside `touch.npy` lies `touch.json`, which says where the frames are from and how they were looked at. The two get
//! their names together, so there is never one of these beside an older one of the other. `touch.json` says whether the
//! recording was ended; that of a killed program does not. The file is long because the array, its description and their
//! names change together.
//!
//! No file appears or is replaced until the first frame arrives. A disk that is full ends a recording after its last
//! whole record, and the description says why.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::formats::recording::{RecordedView, RecordingMetadata};
use crate::formats::seconds::usual_step;
use crate::frame::{Frame, LARGEST_VALUE};
use crate::index::index;
use crate::storage::{Existing, FileError, FinishedFile, UnfinishedFile, persist_pair};

/// Bytes of the header's text: with the ten before it, 256. The longest has about 150.
const HEADER_TEXT: u16 = 246;

/// Bytes before the first record.
const HEADER: u64 = 256;

/// Bytes of time and number before the values of a record.
const RECORD_HEAD: u64 = 16;

/// Records are written out after this time at the latest.
const WRITTEN_OUT: Duration = Duration::from_millis(400);

/// The step is that of the last frames, this many at most.
const MOST_STEPS: usize = 4096;

/// Bytes that wait at most; with this many, records are written out at once.
const BUFFER: usize = 1 << 18;

/// The file is synced after this time.
const SYNCED: Duration = Duration::from_millis(900);

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
    #[error("{} already exists", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The file beside the array is not the description of a recording, so it is not replaced.
    #[error("{} is not the description of a recording: record to another name", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The file is not named as an array.
    #[error("{}: expected a file that ends in .npy", path.display())]
    Ending {
        /// The file.
        path: PathBuf,
    },
    /// The file, or the description beside it, is the source.
    #[error("{} is the source being watched: record to another file", path.display())]
    IsSource {
        /// The file.
        path: PathBuf,
    },
}

/// No description is longer.
const LARGEST_DESCRIPTION: u64 = 1 << 22;

/// Writes frames to a file, until [`Self::finish`] ends the recording and says what went wrong.
///
/// Dropped without that, it writes out the frames that wait, as far as the system lets it, and the description does not say
/// that the recording was ended.
///
/// ```
/// use taxel::acquire::{FrameRecorder, description_beside};
/// use taxel::formats::recording::RecordingMetadata;
/// use taxel::frame::Frame;
/// use taxel::storage::Existing;
/// # let folder = tempfile::tempdir()?;
/// let path = folder.path().join("touch.npy");
/// let mut metadata = RecordingMetadata::default();
/// metadata.unit = Some("kPa".to_owned());
/// let mut recorder = FrameRecorder::create(&path, Existing::Kept, &metadata)?;
/// recorder.add(&Frame::new(16, 16), Some(0.0))?;
/// assert_eq!(recorder.finish()?, 1);
/// assert_eq!(description_beside(&path).unwrap()?.ended, Some(true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct FrameRecorder {
    path: PathBuf,
    /// What happens to files that are there when they get their names.
    existing: Existing,
    metadata: RecordingMetadata,
    file: File,
    names: Names,
    shape: Option<(u16, u16)>,
    buffer: Vec<u8>,
    /// Records in the file and in the buffer.
    records: u64,
    /// Records in the file.
    in_file: u64,
    /// Frames of another size than the first one.
    left_out: u64,
    /// What went wrong first.
    reason: Option<String>,
    written: Instant,
    /// The time of the last frame.
    last_time: Option<f64>,
    /// The times between the last frames.
    steps: VecDeque<f64>,
    syncer: Syncer,
}

/// Whether array and description have their names.
#[derive(Debug)]
enum Names {
    /// They get them with the first frame.
    Waiting(FinishedFile, FinishedFile),
    /// They have them.
    Given,
    /// They did not get them. What lies there is not of this recording, and stays as it is.
    Refused,
}

/// Syncs a file on a thread of its own.
#[derive(Debug)]
struct Syncer {
    ask: Option<SyncSender<()>>,
    /// Ends at the first error. The system reports an error of the disk once only, to whoever asks first.
    thread: Option<JoinHandle<io::Result<()>>>,
    last: Instant,
}

impl Syncer {
    fn new(file: &File) -> Self {
        let (ask, asked) = sync_channel::<()>(1);
        let thread = file.try_clone().and_then(|file| {
            std::thread::Builder::new().spawn(move || {
                while asked.recv().is_ok() {
                    file.sync_data()?;
                }
                Ok(())
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
    ///
    /// # Errors
    /// What an earlier one has failed with.
    fn tick(&mut self) -> io::Result<()> {
        if self.last.elapsed() >= SYNCED {
            self.last = Instant::now();
            let asked = self.ask.as_ref().map(|ask| ask.try_send(()));
            // If it is full, the last sync still runs.
            if let Some(Err(TrySendError::Disconnected(()))) = asked {
                return self.end();
            }
        }
        Ok(())
    }

    /// Waits until no sync runs any more.
    ///
    /// # Errors
    /// What one of them has failed with.
    fn end(&mut self) -> io::Result<()> {
        self.ask = None;
        let ended = self.thread.take().map(JoinHandle::join);
        // It does not panic.
        ended.and_then(Result::ok).unwrap_or(Ok(()))
    }
}

impl Drop for Syncer {
    fn drop(&mut self) {
        // An error was reported by the end of the recording; one that is given up says nothing.
        let _ = self.end();
    }
}

impl FrameRecorder {
    /// Creates the file, whose name ends in `.npy`, and `.json` beside it: both, or none. They appear with the first frame,
    /// and what is to be replaced stays until then.
    ///
    /// # Errors
    /// If the name ends otherwise, if one of the two is there and is to be kept, if what is there under the second name is no
    /// description, or if they cannot be created.
    pub fn create(
        path: &Path,
        existing: Existing,
        metadata: &RecordingMetadata,
    ) -> Result<Self, RecorderError> {
        if !is_array(path) {
            let path = path.to_owned();
            return Err(RecorderError::Ending { path });
        }
        let beside = path.with_extension("json");
        let is_there = existing == Existing::Replaced && beside.symlink_metadata().is_ok();
        if is_there && description_beside(path).is_none() {
            return Err(RecorderError::Foreign { path: beside });
        }
        let mut metadata = metadata.clone();
        metadata.ended = Some(false);
        let array = || {
            let mut array = UnfinishedFile::new(path, existing)?;
            array.write(&header(None, 0))?;
            Ok((array.handle()?, array.finish()?))
        };
        let (file, array) = array().map_err(refused)?;
        let description = prepared(path, existing, &metadata)?;
        Ok(Self {
            path: path.to_owned(),
            existing,
            metadata,
            names: Names::Waiting(array, description),
            in_file: 0,
            left_out: 0,
            reason: None,
            syncer: Syncer::new(&file),
            last_time: None,
            steps: VecDeque::with_capacity(MOST_STEPS),
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
        let written = self.write_description();
        self.noted(written)
    }

    /// Replaces threshold, tare and marks in the description.
    ///
    /// # Errors
    /// What the system reports.
    pub fn change_view(&mut self, view: RecordedView) -> Result<(), RecorderError> {
        self.set_view(view);
        let written = self.write_description();
        self.noted(written)
    }

    /// The same for a caller who writes the description itself: see [`DescriptionDraft`].
    pub(crate) fn set_view(&mut self, view: RecordedView) -> DescriptionDraft {
        let RecordedView { rule, tare, marks } = view;
        (self.metadata.rule, self.metadata.tare, self.metadata.marks) = (rule, tare, marks);
        self.draft()
    }

    /// Keeps the reason of the first failure for the description.
    fn noted<T>(&mut self, result: Result<T, RecorderError>) -> Result<T, RecorderError> {
        if let Err(error) = &result {
            self.note_failure(error);
        }
        result
    }

    /// Keeps the reason of a failure for the description, if it is the first.
    pub(crate) fn note_failure(&mut self, error: &RecorderError) {
        self.reason.get_or_insert_with(|| match error {
            RecorderError::Io { error, .. } => error.to_string(),
            error => error.to_string(),
        });
    }

    fn draft(&self) -> DescriptionDraft {
        DescriptionDraft {
            path: self.path.clone(),
            metadata: self.metadata.clone(),
        }
    }

    /// Takes a description that is on the disk, to give it its name together with the array. Returns it if the array has its
    /// name already: it is to be given its own at once.
    pub(crate) fn take_description(&mut self, file: FinishedFile) -> Option<FinishedFile> {
        match &mut self.names {
            Names::Waiting(_, description) => *description = file.with_existing(self.existing),
            Names::Given => return Some(file),
            Names::Refused => {}
        }
        None
    }

    fn write_description(&mut self) -> Result<(), RecorderError> {
        let file = self.draft().prepare()?;
        self.take_description(file).map_or(Ok(()), name_description)
    }

    /// Writes the description over the old one, where a full disk has no room for both.
    fn overwrite_description(&self) -> io::Result<()> {
        let text = self.metadata.text()?;
        let path = self.path.with_extension("json");
        let mut file = File::options().write(true).open(path)?;
        let old = file.seek(SeekFrom::End(0))?;
        let missing = (text.len() as u64).saturating_sub(old);
        // Blanks change nothing. The text is replaced only if there is room for them.
        if let Err(error) = io::copy(&mut io::repeat(b' ').take(missing), &mut file) {
            file.set_len(old)?;
            return Err(error);
        }
        file.seek(SeekFrom::Start(0))?;
        file.write_all(&text)?;
        file.set_len(text.len() as u64)?;
        file.sync_all()
    }

    /// Number of frames that were recorded.
    pub fn frames(&self) -> u64 {
        self.records
    }

    /// Number of frames that were not, since they are of another size than the first one: an array has one size.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// Rows and columns of the frames that are recorded; None before the first one.
    pub fn size(&self) -> Option<(u16, u16)> {
        self.shape
    }

    /// Records a frame, with its time in seconds; one of another size than the first is left out and counted.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), RecorderError> {
        let added = self.take(frame, time);
        self.noted(added)
    }

    fn take(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), RecorderError> {
        let found = (frame.rows(), frame.columns());
        if self.shape.is_none() {
            self.shape = Some(found);
            self.count()?;
        }
        self.names = match std::mem::replace(&mut self.names, Names::Refused) {
            Names::Waiting(array, description) => {
                self.file = persist_pair(array, description).map_err(refused)?;
                self.syncer = Syncer::new(&self.file);
                Names::Given
            }
            names => names,
        };
        if self.shape.is_some_and(|shape| shape != found) {
            self.left_out += 1;
            return Ok(());
        }
        if let Some(time) = time {
            if self.steps.len() == MOST_STEPS {
                self.steps.pop_front();
            }
            let last = self.last_time.replace(time);
            self.steps.extend(last.map(|last| time - last));
        }
        let time = time.unwrap_or(f64::NAN);
        self.buffer.extend(time.to_le_bytes());
        self.buffer.extend(frame.number.to_le_bytes());
        // Readers refuse infinite values; here they count as none.
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
        if self.buffer.len() >= BUFFER || self.written.elapsed() >= WRITTEN_OUT {
            return self.write_out();
        }
        Ok(())
    }

    /// Writes out what waits for too long; to be called now and then.
    ///
    /// # Errors
    /// What the system reports.
    pub fn tick(&mut self) -> Result<(), RecorderError> {
        if self.buffer.is_empty() || self.written.elapsed() < WRITTEN_OUT {
            return Ok(());
        }
        let written = self.write_out();
        self.noted(written)
    }

    /// Writes out everything that waits, and waits until it is synced; for a source that pauses, perhaps for ever.
    ///
    /// # Errors
    /// What the system reports.
    pub fn flush(&mut self) -> Result<(), RecorderError> {
        if !matches!(self.names, Names::Given) {
            return Ok(());
        }
        let written = self.write_out().and_then(|()| {
            let synced = self.file.sync_data();
            synced.map_err(|error| self.refused(error))
        });
        self.noted(written)
    }

    /// Writes out all records, then their count. What the disk has no room for stays in the buffer.
    fn write_out(&mut self) -> Result<(), RecorderError> {
        let size = self.record_bytes();
        let start = HEADER + self.in_file * size;
        let written = self
            .file
            .seek(SeekFrom::Start(start))
            .and_then(|_| self.file.write_all(&self.buffer));
        if let Err(error) = written {
            // The first error is the one that is reported.
            let _ = self.keep_whole(start, size);
            return Err(self.refused(error));
        }
        self.buffer.clear();
        self.in_file = self.records;
        self.written = Instant::now();
        self.count()?;
        let synced = self.syncer.tick();
        synced.map_err(|error| self.refused(error))
    }

    /// Cuts off a torn record behind `start`, and counts the whole ones.
    fn keep_whole(&mut self, start: u64, size: u64) -> Result<(), RecorderError> {
        let end = self.file.metadata().map(|file| file.len());
        let end = end.map_err(|error| self.refused(error))?;
        let whole = end.saturating_sub(start) / size;
        let whole = whole.min(self.records - self.in_file);
        let cut = self.file.set_len(start + whole * size);
        cut.map_err(|error| self.refused(error))?;
        let bytes = index(whole * size);
        self.buffer.drain(..bytes.min(self.buffer.len()));
        self.in_file += whole;
        self.count()
    }

    /// Bytes of a record.
    fn record_bytes(&self) -> u64 {
        let (rows, columns) = self.shape.unwrap_or((1, 1));
        RECORD_HEAD + 8 * u64::from(rows) * u64::from(columns)
    }

    fn refused(&self, error: io::Error) -> RecorderError {
        let path = self.path.clone();
        RecorderError::Io { path, error }
    }

    /// Writes the header with the number of records in the file, in one piece.
    fn count(&mut self) -> Result<(), RecorderError> {
        let header = header(self.shape, self.in_file);
        let written = self
            .file
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.file.write_all(&header));
        written.map_err(|error| self.refused(error))
    }

    /// Writes out everything, and syncs the file. Without a frame nothing appears, and what was to be replaced is there as
    /// before.
    ///
    /// # Errors
    /// What the system reports. What is in the file then is whole all the same, and the description says why it ends there.
    pub fn finish(mut self) -> Result<u64, RecorderError> {
        if !matches!(self.names, Names::Given) {
            return Ok(0);
        }
        let written = self.write_out();
        let written = self.noted(written);
        let earlier = self.syncer.end();
        let synced = earlier.and(self.file.sync_all());
        let synced = synced.map_err(|error| self.refused(error));
        let synced = self.noted(synced);
        if let Some(step) = usual_step(self.steps.make_contiguous())
            && self.metadata.seconds_per_frame.is_none()
        {
            self.metadata.seconds_per_frame = Some(step);
        }
        self.metadata.ended = Some(true);
        self.metadata.ended_by = self.reason.take();
        let described = self
            .write_description()
            .or_else(|error| self.overwrite_description().map_err(|_| error));
        // What could not be written is not tried again.
        self.buffer.clear();
        written.and(synced).and(described)?;
        Ok(self.records)
    }
}

impl Drop for FrameRecorder {
    fn drop(&mut self) {
        if matches!(self.names, Names::Given) && !self.buffer.is_empty() {
            let _ = self.write_out();
        }
    }
}

/// What the description beside an array is to say. To write it takes as long as the disk does, and needs no recorder, to
/// which frames can be added meanwhile:
/// ```text
/// set_view -> DescriptionDraft -> prepare -> take_description -> name_description
/// ```
#[derive(Debug)]
pub(crate) struct DescriptionDraft {
    path: PathBuf,
    metadata: RecordingMetadata,
}

impl DescriptionDraft {
    /// Writes it, on disk but without its name. What lies under that name does not matter yet: the array may get its own
    /// meanwhile, and the description before this one with it.
    ///
    /// # Errors
    /// What the system reports.
    pub(crate) fn prepare(&self) -> Result<FinishedFile, RecorderError> {
        prepared(&self.path, Existing::Replaced, &self.metadata)
    }
}

/// Gives a description its name.
///
/// # Errors
/// What the system reports.
pub(crate) fn name_description(file: FinishedFile) -> Result<(), RecorderError> {
    file.persist().map_err(refused)
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

/// Whether a path ends as the file of an array does.
fn is_array(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("npy"))
}

/// The description beside an array, `touch.json` of `touch.npy`. None where there is none, or what is there is something
/// else.
///
/// # Errors
/// What is wrong with it, or why it cannot be read, headed by its path.
pub fn description_beside(path: &Path) -> Option<Result<RecordingMetadata, String>> {
    if !is_array(path) {
        return None;
    }
    let beside = path.with_extension("json");
    let content = || {
        let mut bytes = Vec::new();
        // To open a pipe would wait for its writer.
        if beside.metadata()?.is_file() {
            let file = File::open(&beside)?;
            file.take(LARGEST_DESCRIPTION).read_to_end(&mut bytes)?;
        }
        Ok::<_, io::Error>(bytes)
    };
    let read = match content() {
        Ok(bytes) => RecordingMetadata::read(&bytes)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return None,
        Err(error) => Err(format!("cannot read: {error}")),
    };
    Some(read.map_err(|error| format!("{}: {error}", beside.display())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::recording::FrameMark;

    #[test]
    fn an_error_of_a_sync_is_not_lost() {
        // Nothing there can be synced.
        let mut syncer = Syncer::new(&File::open("/dev/null").expect("opened"));
        syncer.last = Instant::now().checked_sub(SYNCED).expect("later than that");
        assert!(syncer.tick().is_ok(), "it does not wait");
        assert!(syncer.end().is_err());
    }

    /// The recording gets its names with the first frame, at any time while a description of it is being written.
    #[test]
    fn a_description_is_written_while_the_first_frame_comes() {
        for comes_first in [true, false] {
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("a.npy");
            let metadata = RecordingMetadata::default();
            let recorder = FrameRecorder::create(&path, Existing::Kept, &metadata);
            let mut recorder = recorder.expect("begun");
            let marks = vec![FrameMark {
                number: 7,
                time: None,
            }];
            let draft = recorder.set_view(RecordedView {
                marks: marks.clone(),
                ..RecordedView::default()
            });
            let add = |recorder: &mut FrameRecorder| {
                recorder.add(&Frame::new(1, 1), None).expect("recorded");
            };
            let prepare = || draft.prepare().expect("on the disk");
            let file = if comes_first {
                add(&mut recorder);
                prepare()
            } else {
                let file = prepare();
                add(&mut recorder);
                file
            };
            let file = recorder.take_description(file).expect("to be named");
            name_description(file).expect("named");
            let beside = description_beside(&path).expect("there").expect("read");
            assert_eq!(beside.marks, marks);
        }
    }

    #[test]
    fn a_recorder_that_is_dropped_leaves_its_frames_but_no_end() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let metadata = RecordingMetadata::default();
        let recorder = FrameRecorder::create(&path, Existing::Kept, &metadata);
        let mut recorder = recorder.expect("begun");
        for _ in 0..3 {
            recorder.add(&Frame::new(1, 1), None).expect("recorded");
        }
        drop(recorder);
        let bytes = std::fs::read(&path).expect("there");
        assert_eq!(
            bytes[..],
            [header(Some((1, 1)), 3), bytes[256..].to_vec()].concat()
        );
        assert_eq!(bytes.len(), 256 + 3 * 24);
        let beside = description_beside(&path).expect("there").expect("read");
        assert_eq!(beside.ended, Some(false));
        // Before its first frame, none of it is there.
        let path = folder.path().join("b.npy");
        drop(FrameRecorder::create(&path, Existing::Kept, &metadata));
        assert_eq!(std::fs::read_dir(folder.path()).expect("read").count(), 2);
    }

    #[test]
    fn what_others_have_put_there_is_not_replaced_by_a_later_description() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let metadata = RecordingMetadata::default();
        let recorder = FrameRecorder::create(&path, Existing::Kept, &metadata);
        let mut recorder = recorder.expect("begun");
        let beside = path.with_extension("json");
        std::fs::write(&beside, "mine").expect("written");
        let file = recorder.set_view(RecordedView::default()).prepare();
        let named = recorder.take_description(file.expect("on the disk"));
        assert!(named.is_none(), "it waits for the first frame");
        let added = recorder.add(&Frame::new(1, 1), None);
        assert!(matches!(added, Err(RecorderError::Exists { .. })));
        assert_eq!(std::fs::read_to_string(&beside).expect("read"), "mine");
    }

    #[test]
    fn only_a_description_is_replaced_beside_an_array() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let beside = path.with_extension("json");
        let record = || {
            let metadata = RecordingMetadata::default();
            let mut recorder = FrameRecorder::create(&path, Existing::Replaced, &metadata)?;
            recorder.add(&Frame::new(1, 1), None)
        };
        std::fs::write(&beside, "{\"mine\":1}").expect("written");
        assert!(matches!(record(), Err(RecorderError::Foreign { .. })));
        let kept = std::fs::read_to_string(&beside).expect("read");
        assert_eq!((kept.as_str(), path.exists()), ("{\"mine\":1}", false));
        std::fs::remove_file(&beside).expect("removed");
        for _ in 0..2 {
            record().expect("its own");
        }
    }

    #[test]
    fn a_recording_is_named_as_an_array() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("touch.json");
        let metadata = RecordingMetadata::default();
        let refused = FrameRecorder::create(&path, Existing::Replaced, &metadata);
        assert!(matches!(refused, Err(RecorderError::Ending { .. })));
    }
}
