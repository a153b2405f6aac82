//! Work that the user waits for, and when the screen says so.

use std::time::{Duration, Instant};

/// After this time the screen says what is waited for.
const SLOW_AFTER: Duration = Duration::from_millis(300);

/// The time after which that is looked at again.
const RECHECK: Duration = Duration::from_millis(500);

/// Work that has begun.
#[derive(Clone, Debug)]
pub(super) struct SlowWork {
    /// What it does, in a few words.
    pub(super) words: String,
    /// When it was asked for.
    since: Instant,
}

impl SlowWork {
    /// Work that begins now.
    pub(super) fn new(words: String) -> Self {
        Self {
            words,
            since: Instant::now(),
        }
    }

    /// When to look at it again.
    pub(super) fn next_check(&self) -> Instant {
        let now = Instant::now();
        let slow = self.since + SLOW_AFTER;
        if slow > now { slow } else { now + RECHECK }
    }

    /// What it does and what it waits for, if it takes long.
    pub(super) fn status(&self, what: &str) -> Option<String> {
        let text = || format!("{}: waiting for {what}", self.words);
        (self.since.elapsed() >= SLOW_AFTER).then(text)
    }
}
