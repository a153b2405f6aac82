//! Watches a source of frames on a thread of its own, so that neither a key nor a slow terminal holds it up. In a
//! script, which has no clock, frames are read when they are asked for.

use std::fs::{self, File};
use std::io::{self, IsTerminal};
use std::ops::ControlFlow;
use std::os::fd::AsFd;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use taxel_files::acquire::FrameSource;
use taxel_files::formats::recording::RecordingMetadata;
use taxel_files::formats::value::grouped;
use taxel_files::storage::{Existing, below_home};

use crate::frames::WatchRequest;
use crate::frames::recording::Recording;
use crate::tui::app::message::WorkerEvent;
use crate::tui::app::update::on_worker;
use crate::tui::jobs::{Post, caught, start, wait_until_finished};
use crate::tui::live::feed::Feed;
use crate::tui::live::message::LiveEvent;
use crate::tui::runtime::disk::files::WriteAccess;

#[derive(Default)]
pub(crate) struct FrameWatcher {
    /// How its thread reports that frames wait; without one, a script takes them.
    pub(crate) post: Option<Post>,
    /// The source; None before the first one and after the page was closed.
    watched: Option<Watched>,
    /// The thread of the last source, which may still read it after it was stopped.
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Watched {
    number: u64,
    feed: Arc<Feed>,
    /// The number of frames that a script has read.
    taken: usize,
    /// Whether a recording is being begun.
    is_starting: bool,
}

/// The longest time that a source waits for the thread of the one before to close it: both may be the same serial
/// line, which only one can open, or the same pipe, whose bytes that thread would take.
const CLOSE_TIMEOUT: Duration = Duration::from_millis(500);

impl FrameWatcher {
    /// Watches a source, recorded in a file if one is given. The source before has to be stopped first.
    pub(crate) fn watch(
        &mut self,
        number: u64,
        request: Arc<WatchRequest>,
        write: Option<(PathBuf, Existing)>,
    ) {
        let feed = Feed::new(request);
        self.watched = Some(Watched {
            number,
            feed: Arc::clone(&feed),
            taken: 0,
            is_starting: false,
        });
        let own = Arc::clone(&feed);
        let begin = move || {
            let source = found(&own.request.source);
            if let Some((path, existing)) = write {
                let metadata = RecordingMetadata {
                    source: source.name(),
                    rule: own.request.pipeline.rule(),
                    ..RecordingMetadata::default()
                };
                let created = (source.refuse_as_target(&path))
                    .and_then(|()| Recording::create(&path, existing, &metadata));
                match created {
                    Ok(recording) => drop(own.record(Arc::new(recording))),
                    Err(error) => own.fail_recording(error.to_string()),
                }
            }
            source
        };
        let Some(post) = self.post.clone() else {
            begin();
            return;
        };
        let (own, before) = (Arc::clone(&feed), self.thread.take());
        let thread = start(move || {
            if let Some(before) = before {
                wait_until_finished(&before, Instant::now() + CLOSE_TIMEOUT);
            }
            // Before the first frame, so that none is missing; not on the screen's thread, as the disk may hang.
            let source = begin();
            let mut options = own.request.options.clone();
            options.waits = true;
            let mut news = || {
                let waiting = WorkerEvent::Live(number, LiveEvent::Waiting);
                post.answer(|app| on_worker(app, waiting));
                ControlFlow::Continue(())
            };
            if let Err(panic) = caught(|| own.run(&source, &options, &mut news)) {
                own.fail(panic);
                let _ = news();
            }
        });
        match thread {
            Ok(thread) => self.thread = Some(thread),
            Err(reason) => feed.fail(reason),
        }
    }

    pub(crate) fn stop(&mut self) -> Option<(u64, Arc<Recording>)> {
        let recording = self.end_recording();
        if let Some(watched) = self.watched.take() {
            watched.feed.stop.store(true, Ordering::Relaxed);
        }
        recording
    }

    pub(crate) fn start_recording(&mut self) -> Result<u64, &'static str> {
        let watched = self.watched.as_mut().ok_or("no source is watched")?;
        if std::mem::replace(&mut watched.is_starting, true) {
            return Err("a recording is already starting");
        }
        Ok(watched.number)
    }

    /// Notes that the file was created, or could not be. From now on each frame of that source is recorded in it.
    /// Returns the recording to finish: the new one if its source is gone, otherwise the one that it replaces.
    pub(crate) fn recording_started(
        &mut self,
        number: u64,
        recording: Option<Arc<Recording>>,
    ) -> Option<Arc<Recording>> {
        let watched = self.watched.as_mut();
        let Some(watched) = watched.filter(|watched| watched.number == number) else {
            return recording;
        };
        watched.is_starting = false;
        watched.feed.record(recording?)
    }

    pub(crate) fn end_recording(&self) -> Option<(u64, Arc<Recording>)> {
        let watched = self.watched.as_ref()?;
        Some((watched.number, watched.feed.end_recording()?))
    }

    /// The number of the source and its recording; None if nothing is recorded.
    pub(crate) fn recording(&self) -> Option<(u64, Arc<Recording>)> {
        let watched = self.watched.as_ref()?;
        Some((watched.number, watched.feed.recording()?))
    }

    pub(crate) fn has_new(&self) -> bool {
        (self.watched.as_ref()).is_some_and(|watched| watched.feed.has_new())
    }

    /// Takes all frames and news that have come; None if there are none.
    pub(crate) fn take(&self) -> Option<WorkerEvent> {
        let watched = self.watched.as_ref()?;
        let batch = Arc::new(watched.feed.take()?);
        Some(WorkerEvent::Live(watched.number, LiveEvent::Arrived(batch)))
    }

    /// Reads the next frames of the source for a script, up to `count`.
    pub(crate) fn next(&mut self, count: usize, access: &WriteAccess) -> Vec<WorkerEvent> {
        let Some(watched) = &mut self.watched else {
            return Vec::new();
        };
        let batches = match readable(&watched.feed.request.source, access) {
            Ok(source) => watched.feed.next(&source, watched.taken, count),
            Err(reason) => {
                watched.feed.fail(reason);
                watched.feed.take().into_iter().collect()
            }
        };
        let event = |batch| WorkerEvent::Live(watched.number, LiveEvent::Arrived(Arc::new(batch)));
        watched.taken += (batches.iter())
            .map(|batch| batch.frames.len())
            .sum::<usize>();
        batches.into_iter().map(event).collect()
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

/// The most names that recordings may have.
const MOST_CHOSEN: u64 = 10_000;

/// Begins a recording in a file whose name is free.
pub(crate) fn record_in_free_file(
    access: &WriteAccess,
    metadata: &RecordingMetadata,
) -> Result<(String, Arc<Recording>), String> {
    for number in 1..=MOST_CHOSEN {
        let name = format!("touch-{number}.npy");
        let path = access.path(&name, Existing::Kept)?;
        if path.exists() || path.with_extension("json").exists() {
            continue;
        }
        let recording = Recording::create(&path, Existing::Kept, metadata);
        let recording = recording.map_err(|error| error.to_string())?;
        return Ok((name, Arc::new(recording)));
    }
    let most = grouped(MOST_CHOSEN);
    Err(format!(
        "{most} recordings are here already; move some elsewhere"
    ))
}

/// Finishes a recording. Returns None if nothing was recorded any more, which has been reported before.
pub(crate) fn finish(recording: &Recording) -> Option<LiveEvent> {
    let path = recording.path().to_string_lossy().into_owned();
    match recording.finish() {
        Ok(recorded) => Some(LiveEvent::Recorded(path, recorded?)),
        Err(error) => Some(LiveEvent::NotFinished(error.to_string())),
    }
}

/// What a source refers to, in which `~` is the home folder.
fn found(named: &FrameSource) -> FrameSource {
    let below = match named {
        FrameSource::File(path) => path.to_str().and_then(below_home),
        _ => None,
    };
    below
        .map_or_else(|| named.clone(), FrameSource::File)
        .found()
}

/// The source of a name. A script from a stranger reads files only: a serial line would be set up and its device reset,
/// a connection made, a pipe waited for.
pub(crate) fn readable(named: &FrameSource, access: &WriteAccess) -> Result<FrameSource, String> {
    let source = found(named);
    let refused = |reason: &str| format!("{}: {reason}", source.name());
    if access.folder.is_some() && !is_file(&source) {
        return Err(refused(
            "without --allow-outside, a script reads frames only from files",
        ));
    }
    check(&source).map_err(|reason| refused(&reason))?;
    Ok(source)
}

/// Refuses a source that cannot be read even if one waits, and the terminal whose keys control the screen: its reader
/// would take half of them.
pub fn check(source: &FrameSource) -> Result<(), String> {
    let is_own_terminal = match source {
        FrameSource::Standard => io::stdin().is_terminal(),
        FrameSource::Serial(path) => is_own_terminal(path),
        _ => false,
    };
    if is_own_terminal {
        return Err("this is your terminal; pipe frames into 'taxel watch -'".to_owned());
    }
    source.check().map_err(|error| error.to_string())
}

fn is_own_terminal(path: &Path) -> bool {
    let device = |file: fs::Metadata| file.rdev();
    let Ok(own) = fs::metadata(path).map(device) else {
        return false;
    };
    let (input, output, errors) = (io::stdin(), io::stdout(), io::stderr());
    let mut streams = [input.as_fd(), output.as_fd(), errors.as_fd()].into_iter();
    let controlling = fs::metadata("/dev/tty").map(device);
    controlling.is_ok_and(|controlling| controlling == own)
        || streams.any(|stream| {
            let metadata = stream
                .try_clone_to_owned()
                .and_then(|file| File::from(file).metadata());
            stream.is_terminal() && metadata.map(device).is_ok_and(|stream| stream == own)
        })
}

/// Whether the source is a file with content. Files of `/proc`, which may have to be waited for like pipes, are empty.
/// A missing file and a folder count as files with content: opening them reports the error.
fn is_file(source: &FrameSource) -> bool {
    match source {
        FrameSource::File(path) => path.metadata().map_or(true, |found| {
            found.is_dir() || (found.is_file() && found.len() > 0)
        }),
        _ => false,
    }
}
