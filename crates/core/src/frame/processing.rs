use crate::frame::recorded::{Frame, FrameError, LARGEST_VALUE, check_size};
use crate::frame::rule::{Rule, without_small};
use crate::frame::tare::Tare;
use crate::frame::view::View;
use crate::imprint::Imprint;
use crate::matrix::Matrix;

/// The settings by which frames are processed, in the order in which they are applied.
#[derive(Clone, Debug, Default)]
pub struct Processing {
    /// The crop, flips, turns and mask.
    pub view: View,
    /// The values that are subtracted from the cells.
    pub tare: Option<Tare>,
    /// The factor of each cell.
    pub gain: Option<Matrix<f64>>,
    /// The rule that decides which taxels are active; None makes no imprint.
    pub rule: Option<Rule>,
    /// The smallest number of taxels of an 8-connected piece; smaller pieces are dropped.
    pub least: u32,
    raw: Matrix<f64>,
    tared: Matrix<f64>,
}

/// A frame and the results of its processing.
#[derive(Clone, Copy, Debug)]
pub struct Processed<'a> {
    /// The values after crop, flip, turn and mask, in the sensor's unit; NaN where there is no cell.
    pub raw: &'a Matrix<f64>,
    /// The values after tare and gain.
    pub tared: &'a Matrix<f64>,
    /// The sum of the raw values; 0 if there are none.
    pub sum: f64,
    /// The largest raw value; None if there are none.
    pub max: Option<f64>,
    /// The number of cells that have a value.
    pub cells: u32,
    /// The sum of the values after tare and gain, by which peaks are compared; NaN if no cell has a value then.
    pub tared_sum: f64,
    /// The imprint; None if there is no rule.
    pub imprint: Option<Imprint>,
}

impl Processing {
    /// Returns the values of a frame in the sensor's unit, first after crop, flip, turn and mask, then also after tare
    /// and gain; NaN where there is no cell.
    ///
    /// # Errors
    /// Returns an error if the view, the tare or the gain does not fit the frame, or if a product with the gain is too
    /// large.
    pub fn values(&mut self, frame: &Frame) -> Result<[&Matrix<f64>; 2], FrameError> {
        self.view.apply_to(frame, &mut self.raw)?;
        self.tared.reset(self.raw.size(), 0.0);
        self.tared.values_mut().copy_from_slice(self.raw.values());
        if let Some(tare) = &self.tare {
            tare.subtract_from(&mut self.tared)?;
        }
        if let Some(gain) = &self.gain {
            multiply(&mut self.tared, gain)?;
        }
        Ok([&self.raw, &self.tared])
    }

    /// Processes a frame.
    ///
    /// # Errors
    /// Returns an error if the view, the tare, the gain or the rule does not fit the frame, or if a product with the gain
    /// is too large.
    pub fn run(&mut self, frame: &Frame) -> Result<Processed<'_>, FrameError> {
        self.values(frame)?;
        let (sum, max, cells) = summary(self.raw.values());
        let (tared_sum, _, tared_cells) = if self.tare.is_none() && self.gain.is_none() {
            (sum, max, cells)
        } else {
            summary(self.tared.values())
        };
        let tared_sum = if tared_cells > 0 { tared_sum } else { f64::NAN };
        let rule = self.rule.as_ref();
        let (tare, gain) = (self.tare.as_ref(), self.gain.as_ref());
        let imprint = rule.map(|rule| rule.imprint(&self.tared, tare, gain));
        let imprint = imprint.transpose()?.map(|imprint| {
            if self.least > 1 {
                without_small(&imprint, self.least)
            } else {
                imprint
            }
        });
        Ok(Processed {
            raw: &self.raw,
            tared: &self.tared,
            sum,
            max,
            cells,
            tared_sum,
            imprint,
        })
    }
}

fn summary(values: &[f64]) -> (f64, Option<f64>, u32) {
    let (mut sum, mut max, mut cells) = (0.0, f64::NEG_INFINITY, 0);
    for &value in values {
        if !value.is_nan() {
            sum += value;
            max = max.max(value);
            cells += 1;
        }
    }
    (sum, (cells > 0).then_some(max), cells)
}

/// A product that is too large is an error, because as a missing value it would make the strongest cells inactive.
fn multiply(values: &mut Matrix<f64>, gain: &Matrix<f64>) -> Result<(), FrameError> {
    check_size("gain", gain, values)?;
    for (value, &gain) in values.values_mut().iter_mut().zip(gain.values()) {
        let product = *value * gain;
        if product.abs() > LARGEST_VALUE {
            let value = *value;
            return Err(FrameError::Product { value, gain });
        }
        *value = product;
    }
    Ok(())
}

/// The frame with the greatest sum of values so far; the first of several equal ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    best: Option<(u64, f64)>,
}

impl Peak {
    /// Compares the sum of another frame. Returns true if it is the new peak; a sum that is NaN never is.
    pub fn add(&mut self, number: u64, sum: f64) -> bool {
        let is_peak = !sum.is_nan() && self.best.is_none_or(|(_, best)| sum > best);
        if is_peak {
            self.best = Some((number, sum));
        }
        is_peak
    }

    /// Returns the number of the peak frame; None before the first frame with a sum.
    pub fn number(&self) -> Option<u64> {
        self.best.map(|(number, _)| number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{FrameSize, TareFrames};
    use crate::sensor::MatrixSize;

    #[test]
    fn sum_and_max_are_raw_and_the_imprint_is_tared() {
        let mut frame = Frame::new(FrameSize::of(2, 1));
        frame.values_mut().copy_from_slice(&[10.0, 12.0]);
        let mut processing = Processing::default();
        let raw = processing.run(&frame).expect("it fits").raw.clone();
        let mut tare = TareFrames::new(1);
        tare.add(&raw).expect("it fits");
        processing.tare = Some(tare.finish().expect("one frame"));
        let mut gain = Matrix::filled(MatrixSize::of(2, 1), 1.0);
        gain.set(1, 0, 3.0);
        processing.gain = Some(gain);
        processing.rule = Some(Rule::AtLeast(9.0));
        frame.values_mut().copy_from_slice(&[18.0, 15.0]);
        let processed = processing.run(&frame).expect("it fits");
        assert_eq!((processed.sum, processed.max), (33.0, Some(18.0)));
        assert_eq!(processed.tared.values(), [8.0, 9.0]);
        assert_eq!(processed.tared_sum, 17.0);
        let imprint = processed.imprint.map(|imprint| imprint.to_string());
        assert_eq!(imprint.as_deref(), Some(".#"));
    }

    #[test]
    fn a_frame_without_cells_has_no_maximum() {
        let mut processing = Processing {
            rule: Some(Rule::Percent(50.0)),
            ..Processing::default()
        };
        let processed = processing
            .run(&Frame::new(FrameSize::of(3, 3)))
            .expect("it fits");
        assert_eq!(
            (processed.sum, processed.max, processed.cells),
            (0.0, None, 0)
        );
        assert!(processed.imprint.is_some_and(|imprint| imprint.is_empty()));
    }

    #[test]
    fn peaks_are_compared_after_a_tare_and_after_a_gain_alone() {
        let mut frame = Frame::new(FrameSize::of(2, 1));
        frame.values_mut().copy_from_slice(&[10.0, 12.0]);
        let mut processing = Processing::default();
        let mut tare = TareFrames::new(1);
        tare.add(&Matrix::filled(MatrixSize::of(2, 1), 4.0))
            .expect("it fits");
        let mut sums = |tare: Option<Tare>, gain: Option<Matrix<f64>>| {
            (processing.tare, processing.gain) = (tare, gain);
            let processed = processing.run(&frame).expect("it fits");
            (processed.sum, processed.tared_sum)
        };
        assert_eq!(sums(None, None), (22.0, 22.0));
        assert_eq!(sums(tare.finish().ok(), None), (22.0, 14.0));
        assert_eq!(
            sums(None, Some(Matrix::filled(MatrixSize::of(2, 1), 0.5))),
            (22.0, 11.0)
        );
    }

    #[test]
    fn a_frame_whose_cells_have_no_tare_has_no_sum_to_compare() {
        let mut frame = Frame::new(FrameSize::of(2, 1));
        frame.values_mut().copy_from_slice(&[5.0, 6.0]);
        let mut tare = TareFrames::new(1);
        tare.add(&Matrix::filled(MatrixSize::of(2, 1), f64::NAN))
            .expect("it fits");
        let mut processing = Processing {
            tare: tare.finish().ok(),
            ..Processing::default()
        };
        let processed = processing.run(&frame).expect("it fits");
        assert_eq!(processed.sum, 11.0);
        assert!(processed.tared_sum.is_nan());
    }

    #[test]
    fn a_product_that_is_too_large_is_an_error() {
        let mut frame = Frame::new(FrameSize::of(3, 1));
        frame.values_mut().copy_from_slice(&[2.0, -1e299, 1e299]);
        let mut gain = Matrix::filled(MatrixSize::of(3, 1), 100.0);
        gain.set(1, 0, 1.0);
        let mut processing = Processing {
            gain: Some(gain),
            rule: Some(Rule::AtLeast(1.0)),
            ..Processing::default()
        };
        let error = processing.run(&frame).expect_err("beyond 1e300");
        let expected = "the value 1e299 times its gain 1e2 is too large, expected at most 1e300";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn a_frame_without_a_sum_is_no_peak() {
        let mut peak = Peak::default();
        assert!(!peak.add(3, f64::NAN));
        assert_eq!(peak.number(), None);
        assert!(peak.add(4, 1.0));
        assert!(!peak.add(5, f64::NAN) && !peak.add(6, 1.0));
        assert_eq!(peak.number(), Some(4));
    }
}
