//! Writes frames to a file that numpy and taxel can open at any moment, even after the program was killed.
//!
//! Beside `touch.npy`, an array of records, is `touch.json`. It states where the frames are from and how they were
//! processed. The old metadata is removed before the new array gets its name, and the new metadata is named last, so
//! neither is ever beside a file of another recording. If another program replaces the array meanwhile, the metadata is
//! left to that program. `touch.json` also states whether the recording was ended, which is false if the program was
//! killed.
//!
//! No file appears or is replaced until the first frame arrives. A disk that is full ends a recording after its last
//! whole record.

mod metadata;
mod record_array;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::{fs, io};

use taxel_core::frame::{Frame, FrameSize};

use crate::formats::file::write_reason;
use crate::formats::recording::{RecordedView, RecordingMetadata};
use crate::storage::{Existing, FileError, NewFile, check_writable};
use metadata::{MetadataDraft, MetadataNotes, is_array, read_beside};
use record_array::{RecordArray, header};

pub use metadata::{MetadataFileError, metadata_beside};

/// A recorder that writes frames to a file, until [`Self::finish`] ends the recording and reports errors.
///
/// If it is dropped before that, it writes out the waiting frames, as far as the system allows, and the metadata
/// does not say that the recording was ended.
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
/// assert_eq!(metadata_beside(&path).unwrap()?.ended, Some(true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct FrameRecorder {
    path: PathBuf,
    existing: Existing,
    notes: MetadataNotes,
    array: Option<RecordArray>,
    left_out: u64,
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
        if !is_array(path) {
            let path = path.to_owned();
            return Err(RecorderError::Ending { path });
        }
        let beside = path.with_extension("json");
        let is_there = existing == Existing::Replaced && beside.symlink_metadata().is_ok();
        if is_there && read_beside(path).is_none() {
            return Err(RecorderError::Foreign { path: beside });
        }
        check_writable(path, existing)?;
        check_writable(&beside, existing)?;
        Ok(Self {
            path: path.to_owned(),
            existing,
            notes: MetadataNotes::new(metadata),
            array: None,
            left_out: 0,
        })
    }

    /// Prepares a recording with the same metadata in another file.
    pub fn elsewhere(&self, path: &Path) -> Result<Self, RecorderError> {
        Self::create(path, self.existing, self.notes.metadata())
    }

    /// Replaces the metadata, also in the file.
    ///
    /// # Errors
    /// The system's error, or [`RecorderError::Replaced`].
    pub fn describe(&mut self, metadata: &RecordingMetadata) -> Result<(), RecorderError> {
        self.notes.describe(metadata);
        let written = self.draft().map_or(Ok(()), MetadataDraft::write);
        self.noted(written)
    }

    /// Replaces threshold, tare and marks. Returns the metadata, for the caller to write; None before the first frame,
    /// with which it is written.
    pub fn set_view(&mut self, view: RecordedView) -> Option<MetadataDraft> {
        self.notes.set_view(view);
        self.draft()
    }

    /// Keeps the message of the first failure for the metadata. Returns the result.
    fn noted<T>(&mut self, result: Result<T, RecorderError>) -> Result<T, RecorderError> {
        if let Err(error) = &result {
            self.note_failure(error);
        }
        result
    }

    /// Keeps the message of a failure for the metadata, if it is the first.
    pub fn note_failure(&mut self, error: &RecorderError) {
        self.notes.note_failure(error);
    }

    /// Keeps the reason why the recording ends early for the metadata, if it is the first.
    pub fn note_reason(&mut self, reason: &str) {
        self.notes.note_reason(reason);
    }

    fn draft(&self) -> Option<MetadataDraft> {
        let array = self.array.as_ref()?;
        Some(MetadataDraft::new(
            &self.path,
            array.id(),
            self.notes.metadata(),
        ))
    }

    /// The number of frames that were recorded.
    pub fn frames(&self) -> u64 {
        self.array.as_ref().map_or(0, RecordArray::records)
    }

    /// The number of frames that were left out because their size is not that of the first one: an array has one size.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// The size of the recorded frames; None before the first one.
    pub fn size(&self) -> Option<FrameSize> {
        self.array.as_ref().map(RecordArray::size)
    }

    /// Records a frame, with its time in seconds. A frame of another size than the first is left out and counted.
    ///
    /// # Errors
    /// If the frame cannot be written, or if the files cannot get their names with the first one.
    pub fn add(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), RecorderError> {
        let added = self.take(frame, time);
        self.noted(added)
    }

    fn take(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), RecorderError> {
        if self.array.is_none() {
            self.array = Some(self.begin(frame.size())?);
        }
        match &mut self.array {
            Some(array) if array.size() == frame.size() => {
                self.notes.note_frame(frame, time);
                let added = array.add(frame, time);
                added.map_err(|error| RecorderError::io(&self.path, error))
            }
            _ => {
                self.left_out += 1;
                Ok(())
            }
        }
    }

    fn begin(&self, size: FrameSize) -> Result<RecordArray, RecorderError> {
        let array = NewFile::with_content(&self.path, &header(size, 0), self.existing)?;
        let beside = self.path.with_extension("json");
        let text = self.notes.metadata().text();
        let metadata = NewFile::with_content(&beside, &text, self.existing)?;
        if self.existing == Existing::Replaced {
            // It belongs to the old array. What cannot be removed is replaced.
            let _ = fs::remove_file(&beside);
        }
        let file = array.persist()?;
        if let Err(error) = metadata.persist() {
            // Another program has taken the name: the array would be beside its file.
            if self.existing == Existing::Kept {
                let _ = fs::remove_file(&self.path);
            }
            return Err(error.into());
        }
        Ok(RecordArray::new(file, size))
    }

    /// Writes out the frames if they have waited too long; to be called now and then.
    ///
    /// # Errors
    /// The system's error.
    pub fn tick(&mut self) -> Result<(), RecorderError> {
        self.write(RecordArray::tick)
    }

    /// Writes out all waiting frames, and waits until they are synced; for a source that pauses, perhaps for ever.
    ///
    /// # Errors
    /// The system's error.
    pub fn flush(&mut self) -> Result<(), RecorderError> {
        self.write(RecordArray::flush)
    }

    fn write(
        &mut self,
        write: impl FnOnce(&mut RecordArray) -> io::Result<()>,
    ) -> Result<(), RecorderError> {
        let written = self.array.as_mut().map_or(Ok(()), write);
        let written = written.map_err(|error| RecorderError::io(&self.path, error));
        self.noted(written)
    }

    /// Writes out everything, syncs the file, and returns the number of frames. Without a frame, no file appears, and
    /// the files that would have been replaced stay as they are.
    ///
    /// # Errors
    /// The system's error. Even then, the records in the file are complete.
    pub fn finish(mut self) -> Result<u64, RecorderError> {
        let written = self.flush();
        self.notes.end();
        let described = self.draft().map_or(Ok(()), MetadataDraft::write);
        let frames = self.frames();
        // Frames that could not be written are not tried again.
        self.array = None;
        written.and(described)?;
        Ok(frames)
    }
}

impl Drop for FrameRecorder {
    fn drop(&mut self) {
        let _ = self.array.as_mut().map(RecordArray::write_out);
    }
}

/// The error for frames that cannot be recorded.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RecorderError {
    /// The system cannot write the file.
    #[error("{}: cannot record: {}", path.display(), write_reason(error))]
    Io {
        /// The file.
        path: PathBuf,
        /// The error that the system reports.
        error: Arc<io::Error>,
    },
    /// The file exists already.
    #[error("{:?} already exists", path.to_string_lossy())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The file beside the array is not the metadata of a recording, so it is not replaced.
    #[error("{} does not belong to a recording: record to another name", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The name of the file does not end like that of an array.
    #[error("{}: expected a file that ends in .npy", path.display())]
    Ending {
        /// The file.
        path: PathBuf,
    },
    /// The file was replaced, moved or removed while frames were recorded in it.
    #[error(
        "{}: replaced, moved or removed while frames were recorded in it; the .json file beside it is left as it is",
        path.display()
    )]
    Replaced {
        /// The path that the file had.
        path: PathBuf,
    },
    /// The file, or the metadata beside it, is the source.
    #[error("{} is the source being watched: record to another file", path.display())]
    IsSource {
        /// The file.
        path: PathBuf,
    },
}

impl RecorderError {
    fn io(path: &Path, error: io::Error) -> Self {
        let (path, error) = (path.to_owned(), Arc::new(error));
        Self::Io { path, error }
    }
}

impl From<FileError> for RecorderError {
    fn from(FileError { path, error, .. }: FileError) -> Self {
        match error.kind() {
            io::ErrorKind::AlreadyExists => Self::Exists { path },
            _ => Self::io(&path, error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::recording::FrameMark;

    pub(super) fn begun(path: &Path) -> FrameRecorder {
        let metadata = RecordingMetadata::default();
        FrameRecorder::create(path, Existing::Kept, &metadata).expect("begun")
    }

    /// The caller writes the metadata on another thread while frames come.
    #[test]
    fn metadata_is_written_with_the_first_frame_or_after_it() {
        for comes_first in [true, false] {
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("a.npy");
            let mut recorder = begun(&path);
            let marks = vec![FrameMark {
                number: 7,
                time: None,
            }];
            let view = RecordedView {
                marks: marks.clone(),
                ..RecordedView::default()
            };
            if comes_first {
                recorder.add(&Frame::default(), None).expect("recorded");
                let draft = recorder.set_view(view).expect("to be written");
                recorder.add(&Frame::default(), None).expect("recorded");
                draft.write().expect("written");
            } else {
                assert!(recorder.set_view(view).is_none());
                recorder.add(&Frame::default(), None).expect("recorded");
            }
            let beside = metadata_beside(&path).expect("there").expect("read");
            assert_eq!(beside.marks, marks);
        }
    }

    /// Another program has replaced the recording, with its metadata.
    #[cfg(unix)]
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
        let files = || {
            [&path, &path.with_extension("json")]
                .map(fs::read)
                .map(Result::ok)
        };
        let before = files();
        let refused = old.describe(&RecordingMetadata::default());
        assert!(
            matches!(refused, Err(RecorderError::Replaced { .. })),
            "{refused:?}"
        );
        let refused = old.finish();
        assert!(
            matches!(refused, Err(RecorderError::Replaced { .. })),
            "{refused:?}"
        );
        assert_eq!(files(), before);
    }

    #[test]
    fn a_recorder_that_is_dropped_leaves_its_frames_but_no_end() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let mut recorder = begun(&path);
        for _ in 0..3 {
            recorder.add(&Frame::default(), None).expect("recorded");
        }
        drop(recorder);
        let bytes = fs::read(&path).expect("there");
        assert_eq!(
            bytes[..],
            [header(FrameSize::SMALLEST, 3), bytes[256..].to_vec()].concat()
        );
        assert_eq!(bytes.len(), 256 + 3 * 24);
        let beside = metadata_beside(&path).expect("there").expect("read");
        assert_eq!(beside.ended, Some(false));
        // Before its first frame, none of its files is there.
        let path = folder.path().join("b.npy");
        drop(begun(&path));
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
            assert!(matches!(added, Err(RecorderError::Exists { .. })));
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
        let record = || {
            let metadata = RecordingMetadata::default();
            let mut recorder = FrameRecorder::create(&path, Existing::Replaced, &metadata)?;
            recorder.add(&Frame::default(), None)
        };
        fs::write(&beside, "{\"mine\":1}").expect("written");
        assert!(matches!(record(), Err(RecorderError::Foreign { .. })));
        let kept = fs::read_to_string(&beside).expect("read");
        assert_eq!((kept.as_str(), path.exists()), ("{\"mine\":1}", false));
        fs::remove_file(&beside).expect("removed");
        for _ in 0..2 {
            record().expect("its own");
        }
    }

    #[test]
    fn the_name_of_a_recording_must_end_like_that_of_an_array() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("touch.json");
        let metadata = RecordingMetadata::default();
        let refused = FrameRecorder::create(&path, Existing::Replaced, &metadata);
        assert!(matches!(refused, Err(RecorderError::Ending { .. })));
    }
}
