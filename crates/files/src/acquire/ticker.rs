//! The ticks of an acquisition, on which a consumer writes out and checks what waits.

use std::time::{Duration, Instant};

/// The time between two ticks, and the longest wait until it is asked again whether more is wanted.
pub(super) const TICK: Duration = Duration::from_millis(100);

/// A clock that says when the next tick is due, however often frames arrive.
#[derive(Debug)]
pub(super) struct Ticker {
    last: Instant,
}

impl Ticker {
    /// Creates a clock whose first tick is due after [`TICK`].
    pub(super) fn new() -> Self {
        Self {
            last: Instant::now(),
        }
    }

    /// Returns true if a tick is due; the next one is due [`TICK`] later.
    pub(super) fn is_due(&mut self) -> bool {
        let now = Instant::now();
        let is_due = now - self.last >= TICK;
        if is_due {
            self.last = now;
        }
        is_due
    }
}
