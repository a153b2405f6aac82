//! Plays a recording back at its own rate, at another rate, or as fast as possible; or follows it while it is
//! written.

use std::cell::{Cell, RefCell};
use std::fs::File;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::acquire::arrival_clock::ArrivalClock;
use crate::acquire::event::{AcquireError, AcquireEvent, AcquireOptions, Playback};
use crate::acquire::followed_file::{self, FollowEnd, FollowedFile, Growth};
use crate::acquire::pace::{MOMENT, Pace};
use crate::acquire::recorder::metadata_beside;
use crate::acquire::silence::SilenceWatch;
use crate::acquire::source::{OpenRecording, has_no_file};
use crate::acquire::stream::Consumer;
use crate::formats::recording::{
    ChannelInfo, EarlierLayout, ReadOptions, RecordingError, RecordingEvent, RecordingFormat,
    RecordingInput, RecordingMetadata, RecordingNote, format_after, read_as,
};
use crate::formats::stream::StreamCounts;
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
    consumer: &mut Consumer<'_>,
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
        counts: RefCell::default(),
        silence: RefCell::new(SilenceWatch::new(Instant::now())),
        damage: RefCell::default(),
    };
    let format = format?;
    if options.playback != Playback::Live || !format.is_appended_to() {
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
    consumer: RefCell<&'a mut Consumer<'b>>,
    /// Whether the consumer wants no more.
    ended: Cell<bool>,
    /// The counts of a followed file: bytes, frames and wrong frames.
    counts: RefCell<StreamCounts>,
    /// The wait for the next frame of a followed file.
    silence: RefCell<SilenceWatch>,
    /// The error of the first of them.
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
                    Ok(Some(found)) if found.is_appended_to() => break found,
                    Ok(Some(other)) => return Err(replaced_by(other).into()),
                    Ok(None) | Err(_) if self.wait_for_more(path, &growth).is_break() => {
                        return Ok(());
                    }
                    Ok(None) | Err(_) => std::thread::sleep(MOMENT),
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

    /// Reports a tick. Returns `Break` if no more is wanted.
    fn tick(&self) -> ControlFlow<()> {
        if self.stop.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        self.report(AcquireEvent::Tick(&self.counts.borrow()))
    }

    /// Reports a tick at the end of a followed file, and whether it is silent. A file that has not grown may be a complete
    /// recording. Returns `Break` if no more is wanted.
    fn wait_for_more(&self, path: &Path, growth: &Growth) -> ControlFlow<()> {
        self.counts.borrow_mut().bytes = growth.bytes();
        self.tick()?;
        if !growth.has_grown() {
            return ControlFlow::Continue(());
        }
        let looked = (self.silence.borrow_mut()).look(growth.bytes(), Instant::now());
        looked.map_or(ControlFlow::Continue(()), |bytes_per_second| {
            self.report(AcquireEvent::Silent {
                bytes_per_second,
                counts: &self.counts.borrow(),
                has_vanished: has_no_file(path),
            })
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
        damage.get_or_insert_with(|| error.copied());
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
    consumer: &mut Consumer<'_>,
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

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::time::{Duration, SystemTime};

    use super::*;
    use crate::acquire::source::FrameSource;
    use crate::formats::seconds::to_nanoseconds;
    use crate::frame::FrameSize;

    /// Plays the recording of that path.
    fn run(
        path: &Path,
        options: &AcquireOptions,
        stop: &AtomicBool,
        consumer: &mut Consumer<'_>,
    ) -> Result<(), AcquireError> {
        let source = FrameSource::File(path.to_owned());
        let opened = source.open_recording(options).expect("a file");
        super::run(opened.expect("a recording"), options, stop, consumer)
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
    fn a_wrong_line_that_stands_in_a_file_is_counted_if_the_file_grows_and_else_an_error() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("r.jsonl");
        let line = "{\"frame\":[[1,2]]}\n";
        let content = line.repeat(2) + "{\"frame\":[[1\n" + &line.repeat(3);
        for grows in [false, true] {
            std::fs::write(&path, &content).expect("written");
            let mut file = File::options().append(true).open(&path).expect("opened");
            if !grows {
                let long_ago = SystemTime::now() - Duration::from_secs(60);
                file.set_modified(long_ago).expect("its time is set");
            }
            let (options, stop) = (AcquireOptions::default(), AtomicBool::new(false));
            let (mut frames, mut dropped) = (0, 0);
            let result = run(&path, &options, &stop, &mut |event| {
                match event {
                    AcquireEvent::Frame { .. } => frames += 1,
                    AcquireEvent::Tick(counts) => dropped = dropped.max(counts.dropped),
                    _ => {}
                }
                if frames == 4 && grows {
                    file.write_all(line.as_bytes()).expect("written");
                    frames += 10;
                }
                if frames == 16 && dropped > 0 {
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(())
            });
            let error = result.err().map(|error| error.to_string());
            let error = error.map(|error| error.starts_with("line 3, "));
            let expected = if grows { (16, None) } else { (2, Some(true)) };
            assert_eq!((frames, error), expected);
        }
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
    fn a_torn_line_of_a_file_that_is_truncated_or_replaced_is_not_a_frame() {
        let folder = tempfile::tempdir().expect("a folder");
        let (path, other) = (folder.path().join("r.csv"), folder.path().join("other.csv"));
        let header = "time_s,r0c0,r0c1\n";
        for is_replaced in [false, true] {
            std::fs::write(&path, header.to_owned() + "0.0,1,11\n0.1,2,22\n").expect("written");
            let (mut values, mut ticks) = (Vec::new(), 0);
            let (options, stop) = (AcquireOptions::default(), AtomicBool::new(false));
            let result = run(&path, &options, &stop, &mut |event| {
                match event {
                    AcquireEvent::Frame { frame, .. } => values.push(frame.values()[1]),
                    AcquireEvent::Tick(_) => ticks += 1,
                    _ => return ControlFlow::Continue(()),
                }
                if values.len() == 4 || ticks == 100 {
                    return ControlFlow::Break(());
                }
                if ticks == 1 {
                    let mut file = File::options().append(true).open(&path).expect("opened");
                    file.write_all(b"0.2,3,33\n0.3,4,4").expect("written");
                }
                // The line has been read up to where it is torn.
                if ticks == 2 {
                    let new = if is_replaced { &other } else { &path };
                    std::fs::write(new, header.to_owned() + "0.0,7,77\n").expect("written");
                    std::fs::rename(new, &path).expect("renamed");
                }
                ControlFlow::Continue(())
            });
            assert!(result.is_ok());
            assert_eq!(values, [11.0, 22.0, 33.0, 77.0]);
        }
    }

    /// Returns the first values of the frames of a file that holds one content, then another one, and how many frames
    /// were dropped. Stops after `count` frames.
    fn values_of_a_rewritten(
        path: &Path,
        [before, after]: [&[u8]; 2],
        count: usize,
    ) -> (Vec<f64>, u64) {
        std::fs::write(path, before).expect("written");
        let options = AcquireOptions {
            size: path.ends_with("named").then(|| FrameSize::of(2, 2)),
            ..AcquireOptions::default()
        };
        let (mut values, mut ticks, mut dropped) = (Vec::new(), 0, 0);
        let mut after = Some(after);
        let result = run(path, &options, &AtomicBool::new(false), &mut |event| {
            match event {
                AcquireEvent::Frame { frame, .. } => values.push(frame.values()[0]),
                AcquireEvent::Tick(counts) => {
                    (ticks, dropped) = (ticks + 1, counts.dropped);
                    if values.len() == 2
                        && let Some(after) = after.take()
                    {
                        std::fs::write(path, after).expect("written");
                    } else if values.len() == count || ticks == 100 {
                        return ControlFlow::Break(());
                    }
                }
                _ => {}
            }
            ControlFlow::Continue(())
        });
        assert!(result.is_ok(), "{result:?}");
        (values, dropped)
    }

    /// The content before each cut has two frames; the one after it has three, with the first values 3, 4 and 5.
    #[test]
    fn a_file_that_is_truncated_keeps_its_format_and_arrangement() {
        let folder = tempfile::tempdir().expect("a folder");
        let named = "r0c0,r0c1,r1c0,r1c1\n1,0,0,0\n2,0,0,0\n";
        let timed = "time_s,r0c0,r0c1,r1c0,r1c1\n0,1,0,0,0\n1,2,0,0,0\n";
        let rows = "1 0\n0 0\n\n2 0\n0 0\n\n";
        let json = "{\"frame\":[[1,0],[0,0]]}\n{\"frame\":[[2,0],[0,0]]}\n";
        let more_json = json.replace("[[1", "[[4").replace("[[2", "[[5");
        let json = |torn: &str| {
            (
                json,
                format!("{torn}{{\"frame\":[[3,0],[0,0]]}}\n{more_json}"),
            )
        };
        let echo = "data:\n- 1\n- 0\n- 0\n- 0\n---\ndata:\n- 2\n- 0\n- 0\n- 0\n---\n";
        let table = |head: &str| (named, format!("{head}3,0,0,0\n4,0,0,0\n5,0,0,0\n"));
        let clocked = |head: &str| (timed, format!("{head}3,3,0,0,0\n4,4,0,0,0\n5,5,0,0,0\n"));
        let blocks = |head: &str| (rows, format!("{head}3 0\n0 0\n\n4 0\n0 0\n\n5 0\n0 0\n\n"));
        let cases = [
            ("cut between lines", table(""), 0),
            ("cut in a line", table("0,0\n"), 1),
            ("behind zero bytes", table("\0\0\0"), 0),
            ("behind a message", table("garbage here\n"), 1),
            (
                "behind two messages",
                table("garbage here\ngarbage, there\n"),
                2,
            ),
            (
                "with its header",
                (named, named.replace("1,0,0,0\n2", "3,0,0,0\n4,0,0,0\n5")),
                0,
            ),
            ("times, cut between lines", clocked(""), 0),
            ("times, cut in a line", clocked("0,0,0\n"), 1),
            ("rows, cut between frames", blocks(""), 0),
            ("rows, cut between rows", blocks("0 0\n\n"), 1),
            ("rows, cut in a row", blocks("9\n0 0\n\n"), 1),
            ("rows, behind a message", blocks("garbage here\n\n"), 1),
            ("rows, behind zero bytes", blocks("\0\0\0\0"), 0),
            (
                "another size",
                (
                    rows,
                    "3 0 0\n0 0 0\n\n4 0 0\n0 0 0\n\n5 0 0\n0 0 0\n\n".to_owned(),
                ),
                0,
            ),
            (
                "other names",
                (
                    named,
                    "time,r0c0,r0c1,r0c2\n0,3,0,0\n1,4,0,0\n2,5,0,0\n".to_owned(),
                ),
                0,
            ),
            ("JSON, cut between lines", json(""), 0),
            ("JSON, cut in a line", json("\": [[1,2],[3,4]]}\n"), 1),
            ("JSON, behind zero bytes", json("\0\0\0"), 0),
            ("another format", (named, json("").1), 0),
            (
                "named",
                (
                    echo,
                    format!(
                        "- 0\n- 0\n---\n{}data: [5, 0, 0, 0]\n---\n",
                        echo.replace("- 1", "- 3").replace("- 2", "- 4")
                    ),
                ),
                1,
            ),
        ];
        // They wait most of the time.
        std::thread::scope(|scope| {
            for (name, (before, after), expected) in cases {
                let path = folder.path().join(name);
                scope.spawn(move || {
                    let contents = [before.as_bytes(), after.as_bytes()];
                    let (values, dropped) = values_of_a_rewritten(&path, contents, 5);
                    assert_eq!(values, [1.0, 2.0, 3.0, 4.0, 5.0], "{name}");
                    assert_eq!(dropped, expected, "{name}");
                });
            }
        });
    }

    #[test]
    fn a_file_that_no_longer_grows_is_silent() {
        let folder = tempfile::tempdir().expect("a folder");
        let silence = |is_removed: bool| {
            let path = folder.path().join(format!("{is_removed}.jsonl"));
            let line = "{\"frame\":[[1,2]]}\n";
            std::fs::write(&path, line).expect("written");
            let (options, mut ticks, mut silence) = (AcquireOptions::default(), 0, None);
            let result = run(&path, &options, &AtomicBool::new(false), &mut |event| {
                match event {
                    AcquireEvent::Tick(_) => ticks += 1,
                    AcquireEvent::Silent {
                        bytes_per_second,
                        counts,
                        has_vanished,
                    } => silence = Some((bytes_per_second, counts.frames, has_vanished)),
                    _ => {}
                }
                if ticks == 1 {
                    let mut file = File::options().append(true).open(&path).expect("opened");
                    file.write_all(line.as_bytes()).expect("written");
                    if is_removed {
                        std::fs::remove_file(&path).expect("removed");
                    }
                    ticks = 2;
                }
                if silence.is_some() || ticks == 200 {
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(())
            });
            assert!(result.is_ok());
            silence
        };
        std::thread::scope(|scope| {
            for is_removed in [false, true] {
                scope.spawn(move || {
                    assert_eq!(silence(is_removed), Some((0.0, 2, is_removed)));
                });
            }
        });
    }

    #[test]
    fn a_consumer_that_broke_off_while_more_was_waited_for_gets_no_more() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("r.bin");
        // The end of the file confirms its last frame.
        std::fs::write(&path, b"\xaa\x55\x01\x02".repeat(4)).expect("written");
        let options = AcquireOptions {
            size: Some(FrameSize::of(2, 1)),
            ..AcquireOptions::default()
        };
        let (mut frames, mut has_ended) = (0, false);
        let result = run(&path, &options, &AtomicBool::new(false), &mut |event| {
            assert!(!has_ended, "{event:?}");
            match event {
                AcquireEvent::Frame { .. } => frames += 1,
                AcquireEvent::Tick(_) => has_ended = frames == 3,
                _ => {}
            }
            if has_ended {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        assert!(result.is_ok() && has_ended);
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
