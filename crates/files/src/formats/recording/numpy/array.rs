//! Frames as a numpy array: frames × rows × columns, rows × columns, frames × cells, or taxel's own records.
//!
//! The type may be any real number in either byte order, the order that of C or Fortran. NaN means that there is no
//! cell. For the source, see [`crate::formats::npy`].
//!
//! | shape | means |
//! |---|---|
//! | (frames, rows, columns), also with an axis of length 1 after the first or at the end | frames |
//! | (rows, columns) | one frame; or frames × cells if rows and columns are known beforehand and fit the second |
//! | (cells) | one frame, if rows and columns are known beforehand |
//! | (records) of `time`, `number`, `values` | what `taxel watch --write` writes |
//!
//! An array of records may end anywhere, since the file of a killed program is not complete: whole records count, and
//! a note reports when the header counts more. A file of any other array must have exactly the bytes that its header
//! requires.

use crate::formats::recording::error::unshaped;
use std::io::{ErrorKind, Read};

use taxel_core::frame::{Frame, FrameSize, LARGEST_VALUE};
use taxel_core::parameter::number::counted;
use taxel_core::quote::shortened;
use taxel_core::sensor::MAX_SIDE;

use crate::error::ReadError;
use crate::formats::job::too_large;
use crate::formats::npy::{self, Header, NumberType};
use crate::formats::recording::event::{
    ChannelInfo, ReadOptions, RecordingEvent, RecordingNote, Sink, Stop,
};
use crate::formats::recording::size::frame_size;
use crate::formats::seconds::since;

/// The most bytes of a header.
const LONGEST_HEADER: usize = 1 << 20;

/// The size limit of an array in Fortran order, 256 MiB: it is read as a whole, since the values of a frame are
/// spread over the file.
const LARGEST_FORTRAN: u64 = 1 << 28;

pub(super) fn header(input: &mut impl Read) -> Result<Header, ReadError> {
    let wrong = || ReadError::new("not a numpy array: expected a header of version 1 to 3");
    let mut start = [0; 8];
    let mut whole = |bytes: &mut [u8]| match input.read_exact(bytes) {
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Err(wrong()),
        read => read.map_err(ReadError::from),
    };
    whole(&mut start)?;
    let mut bytes = start.to_vec();
    let mut length = vec![0; if start[6] == 1 { 2 } else { 4 }];
    whole(&mut length)?;
    bytes.extend(&length);
    let length = length
        .iter()
        .rev()
        .fold(0, |sum, byte| sum << 8 | usize::from(*byte));
    if length > LONGEST_HEADER {
        return Err(wrong());
    }
    let mut text = vec![0; length];
    whole(&mut text)?;
    bytes.extend(text);
    npy::parse(&bytes)
        .map(|(header, _)| header)
        .ok_or_else(wrong)
}

#[derive(Debug)]
pub(super) struct ArrayLayout {
    number: NumberType,
    frames: u64,
    size: FrameSize,
    /// Whether the first axis varies fastest, as in Fortran.
    fortran: bool,
    is_flat: bool,
    record: Option<RecordLayout>,
    note: Option<RecordingNote>,
}

impl ArrayLayout {
    pub(super) fn of(header: &Header, options: &ReadOptions) -> Result<Self, ReadError> {
        if header.code.starts_with('[') {
            return Self::of_records(header);
        }
        let number = NumberType::of(&header.code).ok_or_else(|| {
            let found = shortened(&header.code);
            ReadError::new(format!("numbers of type {found:?}, expected real ones"))
        })?;
        let (frames, size) = frames_of_axes(&header.shape, options)?;
        let (rows, columns) = (size.rows(), size.columns());
        // Few sensors are that large, so a row may well be a frame.
        let is_large = rows.max(columns) > MAX_SIDE.into();
        let is_assumed = header.shape.len() == 2 && options.size.is_none();
        let note = (is_assumed && is_large).then_some(RecordingNote::Flat { rows, columns });
        Ok(Self {
            note,
            number,
            frames,
            size,
            fortran: header.fortran_order && header.shape.len() > 1,
            is_flat: matches!(header.shape[..], [_, cells] if cells == size.cells() as u64),
            record: None,
        })
    }

    fn of_records(header: &Header) -> Result<Self, ReadError> {
        let (Some(mut record), &[counted]) = (RecordLayout::of(&header.code), &header.shape[..])
        else {
            let message = "records other than taxel writes, expected time, number and values";
            return Err(ReadError::new(message));
        };
        record.counted = counted;
        Ok(Self {
            number: record.number,
            // A recording that was cut off may have more frames than its header counts.
            frames: u64::MAX,
            size: record.frame,
            fortran: false,
            is_flat: false,
            record: Some(record),
            note: None,
        })
    }

    /// Returns the assumption that was made about the array, if any.
    pub(super) fn note(&self) -> Option<&RecordingNote> {
        self.note.as_ref()
    }

    pub(super) fn frames(&self) -> u64 {
        self.frames
    }

    pub(super) fn size(&self) -> FrameSize {
        self.size
    }
}

fn frames_of_axes(axes: &[u64], options: &ReadOptions) -> Result<(u64, FrameSize), ReadError> {
    let asked = options.size;
    let cells = asked.map(|size| size.cells() as u64);
    let found = match *axes {
        // An axis of one channel, as frameworks for images and machine learning have it.
        [frames, rows, columns] | [frames, rows, columns, 1] | [frames, 1, rows, columns] => {
            frame_size(columns, rows).map(|size| (frames, size))
        }
        [rows, columns] => match (asked, frame_size(columns, rows)) {
            (Some(asked), Some(own)) if asked == own => Some((1, own)),
            (Some(asked), _) if cells == Some(columns) => Some((rows, asked)),
            (None, Some(own)) => Some((1, own)),
            (None, None) => return Err(unshaped(columns, None)),
            _ => None,
        },
        [length] if cells == Some(length) => asked.map(|asked| (1, asked)),
        [length] if cells.is_none() => return Err(unshaped(length, None)),
        _ => None,
    };
    let found = found.filter(|&(_, size)| asked.is_none_or(|asked| asked == size));
    found.ok_or_else(|| {
        let axes: Vec<String> = axes.iter().take(8).map(ToString::to_string).collect();
        let asked = asked.map_or(String::new(), |asked| {
            format!(", and {} were named", asked.in_words())
        });
        ReadError::new(format!(
            "an array of shape ({}), expected frames, rows and columns, at most 512 rows and columns{asked}",
            axes.join(", ")
        ))
    })
}

#[derive(Debug)]
struct RecordLayout {
    /// The number of records according to the header. The file of a killed program may have more.
    counted: u64,
    size: usize,
    time: Option<(usize, NumberType)>,
    label: Option<(usize, NumberType)>,
    values: usize,
    number: NumberType,
    frame: FrameSize,
}

impl RecordLayout {
    /// Parses a type such as `[('time', '<f8'), ('number', '<u8'), ('values', '<f8', (28, 28))]`.
    fn of(code: &str) -> Option<Self> {
        let mut rest = code.strip_prefix('[')?.strip_suffix(']')?.trim();
        let (mut size, mut time, mut label, mut values) = (0_usize, None, None, None);
        while let Some(field) = rest.strip_prefix('(') {
            let mut words = field.splitn(5, '\'');
            let (_, name, _, kind, after) = (
                words.next()?,
                words.next()?,
                words.next()?,
                words.next()?,
                words.next()?,
            );
            let number = NumberType::of(kind)?;
            let after = after.trim_start().trim_start_matches(',').trim_start();
            let (sides, after) = match after.strip_prefix('(') {
                Some(sides) => {
                    let (sides, after) = sides.split_once(')')?;
                    let sides = sides
                        .split(',')
                        .map(str::trim)
                        .filter(|side| !side.is_empty());
                    let sides: Option<Vec<u16>> = sides.map(|side| side.parse().ok()).collect();
                    (sides?, after)
                }
                None => (Vec::new(), after),
            };
            let count = sides.iter().try_fold(1_usize, |product, side| {
                product.checked_mul(usize::from(*side))
            })?;
            match (name, &sides[..]) {
                ("time", []) => time = Some((size, number)),
                ("number", []) => label = Some((size, number)),
                ("values", &[rows, columns]) => values = Some((size, number, rows, columns)),
                _ => {}
            }
            size = size.checked_add(count.checked_mul(number.size())?)?;
            let after = after.trim_start().strip_prefix(')')?.trim_start();
            rest = after.strip_prefix(',').unwrap_or(after).trim_start();
        }
        let (values, number, rows, columns) = values?;
        let frame = frame_size(columns, rows)?;
        (rest.is_empty() && size < 1 << 24).then_some(Self {
            counted: 0,
            size,
            time,
            label,
            values,
            number,
            frame,
        })
    }
}

pub(in crate::formats::recording) fn read(
    input: &mut impl Read,
    options: &ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let layout = ArrayLayout::of(&header(input)?, options)?;
    let info = ChannelInfo {
        size: Some(layout.size()),
        ..ChannelInfo::default()
    };
    sink.event(RecordingEvent::Channel(&info))?;
    if let Some(note) = layout.note() {
        sink.event(RecordingEvent::Note(note))?;
    }
    frames(input, &layout, 0, &[], sink)?;
    if layout.record.is_none() {
        end(input, &layout)?;
    }
    Ok(())
}

/// Reads the end of an array after its frames. For an entry of an archive, only this verifies the checksum.
pub(super) fn end(input: &mut impl Read, layout: &ArrayLayout) -> Result<(), ReadError> {
    if fill(input, &mut [0])? > 0 {
        let frames = counted(layout.frames, "frame");
        let message = format!("more bytes than the header states for {frames}");
        return Err(ReadError::new(message));
    }
    Ok(())
}

/// Returns the time of a frame, if it has one.
fn time(times: &[f64], number: usize) -> Option<f64> {
    times.get(number).copied().filter(|time| time.is_finite())
}

/// Reads all frames of an array. `times` are in seconds, one per frame and NaN for missing ones, or empty.
pub(super) fn frames(
    input: &mut impl Read,
    layout: &ArrayLayout,
    channel: usize,
    times: &[f64],
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let mut frame = Frame::new(layout.size);
    frame.channel = channel;
    if layout.fortran {
        return fortran(input, layout, frame, times, sink);
    }
    let cells = layout.size.cells() * layout.number.size();
    let size = layout.record.as_ref().map_or(cells, |record| record.size);
    let mut bytes = vec![0; size];
    let mut start = None;
    while frame.number < layout.frames {
        let length = fill(input, &mut bytes)?;
        if length < size {
            let Some(record) = &layout.record else {
                return Err(short(frame.number, layout.frames).into());
            };
            // A recording that is being written, or that was cut off, may end anywhere.
            let (records, counted) = (frame.number, record.counted);
            if records < counted {
                let note = RecordingNote::Cut { records, counted };
                sink.event(RecordingEvent::Note(&note))?;
            }
            return Ok(());
        }
        let values = layout.record.as_ref().map_or(0, |record| record.values);
        let values = &bytes[values..values + cells];
        let slots = frame.values_mut().iter_mut();
        for (slot, value) in slots.zip(layout.number.values(values)) {
            *slot = value;
        }
        frame.time = usize::try_from(frame.number)
            .ok()
            .and_then(|number| time(times, number));
        if let Some(record) = &layout.record {
            let (time, label) = moment(record, &bytes, &mut start);
            (frame.time, frame.label) = (time, label.map(Into::into));
        }
        give(&frame, sink)?;
        frame.number += 1;
    }
    Ok(())
}

/// Returns the time of a record, in seconds since the first record, and its label.
fn moment(
    record: &RecordLayout,
    bytes: &[u8],
    start: &mut Option<f64>,
) -> (Option<f64>, Option<i64>) {
    let time = record
        .time
        .map(|(at, number)| number.value(&bytes[at..at + number.size()]));
    let time = time.filter(|time| time.is_finite());
    let time = time.map(|time| since(*start.get_or_insert(time), time));
    let label = record
        .label
        .and_then(|(at, number)| number.whole(&bytes[at..at + number.size()]));
    (time, label.and_then(|label| i64::try_from(label).ok()))
}

fn short(frame: u64, frames: u64) -> ReadError {
    let frames = counted(frames, "frame");
    ReadError::new(format!(
        "the file ends inside frame {frame}, expected {frames}"
    ))
}

/// Reports a frame if all its values are finite or NaN.
fn give(frame: &Frame, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let wrong = frame
        .values()
        .iter()
        .position(|value| value.abs() > LARGEST_VALUE);
    if let Some(index) = wrong {
        let columns = usize::from(frame.columns());
        let (number, row, column) = (frame.number, index / columns, index % columns);
        let found = too_large(frame.values()[index]);
        let message = format!(
            "frame {number}, row {row}, column {column}: {found}, or NaN where there is no cell"
        );
        return Err(ReadError::new(message).into());
    }
    sink.event(RecordingEvent::Frame(frame))
}

/// Fills the bytes as far as the input reaches; returns the number of bytes read.
pub(super) fn fill(input: &mut impl Read, bytes: &mut [u8]) -> Result<usize, ReadError> {
    let mut length = 0;
    while length < bytes.len() {
        match input.read(&mut bytes[length..]) {
            Ok(0) => break,
            Ok(count) => length += count,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error.into()),
        }
    }
    Ok(length)
}

/// Reads all frames of an array whose first axis varies fastest, like [`frames`].
fn fortran(
    input: &mut impl Read,
    layout: &ArrayLayout,
    mut frame: Frame,
    times: &[f64],
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let size = layout.number.size();
    let frame_bytes = layout.size.cells() * size;
    let expected = (frame_bytes as u64).checked_mul(layout.frames);
    let Some(expected) = expected.filter(|&bytes| bytes <= LARGEST_FORTRAN) else {
        let message =
            "an array of more than 256 MiB in Fortran order: save numpy.ascontiguousarray of it";
        return Err(ReadError::new(message).into());
    };
    let mut bytes = Vec::new();
    input.by_ref().take(expected).read_to_end(&mut bytes)?;
    if (bytes.len() as u64) < expected {
        return Err(short(0, layout.frames).into());
    }
    let [rows, columns] = [layout.size.rows(), layout.size.columns()].map(usize::from);
    let frames = bytes.len() / frame_bytes;
    for number in 0..frames {
        for row in 0..rows {
            for column in 0..columns {
                let cell = if layout.is_flat {
                    row * columns + column
                } else {
                    row + rows * column
                };
                let index = (number + frames * cell) * size;
                let value = layout.number.value(&bytes[index..index + size]);
                frame.values_mut()[row * columns + column] = value;
            }
        }
        frame.time = time(times, number);
        give(&frame, sink)?;
        frame.number += 1;
    }
    Ok(())
}
