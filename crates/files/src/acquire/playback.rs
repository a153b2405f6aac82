//! Plays a recording back at its own rate, at another rate, or as fast as possible; or follows it while it is
//! written.

use crate::error::ReadError;
use std::cell::{Cell, RefCell};
use std::fs::File;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use taxel_core::frame::Frame;

use crate::acquire::clocks::{ArrivalClock, SilenceWatch, TICK, Ticker};
use crate::acquire::event::{AcquireError, AcquireEvent, AcquireOptions, AcquireSink, Playback};
use crate::acquire::followed_file::{self, FollowEnd, FollowedFile, Growth};
use crate::acquire::recorder::metadata_beside;
use crate::acquire::source::{OpenRecording, has_no_file};
use crate::formats::recording::{
    ChannelChoice, ChannelInfo, EarlierLayout, ReadOptions, RecordingEvent, RecordingFormat,
    RecordingInput, RecordingMetadata, RecordingNote, format_after, read_as, unshaped,
};
use crate::formats::stream::{Silence, StreamCounts};

/// Creates the error for a followed file that was replaced by a recording of another kind.
fn replaced_by(format: RecordingFormat) -> ReadError {
    ReadError::new(format!(
        "replaced by a recording in the format {}, whose end cannot be followed",
        format.name()
    ))
}

/// Plays a recording. If it grows meanwhile, it is followed: its present frames are reported at once, then each frame
/// as it arrives.
pub(super) fn run(
    OpenRecording { path, file, format }: OpenRecording<'_>,
    options: &AcquireOptions,
    stop: &AtomicBool,
    consumer: &mut AcquireSink<'_>,
) -> Result<(), AcquireError> {
    let ControlFlow::Continue(metadata) = metadata_of(path, consumer) else {
        return Ok(());
    };
    let player = Player {
        options,
        stop,
        metadata,
        consumer: RefCell::new(consumer),
        ended: Cell::new(false),
        ticker: RefCell::new(Ticker::new()),
        follows: Cell::new(false),
        counts: RefCell::default(),
        silence: RefCell::new(SilenceWatch::new(Instant::now())),
        damage: RefCell::default(),
    };
    let format = format?;
    if options.playback != Playback::Live || !format.can_be_streamed() {
        player.play(file, format)
    } else {
        player.follow(path, file, format)
    }
}

struct Player<'a, 'b> {
    options: &'a AcquireOptions,
    stop: &'a AtomicBool,
    metadata: Option<RecordingMetadata>,
    /// The consumer of what is read, and of a tick now and then while waiting for more.
    consumer: RefCell<&'a mut AcquireSink<'b>>,
    ended: Cell<bool>,
    ticker: RefCell<Ticker>,
    follows: Cell<bool>,
    counts: RefCell<StreamCounts>,
    silence: RefCell<SilenceWatch>,
    damage: RefCell<Option<ReadError>>,
}

struct KnownChannel {
    name: Option<String>,
    first: u64,
    next: u64,
}

/// The state of one reading of a recording from its beginning to its end.
#[derive(Default)]
struct Round<'a> {
    /// The channels of all rounds, in the order in which they were reported.
    channels: Vec<KnownChannel>,
    /// For each channel of this round, its index in `channels`: a file that replaces another one may begin with another
    /// channel.
    order: Vec<usize>,
    times: ArrivalClock,
    /// The arrangement of the table in the file, in this round or before.
    table: EarlierLayout,
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

    /// Returns a frame of this round with its channel and number over all rounds. `renumbered` is its memory, if these
    /// are others.
    fn placed<'f>(&mut self, frame: &'f Frame, renumbered: &'f mut Frame) -> &'f Frame {
        let Some(&index) = self.order.get(frame.channel) else {
            return frame;
        };
        let Some(channel) = self.channels.get_mut(index) else {
            return frame;
        };
        let number = channel.first + frame.number;
        channel.next = number + 1;
        if (index, number) == (frame.channel, frame.number) {
            return frame;
        }
        renumbered.copy_from(frame);
        (renumbered.channel, renumbered.number) = (index, number);
        renumbered
    }

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
    fn play(&self, mut file: File, format: RecordingFormat) -> Result<(), AcquireError> {
        let mut round = Round::default();
        let repeats = self.options.playback.repeats();
        loop {
            let (pace, read) = self.round(format, &mut file, &mut round);
            // A recording without frames is not repeated: it would be read again and again without a pause.
            let ends = read?.is_break() || !repeats || !pace.has_begun();
            if ends
                || pace.wait_for_end(&mut || self.tick()).is_break()
                || self.report(AcquireEvent::Again).is_break()
            {
                return Ok(());
            }
            round.begin(false);
        }
    }

    fn follow(
        &self,
        path: &Path,
        file: File,
        mut format: RecordingFormat,
    ) -> Result<(), AcquireError> {
        let (mut file, growth) = followed_file::of(path, file).map_err(AcquireError::opening)?;
        let mut round = Round {
            growth: Some(&growth),
            ..Round::default()
        };
        loop {
            let waiting = &mut || self.wait_for_more(path, &growth);
            let mut followed =
                FollowedFile::new(file, &growth, waiting).map_err(AcquireError::opening)?;
            let (_, read) = self.round(format, &mut followed, &mut round);
            let end;
            (file, end) = followed.into_parts();
            let how = match end {
                None if read?.is_break() || growth.has_grown() => return Ok(()),
                // It was just changed, but for the last time: wrong frames are damage to a recording.
                None => return self.damage.take().map_or(Ok(()), |error| Err(error.into())),
                Some(FollowEnd::Stopped) => return Ok(()),
                // An error in the end that was torn by the change does not count.
                Some(FollowEnd::Anew(how)) => how,
            };
            if self.report(AcquireEvent::Anew(how)).is_break() {
                return Ok(());
            }
            round.begin(true);
            round.times.rejoin();
            // The beginning of the new content may not be written yet.
            format = loop {
                match File::open(path).and_then(|file| format_after(file, format)) {
                    Ok(Some(found)) if found.can_be_streamed() => break found,
                    Ok(Some(other)) => return Err(replaced_by(other).into()),
                    Ok(None) | Err(_) if self.wait_for_more(path, &growth).is_break() => {
                        return Ok(());
                    }
                    Ok(None) | Err(_) => std::thread::sleep(TICK),
                }
            };
        }
    }

    /// Reports an event, unless no more is wanted. Returns `Break` if no more is wanted: a reader whose input was ended
    /// by that may still have a frame.
    fn report(&self, event: AcquireEvent<'_>) -> ControlFlow<()> {
        if self.ended.get() {
            return ControlFlow::Break(());
        }
        let flow = (self.consumer.borrow_mut())(event);
        self.ended.set(flow.is_break());
        flow
    }

    fn tick(&self) -> ControlFlow<()> {
        if self.ended.get() || self.stop.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        if !self.ticker.borrow_mut().is_due() {
            return ControlFlow::Continue(());
        }
        self.report(AcquireEvent::Tick(&self.counts.borrow()))
    }

    /// Reports a tick, if one is due, at the end of a followed file, and whether it is silent. A file that has not
    /// grown may be a complete recording. Returns `Break` if no more is wanted.
    fn wait_for_more(&self, path: &Path, growth: &Growth) -> ControlFlow<()> {
        self.counts.borrow_mut().bytes = growth.bytes();
        self.tick()?;
        if !growth.has_grown() {
            return ControlFlow::Continue(());
        }
        if !self.follows.replace(true) {
            self.report(AcquireEvent::Follows)?;
        }
        let looked = (self.silence.borrow_mut()).look(growth.bytes(), Instant::now());
        looked.map_or(ControlFlow::Continue(()), |bytes_per_second| {
            self.report(AcquireEvent::Silent(Silence {
                bytes_per_second,
                counts: &self.counts.borrow(),
                has_vanished: has_no_file(path),
            }))
        })
    }

    /// Drops and counts a wrong frame of a followed file if there were frames before it and more may come: a program
    /// that was interrupted continues after a torn line. Whether more comes may be known only later. Returns `Break` if
    /// the error ends the reading.
    fn leave_out(&self, error: &ReadError, bytes: &[u8], round: &Round<'_>) -> ControlFlow<()> {
        if !round.growth.is_some_and(Growth::may_go_on) || !round.has_frames() {
            return ControlFlow::Break(());
        }
        let mut damage = self.damage.borrow_mut();
        damage.get_or_insert_with(|| error.clone());
        let mut counts = self.counts.borrow_mut();
        counts.drop_frames(1, bytes);
        counts.reason = Some(error.to_string());
        ControlFlow::Continue(())
    }

    /// Waits until a frame is due, unless all frames are wanted at once. Returns `Break` if no more is wanted.
    fn wait(&self, pace: &mut Pace<'_>, frame: &Frame) -> ControlFlow<()> {
        if self.options.playback == Playback::Once {
            return ControlFlow::Continue(());
        }
        if let Some(note) = pace.take(frame) {
            self.report(AcquireEvent::Note(&note))?;
        }
        // Also if playback lags behind and does not wait.
        self.tick()?;
        pace.wait(&mut || self.tick())
    }

    /// Reads a recording from its beginning to its end. Returns the pace that it reached, and whether no more is
    /// wanted.
    fn round<'r>(
        &self,
        format: RecordingFormat,
        input: &mut dyn RecordingInput,
        round: &mut Round<'r>,
    ) -> (Pace<'r>, Result<ControlFlow<()>, ReadError>) {
        let reading = ReadOptions {
            size: self.options.size,
            time_column: self.options.time_column.clone(),
            label_column: self.options.label_column.clone(),
            leaves_out: round.growth.is_some(),
            ..ReadOptions::default()
        };
        let mut pace = Pace::new(self.options, round.growth);
        let mut flow = ControlFlow::Continue(());
        let mut renumbered = Frame::default();
        let mut table = std::mem::take(&mut round.table);
        let read = read_as(format, input, &reading, &mut table, &mut |event| {
            flow = match event {
                RecordingEvent::Channel(info) => {
                    let info = info.completed(self.metadata.as_ref());
                    pace.add(&info);
                    if round.add(&info) {
                        self.report(AcquireEvent::Channel(&info))
                    } else {
                        ControlFlow::Continue(())
                    }
                }
                RecordingEvent::Frame(frame) if pace.has_no_shape(frame) => ControlFlow::Break(()),
                RecordingEvent::Frame(frame) => {
                    let given_up = self.wait(&mut pace, frame).is_break();
                    self.counts.borrow_mut().frames += 1;
                    self.silence.borrow_mut().note_frame(Instant::now());
                    // The present content of a file has arrived at some other time.
                    let arrives = round.growth.is_some_and(Growth::has_caught_up);
                    let time = round.times.time(frame.time, arrives);
                    let frame = round.placed(frame, &mut renumbered);
                    if given_up || self.stop.load(Ordering::Relaxed) {
                        ControlFlow::Break(())
                    } else {
                        self.report(AcquireEvent::Frame { frame, time })
                    }
                }
                RecordingEvent::Note(note) => self.report(AcquireEvent::Note(note)),
                RecordingEvent::Provisional(frame) => self.report(AcquireEvent::Provisional(frame)),
                RecordingEvent::Withdrawn => self.report(AcquireEvent::Withdrawn),
                // Not the flow: if this breaks, the error ends the reading.
                RecordingEvent::Damage { error, bytes } => {
                    return self.leave_out(error, bytes, round);
                }
            };
            flow
        });
        round.table = table;
        let read = match pace.unshaped() {
            Some(values) if read.is_ok() => Err(unshaped(values, self.options.size)),
            _ => read.map(|()| flow),
        };
        (pace, read)
    }
}

/// Reads the metadata beside a recording. If something is wrong with it, reports that as a note and leaves out the
/// metadata. Returns `Break` if no more is wanted.
fn metadata_of(
    path: &Path,
    consumer: &mut AcquireSink<'_>,
) -> ControlFlow<(), Option<RecordingMetadata>> {
    match metadata_beside(path).transpose() {
        Ok(metadata) => ControlFlow::Continue(metadata),
        Err(error) => {
            let complaint = error.to_string();
            let note = RecordingNote::Metadata { complaint };
            consumer(AcquireEvent::Note(&note))?;
            ControlFlow::Continue(None)
        }
    }
}

/// The seconds per frame of a recording that does not state them: ten frames a second.
const STEP: f64 = 0.1;

/// The longest wait for a frame, in seconds: a day.
const LONGEST: f64 = 86_400.0;

/// The longest time between two frames, in seconds, for which playback waits. A longer one may come from a clock that was
/// set; it is played as [`PLAYED`] seconds, unless the recording states that frames are that far apart.
const PAUSE: f64 = 60.0;

/// The seconds that playback waits for a frame after a longer pause.
const PLAYED: f64 = 2.0;

/// A function that is called now and then during a wait; it breaks to stop playback.
pub(super) type Tick<'a> = dyn FnMut() -> ControlFlow<()> + 'a;

/// The pace of a recording, from its beginning: when its next frame is due.
pub(super) struct Pace<'a> {
    begun: Instant,
    /// Seconds from one frame to the next, if frames have no time.
    step: f64,
    speed: f64,
    frames: u32,
    last: Option<f64>,
    /// The seconds from the first to the last of them, with long pauses shortened.
    played: f64,
    is_said: bool,
    /// The channel that sets the pace. Playback does not wait for frames of other channels, whether before, between or
    /// after those of this channel.
    channel: ChannelChoice,
    unshaped: Option<u64>,
    /// The growth of a file that is followed: once it has grown, playback waits for no frame.
    growth: Option<&'a Growth>,
}

impl<'a> Pace<'a> {
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
            is_said: false,
            channel: ChannelChoice::new(options.channel.as_deref()),
            unshaped: None,
            growth,
        }
    }

    pub(super) fn add(&mut self, info: &ChannelInfo) {
        if self.channel.add(info) {
            self.step = info.seconds_per_frame.unwrap_or(STEP);
            self.unshaped = info.values.filter(|_| info.size.is_none());
        }
    }

    pub(super) fn has_begun(&self) -> bool {
        self.frames > 0
    }

    pub(super) fn unshaped(&self) -> Option<u64> {
        self.unshaped
    }

    /// Whether a frame belongs to the watched channel and has no rows and columns.
    pub(super) fn has_no_shape(&self, frame: &Frame) -> bool {
        self.unshaped.is_some() && self.channel.takes(frame.channel)
    }

    /// Takes the next frame of the recording. Returns a note about the first pause that is shortened.
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
        let is_long = gap > PAUSE.max(2.0 * self.step);
        self.played += if is_long { PLAYED } else { gap };
        let is_news = is_long && !self.has_grown() && !std::mem::replace(&mut self.is_said, true);
        is_news.then_some(RecordingNote::Gap {
            frame: frame.number,
            seconds: gap,
            played: PLAYED,
        })
    }

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
        pace.step = 10_000.0;
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

    /// The notes about frames at these times, and the seconds that are played.
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
    fn a_long_pause_is_played_as_a_moment_and_the_first_is_said() {
        let (said, played) = notes(&[0.0, 0.5, 1e9, 1e9 + 0.5, 3.0, 3.5, 300.0]);
        let expected = "frame 2 comes 11,574 days after the one before; this pause is played as 2 s at normal speed";
        assert_eq!((said, played), (vec![expected.to_owned()], 5.5));
        let (said, played) = notes(&[0.0, 0.1, 59.0, 59.1]);
        assert!(said.is_empty() && (played - 59.1).abs() < 1e-9);
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
            pace.step = 4000.0;
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
