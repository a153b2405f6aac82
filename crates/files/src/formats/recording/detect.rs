//! Detects the format of a recording from its content.
//!
//! The tests go from the most to the least distinctive: magic bytes first, then JSON, then words that only one vendor
//! writes, then ROS, then a table. A `.csv` of XSENSOR or Tekscan would pass for a table, so it is tested before
//! that.

use std::io::{self, BufReader, Read, Seek, SeekFrom};

use crate::formats::file::without_mark;
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ReadOptions, RecordingSink, until_enough};
use crate::formats::recording::format::RecordingFormat;
use crate::formats::recording::json::lines as json_lines;
use crate::formats::recording::numpy::{archive, array};
use crate::formats::recording::ros::echo;
use crate::formats::recording::ros::mcap;
use crate::formats::recording::signs::{self, VendorSigns};
use crate::formats::recording::table::arrangement::EarlierLayout;
use crate::formats::recording::table::cell_names::is_first_cell;
use crate::formats::recording::table::delimited;
use crate::formats::recording::text::lines::is_blank;
use crate::formats::recording::text::row::is_parted_by_cr;
use crate::formats::recording::text::separator::{Separator, is_comment};
use crate::formats::recording::time::moment;
use crate::formats::recording::vendor::{flexitac, tekscan, xsensor};

/// The number of bytes at the start of a file that decide its format.
pub(super) const LOOKED_AT: usize = 1 << 16;

/// The number of bytes read at a time.
const CHUNK: usize = 1 << 16;

/// Returns the format of a recording, from its first 64 KiB; None if it is not a recording. A text of numbers counts
/// as a table, except a single column without the name of a cell, since many other files are one.
pub fn recognised(start: &[u8]) -> Option<RecordingFormat> {
    recognised_with(start, ReadOptions::default())
}

/// Detects the format like [`recognised`]; if rows and columns are given, a single column of numbers counts as a
/// table, too.
fn recognised_with(start: &[u8], options: ReadOptions) -> Option<RecordingFormat> {
    let start = &start[..start.len().min(LOOKED_AT)];
    let text = without_mark(start);
    let trimmed = text.trim_ascii_start();
    let mut lines = trimmed.split(|&byte| byte == b'\n');
    let first = lines.clone().next().unwrap_or(b"");
    // Comments may stand above a table.
    let is_row = |line: &&[u8]| !is_blank(line) && !is_comment(line);
    let row = lines.find(is_row).unwrap_or(first);
    let known = signs::by_magic(start);
    if known.is_some() {
        return known;
    }
    if is_blank(trimmed) || start.contains(&0) {
        return None;
    }
    if trimmed.starts_with(b"{") {
        return Some(RecordingFormat::JsonLines);
    }
    if is_parted_by_cr(text) || trimmed.starts_with(b"<") || is_bitmap(text) {
        return None;
    }
    let known = VendorSigns::of(text);
    if known.is_some() {
        return known;
    }
    if is_ros(echo::without_notices(trimmed)) {
        return Some(RecordingFormat::Ros2);
    }
    // For rows without keys, or all objects in one list, the reader of JSON lines says what it expected.
    if is_list_of(trimmed, b'[') || is_list_of(trimmed, b'{') {
        return Some(RecordingFormat::JsonLines);
    }
    let is_table =
        is_table(row) || is_named_column(text) || options.size.is_some() && is_number(row);
    (is_table && !moment::is_alone(row)).then_some(RecordingFormat::Csv)
}

/// Returns the error for a file that is not a recording.
fn refused(start: &[u8]) -> RecordingError {
    match numbers_below_text(start) {
        _ if is_parted_by_cr(start) => RecordingError::Foreign {
            kind: "text whose lines end in CR alone (save it with LF or CR LF)",
        },
        _ if is_bitmap(start) => RecordingError::Foreign {
            kind: "a PBM image (taxel describe reads it)",
        },
        _ if start.is_empty() => RecordingError::damaged("empty, expected a recording"),
        _ if is_imprint(start) => RecordingError::Foreign {
            kind: "an imprint as text (taxel describe reads it)",
        },
        _ if is_column(start) => RecordingError::Shape { values: 1 },
        Some(_) if begins_with_time(start) => RecordingError::in_line(1, moment::ABOVE_ROWS),
        Some(line) => RecordingError::in_line(
            1,
            format!(
                "found text, expected a table; numbers begin in line {line}: delete the lines above, or read the file \
                 with taxel watch --once"
            ),
        ),
        None => RecordingError::Unknown,
    }
}

/// Returns the number of the first of two successive lines of numbers; the text above them may be what a board sent
/// at its start.
fn numbers_below_text(text: &[u8]) -> Option<u64> {
    let is_row = |line: &[u8]| {
        let separator = Separator::of(line);
        let (mut fields, mut numbers) = (0, 0);
        for field in separator.fields(line) {
            fields += 1;
            numbers += usize::from(separator.is_numeric(field));
        }
        fields > 1 && fields == numbers
    };
    if text.contains(&0) {
        return None;
    }
    let lines = (1..).zip(text.split(|&byte| byte == b'\n'));
    let mut rows = lines
        .filter(|(_, line)| !is_blank(line))
        .map(|(number, line)| (number, is_row(line)));
    let mut before = rows.next()?;
    rows.find_map(|own| {
        let before = std::mem::replace(&mut before, own);
        (before.1 && own.1).then_some(before.0)
    })
}

/// Returns true if a file is a black-and-white or grey image of netpbm.
pub(super) fn is_bitmap(start: &[u8]) -> bool {
    matches!(start, [b'P', b'1' | b'4', blank, ..] if blank.is_ascii_whitespace())
}

/// Returns true if a text consists of the taxels of an imprint.
fn is_imprint(text: &[u8]) -> bool {
    let text = without_mark(text).trim_ascii();
    let is_taxel = |byte: &u8| b"#.\r\n".contains(byte);
    !text.is_empty() && text.iter().all(is_taxel)
}

/// Returns true if a text consists of numbers, one per line.
fn is_column(text: &[u8]) -> bool {
    let mut rows = rows_of(text).peekable();
    rows.peek().is_some() && rows.all(is_number)
}

/// Returns true if a line is a single number, or a word for a cell without a value.
fn is_number(line: &[u8]) -> bool {
    Separator::of(line) == Separator::Spaces && Separator::Spaces.is_numeric(line.trim_ascii())
}

/// Returns true if a text begins with the name of the only cell of a sensor, and a number below it.
fn is_named_column(text: &[u8]) -> bool {
    let is_word = |&byte: &u8| byte.is_ascii_alphanumeric() || b"_[]".contains(&byte);
    let is_cell_name =
        |name: &[u8]| name.iter().all(is_word) && str::from_utf8(name).is_ok_and(is_first_cell);
    let mut rows = rows_of(text);
    rows.next()
        .is_some_and(|row| is_cell_name(row.trim_ascii()))
        && rows.next().is_some_and(is_number)
}

/// Iterates over the lines of a text that are neither empty nor comments.
fn rows_of(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let lines = without_mark(text).split(|&byte| byte == b'\n');
    lines.filter(|line| !is_blank(line) && !is_comment(line))
}

/// Returns true if the first line of a text is a timestamp or a single number, which may be one.
fn begins_with_time(text: &[u8]) -> bool {
    let first = without_mark(text).split(|&byte| byte == b'\n').next();
    first.is_some_and(|first| is_number(first) || moment::is_alone(first))
}

/// Returns true if a text is a JSON list whose first element begins with this byte.
fn is_list_of(text: &[u8], first: u8) -> bool {
    let inside = text.strip_prefix(b"[").map(<[u8]>::trim_ascii_start);
    inside.is_some_and(|inside| inside.first() == Some(&first))
}

/// Returns true if a text is the output of `ros2 topic echo`.
fn is_ros(text: &[u8]) -> bool {
    let first = text.split(|&byte| byte == b'\n').next().unwrap_or(b"");
    echo::begins_message(first)
        || first.starts_with(b"[") && text.windows(4).any(|word| word == b"\n---")
}

/// Returns true if a line may be the first of a table: it has several fields and a digit. A line of words alone may
/// be the names of columns, if they are separated by commas or semicolons.
fn is_table(line: &[u8]) -> bool {
    let is_text = line
        .iter()
        .all(|&byte| byte >= b' ' || byte == b'\t' || byte == b'\r');
    let has_digit = line.iter().any(u8::is_ascii_digit);
    let has_mark = line.trim_ascii().iter().any(|byte| b",;\t ".contains(byte));
    is_text && has_mark && (has_digit || line.contains(&b',') || line.contains(&b';'))
}

/// Returns true if bytes that are neither an imprint nor a shape look like a recording, for the message about them.
/// JSON must contain a frame for this: most JSON is a stored shape with a mistake.
pub fn may_be_recording(bytes: &[u8]) -> bool {
    // PBM files have messages of their own.
    if matches!(bytes, [b'P', b'1' | b'4', ..]) {
        return false;
    }
    match recognised(bytes) {
        Some(RecordingFormat::JsonLines) => signs::names_frame(bytes),
        found => found.is_some(),
    }
}

/// Returns the format of a recording, reading the input from its current position.
///
/// # Errors
/// Returns [`RecordingError::Foreign`] for a file of another kind, [`RecordingError::Shape`] for a column of numbers
/// that may be a recording, [`RecordingError::Unknown`] for anything else that is not one, and the system's error if
/// the input cannot be read.
pub fn format_of(
    input: impl Read,
    options: ReadOptions,
) -> Result<RecordingFormat, RecordingError> {
    let start = start_of(input)?;
    recognised_with(&start, options).ok_or_else(|| refused(&start))
}

/// Returns the format of a followed file after it was truncated or replaced, reading the input from its current
/// position; before that, it had the format `before`. None if too little has been written yet.
///
/// The same program may go on in the middle of a frame, behind zero bytes, or with a message; a torn line of JSON may
/// look like a table. So the format changes only if the content is clearly another recording.
///
/// # Errors
/// Returns the system's error if the input cannot be read.
#[cfg(unix)]
pub fn format_after(
    input: impl Read,
    before: RecordingFormat,
) -> io::Result<Option<RecordingFormat>> {
    let start = start_of(input)?;
    // The text after the last of them has no end yet.
    let lines = start.split(|&byte| byte == b'\n').skip(1).count();
    Ok(match recognised(&start) {
        Some(own) if own == before || !own.is_text_stream() => Some(own),
        _ if may_hold_frame(&start, before) => Some(before),
        Some(own) => (lines > 1).then_some(own),
        None => (lines > 0 || start.len() == LOOKED_AT).then_some(before),
    })
}

/// Returns true if a frame in this format may begin somewhere in the content. Almost any text may hold a frame of a
/// table, so that is not asked.
#[cfg(unix)]
fn may_hold_frame(content: &[u8], format: RecordingFormat) -> bool {
    let mut lines = content.split(|&byte| byte == b'\n');
    match format {
        RecordingFormat::JsonLines => lines.any(|line| line.starts_with(b"{")),
        RecordingFormat::Ros2 => lines.any(|line| line == b"---" || echo::begins_message(line)),
        RecordingFormat::Flexitac => content.windows(2).any(|pair| pair == [0xaa, 0x55]),
        _ => false,
    }
}

fn start_of(input: impl Read) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    input.take(LOOKED_AT as u64).read_to_end(&mut start)?;
    Ok(start)
}

/// Reads a recording from beginning to end, and reports its events to `consumer`, which may end the reading.
///
/// # Errors
/// Returns an error if the input cannot be read, is not a recording, is damaged, or does not say how its values are
/// arranged. Whole frames before the damage have been reported.
pub fn read(
    mut input: impl Read + Seek,
    options: ReadOptions,
    consumer: &mut RecordingSink<'_>,
) -> Result<RecordingFormat, RecordingError> {
    input.seek(SeekFrom::Start(0))?;
    let format = format_of(&mut input, options)?;
    let mut earlier = EarlierLayout::default();
    read_as(format, &mut input, options, &mut earlier, consumer)?;
    Ok(format)
}

/// The input of a recording. It is read in large pieces through a `dyn` reference, so the readers are compiled only
/// once.
pub trait RecordingInput: Read + Seek {}

impl<T: Read + Seek> RecordingInput for T {}

/// Reads a recording whose format is known, like [`read`]. In a followed file, `earlier` is the arrangement of the
/// table that it held before, and is replaced by the present one.
pub fn read_as(
    format: RecordingFormat,
    input: &mut dyn RecordingInput,
    options: ReadOptions,
    earlier: &mut EarlierLayout,
    consumer: &mut RecordingSink<'_>,
) -> Result<(), RecordingError> {
    input.seek(SeekFrom::Start(0))?;
    let mut input = BufReader::with_capacity(CHUNK, input);
    until_enough(consumer, |sink| match format {
        RecordingFormat::Tekscan => tekscan::read(input, sink),
        RecordingFormat::Xsensor => xsensor::read(input, sink),
        RecordingFormat::Npy => array::read(&mut input, options, sink),
        RecordingFormat::Npz => archive::read(input, options, sink),
        RecordingFormat::JsonLines => json_lines::read(input, options, sink),
        RecordingFormat::Ros2 => echo::read(input, options, sink),
        RecordingFormat::Csv => delimited::read(input, options, earlier, sink),
        RecordingFormat::Flexitac => flexitac::read(&mut input, options, sink),
        RecordingFormat::Mcap => mcap::read(&mut input, options, sink),
    })
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Write};
    use std::ops::ControlFlow;

    use super::*;

    fn error_of(bytes: &[u8]) -> String {
        let read = read(Cursor::new(bytes), ReadOptions::default(), &mut |_| {
            ControlFlow::Continue(())
        });
        read.expect_err("no recording").to_string()
    }

    #[test]
    fn a_file_of_another_kind_is_refused_by_name() {
        let mut workbook = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = zip::write::SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Stored);
        workbook
            .start_file("[Content_Types].xml", options)
            .expect("begun");
        workbook.write_all(b"<Types/>").expect("written");
        let workbook = workbook.finish().expect("finished").into_inner();
        let rows = "1,2\r3,4\r\r5,6\r7,8\r";
        for (bytes, kind) in [
            (
                rows.into(),
                "text whose lines end in CR alone (save it with LF or CR LF)",
            ),
            (
                workbook,
                "a spreadsheet or another office document (save the sheet as CSV)",
            ),
        ] {
            let told = error_of(&bytes);
            assert!(
                told.starts_with(&format!("{kind}, expected Tekscan")),
                "{told}"
            );
        }
        assert!(error_of(b"words").starts_with("not a recording"));
        assert!(error_of(b"P1\n2 2\n1 0\n0 1\n").starts_with("a PBM image"));
        let empty = error_of(b"{\"frame\":[]}\n");
        assert!(
            empty.ends_with("\"frame\" is empty, expected rows of values"),
            "{empty}"
        );
        assert!(error_of(b"words\n1 2\nwords\n").starts_with("not a recording"));
        let log = b"ready\r\n\r\n1 2\r\n3 1\r\n\r\n1 2\r\n3 2\r\n\r\n";
        let expected = "line 1: found text, expected a table; numbers begin in line 3: delete the lines above, or read the \
                        file with taxel watch --once";
        assert_eq!(error_of(log), expected);
        for time in [
            "0.1",
            "1700000000.25",
            "12:00:00.25",
            "2024-05-01 12:00:00.25",
        ] {
            for row in ["1 2", "1,2", "1\t2"] {
                let text = format!("{time}\r\n{row}\r\n{row}\r\n\r\n{time}\r\n{row}\r\n{row}\r\n");
                let expected = "line 1: found one value above rows of numbers; if it is the time of a frame, begin such lines \
                                with #";
                assert_eq!(error_of(text.as_bytes()), expected, "{text}");
            }
        }
        assert_eq!(
            recognised(b"2024-05-01 12:00:00.25 7\n"),
            Some(RecordingFormat::Csv)
        );
        // A growing file may have been read up to the CR of a line.
        assert_eq!(recognised(b"1,2\r"), Some(RecordingFormat::Csv));
    }
}
