use crate::frame::recorded::{Frame, FrameError, VALUES, check_size, in_range};
use crate::frame::view::View;
use crate::matrix::Matrix;
use crate::sensor::MatrixSize;

const MAX_VALUES: u64 = 1 << 25;

/// The standard deviation of the normal distribution divided by its median absolute deviation.
const MAD_TO_DEVIATION: f64 = 1.4826;

/// The frames of which a tare is made. A frame of another size is left out. If successive frames of one other size are
/// more than those so far, the tare begins again with them: the very first frame was cut, or the sensor was set up
/// anew. So a tare ends soon after a change of the size, too.
#[derive(Clone, Debug)]
pub struct TareFrames {
    /// The number of frames that the tare needs.
    pub wanted: u64,
    own: FrameSet,
    /// The last frames, if they are all of one other size.
    other: FrameSet,
    visible: Matrix<f64>,
}

/// Some frames of one size.
#[derive(Clone, Debug, Default)]
struct FrameSet {
    /// The size of a frame; None before the first one.
    size: Option<MatrixSize>,
    values: Vec<f64>,
    frames: u64,
}

impl FrameSet {
    fn add(&mut self, frame: &Matrix<f64>) {
        self.size = Some(frame.size());
        self.values.extend_from_slice(frame.values());
        self.frames += 1;
    }

    /// Checks that a frame has the size of the others.
    fn check(&self, size: MatrixSize) -> Result<(), FrameError> {
        self.size
            .map_or(Ok(()), |own| check_size("tare", own, size))
    }
}

impl TareFrames {
    /// Creates an empty set that needs `wanted` frames, at least one.
    pub fn new(wanted: u64) -> Self {
        Self {
            wanted: wanted.max(1),
            own: FrameSet::default(),
            other: FrameSet::default(),
            visible: Matrix::default(),
        }
    }

    /// Returns the number of frames that are still missing.
    pub fn missing(&self) -> u64 {
        self.wanted - self.own.frames
    }

    /// Checks that the needed number of frames fits into memory if each has this number of values.
    ///
    /// # Errors
    /// Returns an error if they take too much memory.
    pub fn check_memory(&self, values: usize) -> Result<(), FrameError> {
        let most = MAX_VALUES / (values as u64).max(1);
        if self.wanted <= most {
            return Ok(());
        }
        Err(FrameError::Invalid(format!(
            "too many frames for a tare: expected at most {most} of this size"
        )))
    }

    /// Adds the part of a frame that a view shows; does nothing if there are enough. Returns false if the tare begins
    /// again with it and the frames of its size just before it: those that were added before are not in the tare.
    ///
    /// # Errors
    /// Returns an error if the view does not fit the frame, if the frame differs in size from the first one, so that
    /// it is left out, or if the needed number of frames of this size takes too much memory.
    pub fn add(&mut self, frame: &Frame, view: &View) -> Result<bool, FrameError> {
        if self.missing() == 0 {
            return Ok(true);
        }
        let mut other = std::mem::take(&mut self.other);
        view.apply_to(frame, &mut self.visible)?;
        let size = self.visible.size();
        let fits_memory = self.check_memory(size.cells());
        let Err(misfit) = self.own.check(size) else {
            fits_memory?;
            self.own.add(&self.visible);
            return Ok(true);
        };
        if fits_memory.is_ok() {
            if other.check(size).is_err() {
                other = FrameSet::default();
            }
            other.add(&self.visible);
            if other.frames > self.own.frames {
                self.own = other;
                return Ok(false);
            }
            self.other = other;
        }
        Err(misfit)
    }

    /// Computes the tare.
    ///
    /// # Errors
    /// Returns an error if frames are missing.
    pub fn finish(self) -> Result<Tare, FrameError> {
        let (own, wanted) = (self.own, self.wanted);
        let (Some(size), 0) = (own.size, wanted - own.frames) else {
            let frames = own.frames;
            return Err(FrameError::Tare { frames, wanted });
        };
        let mut baseline = Matrix::filled(size, f64::NAN);
        let mut deviation = baseline.clone();
        let mut present = Vec::new();
        for cell in 0..size.cells() {
            let values = own.values.iter().skip(cell).step_by(size.cells());
            present.clear();
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
            step: step(own.values),
            frames: wanted,
        })
    }
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
    /// The median of each cell, in the sensor's unit; NaN where a cell never had a value.
    pub baseline: Matrix<f64>,
    /// The median absolute deviation of each cell, in the sensor's unit; NaN where a cell never had a value.
    pub deviation: Matrix<f64>,
    /// The step of the values, in the sensor's unit: the smallest difference between two of them. None if all are
    /// equal, so that nothing shows it; then it counts as 1, which is too coarse if the sensor sends fractions.
    pub step: Option<f64>,
    /// The number of frames from which the tare was made.
    pub frames: u64,
}

impl Tare {
    /// Rebuilds a tare from the median of each cell, the median absolute deviation of each cell, and the step of the
    /// values, all in the sensor's unit; NaN where a cell never had a value. The deviation defaults to 0. A step that
    /// is not above 0 and finite is unknown. The number of frames is at least 1; 0 counts as 1.
    ///
    /// # Errors
    /// Returns an error if the sizes differ, if a median is infinite or beyond ±1e300, or if a deviation is
    /// below 0 or infinite.
    pub fn from_parts(
        baseline: Matrix<f64>,
        deviation: Option<Matrix<f64>>,
        step: Option<f64>,
        frames: u64,
    ) -> Result<Self, FrameError> {
        let deviation = deviation.unwrap_or_else(|| Matrix::filled(baseline.size(), 0.0));
        check_size("tare", deviation.size(), baseline.size())?;
        for (what, part, range, allowed) in [
            ("tare", &baseline, VALUES, "-1e300 to 1e300"),
            ("tare_spread", &deviation, 0.0..=f64::MAX, "0 or more"),
        ] {
            for &value in part.values().iter().filter(|value| !value.is_nan()) {
                in_range(what, value, range.clone(), allowed)?;
            }
        }
        Ok(Self {
            baseline,
            deviation,
            step: step.filter(|step| *step > 0.0 && step.is_finite()),
            frames: frames.max(1),
        })
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
        check_size("tare", self.baseline.size(), values.size())?;
        for (value, baseline) in values.values_mut().iter_mut().zip(self.baseline.values()) {
            *value -= baseline;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameSize;

    fn tare(frames: &[[f64; 2]]) -> Result<Tare, FrameError> {
        let mut tare = TareFrames::new(frames.len() as u64);
        for frame in frames {
            let frame = Frame::from_values(FrameSize::of(2, 1), frame)?;
            tare.add(&frame, &View::default())?;
        }
        tare.finish()
    }

    #[test]
    fn the_median_ignores_missing_values() {
        let tare = tare(&[[1.0, f64::NAN], [4.0, 7.0], [3.0, 9.0], [10.0, f64::NAN]]);
        let tare = tare.expect("four frames");
        assert_eq!(tare.baseline.values(), [3.5, 8.0]);
        // Deviations 2.5, 0.5, 0.5, 6.5 and 1, 1; the values are 1, 3, 4, 7, 9, 10.
        assert_eq!(tare.margin(0, 2.0), 2.0 * MAD_TO_DEVIATION * 1.5);
        assert_eq!(tare.margin(1, 0.1), 1.0);
        let mut values = Matrix::filled(MatrixSize::of(2, 1), 10.0);
        tare.subtract_from(&mut values).expect("of its size");
        assert_eq!(values.values(), [6.5, 2.0]);
    }

    #[test]
    fn a_step_needs_two_different_values() {
        let rest = |frames: &[[f64; 2]]| tare(frames).expect("all frames").step;
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
        // The error names the largest number of frames.
        let large = Frame::new(FrameSize::of(64, 64));
        let added = |frames| TareFrames::new(frames).add(&large, &View::default());
        assert_eq!(added(8192), Ok(true));
        let error = added(8193).expect_err("too many").to_string();
        assert!(error.contains("at most 8192 of this size"), "{error}");
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
        tare.add(&frame, &view).expect("it fits");
        // A frame of another size is not added.
        view.quarter_turns = 1;
        let error = tare.add(&frame, &view).expect_err("of another size");
        assert!(matches!(error, FrameError::Size(_)), "{error}");
        view.quarter_turns = 0;
        tare.add(&frame, &view).expect("it fits");
        let tare = tare.finish().expect("two frames");
        assert_eq!(tare.baseline.values(), [3.0, 2.0, 1.0]);
    }

    #[test]
    fn what_is_not_a_value_is_missing() {
        let tare = tare(&[[1.0, f64::INFINITY], [f64::NEG_INFINITY, 2.0], [3.0, 1e301]]);
        let tare = tare.expect("three frames");
        assert_eq!(tare.baseline.values(), [2.0, 2.0]);
    }

    #[test]
    fn parts_out_of_range_are_refused() {
        let part = |value: f64| Matrix::filled(MatrixSize::of(2, 1), value);
        let refused = |baseline: f64, deviation: f64, step: f64| {
            let tare = Tare::from_parts(part(baseline), Some(part(deviation)), Some(step), 0);
            tare.map(|tare| tare.frames)
                .map_err(|error| error.to_string())
        };
        assert_eq!(refused(f64::NAN, f64::NAN, 0.1), Ok(1));
        assert_eq!(refused(-1e300, 0.0, 1e300), Ok(1));
        let message = |part: &str| Err(part.to_owned());
        let baseline = "tare: -inf is out of range (allowed: -1e300 to 1e300)";
        assert_eq!(refused(f64::NEG_INFINITY, 0.0, 1.0), message(baseline));
        let deviation = "tare_spread: -5 is out of range (allowed: 0 or more)";
        assert_eq!(refused(0.0, -5.0, 1.0), message(deviation));
        let unknown = Tare::from_parts(part(0.0), None, Some(f64::NAN), 1);
        assert_eq!(unknown.expect("it fits").step, None);
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
            let mut first = TareFrames::new(wanted);
            for &side in sides {
                assert!(first.missing() > 0, "{sides:?}");
                let _ = first.add(&Frame::new(FrameSize::of(side, side)), &View::default());
            }
            let tare = first.finish().expect("complete");
            let found = (tare.frames, tare.baseline.columns());
            assert_eq!(found, (wanted, columns), "{sides:?}");
        }
    }
}
