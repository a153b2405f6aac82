//! Searches for the format of a stream, byte by byte, so that the result does not depend on the pieces in which the
//! bytes arrive.
//!
//! - Text has the format of the first line that only one format can have: an object, the output of `ros2 topic echo`,
//!   or numbers. The first line may be the end of another one, so numbers in it decide nothing.
//! - Bytes that are not text may be noise before a text, such as what a board sends while it starts, or a greeting in
//!   UTF-8. So they have a format only once frames are found in them: `FlexiTac` if two markers are a frame apart,
//!   `MatSense` if frames of the right length end as they should. Until then, two successive lines of one format make
//!   the stream text.
//!
//! A stream that shows none of this is taken for numbers if it is text, and otherwise for `MatSense`, whose decoder
//! counts what it drops.

use crate::formats::stream::old::{self};
use taxel_core::frame::{FrameSize, MAX_FRAME_CELLS};

use crate::formats::file::BYTE_ORDER_MARK;
use crate::formats::recording::ros::echo;
use crate::formats::stream::boards::{MARKER, MatsenseDecoder};
use crate::formats::stream::event::{StreamCounts, StreamEvent, StreamFormat, StreamOutput};
use crate::formats::stream::row_block;

/// The number of bytes of text within which a line must end; otherwise it is not a known stream.
const LOOKED_AT: usize = 1 << 16;

/// The number of bytes after which anything but text is no longer taken for noise before a text.
const NOISE: usize = 1 << 12;

const MARKERS_IN: usize = 3 * (MAX_FRAME_CELLS + 2) + 3;

/// The search for the format of a stream. When more bytes arrive, it continues where it was.
#[derive(Clone, Debug, Default)]
pub(super) struct FormatSearch {
    seen: usize,
    line: usize,
    after_first: bool,
    /// The end of the last byte that is not text; 0 if all are text.
    text_from: usize,
    shown: Option<StreamFormat>,
    trial: Option<MatsenseDecoder>,
}

impl FormatSearch {
    /// Returns the format of a stream that begins with these bytes; None if more are needed.
    pub(super) fn format(
        &mut self,
        bytes: &[u8],
        size: Option<FrameSize>,
        ended: bool,
    ) -> Option<StreamFormat> {
        if bytes.len() < BYTE_ORDER_MARK.len() && BYTE_ORDER_MARK.starts_with(bytes) && !ended {
            return None;
        }
        if self.seen == 0 && bytes.starts_with(BYTE_ORDER_MARK) {
            (self.seen, self.line) = (BYTE_ORDER_MARK.len(), BYTE_ORDER_MARK.len());
        }
        while self.seen < bytes.len() {
            self.seen += 1;
            let found = self.after_byte(&bytes[..self.seen], size);
            if found.is_some() {
                return found;
            }
        }
        ended.then(|| self.at_end(bytes, size))
    }

    /// Returns the format once the last of these bytes is known.
    fn after_byte(&mut self, bytes: &[u8], size: Option<FrameSize>) -> Option<StreamFormat> {
        let &byte = bytes.last()?;
        let was_text = self.text_from == 0;
        if !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c | b' '..=b'~') {
            self.text_from = bytes.len();
        } else if byte == b'\n'
            && let Some(format) = self.after_line(bytes)
        {
            return Some(format);
        }
        if self.text_from > 0 {
            let new = if was_text {
                bytes
            } else {
                &bytes[bytes.len() - 1..]
            };
            if let Some(format) = self.in_bytes(bytes, new, size) {
                return Some(format);
            }
        }
        let is_long = bytes.len() - self.text_from >= LOOKED_AT;
        is_long.then(|| self.of_open_line(bytes).unwrap_or(StreamFormat::Lines))
    }

    /// Returns the format once the line is known that ends these bytes.
    fn after_line(&mut self, bytes: &[u8]) -> Option<StreamFormat> {
        let line = bytes[self.line..].trim_ascii();
        let form = form_of_line(line, self.after_first).filter(|_| self.is_text(line));
        (self.line, self.after_first) = (bytes.len(), true);
        if self.text_from == 0 || form.is_some() && form == self.shown {
            return form;
        }
        if !line.is_empty() {
            self.shown = form;
        }
        None
    }

    /// Returns true if the last line is text: in ASCII, or in UTF-8, since names of channels may be.
    fn is_text(&self, line: &[u8]) -> bool {
        let is_control = |sign: char| sign.is_control() && !matches!(sign, '\t' | '\x0c');
        self.text_from <= self.line
            || str::from_utf8(line).is_ok_and(|text| !text.contains(is_control))
    }

    /// Returns the format of bytes that are not all text; `new` are the last ones, which are new.
    fn in_bytes(
        &mut self,
        bytes: &[u8],
        new: &[u8],
        size: Option<FrameSize>,
    ) -> Option<StreamFormat> {
        let enough = size.map_or(0, bytes_enough);
        match size {
            None if bytes == MARKER => return Some(StreamFormat::Flexitac),
            None => {}
            Some(size) => {
                let before = bytes.len().checked_sub(period(size));
                if bytes.ends_with(&MARKER)
                    && before.is_some_and(|end| bytes[..end].ends_with(&MARKER))
                {
                    return Some(StreamFormat::Flexitac);
                }
                let trial = self
                    .trial
                    .get_or_insert_with(|| MatsenseDecoder::new(size, false));
                let (mut counts, mut sink) = (StreamCounts::default(), |_: StreamEvent<'_>| ());
                trial.push(new, &mut StreamOutput::new(&mut counts, &mut sink));
                // With fewer bytes, markers could still show another format.
                if bytes.len() >= enough && trial.is_sure() {
                    return Some(StreamFormat::Matsense);
                }
            }
        }
        (self.text_from >= NOISE.max(enough)).then_some(StreamFormat::Matsense)
    }

    fn of_open_line(&self, bytes: &[u8]) -> Option<StreamFormat> {
        let line = bytes[self.line..].trim_ascii();
        form_of_line(line, self.after_first).filter(|_| self.is_text(line))
    }

    fn at_end(&self, bytes: &[u8], size: Option<FrameSize>) -> StreamFormat {
        let text = self.of_open_line(bytes).or(self.shown);
        if self.text_from == 0 {
            return text.unwrap_or(StreamFormat::Lines);
        }
        let is_short = size.is_some_and(|size| bytes.len() < bytes_enough(size));
        if is_short && bytes.starts_with(&MARKER) {
            return StreamFormat::Flexitac;
        }
        let has_frames = self.trial.as_ref().is_some_and(MatsenseDecoder::has_frames);
        text.filter(|_| !has_frames)
            .unwrap_or(StreamFormat::Matsense)
    }
}

fn period(size: FrameSize) -> usize {
    MARKER.len() + size.cells()
}

/// Returns the number of bytes within which a marker and the next one would have been found: three frames.
fn bytes_enough(size: FrameSize) -> usize {
    (3 * period(size) + 3).min(MARKERS_IN)
}

/// Returns the format of text with such a line; None if other formats may have it, too.
fn form_of_line(line: &[u8], after_first: bool) -> Option<StreamFormat> {
    match line.trim_ascii() {
        // For rows without an object, the decoder of JSON lines says what is missing.
        [b'{', ..] | [b'[', b'[', ..] => Some(StreamFormat::JsonLines),
        line if line == b"---" || echo::begins_message(line) => Some(StreamFormat::Ros2),
        line if after_first && is_numbers(line) => Some(StreamFormat::Lines),
        _ => None,
    }
}

/// Returns true if a line holds at least one number and nothing else; a timestamp may precede the numbers.
pub(super) fn is_numbers(line: &[u8]) -> bool {
    let line = old::leading(line).map_or(line, |(_, numbers)| numbers);
    let mut values = Vec::new();
    row_block::read_row(line, &mut values, usize::MAX).is_some() && !values.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(bytes: &[u8], size: Option<FrameSize>) -> Option<StreamFormat> {
        FormatSearch::default().format(bytes, size, true)
    }

    #[test]
    fn a_text_after_noise_has_its_format() {
        for noise in [
            &b"\xf8\x80 3\r\n"[..],
            b"\x82l\xeel\x8c\x1c\x8c\xfc\x00\x8e\x8e rl\r\nready\r\n\r\n",
            "Größe 2×2\r\n\r\n".as_bytes(),
            &[0xff; 300],
        ] {
            for (text, format) in [
                ("1 2\r\n3 1\r\n\r\n", StreamFormat::Lines),
                ("1,2,3,1\n1,2,3,2\n", StreamFormat::Lines),
                ("{\"frame\":[[1,2]]}\n", StreamFormat::JsonLines),
                ("---\ndata: [1, 2]\n---\n", StreamFormat::Ros2),
            ] {
                for size in [None, Some(FrameSize::new(2, 2).expect("an allowed size"))] {
                    let stream = [noise, b"\n", text.repeat(40).as_bytes()].concat();
                    let mut search = FormatSearch::default();
                    assert_eq!(search.format(&stream, size, false), Some(format), "{text}");
                    // A few lines are enough at the end of the input.
                    let stream = [noise, b"\n", text.as_bytes()].concat();
                    assert_eq!(found(&stream, size), Some(format), "{text}");
                }
            }
        }
    }

    #[test]
    fn lines_in_utf_8_are_text() {
        let line = "{\"channel\":\"Größe\",\"frame\":[[1,2]]}\n".repeat(2);
        let mut search = FormatSearch::default();
        let found = search.format(line.as_bytes(), None, false);
        assert_eq!(found, Some(StreamFormat::JsonLines));
        // The rest of a message that began earlier.
        let echo = b"- 3\n- 4\n- 5\n---\ndata:\n- 1\n";
        assert_eq!(
            FormatSearch::default().format(echo, None, false),
            Some(StreamFormat::Ros2)
        );
    }

    #[test]
    fn bytes_have_a_format_once_their_frames_are_found() {
        let size = Some(FrameSize::new(2, 2).expect("an allowed size"));
        let flexitac = b"\xaa\x55\x01\x02\x03\x04".repeat(9);
        let matsense = b"\x01\x02\x03\x04\xff".repeat(9);
        // Cells that look like numbers in lines.
        let digits = b"\xff\n1\n2".repeat(9);
        for (stream, format) in [
            (flexitac, StreamFormat::Flexitac),
            (matsense, StreamFormat::Matsense),
            (digits, StreamFormat::Matsense),
        ] {
            for noise in [&b""[..], b"\xf8 boot\r\n", "Größe 2×2\r\n".as_bytes()] {
                let stream = [noise, &stream].concat();
                let found = FormatSearch::default().format(&stream, size, false);
                assert_eq!(found, Some(format), "{stream:?}");
            }
        }
        // Without rows and columns, a stream that remains something other than text is not text.
        let mut search = FormatSearch::default();
        assert_eq!(search.format(&[0xff; NOISE - 1], None, false), None);
        let found = search.format(&[0xff; NOISE], None, false);
        assert_eq!(found, Some(StreamFormat::Matsense));
    }

    #[test]
    fn bytes_without_a_marker_are_matsense_after_enough_of_them() {
        let size = Some(FrameSize::new(512, 512).expect("an allowed size"));
        let bytes = vec![7; MARKERS_IN];
        let mut search = FormatSearch::default();
        assert_eq!(search.format(&bytes[1..], size, false), None);
        let found = search.format(&bytes, size, false);
        assert_eq!(found, Some(StreamFormat::Matsense));
    }
}
