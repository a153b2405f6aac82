//! The pace of a recording that is played back: when each frame is due.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use crate::acquire::event::{AcquireOptions, Playback};
use crate::acquire::followed_file::Growth;
use crate::acquire::ticker::TICK;
use crate::formats::recording::{ChannelChoice, ChannelInfo, RecordingNote};
use crate::frame::Frame;

/// The seconds per frame of a recording that does not state them: ten frames a second.
const STEP: f64 = 0.1;

/// The longest wait for a frame, in seconds: a day.
const LONGEST: f64 = 86_400.0;

/// The longest time between two frames, in seconds, that always counts as a pause, so that playback waits. A longer one
/// counts as a change of the clock if it is also longer than [`PAUSE_RATIO`] times the pause before. An exception is a
/// time about as long as the last change of the clock: then frames or series of frames are regularly that far apart.
const PAUSE: f64 = 60.0;

/// See [`PAUSE`].
const PAUSE_RATIO: f64 = 10.0;

/// The largest ratio of two times between frames that count as about equally long.
const ALIKE: f64 = 2.0;

/// The seconds that playback waits at a change of the clock.
const PLAYED: f64 = 2.0;

/// A function that is called now and then during a wait; it breaks to stop playback.
pub(super) type Tick<'a> = dyn FnMut() -> ControlFlow<()> + 'a;

/// The pace of a recording, from its beginning: when its next frame is due.
pub(super) struct Pace<'a> {
    begun: Instant,
    /// Seconds from one frame to the next, if frames have no time.
    step: f64,
    speed: f64,
    /// The number of frames of the channel so far.
    frames: u32,
    /// The time when the last of them was due, in seconds of the recording.
    last: Option<f64>,
    /// The seconds from the first to the last of them, without changes of the clock.
    played: f64,
    /// The seconds of the last pause between two of them.
    before: f64,
    /// The seconds of the last change of the clock, if the clock was not set back since.
    jump: Option<f64>,
    /// The channel that sets the pace. Playback does not wait for frames of other channels, whether before, between or
    /// after those of this channel.
    channel: ChannelChoice,
    /// The number of values in a frame of the channel, if its rows and columns are unknown.
    unshaped: Option<u64>,
    /// The growth of a file that is followed: once it has grown, playback waits for no frame.
    growth: Option<&'a Growth>,
}

impl<'a> Pace<'a> {
    /// Begins a recording now; `growth` is that of its file, if it is followed.
    pub(super) fn new(options: &AcquireOptions, growth: Option<&'a Growth>) -> Self {
        let speed = match options.playback {
            Playback::Paced { speed, .. } if speed > 0.0 => speed,
            _ => 1.0,
        };
        Self {
            begun: Instant::now(),
            step: STEP,
            speed,
            frames: 0,
            last: None,
            played: 0.0,
            before: STEP,
            jump: None,
            channel: ChannelChoice::new(options.channel.as_deref()),
            unshaped: None,
            growth,
        }
    }

    /// Adds the next channel of the recording.
    pub(super) fn add(&mut self, info: &ChannelInfo) {
        if self.channel.add(info) {
            self.step = info.seconds_per_frame.unwrap_or(STEP);
            self.before = self.step;
            self.unshaped = info.values.filter(|_| info.size.is_none());
        }
    }

    /// Returns true if the channel has had a frame.
    pub(super) fn has_begun(&self) -> bool {
        self.frames > 0
    }

    /// Returns the number of values in a frame of the channel, if its rows and columns are unknown.
    pub(super) fn unshaped(&self) -> Option<u64> {
        self.unshaped
    }

    /// Returns true if a frame belongs to the watched channel and has no rows and columns.
    pub(super) fn has_no_shape(&self, frame: &Frame) -> bool {
        self.unshaped.is_some() && self.channel.takes(frame.channel)
    }

    /// Takes the next frame of the recording. Returns a note if its time shows a change of the clock.
    pub(super) fn take(&mut self, frame: &Frame) -> Option<RecordingNote> {
        if !self.channel.takes(frame.channel) {
            return None;
        }
        let own = f64::from(self.frames) * self.step;
        self.frames = self.frames.saturating_add(1);
        let due = frame.time.unwrap_or(own);
        // Times may count from another channel's first frame, or from the start of a longer recording.
        let last = self.last.replace(due).unwrap_or(due);
        // After a clock was set back, the frame is due at once.
        let gap = (due - last).max(0.0);
        let is_pause = self.is_pause(gap);
        if due < last {
            self.jump = None;
        } else if !is_pause {
            self.jump = Some(gap);
        } else if gap > 0.0 {
            self.before = gap;
        }
        self.played += if is_pause { gap } else { PLAYED };
        (!is_pause && !self.has_grown()).then_some(RecordingNote::Gap {
            frame: frame.number,
            seconds: gap,
            played: PLAYED,
        })
    }

    /// Returns true if a time between two frames, in seconds, is a pause and no change of the clock.
    fn is_pause(&self, gap: f64) -> bool {
        let is_alike = |jump: f64| (jump / ALIKE..=jump * ALIKE).contains(&gap);
        gap <= PAUSE.max(PAUSE_RATIO * self.before) || self.jump.is_some_and(is_alike)
    }

    /// Returns true if the recording is a file that has grown, so that playback does not wait.
    fn has_grown(&self) -> bool {
        self.growth.is_some_and(Growth::has_grown)
    }

    /// Waits until the last frame that was taken is due. Calls `tick` meanwhile, and returns `Break` if it does.
    pub(super) fn wait(&self, tick: &mut Tick<'_>) -> ControlFlow<()> {
        self.until(self.played, tick)
    }

    /// Waits for the duration of one frame after the last frame, so that a repeated recording keeps its pace.
    pub(super) fn wait_for_end(&self, tick: &mut Tick<'_>) -> ControlFlow<()> {
        if self.frames == 0 {
            return ControlFlow::Continue(());
        }
        let mean = self.played / f64::from(self.frames - 1);
        let step = if mean > 0.0 && mean.is_finite() {
            mean
        } else {
            self.step
        };
        self.until(self.played + step, tick)
    }

    /// Waits until this many seconds have been played.
    fn until(&self, seconds: f64, tick: &mut Tick<'_>) -> ControlFlow<()> {
        let longest = self.begun.elapsed().as_secs_f64() + LONGEST;
        // Of infinite times at an infinite speed, the quotient is NaN; `max` drops it.
        let seconds = (seconds / self.speed).max(0.0).min(longest);
        let due = self.begun + Duration::from_secs_f64(seconds);
        loop {
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() || self.has_grown() {
                return ControlFlow::Continue(());
            }
            tick()?;
            std::thread::sleep(left.min(TICK));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_frames_of_the_channel_that_is_watched_are_waited_for() {
        let options = AcquireOptions {
            channel: Some("right".to_owned()),
            // A speed of 0 counts as 1.
            playback: Playback::Paced {
                speed: 0.0,
                repeat: false,
            },
            ..AcquireOptions::default()
        };
        let mut pace = Pace::new(&options, None);
        (pace.step, pace.before) = (10_000.0, 10_000.0);
        for (name, is_watched) in [("left", false), ("right", true)] {
            let name = Some(name.to_owned());
            let info = ChannelInfo {
                name,
                ..ChannelInfo::default()
            };
            assert_eq!(pace.channel.add(&info), is_watched);
        }
        let mut frame = Frame::default();
        let mut waits = |frame: &Frame| {
            pace.take(frame);
            pace.wait(&mut || ControlFlow::Break(())).is_break()
        };
        frame.time = Some(1000.0);
        assert!(!waits(&frame), "of the other channel");
        (frame.channel, frame.time) = (1, None);
        assert!(!waits(&frame), "the first one");
        assert!(waits(&frame), "the second one");
    }

    #[test]
    fn the_first_frame_is_not_waited_for_even_if_its_time_is_late() {
        let mut pace = Pace::new(&AcquireOptions::default(), None);
        pace.channel.add(&ChannelInfo::default());
        let mut frame = Frame::default();
        for (time, is_waited_for) in [(1000.0, false), (1000.0, false), (2000.0, true)] {
            frame.time = Some(time);
            pace.take(&frame);
            let wait = pace.wait(&mut || ControlFlow::Break(()));
            assert_eq!(wait.is_break(), is_waited_for, "{time}");
        }
    }

    /// Returns the notes about frames at these times, and the seconds that are played.
    fn notes(times: &[f64]) -> (Vec<String>, f64) {
        let mut pace = Pace::new(&AcquireOptions::default(), None);
        // All frames are due.
        let begun = Instant::now().checked_sub(Duration::from_secs(36_000));
        pace.begun = begun.expect("later");
        pace.channel.add(&ChannelInfo::default());
        let mut frame = Frame::default();
        let mut notes = Vec::new();
        for (number, &time) in (0..).zip(times) {
            (frame.number, frame.time) = (number, Some(time));
            notes.extend(pace.take(&frame).map(|note| note.to_string()));
            let flow = pace.wait(&mut || ControlFlow::Break(()));
            assert!(flow.is_continue(), "frame {number} is not due");
        }
        (notes, pace.played)
    }

    #[test]
    fn a_change_of_the_clock_is_said_and_played_as_a_moment() {
        let (said, played) = notes(&[0.0, 0.5, 1e9, 1e9 + 0.5, 3.0, 3.5]);
        let expected = "frame 2 comes 11,574 days after the one before; this pause is played as 2 s at normal speed";
        assert_eq!((said, played), (vec![expected.to_owned()], 3.5));
        for pauses in [[0.0, 0.1, 59.0, 59.1], [0.0, 50.0, 500.0, 3000.0]] {
            let (said, played) = notes(&pauses);
            assert!(said.is_empty() && (played - pauses[3]).abs() < 1e-9);
        }
        // A clock that is wrong again and again.
        let (said, played) = notes(&[0.0, 0.5, 1e9, 1.0, 1e9, 1.5]);
        assert_eq!((said.len(), played), (2, 4.5));
    }

    #[test]
    fn a_gap_that_is_usual_for_a_recording_is_not_said() {
        let single = [0.0, 300.0, 610.0, 900.0, 1200.0];
        let series = [0.0, 0.5, 400.0, 400.5, 650.0, 650.5];
        for (times, first, waited) in [(&single[..], 1, 900.0), (&series, 2, 251.0)] {
            let (said, played) = notes(times);
            assert!(said[0].starts_with(&format!("frame {first} ")), "{said:?}");
            assert_eq!((said.len(), played), (1, PLAYED + waited));
        }
        // The second gap is four times as long as the first.
        let (said, played) = notes(&[0.0, 0.5, 400.0, 400.5, 2000.0, 2000.5]);
        assert_eq!((said.len(), played), (2, 2.0 * PLAYED + 1.5));
    }

    #[test]
    fn a_recording_that_plays_for_days_keeps_its_pace() {
        let mut pace = Pace::new(&AcquireOptions::default(), None);
        let begun = Instant::now().checked_sub(Duration::from_secs(48 * 3600));
        pace.begun = begun.expect("later");
        let waits = |seconds: f64| {
            pace.until(seconds, &mut || ControlFlow::Break(()))
                .is_break()
        };
        assert!(!waits(47.0 * 3600.0), "it was due an hour ago");
        assert!(waits(49.0 * 3600.0), "it is due in an hour");
        assert!(waits(f64::INFINITY));
    }

    #[test]
    fn the_last_frame_of_a_round_lasts_as_long_as_the_others() {
        let with = |times: &[Option<f64>]| {
            let mut pace = Pace::new(&AcquireOptions::default(), None);
            // All frames are due.
            pace.begun = Instant::now()
                .checked_sub(Duration::from_secs(2 * 3600))
                .expect("later");
            (pace.step, pace.before) = (4000.0, 4000.0);
            let tick = &mut || ControlFlow::Break(());
            let mut frame = Frame::default();
            for &time in times {
                frame.time = time;
                pace.take(&frame);
                assert!(pace.wait(tick).is_continue());
            }
            pace.wait_for_end(tick).is_break()
        };
        assert!(with(&[None, None]), "until 8,000 s, and 7,200 are gone");
        assert!(!with(&[None]), "until 4,000 s");
        // Counted from the first frame, whose own time does not matter.
        assert!(with(&[Some(1000.0), Some(5000.0)]), "until 8,000 s");
        let often = [1000.0, 2000.0, 3000.0, 4000.0, 5000.0, 6000.0].map(Some);
        assert!(!with(&often), "until 6,000 s: they are not 4,000 s apart");
        assert!(!with(&[]), "there is none");
    }
}
