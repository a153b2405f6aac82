//! The metadata of a recording, and what is noted for it while frames come: their numbers, their rate, and the reason of
//! an early end.

use crate::acquire::frame_rate::FrameRate;
use crate::acquire::recorder::error::RecorderError;
use crate::formats::file::system_reason;
use crate::formats::recording::RecordedView;
use crate::formats::recording::RecordingMetadata;
use crate::frame::Frame;

/// The largest number of bursts over which the rate is measured: several minutes.
const MOST_BURSTS: usize = 4096;

/// The metadata of a recording, and the notes for it.
#[derive(Debug)]
pub(super) struct MetadataNotes {
    metadata: RecordingMetadata,
    /// The numbers of the first and the last frame that were recorded. The first is 0 once numbers have started again,
    /// as when a recording is played in a loop.
    numbers: Option<(u64, u64)>,
    /// The message of the first error.
    reason: Option<String>,
    /// The measurement of the rate of frames.
    rate: FrameRate,
    /// Whether frames carry times, so that they are not only those of arrival.
    carries_times: bool,
}

impl MetadataNotes {
    /// Begins the notes for a recording that has not ended yet.
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

    /// Returns the metadata as it is to be written now.
    pub(super) fn metadata(&self) -> &RecordingMetadata {
        &self.metadata
    }

    /// Replaces the metadata; the recording has not ended yet.
    pub(super) fn describe(&mut self, metadata: &RecordingMetadata) {
        self.metadata.clone_from(metadata);
        self.metadata.ended = Some(false);
    }

    /// Replaces threshold, tare and marks.
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

    /// Notes the number and the time of a frame that is recorded.
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

    /// Keeps the message of a failure, if it is the first.
    pub(super) fn note_failure(&mut self, error: &RecorderError) {
        match error {
            RecorderError::Io { error, .. } => self.note_reason(&system_reason(error)),
            error => self.note_reason(&error.to_string()),
        }
    }

    /// Keeps the reason why the recording ends early, if it is the first.
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
    use crate::acquire::recorder::tests::begun;
    use crate::acquire::recorder::{FrameRecorder, metadata_beside};
    use crate::formats::recording::FrameMark;
    use crate::storage::Existing;

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
