//! Decodes the bytes of a source, and reports the frames with their times, the ticks, and when the source is silent.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::acquire::arrival_clock::ArrivalClock;
use crate::acquire::event::{AcquireError, AcquireEvent, AcquireOptions, AcquireSink, Playback};
use crate::acquire::growing_file::ReadAnew;
use crate::acquire::silence::SilenceWatch;
use crate::acquire::source::FrameSource;
use crate::acquire::stream_start::StreamStart;
use crate::acquire::ticker::Ticker;
use crate::formats::stream::{Silence, StreamDecoder, StreamEvent, StreamSink};

/// The times that are measured while a stream is read.
struct StreamClock {
    /// Whether the source is read as it comes; false if it is read as fast as possible.
    is_live: bool,
    /// Whether a frame without a time of its own gets the time of its arrival.
    timed: bool,
    silence: SilenceWatch,
    ticker: Ticker,
    /// The times of frames.
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

    /// Reports an event of the decoder. A frame without a time gets that of its arrival.
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
    /// Prepares for the first byte of a source.
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

    /// Reports an event that is not one of the decoder.
    pub(super) fn report(&mut self, event: AcquireEvent<'_>) -> ControlFlow<()> {
        (self.consumer)(event)
    }

    /// Reports a tick while the source is not open.
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

    /// Notes that a lost source is open again.
    pub(super) fn resume(&mut self) {
        self.clock.times.rejoin();
        let bytes = self.decoder.counts().bytes;
        self.clock.silence.reopen(bytes, Instant::now());
    }

    /// Checks that a source that has ended is a stream.
    ///
    /// # Errors
    /// Returns [`AcquireError::NotStream`].
    pub(super) fn check_start(&self) -> Result<(), AcquireError> {
        self.start.finish(self.decoder.counts())
    }

    /// Reports what is left of a source that has ended.
    pub(super) fn finish(&mut self) -> ControlFlow<()> {
        self.step(StreamDecoder::finish)
    }

    /// Reports what is left of bytes that may end within a frame.
    pub(super) fn cut_off(&mut self) -> ControlFlow<()> {
        self.step(StreamDecoder::cut_off)
    }

    /// Reports that the source has ended.
    pub(super) fn report_end(&mut self) -> ControlFlow<()> {
        (self.consumer)(AcquireEvent::Ended(self.decoder.counts()))
    }

    /// Decodes bytes, perhaps none, and reports their frames and a tick. No frame waits until it is certain that the
    /// source is a stream: in a recording that is not one, that is certain before the first frame.
    ///
    /// # Errors
    /// Returns [`AcquireError::NotStream`].
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

    /// Decodes bytes, and reports their frames.
    fn push(&mut self, bytes: &[u8]) -> ControlFlow<()> {
        self.step(|decoder, sink| decoder.push(bytes, sink))
    }

    /// Calls one step of the decoder, and reports its events until no more are wanted.
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

    /// Reports a tick if one is due, and whether the stream is silent.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::recording::recognised;

    /// Returns the frames of a pipe that brings these pieces, the number of dropped ones, and the error.
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
        let samples = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files/frames/samples");
        let (mut refused, mut names) = (0, 0);
        for sample in std::fs::read_dir(samples).expect("the samples") {
            let path = sample.expect("a sample").path();
            let bytes = std::fs::read(&path).expect("read");
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
