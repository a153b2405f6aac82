//! The frames and the state of a source that the screen takes next.

use std::io;
use std::mem::take;
use std::sync::Arc;
use std::time::Duration;

use crate::acquire::AcquireEvent;
use crate::formats::recording::{ChannelChoice, ChannelInfo};
use crate::formats::stream::StreamCounts;
use crate::frame::Frame;
use crate::tui::live::history::bytes_of;
use crate::tui::live::message::{
    FeedStatus, FrameBatch, ProvisionalChange, RecordedFrames, SourceState,
};

/// The frames and the state that the screen takes next. They are swapped out under a short lock, so that the source
/// hardly waits.
#[derive(Debug, Default)]
pub(super) struct Pending {
    batch: FrameBatch,
    bytes: usize,
    is_new: bool,
    /// The channels so far, and the one that is watched.
    channels: ChannelChoice,
    begun: bool,
    no_frame_reason: Option<String>,
    last_time: Option<f64>,
    /// The time for which the source has been lost since that frame; None if it was not lost.
    gap: Option<Duration>,
}

impl Pending {
    pub(super) fn new(channel: Option<&str>) -> Self {
        Self {
            channels: ChannelChoice::new(channel),
            ..Self::default()
        }
    }

    /// Returns the state of the source, to change it.
    pub(super) fn status(&mut self) -> &mut FeedStatus {
        &mut self.batch.status
    }

    pub(super) fn is_new(&self) -> bool {
        self.is_new
    }

    pub(super) fn set_new(&mut self) -> bool {
        !std::mem::replace(&mut self.is_new, true)
    }

    /// Takes the frames and the state; None if nothing is new.
    pub(super) fn take(&mut self) -> Option<FrameBatch> {
        if !take(&mut self.is_new) {
            return None;
        }
        self.bytes = 0;
        Some(FrameBatch {
            frames: take(&mut self.batch.frames),
            provisional: take(&mut self.batch.provisional),
            status: self.batch.status.clone(),
        })
    }

    pub(super) fn watches(&self, channel: usize) -> bool {
        self.channels.takes(channel)
    }

    pub(super) fn add_channel(&mut self, info: &ChannelInfo) {
        if self.channels.add(info) {
            self.batch.status.channel = Some(Arc::new(info.clone()));
        }
        self.batch.status.channels = self.channels.names().len();
    }

    /// Notes a change of the frame that is not confirmed yet.
    pub(super) fn change_provisional(&mut self, change: ProvisionalChange) {
        self.batch.provisional = change;
    }

    pub(super) fn lose(&mut self, error: &io::Error) {
        self.gap.get_or_insert_default();
        self.batch.status.state = SourceState::Lost(AcquireEvent::lost(error));
    }

    pub(super) fn back_after(&mut self, time: Duration) {
        self.batch.status.state = match &mut self.gap {
            None => SourceState::Waiting,
            Some(gap) => {
                *gap += time;
                let back = AcquireEvent::back_after(*gap);
                SourceState::Silent(format!("{back}; no frame yet"))
            }
        };
    }

    pub(super) fn end_stream(&mut self, counts: &StreamCounts, no_frame_reason: Option<String>) {
        self.batch.status.note_dropped(counts);
        self.no_frame_reason = no_frame_reason;
    }

    /// Notes the end of the source. One from which no frame came was not what the user expected: the state is the
    /// reason.
    pub(super) fn end(&mut self) {
        self.batch.status.state = if self.begun {
            SourceState::Ended
        } else {
            let reason = self.channels.missing().or(self.no_frame_reason.take());
            SourceState::Failed(reason.unwrap_or_else(|| "no frames".to_owned()))
        };
    }

    /// Adds a frame. If nobody takes the frames and they exceed `most` bytes, the older half is dropped.
    /// Half of them go at once, so that a full buffer does not move all frames for each new one. At least one stays.
    pub(super) fn push(&mut self, frame: Arc<Frame>, most: usize) {
        self.begun = true;
        self.note_time(frame.time);
        self.batch.status.state = SourceState::Live;
        self.batch.provisional = ProvisionalChange::Gone;
        self.bytes += bytes_of(&frame);
        self.batch.frames.push(frame);
        if self.bytes > most && self.batch.frames.len() > 1 {
            let half = self.batch.frames.len() / 2;
            let dropped = self.batch.frames.drain(..half);
            self.bytes -= dropped.map(|frame| bytes_of(&frame)).sum::<usize>();
            self.batch.status.overflowed += half as u64;
        }
    }

    pub(super) fn note_recorded(&mut self, recorded: Result<Option<RecordedFrames>, String>) {
        match recorded {
            Ok(recorded) => self.batch.status.recorded = recorded,
            Err(error) => {
                self.batch.status.recorded = None;
                self.batch.status.record_error = Some(error);
            }
        }
    }

    fn note_time(&mut self, time: Option<f64>) {
        let before = std::mem::replace(&mut self.last_time, time);
        if let (Some(gap), Some((before, now))) = (self.gap.take(), before.zip(time)) {
            let gaps = &mut self.batch.status.gaps;
            gaps.count += 1;
            gaps.waited += gap.as_secs_f64();
            gaps.missing += now - before;
        }
    }
}
