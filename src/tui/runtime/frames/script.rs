//! Reads a source of frames for a script, which has no clock: a frame comes when it is asked for.
//!
//! ```text
//! script           thread
//! next  -- more -> reads on                 the file stays open between two requests,
//!       <- batch - waits                    so a recording is read once
//! ```
//! Only one of the two runs at a time, so a script does the same every time.

use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use crate::acquire::{FrameSource, Playback};
use crate::tui::live::message::FrameBatch;
use crate::tui::live::request::WatchRequest;
use crate::tui::runtime::frames::feed::FrameFeed;
use crate::tui::runtime::frames::recording::Recording;
use crate::tui::runtime::work::execution::start;

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
