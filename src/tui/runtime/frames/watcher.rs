//! Watches a source of frames on a separate thread, so that neither a key nor a slow terminal holds it up.
//!
//! ```text
//! acquire -> Recording: every frame
//!         -> FrameFeed: what has not been taken yet, bounded in bytes -> at most 30 times a second -> Arrived
//! ```
//! Without a receiver of events, as in a script, nothing is watched: frames are read when they are asked for.

use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use taxel_files::acquire::{FrameSource, Playback};
use taxel_files::storage::Existing;

use crate::tui::app::message::WorkerEvent;
use crate::tui::live::message::{FrameBatch, LiveEvent, WatchRequest};
use crate::tui::runtime::disk::files::WriteAccess;
use crate::tui::runtime::frames::feed::FrameFeed;
use crate::tui::runtime::frames::recording::Recording;
use crate::tui::runtime::frames::source;
use crate::tui::runtime::work::execution::{Execution, start, wait_until_finished};

#[derive(Debug, Default)]
pub(crate) struct FrameWatcher {
    /// The source; None before the first one and after the page was closed.
    watched: Option<Watched>,
    /// The thread of the last source, which may still read it after it was stopped.
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Watched {
    number: u64,
    /// The request: the source, the channel, and how frames are read.
    request: Arc<WatchRequest>,
    feed: Arc<FrameFeed>,
    stop: Arc<AtomicBool>,
    taken: usize,
    reader: Option<ScriptReader>,
    is_starting: bool,
}

/// The longest time that a source waits for the thread of the one before to close it: both may be the same serial
/// line, which only one can open, or the same pipe, whose bytes that thread would take.
const CLOSE_TIMEOUT: Duration = Duration::from_millis(500);

impl FrameWatcher {
    /// Watches a source, recorded in a file if one is given. Returns an event if that cannot be begun. The source
    /// before has to be stopped first.
    pub(in crate::tui::runtime) fn watch(
        &mut self,
        number: u64,
        request: Arc<WatchRequest>,
        write: Option<(PathBuf, Existing)>,
        execution: &Execution,
    ) -> Option<WorkerEvent> {
        let watched = Watched {
            number,
            request: Arc::clone(&request),
            feed: Arc::new(FrameFeed::of(&request)),
            stop: Arc::default(),
            taken: 0,
            reader: None,
            is_starting: false,
        };
        let feed = Arc::clone(&watched.feed);
        let existing = write.map(|(path, existing)| {
            feed.begin(Recording::new(path));
            existing
        });
        let post = match execution {
            Execution::AtOnce(_) => {
                self.watched = Some(watched);
                let refused = feed.begin_recording(&request, existing).err()?;
                return Some(WorkerEvent::Live(number, LiveEvent::NotRecorded(refused)));
            }
            Execution::OnThreads(post) => Arc::clone(post),
        };
        let stop = Arc::clone(&watched.stop);
        let before = self.thread.take();
        let thread = start(move || {
            if let Some(before) = before {
                wait_until_finished(&before, CLOSE_TIMEOUT);
            }
            // Before the first frame, so that none is missing; not on the screen's thread, as the disk may hang.
            if let Err(refused) = feed.begin_recording(&request, existing) {
                post(WorkerEvent::Live(number, LiveEvent::NotRecorded(refused)));
            }
            let source = source::found(&request.source);
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
            let recording = watched.feed.end();
            watched.feed.fail(reason.clone());
            self.watched = Some(watched);
            recording?;
            return Some(WorkerEvent::Live(number, LiveEvent::NotRecorded(reason)));
        }
        self.watched = Some(watched);
        None
    }

    pub(in crate::tui::runtime) fn stop(&mut self) -> Option<(u64, Arc<Recording>)> {
        let recording = self.end_recording();
        if let Some(watched) = self.watched.take() {
            watched.stop.store(true, Ordering::Relaxed);
        }
        recording
    }

    pub(in crate::tui::runtime) fn start_recording(&mut self) -> Result<u64, &'static str> {
        let watched = self.watched.as_mut().ok_or("no source is watched")?;
        if std::mem::replace(&mut watched.is_starting, true) {
            return Err("a recording is already starting");
        }
        Ok(watched.number)
    }

    /// Notes that the file was created, or could not be. From now on each frame of that source is recorded in it.
    /// Returns the recording to finish: the new one if its source is gone, otherwise the one that it replaces.
    pub(in crate::tui::runtime) fn recording_started(
        &mut self,
        number: u64,
        recording: Option<Arc<Recording>>,
    ) -> Option<Arc<Recording>> {
        let watched = self.watched.as_mut();
        let Some(watched) = watched.filter(|watched| watched.number == number) else {
            return recording;
        };
        watched.is_starting = false;
        let recording = recording?;
        // Before frames are recorded: a frame that cannot be written leaves an error, which must stay.
        watched.feed.note_begun();
        watched.feed.begin(recording)
    }

    pub(in crate::tui::runtime) fn end_recording(&self) -> Option<(u64, Arc<Recording>)> {
        let watched = self.watched.as_ref()?;
        Some((watched.number, watched.feed.end()?))
    }

    /// Returns the number of the source and its recording; None if nothing is recorded.
    pub(in crate::tui::runtime) fn recording(&self) -> Option<(u64, Arc<Recording>)> {
        let watched = self.watched.as_ref()?;
        Some((watched.number, watched.feed.recording()?))
    }

    pub(crate) fn has_new(&self) -> bool {
        let watched = self.watched.as_ref();
        watched.is_some_and(|watched| watched.feed.has_new())
    }

    /// Takes all frames and news that have come; None if there are none.
    pub(crate) fn take(&self) -> Option<WorkerEvent> {
        let watched = self.watched.as_ref()?;
        let batch = watched.feed.take()?;
        Some(WorkerEvent::Live(
            watched.number,
            LiveEvent::Arrived(Arc::new(batch)),
        ))
    }

    /// Reads the next frames of the source, up to `count`, each as an event; for scripts, which have no clock.
    pub(crate) fn next(&mut self, count: usize, access: &WriteAccess) -> Vec<WorkerEvent> {
        let Some(watched) = &mut self.watched else {
            return Vec::new();
        };
        let number = watched.number;
        let batches = watched.next(count, access).into_iter();
        let events = batches.map(|batch| LiveEvent::Arrived(Arc::new(batch)));
        events
            .map(|event| WorkerEvent::Live(number, event))
            .collect()
    }
}

impl Watched {
    /// Reads the next frames, up to `count`. A source that has ended is read again from its start, as it may have
    /// grown; the frames taken before are skipped then.
    fn next(&mut self, count: usize, access: &WriteAccess) -> Vec<FrameBatch> {
        let mut batches = Vec::new();
        let mut reader = match self.reader.take() {
            Some(reader) => reader,
            None => match self.open(access) {
                Ok(reader) => reader,
                Err(reason) => {
                    self.feed.fail(reason);
                    return self.feed.take().into_iter().collect();
                }
            },
        };
        let end = self.taken + count;
        while self.taken < end {
            let Some(batch) = reader.next() else {
                return batches;
            };
            self.taken += batch.frames.len();
            batches.push(batch);
        }
        self.reader = Some(reader);
        batches
    }

    fn open(&mut self, access: &WriteAccess) -> Result<ScriptReader, String> {
        let source = source::readable(&self.request.source, access)?;
        let feed = Arc::new(FrameFeed::of(&self.request));
        let reader = ScriptReader::open(ScriptSource {
            source,
            request: Arc::clone(&self.request),
            feed: Arc::clone(&feed),
            skipped: self.taken,
            recording: self.feed.recording(),
        })?;
        self.feed = feed;
        Ok(reader)
    }
}

impl Drop for FrameWatcher {
    fn drop(&mut self) {
        // For the end of a script. On a terminal the recording has been finished before.
        if let Some((_, recording)) = self.stop() {
            let _ = recording.finish();
        }
    }
}

#[derive(Debug)]
pub(in crate::tui::runtime) struct ScriptSource {
    pub(in crate::tui::runtime) source: FrameSource,
    pub(in crate::tui::runtime) request: Arc<WatchRequest>,
    pub(in crate::tui::runtime) feed: Arc<FrameFeed>,
    pub(in crate::tui::runtime) skipped: usize,
    pub(in crate::tui::runtime) recording: Option<Arc<Recording>>,
}

impl ScriptSource {
    fn read(&self, take: &mut dyn FnMut(FrameBatch) -> ControlFlow<()>) {
        let mut options = self.request.options.clone();
        options.playback = Playback::Once;
        // The skipped frames were recorded before.
        let record_from = |seen: usize| {
            if seen == self.skipped {
                self.feed.go_on_with(self.recording.clone());
            }
        };
        let mut seen = 0;
        record_from(seen);
        let never = AtomicBool::new(false);
        let (source, request) = (&self.source, &self.request);
        self.feed
            .run(source, request, &options, &never, &mut |feed| {
                let Some(batch) = feed.take() else {
                    return ControlFlow::Continue(());
                };
                let frames = batch.frames.len();
                seen += frames;
                if frames > 0 {
                    record_from(seen);
                }
                if seen > self.skipped || frames == 0 {
                    return take(batch);
                }
                ControlFlow::Continue(())
            });
        if seen < self.skipped {
            // The source has become shorter.
            self.feed.go_on_with(self.recording.clone());
        }
    }
}

/// A script has no clock: a frame comes when it is asked for. The file stays open between two requests, so a recording is
/// read once. Script and thread take turns, so a script does the same every time.
#[derive(Debug)]
pub(in crate::tui::runtime) struct ScriptReader {
    /// The channel that lets the thread read on; dropped to end it.
    more: Option<Sender<()>>,
    batches: Receiver<FrameBatch>,
    thread: Option<JoinHandle<()>>,
}

impl ScriptReader {
    pub(in crate::tui::runtime) fn open(source: ScriptSource) -> Result<Self, String> {
        let (more, wanted) = channel();
        let (sender, batches) = channel();
        let is_wanted = move || match wanted.recv() {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        };
        let thread = start(move || {
            if is_wanted().is_break() {
                return;
            }
            source.read(&mut |batch| match sender.send(batch) {
                Ok(()) => is_wanted(),
                Err(_) => ControlFlow::Break(()),
            });
        })?;
        Ok(Self {
            more: Some(more),
            batches,
            thread: Some(thread),
        })
    }

    /// Returns the next batch; None at the end of the source.
    pub(in crate::tui::runtime) fn next(&mut self) -> Option<FrameBatch> {
        let more = self.more.as_ref()?;
        // A thread that has ended sends nothing either.
        let _ = more.send(());
        if let Ok(batch) = self.batches.recv() {
            return Some(batch);
        }
        self.more = None;
        if let Some(Err(panic)) = self.thread.take().map(JoinHandle::join) {
            // The panic goes on, as if the source were read on the script's thread.
            resume_unwind(panic);
        }
        None
    }
}

impl Drop for ScriptReader {
    fn drop(&mut self) {
        self.more = None;
        // The thread waits for a request, so it ends at once, and has closed the file then.
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(numbers: std::ops::Range<u32>) -> String {
        let line = |number| format!("{number},{number},{number},{number}\n");
        let lines = numbers.map(line).collect::<String>();
        "S0_0,S0_1,S1_0,S1_1\n".to_owned() + &lines
    }

    fn numbers(events: &[WorkerEvent]) -> Vec<Option<f64>> {
        let number = |event: &WorkerEvent| {
            let WorkerEvent::Live(7, LiveEvent::Arrived(batch)) = event else {
                panic!("{event:?}");
            };
            Some(batch.frames.first()?.values()[0])
        };
        events.iter().map(number).collect()
    }

    #[test]
    fn a_script_reads_a_source_once_and_continues_if_it_has_grown() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.csv");
        std::fs::write(&path, frames(0..6)).expect("written");
        let access = WriteAccess::below(folder.path().to_owned());
        let request = Arc::new(WatchRequest::new(path.clone()));
        let mut watcher = FrameWatcher::default();
        let at_once = Execution::default();
        assert_eq!(watcher.watch(7, Arc::clone(&request), None, &at_once), None);
        let mut taken = Vec::new();
        let mut take = |watcher: &mut FrameWatcher, count| {
            let found = numbers(&watcher.next(count, &access));
            let frames = found.iter().flatten().count();
            taken.extend(found.into_iter().flatten());
            frames
        };
        assert_eq!(take(&mut watcher, 2), 2);
        // The file is open, so it does not matter that its name changes meanwhile.
        let aside = folder.path().join("b.csv");
        std::fs::rename(&path, &aside).expect("renamed");
        assert_eq!([take(&mut watcher, 1), take(&mut watcher, 9)], [1, 3]);
        std::fs::write(&path, frames(0..8)).expect("written");
        assert_eq!([take(&mut watcher, 1), take(&mut watcher, 9)], [1, 1]);
        assert_eq!(taken, (0..8).map(f64::from).collect::<Vec<_>>());
    }
}
