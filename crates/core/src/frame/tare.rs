use crate::frame::recorded::{Frame, FrameError, LARGEST_VALUE, check_size};
use crate::frame::view::View;
use crate::matrix::Matrix;
use crate::sensor::MatrixSize;

const MAX_VALUES: u64 = 1 << 25;

/// The standard deviation of the normal distribution divided by its median absolute deviation.
const MAD_TO_DEVIATION: f64 = 1.4826;

/// The frames from which a tare is made.
#[derive(Clone, Debug)]
pub struct TareFrames {
    wanted: u64,
    size: Option<MatrixSize>,
    values: Vec<f64>,
    frames: u64,
    visible: Matrix<f64>,
}

impl TareFrames {
    /// Creates an empty set that needs `wanted` frames, at least one.
    pub fn new(wanted: u64) -> Self {
        Self {
            wanted: wanted.max(1),
            size: None,
            values: Vec::new(),
            frames: 0,
            visible: Matrix::default(),
        }
    }

    /// Returns the number of frames that the tare needs.
    pub fn wanted(&self) -> u64 {
        self.wanted
    }

    /// Returns the number of frames that are still missing.
    pub fn missing(&self) -> u64 {
        self.wanted - self.frames
    }

    /// Checks that the needed number of frames fits into memory if each has this number of values.
    ///
    /// # Errors
    /// Returns [`FrameError::TareSize`] if they take too much memory.
    pub fn check_memory(&self, values: usize) -> Result<(), FrameError> {
        let values = values as u64;
        if self.wanted.saturating_mul(values) > MAX_VALUES {
            let most = MAX_VALUES / values.max(1);
            return Err(FrameError::TareSize { most });
        }
        Ok(())
    }

    /// Adds a frame, in the sensor's unit; does nothing if there are enough. A value that is infinite or beyond
    /// ±[`LARGEST_VALUE`] counts as missing, like NaN.
    ///
    /// # Errors
    /// Returns an error if the frame differs in size from the first one, or if the needed number of frames of this size
    /// takes too much memory.
    pub fn add(&mut self, frame: &Matrix<f64>) -> Result<(), FrameError> {
        if self.missing() == 0 {
            return Ok(());
        }
        self.check(frame)?;
        self.size = Some(frame.size());
        let values = frame.values().iter();
        let known = values.map(|&value| if is_value(value) { value } else { f64::NAN });
        self.values.extend(known);
        self.frames += 1;
        Ok(())
    }

    /// Checks that a frame can be added, with the errors of [`Self::add`].
    fn check(&self, frame: &Matrix<f64>) -> Result<(), FrameError> {
        let size = frame.size();
        if let Some(found) = self.size.filter(|&found| found != size) {
            return Err(FrameError::Size {
                what: "tare",
                found,
                expected: size,
            });
        }
        self.check_memory(frame.values().len())
    }

    /// Adds the part of a frame that a view shows, like [`Self::add`].
    ///
    /// # Errors
    /// Returns the errors of [`Self::add`], and an error if the view does not fit the frame.
    pub fn add_frame(&mut self, frame: &Frame, view: &View) -> Result<(), FrameError> {
        self.with_visible(frame, view, Self::add)
    }

    /// Checks that a frame can be added, with the errors of [`Self::add_frame`].
    pub(super) fn check_frame(&mut self, frame: &Frame, view: &View) -> Result<(), FrameError> {
        self.with_visible(frame, view, |tare, visible| tare.check(visible))
    }

    fn with_visible(
        &mut self,
        frame: &Frame,
        view: &View,
        does: impl FnOnce(&mut Self, &Matrix<f64>) -> Result<(), FrameError>,
    ) -> Result<(), FrameError> {
        let mut visible = std::mem::take(&mut self.visible);
        let done = view
            .apply_to(frame, &mut visible)
            .and_then(|()| does(self, &visible));
        self.visible = visible;
        done
    }

    pub(super) fn frames(&self) -> u64 {
        self.frames
    }

    /// Computes the tare.
    ///
    /// # Errors
    /// Returns an error if frames are missing.
    pub fn finish(self) -> Result<Tare, FrameError> {
        let (frames, wanted) = (self.frames, self.wanted);
        let (Some(size), true) = (self.size, frames == wanted) else {
            return Err(FrameError::Tare { frames, wanted });
        };
        let mut baseline = Matrix::filled(size, f64::NAN);
        let mut deviation = baseline.clone();
        let cells = baseline.values().len();
        let mut present = Vec::new();
        for cell in 0..cells {
            present.clear();
            let values = self.values.iter().skip(cell).step_by(cells);
            present.extend(values.filter(|value| !value.is_nan()));
            let middle = median(&mut present);
            for value in &mut present {
                *value = (*value - middle).abs();
            }
            baseline.values_mut()[cell] = middle;
            deviation.values_mut()[cell] = median(&mut present);
        }
        Ok(Tare {
            baseline,
            deviation,
            step: step(self.values),
            frames,
        })
    }
}

/// Returns true if a number is a value; false for NaN and for what may become infinite.
fn is_value(value: f64) -> bool {
    value.abs() <= LARGEST_VALUE
}

/// Returns the median: the middle value, or the mean of the two middle ones if their number is even; NaN without
/// values.
fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values {
        [] => f64::NAN,
        _ if values.len() % 2 == 1 => values[middle],
        _ => f64::midpoint(values[middle - 1], values[middle]),
    }
}

/// Returns the smallest difference between two values that are not equal; None if all are equal.
fn step(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|value| !value.is_nan());
    values.sort_unstable_by(f64::total_cmp);
    let differences = values.windows(2).map(|pair| pair[1] - pair[0]);
    differences
        .filter(|&difference| difference > 0.0)
        .min_by(f64::total_cmp)
}

/// The values that are subtracted from the cells, and their noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Tare {
    baseline: Matrix<f64>,
    deviation: Matrix<f64>,
    step: Option<f64>,
    frames: u64,
}

impl Tare {
    /// Returns the median of each cell, in the sensor's unit; NaN where a cell never had a value.
    pub fn baseline(&self) -> &Matrix<f64> {
        &self.baseline
    }

    /// Rebuilds a tare from the median of each cell, the median absolute deviation of each cell, and the step of the
    /// values, all in the sensor's unit; NaN where a cell never had a value. The deviation defaults to 0 and the step
    /// to 1. The number of frames is at least 1; 0 counts as 1.
    ///
    /// # Errors
    /// Returns an error if the sizes differ, if a median is infinite or beyond ±[`LARGEST_VALUE`], if a deviation is
    /// below 0 or infinite, or if the step is not above 0 and finite.
    pub fn from_parts(
        baseline: Matrix<f64>,
        deviation: Option<Matrix<f64>>,
        step: Option<f64>,
        frames: u64,
    ) -> Result<Self, FrameError> {
        let deviation = deviation.unwrap_or_else(|| Matrix::filled(baseline.size(), 0.0));
        check_size("tare", &deviation, &baseline)?;
        let check = |what, values: &[f64], fits: fn(f64) -> bool, allowed| {
            let wrong = values.iter().find(|&&value| !fits(value));
            wrong.map_or(Ok(()), |&found| {
                Err(FrameError::Rule {
                    what,
                    found,
                    allowed,
                })
            })
        };
        let fits = |value: f64| value.is_nan() || is_value(value);
        check("tare", baseline.values(), fits, "-1e300 to 1e300")?;
        let fits = |value: f64| value.is_nan() || (0.0..f64::INFINITY).contains(&value);
        check("tare_spread", deviation.values(), fits, "0 or more")?;
        let fits = |value: f64| value > 0.0 && value < f64::INFINITY;
        check("tare_step", step.as_slice(), fits, "above 0")?;
        Ok(Self {
            baseline,
            deviation,
            step,
            frames: frames.max(1),
        })
    }

    /// Returns the median absolute deviation of each cell, in the sensor's unit; NaN where a cell never had a value.
    pub fn median_absolute_deviation(&self) -> &Matrix<f64> {
        &self.deviation
    }

    /// Returns the step of the values, in the sensor's unit: the smallest difference between two of them. None if all
    /// are equal, so that nothing shows it; then it counts as 1, which is too coarse if the sensor sends fractions.
    pub fn step(&self) -> Option<f64> {
        self.step
    }

    /// Returns the number of frames from which the tare was made.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Returns how far the tared value of a cell must exceed 0 to stand out from the noise: `k` standard deviations,
    /// estimated from the median absolute deviation, but at least one step of the values.
    pub(crate) fn margin(&self, index: usize, k: f64) -> f64 {
        let deviation = self.deviation.values()[index];
        (k * MAD_TO_DEVIATION * deviation).max(self.step.unwrap_or(1.0))
    }

    /// Subtracts the tare from the values.
    ///
    /// # Errors
    /// Returns an error if the values are of another size.
    pub fn subtract_from(&self, values: &mut Matrix<f64>) -> Result<(), FrameError> {
        check_size("tare", &self.baseline, values)?;
        for (value, baseline) in values.values_mut().iter_mut().zip(self.baseline.values()) {
            *value -= baseline;
        }
        Ok(())
    }
}

/// The first frames of a source. A frame of another size is left out. If successive frames of one other size are more
/// than those so far, the tare begins again with them: the very first frame was cut, or the sensor was set up anew. So
/// a tare ends soon after a change of the size, too.
#[derive(Clone, Debug)]
pub struct FirstFrames {
    frames: TareFrames,
    other: Option<TareFrames>,
}

impl FirstFrames {
    /// Begins a tare of `wanted` frames, at least one.
    pub fn new(wanted: u64) -> Self {
        Self {
            frames: TareFrames::new(wanted),
            other: None,
        }
    }

    /// Returns the number of frames that the tare needs.
    pub fn wanted(&self) -> u64 {
        self.frames.wanted()
    }

    /// Returns the number of frames that are still missing.
    pub fn missing(&self) -> u64 {
        self.frames.missing()
    }

    /// Checks that the needed number of frames of this size fits into memory.
    ///
    /// # Errors
    /// Returns [`FrameError::TareSize`] if it does not.
    pub fn check_memory(&self, values: usize) -> Result<(), FrameError> {
        self.frames.check_memory(values)
    }

    /// Returns why a frame is not in the tare, as far as it is made; None if it fits.
    pub fn refusal(&mut self, frame: &Frame, view: &View) -> Option<FrameError> {
        self.frames.check_frame(frame, view).err()
    }

    /// Returns how many of the last frames were left out, but are in the tare if it begins again with more of them.
    pub fn others(&self) -> u64 {
        self.other.as_ref().map_or(0, TareFrames::frames)
    }

    /// Adds the part of a frame that a view shows. Returns false if the tare begins again with it and the frames of its
    /// size just before it: those that were added before are not in the tare. After an error of its size, the frame is
    /// left out.
    ///
    /// # Errors
    /// Returns the errors of [`TareFrames::add_frame`].
    pub fn add(&mut self, frame: &Frame, view: &View) -> Result<bool, FrameError> {
        let added = self.frames.add_frame(frame, view);
        let other = self.other.take();
        let Err(error) = added else {
            return Ok(true);
        };
        if !error.is_of_size() {
            return Err(error);
        }
        let wanted = self.wanted();
        let fresh = || TareFrames::new(wanted);
        let mut sets = other.into_iter().chain(std::iter::once_with(fresh));
        self.other = sets.find_map(|mut set| set.add_frame(frame, view).is_ok().then_some(set));
        let missing = self.missing();
        match self.other.take_if(|other| other.missing() < missing) {
            Some(frames) => {
                self.frames = frames;
                Ok(false)
            }
            None => Err(error),
        }
    }

    /// Computes the tare.
    ///
    /// # Errors
    /// Returns an error if frames are missing.
    pub fn finish(self) -> Result<Tare, FrameError> {
        self.frames.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameSize;

    fn tare(frames: &[[f64; 2]]) -> Result<Tare, FrameError> {
        let mut tare = TareFrames::new(frames.len() as u64);
        for frame in frames {
            let mut matrix = Matrix::filled(MatrixSize::of(2, 1), 0.0);
            matrix.values_mut().copy_from_slice(frame);
            tare.add(&matrix)?;
        }
        tare.finish()
    }

    #[test]
    fn the_median_ignores_missing_values() {
        let tare = tare(&[[1.0, f64::NAN], [4.0, 7.0], [3.0, 9.0], [10.0, f64::NAN]]);
        let tare = tare.expect("four frames");
        assert_eq!(tare.baseline().values(), [3.5, 8.0]);
        // Deviations 2.5, 0.5, 0.5, 6.5 and 1, 1; the values are 1, 3, 4, 7, 9, 10.
        assert_eq!(tare.margin(0, 2.0), 2.0 * MAD_TO_DEVIATION * 1.5);
        assert_eq!(tare.margin(1, 0.1), 1.0);
        let mut values = Matrix::filled(MatrixSize::of(2, 1), 10.0);
        tare.subtract_from(&mut values).expect("of its size");
        assert_eq!(values.values(), [6.5, 2.0]);
    }

    #[test]
    fn a_step_needs_two_different_values() {
        let rest = |frames: &[[f64; 2]]| tare(frames).expect("all frames").step();
        assert_eq!(rest(&[[7.25, 7.25], [7.25, f64::NAN]]), None);
        assert_eq!(rest(&[[7.25, 7.5], [7.25, 7.5]]), Some(0.25));
        assert_eq!(rest(&[[7.0, 7.0], [8.0, 8.0]]), Some(1.0));
        // The medians do not show the single other value.
        assert_eq!(rest(&[[7.0, 7.0], [7.0, 7.0], [7.5, 7.0]]), Some(0.5));
    }

    #[test]
    fn a_tare_needs_all_its_frames_and_enough_memory() {
        let few = TareFrames::new(3).finish();
        assert_eq!(
            few.map_err(|error| error.to_string()),
            Err("the tare needs 3 frames, but there are only 0".to_owned())
        );
        let many = TareFrames::new(1 << 40).add(&Matrix::filled(MatrixSize::of(64, 64), 0.0));
        assert_eq!(many, Err(FrameError::TareSize { most: 8192 }));
    }

    #[test]
    fn a_tare_may_have_the_largest_number_of_frames_that_the_error_names() {
        assert_eq!(TareFrames::new(8192).check_memory(64 * 64), Ok(()));
        let longer = TareFrames::new(8193).check_memory(64 * 64);
        assert_eq!(longer, Err(FrameError::TareSize { most: 8192 }));
    }

    #[test]
    fn only_the_visible_part_of_a_frame_is_added() {
        let mut frame = Frame::new(FrameSize::of(3, 1));
        frame.values_mut().copy_from_slice(&[1.0, 2.0, 3.0]);
        let mut view = View {
            flip_x: true,
            ..View::default()
        };
        let mut tare = TareFrames::new(2);
        tare.add_frame(&frame, &view).expect("it fits");
        // A frame of another size is not added.
        view.quarter_turns = 1;
        let error = tare.add_frame(&frame, &view).expect_err("of another size");
        assert!(matches!(error, FrameError::Size { .. }), "{error}");
        view.quarter_turns = 0;
        tare.add_frame(&frame, &view).expect("it fits");
        let tare = tare.finish().expect("two frames");
        assert_eq!(tare.baseline().values(), [3.0, 2.0, 1.0]);
    }

    #[test]
    fn what_is_not_a_value_is_missing() {
        let tare = tare(&[[1.0, f64::INFINITY], [f64::NEG_INFINITY, 2.0], [3.0, 1e301]]);
        let tare = tare.expect("three frames");
        assert_eq!(tare.baseline().values(), [2.0, 2.0]);
    }

    #[test]
    fn parts_out_of_range_are_refused() {
        let part = |value: f64| Matrix::filled(MatrixSize::of(2, 1), value);
        let refused = |baseline: f64, deviation: f64, step: f64| {
            let tare = Tare::from_parts(part(baseline), Some(part(deviation)), Some(step), 0);
            tare.map(|tare| tare.frames())
                .map_err(|error| error.to_string())
        };
        assert_eq!(refused(f64::NAN, f64::NAN, 0.1), Ok(1));
        assert_eq!(refused(-1e300, 0.0, 1e300), Ok(1));
        let message = |part: &str| Err(part.to_owned());
        let baseline = "tare: -inf is out of range (allowed: -1e300 to 1e300)";
        assert_eq!(refused(f64::NEG_INFINITY, 0.0, 1.0), message(baseline));
        let deviation = "tare_spread: -5 is out of range (allowed: 0 or more)";
        assert_eq!(refused(0.0, -5.0, 1.0), message(deviation));
        let step = "tare_step: NaN is out of range (allowed: above 0)";
        assert_eq!(refused(0.0, 0.0, f64::NAN), message(step));
    }

    #[test]
    fn a_tare_begins_again_with_frames_of_another_size_if_no_others_come() {
        for (wanted, sides, columns) in [
            (5, &[2, 6, 6, 6, 6, 6][..], 6),
            (5, &[2, 2, 6, 6, 2, 6, 6, 6, 2, 2], 2),
            (2, &[2, 6, 6], 6),
            (3, &[2, 2, 6, 6, 6], 6),
            (4, &[2, 6, 4, 6, 4, 2, 2, 2], 2),
        ] {
            let mut first = FirstFrames::new(wanted);
            for &side in sides {
                assert!(first.missing() > 0, "{sides:?}");
                let _ = first.add(&Frame::new(FrameSize::of(side, side)), &View::default());
            }
            let tare = first.finish().expect("complete");
            let found = (tare.frames(), tare.baseline().columns());
            assert_eq!(found, (wanted, columns), "{sides:?}");
        }
    }
}
