//! A decoder for any stream; it detects the format from the first bytes.
//! ```text
//! bytes -> State::Looking until the format is certain -> the decoder of that format -> frames
//! ```
//! Formats of text are decoded line by line, and a line is never read before its end has arrived. Bytes come in
//! pieces of any size: the frames are the same however the stream is cut. Dropped frames are counted in
//! [`StreamCounts`], with a sample.

use std::mem::take;

use serde::de::IgnoredAny;

use crate::formats::file::without_mark;
use crate::formats::json::WithoutNan;
use crate::formats::recording::text::{LONGEST_LINE, is_parted_by_cr};
use crate::formats::recording::time::FrameClock;
use crate::formats::stream::boards::{FlexitacDecoder, MatsenseDecoder};
use crate::formats::stream::documents::{JsonDecoder, RosDecoder};
use crate::formats::stream::event::{
    StreamCounts, StreamFormat, StreamOptions, StreamOutput, StreamSink,
};
use crate::formats::stream::format_search::{FormatSearch, is_numbers};
use crate::formats::stream::lines::LinesDecoder;

/// Decodes a stream, piece by piece.
#[derive(Debug)]
pub struct StreamDecoder {
    options: StreamOptions,
    counts: StreamCounts,
    state: State,
    /// The bytes that are not decoded yet: at first the beginning of the stream, and once the format is known, the
    /// unfinished line.
    bytes: Vec<u8>,
    skipping: bool,
    first: bool,
    torn: bool,
    /// The clock of the source, kept from the last decoder.
    clock: FrameClock,
    /// The decoder of JSON lines, which knows the channels of the source.
    json: JsonDecoder,
}

#[derive(Debug)]
enum State {
    /// No decoder: the format is not certain yet.
    Looking(FormatSearch),
    Lines(LinesDecoder),
    Json,
    /// A decoder of `ros2 topic echo` output.
    Ros(RosDecoder),
    /// A decoder of bytes after markers.
    Flexitac(FlexitacDecoder),
    Matsense(MatsenseDecoder),
    /// No decoder: bytes cannot be decoded without rows and columns.
    Unshaped,
}

#[derive(Clone, Copy)]
enum InputEnd {
    Whole,
    CutOff,
}

impl StreamDecoder {
    /// Prepares for a stream.
    pub fn new(options: StreamOptions) -> Self {
        let mut decoder = Self {
            options,
            counts: StreamCounts::default(),
            state: State::Looking(FormatSearch::default()),
            bytes: Vec::new(),
            skipping: false,
            first: true,
            torn: !options.from_start,
            clock: FrameClock::default(),
            json: JsonDecoder::new(options.size),
        };
        if let Some(format) = options.format {
            decoder.begin(format, options.from_start);
        }
        decoder
    }

    /// Returns the format of the stream; None while it is not known.
    pub fn format(&self) -> Option<StreamFormat> {
        match self.state {
            State::Looking(_) | State::Unshaped => self.options.format,
            State::Lines(_) => Some(StreamFormat::Lines),
            State::Json => Some(StreamFormat::JsonLines),
            State::Ros(_) => Some(StreamFormat::Ros2),
            State::Flexitac(_) => Some(StreamFormat::Flexitac),
            State::Matsense(_) => Some(StreamFormat::Matsense),
        }
    }

    /// Returns the counts so far.
    pub fn counts(&self) -> &StreamCounts {
        &self.counts
    }

    /// Ends the stream so far like [`Self::cut_off`], and starts again in the middle of it, as after a cable was
    /// unplugged. Frames are counted on, and times count from the very first frame.
    pub fn restart(&mut self, sink: &mut StreamSink<'_>) {
        // The end may guess the format from a few bytes, so it is not kept for the bytes to come.
        let format = self.format();
        self.cut_off(sink);
        self.reset(format, false);
    }

    /// Starts again with the first byte of another stream, possibly of another format; frames and times are counted
    /// on.
    pub fn begin_anew(&mut self) {
        self.reset(self.options.format, true);
    }

    fn reset(&mut self, format: Option<StreamFormat>, from_start: bool) {
        self.bytes.clear();
        (self.skipping, self.first, self.torn) = (false, true, !from_start);
        match &mut self.state {
            State::Lines(decoder) => self.clock = decoder.clock,
            State::Json => self.clock = self.json.clock(),
            _ => {}
        }
        if from_start {
            self.json.forget_key();
        }
        self.state = State::Looking(FormatSearch::default());
        self.options.from_start = from_start;
        if let Some(format) = format {
            self.begin(format, from_start);
        }
    }

    /// Starts the decoder of a format. `from_start` says whether the next byte begins a frame.
    fn begin(&mut self, format: StreamFormat, from_start: bool) {
        let (size, clock) = (self.options.size, self.clock);
        self.state = match (format, size) {
            (StreamFormat::Lines, _) => State::Lines(LinesDecoder::new(size, from_start, clock)),
            (StreamFormat::JsonLines, _) => {
                self.json.begin(clock);
                State::Json
            }
            (StreamFormat::Ros2, _) => State::Ros(RosDecoder::new(size, from_start)),
            (StreamFormat::Flexitac, Some(size)) => {
                State::Flexitac(FlexitacDecoder::new(size, from_start))
            }
            (StreamFormat::Matsense, Some(size)) => {
                State::Matsense(MatsenseDecoder::new(size, from_start))
            }
            (StreamFormat::Flexitac | StreamFormat::Matsense, None) => {
                self.counts.unshaped = self.counts.unshaped.or(Some(0));
                State::Unshaped
            }
        };
    }

    /// Decodes the next bytes.
    pub fn push(&mut self, bytes: &[u8], sink: &mut StreamSink<'_>) {
        self.counts.bytes += bytes.len() as u64;
        let output = &mut StreamOutput::new(&mut self.counts, sink);
        match &mut self.state {
            State::Looking(_) => {
                self.bytes.extend_from_slice(bytes);
                self.look(false, sink);
            }
            State::Flexitac(decoder) => decoder.push(bytes, output),
            State::Matsense(decoder) => decoder.push(bytes, output),
            State::Unshaped => {}
            State::Lines(_) | State::Json | State::Ros(_) => self.text(bytes, sink),
        }
    }

    /// Ends an input that has ended by itself, like a file: reports the frames that are whole, and counts those that
    /// are not. The last line may lack its line break.
    pub fn finish(&mut self, sink: &mut StreamSink<'_>) {
        self.end(InputEnd::Whole, sink);
    }

    /// Ends an input that was cut off, perhaps within a frame, like a lost connection: as [`Self::finish`], but a line
    /// of numbers without a line break may lack digits, so its frame is dropped.
    pub fn cut_off(&mut self, sink: &mut StreamSink<'_>) {
        self.end(InputEnd::CutOff, sink);
    }

    fn end(&mut self, how: InputEnd, sink: &mut StreamSink<'_>) {
        self.look(true, sink);
        let torn = take(&mut self.bytes);
        if self.first && is_parted_by_cr(&torn) {
            self.counts.drop_frames(1, &torn);
            let reason = "ends in CR alone, expected LF or CR LF";
            self.counts.reason = Some(reason.to_owned());
            return;
        }
        let torn = self.without_mark(&torn);
        let output = &mut StreamOutput::new(&mut self.counts, sink);
        match &mut self.state {
            State::Lines(decoder) => match how {
                InputEnd::Whole => {
                    if !torn.is_empty() {
                        decoder.line(torn, output);
                    }
                    decoder.finish(b"", output);
                }
                InputEnd::CutOff => decoder.finish(torn, output),
            },
            State::Json => self.json.line(torn, output),
            State::Ros(decoder) => {
                decoder.line(torn, output);
                decoder.finish(output);
            }
            State::Flexitac(decoder) => decoder.finish(output),
            State::Matsense(decoder) => decoder.finish(output),
            State::Looking(_) | State::Unshaped => {}
        }
    }

    fn text(&mut self, bytes: &[u8], sink: &mut StreamSink<'_>) {
        let mut rest = bytes;
        while let Some(end) = rest.iter().position(|&byte| byte == b'\n') {
            let (line, after) = (&rest[..end], &rest[end + 1..]);
            rest = after;
            if take(&mut self.skipping) {
                self.bytes.clear();
                continue;
            }
            if self.bytes.is_empty() {
                self.line(line, sink);
            } else {
                let mut whole = take(&mut self.bytes);
                whole.extend_from_slice(line);
                self.line(&whole, sink);
                whole.clear();
                self.bytes = whole;
            }
        }
        if self.skipping {
            return;
        }
        if self.bytes.len() + rest.len() > LONGEST_LINE {
            self.counts.drop_frames(1, rest);
            self.bytes.clear();
            self.skipping = true;
        } else {
            self.bytes.extend_from_slice(rest);
        }
    }

    /// Decodes a line without its end; skips the first one if the stream was joined in the middle. An object of JSON
    /// is whole: the end of a line does not open what it closes.
    fn line(&mut self, line: &[u8], sink: &mut StreamSink<'_>) {
        let line = self.without_mark(line);
        if take(&mut self.torn) && !(matches!(self.state, State::Json) && is_object(line)) {
            return;
        }
        let output = &mut StreamOutput::new(&mut self.counts, sink);
        match &mut self.state {
            State::Lines(decoder) => decoder.line(line, output),
            State::Json => self.json.line(line, output),
            State::Ros(decoder) => decoder.line(line, output),
            _ => {}
        }
    }

    /// Removes the byte order mark that may precede the first line.
    fn without_mark<'a>(&mut self, line: &'a [u8]) -> &'a [u8] {
        let first = take(&mut self.first);
        if first { without_mark(line) } else { line }
    }

    /// Detects the format if it is not known, and then decodes the bytes so far.
    fn look(&mut self, ended: bool, sink: &mut StreamSink<'_>) {
        let State::Looking(search) = &mut self.state else {
            return;
        };
        let Some(format) = search.format(&self.bytes, self.options.size, ended) else {
            return;
        };
        let mut lines = self.bytes.split(|&byte| byte == b'\n');
        self.counts.unknown = format == StreamFormat::Lines
            && self.options.format.is_none()
            && !lines.any(|line| is_numbers(line.trim_ascii()));
        self.begin(format, self.options.from_start);
        let bytes = take(&mut self.bytes);
        // These bytes have been counted already.
        self.counts.bytes -= bytes.len() as u64;
        self.push(&bytes, sink);
    }
}

/// Returns true if a line is a whole object of JSON, with or without `NaN`.
fn is_object(line: &[u8]) -> bool {
    let line = WithoutNan::new(line.trim_ascii()).line;
    line.starts_with(b"{") && serde_json::from_slice::<IgnoredAny>(&line).is_ok()
}

#[cfg(test)]
mod tests {
    use taxel_core::frame::FrameSize;

    use super::*;
    use crate::formats::file::BYTE_ORDER_MARK;
    use crate::formats::stream::StreamEvent;

    #[test]
    fn large_frames_after_markers_are_found_wherever_the_stream_is_joined() {
        let side = 200_u16;
        let cells = usize::from(side) * usize::from(side);
        let frame = [vec![0xaa, 0x55], vec![7; cells]].concat();
        let stream = frame.repeat(6);
        for piece in [1 << 12, stream.len()] {
            for joined in [0, 1, cells / 2, cells] {
                let options = StreamOptions::default()
                    .with_size(FrameSize::new(side, side).expect("an allowed size"));
                let mut decoder = StreamDecoder::new(options);
                let mut sink = |_: StreamEvent<'_>| {};
                for bytes in stream[joined..].chunks(piece) {
                    decoder.push(bytes, &mut sink);
                }
                decoder.finish(&mut sink);
                assert_eq!(decoder.format(), Some(StreamFormat::Flexitac), "{joined}");
                let whole = if joined == 0 { 6 } else { 5 };
                assert_eq!(decoder.counts().frames, whole, "{joined}");
            }
        }
    }

    #[test]
    fn joining_json_lines_between_two_frames_costs_no_frame() {
        for (text, frames) in [
            ("{\"frame\":[[1,NaN]]}\n{\"frame\":[[3,4]]}\n", 2),
            ("[[1,2]]}\n{\"frame\":[[3,4]]}\n", 1),
            ("{\"frame\":[[1,2]]},\"t\":1}\n{\"frame\":[[3,4]]}\n", 1),
        ] {
            for format in [None, Some(StreamFormat::JsonLines)] {
                let options = StreamOptions {
                    format,
                    ..StreamOptions::default()
                };
                let mut decoder = StreamDecoder::new(options);
                let mut sink = |_: StreamEvent<'_>| {};
                decoder.push(text.as_bytes(), &mut sink);
                let counts = decoder.counts();
                assert_eq!((counts.frames, counts.dropped), (frames, 0), "{text}");
            }
        }
    }

    #[test]
    fn a_stream_that_is_cut_off_within_a_line_says_so() {
        let size = Some(FrameSize::new(2, 2).expect("an allowed size"));
        let torn = Some("no line break after it");
        let of_rows = "row 2 has 1 number, expected 2";
        for (text, size, expected) in [
            ("1,2,3,4\n5,6,7,8", size, (1, 1, None, torn)),
            ("1 2\n3 4\n\n5 6\n7", None, (1, 1, None, torn)),
            // The first fault of a frame counts.
            ("1 2\n3 4\n\n5 6\n7\n8", None, (1, 1, None, Some(of_rows))),
            // The rest of a line does not change the number of values in the lines above it.
            ("1,2,3,4\n5,6", None, (0, 0, Some(4), None)),
            ("1 2 3\n4 5\n", None, (0, 0, Some(0), None)),
        ] {
            let mut options = StreamOptions::default().from_start();
            options.format = Some(StreamFormat::Lines);
            options.size = size;
            let mut decoder = StreamDecoder::new(options);
            decoder.push(text.as_bytes(), &mut |_| ());
            decoder.cut_off(&mut |_| ());
            let counts = decoder.counts();
            let reason = counts.reason.as_deref();
            let found = (counts.frames, counts.dropped, counts.unshaped, reason);
            assert_eq!(found, expected, "{text:?}");
        }
    }

    #[test]
    fn the_last_line_of_a_stream_that_has_ended_may_lack_its_line_break() {
        let size = Some(FrameSize::new(2, 2).expect("an allowed size"));
        let few = Some("3 numbers, expected 4 for a frame of 2 rows of 2, or 2 for a row");
        for (text, size, expected) in [
            ("1,2,3,4\n5,6,7,8", size, (2, 0, None)),
            ("1 2\n3 4\n\n5 6\n7 8", None, (2, 0, None)),
            ("1,2,3,4\n5,6,7,8\n", size, (2, 0, None)),
            ("1,2,3,4\n5,6,7", size, (1, 1, few)),
        ] {
            let mut options = StreamOptions::default().from_start();
            options.format = Some(StreamFormat::Lines);
            options.size = size;
            let mut decoder = StreamDecoder::new(options);
            decoder.push(text.as_bytes(), &mut |_| ());
            decoder.finish(&mut |_| ());
            let counts = decoder.counts();
            let found = (counts.frames, counts.dropped, counts.reason.as_deref());
            assert_eq!(found, expected, "{text:?}");
        }
    }

    #[test]
    fn a_byte_order_mark_costs_no_frame() {
        for (text, frames) in [
            ("{\"frame\":[[1,2],[3,4]]}\n{\"frame\":[[5,6],[7,8]]}\n", 2),
            ("{\"frame\":[[1,2],[3,4]]}", 1),
            ("1 2\n3 4\n\n5 6\n7 8\n\n", 2),
            ("data:\n- 1\n- 2\n---\n", 1),
        ] {
            for format in [None, Some(StreamFormat::JsonLines)] {
                let mut options = StreamOptions::default().from_start();
                options.format = format.filter(|_| text.starts_with('{'));
                if text.starts_with('d') {
                    options = options.with_size(FrameSize::new(2, 1).expect("an allowed size"));
                }
                let mut decoder = StreamDecoder::new(options);
                let mut sink = |_: StreamEvent<'_>| {};
                decoder.push(&[BYTE_ORDER_MARK, text.as_bytes()].concat(), &mut sink);
                decoder.finish(&mut sink);
                let counts = decoder.counts();
                assert_eq!((counts.frames, counts.dropped), (frames, 0), "{text}");
            }
        }
    }

    fn times([before, after]: [&str; 2]) -> Vec<Option<f64>> {
        let mut decoder = StreamDecoder::new(StreamOptions::default().from_start());
        let mut times = Vec::new();
        let mut sink = |event: StreamEvent<'_>| {
            if let StreamEvent::Frame(frame) = event {
                times.push(frame.time);
            }
        };
        decoder.push(before.as_bytes(), &mut sink);
        decoder.begin_anew();
        decoder.push(after.as_bytes(), &mut sink);
        times
    }

    #[test]
    fn another_file_may_give_times_under_another_key() {
        let before = "{\"t_ms\":1000,\"frame\":[[1]]}\n{\"t_ms\":1500,\"frame\":[[2]]}\n";
        let after =
            "{\"stamp_us\":9000000,\"frame\":[[3]]}\n{\"stamp_us\":9500000,\"frame\":[[4]]}\n";
        let times = times([before, after]);
        assert_eq!(times, [0.0, 0.5, 8.0, 8.5].map(Some));
    }

    #[test]
    fn times_count_from_the_first_frame_even_if_a_block_before_it_is_not_a_frame() {
        let torn = "00:00:01 5 6\n\n";
        let whole = "00:00:02 1 2\n00:00:02 3 4\n\n00:00:03 1 2\n00:00:03 3 4\n\n";
        let times = times([&format!("{torn}{whole}"), ""]);
        assert_eq!(times, [0.0, 1.0].map(Some));
    }

    #[test]
    fn a_unit_that_is_guessed_is_noted() {
        let line = "{\"timestamp\":1700000000000000000,\"frame\":[[1]]}\n";
        let mut decoder = StreamDecoder::new(StreamOptions::default().from_start());
        let mut notes = Vec::new();
        let mut sink = |event: StreamEvent<'_>| {
            if let StreamEvent::Note(note) = event {
                notes.push(note.to_string());
            }
        };
        decoder.push(line.repeat(3).as_bytes(), &mut sink);
        let noted = "the times have no unit and are taken as nanoseconds since 1970";
        assert_eq!(notes, [noted]);
    }
}
