//! The frames of a source that the screen has not taken yet, and their recording.
//!
//! ```text
//! acquire -> take_in -> Recording: every frame
//!                    -> Pending: frames, bounded in bytes, and how the source is -> take -> FrameBatch
//! ```
//! The thread that reads the source adds frames, and the screen's thread takes them; neither waits long for the other.

use std::io;
use std::mem::take;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use taxel_core::frame::Frame;
use taxel_core::lock::locked;
use taxel_files::acquire::{AcquireEvent, AcquireOptions, FrameSource, Playback, acquire};
use taxel_files::formats::file::system_reason;
use taxel_files::formats::recording::{
    ChannelChoice, ChannelInfo, RecordingMetadata, StreamCounts,
};
use taxel_files::storage::Existing;

use crate::tui::live::history::bytes_of;
use crate::tui::live::message::{
    FeedStatus, FrameBatch, ProvisionalChange, RecordedFrames, SourceState, WatchRequest,
};
use crate::tui::runtime::frames::recording::Recording;
use crate::tui::runtime::frames::source;
use crate::tui::runtime::work::execution::caught;

#[derive(Debug, Default)]
pub(in crate::tui::runtime) struct FrameFeed {
    /// Locked while frames are added or taken, never while a file is written.
    pending: Mutex<Pending>,
    /// The recording. Its lock is held only briefly, so a slow disk holds up the source and nothing else.
    recording: Mutex<Option<Arc<Recording>>>,
}

impl FrameFeed {
    pub(in crate::tui::runtime) fn of(request: &WatchRequest) -> Self {
        Self {
            pending: Mutex::new(Pending::new(request.options.channel.as_deref())),
            recording: Mutex::default(),
        }
    }

    pub(in crate::tui::runtime) fn recording(&self) -> Option<Arc<Recording>> {
        locked(&self.recording).clone()
    }

    pub(in crate::tui::runtime) fn begin(
        &self,
        recording: Arc<Recording>,
    ) -> Option<Arc<Recording>> {
        locked(&self.recording).replace(recording)
    }

    pub(in crate::tui::runtime) fn note_begun(&self) {
        let mut pending = locked(&self.pending);
        pending.status().record_error = None;
        pending.status().recorded_in = None;
        pending.note_recorded(Ok(Some(RecordedFrames::default())));
    }

    pub(in crate::tui::runtime) fn go_on_with(&self, recording: Option<Arc<Recording>>) {
        *locked(&self.recording) = recording;
        let recorded = self.recorded(Recording::tick);
        locked(&self.pending).note_recorded(recorded);
    }

    pub(in crate::tui::runtime) fn end(&self) -> Option<Arc<Recording>> {
        let recording = locked(&self.recording).take()?;
        locked(&self.pending).note_recorded(Ok(None));
        Some(recording)
    }

    /// Notes that the source cannot be read, and why.
    pub(in crate::tui::runtime) fn fail(&self, reason: String) {
        self.change(|pending| pending.status().state = SourceState::Failed(reason));
    }

    pub(in crate::tui::runtime) fn has_new(&self) -> bool {
        locked(&self.pending).is_new
    }

    fn recorded(
        &self,
        write: impl FnOnce(&Recording) -> Result<Option<RecordedFrames>, String>,
    ) -> Result<Option<RecordedFrames>, String> {
        let recording = self.recording();
        recording.map_or(Ok(None), |recording| write(&recording))
    }

    pub(in crate::tui::runtime) fn begin_recording(
        &self,
        request: &WatchRequest,
        existing: Option<Existing>,
    ) -> Result<(), String> {
        let (Some(recording), Some(existing)) = (self.recording(), existing) else {
            return Ok(());
        };
        let metadata = RecordingMetadata {
            source: request.source.name(),
            rule: request.pipeline.rule(),
            ..RecordingMetadata::default()
        };
        source::found(&request.source)
            .refuse_as_target(&recording.path())
            .map_err(|error| error.to_string())?;
        recording.begin(existing, &metadata)?;
        self.note_begun();
        Ok(())
    }

    /// Reads a source to its end; a panic counts as an error of the source. `fresh` is called when there is something
    /// to take and there was nothing before.
    pub(in crate::tui::runtime) fn run(
        &self,
        source: &FrameSource,
        request: &WatchRequest,
        options: &AcquireOptions,
        stop: &AtomicBool,
        fresh: &mut dyn FnMut(&Self) -> ControlFlow<()>,
    ) {
        let mut wanted = ControlFlow::Continue(());
        let mut consumer = |event: AcquireEvent<'_>| {
            let is_time = matches!(event, AcquireEvent::Tick(_) | AcquireEvent::Silent { .. });
            // A script has no clock: the time between its frames is its own, not a silence of the source.
            if is_time && options.playback == Playback::Once {
                return ControlFlow::Continue(());
            }
            if self.take_in(event, request) {
                wanted = fresh(self);
            }
            wanted
        };
        let ended = caught(|| acquire(source, options, stop, &mut consumer));
        let ended = ended.and_then(|ended| ended.map_err(|error| source::reason(source, &error)));
        if wanted.is_break() {
            return;
        }
        let is_fresh = self.change(|pending| match ended {
            Ok(()) if stop.load(Ordering::Relaxed) => pending.status().state = SourceState::Ended,
            Ok(()) => pending.end(),
            Err(reason) => pending.status().state = SourceState::Failed(reason),
        });
        if is_fresh {
            let _ = fresh(self);
        }
        // Nothing comes any more that would make the recording write its rest, and the page may stay open for long.
        // This is done after the end of the source is shown, because a disk may hang.
        let written = self.recorded(Recording::flush);
        if written.is_err() && self.change(|pending| pending.note_recorded(written)) {
            let _ = fresh(self);
        }
    }

    /// Changes the state that is to be taken. Returns true if there was nothing to take before.
    fn change(&self, change: impl FnOnce(&mut Pending)) -> bool {
        let mut pending = locked(&self.pending);
        change(&mut pending);
        pending.set_new()
    }

    /// Takes the pending frames and state; None if nothing is new.
    pub(in crate::tui::runtime) fn take(&self) -> Option<FrameBatch> {
        locked(&self.pending).take()
    }

    /// Records a frame of the channel that is watched, and shows it. Returns whether the screen must be woken.
    fn take_frame(&self, frame: &Frame, time: Option<f64>, request: &WatchRequest) -> bool {
        if !locked(&self.pending).watches(frame.channel) {
            return false;
        }
        // An error ends the recording; the frames are still shown.
        let recorded = self.recorded(|own| own.add(frame, time));
        let name = self
            .recording()
            .and_then(|recording| recording.chosen_name());
        let mut own = frame.clone();
        own.time = time;
        self.change(|pending| {
            pending.note_recorded(recorded);
            pending.status().recorded_in = name;
            pending.push(Arc::new(own), request.history_bytes);
        })
    }

    fn take_in(&self, event: AcquireEvent<'_>, request: &WatchRequest) -> bool {
        match event {
            AcquireEvent::Channel(info) => self.change(|pending| pending.add_channel(info)),
            AcquireEvent::Frame { frame, time } => self.take_frame(frame, time, request),
            AcquireEvent::Provisional(frame) => {
                let shown = ProvisionalChange::Shown(Arc::new(frame.clone()));
                self.change(|pending| pending.change_provisional(shown))
            }
            AcquireEvent::Withdrawn => {
                self.change(|pending| pending.change_provisional(ProvisionalChange::Gone))
            }
            AcquireEvent::Tick(counts) => {
                let written = self.recorded(Recording::tick);
                let mut pending = locked(&self.pending);
                let is_new = pending.status().lost != counts.dropped || written.is_err();
                pending.status().note_dropped(counts);
                pending.note_recorded(written);
                is_new && pending.set_new()
            }
            AcquireEvent::Silent { counts, reason } => self.change(|pending| {
                let why = source::silence(&source::found(&request.source), counts, reason);
                pending.status().state = SourceState::Silent(why);
            }),
            AcquireEvent::Absent(error) => self.change(|pending| {
                let name = request.source.name();
                let reason = system_reason(error);
                let text = format!("waiting for {name}, trying again each second: {reason}");
                pending.status().state = SourceState::Lost(text);
            }),
            AcquireEvent::Lost(error) => self.change(|pending| pending.lose(error)),
            AcquireEvent::Note(note) if note.is_plain() => false,
            AcquireEvent::Note(note) => self.change(|pending| {
                if pending.status().note.is_none() {
                    pending.status().set_note(note.to_string());
                }
            }),
            AcquireEvent::Back { gap } => self.change(|pending| pending.back_after(gap)),
            AcquireEvent::Follows => self.change(|pending| pending.status().follows = true),
            AcquireEvent::Anew(how) => self.change(|pending| {
                // A note rather than a state: the next frame would replace a state at once.
                pending.status().set_note(format!("the file {how}"));
            }),
            AcquireEvent::Ended(counts) => self.change(|pending| {
                pending.end_stream(counts, source::reason_at_end(counts));
            }),
        }
    }
}

/// The frames and the state that the screen takes next. They are swapped out under a short lock, so that the source
/// hardly waits.
#[derive(Debug, Default)]
pub(super) struct Pending {
    batch: FrameBatch,
    bytes: usize,
    pub(super) is_new: bool,
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

#[cfg(test)]
mod tests {
    use taxel_core::frame::FrameSize;
    use taxel_files::formats::recording::{ChannelInfo, StreamCounts};

    use super::*;
    use crate::tui::live::state::Live;

    fn after(page: &mut Live, feed: &FrameFeed, event: AcquireEvent<'_>) -> Option<u64> {
        feed.take_in(event, &WatchRequest::new("none"));
        if let Some(batch) = feed.take() {
            page.take(&batch);
        }
        page.reading.as_ref().map(|reading| reading.frame.number)
    }

    #[test]
    fn a_provisional_frame_is_shown_until_it_is_withdrawn() {
        let feed = FrameFeed::default();
        let mut page = Live::new(Arc::new(WatchRequest::new("none")), 7);
        let mut frame = Frame::new(FrameSize::new(2, 2).expect("an allowed size"));
        let mut counts = StreamCounts::default();
        let shown = after(&mut page, &feed, AcquireEvent::Provisional(&frame));
        assert_eq!(shown, Some(0));
        // The tick counts frames that were lost before it.
        counts.dropped = 3;
        let shown = after(&mut page, &feed, AcquireEvent::Tick(&counts));
        assert_eq!((shown, page.status.lost), (Some(0), 3));
        let shown = after(&mut page, &feed, AcquireEvent::Withdrawn);
        assert_eq!(shown, None, "there is no other frame");
        let time = None;
        let whole = AcquireEvent::Frame {
            frame: &frame.clone(),
            time,
        };
        assert_eq!(after(&mut page, &feed, whole), Some(0));
        frame.number = 1;
        let shown = after(&mut page, &feed, AcquireEvent::Provisional(&frame));
        assert_eq!(shown, Some(1));
        let shown = after(&mut page, &feed, AcquireEvent::Withdrawn);
        assert_eq!(shown, Some(0));
    }

    #[test]
    fn the_gap_of_a_lost_connection_is_reported_with_the_first_frame_after_it() {
        let feed = FrameFeed::default();
        let mut page = Live::new(Arc::new(WatchRequest::new("none")), 7);
        let (frame, gap) = (
            Frame::new(FrameSize::new(2, 2).expect("an allowed size")),
            Duration::from_secs(2),
        );
        let at = |time| AcquireEvent::Frame {
            frame: &frame,
            time: Some(time),
        };
        let error = io::Error::other("cut");
        // The source was waited for before it was there at all: nothing is missing.
        for event in [
            AcquireEvent::Absent(&error),
            AcquireEvent::Back { gap },
            at(0.0),
        ] {
            after(&mut page, &feed, event);
        }
        assert_eq!(page.trouble(), None);
        // The source is lost again before a frame came: one gap.
        for _ in 0..2 {
            after(&mut page, &feed, AcquireEvent::Lost(&error));
            let lost = page.trouble().expect("it is lost");
            assert!(lost.starts_with("lost: cut;"), "{lost}");
            after(&mut page, &feed, AcquireEvent::Back { gap });
        }
        assert_eq!(
            page.trouble().as_deref(),
            Some("back after 4 s; no frame yet")
        );
        after(&mut page, &feed, at(5.5));
        let once = "no frames for 5.5 s, of which the connection was lost for 4 s";
        assert_eq!(page.trouble().as_deref(), Some(once));
        // The text stays until the user has seen it.
        after(&mut page, &feed, at(5.6));
        assert_eq!(page.trouble().as_deref(), Some(once));
        for event in [
            AcquireEvent::Lost(&error),
            AcquireEvent::Back { gap },
            at(8.0),
        ] {
            after(&mut page, &feed, event);
        }
        let twice = "no frames for 7.9 s in 2 gaps, of which the connection was lost for 6 s";
        assert_eq!(page.trouble().as_deref(), Some(twice));
        page.see_notices();
        assert_eq!(page.trouble(), None);
        assert_eq!(page.status.gaps.count, 2);
    }

    #[test]
    fn frames_of_other_channels_are_not_shown_before_the_one_that_is_asked_for() {
        let mut request = WatchRequest::new("none");
        request.options.channel = Some("right".to_owned());
        let feed = FrameFeed::of(&request);
        for (index, name) in ["left", "right"].into_iter().enumerate() {
            let info = ChannelInfo {
                name: Some(name.to_owned()),
                ..ChannelInfo::default()
            };
            feed.take_in(AcquireEvent::Channel(&info), &request);
            let mut frame = Frame::new(FrameSize::new(2, 2).expect("an allowed size"));
            frame.channel = index;
            let (frame, time) = (&frame, None);
            feed.take_in(AcquireEvent::Frame { frame, time }, &request);
        }
        let batch = feed.take().expect("a frame");
        let channels = batch.frames.iter().map(|frame| frame.channel);
        assert_eq!(channels.collect::<Vec<_>>(), [1]);
        let channel = batch.status.channel.expect("the one that is asked for");
        assert_eq!(
            (channel.name.as_deref(), batch.status.channels),
            (Some("right"), 2)
        );
    }
}
