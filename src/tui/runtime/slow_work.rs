//! Work that the user waits for, and the time after which the screen says so.

use std::time::{Duration, Instant};

/// The time after which the screen says that the user waits for work.
const SLOW_AFTER: Duration = Duration::from_millis(300);

/// The interval between later checks.
const RECHECK: Duration = Duration::from_millis(500);

/// Work that has begun.
#[derive(Clone, Debug)]
pub(super) struct SlowWork {
    /// The description of the work, in a few words.
    pub(super) words: String,
    /// The time when it was asked for.
    since: Instant,
}

impl SlowWork {
    /// Returns work that begins now.
    pub(super) fn new(words: String) -> Self {
        Self {
            words,
            since: Instant::now(),
        }
    }

    /// Returns the time of the next check.
    pub(super) fn next_check(&self) -> Instant {
        let now = Instant::now();
        let slow = self.since + SLOW_AFTER;
        if slow > now { slow } else { now + RECHECK }
    }

    /// Returns the description of the work and of what it waits for, if it takes long.
    pub(super) fn status(&self, what: &str) -> Option<String> {
        Some(format!("{}: waiting for {what}", self.slow_words()?))
    }

    /// Returns the description of the work, if it takes long.
    pub(super) fn slow_words(&self) -> Option<&str> {
        (self.since.elapsed() >= SLOW_AFTER).then_some(&*self.words)
    }
}
