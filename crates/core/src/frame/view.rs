use crate::frame::recorded::{Frame, FrameError, FrameSize, LARGEST_VALUE};
use crate::imprint::Imprint;
use crate::matrix::Matrix;
use crate::sensor::MatrixSize;

/// A rectangle of whole cells of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Crop {
    /// The first column, from 0.
    pub left: u16,
    /// The first row, from 0.
    pub top: u16,
    /// The number of columns.
    pub columns: u16,
    /// The number of rows.
    pub rows: u16,
}

/// The crop, flips, turns and mask of a frame, applied in this order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct View {
    /// The part to keep; None keeps the whole frame.
    pub crop: Option<Crop>,
    /// Whether the columns are reversed: the left one becomes the right one.
    pub flip_x: bool,
    /// Whether the rows are reversed.
    pub flip_y: bool,
    /// The number of quarter turns clockwise as seen. Four are the same as none.
    pub quarter_turns: u8,
    /// The mask of dead cells: a cell that is active in it has no value. It has the size of the cropped and turned
    /// frame.
    pub mask: Option<Imprint>,
}

impl View {
    /// Writes the visible part of a frame into a matrix, which takes its size. Values that are infinite or beyond
    /// ±[`LARGEST_VALUE`] become NaN.
    ///
    /// # Errors
    /// Returns an error if the crop reaches beyond the frame, more than 64 × 64 cells are left, or the mask is of
    /// another size.
    pub fn apply_to(&self, frame: &Frame, seen: &mut Matrix<f64>) -> Result<(), FrameError> {
        let crop = self.part(frame.size())?;
        let left = matrix_size(FrameSize::new(crop.columns, crop.rows)?)?;
        let size = if self.keeps_sides() {
            left
        } else {
            left.transposed()
        };
        seen.reset(size, f64::NAN);
        self.copy(frame, crop, left, seen);
        self.apply_mask(seen)
    }

    /// Returns the size of the visible part of a frame of size `frame`. It may be larger than a matrix can be.
    ///
    /// # Errors
    /// Returns an error if the crop reaches beyond the frame.
    pub fn size(&self, frame: FrameSize) -> Result<FrameSize, FrameError> {
        let Crop { columns, rows, .. } = self.part(frame)?;
        if self.keeps_sides() {
            Ok(FrameSize::new(columns, rows)?)
        } else {
            Ok(FrameSize::new(rows, columns)?)
        }
    }

    fn keeps_sides(&self) -> bool {
        self.quarter_turns.is_multiple_of(2)
    }

    /// The part of a frame that is kept; an error if it has no cells or reaches beyond the frame.
    fn part(&self, frame: FrameSize) -> Result<Crop, FrameError> {
        let whole = Crop {
            left: 0,
            top: 0,
            columns: frame.columns(),
            rows: frame.rows(),
        };
        let crop = self.crop.unwrap_or(whole);
        let fits = |start: u16, length: u16, all: u16| {
            length > 0 && u32::from(start) + u32::from(length) <= u32::from(all)
        };
        if fits(crop.left, crop.columns, frame.columns()) && fits(crop.top, crop.rows, frame.rows())
        {
            Ok(crop)
        } else {
            Err(FrameError::Crop { size: frame })
        }
    }

    fn copy(&self, frame: &Frame, crop: Crop, left: MatrixSize, seen: &mut Matrix<f64>) {
        let columns = left.columns();
        let width = usize::from(frame.columns());
        let from = usize::from(crop.top) * width + usize::from(crop.left);
        let plain = self.quarter_turns.is_multiple_of(4) && !self.flip_x && !self.flip_y;
        for row in 0..left.rows() {
            let start = from + usize::from(row) * width;
            let values = &frame.values()[start..start + usize::from(columns)];
            if plain {
                let to = usize::from(row) * usize::from(columns);
                seen.values_mut()[to..to + usize::from(columns)].copy_from_slice(values);
                continue;
            }
            for (column, &value) in (0..columns).zip(values) {
                let (x, y) = self.position(column, row, left);
                seen.set(x, y, value);
            }
        }
        for value in seen.values_mut() {
            if value.abs() > LARGEST_VALUE {
                *value = f64::NAN;
            }
        }
    }

    /// Returns the cell of the visible part that a cell of the cropped frame becomes.
    fn position(&self, column: u8, row: u8, left: MatrixSize) -> (u8, u8) {
        let (last_column, last_row) = (left.columns() - 1, left.rows() - 1);
        let x = if self.flip_x {
            last_column - column
        } else {
            column
        };
        let y = if self.flip_y { last_row - row } else { row };
        match self.quarter_turns % 4 {
            0 => (x, y),
            1 => (last_row - y, x),
            2 => (last_column - x, last_row - y),
            _ => (y, last_column - x),
        }
    }

    fn apply_mask(&self, seen: &mut Matrix<f64>) -> Result<(), FrameError> {
        let Some(mask) = &self.mask else {
            return Ok(());
        };
        let (found, expected) = (mask.size(), seen.size());
        if found != expected {
            return Err(FrameError::Size {
                what: "mask",
                found,
                expected,
            });
        }
        for (column, row) in mask.active() {
            seen.set(column, row, f64::NAN);
        }
        Ok(())
    }
}

/// The size of the visible part of a frame as that of a matrix; an error if it is too large.
fn matrix_size(left: FrameSize) -> Result<MatrixSize, FrameError> {
    MatrixSize::of_sides(left.columns(), left.rows()).ok_or(FrameError::Large { size: left })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(view: &View) -> Result<String, FrameError> {
        let mut frame = Frame::new(FrameSize::of(3, 2));
        frame
            .values_mut()
            .copy_from_slice(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let mut seen = Matrix::default();
        view.apply_to(&frame, &mut seen)?;
        let row = |row| {
            seen.row(row)
                .iter()
                .map(ToString::to_string)
                .collect::<String>()
        };
        Ok((0..seen.rows()).map(row).collect::<Vec<_>>().join("/"))
    }

    #[test]
    fn a_view_crops_then_flips_then_turns_clockwise() {
        let view = View::default();
        assert_eq!(seen(&view).as_deref(), Ok("123/456"));
        let turned = |quarter_turns| View {
            quarter_turns,
            ..View::default()
        };
        assert_eq!(seen(&turned(1)).as_deref(), Ok("41/52/63"));
        assert_eq!(seen(&turned(2)).as_deref(), Ok("654/321"));
        assert_eq!(seen(&turned(3)).as_deref(), Ok("36/25/14"));
        let view = View {
            crop: Some(Crop {
                left: 1,
                top: 0,
                columns: 2,
                rows: 2,
            }),
            flip_x: true,
            ..turned(1)
        };
        assert_eq!(seen(&view).as_deref(), Ok("63/52"));
        let flipped = View {
            flip_y: true,
            ..View::default()
        };
        assert_eq!(seen(&flipped).as_deref(), Ok("456/123"));
    }

    #[test]
    fn a_mask_is_applied_last_and_must_fit() {
        let mask = |rows: &str| View {
            quarter_turns: 1,
            mask: rows.parse().ok(),
            ..View::default()
        };
        assert_eq!(seen(&mask("#.\n..\n..")).as_deref(), Ok("NaN1/52/63"));
        let wrong = seen(&mask("#..")).map_err(|error| error.to_string());
        assert_eq!(
            wrong,
            Err("the mask has 3 columns and 1 row, expected 2 and 3 as the frame has".to_owned())
        );
    }

    #[test]
    fn a_crop_leaves_at_most_64_cells_a_side() {
        let mut matrix = Matrix::default();
        let frame = Frame::new(FrameSize::of(65, 2));
        let large = View::default().apply_to(&frame, &mut matrix);
        assert_eq!(
            large,
            Err(FrameError::Large {
                size: FrameSize::of(65, 2)
            })
        );
        let crop = |left, columns| View {
            crop: Some(Crop {
                left,
                top: 0,
                columns,
                rows: 2,
            }),
            ..View::default()
        };
        assert_eq!(crop(1, 64).apply_to(&frame, &mut matrix), Ok(()));
        assert!(matches!(
            crop(2, 64).apply_to(&frame, &mut matrix),
            Err(FrameError::Crop { .. })
        ));
    }

    #[test]
    fn a_crop_keeps_at_least_one_cell() {
        let crop = |columns, rows| View {
            crop: Some(Crop {
                left: 2,
                top: 1,
                columns,
                rows,
            }),
            ..View::default()
        };
        assert_eq!(seen(&crop(1, 1)).as_deref(), Ok("6"));
        let refused = Err(FrameError::Crop {
            size: FrameSize::of(3, 2),
        });
        assert_eq!(
            (seen(&crop(0, 1)), seen(&crop(1, 0))),
            (refused.clone(), refused)
        );
    }
}
