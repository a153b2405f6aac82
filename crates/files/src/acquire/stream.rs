//! Reads a source of bytes until it ends. If it may come back, taxel tries to open it again each second.

use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::acquire::byte_input::{ByteInput, ReadOutcome};
use crate::acquire::clocks::{ArrivalClock, SilenceWatch, TICK, Ticker};
use crate::acquire::event::{AcquireError, AcquireEvent, AcquireOptions, AcquireSink, Playback};
use crate::acquire::followed_file::ReadAnew;
use crate::acquire::source::FrameSource;
use crate::formats::recording::{StartKind, StartSearch};
use crate::formats::stream::{Silence, StreamCounts, StreamDecoder, StreamEvent, StreamSink};

const CHUNK: usize = 1 << 16;

const RETRY: Duration = Duration::from_secs(1);

pub(super) fn run(
    source: &FrameSource,
    options: &AcquireOptions,
    stop: &AtomicBool,
    consumer: &mut AcquireSink<'_>,
) -> Result<(), AcquireError> {
    let reader = StreamReader {
        source,
        options,
        stop,
        reporter: StreamReporter::new(source, options, consumer),
    };
    reader.read()
}

struct StreamReader<'a, 'b> {
    source: &'a FrameSource,
    options: &'a AcquireOptions,
    stop: &'a AtomicBool,
    reporter: StreamReporter<'a, 'b>,
}

impl StreamReader<'_, '_> {
    fn read(mut self) -> Result<(), AcquireError> {
        let Some(mut input) = self.first_input()? else {
            return Ok(());
        };
        self.reporter.begin();
        let comes_back = self.source.comes_back() && self.options.playback != Playback::Once;
        let mut bytes = vec![0; CHUNK];
        while !self.stop.load(Ordering::Relaxed) {
            let lost = match input.read(&mut bytes) {
                Ok(ReadOutcome::Bytes(count)) => match self.reporter.decode(&bytes[..count])? {
                    ControlFlow::Continue(()) => continue,
                    ControlFlow::Break(()) => return Ok(()),
                },
                Ok(ReadOutcome::Anew(how)) => {
                    if self.reporter.begin_anew(how).is_break() {
                        return Ok(());
                    }
                    continue;
                }
                Ok(ReadOutcome::End) if comes_back => {
                    io::Error::new(io::ErrorKind::UnexpectedEof, "the other end has closed it")
                }
                Ok(ReadOutcome::End) => {
                    self.reporter.check_start()?;
                    if self.end().is_continue() {
                        let _ = self.reporter.report_end();
                    }
                    return Ok(());
                }
                Err(error) if comes_back => error,
                Err(error) => {
                    // What came before counts.
                    let _ = self.reporter.cut_off();
                    return Err(AcquireError::reading(error));
                }
            };
            if self.reporter.interrupt().is_break() {
                return Ok(());
            }
            match self.again(AcquireEvent::Lost(&lost))? {
                Some(found) => input = found,
                None => return Ok(()),
            }
            self.reporter.resume();
        }
        // No more is wanted.
        let _ = self.reporter.cut_off();
        Ok(())
    }

    /// Reports what is left at the end of the source. A file, or anything that is read to its end, ends as intended. A
    /// live pipe may end because its writer died in the middle of a number.
    fn end(&mut self) -> ControlFlow<()> {
        if self.options.playback == Playback::Once && !self.source.comes_back() {
            self.reporter.finish()
        } else {
            self.reporter.cut_off()
        }
    }

    fn open(&mut self) -> io::Result<Option<ByteInput>> {
        ByteInput::open(self.source, self.options, &mut || self.wait())
    }

    fn wait(&mut self) -> ControlFlow<()> {
        if self.stop.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        self.reporter.wait()
    }

    /// Opens the source; if it does not exist yet, waits for it if the options say so. None if no more is wanted.
    fn first_input(&mut self) -> Result<Option<ByteInput>, AcquireError> {
        match self.open() {
            Ok(input) => Ok(input),
            Err(error) if self.options.waits && self.source.comes_back() && !is_invalid(&error) => {
                self.again(AcquireEvent::Absent(&error))
            }
            Err(error) => Err(AcquireError::opening(error)),
        }
    }

    /// Reports why it waits for the source, and tries to open it each second until it exists. None if no more is
    /// wanted.
    fn again(&mut self, event: AcquireEvent<'_>) -> Result<Option<ByteInput>, AcquireError> {
        let since = Instant::now();
        if self.reporter.report(event).is_break() {
            return Ok(None);
        }
        loop {
            let next = Instant::now() + RETRY;
            while Instant::now() < next {
                if self.wait().is_break() {
                    return Ok(None);
                }
                std::thread::sleep(TICK);
            }
            match self.open() {
                Ok(None) => return Ok(None),
                Ok(Some(input)) => {
                    let gap = since.elapsed();
                    let back = self.reporter.report(AcquireEvent::Back { gap });
                    return Ok(back.is_continue().then_some(input));
                }
                Err(error) if is_invalid(&error) => return Err(AcquireError::opening(error)),
                Err(_) => {}
            }
        }
    }
}

/// Whether the source is not one that can be opened. Waiting does not make it valid.
fn is_invalid(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::InvalidInput
}

struct StreamClock {
    /// Whether the source is read as it comes; false if it is read as fast as possible.
    is_live: bool,
    /// Whether a frame without a time of its own gets the time of its arrival.
    timed: bool,
    silence: SilenceWatch,
    ticker: Ticker,
    times: ArrivalClock,
}

impl StreamClock {
    fn new(source: &FrameSource, options: &AcquireOptions) -> Self {
        Self {
            is_live: options.playback != Playback::Once,
            // The present content of a file has arrived at some other time.
            timed: source.arrives(options.playback),
            silence: SilenceWatch::new(Instant::now()),
            ticker: Ticker::new(),
            times: ArrivalClock::default(),
        }
    }

    fn report(
        &mut self,
        event: StreamEvent<'_>,
        consumer: &mut AcquireSink<'_>,
    ) -> ControlFlow<()> {
        consumer(match event {
            StreamEvent::Frame(frame) => {
                self.silence.note_frame(Instant::now());
                let time = self.times.time(frame.time, self.timed);
                AcquireEvent::Frame { frame, time }
            }
            StreamEvent::Channel(info) => AcquireEvent::Channel(info),
            StreamEvent::Provisional(frame) => AcquireEvent::Provisional(frame),
            StreamEvent::Withdrawn => AcquireEvent::Withdrawn,
            StreamEvent::Note(note) => AcquireEvent::Note(note),
        })
    }
}

/// A decoder of the bytes of a source, which reports what they mean to a consumer. Each report returns `Break` if no more
/// is wanted.
pub(super) struct StreamReporter<'a, 'b> {
    source: &'a FrameSource,
    options: &'a AcquireOptions,
    decoder: StreamDecoder,
    start: StreamStart,
    clock: StreamClock,
    consumer: &'a mut AcquireSink<'b>,
}

impl<'a, 'b> StreamReporter<'a, 'b> {
    pub(super) fn new(
        source: &'a FrameSource,
        options: &'a AcquireOptions,
        consumer: &'a mut AcquireSink<'b>,
    ) -> Self {
        let decoder = StreamDecoder::new(options.for_stream(source.begins()));
        Self {
            source,
            options,
            start: StreamStart::new(source, options, decoder.counts()),
            decoder,
            clock: StreamClock::new(source, options),
            consumer,
        }
    }

    /// Notes that the source is open. The wait for it was not a silence.
    pub(super) fn begin(&mut self) {
        self.clock.silence = SilenceWatch::new(Instant::now());
    }

    pub(super) fn report(&mut self, event: AcquireEvent<'_>) -> ControlFlow<()> {
        (self.consumer)(event)
    }

    pub(super) fn wait(&mut self) -> ControlFlow<()> {
        (self.consumer)(AcquireEvent::Tick(self.decoder.counts()))
    }

    /// Reports the last frame of a file and that the file is read anew, and prepares for its first byte.
    pub(super) fn begin_anew(&mut self, how: ReadAnew) -> ControlFlow<()> {
        self.cut_off()?;
        self.report(AcquireEvent::Anew(how))?;
        self.decoder.begin_anew();
        self.start = StreamStart::new(self.source, self.options, self.decoder.counts());
        self.clock.times.rejoin();
        ControlFlow::Continue(())
    }

    /// Reports what is left of a connection that was lost. The next bytes may begin inside a frame.
    pub(super) fn interrupt(&mut self) -> ControlFlow<()> {
        self.step(StreamDecoder::restart)
    }

    pub(super) fn resume(&mut self) {
        self.clock.times.rejoin();
        let bytes = self.decoder.counts().bytes;
        self.clock.silence.reopen(bytes, Instant::now());
    }

    pub(super) fn check_start(&self) -> Result<(), AcquireError> {
        self.start.finish(self.decoder.counts())
    }

    pub(super) fn finish(&mut self) -> ControlFlow<()> {
        self.step(StreamDecoder::finish)
    }

    pub(super) fn cut_off(&mut self) -> ControlFlow<()> {
        self.step(StreamDecoder::cut_off)
    }

    pub(super) fn report_end(&mut self) -> ControlFlow<()> {
        (self.consumer)(AcquireEvent::Ended(self.decoder.counts()))
    }

    /// Decodes bytes, perhaps none, and reports their frames and a tick. No frame waits until it is certain that the
    /// source is a stream: in a recording that is not one, that is certain before the first frame.
    pub(super) fn decode(&mut self, bytes: &[u8]) -> Result<ControlFlow<()>, AcquireError> {
        // If no bytes came, the content that was in a file has been read.
        self.clock.timed |= self.clock.is_live && bytes.is_empty();
        let mut rest = bytes;
        if let Some((count, kind)) = self.start.push(bytes, self.decoder.counts()) {
            let (before, after) = bytes.split_at(count);
            if self.push(before).is_break() {
                return Ok(ControlFlow::Break(()));
            }
            self.start.check(kind, self.decoder.counts())?;
            rest = after;
        }
        if self.push(rest).is_break() {
            return Ok(ControlFlow::Break(()));
        }
        Ok(self.tick())
    }

    fn push(&mut self, bytes: &[u8]) -> ControlFlow<()> {
        self.step(|decoder, sink| decoder.push(bytes, sink))
    }

    fn step(
        &mut self,
        how: impl FnOnce(&mut StreamDecoder, &mut StreamSink<'_>),
    ) -> ControlFlow<()> {
        let mut flow = ControlFlow::Continue(());
        how(&mut self.decoder, &mut |event| {
            if flow.is_continue() {
                flow = self.clock.report(event, self.consumer);
            }
        });
        flow
    }

    fn tick(&mut self) -> ControlFlow<()> {
        if !self.clock.ticker.is_due() {
            return ControlFlow::Continue(());
        }
        let counts = self.decoder.counts();
        (self.consumer)(AcquireEvent::Tick(counts))?;
        match self.clock.silence.look(counts.bytes, Instant::now()) {
            Some(bytes_per_second) => (self.consumer)(AcquireEvent::Silent(Silence {
                bytes_per_second,
                counts,
                has_vanished: self.source.has_vanished(),
            })),
            None => ControlFlow::Continue(()),
        }
    }
}

/// The start of a source, as long as it may be that of a recording that only a file can be. With its first frame, a
/// source is a stream.
pub(super) struct StreamStart {
    search: Option<StartSearch>,
    frames: u64,
}

impl StreamStart {
    /// Prepares for the first byte of a source, given the counts before it. Where the bytes may begin anywhere, they do
    /// not show a recording, and a format that the user names is not doubted.
    pub(super) fn new(
        source: &FrameSource,
        options: &AcquireOptions,
        counts: &StreamCounts,
    ) -> Self {
        let is_searched = source.begins() && options.format.is_none();
        Self {
            search: is_searched.then(StartSearch::default),
            frames: counts.frames,
        }
    }

    /// Examines the next bytes, after those that gave these counts. Returns the number of those after which the kind of
    /// the source is certain, and the kind; None if it is not certain yet, or was before.
    pub(super) fn push(
        &mut self,
        bytes: &[u8],
        counts: &StreamCounts,
    ) -> Option<(usize, StartKind)> {
        self.search.take_if(|_| counts.frames > self.frames);
        let found = self.search.as_mut()?.push(bytes)?;
        self.search = None;
        Some(found)
    }

    pub(super) fn check(&self, kind: StartKind, counts: &StreamCounts) -> Result<(), AcquireError> {
        match kind {
            StartKind::Recording(format) if counts.frames == self.frames => {
                Err(AcquireError::NotStream { format })
            }
            _ => Ok(()),
        }
    }

    pub(super) fn finish(&self, counts: &StreamCounts) -> Result<(), AcquireError> {
        let search = self.search.as_ref();
        search.map_or(Ok(()), |search| self.check(search.finish(), counts))
    }
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};
    use std::io::Write;
    use std::net::TcpListener;

    use taxel_core::frame::FrameSize;

    use super::*;
    use crate::formats::recording::recognised;
    use crate::formats::stream::StreamFormat;

    /// Two connections: the first ends with the last byte of a frame, the second one byte later.
    #[test]
    fn the_rest_of_a_lost_connection_is_reported_counted_or_withdrawn() {
        const FRAME: [u8; 6] = [0xaa, 0x55, 1, 2, 3, 4];
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("its address").to_string();
        let sender = std::thread::spawn(move || {
            for rest in [&b""[..], &b"?"[..]] {
                let (mut connection, _) = listener.accept().expect("a connection");
                connection.write_all(&FRAME.repeat(2)).expect("sent");
                std::thread::sleep(Duration::from_millis(300));
                connection.write_all(rest).expect("sent");
            }
        });
        let options = AcquireOptions {
            format: Some(StreamFormat::Flexitac),
            size: Some(FrameSize::new(2, 2).expect("an allowed size")),
            ..AcquireOptions::default()
        };
        let (mut events, mut dropped) = (Vec::new(), 0);
        let source = FrameSource::Tcp(address);
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            let losses = events.iter().filter(|event| **event == "lost").count();
            match event {
                AcquireEvent::Frame { .. } => events.push("frame"),
                AcquireEvent::Provisional(_) => events.push("provisional"),
                AcquireEvent::Withdrawn => events.push("withdrawn"),
                AcquireEvent::Lost(_) => events.push("lost"),
                AcquireEvent::Tick(counts) if losses == 2 => {
                    dropped = counts.dropped;
                    return ControlFlow::Break(());
                }
                _ => {}
            }
            ControlFlow::Continue(())
        });
        sender.join().expect("all was sent");
        assert!(result.is_ok());
        let first = ["frame", "provisional", "frame", "lost"];
        let second = ["frame", "provisional", "withdrawn", "lost"];
        assert_eq!(events, [first, second].concat());
        assert_eq!(dropped, 1);
    }

    /// The times of the first five frames of two connections, of which each loses its first line.
    fn times_over_a_gap(connections: [String; 2]) -> Vec<Option<f64>> {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("its address").to_string();
        let sender = std::thread::spawn(move || {
            for lines in connections {
                let (mut connection, _) = listener.accept().expect("a connection");
                connection.write_all(lines.as_bytes()).expect("sent");
            }
        });
        let options = AcquireOptions {
            size: Some(FrameSize::new(2, 1).expect("an allowed size")),
            ..AcquireOptions::default()
        };
        let mut times = Vec::new();
        let source = FrameSource::Tcp(address);
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            if let AcquireEvent::Frame { time, .. } = event {
                times.push(time);
            }
            if times.len() == 5 {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        sender.join().expect("all was sent");
        assert!(result.is_ok());
        times
    }

    #[test]
    fn a_source_that_turns_out_to_be_invalid_is_not_waited_for() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("line");
        let source = FrameSource::Serial(path.clone());
        let options = AcquireOptions {
            waits: true,
            ..AcquireOptions::default()
        };
        let mut events = 0;
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            match event {
                AcquireEvent::Absent(_) => fs::write(&path, "").expect("written"),
                _ => events += 1,
            }
            if events == 100 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        let error = result.expect_err("a file").to_string();
        assert!(error.contains("it is not a serial line"), "{error}");
    }

    #[test]
    fn a_file_that_becomes_a_recording_is_not_taken_for_a_stream() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("touch.npy");
        fs::write(&path, b"\x93NUM").expect("written");
        let source = FrameSource::File(path.clone());
        let options = AcquireOptions::default();
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            if let AcquireEvent::Tick(counts) = event
                && counts.bytes == 4
            {
                let mut file = File::options().append(true).open(&path).expect("opened");
                file.write_all(b"PY\x01\x00v\x00{").expect("written");
            }
            ControlFlow::Continue(())
        });
        assert!(matches!(result, Err(AcquireError::NotStream { .. })));
        // The frames before the file was replaced do not make it a stream.
        fs::write(&path, b"1 2\n3 4\n\n5 6\n7 8\n\n").expect("written");
        let other = folder.path().join("other");
        fs::write(&other, b"\x93NUMPY\x01\x00v\x00{").expect("written");
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            if let AcquireEvent::Tick(counts) = event
                && counts.frames == 2
                && other.exists()
            {
                fs::rename(&other, &path).expect("renamed");
            }
            ControlFlow::Continue(())
        });
        assert!(matches!(result, Err(AcquireError::NotStream { .. })));
    }

    /// A connection and a serial line are live even if they are read only once; a pipe may hold a file.
    #[test]
    fn frames_of_a_live_source_have_times_of_arrival() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("its address").to_string();
        let sender = std::thread::spawn(move || {
            let (mut connection, _) = listener.accept().expect("a connection");
            connection.write_all(b"?\n1 2\n3 4\n").expect("sent");
        });
        let options = AcquireOptions {
            size: Some(FrameSize::new(2, 1).expect("an allowed size")),
            playback: Playback::Once,
            ..AcquireOptions::default()
        };
        let (mut times, source) = (Vec::new(), FrameSource::Tcp(address));
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            if let AcquireEvent::Frame { time, .. } = event {
                times.push(time);
            }
            ControlFlow::Continue(())
        });
        sender.join().expect("all was sent");
        assert!(result.is_ok());
        assert_eq!((times.len(), times[0]), (2, Some(0.0)));
        assert!(times[1].is_some());
        let fifo = FrameSource::Fifo("pipe".into());
        let live = [Playback::Live, Playback::Once].map(|playback| fifo.arrives(playback));
        assert_eq!(live, [true, false]);
    }

    #[test]
    fn the_times_of_a_source_go_on_over_a_gap() {
        let json = |time: f64| format!("{{\"time\":{time},\"frame\":[[1,2]]}}\n");
        let stamped = |time: f64| format!("{{\"t_ms\":{},\"frame\":[[1,2]]}}\n", 1e6 + 1e3 * time);
        let dated = |time: f64| format!("2024-05-01 12:00:0{time},1,2\n");
        // Midnight is in the gap.
        let clock = |time: f64| {
            let (hour, second) = if time < 1.0 {
                ("23:59", 59.0)
            } else {
                ("00:00", -1.0)
            };
            format!("{hour}:{:04.1},1,2\n", second + time)
        };
        // The first line of a connection may be torn, but an object of JSON is whole.
        let (whole, torn) = ([0.0, 0.1, 0.2, 0.3, 1.8], [0.0, 0.1, 0.2, 1.8, 1.9]);
        let formats: [(&(dyn Fn(f64) -> String + Sync), _); 4] = [
            (&json, whole),
            (&stamped, whole),
            (&dated, torn),
            (&clock, torn),
        ];
        std::thread::scope(|scope| {
            for (line, expected) in formats {
                scope.spawn(move || {
                    let text = |times: &[f64]| times.iter().map(|&time| line(time)).collect();
                    let connections = [text(&[0.0, 0.1, 0.2, 0.3]), text(&[1.8, 1.9, 2.0])];
                    let times = times_over_a_gap(connections);
                    assert_eq!(times, expected.map(Some), "{}", line(0.0));
                });
            }
        });
    }

    /// The frames of a pipe that brings these pieces, the number of dropped ones, and the error.
    fn watched(pieces: &[&[u8]]) -> (Vec<String>, u64, Option<String>) {
        let source = FrameSource::Fifo("pipe".into());
        let options = AcquireOptions {
            playback: Playback::Once,
            ..AcquireOptions::default()
        };
        let mut frames = Vec::new();
        let consumer = &mut |event: AcquireEvent<'_>| {
            if let AcquireEvent::Frame { frame, time } = event {
                frames.push(format!("{frame:?} {time:?}"));
            }
            ControlFlow::Continue(())
        };
        let mut reporter = StreamReporter::new(&source, &options, consumer);
        let mut decoded = pieces
            .iter()
            .try_for_each(|piece| reporter.decode(piece).map(drop));
        if decoded.is_ok() {
            decoded = reporter.check_start();
            let _ = reporter.finish();
        }
        let dropped = reporter.decoder.counts().dropped;
        let error = decoded.err().map(|error| error.to_string());
        (frames, dropped, error)
    }

    /// Returns what comes of a pipe with these bytes, after a check that it does not depend on the pieces.
    fn watched_in_any_pieces(bytes: &[u8]) -> (Vec<String>, u64, Option<String>) {
        let whole = watched(&[bytes]);
        let single: Vec<_> = bytes.chunks(1).collect();
        assert_eq!(watched(&single), whole, "{}", bytes.escape_ascii());
        for cut in 1..bytes.len() {
            let (start, rest) = bytes.split_at(cut);
            assert_eq!(watched(&[start, rest]), whole, "{}|", start.escape_ascii());
        }
        whole
    }

    #[test]
    fn a_sample_is_a_stream_or_refused_however_it_is_cut() {
        let samples = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../tests/files/frames/samples"
        );
        let (mut refused, mut names) = (0, 0);
        for sample in fs::read_dir(samples).expect("the samples") {
            let path = sample.expect("a sample").path();
            let bytes = fs::read(&path).expect("read");
            let format = recognised(&bytes).expect("a recording");
            let (frames, _, error) = watched_in_any_pieces(&bytes);
            let expected = (!format.can_be_streamed())
                .then(|| format!("a recording ({}), not a stream", format.name()));
            assert_eq!(error, expected, "{}", path.display());
            assert!(error.is_none() || frames.is_empty(), "{}", path.display());
            refused += usize::from(error.is_some());
            names += 1;
        }
        assert!(refused > 5 && names > refused + 5, "{refused} of {names}");
    }

    #[test]
    fn a_stream_with_words_of_recordings_is_a_stream_however_it_is_cut() {
        for (stream, frames) in [
            // A line of JSON is judged when it is whole.
            ("{\"n_columns\":2,\"n_rows\":1,\"frame\":[[1,2]]}\n", 1),
            ("boot v1\nDATA_TYPE ready\n\n1 2\n3 4\n\n5 6\n7 8\n\n", 2),
            ("PK ready\n\n1 2\n3 4\n\n5 6\n7 8\n\n", 2),
            ("FRAME,1\n\n1 2\n3 4\n\nFRAME,2\n\n1 2\n3 4\n\n", 2),
            // After its first frame, a stream may contain anything.
            ("1 2\n3 4\n\n5 6\n7 8\n\nASCII_DATA @@\n\n", 2),
            ("P1\n\n1 2\n3 4\n\n5 6\n7 8\n\nASCII_DATA @@\n\n", 2),
        ] {
            let (found, _, error) = watched_in_any_pieces(stream.as_bytes());
            assert_eq!((found.len(), error), (frames, None), "{stream}");
        }
    }
}
