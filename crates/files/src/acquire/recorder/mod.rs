//! Writes frames to a file that numpy and taxel can open at any moment, even after the program was killed.
//!
//! Beside `touch.npy`, an array of records, is `touch.json`. It states where the frames are from and how they were
//! processed. The two get their names together, so a new file is never paired with an old version of the other one. If
//! another program replaces the array meanwhile, the metadata is left to that program. `touch.json` also states
//! whether the recording was ended, which is false if the program was killed.
//!
//! No file appears or is replaced until the first frame arrives. A disk that is full ends a recording after its last
//! whole record, and the metadata says why.

mod error;

mod syncer;

mod record_array;

mod metadata;

mod naming;

mod notes;

use std::io;
use std::path::{Path, PathBuf};

use error::refused;
use metadata::{MetadataDraft, is_array, overwrite, prepared, read_beside};
use naming::{NamedArray, NamingState};
use notes::MetadataNotes;
use record_array::{RecordArray, empty};

pub use error::{MetadataFileError, RecorderError};
pub use metadata::PreparedMetadata;
pub use metadata::metadata_beside;

use crate::formats::recording::RecordedView;
use crate::formats::recording::RecordingMetadata;
use crate::frame::{Frame, FrameSize};
use crate::storage::{Existing, FinishedFile, UnfinishedFile};

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
    /// The handling of existing files when the recording gets its names.
    existing: Existing,
    /// The metadata, and the notes for it.
    notes: MetadataNotes,
    naming: NamingState,
    array: RecordArray,
    /// The number of frames of another size than the first one.
    left_out: u64,
    /// The error if the files have their names, but their folder could not be synced.
    unsynced: Option<RecorderError>,
}

impl FrameRecorder {
    /// Creates the file, whose name ends in `.npy`, and the `.json` file beside it: both, or neither. They appear
    /// with the first frame; files that they replace stay until then.
    ///
    /// # Errors
    /// Returns an error if the name ends otherwise, if one of the two files exists and must be kept, if the file under
    /// the second name is not metadata, or if they cannot be created.
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
        let notes = MetadataNotes::new(metadata);
        let array = || {
            let mut array = UnfinishedFile::new(path, existing)?;
            array.write(&empty())?;
            Ok((array.handle()?, array.finish()?))
        };
        let (file, array) = array().map_err(refused)?;
        let beside = prepared(path, existing, notes.metadata())?;
        Ok(Self {
            path: path.to_owned(),
            existing,
            notes,
            naming: NamingState::Waiting(array, beside),
            left_out: 0,
            unsynced: None,
            array: RecordArray::new(file),
        })
    }

    /// Creates a recorder with the same metadata for another file.
    ///
    /// # Errors
    /// Returns the errors of [`Self::create`].
    pub fn elsewhere(&self, path: &Path) -> Result<Self, RecorderError> {
        Self::create(path, self.existing, self.notes.metadata())
    }

    /// Writes the metadata beside the file anew.
    ///
    /// # Errors
    /// Returns the system's error, or the reason why the files did not get their names.
    pub fn describe(&mut self, metadata: &RecordingMetadata) -> Result<(), RecorderError> {
        self.notes.describe(metadata);
        let written = self.write_metadata();
        self.noted(written)
    }

    /// Replaces threshold, tare and marks, and returns the metadata with them, for the caller to write.
    pub fn set_view(&mut self, view: RecordedView) -> MetadataDraft {
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

    fn draft(&self) -> MetadataDraft {
        MetadataDraft {
            path: self.path.clone(),
            metadata: self.notes.metadata().clone(),
        }
    }

    /// Takes metadata that is on the disk, to give it its name together with the array. If the array has its
    /// name already, returns the metadata, which is to be given its name at once. Drops metadata that was prepared for
    /// the recorder of another file, which is [`elsewhere`](Self::elsewhere) by now.
    pub fn take_metadata(&mut self, file: FinishedFile) -> Option<PreparedMetadata> {
        if file.path() != self.path.with_extension("json") {
            return None;
        }
        match &mut self.naming {
            NamingState::Waiting(_, beside) => *beside = file.with_existing(self.existing),
            NamingState::Given(array) => {
                let (array, path) = (*array, self.path.clone());
                return Some(PreparedMetadata { file, array, path });
            }
            NamingState::Refused(_) => {}
        }
        None
    }

    fn write_metadata(&mut self) -> Result<(), RecorderError> {
        self.naming.array()?;
        let file = self.draft().prepare()?;
        let file = self.take_metadata(file);
        file.map_or(Ok(()), PreparedMetadata::give_name)
    }

    /// Returns the number of frames that were recorded.
    pub fn frames(&self) -> u64 {
        self.array.records()
    }

    /// Returns the number of frames that were left out because their size is not that of the first one: an array has
    /// one size.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// Returns the size of the recorded frames; None before the first one.
    pub fn size(&self) -> Option<FrameSize> {
        self.array.size()
    }

    /// Records a frame, with its time in seconds. A frame of another size than the first is left out and counted.
    ///
    /// # Errors
    /// Returns an error if the frame cannot be written, or if the files did not get their names with the first frame:
    /// then no later frame is recorded, either.
    pub fn add(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), RecorderError> {
        let added = self.take(frame, time);
        self.noted(added)
    }

    fn take(&mut self, frame: &Frame, time: Option<f64>) -> Result<(), RecorderError> {
        let found = frame.size();
        if self.array.size().is_none() {
            let begun = self.array.begin(found);
            begun.map_err(|error| self.refused(error))?;
        }
        self.give_names()?;
        if self.array.size() != Some(found) {
            self.left_out += 1;
            return Ok(());
        }
        self.notes.note_frame(frame, time);
        let added = self.array.add(frame, time);
        added.map_err(|error| self.refused(error))
    }

    /// Gives the files their names with the first frame. If they have them, but their folder cannot be synced, frames
    /// are recorded all the same, and [`Self::finish`] returns the error.
    ///
    /// # Errors
    /// Returns the reason why the files do not get their names, with each frame.
    fn give_names(&mut self) -> Result<(), RecorderError> {
        if let Some(NamedArray { file, unsynced }) = self.naming.give()? {
            self.array.move_to(file);
            self.unsynced = unsynced;
        }
        Ok(())
    }

    /// Writes out the frames if they have waited too long; to be called now and then.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn tick(&mut self) -> Result<(), RecorderError> {
        let written = self.array.tick();
        let written = written.map_err(|error| self.refused(error));
        self.noted(written)
    }

    /// Writes out all waiting frames, and waits until they are synced; for a source that pauses, perhaps for ever.
    ///
    /// # Errors
    /// Returns the system's error, or the reason why the files did not get their names.
    pub fn flush(&mut self) -> Result<(), RecorderError> {
        if self.naming.array()?.is_none() {
            return Ok(());
        }
        let written = self.array.write_out().and_then(|()| self.array.sync());
        let written = written.map_err(|error| self.refused(error));
        self.noted(written)
    }

    fn refused(&self, error: io::Error) -> RecorderError {
        RecorderError::io(self.path.clone(), error)
    }

    /// Writes out everything, syncs the file, and returns the number of frames. Without a frame, no file appears, and
    /// the files that would have been replaced stay as they are.
    ///
    /// # Errors
    /// Returns the reason why the files did not get their names; there is no recording then. Otherwise returns the
    /// system's error, also if the folder could not be synced when the files got their names. Even then, the records in
    /// the file are complete, and the metadata says why it ends there.
    pub fn finish(mut self) -> Result<u64, RecorderError> {
        if self.naming.array()?.is_none() {
            return Ok(0);
        }
        let written = self.array.write_out();
        let written = written.map_err(|error| self.refused(error));
        let written = self.noted(written);
        let synced = self.array.end();
        let synced = synced.map_err(|error| self.refused(error));
        let synced = self.noted(synced);
        self.notes.end();
        let described = self.write_metadata().or_else(|error| match error {
            RecorderError::Replaced { .. } => Err(error),
            error => overwrite(&self.path, self.notes.metadata()).map_err(|_| error),
        });
        // Frames that could not be written are not tried again.
        self.array.give_up();
        written.and(synced).and(described)?;
        match self.unsynced.take() {
            Some(error) => Err(error),
            None => Ok(self.array.records()),
        }
    }
}

impl Drop for FrameRecorder {
    fn drop(&mut self) {
        if matches!(self.naming, NamingState::Given(_)) && !self.array.is_written_out() {
            let _ = self.array.write_out();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::acquire::recorder::record_array::header;
    use crate::formats::recording::FrameMark;

    pub(super) fn begun(path: &Path) -> FrameRecorder {
        let metadata = RecordingMetadata::default();
        FrameRecorder::create(path, Existing::Kept, &metadata).expect("begun")
    }

    /// The recording gets its names with the first frame, at any time while its metadata is being written.
    #[test]
    fn metadata_is_written_while_the_first_frame_comes() {
        for comes_first in [true, false] {
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("a.npy");
            let mut recorder = begun(&path);
            let marks = vec![FrameMark {
                number: 7,
                time: None,
            }];
            let draft = recorder.set_view(RecordedView {
                marks: marks.clone(),
                ..RecordedView::default()
            });
            let add = |recorder: &mut FrameRecorder| {
                recorder.add(&Frame::default(), None).expect("recorded");
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
            let file = recorder.take_metadata(file).expect("to be named");
            file.give_name().expect("named");
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
                .map(std::fs::read)
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
        let bytes = std::fs::read(&path).expect("there");
        assert_eq!(
            bytes[..],
            [header(Some(FrameSize::SMALLEST), 3), bytes[256..].to_vec()].concat()
        );
        assert_eq!(bytes.len(), 256 + 3 * 24);
        let beside = metadata_beside(&path).expect("there").expect("read");
        assert_eq!(beside.ended, Some(false));
        // Before its first frame, none of its files is there.
        let path = folder.path().join("b.npy");
        drop(begun(&path));
        assert_eq!(std::fs::read_dir(folder.path()).expect("read").count(), 2);
    }

    #[test]
    fn later_metadata_does_not_replace_the_file_of_another_program() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let mut recorder = begun(&path);
        let beside = path.with_extension("json");
        std::fs::write(&beside, "mine").expect("written");
        let file = recorder.set_view(RecordedView::default()).prepare();
        let named = recorder.take_metadata(file.expect("on the disk"));
        assert!(named.is_none(), "it waits for the first frame");
        let added = recorder.add(&Frame::default(), None);
        assert!(matches!(added, Err(RecorderError::Exists { .. })));
        assert_eq!(std::fs::read_to_string(&beside).expect("read"), "mine");
    }

    #[test]
    fn a_recorder_whose_files_did_not_get_their_names_says_so_again_and_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let below = folder.path().join("below");
        std::fs::create_dir(&below).expect("made");
        let names = [folder.path().join("a.npy"), below.join("b.npy")];
        for (path, is_removed) in names.into_iter().zip([false, true]) {
            let mut recorder = begun(&path);
            let spoilt = if is_removed {
                std::fs::remove_dir_all(&below)
            } else {
                std::fs::write(&path, "mine")
            };
            spoilt.expect("spoilt");
            let add = |recorder: &mut FrameRecorder| recorder.add(&Frame::default(), None);
            let first = add(&mut recorder).expect_err("refused").to_string();
            let described = recorder.describe(&RecordingMetadata::default());
            let later = [add(&mut recorder), described, recorder.flush()];
            let finished = recorder.finish().map(drop);
            for result in later.into_iter().chain([finished]) {
                let message = result.expect_err("refused").to_string();
                assert_eq!(message, first, "{}", path.display());
            }
        }
        // Without a frame, there is no reason.
        assert_eq!(
            begun(&folder.path().join("c.npy")).finish().expect("none"),
            0
        );
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
    fn the_name_of_a_recording_must_end_like_that_of_an_array() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("touch.json");
        let metadata = RecordingMetadata::default();
        let refused = FrameRecorder::create(&path, Existing::Replaced, &metadata);
        assert!(matches!(refused, Err(RecorderError::Ending { .. })));
    }
}
