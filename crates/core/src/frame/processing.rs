use crate::frame::recorded::{Frame, FrameError, LARGEST_VALUE, check_size};
use crate::frame::rule::{Rule, RuleOrigin, SetRule};
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
    /// The origin of the rule.
    pub rule_from: RuleOrigin,
    /// The smallest number of taxels of an 8-connected piece; smaller pieces are dropped.
    pub least: u32,
    raw: Matrix<f64>,
    tared: Matrix<f64>,
}

/// A frame and the results of its processing. Values are in the sensor's unit, and NaN where there is no cell.
///
/// Force, contact and centre of pressure are of the values after tare and gain in the cells of the imprint; without a
/// rule, in all cells whose value is above 0.
#[derive(Clone, Copy, Debug)]
pub struct Processed<'a> {
    /// The values after crop, flip, turn and mask.
    pub raw: &'a Matrix<f64>,
    /// The values after tare and gain.
    pub tared: &'a Matrix<f64>,
    /// The sum of the raw values; 0 if there are none.
    pub sum: f64,
    /// The largest raw value; None if there are none.
    pub max: Option<f64>,
    /// The sum of the values after tare and gain, by which peaks are compared; None if there are none.
    pub tared_sum: Option<f64>,
    /// The imprint; None if there is no rule.
    pub imprint: Option<Imprint>,
    /// The sum of the values in contact; 0 without contact.
    pub force: f64,
    /// The number of cells in contact.
    pub contact: u32,
    /// The centre of pressure: the mean of the centres of the cells in contact, weighted by their values, as x and y
    /// in cells. None if the force is 0.
    pub cop: Option<[f64; 2]>,
    /// The rule of the imprint.
    pub rule: Option<SetRule>,
    /// The number of frames of which the tare was made; 0 without a tare.
    pub tare: u64,
    /// Whether the tared values were multiplied by a gain.
    pub gain: bool,
}

impl Processing {
    /// Returns the rule with its origin.
    pub fn applied_rule(&self) -> Option<SetRule> {
        let (least, from) = (self.least, self.rule_from);
        self.rule.map(|rule| SetRule { rule, least, from })
    }

    /// Sets or removes the rule. If it is removed, the smallest size of a piece is kept for the next rule.
    pub fn apply_rule(&mut self, rule: Option<SetRule>) {
        self.rule = rule.map(|set| set.rule);
        if let Some(set) = rule {
            (self.least, self.rule_from) = (set.least, set.from);
        }
    }

    /// Returns the values of a frame in the sensor's unit, first after crop, flip, turn and mask, then also after tare
    /// and gain; NaN where there is no cell.
    ///
    /// # Errors
    /// Returns an error if the view, the tare or the gain does not fit the frame, or if a product with the gain is too
    /// large.
    pub fn values(&mut self, frame: &Frame) -> Result<[&Matrix<f64>; 2], FrameError> {
        self.view.apply_to(frame, &mut self.raw)?;
        self.tared.clone_from(&self.raw);
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
    /// Returns the errors of [`Self::values`], and an error if the rule needs a tare of two frames and there is none.
    pub fn run(&mut self, frame: &Frame) -> Result<Processed<'_>, FrameError> {
        self.values(frame)?;
        let (raw, tared) = (&self.raw, &self.tared);
        let (tare, gain) = (self.tare.as_ref(), self.gain.as_ref());
        let rule = self.rule.as_ref();
        let imprint = rule.map(|rule| rule.imprint(tared, tare, gain, self.least));
        let imprint = imprint.transpose()?;
        let [sum, tared_sum] = [raw, tared].map(sum);
        let (force, contact, cop) = contact(tared, imprint.as_ref());
        let max = raw.values().iter().copied().reduce(f64::max);
        Ok(Processed {
            raw,
            tared,
            sum: sum.unwrap_or(0.0),
            max: max.filter(|max| !max.is_nan()),
            tared_sum,
            imprint,
            force,
            contact,
            cop,
            rule: self.applied_rule(),
            tare: tare.map_or(0, |tare| tare.frames),
            gain: gain.is_some(),
        })
    }
}

/// Returns the sum of the values; None if there are none.
fn sum(values: &Matrix<f64>) -> Option<f64> {
    let values = values.values().iter().copied();
    let values = values.filter(|value| !value.is_nan());
    values.fold(None, |sum, value| Some(sum.unwrap_or(0.0) + value))
}

/// Returns the force, the number of cells in contact, and the centre of pressure.
fn contact(values: &Matrix<f64>, imprint: Option<&Imprint>) -> (f64, u32, Option<[f64; 2]>) {
    let (mut force, mut cells, mut moment) = (0.0, 0, [0.0; 2]);
    for row in 0..values.rows() {
        for (column, &value) in (0..values.columns()).zip(values.row(row)) {
            if imprint.map_or(value > 0.0, |imprint| imprint.get(column, row)) {
                force += value;
                cells += 1;
                moment[0] += value * (f64::from(column) + 0.5);
                moment[1] += value * (f64::from(row) + 0.5);
            }
        }
    }
    // Values below 0 may leave next to no force.
    let cop = moment.map(|moment| moment / force);
    let is_finite = cop.iter().all(|own| own.is_finite());
    (force, cells, is_finite.then_some(cop))
}

/// A product that is too large is an error, because as a missing value it would make the strongest cells inactive.
fn multiply(values: &mut Matrix<f64>, gain: &Matrix<f64>) -> Result<(), FrameError> {
    check_size("gain", gain.size(), values.size())?;
    for (value, &gain) in values.values_mut().iter_mut().zip(gain.values()) {
        let product = *value * gain;
        if product.abs() > LARGEST_VALUE {
            return Err(FrameError::Invalid(format!(
                "the value {value:e} times its gain {gain:e} is too large, expected at most 1e300"
            )));
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
    /// Takes the sum of another frame; a frame without one is never the peak.
    pub fn add(&mut self, number: u64, sum: Option<f64>) {
        if sum.is_some() && self.best.is_none_or(|(_, best)| sum > Some(best)) {
            self.best = sum.map(|sum| (number, sum));
        }
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

    fn frame(columns: u16, values: &[f64]) -> Frame {
        let rows = u16::try_from(values.len()).expect("few") / columns;
        Frame::from_values(FrameSize::of(columns, rows), values).expect("as many")
    }

    fn tare_of(frame: &Frame) -> Option<Tare> {
        let mut tare = TareFrames::new(1);
        tare.add(frame, &View::default()).expect("it fits");
        tare.finish().ok()
    }

    fn gain(columns: u8, values: &[f64]) -> Option<Matrix<f64>> {
        let rows = u8::try_from(values.len()).expect("few") / columns;
        Matrix::from_values(MatrixSize::of(columns, rows), values.to_vec())
    }

    #[test]
    fn sum_and_max_are_raw_and_the_imprint_is_tared() {
        let mut processing = Processing {
            tare: tare_of(&frame(2, &[10.0, 12.0])),
            gain: gain(2, &[1.0, 3.0]),
            rule: Some(Rule::AtLeast(9.0)),
            ..Processing::default()
        };
        let touched = frame(2, &[18.0, 15.0]);
        let processed = processing.run(&touched).expect("it fits");
        assert_eq!((processed.sum, processed.max), (33.0, Some(18.0)));
        assert_eq!(processed.tared.values(), [8.0, 9.0]);
        assert_eq!(processed.tared_sum, Some(17.0));
        let imprint = processed.imprint.map(|imprint| imprint.to_string());
        assert_eq!(imprint.as_deref(), Some(".#"));
        assert_eq!((processed.force, processed.contact), (9.0, 1));
        assert_eq!(processed.cop, Some([1.5, 0.5]));
    }

    #[test]
    fn a_frame_without_cells_has_no_maximum_and_no_force() {
        let mut processing = Processing {
            rule: Some(Rule::Percent(50.0)),
            ..Processing::default()
        };
        let empty = Frame::new(FrameSize::of(3, 3));
        let processed = processing.run(&empty).expect("it fits");
        assert_eq!((processed.sum, processed.max), (0.0, None));
        assert!(processed.imprint.is_some_and(|imprint| imprint.is_empty()));
        let (force, contact) = (processed.force, processed.contact);
        assert_eq!((force, contact, processed.cop), (0.0, 0, None));
    }

    /// The second method: whole numbers, so that sums are exact, and a centre from the sums of columns and rows.
    #[test]
    fn force_contact_and_centre_equal_those_of_the_margins() {
        let mut state = 9_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            i32::try_from(state >> 59).expect("five bits")
        };
        for threshold in [None, Some(20_i32), Some(-3)] {
            let cells: Vec<[i32; 2]> = (0..35).map(|_| [next(), next()]).collect();
            let of = |side: usize| -> Vec<f64> {
                cells.iter().map(|cell| f64::from(cell[side])).collect()
            };
            let mut touched = frame(7, &of(0));
            touched.values_mut()[17] = f64::NAN;
            let mut processing = Processing {
                tare: tare_of(&frame(7, &of(1))),
                gain: gain(7, &[2.0; 35]),
                rule: threshold.map(|own| Rule::AtLeast(f64::from(own))),
                ..Processing::default()
            };
            let processed = processing.run(&touched).expect("it fits");
            let (mut columns, mut rows, mut contact) = ([0; 7], [0; 5], 0);
            for (index, [value, rest]) in cells.into_iter().enumerate() {
                let value = 2 * (value - rest);
                let counts = threshold.map_or(value > 0, |threshold| value >= threshold);
                if index != 17 && counts {
                    columns[index % 7] += value;
                    rows[index / 7] += value;
                    contact += 1;
                }
            }
            let centre = |margin: &[i32]| {
                let moment: i32 = (1..).step_by(2).zip(margin).map(|(x, sum)| x * sum).sum();
                f64::from(moment) / f64::from(2 * margin.iter().sum::<i32>())
            };
            assert_eq!(processed.force, f64::from(columns.iter().sum::<i32>()));
            assert_eq!(processed.contact, contact);
            let [x, y] = processed.cop.expect("a force");
            let apart = (x - centre(&columns)).abs().max((y - centre(&rows)).abs());
            assert!(apart < 1e-12, "{apart}");
        }
    }

    #[test]
    fn a_force_of_zero_has_no_centre() {
        let mut processing = Processing {
            rule: Some(Rule::AtLeast(-5.0)),
            ..Processing::default()
        };
        let balanced = frame(2, &[4.0, -4.0]);
        let processed = processing.run(&balanced).expect("it fits");
        let (force, contact) = (processed.force, processed.contact);
        assert_eq!((force, contact, processed.cop), (0.0, 2, None));
    }

    #[test]
    fn peaks_are_compared_after_a_tare_and_after_a_gain_alone() {
        let touched = frame(2, &[10.0, 12.0]);
        let mut processing = Processing::default();
        let mut sums = |tare: Option<Tare>, gain: Option<Matrix<f64>>| {
            (processing.tare, processing.gain) = (tare, gain);
            let processed = processing.run(&touched).expect("it fits");
            (processed.sum, processed.tared_sum)
        };
        assert_eq!(sums(None, None), (22.0, Some(22.0)));
        assert_eq!(
            sums(tare_of(&frame(2, &[4.0; 2])), None),
            (22.0, Some(14.0))
        );
        assert_eq!(sums(None, gain(2, &[0.5; 2])), (22.0, Some(11.0)));
        // Cells without a tare have no sum to compare.
        assert_eq!(sums(tare_of(&frame(2, &[f64::NAN; 2])), None), (22.0, None));
    }

    #[test]
    fn a_product_that_is_too_large_is_an_error() {
        let mut processing = Processing {
            gain: gain(3, &[100.0, 1.0, 100.0]),
            ..Processing::default()
        };
        let error = processing.run(&frame(3, &[2.0, -1e299, 1e299]));
        let expected = "the value 1e299 times its gain 1e2 is too large, expected at most 1e300";
        assert_eq!(error.expect_err("beyond 1e300").to_string(), expected);
    }

    #[test]
    fn a_removed_rule_leaves_the_smallest_size_of_a_piece() {
        let mut processing = Processing::default();
        let rule = SetRule {
            rule: Rule::AtLeast(2.0),
            least: 3,
            from: RuleOrigin::Key,
        };
        processing.apply_rule(Some(rule));
        assert_eq!(processing.applied_rule(), Some(rule));
        processing.apply_rule(None);
        assert_eq!((processing.rule, processing.least), (None, 3));
    }

    #[test]
    fn a_frame_without_a_sum_is_no_peak() {
        let mut peak = Peak::default();
        for (number, sum, expected) in [
            (3, None, None),
            (4, Some(-1.0), Some(4)),
            (5, None, Some(4)),
            (6, Some(-1.0), Some(4)),
            (7, Some(1.0), Some(7)),
        ] {
            peak.add(number, sum);
            assert_eq!(peak.number(), expected);
        }
    }
}
