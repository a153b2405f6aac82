//! A raw frame: the values of all cells at one moment, before any processing.

use crate::frame::error::FrameError;

/// The largest number of columns, and of rows, that a frame may have before it is cropped.
pub const MAX_FRAME_SIDE: u16 = 512;

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
    /// The row and column of the whole sensor at which the frame begins, counted as in the recording; None if the
    /// recording does not state them.
    pub first: Option<(u32, u32)>,
    columns: u16,
    rows: u16,
    values: Vec<f64>,
}

impl Frame {
    /// Creates a frame whose cells have no values. Sides are clamped to 1 to 512.
    pub fn new(columns: u16, rows: u16) -> Self {
        let mut frame = Self {
            number: 0,
            channel: 0,
            label: None,
            time: None,
            first: None,
            columns: 1,
            rows: 1,
            values: Vec::new(),
        };
        frame.reset(columns, rows);
        frame
    }

    /// Creates a frame from the values of its cells, row by row; NaN stands for no cell. A value that is infinite or
    /// beyond ±[`LARGEST_VALUE`] counts as no value.
    ///
    /// ```
    /// use taxel::frame::Frame;
    /// let mut frame = Frame::from_values(3, 2, &[0.0, 12.0, f64::NAN, 3.0, 10.0, 0.0])?;
    /// assert_eq!((frame.columns(), frame.rows(), frame.cells()), (3, 2, 5));
    /// // The next frame, in the same memory.
    /// frame.set_values(&[0.0, 11.0, f64::NAN, 4.0, 10.0, 0.0])?;
    /// assert_eq!(frame.set_values(&[0.0]).unwrap_err().to_string(), "found 1 value, expected 6 for a frame of 3 × 2");
    /// # Ok::<(), taxel::frame::FrameError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if a side is not 1 to 512, or the number of values differs from the number of cells.
    pub fn from_values(columns: u16, rows: u16, values: &[f64]) -> Result<Self, FrameError> {
        let mut frame = Self::new(columns, rows);
        if (frame.columns, frame.rows) != (columns, rows) {
            return Err(FrameError::Sides { columns, rows });
        }
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
                columns: self.columns,
                rows: self.rows,
                found: values.len(),
            });
        }
        self.values.copy_from_slice(values);
        Ok(())
    }

    /// Changes the size, clamped to 1 to 512 on each side, and removes all values; everything else stays. Allocates
    /// only if there are more cells than ever before.
    pub fn reset(&mut self, columns: u16, rows: u16) {
        self.columns = columns.clamp(1, MAX_FRAME_SIDE);
        self.rows = rows.clamp(1, MAX_FRAME_SIDE);
        self.values.clear();
        let cells = usize::from(self.columns) * usize::from(self.rows);
        self.values.resize(cells, f64::NAN);
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
            first: other.first,
            columns: other.columns,
            rows: other.rows,
        };
        self.values.clear();
        self.values.extend_from_slice(&other.values);
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> u16 {
        self.columns
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> u16 {
        self.rows
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
        let mut frame = Frame::new(2, 1);
        frame.values_mut().copy_from_slice(&[1.0, 2.0]);
        (frame.number, frame.channel, frame.label) = (3, 4, Some(5));
        (frame.time, frame.first) = (Some(0.5), Some((6, 7)));
        let mut copy = Frame::new(5, 5);
        copy.copy_from(&frame);
        assert_eq!(format!("{copy:?}"), format!("{frame:?}"));
    }
}
