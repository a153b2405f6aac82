//! The clock of a stream's source.

use crate::formats::recording::moment::{Midnights, Moment};
use crate::formats::seconds::since;

/// Counts the times that frames bring with them from that of the first one. It outlives the decoder that reads it: what comes
/// after a gap counts from the same frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SourceClock {
    /// The time of the first frame.
    start: Option<f64>,
    /// The midnights that clocks without a date have passed.
    midnights: Midnights,
}

impl SourceClock {
    /// The time that a moment is, in seconds. Each moment passes here once, in the order of the stream.
    pub(super) fn read(&mut self, moment: Moment) -> f64 {
        self.midnights.seconds(moment)
    }

    /// The seconds from the first frame to one with this time.
    pub(super) fn since_first(&mut self, time: f64) -> f64 {
        since(*self.start.get_or_insert(time), time)
    }
}
