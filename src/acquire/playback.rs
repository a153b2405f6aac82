//! Plays a recording back at its own rate, at another rate, or as fast as possible; or follows it while it is
//! written.

use std::cell::RefCell;
use std::fs::File;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::acquire::arrival_clock::ArrivalClock;
use crate::acquire::event::{AcquireError, AcquireEvent, AcquireOptions, Playback};
use crate::acquire::followed_file::{self, FollowEnd, FollowedFile, Growth};
use crate::acquire::recorder::description_beside;
use crate::acquire::stream::Consumer;
use crate::formats::recording::{
    ChannelChoice, ChannelInfo, ReadOptions, RecordingError, RecordingEvent, RecordingFormat,
    RecordingInput, RecordingMetadata, RecordingNote, format_of, read_as, recognised_input,
};
use crate::formats::stream::StreamCounts;
use crate::frame::Frame;

/// The seconds per frame of a recording that does not state them: ten frames a second.
const STEP: f64 = 0.1;

/// The length of the pieces into which waits are divided, so that they can be interrupted.
const MOMENT: Duration = Duration::from_millis(100);

/// The longest wait for a frame, in seconds: a day.
const LONGEST: f64 = 86_400.0;

/// The longest time between two frames, in seconds, that always counts as a pause and is waited for. A longer one
/// counts as a change of the clock if it is also longer than [`PAUSE_RATIO`] times the one before.
const PAUSE: f64 = 60.0;

/// See [`PAUSE`].
const PAUSE_RATIO: f64 = 10.0;

/// The seconds that a change of the clock is played as.
const PLAYED: f64 = 2.0;

/// Creates the error for a followed file whose place a recording of another kind has taken.
fn replaced_by(format: RecordingFormat) -> RecordingError {
    RecordingError::damaged(format!(
        "replaced by a recording in the format {}, whose end cannot be followed",
        format.name()
    ))
}

/// The pace of a recording: when its next frame is due.
struct Pace<'a> {
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

impl Pace<'_> {
    fn new(options: &AcquireOptions) -> Self {
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
            growth: None,
        }
    }

    /// Adds the next channel of the recording.
    fn add(&mut self, info: &ChannelInfo) {
        if self.channel.add(info) {
            self.step = info.seconds_per_frame.unwrap_or(STEP);
            self.before = self.step;
            self.unshaped = info.values.filter(|_| info.size.is_none());
        }
    }

    /// Returns true if a frame is one of the watched channel, and has no rows and columns.
    fn has_no_shape(&self, frame: &Frame) -> bool {
        self.unshaped.is_some() && self.channel.takes(frame.channel)
    }

    /// Waits until a frame is due. Returns `Break` if no more is wanted.
    fn wait(
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
    fn last_frame(&self, stop: &AtomicBool, consumer: &mut Consumer<'_>) -> ControlFlow<()> {
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

/// Plays a recording. If it grows meanwhile, it is followed: its present frames are given at once, then each frame as
/// it comes.
pub(super) fn run(
    path: &Path,
    options: &AcquireOptions,
    stop: &AtomicBool,
    consumer: &mut Consumer<'_>,
) -> Result<(), AcquireError> {
    let ControlFlow::Continue(description) = description_of(path, consumer) else {
        return Ok(());
    };
    let player = Player {
        options,
        stop,
        description,
        consumer: RefCell::new(consumer),
        counts: RefCell::default(),
    };
    let file = File::open(path).map_err(AcquireError::opening)?;
    let format = format_of(file, ReadOptions::default())?;
    if options.playback != Playback::Live || !format.is_appended_to() {
        player.play(path, format)
    } else {
        player.follow(path, format)
    }
}

/// A player of a recording.
struct Player<'a, 'b> {
    options: &'a AcquireOptions,
    stop: &'a AtomicBool,
    /// The description beside the recording.
    description: Option<RecordingMetadata>,
    /// The consumer of what is read, and of a tick now and then while more is waited for.
    consumer: RefCell<&'a mut Consumer<'b>>,
    /// The counts of wrong frames in a followed file.
    counts: RefCell<StreamCounts>,
}

/// A channel that was reported.
struct KnownChannel {
    name: Option<String>,
    /// The number of its first frame in this round.
    first: u64,
    /// The number of its next frame.
    next: u64,
}

/// The state of one reading of a recording from its beginning to its end.
#[derive(Default)]
struct Round<'a> {
    /// The channels of all rounds, in the order in which they were reported.
    channels: Vec<KnownChannel>,
    /// For each channel of this round, its index in `channels`: a file that takes the place of another may begin with
    /// another channel.
    order: Vec<usize>,
    /// The times of the frames.
    times: ArrivalClock,
    /// The growth of the file, if it is followed.
    growth: Option<&'a Growth>,
}

impl Round<'_> {
    /// Adds the next channel of this round. Returns true if no round had it before.
    fn add(&mut self, info: &ChannelInfo) -> bool {
        let mut known = self.channels.iter().enumerate();
        // Several channels may have the same name, or none.
        let known = known
            .position(|(index, channel)| channel.name == info.name && !self.order.contains(&index));
        self.order.push(known.unwrap_or(self.channels.len()));
        if known.is_none() {
            self.channels.push(KnownChannel {
                name: info.name.clone(),
                first: 0,
                next: 0,
            });
        }
        known.is_none()
    }

    /// Returns the channel and the number, over all rounds, of a frame of this round.
    fn place(&mut self, frame: &Frame) -> (usize, u64) {
        let own = (frame.channel, frame.number);
        let Some(&index) = self.order.get(frame.channel) else {
            return own;
        };
        let Some(channel) = self.channels.get_mut(index) else {
            return own;
        };
        let number = channel.first + frame.number;
        channel.next = number + 1;
        (index, number)
    }

    /// Returns true if any round had a frame.
    fn has_frames(&self) -> bool {
        self.channels.iter().any(|channel| channel.next > 0)
    }

    /// Begins the next round. Its frames are counted on if it has another file.
    fn begin(&mut self, counts_on: bool) {
        self.order.clear();
        for channel in &mut self.channels {
            channel.first = if counts_on { channel.next } else { 0 };
        }
    }
}

impl Player<'_, '_> {
    /// Plays a file, once or again and again.
    fn play(&self, path: &Path, format: RecordingFormat) -> Result<(), AcquireError> {
        let mut file = File::open(path).map_err(AcquireError::opening)?;
        let mut round = Round::default();
        let repeats = self.options.playback.repeats();
        loop {
            let (pace, read) = self.round(format, &mut file, &mut round);
            // A recording without frames is not repeated: it would be read again and again without a pause.
            let ends = read?.is_break() || !repeats || pace.frames == 0;
            let consumer = &mut **self.consumer.borrow_mut();
            if ends
                || pace.last_frame(self.stop, consumer).is_break()
                || consumer(AcquireEvent::Again).is_break()
            {
                return Ok(());
            }
            round.begin(false);
        }
    }

    /// Plays a file, and follows what is written at its end.
    fn follow(&self, path: &Path, mut format: RecordingFormat) -> Result<(), AcquireError> {
        let (mut file, growth) = followed_file::open(path).map_err(AcquireError::opening)?;
        let mut round = Round {
            growth: Some(&growth),
            ..Round::default()
        };
        loop {
            let waiting = &mut || self.tick();
            let mut followed =
                FollowedFile::new(file, &growth, waiting).map_err(AcquireError::opening)?;
            let (_, read) = self.round(format, &mut followed, &mut round);
            let end;
            (file, end) = followed.into_parts();
            let how = match end {
                None => return read.map(drop).map_err(AcquireError::from),
                Some(FollowEnd::Stopped) => return Ok(()),
                // An error in the end that was torn by the change does not count.
                Some(FollowEnd::Anew(how)) => how,
            };
            if (self.consumer.borrow_mut())(AcquireEvent::Anew(how)).is_break() {
                return Ok(());
            }
            round.begin(true);
            round.times.rejoin();
            // The beginning of the new content may not be written yet.
            format = loop {
                match File::open(path).and_then(recognised_input) {
                    Ok(Some(format)) if format.is_appended_to() => break format,
                    Ok(Some(other)) => return Err(replaced_by(other).into()),
                    Ok(None) | Err(_) if self.tick().is_break() => return Ok(()),
                    Ok(None) | Err(_) => std::thread::sleep(MOMENT),
                }
            };
        }
    }

    /// Reports a tick. Returns `Break` if no more is wanted.
    fn tick(&self) -> ControlFlow<()> {
        if self.stop.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        (self.consumer.borrow_mut())(AcquireEvent::Tick(&self.counts.borrow()))
    }

    /// Leaves out and counts a wrong frame of a followed file if there were frames before it: a program that was
    /// interrupted writes on behind a torn line. A file that may be about to grow is waited for. Returns `Break` if
    /// the error ends the reading.
    fn leave_out(
        &self,
        error: &RecordingError,
        bytes: &[u8],
        round: &Round<'_>,
    ) -> ControlFlow<()> {
        let Some(growth) = round.growth.filter(|_| round.has_frames()) else {
            return ControlFlow::Break(());
        };
        while !growth.has_grown() {
            if !growth.may_go_on() {
                return ControlFlow::Break(());
            }
            self.tick()?;
            std::thread::sleep(MOMENT);
        }
        let mut counts = self.counts.borrow_mut();
        counts.drop_frames(1, bytes);
        counts.reason = Some(error.to_string());
        ControlFlow::Continue(())
    }

    /// Reads a recording from its beginning to its end. Returns the pace that it reached, and whether no more is
    /// wanted.
    fn round<'r>(
        &self,
        format: RecordingFormat,
        input: &mut dyn RecordingInput,
        round: &mut Round<'r>,
    ) -> (Pace<'r>, Result<ControlFlow<()>, RecordingError>) {
        let reading = ReadOptions {
            size: self.options.size,
            leaves_out: round.growth.is_some(),
        };
        let mut pace = Pace::new(self.options);
        pace.growth = round.growth;
        let mut flow = ControlFlow::Continue(());
        let mut renumbered = Frame::default();
        let read = read_as(format, input, reading, &mut |event| {
            if let RecordingEvent::Damage { error, bytes } = event {
                return self.leave_out(error, bytes, round);
            }
            let consumer = &mut **self.consumer.borrow_mut();
            flow = match event {
                RecordingEvent::Channel(info) => {
                    let info = info.completed(self.description.as_ref());
                    pace.add(&info);
                    if round.add(&info) {
                        consumer(AcquireEvent::Channel(&info))
                    } else {
                        ControlFlow::Continue(())
                    }
                }
                RecordingEvent::Frame(frame) if pace.has_no_shape(frame) => ControlFlow::Break(()),
                RecordingEvent::Frame(mut frame) => {
                    let given_up = self.options.playback != Playback::Once
                        && pace.wait(frame, self.stop, consumer).is_break();
                    // The present content of a file has arrived at some other time.
                    let arrives = round.growth.is_some_and(Growth::has_caught_up);
                    let time = round.times.time(frame.time, arrives);
                    let (channel, number) = round.place(frame);
                    if (channel, number) != (frame.channel, frame.number) {
                        renumbered.copy_from(frame);
                        (renumbered.channel, renumbered.number) = (channel, number);
                        frame = &renumbered;
                    }
                    if given_up || self.stop.load(Ordering::Relaxed) {
                        ControlFlow::Break(())
                    } else {
                        consumer(AcquireEvent::Frame { frame, time })
                    }
                }
                RecordingEvent::Note(note) => consumer(AcquireEvent::Note(note)),
                RecordingEvent::Damage { .. } => flow,
            };
            flow
        });
        let unshaped = pace.unshaped;
        let read = match unshaped {
            Some(values) if read.is_ok() => Err(RecordingError::Shape { values }),
            _ => read.map(|()| flow),
        };
        (pace, read)
    }
}

/// Reads the description beside a recording. If something is wrong with it, that is reported as a note, and the
/// description is left out. Returns `Break` if no more is wanted.
fn description_of(
    path: &Path,
    consumer: &mut Consumer<'_>,
) -> ControlFlow<(), Option<RecordingMetadata>> {
    match description_beside(path).transpose() {
        Ok(description) => ControlFlow::Continue(description),
        Err(error) => {
            let complaint = error.to_string();
            let note = RecordingNote::Description { complaint };
            consumer(AcquireEvent::Note(&note))?;
            ControlFlow::Continue(None)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::seconds::to_nanoseconds;

    #[test]
    fn only_frames_of_the_channel_that_is_watched_are_waited_for() {
        let mut pace = Pace::new(&AcquireOptions {
            channel: Some("right".to_owned()),
            // A speed of 0 counts as 1.
            playback: Playback::Paced {
                speed: 0.0,
                repeat: false,
            },
            ..AcquireOptions::default()
        });
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
        let mut pace = Pace::new(&AcquireOptions::default());
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
            let mut pace = Pace::new(&AcquireOptions::default());
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
        let mut pace = Pace::new(&AcquireOptions::default());
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
            let mut pace = Pace::new(&AcquireOptions::default());
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

    /// Returns the times of the five frames of a file and of the three that then take their place.
    fn times_of_a_rewritten(path: &Path, [before, after]: &[String; 2]) -> Vec<f64> {
        std::fs::write(path, before).expect("written");
        let (options, stop) = (AcquireOptions::default(), AtomicBool::new(false));
        let mut times = Vec::new();
        let result = run(path, &options, &stop, &mut |event| {
            if let AcquireEvent::Frame { time, .. } = event {
                times.extend(time);
                if times.len() == 5 {
                    std::fs::write(path, after).expect("written");
                }
            }
            if times.len() == 8 {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        assert!(result.is_ok());
        times
    }

    #[test]
    fn the_channels_of_a_file_that_is_rewritten_keep_their_names_and_count_on() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("r.jsonl");
        let lines = |names: &[&str]| -> String {
            let line = |name| format!("{{\"channel\":\"{name}\",\"frame\":[[1,2]]}}\n");
            names.iter().map(line).collect()
        };
        std::fs::write(&path, lines(&["left", "right", "left"])).expect("written");
        let options = AcquireOptions {
            channel: Some("left".to_owned()),
            ..AcquireOptions::default()
        };
        let (mut channels, mut frames) = (Vec::new(), Vec::new());
        let result = run(&path, &options, &AtomicBool::new(false), &mut |event| {
            match event {
                AcquireEvent::Channel(info) => channels.extend(info.name.clone()),
                AcquireEvent::Frame { frame, .. } => {
                    frames.push((channels[frame.channel].clone(), frame.number));
                    if frames.len() == 3 {
                        std::fs::write(&path, lines(&["right", "top", "left"])).expect("written");
                    }
                }
                _ => {}
            }
            if frames.len() == 6 {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        assert!(result.is_ok());
        assert_eq!(channels, ["left", "right", "top"]);
        let frames = frames.iter().map(|(name, number)| (name.as_str(), *number));
        assert_eq!(
            frames.collect::<Vec<_>>(),
            [
                ("left", 0),
                ("right", 0),
                ("left", 1),
                ("right", 1),
                ("top", 0),
                ("left", 2)
            ]
        );
    }

    #[test]
    fn the_times_of_a_file_that_is_rewritten_while_it_is_followed_go_on() {
        let folder = tempfile::tempdir().expect("a folder");
        let csv = |frames: std::ops::Range<u8>| {
            let lines = frames.map(|tenth| format!("{:.1},1,2\n", f64::from(tenth) / 10.0));
            "time_s,r0c0,r0c1\n".to_owned() + &lines.collect::<String>()
        };
        let json = |frames: std::ops::Range<u8>| {
            let times = frames.map(|tenth| f64::from(tenth) / 10.0);
            let lines = times.map(|time| format!("{{\"time\":{time},\"frame\":[[1,2]]}}\n"));
            lines.collect::<String>()
        };
        for (name, contents) in [
            ("r.csv", [csv(0..5), csv(0..3)]),
            ("r.jsonl", [json(0..5), json(0..3)]),
        ] {
            let times = times_of_a_rewritten(&folder.path().join(name), &contents);
            assert_eq!(times[..5], [0.0, 0.1, 0.2, 0.3, 0.4], "{name}");
            assert!(times.is_sorted_by(|one, next| one < next), "{times:?}");
            let begun = times[5];
            let steps = times[5..].iter().map(|time| to_nanoseconds(time - begun));
            assert_eq!(steps.collect::<Vec<_>>(), [0.0, 0.1, 0.2], "{name}");
        }
    }

    #[test]
    fn a_recording_that_is_repeated_has_the_same_numbers_in_each_round() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("two.jsonl");
        std::fs::write(&path, "{\"frame\":[[1,2]]}\n{\"frame\":[[3,4]]}\n").expect("written");
        let options = AcquireOptions {
            playback: Playback::Paced {
                speed: 1e9,
                repeat: true,
            },
            ..AcquireOptions::default()
        };
        let mut numbers = Vec::new();
        let result = run(&path, &options, &AtomicBool::new(false), &mut |event| {
            if let AcquireEvent::Frame { frame, .. } = event {
                numbers.push(frame.number);
            }
            if numbers.len() == 5 {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        assert!(result.is_ok());
        assert_eq!(numbers, [0, 1, 0, 1, 0]);
    }
}
