//! Watches a source of frames on a thread of its own, so that neither a key nor a slow terminal holds it up.
//!
//! ```text
//! acquire -> recording: every frame
//!         -> FrameFeed: what has not been taken yet, bounded in bytes -> at most 30 times a second -> Arrived
//! ```
//! Without a receiver of events, as in a script, nothing is watched: frames are read when they are asked for.

use std::ffi::OsStr;
use std::mem::take;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::acquire::{
    AcquireError, AcquireEvent, AcquireOptions, FrameRecorder, FrameSource, acquire,
};
use crate::formats::recording::{FrameMark, RecordingMetadata};
use crate::frame::Frame;
use crate::storage::{Existing, location};
use crate::tui::explore::message::WorkerEvent;
use crate::tui::live::history::bytes_of;
use crate::tui::live::message::{FrameBatch, LiveEvent, SourceState};
use crate::tui::live::request::WatchRequest;
use crate::tui::runtime::progress::WorkerEventSink;
use crate::tui::runtime::write_access::WriteAccess;

/// The source that is watched.
#[derive(Debug, Default)]
pub(super) struct FrameWatcher {
    /// None before the first source and after the page was closed.
    watched: Option<Watched>,
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
}

/// What has come and was not taken yet.
#[derive(Debug, Default)]
struct FrameFeed {
    /// Held for as long as it takes to add or to take frames, never while a file is written.
    pending: Mutex<Pending>,
    /// Locked apart, so that a slow disk holds up the source only.
    recorder: Mutex<Option<(PathBuf, FrameRecorder)>>,
    /// Marks that are not in the recording's description yet.
    marks: Mutex<Option<Vec<FrameMark>>>,
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
    /// The names of the channels so far.
    channels: Vec<Option<String>>,
    /// The number of the channel that is watched.
    channel: Option<usize>,
}

/// A panic while it was locked does not matter: what it holds is always whole.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl FrameWatcher {
    /// Watches a source. Returns an event where the recording that is asked for cannot be begun.
    pub(super) fn watch(
        &mut self,
        number: u64,
        request: Arc<WatchRequest>,
        post: Option<WorkerEventSink>,
    ) -> Option<WorkerEvent> {
        self.stop();
        let watched = Watched {
            number,
            request: Arc::clone(&request),
            feed: Arc::default(),
            stop: Arc::default(),
            taken: 0,
        };
        let mut refused = None;
        if let Some((path, existing)) = &request.write {
            let metadata = RecordingMetadata {
                source: request.source.to_string_lossy().into_owned(),
                rule: request.rule,
                ..RecordingMetadata::default()
            };
            refused = watched.begin_recording(path, *existing, &metadata).err();
        }
        if let Some(post) = post {
            let (feed, stop) = (Arc::clone(&watched.feed), Arc::clone(&watched.stop));
            // It is not joined: opening a pipe waits for its other end.
            let thread = std::thread::Builder::new().spawn(move || {
                let source = source(&request.source);
                let post = || post(WorkerEvent::Live(number, LiveEvent::Waiting));
                feed.run(&source, &request, &request.options, &stop, &mut |_| {
                    post();
                    ControlFlow::Continue(())
                });
            });
            if let Err(error) = thread {
                let reason = format!("the system gives no thread for it: {error}");
                watched.feed.change(|pending| {
                    pending.batch.status.state = SourceState::Failed(reason);
                });
            }
        }
        self.watched = Some(watched);
        refused.map(|reason| WorkerEvent::Live(number, LiveEvent::NotRecorded(reason)))
    }

    /// Takes no more frames; a recording is finished.
    pub(super) fn stop(&mut self) {
        if let Some(watched) = self.watched.take() {
            watched.stop.store(true, Ordering::Relaxed);
            watched.end_recording();
        }
    }

    /// Begins a recording in the first file `touch-1.npy`, `touch-2.npy` … that is not there.
    pub(super) fn record(
        &self,
        metadata: &RecordingMetadata,
        access: &WriteAccess,
    ) -> Option<WorkerEvent> {
        let watched = self.watched.as_ref()?;
        let names = (1..10_000).map(|number| format!("touch-{number}.npy"));
        let mut paths = names.map(|name| (access.path(&name, Existing::Kept), name));
        let is_free = |(path, _): &(Result<PathBuf, String>, String)| match path {
            Ok(path) => !path.exists() && !path.with_extension("json").exists(),
            Err(_) => true,
        };
        let begun = match paths.find(is_free) {
            Some((Ok(path), name)) => watched
                .begin_recording(&path, Existing::Kept, metadata)
                .map(|()| LiveEvent::Recording(name)),
            Some((Err(refused), _)) => Err(refused),
            None => Err("10,000 recordings are here already; move some elsewhere".to_owned()),
        };
        let event = begun.unwrap_or_else(LiveEvent::NotRecorded);
        Some(WorkerEvent::Live(watched.number, event))
    }

    /// Ends it.
    /// The event says how many frames the file holds, or why it could not be finished.
    pub(super) fn stop_recording(&self) -> Option<WorkerEvent> {
        let watched = self.watched.as_ref()?;
        let event = watched.end_recording()?;
        Some(WorkerEvent::Live(watched.number, event))
    }

    /// Has the marks written into the description of the recording, by the thread that records.
    pub(super) fn mark(&self, marks: &[FrameMark]) -> Option<WorkerEvent> {
        *locked(&self.watched.as_ref()?.feed.marks) = Some(marks.to_vec());
        None
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
    pub(super) fn next(&mut self, count: usize) -> Vec<WorkerEvent> {
        let Some(watched) = &mut self.watched else {
            return Vec::new();
        };
        let (request, number) = (Arc::clone(&watched.request), watched.number);
        let mut options = request.options.clone();
        (options.once, options.repeat) = (true, false);
        let (skipped, mut seen) = (watched.taken, 0);
        let feed = FrameFeed::default();
        let mut events = Vec::new();
        feed.run(
            &source(&request.source),
            &request,
            &options,
            &AtomicBool::new(false),
            &mut |feed| {
                let Some(batch) = feed.take() else {
                    return ControlFlow::Continue(());
                };
                seen += batch.frames.len();
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
        self.stop();
    }
}

impl Watched {
    /// Opens the file of a recording; from then on each frame goes into it. An earlier error is forgotten.
    fn begin_recording(
        &self,
        path: &Path,
        existing: Existing,
        metadata: &RecordingMetadata,
    ) -> Result<(), String> {
        let recorder = FrameRecorder::create(path, existing, metadata);
        let recorder = recorder.map_err(|error| error.to_string())?;
        *locked(&self.feed.recorder) = Some((path.to_owned(), recorder));
        let mut pending = locked(&self.feed.pending);
        pending.batch.status.recorded = Some(0);
        pending.batch.status.record_error = None;
        Ok(())
    }

    /// Finishes the recording; None if there was none.
    fn end_recording(&self) -> Option<LiveEvent> {
        let (path, mut recorder) = locked(&self.feed.recorder).take()?;
        let marked = match locked(&self.feed.marks).take() {
            Some(marks) => recorder.mark(marks),
            None => Ok(()),
        };
        locked(&self.feed.pending).batch.status.recorded = None;
        let name = path.to_string_lossy().into_owned();
        Some(match marked.and_then(|()| recorder.finish()) {
            Ok(frames) => LiveEvent::Recorded(name, frames),
            Err(error) => LiveEvent::NotRecorded(error.to_string()),
        })
    }
}

/// The source of a name, which may begin with `~`.
fn source(name: &OsStr) -> FrameSource {
    let below = name.to_str().and_then(location::below_home);
    match below {
        Some(path) if name != "-" && !name.to_string_lossy().starts_with("tcp://") => {
            FrameSource::new(path.as_os_str())
        }
        _ => FrameSource::new(name),
    }
}

impl FrameFeed {
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
            Err(AcquireError::Recording(error)) => SourceState::Failed(error.to_string()),
            Err(error) => SourceState::Failed(error.to_string()),
        };
        if self.change(|pending| pending.batch.status.state = state) {
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
            provisional: pending.batch.provisional.take(),
            status: pending.batch.status.clone(),
        })
    }

    /// Notes what a source reports. True if it is to be shown and there was nothing before it.
    fn take_in(&self, event: AcquireEvent<'_>, request: &WatchRequest) -> bool {
        let state = |state: SourceState| self.change(|pending| pending.batch.status.state = state);
        match event {
            AcquireEvent::Channel(info) => self.change(|pending| {
                let wanted = request.channel.is_none() || request.channel == info.name;
                if pending.channel.is_none() && wanted {
                    pending.channel = Some(pending.channels.len());
                    pending.batch.status.channel = Some(Arc::new(info.clone()));
                }
                pending.channels.push(info.name.clone());
                pending.batch.status.channels = pending.channels.len();
            }),
            AcquireEvent::Frame { frame, time } => {
                let channel = locked(&self.pending).channel;
                if channel.is_some_and(|channel| channel != frame.channel) {
                    return false;
                }
                let recorded = self.record(frame, time);
                let mut own = frame.clone();
                own.time = time;
                self.change(|pending| {
                    pending.note(recorded);
                    pending.push(Arc::new(own), request.history_bytes);
                })
            }
            AcquireEvent::Provisional(frame) => {
                let frame = Some(Arc::new(frame.clone()));
                self.change(|pending| pending.batch.provisional = frame)
            }
            AcquireEvent::Withdrawn => self.change(|pending| pending.batch.provisional = None),
            AcquireEvent::Tick(counts) => {
                let written = self.write_out();
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
            AcquireEvent::Lost(error) => state(SourceState::Lost(format!(
                "lost: {error}; trying again each second"
            ))),
            AcquireEvent::Back { .. } => state(SourceState::Waiting),
            AcquireEvent::Ended(counts) => self.change(|pending| {
                pending.batch.status.lost = counts.dropped;
                pending.batch.status.sample.clone_from(&counts.sample);
            }),
            _ => false,
        }
    }

    /// Records a frame. Returns how many are recorded, None without a recording.
    /// An error ends the recording; the frames go on being shown.
    fn record(&self, frame: &Frame, time: Option<f64>) -> Result<Option<u64>, String> {
        let mut recorder = locked(&self.recorder);
        let Some((_, own)) = &mut *recorder else {
            return Ok(None);
        };
        let added = own.add(frame, time).map(|()| Some(own.frames()));
        added.map_err(|error| {
            // What is recorded so far stays.
            let _ = recorder.take().map(|(_, recorder)| recorder.finish());
            error.to_string()
        })
    }

    /// Writes out what has waited for long enough.
    /// Marks are written here, too: until a recording ends, only the thread of the source writes.
    fn write_out(&self) -> Result<Option<u64>, String> {
        let mut recorder = locked(&self.recorder);
        let Some((_, own)) = &mut *recorder else {
            return Ok(None);
        };
        let marked = match locked(&self.marks).take() {
            Some(marks) => own.mark(marks),
            None => Ok(()),
        };
        let written = marked.and_then(|()| own.tick());
        let written = written.map(|()| Some(own.frames()));
        written.map_err(|error| {
            let _ = recorder.take();
            error.to_string()
        })
    }
}

impl Pending {
    /// Adds a frame; the oldest go where nobody takes them and there is no memory for more.
    /// Half of them go at once, so that a full buffer does not move all frames for each new one. At least one stays.
    fn push(&mut self, frame: Arc<Frame>, most: usize) {
        self.batch.status.state = SourceState::Live;
        self.batch.provisional = None;
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
    fn note(&mut self, recorded: Result<Option<u64>, String>) {
        match recorded {
            Ok(recorded) => self.batch.status.recorded = recorded,
            Err(error) => {
                self.batch.status.recorded = None;
                self.batch.status.record_error = Some(error);
            }
        }
    }
}
