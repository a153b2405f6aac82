//! Frames as a numpy array, or as an archive of such arrays.
//!
//! The type may be any real number in either byte order, the order that of C or Fortran. NaN means that there is no
//! cell.
//!
//! | shape | means |
//! |---|---|
//! | (frames, rows, columns), also with an axis of length 1 after the first or at the end | frames |
//! | (rows, columns) | one frame; or frames × cells if rows and columns are known beforehand and fit the second |
//! | (cells) | one frame, if rows and columns are known beforehand |
//! | (records) | a frame a record: fields of two axes are channels, or fields of a number each are its cells; others its time and label |
//!
//! Of an archive, each array of two or three axes is a channel, and an array of one axis named `t…` or `time…` gives the
//! times of the channels with as many frames. Times are in the unit of their name (`time_ms`) or of their type (datetime64
//! and timedelta64 of numpy), else in seconds, and count from the first one. Whole nanoseconds since 1970 keep all their
//! digits.
//!
//! A file must have exactly the bytes that its header requires. Only taxel's own recordings, records of `time`, `number`
//! and `values`, may end anywhere, since the file of a killed program is not complete: whole records count.

use std::cmp::Reverse;
use std::io::{Read, Seek};

use taxel_core::frame::{Frame, FrameSize, LARGEST_VALUE, Label};
use taxel_core::index::index;
use taxel_core::parameter::number::counted;
use taxel_core::quote::shortened;
use zip::ZipArchive;

use crate::error::ReadError;
use crate::formats::job::too_large;
use crate::formats::numpy::archive::{in_array, refused};
use crate::formats::numpy::{Elements, Field, Header, Number};
use crate::formats::recording::error::{foreign, unshaped};
use crate::formats::recording::event::{ChannelInfo, RecordingNote, Sink, Stop};
use crate::formats::recording::size::frame_size;
use crate::formats::recording::table::is_label;
use crate::formats::recording::time::{FrameClock, Time, TimeUnit, time_name};

/// The size limit of an array in Fortran order, 256 MiB: it is read as a whole, since the values of a frame are
/// spread over the file.
const LARGEST_FORTRAN: usize = 1 << 28;

/// The size limit of a record in bytes; it may have frames of several channels.
const LARGEST_RECORD: usize = 1 << 26;

/// The most frames of an archive of which times are read: 256 MiB of them.
const MOST_TIMES: u64 = 1 << 24;

/// The most arrays in an archive.
const MOST_ARRAYS: usize = 256;

/// The arrangement of the frames in an array.
#[derive(Default)]
struct Layout {
    frames: u64,
    /// The number of bytes of a record: of a frame, or of a frame of each channel and what is beside them.
    record: usize,
    channels: Vec<Cells>,
    time: Option<(usize, TimeType)>,
    label: Option<(usize, Number)>,
    /// The number of records that the header of taxel's own recordings counts; there may be more or fewer.
    own: Option<u64>,
}

/// The cells of a channel: where in a record the value of each is.
struct Cells {
    name: Option<String>,
    size: FrameSize,
    places: Vec<(usize, Number)>,
}

impl Layout {
    fn of(header: &Header, asked: Option<FrameSize>) -> Result<Self, ReadError> {
        let shape = header.shape_in_words();
        let names = ["time", "number", "values"];
        let is_own = matches!(&header.descr, Elements::Record(fields) if fields.iter().map(|field| &*field.name).eq(names));
        if header.shape.contains(&0) && !is_own {
            let message = format!("an empty array of shape {shape}, expected frames");
            return Err(ReadError::new(message));
        }
        let (counted, fields) = match &header.descr {
            Elements::Record(fields) => (header.shape.iter().product(), fields.clone()),
            Elements::Code(code) => {
                let (frames, size) = frames_of_axes(header, asked)?;
                let sides = [size.rows(), size.columns()].map(u64::from).to_vec();
                let (name, code) = (String::new(), code.clone());
                (frames, vec![Field { name, code, sides }])
            }
        };
        let mut layout = Self {
            frames: if is_own { u64::MAX } else { counted },
            own: Some(counted).filter(|_| is_own),
            ..Self::default()
        };
        let mut others = Vec::new();
        for field in &fields {
            others.extend(layout.add(field)?);
        }
        if layout.channels.is_empty() {
            let size = asked.filter(|size| size.cells() == others.len());
            let size = size.ok_or_else(|| unshaped(others.len() as u64, asked))?;
            let (name, places) = (None, others);
            layout.channels.push(Cells { name, size, places });
        }
        Ok(layout)
    }

    /// Adds a field: the cells of a channel, the time or the label. Returns any other number, which may be a cell.
    fn add(&mut self, field: &Field) -> Result<Option<(usize, Number)>, ReadError> {
        let (name, start) = (shortened(&field.name), self.record);
        let (number, code) = (Number::of(&field.code), shortened(&field.code));
        let not_real = || ReadError::new(format!("numbers of type {code:?}, expected real ones"));
        let end = field.bytes().and_then(|bytes| start.checked_add(bytes));
        let end = end.filter(|&end| end <= LARGEST_RECORD);
        self.record = end.ok_or_else(not_real)?;
        match (&field.sides[..], number) {
            ([], _) if self.time.is_none() && time_name(&field.name).is_some() => {
                // Taxel writes seconds.
                let seconds = self.own.map(|_| TimeUnit::Seconds);
                let unit = seconds.or(time_name(&field.name).flatten());
                let expected = "expected numbers, or datetime64 in s, ms, us or ns";
                let message = || format!("{name}: times of type {code:?}, {expected}");
                let time = TimeType::of(&field.code, unit);
                self.time = Some((start, time.ok_or_else(|| ReadError::new(message()))?));
            }
            ([], Some(number)) if field.name == "number" || is_label(&field.name) => {
                self.label = Some((start, number));
            }
            ([], _) => return Ok(number.map(|number| (start, number))),
            (&[rows, columns], _) => {
                let number = number.ok_or_else(not_real)?;
                let size = frame_size(columns, rows).ok_or_else(|| {
                    let expected = "expected 1 to 512 rows and columns";
                    ReadError::new(format!("{name}: {rows} × {columns} values, {expected}"))
                })?;
                let place = |cell| (start + cell * number.size(), number);
                let places = (0..size.cells()).map(place).collect();
                let is_named = self.own.is_none() && !name.is_empty();
                let name = is_named.then(|| field.name.clone());
                self.channels.push(Cells { name, size, places });
            }
            _ => {}
        }
        Ok(None)
    }
}

/// The number and the size of the frames in an array of numbers.
fn frames_of_axes(
    header: &Header,
    asked: Option<FrameSize>,
) -> Result<(u64, FrameSize), ReadError> {
    let cells = asked.map(|size| size.cells() as u64);
    let found = match header.shape[..] {
        // An axis of one channel, as frameworks for images and machine learning have it.
        [frames, rows, columns] | [frames, rows, columns, 1] | [frames, 1, rows, columns] => {
            frame_size(columns, rows).map(|size| (frames, size))
        }
        [frames, values] if cells == Some(values) => asked.map(|asked| (frames, asked)),
        [values] if cells == Some(values) => asked.map(|asked| (1, asked)),
        [rows, columns] if frame_size(columns, rows).is_some() => {
            frame_size(columns, rows).map(|size| (1, size))
        }
        [values] | [_, values] if cells.is_none() => return Err(unshaped(values, None)),
        _ => None,
    };
    let found = found.filter(|&(_, size)| asked.is_none_or(|asked| asked == size));
    found.ok_or_else(|| {
        let (shape, expected) = (header.shape_in_words(), "expected frames, rows and columns");
        let asked = asked.map(|asked| format!(", and {} were named", asked.in_words()));
        let asked = asked.unwrap_or_default();
        let most = "at most 512 rows and columns";
        ReadError::new(format!(
            "an array of shape {shape}, {expected}, {most}{asked}"
        ))
    })
}

/// Reads the numbers of an array in Fortran order, in which the first axis is the fastest, and returns them in that of
/// C.
fn in_order_of_c(header: &Header, input: &mut dyn Read) -> Result<Vec<u8>, ReadError> {
    let size = header.number().map_or(1, Number::size);
    let sides = header.shape.iter().map(|&side| index(side));
    let length = sides.fold(size, usize::saturating_mul);
    if length > LARGEST_FORTRAN {
        let message =
            "an array of more than 256 MiB in Fortran order: save numpy.ascontiguousarray of it";
        return Err(ReadError::new(message));
    }
    let mut bytes = Vec::new();
    input.take(length as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() != length {
        let message = format!("{} bytes of numbers, expected {length}", bytes.len());
        return Err(ReadError::new(message));
    }
    Ok(header.in_order_of_c(&bytes))
}

/// The type of times in a field or an array.
struct TimeType {
    number: Number,
    unit: Option<TimeUnit>,
    /// Whether the smallest number means a missing time, as in numpy's own types for times.
    has_none: bool,
}

impl TimeType {
    /// The type of a code, for times whose name may have a unit. A code such as `<M8[ns]` or `<m8[ms]`, numpy's types
    /// for points in time and for durations, includes its unit.
    fn of(code: &str, unit: Option<TimeUnit>) -> Option<Self> {
        let Some((kind, word)) = code.split_once('[') else {
            let (number, has_none) = (Number::of(code)?, false);
            return Some(Self {
                number,
                unit,
                has_none,
            });
        };
        let order = kind
            .strip_suffix("M8")
            .or_else(|| kind.strip_suffix("m8"))?;
        Some(Self {
            number: Number::of(&format!("{order}i8"))?,
            unit: Some(TimeUnit::named(word.strip_suffix(']')?)?),
            has_none: true,
        })
    }

    /// The seconds from the first time to one; None if it is missing.
    fn seconds(&self, bytes: &[u8], clock: &mut FrameClock) -> Option<f64> {
        let (value, whole) = (self.number.value(bytes), self.number.whole(bytes));
        let is_none = self.has_none && whole == Some(i128::from(i64::MIN));
        if is_none || !value.is_finite() {
            return None;
        }
        let unit = clock.unit();
        Some(clock.since_first(match whole {
            Some(whole) => Time::of_whole(whole, unit),
            None => Time::Seconds(unit.seconds(value)),
        }))
    }
}

pub(super) fn read_array(input: &mut dyn Read, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let header = Header::read(input)?;
    let layout = Layout::of(&header, sink.options.size)?;
    let channels = report(&layout, None, sink)?;
    frames(input, &header, &layout, &channels, &[], sink)
}

/// Reports the channels of an array, and returns their numbers.
fn report(layout: &Layout, array: Option<&str>, sink: &mut Sink<'_>) -> Result<Vec<usize>, Stop> {
    let mut channels = Vec::new();
    for cells in &layout.channels {
        let name = array.or(cells.name.as_deref());
        channels.push(sink.channel(name, || ChannelInfo::of_size(cells.size))?);
    }
    Ok(channels)
}

/// Reads all frames of an array. `times` are in seconds, one a frame, or empty.
fn frames(
    input: &mut dyn Read,
    header: &Header,
    layout: &Layout,
    channels: &[usize],
    times: &[Option<f64>],
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let ordered = if header.fortran_order {
        in_order_of_c(header, input)?
    } else {
        Vec::new()
    };
    let mut input = ordered.as_slice().chain(input);
    let mut clock = FrameClock::default();
    clock.unit = layout.time.as_ref().and_then(|(_, time)| time.unit);
    let (mut frame, mut record) = (Frame::default(), Vec::new());
    for number in 0..layout.frames {
        record.clear();
        let length = layout.record as u64;
        input.by_ref().take(length).read_to_end(&mut record)?;
        if record.len() < layout.record {
            let (records, frames) = (number, layout.frames);
            match layout.own {
                Some(counted) if records < counted => {
                    let text = format!(
                        "the file was cut off: it has {records} of the {counted} frames that its header counts"
                    );
                    sink.note(&RecordingNote::Oddity(text))?;
                }
                Some(_) => {}
                None => {
                    let expected = counted(frames, "frame");
                    let message = format!("ends inside frame {number}, expected {expected}");
                    return Err(ReadError::new(message).into());
                }
            }
            return Ok(());
        }
        let bytes = |at: usize, number: Number| &record[at..at + number.size()];
        frame.time = match &layout.time {
            Some((at, time)) => time.seconds(bytes(*at, time.number), &mut clock),
            None => times.get(index(number)).copied().flatten(),
        };
        let label = layout.label;
        let label = label.and_then(|(at, number)| number.whole(bytes(at, number))?.try_into().ok());
        frame.label = label.map(Label::Number);
        for (&channel, cells) in channels.iter().zip(&layout.channels) {
            frame.reset(cells.size);
            let values = frame.values_mut().iter_mut().zip(&cells.places);
            for (cell, (slot, &(at, own))) in values.enumerate() {
                *slot = own.value(bytes(at, own));
                if slot.abs() > LARGEST_VALUE {
                    let columns = usize::from(cells.size.columns());
                    let (row, column, found) = (cell / columns, cell % columns, too_large(*slot));
                    let place = format!("frame {number}, row {row}, column {column}");
                    let message = format!("{place}: {found}, or NaN where there is no cell");
                    return Err(ReadError::new(message).into());
                }
            }
            sink.frame(channel, &mut frame)?;
        }
    }
    // For an array of an archive, only the attempt to read on verifies the checksum.
    if input.take(1).read_to_end(&mut record)? > 0 {
        let frames = counted(layout.frames, "frame");
        let message = format!("more bytes than the header states for {frames}");
        return Err(ReadError::new(message).into());
    }
    Ok(())
}

struct ArchiveArray {
    index: usize,
    /// The name without `.npy`.
    name: String,
    header: Header,
}

pub(super) fn read_archive(input: impl Read + Seek, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let archive = &mut ZipArchive::new(input).map_err(refused)?;
    let arrays = arrays(archive)?;
    let mut channels = Vec::new();
    for (array, layout) in self::channels(&arrays, sink.options.size)? {
        let numbers = report(&layout, Some(&array.name), sink)?;
        channels.push((array, layout, numbers));
    }
    for (array, layout, numbers) in &channels {
        let times = times(archive, &arrays, layout.frames)?;
        let file = &mut archive.by_index(array.index).map_err(refused)?;
        Header::read(file)?;
        let read = frames(file, &array.header, layout, numbers, &times, sink);
        read.map_err(|stop| match stop {
            Stop::Failed(error) => in_array(&array.name, error).into(),
            Stop::Enough => stop,
        })?;
    }
    Ok(())
}

/// All arrays with their headers. An atlas or a model is refused.
fn arrays<R: Read + Seek>(archive: &mut ZipArchive<R>) -> Result<Vec<ArchiveArray>, ReadError> {
    if archive.len() > MOST_ARRAYS {
        let message = format!("more than {MOST_ARRAYS} files in the archive");
        return Err(ReadError::new(message));
    }
    let mut arrays = Vec::new();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).map_err(refused)?;
        let name = file.name().map_err(refused)?.into_owned();
        // A spreadsheet is a zip archive, too.
        if matches!(&*name, "[Content_Types].xml" | "content.xml") {
            let kind = "a spreadsheet or another office document (save the sheet as CSV)";
            return Err(foreign(kind));
        }
        if let Some(name) = name.strip_suffix(".npy").map(str::to_owned) {
            let header = Header::read(&mut file).map_err(|error| in_array(&name, error))?;
            arrays.push(ArchiveArray {
                index,
                name,
                header,
            });
        }
    }
    if arrays
        .first()
        .is_some_and(|array| array.name == "header" && array.header.code() == "|u1")
    {
        return Err(foreign("an atlas or a model of taxel"));
    }
    Ok(arrays)
}

/// The arrays whose numbers can be frames. Others, such as a list of poses, may lie beside them.
fn channels(
    arrays: &[ArchiveArray],
    asked: Option<FrameSize>,
) -> Result<Vec<(&ArchiveArray, Layout)>, ReadError> {
    let may_be =
        |array: &&ArchiveArray| array.header.shape.len() > 1 && !array.header.code().is_empty();
    let arrays: Vec<_> = arrays.iter().filter(may_be).collect();
    let message = "no array of two or three axes, expected frames, rows and columns";
    let mut error = ReadError::new(message);
    let mut channels = Vec::new();
    for array in &arrays {
        let mut layout = Layout::of(&array.header, asked);
        // Rows and columns that are meant for one of several arrays need not fit the others.
        if layout.is_err() && arrays.len() > 1 {
            layout = Layout::of(&array.header, None);
        }
        match layout {
            Ok(layout) => channels.push((*array, layout)),
            Err(own) => error = own,
        }
    }
    if channels.is_empty() {
        return Err(error);
    }
    Ok(channels)
}

/// The times of as many frames, in seconds since the first one; empty if there are none.
fn times<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    arrays: &[ArchiveArray],
    frames: u64,
) -> Result<Vec<Option<f64>>, ReadError> {
    let fitting = arrays.iter().filter(|array| array.header.shape == [frames]);
    let named = fitting.filter_map(|array| match time_name(&array.name) {
        Some(unit) => Some((true, array, unit)),
        // `temperature` begins with a t, too, so a time has precedence.
        _ => array
            .name
            .starts_with(['t', 'T'])
            .then_some((false, array, None)),
    });
    let found = named.max_by_key(|(is_time, array, _)| (*is_time, Reverse(array.index)));
    let time =
        found.and_then(|(_, array, unit)| Some((array, TimeType::of(array.header.code(), unit)?)));
    let Some((array, time)) = time.filter(|_| frames <= MOST_TIMES) else {
        return Ok(Vec::new());
    };
    let mut file = archive.by_index(array.index).map_err(refused)?;
    let size = time.number.size();
    let expected = frames * size as u64;
    let mut bytes = Vec::new();
    Header::read(&mut file)
        .and_then(|_| Ok(file.take(expected + 1).read_to_end(&mut bytes)?))
        .map_err(|error| in_array(&array.name, error))?;
    if bytes.len() as u64 != expected {
        let message = format!("{}: expected {frames} times", array.name);
        return Err(ReadError::new(message));
    }
    let mut clock = FrameClock::default();
    clock.unit = time.unit;
    let times = bytes.chunks_exact(size);
    Ok(times.map(|bytes| time.seconds(bytes, &mut clock)).collect())
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Write};
    use std::ops::ControlFlow;

    use zip::write::SimpleFileOptions;

    use super::*;
    use crate::formats::numpy::header_of;
    use crate::formats::recording::{ReadOptions, RecordingEvent, read};

    fn array(code: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
        let text = format!("{{'descr': {code}, 'fortran_order': False, 'shape': ({shape}), }}");
        [&header_of(&text, 0), numbers].concat()
    }

    /// The times of the frames, the names of the channels and the notes.
    type Found = (Vec<Option<f64>>, Vec<Option<String>>, Vec<String>);

    fn found(file: &[u8], size: Option<FrameSize>) -> Result<Found, String> {
        let (mut times, mut names, mut notes) = (Vec::new(), Vec::new(), Vec::new());
        let options = ReadOptions {
            size,
            ..ReadOptions::default()
        };
        let read = read(Cursor::new(file), &options, &mut |event| {
            match event {
                RecordingEvent::Frame(frame) => times.push(frame.time),
                RecordingEvent::Channel(info) => names.push(info.name.clone()),
                RecordingEvent::Note(note) => notes.push(note.to_string()),
                RecordingEvent::Damage { .. } => {}
            }
            ControlFlow::Continue(())
        });
        read.map(|_| (times, names, notes))
            .map_err(|error| error.to_string())
    }

    /// The times and notes of two frames of two cells from each of two sensors, beside an array of that name and type
    /// with these numbers.
    fn times_of(name: &str, code: &str, times: [i64; 2]) -> (Vec<Option<f64>>, Vec<String>) {
        let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default();
        let mut add = |name: &str, array: &[u8]| {
            let file = format!("{name}.npy");
            archive.start_file(file, options).expect("begun");
            archive.write_all(array).expect("written");
        };
        for sensor in ["left", "right"] {
            add(sensor, &array("'|u1'", "2, 1, 2", &[1, 2, 3, 4]));
        }
        let numbers = times.map(i64::to_le_bytes).concat();
        add(name, &array(&format!("'{code}'"), "2,", &numbers));
        let archive = archive.finish().expect("finished").into_inner();
        let (times, _, notes) = found(&archive, None).expect("read");
        let (left, right) = times.split_at(2);
        assert_eq!(left, right);
        (left.to_vec(), notes)
    }

    #[test]
    fn times_have_the_unit_of_their_name_or_their_type() {
        let since_1970 = [1_714_564_800_123_456_789, 1_714_564_800_124_456_790];
        let both = |step| vec![Some(0.0), Some(step)];
        for (name, code, times, expected) in [
            ("time_ns", "<i8", since_1970, both(0.001_000_001)),
            ("time", "<M8[ns]", since_1970, both(0.001_000_001)),
            ("time", "<m8[ms]", [5, 55], both(0.05)),
            ("t_ms", "<i8", [5, 55], both(0.05)),
            ("time", "<i8", [5, 55], both(50.0)),
            // NaT, numpy's missing time.
            (
                "time",
                "<M8[ns]",
                [since_1970[0], i64::MIN],
                vec![Some(0.0), None],
            ),
            (
                "time",
                "<M8[ns]",
                [i64::MIN, since_1970[0]],
                vec![None, Some(0.0)],
            ),
            ("stamps", "<i8", [5, 55], vec![None; 2]),
        ] {
            assert_eq!(
                times_of(name, code, times),
                (expected, vec![]),
                "{name} {code}"
            );
        }
    }

    #[test]
    fn fields_of_records_are_times_and_cells() {
        let size = FrameSize::new(2, 1).ok();
        let record = |fields: &str, record: &[u8]| {
            found(
                &array(&format!("[{fields}]"), "2,", &record.repeat(2)),
                size,
            )
        };
        let stamps = "('time', '<M8[ms]'), ('left', '|u1', (1, 2)), ('right', '|u1', (1, 2))";
        let names = ["left", "right"].map(|name| Some(name.to_owned()));
        let found = record(stamps, &[5, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4]);
        assert_eq!(found, Ok((vec![Some(0.0); 4], names.to_vec(), vec![])));
        let found = record("('index', '|u1'), ('a', '|u1'), ('b', '|u1')", &[7, 1, 2]);
        assert_eq!(found, Ok((vec![None; 2], vec![None], vec![])));
        for (fields, bytes, expected) in [
            ("('time', '<M8[D]'), ('a', '|u1', (1, 2))", 10, "datetime64"),
            ("('a', '<c8', (1, 2))", 16, "\"<c8\""),
            ("('a', '|u1'), ('b', '|u1'), ('c', '|u1')", 3, "3 values"),
        ] {
            let error = record(fields, &vec![0; bytes]).expect_err(fields);
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn an_array_of_no_values_is_empty() {
        for shape in ["0,", "0, 4, 5", "4, 0"] {
            let error = found(&array("'<f8'", shape, &[]), None).expect_err(shape);
            assert!(error.contains("empty"), "{error}");
        }
    }
}
