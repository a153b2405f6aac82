//! Requests to the live page, and reports from its source.

use std::sync::Arc;

use crate::formats::recording::ChannelInfo;
use crate::formats::stream::StreamCounts;
use crate::formats::value::decimal;
use crate::frame::{Frame, Rule};
use crate::tui::keys::key::Arrow;
use crate::tui::live::named_source::NamedSource;
use crate::tui::live::naming::NamedImprint;
use crate::tui::live::request::WatchRequest;

/// A request by a key or a command.
#[derive(Clone, Debug, PartialEq)]
pub enum LiveMessage {
    /// Opens the page of the last source.
    Open,
    /// Watches the source of the page again: a recording that does not grow from its start, any other source after its
    /// end.
    Again,
    /// Watches a source.
    Watch(Arc<WatchRequest>),
    /// Watches a source that was named at the prompt, if it can be read.
    Source(NamedSource),
    /// Subtracts the median of the last frames up to the shown one.
    Tare,
    /// Removes the tare.
    NoTare,
    /// Moves the threshold up or down.
    Threshold(i8),
    /// Sets a threshold in the sensor's unit.
    AtLeast(Rule),
    /// Converts the threshold to percent of the largest value, or to the sensor's unit.
    Percent,
    /// Freezes the shown frame, or follows the source again.
    Freeze,
    /// Shows the largest value of each cell from now on, or the present values again.
    PeakHold,
    /// Shows the next layer: raw values, tared values or imprint.
    NextLayer,
    /// Shows values as numbers, or in shades.
    Numbers,
    /// Spreads the shades over the range of the shown frame, or over a fixed range.
    OwnRange,
    /// Shows taxels further in a direction, if not all are visible.
    Window(Arrow),
    /// Shows the taxels of the contact again.
    FollowContact,
    /// Begins a recording, or ends it.
    Record,
    /// Marks the shown frame, or removes its mark.
    Mark,
    /// Names imprints by the next model, or by none.
    NameShape,
}

/// A report from the source, from its recording or from the work that names imprints.
#[derive(Clone, Debug, PartialEq)]
pub enum LiveEvent {
    /// Frames or other news can be fetched.
    Waiting,
    /// Everything that has come since the last time.
    Arrived(Arc<FrameBatch>),
    /// A recording has begun in this file.
    Recording(String),
    /// The recording has ended; the file, and the frames in it and not in it.
    Recorded(String, RecordedFrames),
    /// The reason why the recording cannot be begun.
    NotRecorded(String),
    /// The reason why the recording could not be finished.
    NotFinished(String),
    /// The answer of a model about an imprint, with the number of the work that names imprints.
    Named(u64, Box<NamedImprint>),
    /// The number of the work that would name imprints, and the reason why there is no model.
    NotNamed(u64, String),
}

/// New frames, and the state of the source.
#[derive(Clone, Debug, Default)]
pub struct FrameBatch {
    /// The frames, the newest last. Frames without times of their own have the time of their arrival.
    pub frames: Vec<Arc<Frame>>,
    /// The change of the frame after these, which is not confirmed yet.
    pub provisional: ProvisionalChange,
    /// The state of the source.
    pub status: FeedStatus,
}

impl PartialEq for FrameBatch {
    /// Returns true if both are the same object in memory; a batch never changes.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

/// A change of the frame that is shown before it is confirmed. It is a change and not a state, so that a report about
/// something else does not remove the frame from the screen.
#[derive(Clone, Debug, Default)]
pub enum ProvisionalChange {
    /// The frame is as before.
    #[default]
    Unchanged,
    /// There is a new frame, or another one in its place.
    Shown(Arc<Frame>),
    /// There is no frame any more: it was confirmed or withdrawn.
    Gone,
}

/// The state of a source and of the recording of its frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FeedStatus {
    /// Whether frames come, and if not, why.
    pub state: SourceState,
    /// The channel that is watched; None until it is known.
    pub channel: Option<Arc<ChannelInfo>>,
    /// The number of channels; 0 for a stream.
    pub channels: usize,
    /// Whether the source is a file that grows and is read to its present end.
    pub follows: bool,
    /// The number of lost frames: torn, short, long or garbled.
    pub lost: u64,
    /// A sample of the last lost frame, up to 40 characters.
    pub sample: Option<String>,
    /// Why the last lost frame is not a frame, if the format can tell.
    pub reason: Option<String>,
    /// The gaps in which the source was lost and came back.
    pub gaps: SourceGaps,
    /// The number of frames that were dropped because nobody took them and there was no memory for more.
    pub overflowed: u64,
    /// The frames of the recording; None without a recording.
    pub recorded: Option<RecordedFrames>,
    /// The file in which the last frame was recorded, if the program chose its name. It may be another one than at the
    /// beginning, if another program took that name before the first frame came.
    pub recorded_in: Option<String>,
    /// Why the recording ended early.
    pub record_error: Option<String>,
    /// The first oddity found in a recording that is played back, or why a file is read from its start again.
    pub note: Option<String>,
    /// The number of notes so far.
    pub notes: u64,
}

impl FeedStatus {
    /// Replaces the note.
    pub(in crate::tui) fn set_note(&mut self, note: String) {
        self.note = Some(note);
        self.notes += 1;
    }

    /// Takes the counts of lost frames so far.
    pub(in crate::tui) fn note_dropped(&mut self, counts: &StreamCounts) {
        self.lost = counts.dropped;
        self.sample.clone_from(&counts.sample);
        self.reason.clone_from(&counts.reason);
    }
}

/// Gaps between the frames of a source that was lost and came back, such as a connection.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SourceGaps {
    /// The number of gaps.
    pub count: u64,
    /// The total time until the source was back, in seconds.
    pub waited: f64,
    /// The total time between the last frame before each gap and the first one after it, in seconds.
    pub missing: f64,
}

impl SourceGaps {
    /// Returns the gaps that came after the gaps of `before`.
    #[must_use]
    pub fn since(self, before: Self) -> Self {
        Self {
            count: self.count.saturating_sub(before.count),
            waited: self.waited - before.waited,
            missing: self.missing - before.missing,
        }
    }

    /// Returns a sentence about the gaps; None if there are none.
    pub fn sentence(self) -> Option<String> {
        let [waited, missing] = [self.waited, self.missing].map(|seconds| decimal(seconds, 1));
        let gaps = match self.count {
            0 => return None,
            1 => String::new(),
            several => format!(" in {several} gaps"),
        };
        Some(format!(
            "no frames for {missing} s{gaps}, of which the connection was lost for {waited} s"
        ))
    }
}

/// The number of frames that were recorded, and of those that were not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecordedFrames {
    /// The number of frames in the recording.
    pub frames: u64,
    /// The number of frames that were left out because they are of another size.
    pub left_out: u64,
}

/// Whether frames come.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum SourceState {
    /// No frame has come yet.
    #[default]
    Waiting,
    /// Frames come.
    Live,
    /// No frame has come for two seconds or longer, or since the source came back; the likely cause.
    Silent(String),
    /// The source is gone or not there yet, and why; it is tried again each second.
    Lost(String),
    /// The source has come to its end.
    Ended,
    /// The source cannot be read, and why.
    Failed(String),
}

impl SourceState {
    /// Returns true if no frame can come any more. A lost source is tried again, and a followed file may grow.
    pub fn is_final(&self) -> bool {
        matches!(self, Self::Ended | Self::Failed(_))
    }
}
