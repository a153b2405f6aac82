//! Watches a source of frames on a thread of its own, so that neither a key nor a slow terminal holds it up. In a
//! script, which has no clock, frames are read when they are asked for.

use std::fs;
use std::io::{self, IsTerminal};
use std::ops::ControlFlow;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use taxel_files::acquire::{FrameRecorder, FrameSource, RecorderError};
use taxel_files::formats::recording::RecordingMetadata;
use taxel_files::formats::value::{counted, grouped};
use taxel_files::storage::{Existing, below_home};

use crate::frames::WatchRequest;
use crate::frames::recording::{RecordedFrames, Recording};
use crate::tui::app::{App, inform, refuse};
use crate::tui::files::WriteAccess;
use crate::tui::jobs::{answer, caught, start, wait_until_finished};
use crate::tui::live::update::{arrived, begun_in};
use crate::tui::live::{Feed, FrameBatch};

/// The longest time that a source waits for the thread of the one before to close it: both may be the same serial
/// line, which only one can open, or the same pipe, whose bytes that thread would take.
const CLOSE_TIMEOUT: Duration = Duration::from_millis(500);

#[derive(Debug, Default)]
pub(crate) struct Sources {
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

impl Sources {
    fn feed(&self) -> Option<(u64, &Feed)> {
        let watched = self.watched.as_ref()?;
        Some((watched.number, &watched.feed))
    }

    fn recording(&self) -> Option<(u64, Arc<Recording>)> {
        let (number, feed) = self.feed()?;
        Some((number, feed.recording()?))
    }

    pub(crate) fn has_new(&self) -> bool {
        self.feed().is_some_and(|(_, feed)| feed.has_new())
    }

    /// Reads the next frames of the source for a script, up to `count`. The batches are those of the source of that
    /// number.
    pub(crate) fn next(&mut self, count: usize, access: &WriteAccess) -> (u64, Vec<FrameBatch>) {
        let Some(watched) = &mut self.watched else {
            return (0, Vec::new());
        };
        let batches = match readable(&watched.feed.request.source, access) {
            Ok(source) => watched.feed.next(&source, watched.taken, count),
            Err(reason) => {
                watched.feed.fail(reason);
                watched.feed.take().into_iter().collect()
            }
        };
        let frames = batches.iter().map(|batch| batch.frames.len());
        watched.taken += frames.sum::<usize>();
        (watched.number, batches)
    }
}

impl Drop for Sources {
    fn drop(&mut self) {
        // For the end of a script. On a terminal the recording has been finished before.
        if let Some((_, feed)) = self.feed()
            && let Some(recording) = feed.end_recording()
        {
            let _ = recording.finish();
        }
    }
}

/// Watches a source, as the work of this number, in place of the one before. `records` says whether the recording that
/// the request asks for is begun.
pub(super) fn watch(app: &mut App, number: u64, request: Arc<WatchRequest>, records: bool) {
    stop(app);
    let feed = Feed::new(request);
    app.jobs.sources.watched = Some(Watched {
        number,
        feed: Arc::clone(&feed),
        taken: 0,
        is_starting: false,
    });
    let own = Arc::clone(&feed);
    let begin = move || {
        let source = found(&own.request.source);
        let asked = records.then(|| Recording::asked(&source, &own.request));
        match asked.transpose().map(Option::flatten) {
            Ok(Some(recording)) => drop(own.record(Arc::new(recording))),
            Ok(None) => {}
            Err(error) => own.fail_recording(error.to_string()),
        }
        source
    };
    let Some(wake) = app.jobs.post.wake.clone() else {
        begin();
        return;
    };
    let (own, before) = (Arc::clone(&feed), app.jobs.sources.thread.take());
    let thread = start(move || {
        if let Some(before) = before {
            wait_until_finished(&before, Instant::now() + CLOSE_TIMEOUT);
        }
        // Before the first frame, so that none is missing; not on the screen's thread, as the disk may hang.
        let source = begin();
        let mut options = own.request.options.clone();
        options.waits = true;
        let mut news = || {
            wake();
            ControlFlow::Continue(())
        };
        if let Err(panic) = caught(|| own.run(&source, &options, &mut news)) {
            own.fail(panic);
            wake();
        }
    });
    match thread {
        Ok(thread) => app.jobs.sources.thread = Some(thread),
        Err(reason) => feed.fail(reason),
    }
}

/// Takes the frames and the news that have come.
pub(crate) fn take(app: &mut App) {
    if let Some((number, feed)) = app.jobs.sources.feed()
        && let Some(batch) = feed.take()
    {
        arrived(app, number, &batch);
    }
}

pub(crate) fn stop(app: &mut App) {
    end_recording(app);
    if let Some(watched) = app.jobs.sources.watched.take() {
        watched.feed.stop.store(true, Ordering::Relaxed);
    }
}

/// Records all frames from now on, in a file whose name is free.
pub(super) fn record(app: &mut App, metadata: RecordingMetadata) {
    let Some(watched) = &mut app.jobs.sources.watched else {
        return refuse(app, "no source is watched");
    };
    if std::mem::replace(&mut watched.is_starting, true) {
        return refuse(app, "a recording is already starting");
    }
    let (number, access) = (watched.number, Arc::clone(&app.jobs.access));
    app.jobs.disk("Starting a recording", move |_| {
        let begun = record_in_free_file(&access, &metadata);
        answer(move |app| recording_begun(app, number, begun))
    });
}

fn recording_begun(app: &mut App, number: u64, begun: Result<(String, Arc<Recording>), String>) {
    let watched = app.jobs.sources.watched.as_mut();
    let watched = watched.filter(|watched| watched.number == number);
    let (name, recording) =
        begun.map_or_else(|why| (Err(why), None), |(name, own)| (Ok(name), Some(own)));
    // The recording to finish: the new one if its source was left meanwhile, or another one that was still open.
    let over = match watched {
        Some(watched) => {
            watched.is_starting = false;
            recording.and_then(|recording| watched.feed.record(recording))
        }
        None => recording,
    };
    if let Some(over) = over {
        finish(app, over);
    }
    begun_in(app, number, name);
}

pub(super) fn end_recording(app: &mut App) {
    let feed = app.jobs.sources.feed();
    if let Some(recording) = feed.and_then(|(_, feed)| feed.end_recording()) {
        finish(app, recording);
    }
}

fn finish(app: &mut App, recording: Arc<Recording>) {
    let path = recording.path.to_string_lossy().into_owned();
    app.jobs.disk(format!("Saving {path}"), move |_| {
        let finished = recording.finish();
        answer(move |app| match finished {
            // Nothing was recorded any more, which has been reported before.
            Ok(None) => {}
            Ok(Some(RecordedFrames { frames: 0, .. })) => {
                inform(
                    app,
                    format!("{path}: no frame came, so nothing was written"),
                );
            }
            Ok(Some(RecordedFrames { frames, left_out })) => {
                let frames = counted(frames, "frame");
                let mut text = format!("{path}: {frames} recorded");
                if left_out > 0 {
                    text += &format!(", {} of another size left out", grouped(left_out));
                }
                inform(app, text);
            }
            Err(error) => refuse(app, error.to_string()),
        })
    });
}

/// Writes out what the recording has gathered.
pub(crate) fn flush(app: &mut App) {
    write(app, "Saving", FrameRecorder::flush);
}

/// Writes to the recording. A failure ends it.
pub(super) fn write(
    app: &mut App,
    what: &str,
    write: impl FnOnce(&mut FrameRecorder) -> Result<(), RecorderError> + Send + 'static,
) {
    if let Some((number, recording)) = app.jobs.sources.recording() {
        let what = format!("{what} {}", recording.path.display());
        app.jobs.disk(what, move |_| {
            let written = recording.write(write);
            answer(move |app| {
                if let Err(error) = written {
                    begun_in(app, number, Err(error.to_string()));
                }
            })
        });
    }
}

/// Begins a recording in a file whose name is free.
fn record_in_free_file(
    access: &WriteAccess,
    metadata: &RecordingMetadata,
) -> Result<(String, Arc<Recording>), String> {
    let mut number = 1_u64;
    loop {
        let name = format!("touch-{number}.npy");
        let path = access.path(&name, Existing::Kept)?;
        if !path.exists() && !path.with_extension("json").exists() {
            let recording = Recording::create(&path, Existing::Kept, metadata);
            let recording = recording.map_err(|error| error.to_string())?;
            return Ok((name, Arc::new(recording)));
        }
        number += 1;
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
    let Ok(device) = path.metadata().map(|file| file.rdev()) else {
        return false;
    };
    let is_here = |name: &str| fs::metadata(name).is_ok_and(|file| file.rdev() == device);
    is_here("/dev/tty")
        || io::stdin().is_terminal() && is_here("/dev/stdin")
        || io::stdout().is_terminal() && is_here("/dev/stdout")
        || io::stderr().is_terminal() && is_here("/dev/stderr")
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
