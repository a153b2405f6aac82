//! Plays a recording back at its own rate, at another rate, or as fast as possible; or follows it while it is
//! written.

use std::cell::{Cell, RefCell};
use std::fs::File;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::acquire::arrival_clock::ArrivalClock;
use crate::acquire::event::{AcquireError, AcquireEvent, AcquireOptions, AcquireSink, Playback};
use crate::acquire::followed_file::{self, FollowEnd, FollowedFile, Growth};
use crate::acquire::pace::Pace;
use crate::acquire::recorder::metadata_beside;
use crate::acquire::silence::SilenceWatch;
use crate::acquire::source::{OpenRecording, has_no_file};
use crate::acquire::ticker::{TICK, Ticker};
use crate::formats::recording::{
    ChannelInfo, EarlierLayout, ReadOptions, RecordingError, RecordingEvent, RecordingFormat,
    RecordingInput, RecordingMetadata, RecordingNote, format_after, read_as,
};
use crate::formats::stream::{Silence, StreamCounts};
use crate::frame::Frame;

/// Creates the error for a followed file that was replaced by a recording of another kind.
fn replaced_by(format: RecordingFormat) -> RecordingError {
    RecordingError::damaged(format!(
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

/// A player of a recording.
struct Player<'a, 'b> {
    options: &'a AcquireOptions,
    stop: &'a AtomicBool,
    /// The metadata beside the recording.
    metadata: Option<RecordingMetadata>,
    /// The consumer of what is read, and of a tick now and then while waiting for more.
    consumer: RefCell<&'a mut AcquireSink<'b>>,
    /// Whether the consumer wants no more.
    ended: Cell<bool>,
    ticker: RefCell<Ticker>,
    /// Whether [`AcquireEvent::Follows`] was reported.
    follows: Cell<bool>,
    /// The counts of a followed file: bytes, frames and wrong frames.
    counts: RefCell<StreamCounts>,
    /// The wait for the next frame of a followed file.
    silence: RefCell<SilenceWatch>,
    /// The error of the first wrong frame of a followed file.
    damage: RefCell<Option<RecordingError>>,
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
    /// For each channel of this round, its index in `channels`: a file that replaces another one may begin with another
    /// channel.
    order: Vec<usize>,
    /// The times of the frames.
    times: ArrivalClock,
    /// The arrangement of the table in the file, in this round or before.
    table: EarlierLayout,
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

    /// Plays a file, and follows what is written at its end.
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

    /// Reports a tick if one is due. Returns `Break` if no more is wanted.
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
    fn leave_out(
        &self,
        error: &RecordingError,
        bytes: &[u8],
        round: &Round<'_>,
    ) -> ControlFlow<()> {
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
    ) -> (Pace<'r>, Result<ControlFlow<()>, RecordingError>) {
        let reading = ReadOptions {
            size: self.options.size,
            leaves_out: round.growth.is_some(),
        };
        let mut pace = Pace::new(self.options, round.growth);
        let mut flow = ControlFlow::Continue(());
        let mut renumbered = Frame::default();
        let mut table = std::mem::take(&mut round.table);
        let read = read_as(format, input, reading, &mut table, &mut |event| {
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
                // Not the flow: if this breaks, the error ends the reading.
                RecordingEvent::Damage { error, bytes } => {
                    return self.leave_out(error, bytes, round);
                }
            };
            flow
        });
        round.table = table;
        let read = match pace.unshaped() {
            Some(values) if read.is_ok() => {
                Err(RecordingError::unshaped(values, self.options.size))
            }
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
