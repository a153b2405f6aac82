//! The pace of a recording that is played back: when each frame is due.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::acquire::event::{AcquireEvent, AcquireOptions, Playback};
use crate::acquire::followed_file::Growth;
use crate::acquire::stream::Consumer;
use crate::formats::recording::{ChannelChoice, ChannelInfo, RecordingNote};
use crate::formats::stream::StreamCounts;
use crate::frame::Frame;

/// The seconds per frame of a recording that does not state them: ten frames a second.
const STEP: f64 = 0.1;

/// The length of the pieces into which waits are divided, so that they can be interrupted.
pub(super) const MOMENT: Duration = Duration::from_millis(100);

/// The longest wait for a frame, in seconds: a day.
const LONGEST: f64 = 86_400.0;

/// The longest time between two frames, in seconds, that always counts as a pause and is waited for. A longer one
/// counts as a change of the clock if it is also longer than [`PAUSE_RATIO`] times the one before.
const PAUSE: f64 = 60.0;

/// See [`PAUSE`].
const PAUSE_RATIO: f64 = 10.0;

/// The seconds that a change of the clock is played as.
const PLAYED: f64 = 2.0;

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
    /// The seconds between the last two.
    before: f64,
    /// The channel that sets the pace. Frames of other channels, before, between or after its own, are not waited
    /// for.
    channel: ChannelChoice,
    /// The number of values in a frame of the channel, if its rows and columns are unknown.
    unshaped: Option<u64>,
    /// The growth of a file that is followed: once it has grown, no frame is waited for.
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

    /// Returns true if a frame is one of the watched channel, and has no rows and columns.
    pub(super) fn has_no_shape(&self, frame: &Frame) -> bool {
        self.unshaped.is_some() && self.channel.takes(frame.channel)
    }

    /// Waits until a frame is due. Returns `Break` if no more is wanted.
    pub(super) fn wait(
        &mut self,
        frame: &Frame,
        stop: &AtomicBool,
        consumer: &mut Consumer<'_>,
    ) -> ControlFlow<()> {
        if !self.channel.takes(frame.channel) {
            return ControlFlow::Continue(());
        }
        let own = f64::from(self.frames) * self.step;
        self.frames = self.frames.saturating_add(1);
        let due = frame.time.unwrap_or(own);
        // Times may count from another channel's first frame, or from the start of a longer recording.
        let last = self.last.replace(due).unwrap_or(due);
        // After a clock was set back, the frame is due at once.
        let gap = (due - last).max(0.0);
        let is_pause = gap <= PAUSE.max(PAUSE_RATIO * self.before);
        if gap > 0.0 && is_pause {
            self.before = gap;
        }
        if !is_pause && !self.growth.is_some_and(Growth::has_grown) {
            let note = RecordingNote::Gap {
                frame: frame.number,
                seconds: gap,
                played: PLAYED,
            };
            consumer(AcquireEvent::Note(&note))?;
        }
        self.played += if is_pause { gap } else { PLAYED };
        self.until(self.played, stop, consumer)
    }

    /// Waits after the last frame as long as one frame lasts, so that a repeated recording keeps its pace.
    pub(super) fn last_frame(
        &self,
        stop: &AtomicBool,
        consumer: &mut Consumer<'_>,
    ) -> ControlFlow<()> {
        if self.frames == 0 {
            return ControlFlow::Continue(());
        }
        let mean = self.played / f64::from(self.frames - 1);
        let step = if mean > 0.0 && mean.is_finite() {
            mean
        } else {
            self.step
        };
        self.until(self.played + step, stop, consumer)
    }

    /// Waits until this many seconds have been played.
    fn until(
        &self,
        seconds: f64,
        stop: &AtomicBool,
        consumer: &mut Consumer<'_>,
    ) -> ControlFlow<()> {
        let longest = self.begun.elapsed().as_secs_f64() + LONGEST;
        let seconds = (seconds / self.speed).clamp(0.0, longest);
        let due = self.begun + Duration::from_secs_f64(seconds);
        loop {
            let left = due.saturating_duration_since(Instant::now());
            if stop.load(Ordering::Relaxed) {
                return ControlFlow::Break(());
            }
            if left.is_zero() || self.growth.is_some_and(Growth::has_grown) {
                return ControlFlow::Continue(());
            }
            consumer(AcquireEvent::Tick(&StreamCounts::default()))?;
            std::thread::sleep(left.min(MOMENT));
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
            // The consumer stops it at the first wait.
            let consumer = &mut |_: AcquireEvent<'_>| ControlFlow::Break(());
            pace.wait(frame, &AtomicBool::new(false), consumer)
                .is_break()
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
        let consumer = &mut |_: AcquireEvent<'_>| ControlFlow::Break(());
        let mut frame = Frame::default();
        for (time, is_waited_for) in [(1000.0, false), (1000.0, false), (2000.0, true)] {
            frame.time = Some(time);
            let wait = pace.wait(&frame, &AtomicBool::new(false), consumer);
            assert_eq!(wait.is_break(), is_waited_for, "{time}");
        }
    }

    #[test]
    fn a_change_of_the_clock_is_said_and_played_as_a_moment() {
        let notes = |times: &[f64]| {
            let mut pace = Pace::new(&AcquireOptions::default(), None);
            // All frames are due.
            let begun = Instant::now().checked_sub(Duration::from_secs(36_000));
            pace.begun = begun.expect("later");
            pace.channel.add(&ChannelInfo::default());
            let mut frame = Frame::default();
            let mut notes = Vec::new();
            for (number, &time) in (0..).zip(times) {
                (frame.number, frame.time) = (number, Some(time));
                let flow = pace.wait(&frame, &AtomicBool::new(false), &mut |event| {
                    match event {
                        AcquireEvent::Note(note) => notes.push(note.to_string()),
                        _ => return ControlFlow::Break(()),
                    }
                    ControlFlow::Continue(())
                });
                assert!(flow.is_continue(), "frame {number} is not due");
            }
            (notes, pace.played)
        };
        let (said, played) = notes(&[0.0, 0.5, 1e9, 1e9 + 0.5, 3.0, 3.5]);
        let expected = "frame 2 comes 11,574 days after the one before, which is played as 2 s at normal speed";
        assert_eq!((said, played), (vec![expected.to_owned()], 3.5));
        for pauses in [[0.0, 0.1, 59.0, 59.1], [0.0, 50.0, 500.0, 3000.0]] {
            let (said, played) = notes(&pauses);
            assert!(said.is_empty() && (played - pauses[3]).abs() < 1e-9);
        }
    }

    #[test]
    fn a_recording_that_plays_for_days_keeps_its_pace() {
        let mut pace = Pace::new(&AcquireOptions::default(), None);
        let begun = Instant::now().checked_sub(Duration::from_secs(48 * 3600));
        pace.begun = begun.expect("later");
        let waits = |seconds: f64| {
            let consumer = &mut |_: AcquireEvent<'_>| ControlFlow::Break(());
            let wait = pace.until(seconds, &AtomicBool::new(false), consumer);
            wait.is_break()
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
            let stop = AtomicBool::new(false);
            let consumer = &mut |_: AcquireEvent<'_>| ControlFlow::Break(());
            let mut frame = Frame::default();
            for &time in times {
                frame.time = time;
                assert!(pace.wait(&frame, &stop, consumer).is_continue());
            }
            pace.last_frame(&stop, consumer).is_break()
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
