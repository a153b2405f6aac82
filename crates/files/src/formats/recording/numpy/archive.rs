//! Frames as an archive of numpy arrays: each array of two or three axes is a channel, and an array of one axis named
//! `t…` or `time…` gives the times of the channels with as many frames.
//!
//! Channels have the names of their arrays, without `.npy`. Times may be in s, ms, µs or ns, according to their name
//! (`time_ms`), their type (datetime64 and timedelta64 of numpy) or their size ([`TimeUnit::by_size`]), and count
//! from the first one. Whole nanoseconds since 1970 keep all their digits: the difference is taken before they become
//! floats. Archives of `numpy.savez` and `numpy.savez_compressed` are read.
//!
//! The checksum of an array only says that some of its bytes are wrong, and only at its end. Its frames are reported
//! as they are read, then the error: to check it first would take twice the time and lose all frames that are right.
//! An archive that is cut short has no directory, so nothing of it is read.

use crate::formats::recording::error::foreign;
use std::io::{ErrorKind, Read, Seek};

use zip::ZipArchive;
use zip::result::ZipError;

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::npy::{Header, NumberType};
use crate::formats::recording::event::{
    ChannelInfo, ReadOptions, RecordingEvent, RecordingNote, Sink, Stop,
};
use crate::formats::recording::numpy::array::{self, ArrayLayout};
use crate::formats::recording::time::field_role::{FieldRole, role};
use crate::formats::recording::time::{FrameClock, Time, TimeUnit};

/// The most frames of which times are read: 128 MiB of them.
const MOST_TIMES: u64 = 1 << 24;

/// The most arrays in an archive.
const MOST_ARRAYS: usize = 256;

const CUT: &str = "an archive that is cut short or damaged";

fn damaged(error: ZipError) -> ReadError {
    match error {
        ZipError::Io(error) => error.into(),
        ZipError::UnsupportedArchive(what) => ReadError::new(format!("an archive: {what}")),
        _ => ReadError::new(CUT),
    }
}

/// Returns the error for the array of that name: bytes that cannot be decompressed or that have a wrong checksum are
/// damage to the array, not to the disk.
fn in_array(name: &str, error: ReadError) -> ReadError {
    let message = match error.kind {
        ReadErrorKind::Invalid => error.message,
        ReadErrorKind::Io(
            ErrorKind::InvalidData | ErrorKind::InvalidInput | ErrorKind::UnexpectedEof,
        ) => "the array is damaged, so some of its values may be wrong".to_owned(),
        _ => return error,
    };
    ReadError::new(format!("{name}: {message}"))
}

struct ArchiveArray {
    index: usize,
    /// The name without `.npy`.
    name: String,
    header: Header,
}

pub(in crate::formats::recording) fn read(
    input: impl Read + Seek,
    options: &ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let archive = &mut ZipArchive::new(input).map_err(damaged)?;
    // A spreadsheet is a zip archive, too.
    let is_office = |name: &str| matches!(name, "[Content_Types].xml" | "content.xml");
    if archive
        .file_names()
        .any(|name| name.is_ok_and(|name| is_office(&name)))
    {
        let kind = "a spreadsheet or another office document (save the sheet as CSV)";
        return Err(foreign(kind).into());
    }
    let arrays = arrays(archive)?;
    let channels = channels(&arrays, options)?;
    for (array, layout) in &channels {
        let info = ChannelInfo {
            name: Some(array.name.clone()),
            size: Some(layout.size()),
            ..ChannelInfo::default()
        };
        sink.event(RecordingEvent::Channel(&info))?;
        if let Some(note) = layout.note() {
            sink.event(RecordingEvent::Note(note))?;
        }
    }
    let (mut noted, mut counted, mut times) = (None, None, Vec::new());
    for (channel, (array, layout)) in channels.iter().enumerate() {
        let frames = layout.frames();
        // Channels with as many frames have the same times.
        if counted != Some(frames) {
            let (found, note) = self::times(archive, &arrays, frames)?;
            if let Some(note) = note.as_ref().filter(|_| note != noted) {
                sink.event(RecordingEvent::Note(note))?;
            }
            noted = note.or(noted);
            (counted, times) = (Some(frames), found);
        }
        let mut file = archive.by_index(array.index).map_err(damaged)?;
        let named = |error| in_array(&array.name, error);
        array::header(&mut file).map_err(named)?;
        array::frames(&mut file, layout, channel, &times, sink).map_err(|end| match end {
            Stop::Failed(error) => named(error).into(),
            Stop::Enough => end,
        })?;
        array::end(&mut file, layout).map_err(named)?;
    }
    Ok(())
}

fn channels<'a>(
    arrays: &'a [ArchiveArray],
    options: &ReadOptions,
) -> Result<Vec<(&'a ArchiveArray, ArrayLayout)>, ReadError> {
    let channels: Vec<&ArchiveArray> = arrays
        .iter()
        .filter(|array| {
            let shape = &array.header.shape[..];
            let is_frames = matches!(shape, [_, _] | [_, _, _] | [_, _, _, 1] | [_, 1, _, _]);
            is_frames && !array.header.code.starts_with('[')
        })
        .collect();
    if channels.is_empty() {
        let message = "no array of two or three axes, expected frames, rows and columns";
        return Err(ReadError::new(message));
    }
    with_layouts(channels, options)
}

/// Returns true if the archive begins as taxel writes atlases and models: with a header of bytes, then with the rows of
/// imprints, or their heights.
fn is_atlas_or_model(arrays: &[ArchiveArray]) -> bool {
    let [header, second, ..] = arrays else {
        return false;
    };
    header.name == "header"
        && header.header.code == "|u1"
        && header.header.shape.len() == 1
        && matches!(&*second.name, "rows" | "height")
}

/// Returns all arrays with their headers. An atlas or a model is refused.
fn arrays<R: Read + Seek>(archive: &mut ZipArchive<R>) -> Result<Vec<ArchiveArray>, ReadError> {
    if archive.len() > MOST_ARRAYS {
        let message = format!("more than {MOST_ARRAYS} files in the archive");
        return Err(ReadError::new(message));
    }
    let mut arrays = Vec::new();
    for index in 0..archive.len() {
        arrays.extend(array(archive, index)?);
    }
    if is_atlas_or_model(&arrays) {
        let kind = "an atlas or a model of taxel";
        return Err(foreign(kind));
    }
    Ok(arrays)
}

/// Returns an array with its header; None if the file is not an array.
fn array<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    index: usize,
) -> Result<Option<ArchiveArray>, ReadError> {
    let mut file = archive.by_index(index).map_err(damaged)?;
    let name = file.name().map_err(damaged)?.into_owned();
    let Some(name) = name.strip_suffix(".npy").map(str::to_owned) else {
        return Ok(None);
    };
    let header = array::header(&mut file).map_err(|error| in_array(&name, error))?;
    Ok(Some(ArchiveArray {
        index,
        name,
        header,
    }))
}

/// Returns the arrays whose numbers can be frames, with their layouts. Others, such as a list of poses, may lie
/// beside them.
fn with_layouts<'a>(
    arrays: Vec<&'a ArchiveArray>,
    options: &ReadOptions,
) -> Result<Vec<(&'a ArchiveArray, ArrayLayout)>, ReadError> {
    let alone = arrays.len() == 1;
    let (mut found, mut first_error) = (Vec::new(), None);
    for array in arrays {
        // Rows and columns that are meant for one of several arrays need not fit the others.
        let layout = match ArrayLayout::of(&array.header, options) {
            Err(_) if !alone && options.size.is_some() => {
                ArrayLayout::of(&array.header, &ReadOptions::default())
            }
            layout => layout,
        };
        match layout {
            Ok(layout) => found.push((array, layout)),
            Err(error) => {
                first_error.get_or_insert(error);
            }
        }
    }
    match first_error {
        Some(error) if found.is_empty() => Err(error),
        _ => Ok(found),
    }
}

struct TimeArray<'a> {
    array: &'a ArchiveArray,
    number: NumberType,
    unit: Option<TimeUnit>,
    /// Whether the smallest number means a missing time, as in numpy's own types for times.
    has_none: bool,
}

impl<'a> TimeArray<'a> {
    /// Makes the times of an array whose name may have a unit; None if its numbers cannot be times. A type such as
    /// `<M8[ns]` or `<m8[ms]`, numpy's types for points in time and for durations, includes its unit.
    fn new(array: &'a ArchiveArray, unit: Option<TimeUnit>) -> Option<Self> {
        let code = &array.header.code;
        let own = code.strip_suffix(']').and_then(|code| code.split_once('['));
        let Some((kind, word)) = own else {
            return NumberType::of(code).map(|number| Self {
                array,
                number,
                unit,
                has_none: false,
            });
        };
        let unit = match word {
            "ns" => TimeUnit::Nanoseconds,
            "us" => TimeUnit::Microseconds,
            "ms" => TimeUnit::Milliseconds,
            "s" => TimeUnit::Seconds,
            "m" => TimeUnit::Minutes,
            _ => return None,
        };
        let order = kind
            .strip_suffix("M8")
            .or_else(|| kind.strip_suffix("m8"))?;
        Some(Self {
            array,
            number: NumberType::of(&format!("{order}i8"))?,
            unit: Some(unit),
            has_none: true,
        })
    }

    /// Returns the times for arrays with that many frames. An array whose name merely begins with `t` counts only if
    /// no other is named as a time: `temperature` is not one.
    fn of_frames(arrays: &'a [ArchiveArray], frames: u64) -> Option<Self> {
        let mut fitting = arrays.iter().filter(|own| own.header.shape == [frames]);
        let timed = |array: &'a ArchiveArray| match role(&array.name) {
            Some(FieldRole::Time(unit)) => Self::new(array, unit),
            _ => None,
        };
        let found = fitting.clone().find_map(timed);
        let other = fitting.find(|array| array.name.starts_with(['t', 'T']));
        found.or_else(|| Self::new(other?, None))
    }

    /// Returns the times in seconds since the first one, NaN for missing ones, and a note if their unit was derived
    /// from their size and is not seconds.
    fn seconds(
        &self,
        file: &mut impl Read,
        frames: u64,
    ) -> Result<(Vec<f64>, Option<RecordingNote>), ReadError> {
        array::header(file)?;
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..self.number.size()];
        let (mut times, mut clock) = (Vec::new(), FrameClock::default());
        clock.set_unit(self.unit);
        for _ in 0..frames {
            if array::fill(file, bytes)? < bytes.len() {
                let message = format!("ends before its {frames} times");
                return Err(ReadError::new(message));
            }
            let (value, whole) = (self.number.value(bytes), self.number.whole(bytes));
            let is_none = self.has_none && whole == Some(i128::from(i64::MIN));
            if is_none || !value.is_finite() {
                times.push(f64::NAN);
                continue;
            }
            let unit = clock.unit(value);
            times.push(clock.since_first(match whole {
                Some(whole) => Time::of_whole(whole, unit),
                None => Time::Seconds(unit.seconds(value)),
            }));
        }
        // Wrong times are worse than none, so read up to the end of the array, where its checksum is verified.
        array::fill(file, &mut [0])?;
        Ok((times, clock.take_note()))
    }
}

/// Returns the times of all `frames`, in seconds since the first one, NaN for missing ones; empty if there are none.
/// Returns a note, too, if their unit was derived from their size and is not seconds.
fn times<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    arrays: &[ArchiveArray],
    frames: u64,
) -> Result<(Vec<f64>, Option<RecordingNote>), ReadError> {
    let found = TimeArray::of_frames(arrays, frames);
    let Some(found) = found.filter(|_| frames <= MOST_TIMES) else {
        return Ok((Vec::new(), None));
    };
    let mut file = archive.by_index(found.array.index).map_err(damaged)?;
    let named = |error| in_array(&found.array.name, error);
    found.seconds(&mut file, frames).map_err(named)
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Write};

    use zip::write::SimpleFileOptions;

    use super::*;
    use crate::formats::npy::header_of;
    use crate::formats::recording;
    use std::ops::ControlFlow;

    /// Returns times and notes of two frames of two cells from each of two sensors, beside an array `time` of that
    /// type with those numbers.
    fn times_of(name: &str, code: &str, times: [i64; 2]) -> (Vec<Option<f64>>, Vec<String>) {
        let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default();
        let mut add = |name: &str, code: &str, shape: &str, numbers: &[u8]| {
            let text =
                format!("{{'descr': '{code}', 'fortran_order': False, 'shape': ({shape}), }}");
            archive
                .start_file(format!("{name}.npy"), options)
                .expect("begun");
            let array = [&header_of(&text, 0), numbers].concat();
            archive.write_all(&array).expect("written");
        };
        for sensor in ["left", "right"] {
            add(sensor, "|u1", "2, 1, 2", &[1, 2, 3, 4]);
        }
        add(name, code, "2,", &times.map(i64::to_le_bytes).concat());
        let archive = archive.finish().expect("finished").into_inner();
        let (mut found, mut notes) = (Vec::new(), Vec::new());
        let options = ReadOptions::default();
        let read = recording::read(Cursor::new(archive), &options, &mut |event| {
            match event {
                RecordingEvent::Frame(frame) => found.push(frame.time),
                RecordingEvent::Note(note) => notes.push(note.to_string()),
                _ => {}
            }
            ControlFlow::Continue(())
        });
        assert!(read.is_ok(), "{read:?}");
        let (left, right) = found.split_at(2);
        assert_eq!(left, right);
        (left.to_vec(), notes)
    }

    #[test]
    fn times_have_the_unit_of_their_name_their_type_or_their_size() {
        let since_1970 = [1_714_564_800_123_456_789, 1_714_564_800_124_456_790];
        let both = |step| vec![Some(0.0), Some(step)];
        for (name, code, times, step) in [
            ("time_ns", "<i8", since_1970, 0.001_000_001),
            ("time", "<M8[ns]", since_1970, 0.001_000_001),
            ("time", "<m8[ms]", [5, 55], 0.05),
            ("stamps", "<i8", [5, 55], f64::NAN),
            ("t_ms", "<i8", [5, 55], 0.05),
            ("time", "<i8", [5, 55], 50.0),
        ] {
            let expected = if step.is_nan() {
                vec![None; 2]
            } else {
                both(step)
            };
            assert_eq!(
                times_of(name, code, times),
                (expected, vec![]),
                "{name} {code}"
            );
        }
        let noted =
            vec!["the times have no unit and are taken as nanoseconds since 1970".to_owned()];
        assert_eq!(
            times_of("time", "<i8", since_1970),
            (both(0.001_000_001), noted)
        );
    }

    #[test]
    fn a_missing_time_leaves_the_others() {
        // NaT, numpy's missing time.
        let (time, none) = (1_714_564_800_123_456_789, i64::MIN);
        let times = |numbers| times_of("time", "<M8[ns]", numbers).0;
        assert_eq!(times([time, none]), [Some(0.0), None]);
        assert_eq!(times([none, time]), [None, Some(0.0)]);
        let floats = |numbers: [f64; 2]| {
            let bits = numbers.map(|number| number.to_bits().cast_signed());
            times_of("time", "<f8", bits).0
        };
        assert_eq!(floats([2.0, f64::INFINITY]), [Some(0.0), None]);
        assert_eq!(floats([f64::NAN, 2.0]), [None, Some(0.0)]);
    }
}
