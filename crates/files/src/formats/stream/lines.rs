//! Decodes lines of numbers: one frame per line, or one row per line with an empty line between frames.
//!
//! A line is never read before its end has arrived: its last number may be torn.
//! ```text
//! 0 12 7 3        a frame a line, if rows and columns are known
//!
//! 0 12            or a row a line; an empty line ends the frame, and shows its rows and columns
//! 7 3
//!
//! 2024-05-01 12:00:00.25,0,12,7,3     a moment at the beginning of a frame's first line is its time
//! # frame 7       a comment, or sep=;, wherever it stands
//! ```
//! If a stream is read from its beginning, such as a file, the first block may be a frame, or the end of one: its
//! rows and columns are those of all frames, unless the next two blocks agree on more rows. Until then it is
//! provisional.
//!
//! A frame with a row of another length is dropped as a whole, up to the next empty line: rows of two frames are
//! never joined. If frames are known to be single lines, each line that is not a frame counts as a lost one.

use crate::formats::stream::old::{self};
use taxel_core::frame::{Frame, FrameSize, MAX_FRAME_CELLS, MAX_FRAME_SIDE};

use crate::formats::recording::size::StreamSize;
use crate::formats::recording::text::is_comment;
use crate::formats::recording::time::{FrameClock, Time};
use crate::formats::stream::event::{StreamEvent, StreamOutput};
use crate::formats::stream::row_block::{self, RowBlock, WrongRow, may_be_end};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LineKind {
    /// A row of a frame, unless it has all cells.
    Row,
    /// A frame, since the last frame was a line: an invalid line is a lost frame.
    Frame,
}

#[derive(Debug)]
pub(super) struct LinesDecoder {
    size: StreamSize,
    begun: bool,
    current: RowBlock,
    /// The clock that turns timestamps into seconds since the first frame.
    pub(super) clock: FrameClock,
    parted: bool,
    /// The content of lines, as far as it is known.
    kind: LineKind,
    /// The first blocks of a stream that is read from its beginning, until it is known whether the first one is a
    /// frame.
    held: Option<Vec<RowBlock>>,
    frame: Frame,
}

impl LinesDecoder {
    /// Prepares for a stream. If it is joined in the middle, everything before the first boundary is ignored.
    pub(super) fn new(named: Option<FrameSize>, from_start: bool, clock: FrameClock) -> Self {
        Self {
            size: StreamSize::new(named),
            begun: from_start,
            current: RowBlock::default(),
            clock,
            parted: false,
            kind: match named {
                Some(size) if size.rows() == 1 => LineKind::Frame,
                _ => LineKind::Row,
            },
            held: (from_start && named.is_none()).then(Vec::new),
            frame: Frame::default(),
        }
    }

    pub(super) fn line(&mut self, line: &[u8], output: &mut StreamOutput<'_, '_>) {
        let trimmed = line.trim_ascii();
        if trimmed.is_empty() {
            self.boundary(output);
            return;
        }
        if is_comment(trimmed) {
            return;
        }
        let (moment, line) = match old::leading(line) {
            Some((moment, numbers)) => (Some(self.clock.moment(moment)), numbers),
            None => (None, line),
        };
        self.numbers(moment, line, output);
    }

    fn numbers(&mut self, moment: Option<Time>, line: &[u8], output: &mut StreamOutput<'_, '_>) {
        let before = self.current.values.len();
        let room = MAX_FRAME_CELLS.saturating_sub(before);
        let read = row_block::read_row(line, &mut self.current.values, room);
        let count = self.current.values.len() - before;
        let found = read.and(Some(count));
        // A line with all cells is a boundary itself. Frames of one row must be given as such: otherwise a line
        // before the frames, such as the numbers of their columns, would make each of their rows a frame.
        let is_frame = |size: FrameSize| size.rows() > 1 && count == size.cells();
        let is_row = |size: FrameSize| size.rows() == 1 && count == size.cells();
        if read.is_some()
            && (self.size.present().is_some_and(is_frame) || self.size.named().is_some_and(is_row))
        {
            self.current.values.drain(..before);
            self.current.time = moment;
            self.give_line(output);
            return;
        }
        if self.kind == LineKind::Frame && self.current.rows == 0 && !self.may_be_row(found) {
            self.current.values.truncate(before);
            self.size.pass_torn();
            let cells = self.size.present().map(FrameSize::cells);
            self.current.wrong = cells.and_then(|cells| WrongRow::of(1, found, cells));
            if std::mem::replace(&mut self.begun, true) {
                self.lose(1, line, output);
            }
            return;
        }
        let expected = match self.size.named() {
            Some(size) => usize::from(size.columns()),
            _ if self.current.rows > 0 => before / usize::from(self.current.rows),
            _ => count,
        };
        self.current.begin_row(moment, line, found);
        if self.current.broken || found != Some(expected) || self.current.rows > MAX_FRAME_SIDE {
            self.current.values.truncate(before);
            if !self.current.broken {
                let wrong = WrongRow::of(self.current.rows, found, expected);
                self.current.note_row(line, wrong);
            }
            self.current.broken = true;
            // No frame of a known size has that many rows.
            if self.size.present().is_none() && self.current.rows > MAX_FRAME_SIDE {
                output.counts.unshaped = Some(count as u64);
            }
            self.give_up(line, output);
        } else if self.current.rows == 1 {
            self.current.note_row(line, None);
        }
    }

    /// Reports the values of a line as a frame. The rows before it do not belong to a frame.
    fn give_line(&mut self, output: &mut StreamOutput<'_, '_>) {
        if self.current.rows > 0 && self.begun {
            // If there was no empty line so far, those rows were frames, too.
            let lost = if self.parted { 1 } else { self.current.rows };
            self.lose(lost.into(), &self.current.sample, output);
        }
        self.kind = LineKind::Frame;
        self.size.pass_torn();
        // The line before this one was complete.
        self.begun = true;
        self.give(output);
        self.current.clear();
    }

    fn may_be_row(&self, count: Option<usize>) -> bool {
        let columns = self.size.present().map(|size| size.columns().into());
        self.parted && count.is_some() && count == columns
    }

    fn lose(&self, frames: u64, sample: &[u8], output: &mut StreamOutput<'_, '_>) {
        let reason = self.current.reason(self.size.named(), self.parted);
        // The carriage return of CR LF belongs to the end of the line.
        output.lose(frames, sample.trim_ascii_end(), reason);
    }

    /// Counts an invalid line at once if, as far as is known, no empty line separates frames.
    fn give_up(&mut self, line: &[u8], output: &mut StreamOutput<'_, '_>) {
        let is_full = |size: FrameSize| self.current.rows > size.rows();
        if self.size.named().is_some_and(is_full) || self.current.rows > MAX_FRAME_SIDE {
            if self.begun {
                self.lose(1, line, output);
            }
            self.current.clear();
            self.begun = true;
        }
    }

    fn boundary(&mut self, output: &mut StreamOutput<'_, '_>) {
        self.parted = true;
        if !std::mem::replace(&mut self.begun, true) || self.current.rows == 0 {
            self.current.clear();
            return;
        }
        match self.current.size() {
            Some(own) if self.held.is_some() => self.hold(own, output),
            Some(own) => self.block(own, output),
            None => {
                self.size.pass_torn();
                self.lose(1, &self.current.sample, output);
            }
        }
        self.current.clear();
    }

    fn block(&mut self, own: FrameSize, output: &mut StreamOutput<'_, '_>) {
        match self.size.admit(own) {
            Ok(()) => {
                if self.current.rows > 1 {
                    self.kind = LineKind::Row;
                }
                self.give(output);
            }
            Err(reason) => output.lose(1, self.current.sample.trim_ascii_end(), Some(reason)),
        }
    }

    /// Holds a block until it is known whether the first one is a frame. It is, if the second is not larger, or if
    /// the third differs from the second, which may be two frames that lost the empty line between them.
    fn hold(&mut self, own: FrameSize, output: &mut StreamOutput<'_, '_>) {
        if self.held.as_ref().is_some_and(Vec::is_empty) {
            // If the block is withdrawn, another frame is the first one.
            let clock = self.clock;
            self.fill(own);
            self.clock = clock;
            output.provisional(&mut self.frame);
        }
        let held = self.held.get_or_insert_default();
        held.push(std::mem::take(&mut self.current));
        let sizes: Vec<FrameSize> = held.iter().filter_map(RowBlock::size).collect();
        match sizes[..] {
            [] | [_] => {}
            [first, second] if may_be_end(first, second) => {}
            [_, second, third] if second == third => self.release(second, output),
            [first, ..] => self.release(first, output),
        }
    }

    /// Takes the held blocks; those of the given size are frames.
    fn release(&mut self, size: FrameSize, output: &mut StreamOutput<'_, '_>) {
        let Some(held) = self.held.take() else {
            return;
        };
        self.size.begin(size);
        let differs = |first: &RowBlock| first.size() != Some(size);
        if held.first().is_some_and(differs) {
            output.report(StreamEvent::Withdrawn);
        }
        for block in held {
            self.current = block;
            if let Some(own) = self.current.size() {
                self.block(own, output);
            }
        }
    }

    fn give(&mut self, output: &mut StreamOutput<'_, '_>) {
        let Some(size) = self.size.present() else {
            return;
        };
        self.fill(size);
        output.frame(&mut self.frame);
    }

    fn fill(&mut self, size: FrameSize) {
        self.frame.reset(size);
        let time = self.current.time;
        self.frame.time = time.map(|time| self.clock.since_first(time));
        self.frame
            .values_mut()
            .copy_from_slice(&self.current.values);
    }

    /// Ends the input: the last frame may lack its empty line. An incomplete frame is dropped.
    pub(super) fn finish(&mut self, torn: &[u8], output: &mut StreamOutput<'_, '_>) {
        let is_torn = !torn.trim_ascii().is_empty();
        let has_rows = self.current.rows > 0 || is_torn;
        // Only lines and no empty one: they are frames, or the rows of a single frame.
        if self.size.present().is_none() && !self.parted && has_rows {
            let values = match usize::from(self.current.rows) {
                rows if rows > 0 && !self.current.broken => self.current.values.len() / rows,
                // Neither no rows nor rows of different lengths show it.
                _ => 0,
            };
            output.counts.unshaped = Some(values as u64);
            self.current.clear();
            return;
        }
        if is_torn {
            self.current.add_torn(torn);
        }
        self.boundary(output);
        let first = self.held.as_ref().and_then(|held| held.first());
        if let Some(size) = first.and_then(RowBlock::size) {
            self.release(size, output);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::stream::event::StreamCounts;

    fn decoded(text: &str, named: Option<(u16, u16)>) -> (Vec<(u16, u16, f64)>, u64) {
        let named =
            named.map(|(rows, columns)| FrameSize::new(columns, rows).expect("an allowed size"));
        let mut decoder = LinesDecoder::new(named, true, FrameClock::default());
        let (mut frames, mut counts) = (Vec::new(), StreamCounts::default());
        let mut sink = |event: StreamEvent<'_>| {
            if let StreamEvent::Frame(frame) = event {
                frames.push((frame.rows(), frame.columns(), frame.values()[0]));
            }
        };
        for line in text.lines() {
            decoder.line(
                line.as_bytes(),
                &mut StreamOutput::new(&mut counts, &mut sink),
            );
        }
        decoder.finish(b"", &mut StreamOutput::new(&mut counts, &mut sink));
        (frames, counts.dropped)
    }

    #[test]
    fn a_number_before_the_frames_does_not_fix_their_shape() {
        let frames: String = (1..=5).map(|n| format!("{n} 2\n3 4\n\n")).collect();
        let stream = format!("1.2\n\n{frames}");
        let whole: Vec<_> = (1..=5).map(|n| (2, 2, f64::from(n))).collect();
        assert_eq!(decoded(&stream, None), (whole.clone(), 1));
        // A given shape stays.
        assert_eq!(decoded(&stream, Some((1, 1))).0, [(1, 1, 1.2)]);
        // As many numbers as the frames have columns.
        assert_eq!(decoded(&format!("0 1\n\n{frames}"), None), (whole, 1));
        // More numbers than the frames have columns: three frames in succession are needed.
        let found = vec![(1, 3, 0.0), (2, 2, 3.0), (2, 2, 4.0), (2, 2, 5.0)];
        assert_eq!(decoded(&format!("0 1 2\n\n{frames}"), None), (found, 2));
        // Frames of one row each end in an empty line, or their size is given.
        let rows = vec![(1, 2, 1.0), (1, 2, 3.0)];
        assert_eq!(decoded("1 2\n\n3 4\n\n", None), (rows.clone(), 0));
        assert_eq!(decoded("1 2\n3 4\n", Some((1, 2))), (rows, 0));
    }

    #[test]
    fn the_end_of_a_frame_is_not_taken_for_the_first_frame() {
        let whole = "1 2 3\n4 5 6\n7 8 9\n\n";
        for torn in ["9\n\n", "8 9\n\n", "7 8 9\n\n", "4 5 6\n7 8 9\n\n"] {
            let stream = format!("{torn}{}", whole.repeat(3));
            let found = (vec![(3, 3, 1.0); 3], 1);
            assert_eq!(decoded(&stream, None), found, "{torn}");
        }
        // The input ends, or an empty line between two frames was lost.
        assert_eq!(decoded(whole, None), (vec![(3, 3, 1.0)], 0));
        let joined = whole.trim_end().to_owned() + "\n" + whole;
        let stream = [whole, &joined, whole, whole].concat();
        assert_eq!(decoded(&stream, None), (vec![(3, 3, 1.0); 3], 1));
        let stream = [whole, &joined].concat();
        assert_eq!(decoded(&stream, None), (vec![(3, 3, 1.0)], 1));
    }

    #[test]
    fn the_first_block_is_shown_at_once_and_withdrawn_if_it_is_not_a_frame() {
        let mut decoder = LinesDecoder::new(None, true, FrameClock::default());
        let (mut events, mut counts) = (String::new(), StreamCounts::default());
        for line in ["3 4", "", "1 2", "3 4", "", "1 2", "3 4", ""] {
            let mut sink = |event: StreamEvent<'_>| {
                events += match event {
                    StreamEvent::Frame(_) => "frame ",
                    StreamEvent::Provisional(_) => "provisional ",
                    StreamEvent::Withdrawn => "withdrawn ",
                    StreamEvent::Channel(_) => "channel ",
                    StreamEvent::Note(_) => "note ",
                };
            };
            decoder.line(
                line.as_bytes(),
                &mut StreamOutput::new(&mut counts, &mut sink),
            );
        }
        assert_eq!(events, "provisional withdrawn frame frame ");
    }

    #[test]
    fn if_frames_are_single_lines_every_wrong_line_is_counted() {
        let shape = Some((2, 3));
        let (whole, torn) = ("1,2,3,4,5,6\n", "1,2,3,4,5\n1,2,3,4\n1,2,3,4,5,9,9\n");
        let stream = [whole, whole, torn, whole, whole];
        assert_eq!(decoded(&stream.concat(), shape), (vec![(2, 3, 1.0); 4], 3));
        // As long as a row, at the beginning, at the end, with words, and after an empty line.
        let stream = ["1,2\n", "1,2,3,4\n", whole, "1,2,3\n", "x\n", whole, torn];
        assert_eq!(decoded(&stream.concat(), shape), (vec![(2, 3, 1.0); 2], 7));
        let stream = ["version 1\n\n", whole, torn, whole, "\n", torn, whole];
        assert_eq!(decoded(&stream.concat(), shape), (vec![(2, 3, 1.0); 3], 7));
        let stream = "1,2\n1\n1,2,3\nx\n3,4\n";
        let found = vec![(1, 2, 1.0), (1, 2, 3.0)];
        assert_eq!(decoded(stream, Some((1, 2))), (found, 3));
        // A frame of several rows is lost once, also after a frame that has lost the end of a line.
        let (rows, torn) = ("1 2 3\n4 5 6\n\n", "1 2 3\n4 5\n4\n\n");
        let stream = [rows, torn, rows, "1 2 3 4 5 6\n\n", torn, rows, torn];
        assert_eq!(decoded(&stream.concat(), shape), (vec![(2, 3, 1.0); 4], 3));
    }

    #[test]
    fn a_moment_before_a_frame_is_its_time() {
        let times = |text: &str, shape| {
            let mut decoder = LinesDecoder::new(shape, true, FrameClock::default());
            let (mut times, mut counts) = (Vec::new(), StreamCounts::default());
            let mut sink = |event: StreamEvent<'_>| {
                if let StreamEvent::Frame(frame) = event {
                    times.push((frame.time, frame.values()[0]));
                }
            };
            for line in text.lines() {
                decoder.line(
                    line.as_bytes(),
                    &mut StreamOutput::new(&mut counts, &mut sink),
                );
            }
            decoder.finish(b"", &mut StreamOutput::new(&mut counts, &mut sink));
            (times, counts.dropped)
        };
        let lines = "2024-05-01 23:59:59.75,1,2,3,4\n5,6,7,8\n2024-05-02T00:00:00.5,9,1,1,1\n";
        let found = vec![(Some(0.0), 1.0), (None, 5.0), (Some(0.75), 9.0)];
        assert_eq!(
            times(lines, Some(FrameSize::new(2, 2).expect("an allowed size"))),
            (found, 0)
        );
        // Rows with a timestamp each: the first one counts. Midnight passes.
        let rows = "23:59:59 1 2\n23:59:59.1 3 4\n\n00:00:00 5 6\n00:00:00.1 7 8\n\n";
        let found = vec![(Some(0.0), 1.0), (Some(1.0), 5.0)];
        assert_eq!(times(rows, None), (found, 0));
        // The comma may be a decimal sign.
        let unclear = "12:00:00,125 1 2 3 4\n";
        assert_eq!(
            times(
                unclear,
                Some(FrameSize::new(2, 2).expect("an allowed size"))
            ),
            (Vec::new(), 1)
        );
        let cells = "12:00:00,512,2\n12:00:00,498,4\n\n";
        assert_eq!(times(cells, None), (vec![(Some(0.0), 512.0)], 0));
        assert_eq!(
            times(
                "12:00:00,512,2,3,4\n",
                Some(FrameSize::new(2, 2).expect("an allowed size"))
            ),
            (vec![(Some(0.0), 512.0)], 0)
        );
    }

    #[test]
    fn comments_cost_no_frame() {
        let frame = "# frame 7\n1 2\n # rows\n3 4\n\n";
        assert_eq!(decoded(&frame.repeat(4), None), (vec![(2, 2, 1.0); 4], 0));
        let lines = "# two frames\n1,2,3,4\n# and one\n1,2,3,4\n";
        let found = (vec![(2, 2, 1.0); 2], 0);
        assert_eq!(decoded(lines, Some((2, 2))), found);
        let table = "sep=;\n\"1\";\"2\"\n3;4\n";
        let found = (vec![(1, 2, 1.0), (1, 2, 3.0)], 0);
        assert_eq!(decoded(table, Some((1, 2))), found);
    }

    #[test]
    fn torn_frames_do_not_change_the_shape() {
        let (whole, torn) = ("1 2\n3 4\n\n", "1 2\n\n");
        // Two in succession, and then two more, with frames of other shapes in between.
        let stream = [
            whole,
            "9\n\n",
            "9\n\n",
            whole,
            "9\n\n",
            "9\n\n",
            "5 5 5\n\n",
            whole,
        ];
        assert_eq!(decoded(&stream.concat(), None), (vec![(2, 2, 1.0); 3], 5));
        let stream = [whole, torn, torn, "1 x\n\n", torn, whole];
        assert_eq!(decoded(&stream.concat(), None), (vec![(2, 2, 1.0); 2], 4));
    }

    #[test]
    fn two_frames_of_one_size_are_reported_before_a_third_arrives() {
        let mut decoder = LinesDecoder::new(None, true, FrameClock::default());
        let (mut given, mut counts) = (0, StreamCounts::default());
        for line in ["1 2", "3 4", "", "5 6", "7 8", ""] {
            let mut sink = |event: StreamEvent<'_>| {
                given += u32::from(matches!(event, StreamEvent::Frame(_)));
            };
            decoder.line(
                line.as_bytes(),
                &mut StreamOutput::new(&mut counts, &mut sink),
            );
        }
        assert_eq!((given, counts.dropped), (2, 0));
    }
}
