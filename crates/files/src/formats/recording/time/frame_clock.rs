//! A clock that turns the times of frames into seconds since the first one.

use crate::formats::recording::event::RecordingNote;
use crate::formats::recording::time::exact::Time;
use crate::formats::recording::time::moment::{Midnights, Moment};
use crate::formats::recording::time::unit::TimeUnit;

/// The clock of a recording or a stream. After a gap in a stream it passes to the next decoder, so that times
/// continue from the same frame.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::formats) struct FrameClock {
    /// The unit of numbers; None if it is not named, until the size of the first number decides it.
    unit: Option<TimeUnit>,
    /// The time of the first frame.
    start: Option<Time>,
    /// The midnights passed so far, for timestamps without a date.
    midnights: Midnights,
    /// The unit that was derived from the size alone, until it is noted.
    assumed: Option<TimeUnit>,
}

impl FrameClock {
    /// Sets the unit of the numbers to come; None if nothing names it.
    pub(in crate::formats::recording) fn set_unit(&mut self, unit: Option<TimeUnit>) {
        self.unit = unit;
    }

    /// Returns the unit of a number. If nothing names it, the size of the first number decides it for all.
    pub(in crate::formats::recording) fn unit(&mut self, number: f64) -> TimeUnit {
        if let Some(unit) = self.unit {
            return unit;
        }
        let unit = TimeUnit::by_size(number);
        self.unit = Some(unit);
        self.assumed = Some(unit).filter(|&unit| unit != TimeUnit::Seconds);
        unit
    }

    /// Returns the time in a field whose value is `number`.
    pub(in crate::formats::recording) fn number(&mut self, field: &[u8], number: f64) -> Time {
        let unit = self.unit(number);
        Time::read(field, number, unit)
    }

    /// Returns the time of a timestamp. Must be called once for each timestamp, in their order.
    pub(in crate::formats) fn moment(&mut self, moment: Moment) -> Time {
        Time::Seconds(self.midnights.seconds(moment))
    }

    /// Returns the seconds from the first frame to a frame with this time.
    pub(in crate::formats) fn since_first(&mut self, time: Time) -> f64 {
        time.since(*self.start.get_or_insert(time))
    }

    /// Returns once a note about a unit that was derived from the size of a time, unless it is seconds.
    pub(in crate::formats) fn take_note(&mut self) -> Option<RecordingNote> {
        let unit = self.assumed.take()?;
        Some(RecordingNote::TimeUnit { unit: unit.name() })
    }
}
