//! A raw frame: the values of all cells at one moment, before any processing.

use crate::frame::error::FrameError;

/// The largest number of columns, and of rows, of a frame before it is cropped.
pub const MAX_FRAME_SIDE: u16 = 512;

/// The largest value that a cell may have; the smallest is minus that. So sums of a frame are always finite.
pub const LARGEST_VALUE: f64 = 1e300;

/// The values of a sensor's cells at one moment, in the sensor's unit.
///
/// Readers and decoders reuse the same frame, so nothing is allocated per frame.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Its number in its channel, from 0.
    pub number: u64,
    /// The number of its channel (one of several sensors), from 0.
    pub channel: usize,
    /// The recording's own label for it, if it has one.
    pub label: Option<i64>,
    /// Seconds since the start of the recording, if known. Times may repeat and go back.
    pub time: Option<f64>,
    /// The row and column of the whole sensor at which the frame begins, as the recording counts them, if it states
    /// them.
    pub first: Option<(u32, u32)>,
    columns: u16,
    rows: u16,
    values: Vec<f64>,
}

impl Frame {
    /// Creates a frame of cells without values. Sides are clamped to 1 to 512.
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

    /// Creates a frame from the values of its cells, row by row; NaN where the sensor has no cell. A value that is infinite or
    /// beyond [`LARGEST_VALUE`] counts as none.
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
    /// If a side is not 1 to 512, or the number of values is not that of the cells.
    pub fn from_values(columns: u16, rows: u16, values: &[f64]) -> Result<Self, FrameError> {
        let mut frame = Self::new(columns, rows);
        if (frame.columns, frame.rows) != (columns, rows) {
            return Err(FrameError::Sides { columns, rows });
        }
        frame.set_values(values)?;
        Ok(frame)
    }

    /// Changes the values of all cells, row by row; number, channel, label and time stay. It does not allocate.
    ///
    /// # Errors
    /// If the number of values is not that of the cells; then nothing is changed.
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

    /// Changes the size and empties all cells; number, channel, label and time stay. It allocates only if there are
    /// more cells than ever before.
    pub fn reset(&mut self, columns: u16, rows: u16) {
        self.columns = columns.clamp(1, MAX_FRAME_SIDE);
        self.rows = rows.clamp(1, MAX_FRAME_SIDE);
        self.values.clear();
        let cells = usize::from(self.columns) * usize::from(self.rows);
        self.values.resize(cells, f64::NAN);
    }

    /// Makes this frame a copy of another one, reusing its memory.
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

    /// Number of columns.
    pub fn columns(&self) -> u16 {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> u16 {
        self.rows
    }

    /// The values row by row; NaN where the sensor has no cell.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The same, mutable. A value that is infinite or beyond [`LARGEST_VALUE`] counts as none.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Number of cells that have a value.
    pub fn cells(&self) -> usize {
        let is_value = |value: &&f64| value.abs() <= LARGEST_VALUE;
        self.values.iter().filter(is_value).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_has_all_that_the_frame_has() {
        let mut frame = Frame::new(2, 1);
        frame.values_mut().copy_from_slice(&[1.0, 2.0]);
        (frame.number, frame.channel, frame.label) = (3, 4, Some(5));
        (frame.time, frame.first) = (Some(0.5), Some((6, 7)));
        let mut copy = Frame::new(5, 5);
        copy.copy_from(&frame);
        assert_eq!(format!("{copy:?}"), format!("{frame:?}"));
    }
}
