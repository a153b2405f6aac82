//! The signs by which formats of recordings are recognised at the start of a file or a stream: magic bytes, and words
//! that only one vendor writes. Words are found line by line, so that a stream can be looked at while it arrives.

use crate::formats::npy;
use crate::formats::recording::format::RecordingFormat;
use crate::formats::recording::ros::MCAP_MAGIC;
use crate::formats::recording::vendor::xsensor;
use crate::formats::stream::FLEXITAC_MARKER;

/// The first bytes of the formats that have such bytes. An archive without a file begins with its end.
const MAGIC: [(&[u8], RecordingFormat); 5] = [
    (npy::MAGIC, RecordingFormat::Npy),
    (&MCAP_MAGIC, RecordingFormat::Mcap),
    (&FLEXITAC_MARKER, RecordingFormat::Flexitac),
    (b"PK\x03\x04", RecordingFormat::Npz),
    (b"PK\x05\x06", RecordingFormat::Npz),
];

/// The most bytes that decide by themselves.
#[cfg(unix)]
pub(super) const LONGEST_MAGIC: usize = MCAP_MAGIC.len();

/// Returns the format whose magic bytes are at the start.
pub(super) fn by_magic(start: &[u8]) -> Option<RecordingFormat> {
    let mut formats = MAGIC.into_iter();
    formats.find_map(|(magic, format)| start.starts_with(magic).then_some(format))
}

/// Returns true if a text of JSON has the key without which there is no frame in JSON lines.
pub(super) fn names_frame(text: &[u8]) -> bool {
    has(text, b"\"frame\"")
}

/// Returns true if a text contains a word.
fn has(text: &[u8], word: &[u8]) -> bool {
    text.windows(word.len()).any(|window| window == word)
}

/// The words of vendors in the lines so far. The format whose words are complete first counts.
#[derive(Debug, Default)]
pub(super) struct VendorSigns {
    /// The number of lines that are not blank.
    lines: usize,
    /// Whether XSENSOR's line that begins a frame was found.
    has_frame: bool,
}

impl VendorSigns {
    /// Returns the format whose words are in a text without a byte order mark.
    pub(super) fn of(text: &[u8]) -> Option<RecordingFormat> {
        let mut signs = Self::default();
        text.split(|&byte| byte == b'\n')
            .find_map(|line| signs.add(line))
    }

    /// Adds the next line, without its end. Returns the format if its words are complete now. `DATA_TYPE` is an ordinary
    /// word, so it counts only at the start of a text, where Tekscan writes it.
    pub(super) fn add(&mut self, line: &[u8]) -> Option<RecordingFormat> {
        let is_blank = line.trim_ascii().is_empty();
        let is_first = self.lines == 0 && !is_blank;
        self.lines += usize::from(!is_blank);
        if line.starts_with(b"ASCII_DATA") || is_first && line.starts_with(b"DATA_TYPE ") {
            return Some(RecordingFormat::Tekscan);
        }
        if self.has_frame && xsensor::begins_cells(line) {
            return Some(RecordingFormat::Xsensor);
        }
        self.has_frame |= xsensor::begins_frame(line);
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ordinary_word_is_a_sign_only_where_the_vendor_writes_it() {
        let tekscan = Some(RecordingFormat::Tekscan);
        for (text, expected) in [
            ("DATA_TYPE MOVIE\nROWS 2\n", tekscan),
            ("\r\nDATA_TYPE MOVIE\r\n", tekscan),
            ("boot v1\nDATA_TYPE ready\n1 2\n", None),
            ("boot v1\nASCII_DATA @@\n", tekscan),
        ] {
            assert_eq!(VendorSigns::of(text.as_bytes()), expected, "{text:?}");
        }
    }
}
