//! The messages of ROS 2 that have frames, in CDR.
//!
//! | message | its frames |
//! |---|---|
//! | `std_msgs/*MultiArray` | a frame; rows and columns from the layout's first two sizes, if all others are 1 |
//! | `sensor_msgs/Image` | a frame; `mono8`, `mono16`, and types of `OpenCV` with one channel, such as `16UC1` and `32FC1` |
//! | `tactile_msgs/TactileState` | for each of its sensors a frame |
//!
//! Source: the definitions of these messages.

use crate::formats::npy::{Dtype, NumberType};
use crate::formats::recording::ros::cdr::CdrReader;
use crate::formats::recording::side::frame_size;
use crate::frame::FrameSize;

/// A kind of message that has frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum MessageKind {
    /// A `MultiArray` of numbers of this type.
    Array(Dtype),
    /// Grey pixels, row by row; rows may be padded.
    Image,
    /// Lists of values, each with the name of its sensor.
    TactileState,
}

impl MessageKind {
    /// Returns the kind of a schema such as `std_msgs/msg/UInt16MultiArray`; None if its messages have no frames.
    pub(super) fn of(schema: &str) -> Option<Self> {
        let (package, name) = (schema.split('/').next()?, schema.rsplit('/').next()?);
        match (package, name) {
            ("sensor_msgs", "Image") => Some(Self::Image),
            ("tactile_msgs", "TactileState") => Some(Self::TactileState),
            ("std_msgs", name) => {
                let dtype = match name.strip_suffix("MultiArray")? {
                    "Int8" => Dtype::I8,
                    "UInt8" | "Byte" | "Char" => Dtype::U8,
                    "Int16" => Dtype::I16,
                    "UInt16" => Dtype::U16,
                    "Int32" => Dtype::I32,
                    "UInt32" => Dtype::U32,
                    "Int64" => Dtype::I64,
                    "UInt64" => Dtype::U64,
                    "Float32" => Dtype::F32,
                    "Float64" => Dtype::F64,
                    _ => return None,
                };
                Some(Self::Array(dtype))
            }
            _ => None,
        }
    }
}

/// Reads an array into `values`. Returns the sizes of its layout; None if it is broken.
pub(super) fn multi_array(
    cdr: &mut CdrReader<'_>,
    dtype: Dtype,
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
    cdr.numbers(dtype, values)?;
    values.drain(..offset.min(values.len()));
    Some(sizes)
}

/// Skips a `std_msgs/Header`.
pub(super) fn header(cdr: &mut CdrReader<'_>) -> Option<()> {
    cdr.word()?;
    cdr.word()?;
    cdr.text().map(drop)
}

/// The content of an image.
pub(super) enum ImageFrame {
    /// A frame, with its size.
    Values(FrameSize),
    /// Not a frame: an encoding with other than one value per pixel, or an image that is too large.
    OfCamera,
}

/// Reads an image into `values`; None if it is broken. `step` is the number of bytes from one row to the next.
pub(super) fn image(cdr: &mut CdrReader<'_>, values: &mut Vec<f64>) -> Option<ImageFrame> {
    header(cdr)?;
    let (height, width) = (cdr.word()?, cdr.word()?);
    let dtype = match cdr.text()? {
        "mono8" | "8UC1" => Dtype::U8,
        "8SC1" => Dtype::I8,
        "mono16" | "16UC1" => Dtype::U16,
        "16SC1" => Dtype::I16,
        "32SC1" => Dtype::I32,
        "32FC1" => Dtype::F32,
        "64FC1" => Dtype::F64,
        _ => return Some(ImageFrame::OfCamera),
    };
    let big_endian = cdr.byte()? != 0;
    let number = NumberType { dtype, big_endian };
    let step = usize::try_from(cdr.word()?).ok()?;
    let data = cdr.bytes()?;
    let Some(frame) = frame_size(width, height) else {
        return Some(ImageFrame::OfCamera);
    };
    let line = usize::from(frame.columns()) * dtype.width();
    values.clear();
    for row in 0..usize::from(frame.rows()) {
        let start = row.checked_mul(step)?;
        let bytes = data.get(start..start.checked_add(line)?)?;
        values.extend(number.values(bytes));
    }
    Some(ImageFrame::Values(frame))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns two pixels of an image in that encoding; None if it is not a frame.
    fn pixels(encoding: &str, data: &[u8]) -> Option<Vec<f64>> {
        let mut message = vec![0, 1, 0, 0];
        let word = |message: &mut Vec<u8>, number: usize| {
            message.resize(message.len().next_multiple_of(4), 0);
            message.extend(u32::try_from(number).expect("small").to_le_bytes());
        };
        let text = |message: &mut Vec<u8>, text: &str| {
            word(message, text.len() + 1);
            message.extend(text.bytes().chain([0]));
        };
        word(&mut message, 0);
        word(&mut message, 0);
        text(&mut message, "pad");
        word(&mut message, 1);
        word(&mut message, 2);
        text(&mut message, encoding);
        message.push(0);
        word(&mut message, data.len());
        word(&mut message, data.len());
        message.extend(data);
        let mut values = Vec::new();
        let found = image(&mut CdrReader::new(&message)?, &mut values)?;
        matches!(found, ImageFrame::Values(size) if size == FrameSize::new(2, 1).expect("an allowed size")).then_some(values)
    }

    #[test]
    fn images_of_one_channel_are_frames() {
        let signed = [0xfe, 0xff, 3, 0];
        for (encoding, data, expected) in [
            ("mono8", vec![254, 3], [254.0, 3.0]),
            ("8SC1", vec![254, 3], [-2.0, 3.0]),
            ("16UC1", signed.to_vec(), [65_534.0, 3.0]),
            ("16SC1", signed.to_vec(), [-2.0, 3.0]),
            (
                "32SC1",
                [(-2_i32).to_le_bytes(), 3_i32.to_le_bytes()].concat(),
                [-2.0, 3.0],
            ),
            (
                "32FC1",
                [0.5_f32.to_le_bytes(), 3_f32.to_le_bytes()].concat(),
                [0.5, 3.0],
            ),
            (
                "64FC1",
                [0.5_f64.to_le_bytes(), 3_f64.to_le_bytes()].concat(),
                [0.5, 3.0],
            ),
        ] {
            assert_eq!(
                pixels(encoding, &data),
                Some(expected.to_vec()),
                "{encoding}"
            );
        }
        assert_eq!(pixels("rgb8", &[0; 6]), None);
    }
}
