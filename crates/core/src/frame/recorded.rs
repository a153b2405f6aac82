use crate::frame::error::FrameError;
use crate::frame::size::FrameSize;

/// The largest value that a cell may have; the smallest is its negative. So the sum of a frame is always finite.
pub const LARGEST_VALUE: f64 = 1e300;

/// The values of a sensor's cells at one moment, in the sensor's unit.
///
/// Readers and decoders reuse one frame, so nothing is allocated per frame.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The number of the frame in its channel, from 0.
    pub number: u64,
    /// The number of the channel, from 0; each of several sensors has one.
    pub channel: usize,
    /// The label that the recording gives the frame, if any.
    pub label: Option<i64>,
    /// The time in seconds since the start of the recording, if known. Times may repeat and go back.
    pub time: Option<f64>,
    size: FrameSize,
    values: Vec<f64>,
}

impl Default for Frame {
    fn default() -> Self {
        Self::new(FrameSize::SMALLEST)
    }
}

impl Frame {
    /// Creates a frame of cells without values.
    pub fn new(size: FrameSize) -> Self {
        Self {
            number: 0,
            channel: 0,
            label: None,
            time: None,
            size,
            values: vec![f64::NAN; size.cells()],
        }
    }

    /// Creates a frame from the values of its cells, row by row; NaN stands for no cell. A value that is infinite or
    /// beyond ±[`LARGEST_VALUE`] counts as no value.
    ///
    /// # Errors
    /// Returns an error if the number of values is not the number of cells.
    pub fn from_values(size: FrameSize, values: &[f64]) -> Result<Self, FrameError> {
        let mut frame = Self::new(size);
        frame.set_values(values)?;
        Ok(frame)
    }

    /// Sets the values of all cells, row by row; everything else stays. Does not allocate.
    ///
    /// # Errors
    /// Returns an error if the number of values differs from the number of cells; then nothing is changed.
    pub fn set_values(&mut self, values: &[f64]) -> Result<(), FrameError> {
        if values.len() != self.values.len() {
            return Err(FrameError::Values {
                size: self.size,
                found: values.len(),
            });
        }
        self.values.copy_from_slice(values);
        Ok(())
    }

    /// Changes the size and removes all values; everything else stays. Allocates only if there are more cells than ever
    /// before.
    pub fn reset(&mut self, size: FrameSize) {
        self.size = size;
        self.values.clear();
        self.values.resize(size.cells(), f64::NAN);
    }

    /// Copies another frame into this one, reusing its memory.
    pub fn copy_from(&mut self, other: &Self) {
        let values = std::mem::take(&mut self.values);
        *self = Self {
            values,
            number: other.number,
            channel: other.channel,
            label: other.label,
            time: other.time,
            size: other.size,
        };
        self.values.clear();
        self.values.extend_from_slice(&other.values);
    }

    /// Returns the number of columns and rows.
    pub fn size(&self) -> FrameSize {
        self.size
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> u16 {
        self.size.columns()
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> u16 {
        self.size.rows()
    }

    /// Returns the values row by row; NaN where the sensor has no cell.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the values for writing. A value that is infinite or beyond ±[`LARGEST_VALUE`] counts as no value.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Returns the number of cells that have a value.
    pub fn cells(&self) -> usize {
        let is_value = |value: &&f64| value.abs() <= LARGEST_VALUE;
        self.values.iter().filter(is_value).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_equals_the_frame() {
        let mut frame = Frame::new(FrameSize::of(2, 1));
        frame.values_mut().copy_from_slice(&[1.0, 2.0]);
        (frame.number, frame.channel, frame.label) = (3, 4, Some(5));
        frame.time = Some(0.5);
        let mut copy = Frame::new(FrameSize::of(5, 5));
        copy.copy_from(&frame);
        assert_eq!(format!("{copy:?}"), format!("{frame:?}"));
    }

    #[test]
    fn examples() -> Result<(), Box<dyn std::error::Error>> {
        use crate::frame::{Frame, FrameSize};
        let size = FrameSize::new(3, 2)?;
        let mut frame = Frame::from_values(size, &[0.0, 12.0, f64::NAN, 3.0, 10.0, 0.0])?;
        assert_eq!((frame.columns(), frame.rows(), frame.cells()), (3, 2, 5));
        // The next frame, in the same memory.
        frame.set_values(&[0.0, 11.0, f64::NAN, 4.0, 10.0, 0.0])?;
        assert_eq!(
            frame.set_values(&[0.0]).unwrap_err().to_string(),
            "found 1 value, expected 6 for a frame of 3 × 2"
        );
        Ok(())
    }
}
