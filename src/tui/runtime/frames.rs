//! Watches a source of frames on a thread of its own, so that neither a key nor a slow terminal holds it up.
//!
//! ```text
//! acquire -> Recording: every frame
//!         -> FrameFeed: what has not been taken yet, bounded in bytes -> at most 30 times a second -> Arrived
//! ```
//! Without a receiver of events, as in a script, nothing is watched: frames are read when they are asked for.
//!
//! The file is long because what is taken in, recorded and shown shares one lock, and its tests are about that.

use std::mem::take;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::acquire::{AcquireEvent, AcquireOptions, FrameSource, acquire};
use crate::formats::recording::{ChannelChoice, ChannelInfo, RecordingMetadata};
use crate::frame::Frame;
use crate::storage::Existing;
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::live::history::bytes_of;
use crate::tui::live::message::{
    FrameBatch, LiveEvent, ProvisionalChange, RecordedFrames, SourceState,
};
use crate::tui::live::request::WatchRequest;
use crate::tui::runtime::lock::locked;
use crate::tui::runtime::progress::WorkerEventSink;
use crate::tui::runtime::recording::Recording;
use crate::tui::runtime::source;
use crate::tui::runtime::threads;
use crate::tui::runtime::write_access::WriteAccess;

/// The source that is watched.
#[derive(Debug, Default)]
pub(super) struct FrameWatcher {
    /// None before the first source and after the page was closed.
    watched: Option<Watched>,
    /// The thread of the last source, which may still read it after it was stopped.
    thread: Option<JoinHandle<()>>,
}

/// A source with the thread that reads it. The thread ends by itself when `stop` is set or the source ends.
#[derive(Debug)]
struct Watched {
    /// The number of the piece of work, which its events carry.
    number: u64,
    /// What was asked for: the source, the channel, how frames are read.
    request: Arc<WatchRequest>,
    /// Shared with the thread that reads the source.
    feed: Arc<FrameFeed>,
    /// Set to end that thread.
    stop: Arc<AtomicBool>,
    /// Frames that a script has taken.
    taken: usize,
    /// Whether a file is being created for a recording.
    begins: bool,
}

/// How long a source waits for the thread of the one before.
const ENDING: Duration = Duration::from_millis(500);

/// Waits until a thread that was stopped has closed its source: the next one may be the same serial line, which only one
/// can open, or the same pipe, whose bytes it would take. It is not joined, since a disk or a host that does not answer
/// may hold it up.
fn give_time_to_end(thread: &JoinHandle<()>) {
    let begun = Instant::now();
    while !thread.is_finished() && begun.elapsed() < ENDING {
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// What has come and was not taken yet.
#[derive(Debug, Default)]
struct FrameFeed {
    /// Held for as long as it takes to add or to take frames, never while a file is written.
    pending: Mutex<Pending>,
    /// What is recorded in. Held for a moment only: a slow disk holds up the source, and nobody else.
    recording: Mutex<Option<Arc<Recording>>>,
}

/// What the screen takes at its next turn. It is swapped out under a short lock, so that the source hardly waits.
#[derive(Debug, Default)]
struct Pending {
    /// The frames, and how the source is.
    batch: FrameBatch,
    /// The memory that those frames take.
    bytes: usize,
    /// Whether there is something that was not taken yet.
    is_new: bool,
    /// The channels so far, and which of them is watched.
    channels: ChannelChoice,
}

impl FrameWatcher {
    /// Watches a source, recorded in a file if one is given. Returns an event where that cannot be begun. The source
    /// before has to be stopped first.
    pub(super) fn watch(
        &mut self,
        number: u64,
        request: Arc<WatchRequest>,
        write: Option<(PathBuf, Existing)>,
        post: Option<WorkerEventSink>,
    ) -> Option<WorkerEvent> {
        let watched = Watched {
            number,
            request: Arc::clone(&request),
            feed: Arc::new(FrameFeed::of(&request)),
            stop: Arc::default(),
            taken: 0,
            begins: false,
        };
        let feed = Arc::clone(&watched.feed);
        let existing = write.map(|(path, existing)| {
            *locked(&feed.recording) = Some(Recording::new(path));
            existing
        });
        let Some(post) = post else {
            self.watched = Some(watched);
            let refused = feed.begin_recording(&request, existing).err()?;
            return Some(WorkerEvent::Live(number, LiveEvent::NotRecorded(refused)));
        };
        let stop = Arc::clone(&watched.stop);
        let before = self.thread.take();
        let thread = threads::start(move || {
            if let Some(before) = before {
                give_time_to_end(&before);
            }
            // Before the first frame: each one is wanted. Not on the screen's thread: the disk may hang.
            if let Err(refused) = feed.begin_recording(&request, existing) {
                post(WorkerEvent::Live(number, LiveEvent::NotRecorded(refused)));
            }
            let source = source::named(&request.source);
            let post = || post(WorkerEvent::Live(number, LiveEvent::Waiting));
            let mut options = request.options.clone();
            options.waits = true;
            feed.run(&source, &request, &options, &stop, &mut |_| {
                post();
                ControlFlow::Continue(())
            });
        });
        let thread = thread.map(|thread| self.thread = Some(thread));
        if let Err(reason) = thread {
            let recording = locked(&watched.feed.recording).take();
            watched.feed.change(|pending| {
                pending.batch.status.state = SourceState::Failed(reason.clone());
            });
            self.watched = Some(watched);
            recording?;
            return Some(WorkerEvent::Live(number, LiveEvent::NotRecorded(reason)));
        }
        self.watched = Some(watched);
        None
    }

    /// Takes no more frames. Returns the recording, which is to be finished, and the number of the source.
    pub(super) fn stop(&mut self) -> Option<(u64, Arc<Recording>)> {
        let recording = self.end_recording();
        if let Some(watched) = self.watched.take() {
            watched.stop.store(true, Ordering::Relaxed);
        }
        recording
    }

    /// Notes that a recording is being begun. Returns the number of the source.
    ///
    /// # Errors
    /// A sentence, where there is no source, or a recording of it is being begun already.
    pub(super) fn begins(&mut self) -> Result<u64, &'static str> {
        let watched = self.watched.as_mut().ok_or("no source is watched")?;
        if std::mem::replace(&mut watched.begins, true) {
            return Err("a recording is being begun already");
        }
        Ok(watched.number)
    }

    /// Notes that it has begun, or cannot be: from now on each frame of the source of that number goes into it. Returns
    /// what is to be finished: it, if that source is gone, or the recording in whose place it comes.
    pub(super) fn begun(
        &mut self,
        number: u64,
        recording: Option<Arc<Recording>>,
    ) -> Option<Arc<Recording>> {
        let watched = self.watched.as_mut();
        let Some(watched) = watched.filter(|watched| watched.number == number) else {
            return recording;
        };
        watched.begins = false;
        let before = locked(&watched.feed.recording).replace(recording?);
        let mut pending = locked(&watched.feed.pending);
        pending.batch.status.recorded = Some(RecordedFrames::default());
        pending.batch.status.record_error = None;
        before
    }

    /// Records no more frames. Returns the recording, which is to be finished, and the number of the source.
    pub(super) fn end_recording(&self) -> Option<(u64, Arc<Recording>)> {
        let watched = self.watched.as_ref()?;
        let recording = locked(&watched.feed.recording).take()?;
        locked(&watched.feed.pending).batch.status.recorded = None;
        Some((watched.number, recording))
    }

    /// The number of the source, and what is recorded of it; None where nothing is.
    pub(super) fn recording(&self) -> Option<(u64, Arc<Recording>)> {
        let watched = self.watched.as_ref()?;
        Some((watched.number, watched.feed.recording()?))
    }

    /// Whether there is something to take.
    pub(super) fn has_new(&self) -> bool {
        let pending = self
            .watched
            .as_ref()
            .map(|watched| locked(&watched.feed.pending));
        pending.is_some_and(|pending| pending.is_new)
    }

    /// Takes all that has come; None if nothing has.
    pub(super) fn take(&self) -> Option<WorkerEvent> {
        let watched = self.watched.as_ref()?;
        let batch = watched.feed.take()?;
        Some(WorkerEvent::Live(
            watched.number,
            LiveEvent::Arrived(Arc::new(batch)),
        ))
    }

    /// Reads the next frames of the source, up to `count`, each as an event; for scripts, which have no clock.
    /// Nothing reads ahead in a script: the source is read anew from its start, and what was taken is skipped.
    pub(super) fn next(&mut self, count: usize, access: &WriteAccess) -> Vec<WorkerEvent> {
        let Some(watched) = &mut self.watched else {
            return Vec::new();
        };
        let (request, number) = (Arc::clone(&watched.request), watched.number);
        let mut options = request.options.clone();
        (options.once, options.repeat) = (true, false);
        let (skipped, mut seen) = (watched.taken, 0);
        let feed = FrameFeed::of(&request);
        let recording = watched.feed.recording();
        // What is skipped was recorded before.
        let record_from = |feed: &FrameFeed, seen: usize| {
            if seen == skipped {
                locked(&feed.recording).clone_from(&recording);
                let recorded = feed.recorded(Recording::tick);
                locked(&feed.pending).note(recorded);
            }
        };
        record_from(&feed, seen);
        let mut events = Vec::new();
        let source = match source::readable(&request.source, access) {
            Ok(source) => source,
            Err(reason) => {
                feed.change(|pending| pending.batch.status.state = SourceState::Failed(reason));
                let batch = feed.take().map(Arc::new);
                let event = batch.map(|batch| WorkerEvent::Live(number, LiveEvent::Arrived(batch)));
                return event.into_iter().collect();
            }
        };
        feed.run(
            &source,
            &request,
            &options,
            &AtomicBool::new(false),
            &mut |feed| {
                let Some(batch) = feed.take() else {
                    return ControlFlow::Continue(());
                };
                seen += batch.frames.len();
                record_from(feed, seen);
                if seen > skipped || batch.frames.is_empty() {
                    let event = LiveEvent::Arrived(Arc::new(batch));
                    events.push(WorkerEvent::Live(number, event));
                }
                if seen >= skipped + count {
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(())
            },
        );
        watched.taken = seen.max(skipped);
        events
    }
}

impl Drop for FrameWatcher {
    fn drop(&mut self) {
        // At the end of a script. On a terminal it has been finished before.
        if let Some((_, recording)) = self.stop() {
            let _ = recording.finish();
        }
    }
}

impl FrameFeed {
    /// What comes of the channel that is asked for.
    fn of(request: &WatchRequest) -> Self {
        let feed = Self::default();
        locked(&feed.pending).channels = ChannelChoice::new(request.options.channel.as_deref());
        feed
    }

    /// What is recorded in.
    fn recording(&self) -> Option<Arc<Recording>> {
        locked(&self.recording).clone()
    }

    /// Writes to it, if there is one. Returns how many frames are recorded then.
    fn recorded(
        &self,
        write: impl FnOnce(&Recording) -> Result<Option<RecordedFrames>, String>,
    ) -> Result<Option<RecordedFrames>, String> {
        let recording = self.recording();
        recording.map_or(Ok(None), |recording| write(&recording))
    }

    /// Creates the file of the recording that is asked for together with the source.
    fn begin_recording(
        &self,
        request: &WatchRequest,
        existing: Option<Existing>,
    ) -> Result<(), String> {
        let (Some(recording), Some(existing)) = (self.recording(), existing) else {
            return Ok(());
        };
        let metadata = RecordingMetadata {
            source: request.source.to_string_lossy().into_owned(),
            rule: request.rule,
            ..RecordingMetadata::default()
        };
        source::named(&request.source)
            .refuse_as_target(recording.path())
            .map_err(|error| error.to_string())?;
        recording.begin(existing, &metadata)?;
        locked(&self.pending).batch.status.recorded = Some(RecordedFrames::default());
        Ok(())
    }

    /// Reads a source to its end. `fresh` is called when there is something to take where there was nothing.
    fn run(
        &self,
        source: &FrameSource,
        request: &WatchRequest,
        options: &AcquireOptions,
        stop: &AtomicBool,
        fresh: &mut dyn FnMut(&Self) -> ControlFlow<()>,
    ) {
        let mut wanted = ControlFlow::Continue(());
        let ended = acquire(source, options, stop, &mut |event| {
            if self.take_in(event, request) {
                wanted = fresh(self);
            }
            wanted
        });
        if wanted.is_break() {
            return;
        }
        let state = match ended {
            Ok(()) => SourceState::Ended,
            Err(error) => SourceState::Failed(error.to_string()),
        };
        if self.change(|pending| pending.batch.status.state = state) {
            let _ = fresh(self);
        }
        // Nothing comes any more that would have the rest written, and the page may stay open for long. Said after the end
        // of the source: a disk may hang.
        let written = self.recorded(Recording::flush);
        if written.is_err() && self.change(|pending| pending.note(written)) {
            let _ = fresh(self);
        }
    }

    /// Changes what is to be taken; true if there was nothing to take before.
    fn change(&self, change: impl FnOnce(&mut Pending)) -> bool {
        let mut pending = locked(&self.pending);
        change(&mut pending);
        !std::mem::replace(&mut pending.is_new, true)
    }

    /// Takes what there is; None if nothing is new.
    fn take(&self) -> Option<FrameBatch> {
        let mut pending = locked(&self.pending);
        if !take(&mut pending.is_new) {
            return None;
        }
        pending.bytes = 0;
        Some(FrameBatch {
            frames: take(&mut pending.batch.frames),
            provisional: take(&mut pending.batch.provisional),
            status: pending.batch.status.clone(),
        })
    }

    /// Records a frame of the channel that is watched, and shows it. Whether there was nothing new before.
    fn take_frame(&self, frame: &Frame, time: Option<f64>, request: &WatchRequest) -> bool {
        if !locked(&self.pending).channels.takes(frame.channel) {
            return false;
        }
        // An error ends the recording; the frames go on being shown.
        let recorded = self.recorded(|own| own.add(frame, time));
        let mut own = frame.clone();
        own.time = time;
        self.change(|pending| {
            pending.note(recorded);
            pending.push(Arc::new(own), request.history_bytes);
        })
    }

    /// Notes what a source reports. True if it is to be shown and there was nothing before it.
    fn take_in(&self, event: AcquireEvent<'_>, request: &WatchRequest) -> bool {
        let state = |state: SourceState| self.change(|pending| pending.batch.status.state = state);
        match event {
            AcquireEvent::Channel(info) => self.change(|pending| pending.add_channel(info)),
            AcquireEvent::Frame { frame, time } => self.take_frame(frame, time, request),
            AcquireEvent::Provisional(frame) => {
                let shown = ProvisionalChange::Shown(Arc::new(frame.clone()));
                self.change(|pending| pending.batch.provisional = shown)
            }
            AcquireEvent::Withdrawn => {
                self.change(|pending| pending.batch.provisional = ProvisionalChange::Gone)
            }
            AcquireEvent::Tick(counts) => {
                let written = self.recorded(Recording::tick);
                let mut pending = locked(&self.pending);
                let status = &mut pending.batch.status;
                let is_new = status.lost != counts.dropped || written.is_err();
                status.lost = counts.dropped;
                status.sample.clone_from(&counts.sample);
                pending.note(written);
                is_new && !std::mem::replace(&mut pending.is_new, true)
            }
            AcquireEvent::Silent {
                bytes_per_second,
                counts,
            } => {
                let what = counts.silence(bytes_per_second);
                state(SourceState::Silent(format!("no frame for 2 s: {what}")))
            }
            AcquireEvent::Absent(error) => {
                let name = request.source.to_string_lossy();
                let text = format!("waiting for {name}, trying again each second: {error}");
                state(SourceState::Lost(text))
            }
            AcquireEvent::Lost(error) => {
                let text = format!("lost: {error}; trying again each second");
                state(SourceState::Lost(text))
            }
            AcquireEvent::Note(note) => self.change(|pending| {
                let first = &mut pending.batch.status.note;
                first.get_or_insert_with(|| note.to_string());
            }),
            AcquireEvent::Back { .. } => state(SourceState::Waiting),
            AcquireEvent::Anew(how) => state(SourceState::Silent(how.to_string())),
            AcquireEvent::Ended(counts) => self.change(|pending| {
                pending.batch.status.lost = counts.dropped;
                pending.batch.status.sample.clone_from(&counts.sample);
            }),
            _ => false,
        }
    }
}

impl Pending {
    /// Adds a channel.
    fn add_channel(&mut self, info: &ChannelInfo) {
        if self.channels.add(info) {
            self.batch.status.channel = Some(Arc::new(info.clone()));
        }
        self.batch.status.channels = self.channels.names().len();
    }

    /// Adds a frame; the oldest go where nobody takes them and there is no memory for more.
    /// Half of them go at once, so that a full buffer does not move all frames for each new one. At least one stays.
    fn push(&mut self, frame: Arc<Frame>, most: usize) {
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

    /// Notes how a recording is.
    fn note(&mut self, recorded: Result<Option<RecordedFrames>, String>) {
        match recorded {
            Ok(recorded) => self.batch.status.recorded = recorded,
            Err(error) => {
                self.batch.status.recorded = None;
                self.batch.status.record_error = Some(error);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::stream::StreamCounts;
    use crate::tui::live::state::Live;
    use crate::tui::runtime::write_access::WriteAccess;

    /// What a page shows after an event of its source: the number of the frame.
    fn after(page: &mut Live, feed: &FrameFeed, event: AcquireEvent<'_>) -> Option<u64> {
        feed.take_in(event, &WatchRequest::new("none"));
        if let Some(batch) = feed.take() {
            page.take(&batch);
        }
        page.reading().map(|reading| reading.frame.number)
    }

    #[test]
    fn a_provisional_frame_is_shown_until_it_is_withdrawn() {
        let feed = FrameFeed::default();
        let mut page = Live::new(Arc::new(WatchRequest::new("none")), 7);
        let mut frame = Frame::new(2, 2);
        let mut counts = StreamCounts::default();
        let shown = after(&mut page, &feed, AcquireEvent::Provisional(&frame));
        assert_eq!(shown, Some(0));
        // Of what was lost before it.
        counts.dropped = 3;
        let shown = after(&mut page, &feed, AcquireEvent::Tick(&counts));
        assert_eq!((shown, page.status().lost), (Some(0), 3));
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
        assert_eq!(page.mark(), Ok((1, true)));
        let shown = after(&mut page, &feed, AcquireEvent::Withdrawn);
        assert_eq!(shown, Some(0));
        assert!(page.marks().is_empty(), "the frame is gone, so its mark is");
        // The mark of one that is confirmed remains.
        after(&mut page, &feed, AcquireEvent::Provisional(&frame));
        assert_eq!(page.mark(), Ok((1, true)));
        let whole = AcquireEvent::Frame {
            frame: &frame,
            time,
        };
        assert_eq!(after(&mut page, &feed, whole), Some(1));
        assert!(page.is_marked());
    }

    #[test]
    fn a_mark_does_not_pass_to_the_frame_that_comes_in_place_of_a_withdrawn_one() {
        let feed = FrameFeed::default();
        let request = WatchRequest::new("none");
        let mut page = Live::new(Arc::new(WatchRequest::new("none")), 7);
        let [first, mut second] = [Frame::new(2, 2), Frame::new(2, 2)];
        second.values_mut()[0] = 9.0;
        let whole = AcquireEvent::Frame {
            frame: &second,
            time: None,
        };
        page.set_recording(Some("a.npy".to_owned()));
        for event in [AcquireEvent::Provisional(&second), whole] {
            after(&mut page, &feed, AcquireEvent::Provisional(&first));
            assert_eq!(page.mark(), Ok((0, true)));
            assert_eq!(page.take_marks().len(), 1);
            // Both before the page takes anything.
            feed.take_in(AcquireEvent::Withdrawn, &request);
            assert_eq!(after(&mut page, &feed, event), Some(0));
            assert!(!page.is_marked() && page.marks().is_empty());
            // The description of the recording has the mark until then.
            assert!(page.has_unwritten_marks());
        }
    }

    #[test]
    fn a_held_peak_does_not_begin_with_a_frame_that_may_be_withdrawn() {
        let feed = FrameFeed::default();
        let mut page = Live::new(Arc::new(WatchRequest::new("none")), 7);
        let [mut first, mut garbled] = [Frame::new(2, 2), Frame::new(2, 2)];
        first.values_mut().fill(1.0);
        garbled.values_mut()[0] = 9.0;
        let whole = AcquireEvent::Frame {
            frame: &first,
            time: None,
        };
        after(&mut page, &feed, whole);
        after(&mut page, &feed, AcquireEvent::Provisional(&garbled));
        assert!(page.hold_peak());
        after(&mut page, &feed, AcquireEvent::Withdrawn);
        assert_eq!(
            page.reading().and_then(|reading| Some(reading.max?.0)),
            Some(1.0)
        );
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
            let mut frame = Frame::new(2, 2);
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

    #[test]
    fn a_recording_that_another_one_comes_after_is_finished() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = Some((folder.path().join("a.npy"), Existing::Kept));
        let request = Arc::new(WatchRequest::new("none"));
        let mut watcher = FrameWatcher::default();
        assert_eq!(watcher.begins(), Err("no source is watched"));
        assert_eq!(watcher.watch(7, request, write, None), None);
        assert_eq!(watcher.begins(), Ok(7));
        let already = "a recording is being begun already";
        assert_eq!(watcher.begins(), Err(already));
        let access = WriteAccess::below(folder.path().to_owned());
        let metadata = RecordingMetadata::default();
        let next = Recording::in_free_file(&access, &metadata).map(|(_, next)| next);
        let over = watcher.begun(7, next.ok()).expect("the one before");
        assert!(over.path().ends_with("a.npy"));
        assert_eq!(
            over.finish(),
            Some(LiveEvent::Recorded(over.path().to_string_lossy().into(), 0))
        );
    }
}
