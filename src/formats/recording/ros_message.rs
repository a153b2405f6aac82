//! The messages of ROS 2 that have frames, in CDR.
//!
//! | message | its frames |
//! |---|---|
//! | `std_msgs/*MultiArray` | a frame; rows and columns from the layout's first two sizes, if it has them |
//! | `sensor_msgs/Image` | a frame; `mono8`, `8UC1`, `mono16`, `16UC1` and `32FC1` |
//! | `tactile_msgs/TactileState` | for each of its sensors a frame |
//!
//! Source: the definitions of these messages.

use crate::formats::npy::NumberType;
use crate::formats::recording::cdr::CdrReader;
use crate::formats::recording::side::shape;

/// A kind of message that has frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum MessageKind {
    /// A `MultiArray` of numbers: their kind, as of numpy, and bytes.
    Array(u8, usize),
    /// Grey pixels, a row after the other, which may be padded.
    Image,
    /// Lists of values, each with the name of its sensor.
    TactileState,
}

impl MessageKind {
    /// That of a schema such as `std_msgs/msg/UInt16MultiArray`.
    pub(super) fn of(schema: &str) -> Option<Self> {
        let (package, name) = (schema.split('/').next()?, schema.rsplit('/').next()?);
        match (package, name) {
            ("sensor_msgs", "Image") => Some(Self::Image),
            ("tactile_msgs", "TactileState") => Some(Self::TactileState),
            ("std_msgs", name) => {
                let (kind, size) = match name.strip_suffix("MultiArray")? {
                    "Int8" => (b'i', 1),
                    "UInt8" | "Byte" | "Char" => (b'u', 1),
                    "Int16" => (b'i', 2),
                    "UInt16" => (b'u', 2),
                    "Int32" => (b'i', 4),
                    "UInt32" => (b'u', 4),
                    "Int64" => (b'i', 8),
                    "UInt64" => (b'u', 8),
                    "Float32" => (b'f', 4),
                    "Float64" => (b'f', 8),
                    _ => return None,
                };
                Some(Self::Array(kind, size))
            }
            _ => None,
        }
    }
}

/// Reads an array. Returns the sizes of its layout; None if it is broken.
pub(super) fn multi_array(
    cdr: &mut CdrReader<'_>,
    kind: u8,
    size: usize,
    values: &mut Vec<f64>,
) -> Option<Vec<u32>> {
    let mut sizes = Vec::new();
    for _ in 0..cdr.count(12)? {
        cdr.text()?;
        sizes.push(cdr.word()?);
        cdr.word()?;
    }
    let offset = usize::try_from(cdr.word()?).ok()?;
    values.clear();
    cdr.numbers(kind, size, values)?;
    values.drain(..offset.min(values.len()));
    Some(sizes)
}

/// Rows and columns of an array with these sizes, if they are those of a matrix.
pub(super) fn matrix_shape(sizes: &[u32]) -> Option<(u16, u16)> {
    match *sizes {
        [rows, columns] | [rows, columns, 1] => shape(rows, columns),
        _ => None,
    }
}

/// Passes over a `std_msgs/Header`.
pub(super) fn header(cdr: &mut CdrReader<'_>) -> Option<()> {
    cdr.word()?;
    cdr.word()?;
    cdr.text().map(drop)
}

/// What an image is.
pub(super) enum ImageFrame {
    /// A frame of so many rows and columns.
    Values(u16, u16),
    /// No frame: in another encoding than one value a pixel, or too large.
    OfCamera,
}

/// Reads an image.
/// `step` is the number of bytes from a row to the next. None if it is broken.
pub(super) fn image(cdr: &mut CdrReader<'_>, values: &mut Vec<f64>) -> Option<ImageFrame> {
    header(cdr)?;
    let (height, width) = (cdr.word()?, cdr.word()?);
    let (kind, size) = match cdr.text()? {
        "mono8" | "8UC1" => (b'u', 1),
        "mono16" | "16UC1" => (b'u', 2),
        "32FC1" => (b'f', 4),
        _ => return Some(ImageFrame::OfCamera),
    };
    let big_endian = cdr.byte()? != 0;
    let step = usize::try_from(cdr.word()?).ok()?;
    let data = cdr.bytes()?;
    let Some((rows, columns)) = shape(height, width) else {
        return Some(ImageFrame::OfCamera);
    };
    let line = usize::from(columns) * size;
    values.clear();
    for row in 0..usize::from(rows) {
        let start = row.checked_mul(step)?;
        let bytes = data.get(start..start.checked_add(line)?)?;
        let number = NumberType::new(kind, size, big_endian);
        values.extend(bytes.chunks(size).map(|bytes| number.value(bytes)));
    }
    Some(ImageFrame::Values(rows, columns))
}
