//! The execution of work: at once or on threads of its own, and how it is stopped there.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::tui::runtime::work::progress::{PoseLimit, WorkerEventSink};

/// A way of doing work.
#[derive(Clone)]
pub(in crate::tui::runtime) enum Execution {
    /// Work is done at once, before the next message, as a script needs it. Work with more poses than the limit is
    /// stopped.
    AtOnce(PoseLimit),
    /// Work is done on threads of its own, which give their events to this sink.
    OnThreads(WorkerEventSink),
}

impl Default for Execution {
    /// Returns the execution at once, for any number of poses.
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
pub(in crate::tui::runtime) struct StopFlag(Arc<AtomicBool>);

impl StopFlag {
    /// Stops the work in progress. Returns the flag that stops the next work when it is set.
    pub(in crate::tui::runtime) fn renew(&mut self) -> Arc<AtomicBool> {
        self.stop();
        self.0 = Arc::default();
        Arc::clone(&self.0)
    }

    /// Stops the work in progress.
    pub(in crate::tui::runtime) fn stop(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Drop for StopFlag {
    fn drop(&mut self) {
        self.stop();
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
