//! A frame as it comes: the values of all cells at one moment, before anything is done with them.

/// The largest number of columns, and of rows, of a frame before it is cropped.
pub const MAX_FRAME_SIDE: u16 = 512;

/// The largest value that a cell may have, and minus that the smallest: sums of a frame are finite then.
pub const LARGEST_VALUE: f64 = 1e300;

/// The values of a sensor's cells at one moment, in the sensor's unit.
///
/// Readers and decoders fill the same frame again and again, so nothing is allocated per frame.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Its number in its channel, from 0.
    pub number: u64,
    /// The number of its channel (a sensor of several), from 0.
    pub channel: usize,
    /// What the recording itself calls it, where it does.
    pub label: Option<i64>,
    /// Seconds since the start of the recording, where they are known. Times may repeat and go back.
    pub time: Option<f64>,
    /// The row and column of the whole sensor where the frame begins, as the recording counts them, where it says so.
    pub first: Option<(u32, u32)>,
    columns: u16,
    rows: u16,
    values: Vec<f64>,
}

impl Frame {
    /// Creates a frame of cells without values. Sides beyond 1 to 512 are brought to the nearest of these.
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

    /// Changes the size and empties all cells; number, channel, label and time stay. Memory is only taken for more cells
    /// than there have been.
    pub fn reset(&mut self, columns: u16, rows: u16) {
        self.columns = columns.clamp(1, MAX_FRAME_SIDE);
        self.rows = rows.clamp(1, MAX_FRAME_SIDE);
        self.values.clear();
        let cells = usize::from(self.columns) * usize::from(self.rows);
        self.values.resize(cells, f64::NAN);
    }

    /// Makes this frame a copy of another one, in the memory that it has.
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

    /// The same, to be changed. A value that is infinite or beyond [`LARGEST_VALUE`] counts as none.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Number of cells that have a value.
    pub fn cells(&self) -> usize {
        self.values.iter().filter(|value| !value.is_nan()).count()
    }
}
