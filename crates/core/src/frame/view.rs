use crate::frame::recorded::{Frame, FrameError, FrameSize, LARGEST_VALUE, check_size};
use crate::imprint::Imprint;
use crate::matrix::Matrix;
use crate::parameter::number::counted;
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
        let (crop, left) = self.part(frame.size())?;
        let size = MatrixSize::of_sides(left.columns(), left.rows()).ok_or_else(|| {
            let text = format!("{left} cells are left, expected at most 64 × 64: crop the frame");
            FrameError::Size(text)
        })?;
        // A turn swaps columns and rows, and reverses those that a flip alone would not.
        let turns = self.quarter_turns % 4;
        let (column, across) = walk(crop.left, crop.columns, self.flip_x != (turns >= 2));
        let (row, down) = walk(crop.top, crop.rows, self.flip_y != matches!(turns, 1 | 2));
        let width = usize::from(frame.columns());
        let (mut start, down) = (row * width + column, down.wrapping_mul(width));
        let (next, next_row) = match turns % 2 {
            0 => (across, down),
            _ => (down, across),
        };
        seen.reset(size, f64::NAN);
        for line in seen.values_mut().chunks_mut(size.columns().into()) {
            let mut index = start;
            for slot in line {
                let value = frame.values()[index];
                if value.abs() <= LARGEST_VALUE {
                    *slot = value;
                }
                index = index.wrapping_add(next);
            }
            start = start.wrapping_add(next_row);
        }
        if let Some(mask) = &self.mask {
            check_size("mask", mask.size(), size)?;
            for (column, row) in mask.active() {
                seen.set(column, row, f64::NAN);
            }
        }
        Ok(())
    }

    /// Returns the size of the visible part of a frame of size `frame`. It may be larger than a matrix can be.
    ///
    /// # Errors
    /// Returns an error if the crop reaches beyond the frame.
    pub fn size(&self, frame: FrameSize) -> Result<FrameSize, FrameError> {
        self.part(frame).map(|(_, size)| size)
    }

    /// The part of a frame that is kept, and its size after the turn; an error if it has no cells or reaches beyond the
    /// frame.
    fn part(&self, frame: FrameSize) -> Result<(Crop, FrameSize), FrameError> {
        let crop = self.crop.unwrap_or(Crop {
            left: 0,
            top: 0,
            columns: frame.columns(),
            rows: frame.rows(),
        });
        let fits = |start: u16, length: u16, all: u16| {
            length > 0 && u32::from(start) + u32::from(length) <= u32::from(all)
        };
        if fits(crop.left, crop.columns, frame.columns()) && fits(crop.top, crop.rows, frame.rows())
        {
            let size = match self.quarter_turns % 2 {
                0 => FrameSize::new(crop.columns, crop.rows)?,
                _ => FrameSize::new(crop.rows, crop.columns)?,
            };
            return Ok((crop, size));
        }
        let columns = counted(frame.columns(), "column");
        let rows = counted(frame.rows(), "row");
        Err(FrameError::Size(format!(
            "the crop reaches beyond the frame, which has {columns} and {rows}"
        )))
    }
}

/// Returns the first of some columns or rows, and the step to the next; a step back wraps around.
fn walk(first: u16, count: u16, is_reversed: bool) -> (usize, usize) {
    if is_reversed {
        (usize::from(first) + usize::from(count) - 1, usize::MAX)
    } else {
        (first.into(), 1)
    }
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
        assert!(large.is_err_and(|error| error.to_string().starts_with("65 × 2 cells are left")));
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
            Err(FrameError::Size(_))
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
        assert!(seen(&crop(0, 1)).is_err() && seen(&crop(1, 0)).is_err());
    }
}
