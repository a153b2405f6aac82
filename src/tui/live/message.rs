//! Requests to the live page, and reports from its source.

use std::sync::Arc;

use crate::formats::recording::ChannelInfo;
use crate::formats::stream::StreamCounts;
use crate::formats::value::decimal;
use crate::frame::Frame;
use crate::tui::keys::key::Arrow;
use crate::tui::live::named_source::NamedSource;
use crate::tui::live::naming::NamedImprint;
use crate::tui::live::request::WatchRequest;

/// What a key or a command asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum LiveMessage {
    /// The page of the last source.
    Open,
    /// To watch a source.
    Watch(Arc<WatchRequest>),
    /// To watch a source that was named at the prompt, if it can be read.
    Source(NamedSource),
    /// To subtract the median of the frames up to the one that is shown.
    Tare,
    /// To take nothing off.
    NoTare,
    /// The threshold up or down.
    Threshold(i8),
    /// A threshold in percent of the largest value, or in the sensor's unit.
    Percent,
    /// To stay at the frame that is shown, or to follow the source again.
    Freeze,
    /// To show the largest value that each cell has had since then, or the present one.
    PeakHold,
    /// The next of raw values, tared values and imprint.
    NextLayer,
    /// Values as numbers, or in shades.
    Numbers,
    /// Shades over the range of the frame that is shown, or over a fixed range.
    OwnRange,
    /// To see taxels further in a direction, where not all are visible.
    Window(Arrow),
    /// To see those of the contact again.
    FollowContact,
    /// To begin a recording, or to end it.
    Record,
    /// To mark the frame that is shown, or to take its mark off.
    Mark,
    /// To name shapes by the next set of shapes, or by none.
    NextModel,
}

/// What the source reports.
#[derive(Clone, Debug, PartialEq)]
pub enum LiveEvent {
    /// There are frames, or something else to report.
    Waiting,
    /// All that has come since the last time.
    Arrived(Arc<FrameBatch>),
    /// A recording has begun in this file.
    Recording(String),
    /// It has ended; the file, and the number of frames in it.
    Recorded(String, u64),
    /// It cannot be begun, and why.
    NotRecorded(String),
    /// It could not be finished, and why.
    NotFinished(String),
    /// What a model says of an imprint; the number of the work that names.
    Named(u64, Box<NamedImprint>),
    /// There is no model, and why; the number of the work that would name.
    NotNamed(u64, String),
}

/// Frames that have come, and how the source is.
#[derive(Clone, Debug, Default)]
pub struct FrameBatch {
    /// The frames, the newest last. Their times are those of their arrival where they have none of their own.
    pub frames: Vec<Arc<Frame>>,
    /// What has become of a frame after these that is not confirmed yet.
    pub provisional: ProvisionalChange,
    /// How the source is.
    pub status: FeedStatus,
}

impl PartialEq for FrameBatch {
    /// Whether they are one: they are never changed.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

/// What has become of a frame that is shown before it is confirmed. A change, not a state: a report that is about something
/// else takes nothing off the screen.
#[derive(Clone, Debug, Default)]
pub enum ProvisionalChange {
    /// It is as before.
    #[default]
    Unchanged,
    /// There is one, or another one.
    Shown(Arc<Frame>),
    /// There is none: it was confirmed or withdrawn.
    Gone,
}

/// How a source is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FeedStatus {
    /// Whether frames come, and if not, why.
    pub state: SourceState,
    /// The channel that is watched, once that is known.
    pub channel: Option<Arc<ChannelInfo>>,
    /// How many channels there are; 0 of a stream.
    pub channels: usize,
    /// Frames that were torn, short, long or garbled.
    pub lost: u64,
    /// What the last of these looked like.
    pub sample: Option<String>,
    /// Why the last of these is not a frame, where the format can tell.
    pub reason: Option<String>,
    /// How often the source was lost and came back.
    pub gaps: SourceGaps,
    /// Frames that came while nobody took them and there was no memory for more.
    pub overflowed: u64,
    /// How many frames are in the recording; None without one.
    pub recorded: Option<RecordedFrames>,
    /// Why the recording has ended early.
    pub record_error: Option<String>,
    /// What is odd in a recording that is played, the first of it.
    pub note: Option<String>,
}

impl FeedStatus {
    /// Notes the frames that were dropped so far.
    pub(in crate::tui) fn note_dropped(&mut self, counts: &StreamCounts) {
        self.lost = counts.dropped;
        self.sample.clone_from(&counts.sample);
        self.reason.clone_from(&counts.reason);
    }
}

/// Gaps between the frames of a source that was lost and came back, such as a connection.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SourceGaps {
    /// How many.
    pub count: u64,
    /// The seconds of all until the source was back.
    pub waited: f64,
    /// The seconds of all between the last frame before and the first one after.
    pub missing: f64,
}

impl SourceGaps {
    /// Those of them that came after others.
    #[must_use]
    pub fn since(self, before: Self) -> Self {
        Self {
            count: self.count.saturating_sub(before.count),
            waited: self.waited - before.waited,
            missing: self.missing - before.missing,
        }
    }

    /// A sentence; None where there are none.
    pub fn sentence(self) -> Option<String> {
        let [waited, missing] = [self.waited, self.missing].map(|seconds| decimal(seconds, 1));
        let lost = match self.count {
            0 => return None,
            1 => format!("for {waited} s"),
            several => format!("{several} times, for {waited} s in all"),
        };
        Some(format!(
            "the connection was lost {lost}; {missing} s of frames are missing"
        ))
    }
}

/// What has become of frames that are recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecordedFrames {
    /// How many are in the recording.
    pub frames: u64,
    /// How many are not, since they are of another size.
    pub left_out: u64,
}

/// Whether frames come.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum SourceState {
    /// None has come yet.
    #[default]
    Waiting,
    /// They come.
    Live,
    /// None for two seconds, and what may be wrong.
    Silent(String),
    /// The source is gone or not there yet, and why; it is tried again each second.
    Lost(String),
    /// It has come to its end.
    Ended,
    /// It cannot be read, and why.
    Failed(String),
}

impl SourceState {
    /// Whether no frame can come any more. A source that is lost is tried again, and a file that is followed may grow.
    pub fn is_final(&self) -> bool {
        matches!(self, Self::Ended | Self::Failed(_))
    }
}
