//! Frames as an archive of numpy arrays: each array of two or three axes is a channel, and a list named `t…` or `time…`
//! gives the times of channels of its length.
//!
//! Its channels are named as the arrays, without `.npy`. Times may be in s, ms, µs or ns, which their name tells
//! (`time_ms`), and count from the first one. Whole nanoseconds since 1970 lose nothing: the difference is taken before
//! they become floats. What `numpy.savez` and `numpy.savez_compressed` write is read.
//!
//! The checksum of an array says only that some of its bytes are wrong, and only at its end. Its frames are given as they
//! are read, then the error: to check it first would take twice the time and give none of the frames that are right.

use std::io::{ErrorKind, Read, Seek};

use zip::ZipArchive;
use zip::result::ZipError;

use crate::formats::npy::{Header, NumberType};
use crate::formats::recording::cell_names::{FieldRole, role};
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ChannelInfo, ReadOptions, RecordingEvent, Sink};
use crate::formats::recording::numpy::{self, ArrayLayout};
use crate::formats::seconds::{since, to_nanoseconds};

/// Times of more frames than these are not read: 128 MiB of them.
const MOST_TIMES: u64 = 1 << 24;

/// No archive has more arrays.
const MOST_ARRAYS: usize = 256;

/// What the archive's reader complains about.
fn damaged(error: ZipError) -> RecordingError {
    match error {
        ZipError::Io(error) => RecordingError::Io(error),
        error => RecordingError::damaged(format!("a broken archive: {error}")),
    }
}

/// What is wrong with the array of that name: bytes that cannot be unpacked or whose checksum does not hold are a damage of
/// the array, not of the disk.
fn in_array(name: &str, error: RecordingError) -> RecordingError {
    let message = match error {
        RecordingError::Damaged { message, .. } => message,
        RecordingError::Io(error)
            if matches!(
                error.kind(),
                ErrorKind::InvalidData | ErrorKind::InvalidInput | ErrorKind::UnexpectedEof
            ) =>
        {
            "the array is damaged, so some of its values may be wrong".to_owned()
        }
        error => return error,
    };
    RecordingError::damaged(format!("{name}: {message}"))
}

/// An array of the archive.
struct ArchiveArray {
    /// Its place in the archive.
    index: usize,
    /// Its name without `.npy`.
    name: String,
    /// Its type and shape.
    header: Header,
}

/// Reads a recording.
///
/// # Errors
/// If there is no array that may be frames; those of each array, with its name.
pub(super) fn read(
    input: impl Read + Seek,
    options: ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), RecordingError> {
    let mut archive = ZipArchive::new(input).map_err(damaged)?;
    // Of Excel and of LibreOffice.
    let is_office = |name: &str| matches!(name, "[Content_Types].xml" | "content.xml");
    if archive
        .file_names()
        .any(|name| name.is_ok_and(|name| is_office(&name)))
    {
        return Err(RecordingError::Foreign {
            kind: "a spreadsheet or another office document (save the sheet as CSV)",
        });
    }
    let arrays = arrays(&mut archive)?;
    let channels: Vec<&ArchiveArray> = arrays
        .iter()
        .filter(|array| {
            (2..=3).contains(&array.header.shape.len()) && !array.header.code.starts_with('[')
        })
        .collect();
    if channels.is_empty() {
        return Err(RecordingError::damaged(
            "no array of two or three axes, expected frames, rows and columns",
        ));
    }
    let channels = with_layouts(channels, options)?;
    for (array, layout) in &channels {
        let info = ChannelInfo {
            name: Some(array.name.clone()),
            shape: Some(layout.shape()),
            ..ChannelInfo::default()
        };
        if sink(RecordingEvent::Channel(&info)).is_break() {
            return Ok(());
        }
    }
    for (channel, (array, layout)) in channels.iter().enumerate() {
        let times = times(&mut archive, &arrays, layout.frames())?;
        let mut file = archive.by_index(array.index).map_err(damaged)?;
        let named = |error| in_array(&array.name, error);
        numpy::header(&mut file).map_err(named)?;
        if numpy::frames(&mut file, layout, channel, &times, sink).map_err(named)? {
            break;
        }
        numpy::end(&mut file, layout).map_err(named)?;
    }
    Ok(())
}

/// All arrays with their headers.
fn arrays(archive: &mut ZipArchive<impl Read + Seek>) -> Result<Vec<ArchiveArray>, RecordingError> {
    if archive.len() > MOST_ARRAYS {
        let message = format!("more than {MOST_ARRAYS} files in the archive");
        return Err(RecordingError::damaged(message));
    }
    let mut arrays = Vec::new();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).map_err(damaged)?;
        let name = file.name().map_err(damaged)?.into_owned();
        let Some(name) = name.strip_suffix(".npy").map(str::to_owned) else {
            continue;
        };
        let header = numpy::header(&mut file).map_err(|error| in_array(&name, error))?;
        arrays.push(ArchiveArray {
            index,
            name,
            header,
        });
    }
    Ok(arrays)
}

/// The arrays whose numbers can be frames, and how. Others, such as a list of poses, may lie beside them.
///
/// # Errors
/// What is wrong with the first, if none can.
fn with_layouts(
    arrays: Vec<&ArchiveArray>,
    options: ReadOptions,
) -> Result<Vec<(&ArchiveArray, ArrayLayout)>, RecordingError> {
    let alone = arrays.len() == 1;
    let (mut found, mut first_error) = (Vec::new(), None);
    for array in arrays {
        // What is meant for one of several arrays need not fit the others.
        let layout = match ArrayLayout::of(&array.header, options) {
            Err(_) if !alone && options.shape.is_some() => {
                ArrayLayout::of(&array.header, ReadOptions::default())
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

/// The times of all `frames`, in seconds since the first; empty where there are none.
fn times<'a>(
    archive: &mut ZipArchive<impl Read + Seek>,
    arrays: &'a [ArchiveArray],
    frames: u64,
) -> Result<Vec<f64>, RecordingError> {
    let fits = |array: &&ArchiveArray| array.header.shape == [frames];
    let number = |array: &ArchiveArray| NumberType::of(&array.header.code);
    let timed = |array: &'a ArchiveArray| match role(&array.name) {
        Some(FieldRole::Time(factor)) => Some((array, number(array)?, factor)),
        _ => None,
    };
    // Only where no array is called a time: `temperature` is none.
    let mut others = arrays.iter().filter(fits);
    let other = others.find(|array| array.name.starts_with(['t', 'T']));
    let found = arrays.iter().filter(fits).find_map(timed);
    let found = found.or_else(|| other.and_then(|array| Some((array, number(array)?, 1.0))));
    let Some((array, number, factor)) = found.filter(|_| frames <= MOST_TIMES) else {
        return Ok(Vec::new());
    };
    let mut file = archive.by_index(array.index).map_err(damaged)?;
    let named = |error| in_array(&array.name, error);
    numpy::header(&mut file).map_err(named)?;
    let mut bytes = [0; 8];
    let bytes = &mut bytes[..number.size()];
    let mut times = Vec::new();
    let (mut first, mut first_whole) = (None, None);
    for _ in 0..frames {
        if numpy::fill(&mut file, bytes).map_err(named)? < bytes.len() {
            let message = format!("{}: ends before its {frames} times", array.name);
            return Err(RecordingError::damaged(message));
        }
        // Nanoseconds since 1970 have more digits than a float.
        #[expect(
            clippy::cast_precision_loss,
            reason = "the nearest float of a difference"
        )]
        let time = if let Some(whole) = number.whole(bytes) {
            (whole - *first_whole.get_or_insert(whole)) as f64
        } else {
            let value = number.value(bytes);
            since(*first.get_or_insert(value), value)
        };
        if !time.is_finite() {
            return Ok(Vec::new());
        }
        times.push(to_nanoseconds(time * factor));
    }
    // Wrong times are worse than none, and the end of the list tells whether its checksum holds.
    numpy::fill(&mut file, &mut [0]).map_err(named)?;
    Ok(times)
}
