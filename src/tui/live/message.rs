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

#[derive(Clone, Debug, PartialEq)]
pub enum LiveMessage {
    Open,
    /// Watches the source of the page again: a recording that does not grow from its start, any other source after its
    /// end.
    Again,
    Watch(Arc<WatchRequest>),
    Source(NamedSource),
    Tare,
    NoTare,
    Threshold(i8),
    AtLeast(Rule),
    Percent,
    Freeze,
    PeakHold,
    /// Shows the next layer: raw values, tared values or imprint.
    NextLayer,
    Numbers,
    OwnRange,
    Window(Arrow),
    FollowContact,
    Record,
    Mark,
    NameShape,
}

#[derive(Clone, Debug, PartialEq)]
pub enum LiveEvent {
    Waiting,
    /// Everything that has come since the last time.
    Arrived(Arc<FrameBatch>),
    Recording(String),
    /// The recording has ended; the file, and the frames in it and not in it.
    Recorded(String, RecordedFrames),
    /// The reason why the recording cannot be begun.
    NotRecorded(String),
    NotFinished(String),
    Named(u64, Box<NamedImprint>),
    /// The number of the work that would name imprints, and the reason why there is no model.
    NotNamed(u64, String),
}

#[derive(Clone, Debug, Default)]
pub struct FrameBatch {
    pub frames: Vec<Arc<Frame>>,
    /// The change of the frame after these, which is not confirmed yet.
    pub provisional: ProvisionalChange,
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
    #[default]
    Unchanged,
    Shown(Arc<Frame>),
    /// There is no frame any more: it was confirmed or withdrawn.
    Gone,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct FeedStatus {
    pub state: SourceState,
    /// The channel that is watched; None until it is known.
    pub channel: Option<Arc<ChannelInfo>>,
    /// The number of channels; 0 for a stream.
    pub channels: usize,
    pub follows: bool,
    /// The number of lost frames: torn, short, long or garbled.
    pub lost: u64,
    pub sample: Option<String>,
    pub reason: Option<String>,
    pub gaps: SourceGaps,
    /// The number of frames that were dropped because nobody took them and there was no memory for more.
    pub overflowed: u64,
    /// The frames of the recording; None without a recording.
    pub recorded: Option<RecordedFrames>,
    pub recorded_in: Option<String>,
    pub record_error: Option<String>,
    pub note: Option<String>,
    /// The number of notes so far.
    pub notes: u64,
}

impl FeedStatus {
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

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SourceGaps {
    pub count: u64,
    /// The total time until the source was back, in seconds.
    pub waited: f64,
    /// The total time between the last frame before each gap and the first one after it, in seconds.
    pub missing: f64,
}

impl SourceGaps {
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

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecordedFrames {
    pub frames: u64,
    /// The number of frames that were left out because they are of another size.
    pub left_out: u64,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum SourceState {
    #[default]
    Waiting,
    Live,
    /// No frame has come for two seconds or longer, or since the source came back; the likely cause.
    Silent(String),
    /// The source is gone or not there yet, and why; it is tried again each second.
    Lost(String),
    Ended,
    /// The source cannot be read, and why.
    Failed(String),
}

impl SourceState {
    pub fn is_final(&self) -> bool {
        matches!(self, Self::Ended | Self::Failed(_))
    }
}
