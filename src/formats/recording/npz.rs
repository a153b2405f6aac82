//! Frames as an archive of numpy arrays: each array of two or three axes is a channel, and a list named `t…` or `time…`
//! gives the times of channels of its length.
//!
//! Its channels are named as the arrays, without `.npy`; a single one has no name. Times may be in s, ms, µs or ns,
//! which their name tells (`time_ms`), and count from the first one. Whole nanoseconds since 1970 lose nothing: the
//! difference is taken before they become floats. What `numpy.savez` and `numpy.savez_compressed` write is read.

use std::io::{Read, Seek};

use zip::ZipArchive;
use zip::result::ZipError;

use crate::formats::npy::Header;
use crate::formats::recording::cell_names::{FieldRole, role};
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ChannelInfo, ReadOptions, RecordingEvent, Sink};
use crate::formats::recording::numpy::{self, ArrayLayout, NumberType};
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
    let alone = channels.len() == 1;
    let mut layouts = Vec::new();
    for array in &channels {
        // What is meant for one of several arrays need not fit the others.
        let layout = match ArrayLayout::of(&array.header, options) {
            Err(_) if !alone && options.shape.is_some() => {
                ArrayLayout::of(&array.header, ReadOptions::default())?
            }
            layout => layout?,
        };
        let info = ChannelInfo {
            name: (!alone).then(|| array.name.clone()),
            shape: Some(layout.shape()),
            ..ChannelInfo::default()
        };
        if sink(RecordingEvent::Channel(&info)).is_break() {
            return Ok(());
        }
        layouts.push(layout);
    }
    for (channel, (array, layout)) in channels.iter().zip(&layouts).enumerate() {
        let times = times(&mut archive, &arrays, layout.frames())?;
        let mut file = archive.by_index(array.index).map_err(damaged)?;
        numpy::header(&mut file)?;
        let named = |error| match error {
            RecordingError::Damaged { message, .. } => {
                RecordingError::damaged(format!("{}: {message}", array.name))
            }
            error => error,
        };
        if numpy::frames(&mut file, layout, channel, &times, sink).map_err(named)? {
            break;
        }
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
        let header = numpy::header(&mut file)?;
        arrays.push(ArchiveArray {
            index,
            name,
            header,
        });
    }
    Ok(arrays)
}

/// The times of all `frames`, in seconds since the first; empty where there are none.
fn times(
    archive: &mut ZipArchive<impl Read + Seek>,
    arrays: &[ArchiveArray],
    frames: u64,
) -> Result<Vec<f64>, RecordingError> {
    let found = arrays.iter().find_map(|array| {
        let factor = match role(&array.name) {
            Some(FieldRole::Time(factor)) => factor,
            _ if array.name.starts_with(['t', 'T']) => 1.0,
            _ => return None,
        };
        let number = NumberType::of(&array.header.code)?;
        (array.header.shape == [frames]).then_some((array, number, factor))
    });
    let Some((array, number, factor)) = found.filter(|_| frames <= MOST_TIMES) else {
        return Ok(Vec::new());
    };
    let mut file = archive.by_index(array.index).map_err(damaged)?;
    numpy::header(&mut file)?;
    let mut bytes = [0; 8];
    let bytes = &mut bytes[..number.size()];
    let mut times = Vec::new();
    let (mut first, mut first_whole) = (None, None);
    for _ in 0..frames {
        if numpy::fill(&mut file, bytes)? < bytes.len() {
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
    Ok(times)
}
