//! How work is done: at once or on threads of its own, how it is stopped there, and how it reports.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use taxel_core::lock::try_locked;
use taxel_core::progress::{Progress, stop_if};
use taxel_files::formats::file::system_reason;
use taxel_files::memory::MemoryGuard;

use crate::tui::app::message::WorkerEvent;
use crate::tui::explore::message::SweepProgress;

const PAUSE: Duration = Duration::from_millis(5);

#[derive(Clone)]
pub(crate) enum Execution {
    AtOnce(PoseLimit),
    OnThreads(WorkerEventSink),
}

impl Default for Execution {
    fn default() -> Self {
        Self::AtOnce(PoseLimit::default())
    }
}

impl fmt::Debug for Execution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AtOnce(limit) => f.debug_tuple("AtOnce").field(limit).finish(),
            Self::OnThreads(_) => f.write_str("OnThreads"),
        }
    }
}

/// A flag that stops the work in progress: on request, when the next work begins, and when it is dropped.
#[derive(Debug, Default)]
pub(crate) struct StopFlag(Arc<AtomicBool>);

impl StopFlag {
    pub(crate) fn renew(&mut self) -> Arc<AtomicBool> {
        self.stop();
        self.0 = Arc::default();
        Arc::clone(&self.0)
    }

    pub(crate) fn stop(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Drop for StopFlag {
    fn drop(&mut self) {
        self.stop();
    }
}

pub(crate) fn start(body: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>, String> {
    let thread = Builder::new().spawn(body);
    thread.map_err(|error| format!("cannot start a thread: {}", system_reason(&error)))
}

/// Waits for a thread to end, but not for longer than `patience`. It is not joined: a disk or a host that does not
/// answer may hold it up.
pub(crate) fn wait_until_finished(thread: &JoinHandle<()>, patience: Duration) {
    let begun = Instant::now();
    while !thread.is_finished() && begun.elapsed() < patience {
        std::thread::sleep(PAUSE);
    }
}

pub(crate) type WorkerEventSink = Arc<dyn Fn(WorkerEvent) + Send + Sync>;

const PROGRESS_INTERVAL: Duration = Duration::from_millis(100);

pub(crate) struct ProgressReporter<'a> {
    number: u64,
    post: &'a WorkerEventSink,
    start: Instant,
    poses: AtomicU64,
    last: Mutex<Instant>,
}

impl<'a> ProgressReporter<'a> {
    pub(crate) fn new(number: u64, post: &'a WorkerEventSink) -> Self {
        let start = Instant::now();
        Self {
            number,
            post,
            start,
            poses: AtomicU64::new(0),
            last: Mutex::new(start),
        }
    }

    fn add(&self, poses: u64) {
        let poses = self.poses.fetch_add(poses, Ordering::Relaxed) + poses;
        // A thread that finds the lock taken leaves the report to the other one.
        if let Some(mut last) = try_locked(&self.last)
            && last.elapsed() >= PROGRESS_INTERVAL
        {
            *last = Instant::now();
            let elapsed = self.start.elapsed();
            (self.post)(WorkerEvent::Progress(
                self.number,
                SweepProgress { poses, elapsed },
            ));
        }
    }
}

pub(crate) fn on_a_thread(
    number: u64,
    post: &WorkerEventSink,
    work: impl FnOnce(&WorkerEventSink) + Send + 'static,
) -> Result<JoinHandle<()>, WorkerEvent> {
    let own = Arc::clone(post);
    let thread = start(move || work(&own));
    thread.map_err(|message| WorkerEvent::Failed(number, message))
}

/// Turns a panic into an event; without it the program would wait for ever.
pub(crate) fn guarded(number: u64, work: impl FnOnce() -> WorkerEvent) -> WorkerEvent {
    caught(work).unwrap_or_else(|message| WorkerEvent::Failed(number, message))
}

pub(crate) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    let done = catch_unwind(AssertUnwindSafe(work));
    done.map_err(|_| "the work failed; this is a bug".to_owned())
}

/// The largest number of poses of a piece of work that is done at once; None for any number.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PoseLimit(pub(crate) Option<u64>);

/// The progress of a piece of work on the screen. It knows nothing of memory, so work reports to it only within a guard.
pub(crate) struct WorkProgress<'a>(Box<dyn Progress + 'a>);

impl<'a> WorkProgress<'a> {
    pub(crate) fn up_to(limit: PoseLimit) -> Self {
        let all = AtomicU64::new(0);
        Self(Box::new(move |poses| {
            let all = all.fetch_add(poses, Ordering::Relaxed) + poses;
            stop_if(limit.0.is_some_and(|most| all > most))
        }))
    }

    pub(crate) fn until(stop: &'a AtomicBool, clock: Option<&'a ProgressReporter<'a>>) -> Self {
        Self(Box::new(move |poses| {
            if let Some(clock) = clock {
                clock.add(poses);
            }
            stop_if(stop.load(Ordering::Relaxed))
        }))
    }

    pub(crate) fn within<T>(
        &self,
        memory: &MemoryGuard,
        work: impl FnOnce(&dyn Progress) -> T,
    ) -> Result<T, String> {
        memory.limit(&*self.0, work)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_stopped_by_new_work_and_at_the_end() {
        let is_set = |stop: &AtomicBool| stop.load(Ordering::Relaxed);
        let mut flag = StopFlag::default();
        let first = flag.renew();
        assert!(!is_set(&first));
        let second = flag.renew();
        assert!(is_set(&first) && !is_set(&second));
        drop(flag);
        assert!(is_set(&second), "nothing is left behind");
    }
}
