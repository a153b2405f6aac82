//! The clock of a stream's source.

use crate::formats::recording::time::moment::{Midnights, Moment};
use crate::formats::seconds::since;

/// A clock that turns the times of frames into seconds since the first frame. After a gap it passes to the next
/// decoder, so that times continue from the same frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SourceClock {
    /// The time of the first frame.
    start: Option<f64>,
    /// The midnights passed so far, for timestamps without a date.
    midnights: Midnights,
}

impl SourceClock {
    /// Returns a timestamp in seconds. Must be called once for each timestamp, in the order of the stream.
    pub(super) fn read(&mut self, moment: Moment) -> f64 {
        self.midnights.seconds(moment)
    }

    /// Returns the seconds from the first frame to a frame with this time.
    pub(super) fn since_first(&mut self, time: f64) -> f64 {
        since(*self.start.get_or_insert(time), time)
    }
}
