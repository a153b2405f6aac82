//! The metadata beside an array, `touch.json` for `touch.npy`, and what is noted for it while frames come: their numbers,
//! their rate, and the reason of an early end.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use taxel_core::frame::Frame;

use crate::acquire::clocks::FrameRate;
use crate::acquire::recorder::RecorderError;
use crate::acquire::recorder::record_array::{HEADER, is_own};
use crate::formats::file::{has_ending, system_reason};
use crate::formats::recording::{MetadataError, RecordedView, RecordingMetadata};
use crate::storage::{self, Existing, FileId};

const LARGEST_METADATA: u64 = 1 << 22;

/// The largest number of bursts over which the rate is measured: several minutes.
const MOST_BURSTS: usize = 4096;

/// Metadata that is to be written beside an array. Writing it takes as long as the disk does, and needs no recorder:
/// meanwhile, frames can be added.
#[derive(Debug)]
pub struct MetadataDraft {
    /// The path of the array, and its identity; None if it is not known.
    path: PathBuf,
    array: Option<FileId>,
    metadata: RecordingMetadata,
}

impl MetadataDraft {
    pub(super) fn new(path: &Path, array: Option<FileId>, metadata: &RecordingMetadata) -> Self {
        Self {
            path: path.to_owned(),
            array,
            metadata: metadata.clone(),
        }
    }

    /// Writes the metadata, unless the name of the array now belongs to another file, which it does not describe.
    pub fn write(self) -> Result<(), RecorderError> {
        let Self {
            path,
            array,
            metadata,
        } = self;
        if !array.is_none_or(|array| array.is_at(&path)) {
            return Err(RecorderError::Replaced { path });
        }
        let beside = path.with_extension("json");
        let text = metadata.text();
        Ok(storage::write(&beside, &text, Existing::Replaced)?)
    }
}

pub(super) fn is_array(path: &Path) -> bool {
    has_ending(path, "npy")
}

/// Reads the metadata beside an array: `touch.json` for `touch.npy`. Returns None if an array of another program has no
/// metadata beside it.
///
/// # Errors
/// If the metadata is damaged, of another version or cannot be read; or if there is none although
/// taxel has recorded the array.
pub fn metadata_beside(path: &Path) -> Option<Result<RecordingMetadata, MetadataFileError>> {
    if !is_array(path) {
        return None;
    }
    read_beside(path).or_else(|| {
        if !is_recorded(path) {
            return None;
        }
        let path = path.with_extension("json");
        Some(Err(if path.exists() {
            MetadataFileError::Foreign { path }
        } else {
            MetadataFileError::Missing { path }
        }))
    })
}

fn is_recorded(path: &Path) -> bool {
    let start = || {
        let mut start = Vec::new();
        // Opening a pipe would wait for its writer.
        if path.metadata()?.is_file() {
            File::open(path)?.take(HEADER).read_to_end(&mut start)?;
        }
        Ok::<_, io::Error>(start)
    };
    start().is_ok_and(|start| is_own(&start))
}

/// Reads the metadata beside an array. Returns None if there is no such file, or if it is not metadata.
pub(super) fn read_beside(path: &Path) -> Option<Result<RecordingMetadata, MetadataFileError>> {
    let path = path.with_extension("json");
    let content = || {
        let mut bytes = Vec::new();
        // Opening a pipe would wait for its writer.
        if path.metadata()?.is_file() {
            let file = File::open(&path)?;
            file.take(LARGEST_METADATA + 1).read_to_end(&mut bytes)?;
        }
        Ok::<_, io::Error>(bytes)
    };
    match content() {
        Ok(bytes) => {
            let read = RecordingMetadata::read(&bytes)?;
            if bytes.len() as u64 > LARGEST_METADATA {
                return Some(Err(MetadataFileError::Large { path }));
            }
            Some(read.map_err(|error| MetadataFileError::Broken { path, error }))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => Some(Err(MetadataFileError::Io { path, error })),
    }
}

const UNKNOWN: &str = "the recording's threshold and tare are unknown";

/// The error for metadata beside an array that is missing or cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum MetadataFileError {
    /// The system cannot read the file.
    #[error("{}: cannot read: {}; {UNKNOWN}", path.display(), system_reason(error))]
    Io {
        /// The file.
        path: PathBuf,
        /// The error that the system reports.
        error: io::Error,
    },
    /// The metadata is larger than 4 MiB, and was not read.
    #[error("{}: larger than 4 MiB, the limit for metadata; {UNKNOWN}", path.display())]
    Large {
        /// The file.
        path: PathBuf,
    },
    /// The metadata is damaged, of another version, or was changed.
    #[error("{}: {error}; {UNKNOWN}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// The error in the metadata.
        error: MetadataError,
    },
    /// The array was recorded by taxel, but has no metadata beside it.
    #[error("{}: missing; {UNKNOWN}", path.display())]
    Missing {
        /// The path of the metadata.
        path: PathBuf,
    },
    /// The array was recorded by taxel, but the file beside it is empty or something other than metadata.
    #[error("{}: empty or not written by taxel; {UNKNOWN}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
}

#[derive(Debug)]
pub(super) struct MetadataNotes {
    metadata: RecordingMetadata,
    /// The numbers of the first and the last frame that were recorded. The first is 0 once numbers have started again,
    /// as when a recording is played in a loop.
    numbers: Option<(u64, u64)>,
    reason: Option<String>,
    rate: FrameRate,
    /// Whether frames carry times, so that they are not only those of arrival.
    carries_times: bool,
}

impl MetadataNotes {
    pub(super) fn new(metadata: &RecordingMetadata) -> Self {
        let mut metadata = metadata.clone();
        metadata.ended = Some(false);
        Self {
            metadata,
            numbers: None,
            reason: None,
            rate: FrameRate::over(MOST_BURSTS),
            carries_times: false,
        }
    }

    pub(super) fn metadata(&self) -> &RecordingMetadata {
        &self.metadata
    }

    /// Replaces the metadata; the recording has not ended yet.
    pub(super) fn describe(&mut self, metadata: &RecordingMetadata) {
        self.metadata.clone_from(metadata);
        self.metadata.ended = Some(false);
    }

    pub(super) fn set_view(&mut self, view: RecordedView) {
        let RecordedView { rule, tare, marks } = view;
        (self.metadata.rule, self.metadata.tare, self.metadata.marks) = (rule, tare, marks);
        self.leave_out_marks();
    }

    /// Drops the marks of frames before the first recorded one.
    fn leave_out_marks(&mut self) {
        if let Some((first, _)) = self.numbers {
            self.metadata.marks.retain(|mark| mark.number >= first);
        }
    }

    pub(super) fn note_frame(&mut self, frame: &Frame, time: Option<f64>) {
        if let Some(time) = time {
            self.rate.add(time);
            self.carries_times |= frame.time.is_some();
        }
        let (first, last) = self.numbers.unwrap_or((frame.number, frame.number));
        let first = if frame.number < last { 0 } else { first };
        let is_first = self.numbers.replace((first, frame.number)).is_none();
        if is_first {
            self.leave_out_marks();
        }
    }

    pub(super) fn note_failure(&mut self, error: &RecorderError) {
        match error {
            RecorderError::Io { error, .. } => self.note_reason(&system_reason(error)),
            error => self.note_reason(&error.to_string()),
        }
    }

    pub(super) fn note_reason(&mut self, reason: &str) {
        self.reason.get_or_insert_with(|| reason.to_owned());
    }

    /// Completes the metadata at the end of the recording: the time of a frame, unless the source has stated it, and
    /// the reason of an early end.
    pub(super) fn end(&mut self) {
        let stated = self.metadata.seconds_per_frame;
        self.metadata.seconds_per_frame = stated.or_else(|| {
            if self.carries_times {
                self.rate.even_seconds_per_frame()
            } else {
                self.rate.seconds_per_frame()
            }
        });
        self.metadata.ended = Some(true);
        self.metadata.ended_by = self.reason.take();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::acquire::recorder::FrameRecorder;
    use crate::acquire::recorder::tests::begun;
    use crate::formats::recording::FrameMark;

    #[test]
    fn metadata_that_is_too_large_is_not_called_damaged() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let text = RecordingMetadata::default().text();
        for (size, is_read) in [(1 << 22, true), ((1 << 22) + 1, false)] {
            let blanks = vec![b' '; size - text.len()];
            let written = [&blanks[..], &text].concat();
            std::fs::write(path.with_extension("json"), written).expect("written");
            match metadata_beside(&path).expect("there") {
                Ok(_) => assert!(is_read),
                Err(error) => {
                    let message = error.to_string();
                    assert!(
                        !is_read && message.contains("larger than 4 MiB"),
                        "{message}"
                    );
                }
            }
        }
    }

    #[test]
    fn marks_of_frames_that_are_not_recorded_are_left_out() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let mut recorder = begun(&path);
        let mark = |number| FrameMark { number, time: None };
        let view = |numbers: &[u64]| RecordedView {
            marks: numbers.iter().copied().map(mark).collect(),
            ..RecordedView::default()
        };
        recorder.set_view(view(&[3]));
        for number in [5, 6] {
            let mut frame = Frame::default();
            frame.number = number;
            recorder.add(&frame, None).expect("recorded");
        }
        recorder.set_view(view(&[4, 5, 6]));
        recorder.finish().expect("finished");
        let beside = metadata_beside(&path).expect("there").expect("read");
        assert_eq!(beside.marks, [mark(5), mark(6)]);
    }

    #[test]
    fn marks_of_frames_whose_numbers_begin_again_are_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let mut recorder = begun(&path);
        for number in [5, 6, 0, 1] {
            let mut frame = Frame::default();
            frame.number = number;
            recorder.add(&frame, None).expect("recorded");
        }
        let marks = vec![FrameMark {
            number: 1,
            time: None,
        }];
        recorder.set_view(RecordedView {
            marks: marks.clone(),
            ..RecordedView::default()
        });
        recorder.finish().expect("finished");
        let beside = metadata_beside(&path).expect("there").expect("read");
        assert_eq!(beside.marks, marks);
    }

    #[test]
    fn the_time_of_a_frame_is_measured_unless_the_source_states_it() {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, stated, expected) in [("a.npy", None, 0.25), ("b.npy", Some(0.2), 0.2)] {
            let path = folder.path().join(name);
            let metadata = RecordingMetadata {
                seconds_per_frame: stated,
                ..RecordingMetadata::default()
            };
            let recorder = FrameRecorder::create(&path, Existing::Kept, &metadata);
            let mut recorder = recorder.expect("begun");
            for time in [0.0, 0.25, 0.5, 0.75] {
                let added = recorder.add(&Frame::default(), Some(time));
                added.expect("recorded");
            }
            recorder.finish().expect("finished");
            let beside = metadata_beside(&path).expect("there").expect("read");
            assert_eq!(beside.seconds_per_frame, Some(expected));
        }
    }

    #[test]
    fn times_that_the_source_gives_have_a_step_only_if_they_are_even() {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, times, expected) in [
            ("a.npy", [0.0, 0.25, 0.5, 0.75], Some(0.25)),
            ("b.npy", [0.0, 0.1, 5.0, 5.2], None),
        ] {
            let path = folder.path().join(name);
            let mut recorder = begun(&path);
            for time in times.map(Some) {
                let mut frame = Frame::default();
                frame.time = time;
                recorder.add(&frame, time).expect("recorded");
            }
            recorder.finish().expect("finished");
            let beside = metadata_beside(&path).expect("there").expect("read");
            assert_eq!(beside.seconds_per_frame, expected);
        }
    }
}
