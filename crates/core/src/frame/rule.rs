use crate::description::{RegionKind, each_region};
use crate::frame::recorded::{FrameError, VALUES, in_range};
use crate::frame::tare::Tare;
use crate::imprint::Imprint;
use crate::matrix::Matrix;
use crate::parameter::named;

/// The rule that decides which values make a taxel active. A value equal to a threshold is active; a cell without a
/// value never is.
///
/// Rules are created only by the functions below, which check the numbers. To read a rule, match with `..`, as in
/// `Rule::AtLeast(value, ..)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// A taxel is active at this value or more, in the sensor's unit.
    AtLeast(f64),
    /// A taxel is active at this percentage of the frame's largest value or more. No taxel is active if that value is 0
    /// or less. The threshold is `percent / 100 * largest` in f64: 7 % of 100 is rounded to slightly more than 7.
    Percent(f64),
    /// A taxel is active at `high` or more. A cell of at least `low` is active too if an 8-connected path of such cells
    /// joins it to a cell of at least `high`.
    Hysteresis {
        /// The lower threshold.
        low: f64,
        /// The upper threshold.
        high: f64,
    },
    /// A taxel is active if its value exceeds the tare by at least this number of standard deviations of the cell's own
    /// noise, and by at least one step of the values ([`Tare::step`], which is 1 if the tare shows none). The standard
    /// deviation is estimated as 1.4826 times the median absolute deviation of the frames of the tare, as for a normal
    /// distribution.
    Noise(f64),
}

impl Rule {
    /// Returns a percentage of a value, rounded like `percent / 100 * value` in other programs.
    pub fn percent_of(percent: f64, value: f64) -> f64 {
        percent / 100.0 * value
    }

    /// Creates a rule with a fixed threshold, in the sensor's unit.
    ///
    /// # Errors
    /// Returns an error if the threshold is not finite, or beyond ±1e300.
    pub fn at_least(threshold: f64) -> Result<Self, FrameError> {
        pressure("at_least", threshold).map(Self::AtLeast)
    }

    /// Creates a rule with a threshold in percent of the largest value.
    ///
    /// # Errors
    /// Returns an error if the percentage is not above 0 and at most 100.
    pub fn percent(percent: f64) -> Result<Self, FrameError> {
        let range = f64::MIN_POSITIVE..=100.0;
        in_range("percent", percent, range, "above 0, up to 100").map(Self::Percent)
    }

    /// Creates a rule with two thresholds, in the sensor's unit.
    ///
    /// # Errors
    /// Returns an error if a threshold is not finite or beyond ±1e300, or `low` is above `high`.
    pub fn hysteresis(low: f64, high: f64) -> Result<Self, FrameError> {
        let (low, high) = (pressure("low", low)?, pressure("high", high)?);
        if low > high {
            return Err(FrameError::Order { low, high });
        }
        Ok(Self::Hysteresis { low, high })
    }

    /// Creates a rule with a threshold in standard deviations of the noise ([`Self::Noise`]). The rule needs a tare of
    /// two or more frames.
    ///
    /// # Errors
    /// Returns an error if the number is not above 0 and at most 1000.
    pub fn noise(deviations: f64) -> Result<Self, FrameError> {
        let range = f64::MIN_POSITIVE..=1000.0;
        in_range("noise", deviations, range, "above 0, up to 1000").map(Self::Noise)
    }

    /// Returns the imprint of values after tare and gain, which have the size of the values, without pieces of fewer
    /// than `least` taxels. The noise of a cell is measured before the gain, so its margin is multiplied by the gain
    /// too; without a tare of two or more frames it is an error.
    pub(super) fn imprint(
        &self,
        values: &Matrix<f64>,
        tare: Option<&Tare>,
        gain: Option<&Matrix<f64>>,
        least: u32,
    ) -> Result<Imprint, FrameError> {
        let at_or_above = |threshold| values.cells_where(|_, value| value >= threshold);
        let imprint = match *self {
            Self::AtLeast(threshold) => at_or_above(threshold),
            Self::Percent(percent) => {
                let max = values.values().iter().copied().fold(f64::NAN, f64::max);
                values.cells_where(|_, value| max > 0.0 && value >= Self::percent_of(percent, max))
            }
            Self::Hysteresis { low, high } => {
                let strong = at_or_above(high);
                pieces(&at_or_above(low), |piece| {
                    !piece.intersection(&strong).is_empty()
                })
            }
            Self::Noise(deviations) => {
                let tare = tare.filter(|tare| tare.frames > 1);
                let tare = tare.ok_or(FrameError::NoTare)?;
                let factor = |index: usize| gain.map_or(1.0, |gain| gain.values()[index].abs());
                // A margin is above 0, so a value of 0 is never active, not even in a cell whose gain is 0.
                values.cells_where(|index, value| {
                    value > 0.0 && value >= factor(index) * tare.margin(index, deviations)
                })
            }
        };
        Ok(match least {
            0 | 1 => imprint,
            least => pieces(&imprint, |piece| piece.count() >= least),
        })
    }
}

/// Returns a threshold in the sensor's unit if it is one that a value may have.
fn pressure(what: &'static str, value: f64) -> Result<f64, FrameError> {
    in_range(what, value, VALUES, "-1e300 to 1e300")
}

/// Returns the 8-connected pieces of an imprint that are kept.
fn pieces(imprint: &Imprint, is_kept: impl Fn(&Imprint) -> bool) -> Imprint {
    let mut kept = Imprint::empty(imprint.size());
    each_region(imprint, |region| {
        if region.kind() == RegionKind::Exterior && is_kept(region.taxels()) {
            kept = kept.union(region.taxels());
        }
    });
    kept
}

/// A rule and its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetRule {
    /// The rule.
    pub rule: Rule,
    /// The smallest number of taxels of a piece; smaller pieces are dropped. 0 or 1 drops none.
    pub least: u32,
    /// The origin of the rule.
    pub from: RuleOrigin,
}

/// The origin of a rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RuleOrigin {
    /// An argument on the command line.
    #[default]
    Flag,
    /// The recording, or the metadata beside it.
    File,
    /// The user's settings.
    Settings,
    /// A key on the live page.
    Key,
}

named!(RuleOrigin, "origin", [Flag "flag", File "file", Settings "settings", Key "key"]);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Frame, TareFrames, View};
    use crate::sensor::MatrixSize;

    fn matrix(rows: &[&[f64]]) -> Matrix<f64> {
        let side = |length: usize| u8::try_from(length).expect("few");
        let size = MatrixSize::of(side(rows[0].len()), side(rows.len()));
        Matrix::from_values(size, rows.concat()).expect("rows of one length")
    }

    fn tare(frames: &[Matrix<f64>]) -> Tare {
        let mut tare = TareFrames::new(frames.len() as u64);
        for values in frames {
            let frame = Frame::from_values(values.size().into(), values.values());
            tare.add(&frame.expect("as many"), &View::default())
                .expect("of one size");
        }
        tare.finish().expect("all frames")
    }

    fn imprint(rule: Result<Rule, FrameError>, values: &Matrix<f64>) -> String {
        let imprint = rule.and_then(|rule| rule.imprint(values, None, None, 0));
        imprint.expect("a rule that fits").to_string()
    }

    #[test]
    fn values_at_a_threshold_are_active_and_missing_cells_never_are() {
        let values = matrix(&[&[9.999, 10.0, f64::NAN, 40.0]]);
        assert_eq!(imprint(Rule::at_least(10.0), &values), ".#.#");
        assert_eq!(imprint(Rule::percent(25.0), &values), ".#.#");
        assert_eq!(imprint(Rule::at_least(-1.0), &values), "##.#");
    }

    #[test]
    fn a_percentage_is_rounded_as_in_other_programs() {
        for percent in 1_u32..=100 {
            let threshold = f64::from(percent) / 100.0 * 300.0;
            let values = matrix(&[&[threshold.next_down(), threshold, 300.0]]);
            assert_eq!(imprint(Rule::percent(f64::from(percent)), &values), ".##");
        }
        assert_eq!(imprint(Rule::percent(7.0), &matrix(&[&[7.0, 100.0]])), ".#");
        assert_eq!(imprint(Rule::percent(50.0), &matrix(&[&[7.0, 14.0]])), "##");
    }

    #[test]
    fn the_largest_value_is_active_at_every_percentage() {
        let (largest, all) = (14.847_618_057_259_202, Rule::percent(100.0));
        assert!(largest * 100.0 / 100.0 > largest);
        assert_eq!(imprint(all, &matrix(&[&[largest, 6.0]])), "#.");
    }

    #[test]
    fn no_taxel_is_active_at_a_percentage_of_no_pressure() {
        for nothing in [0.0, -3.0, f64::NAN] {
            assert_eq!(
                imprint(Rule::percent(50.0), &matrix(&[&[nothing; 2]])),
                ".."
            );
        }
    }

    #[test]
    fn hysteresis_follows_corners_but_not_gaps() {
        let values = matrix(&[
            &[5.0, 0.0, 0.0, 5.0],
            &[0.0, 5.0, 0.0, 5.0],
            &[0.0, 0.0, 9.0, 0.0],
            &[5.0, 0.0, 0.0, 0.0],
        ]);
        assert_eq!(
            imprint(Rule::hysteresis(5.0, 9.0), &values),
            "#..#\n.#.#\n..#.\n...."
        );
        // A weak ring around a strong one is another piece.
        let mut ring = Matrix::filled(MatrixSize::of(5, 5), 5.0);
        for (column, row) in [
            (1, 1),
            (2, 1),
            (3, 1),
            (1, 2),
            (3, 2),
            (1, 3),
            (2, 3),
            (3, 3),
        ] {
            ring.set(column, row, 0.0);
        }
        ring.set(2, 2, 9.0);
        assert_eq!(
            imprint(Rule::hysteresis(5.0, 9.0), &ring),
            ".....\n.....\n..#..\n.....\n....."
        );
    }

    #[test]
    fn each_cell_has_its_own_noise() {
        let tare = tare(&[[0.0, 0.0], [1.0, 10.0], [2.0, 20.0]].map(|frame| matrix(&[&frame])));
        let rule = Rule::noise(3.0).expect("in range");
        let mut values = matrix(&[&[6.0, 6.0]]);
        tare.subtract_from(&mut values).expect("of one size");
        let imprint = rule.imprint(&values, Some(&tare), None, 0).expect("a tare");
        assert_eq!(imprint.to_string(), "#.");
        assert_eq!(
            rule.imprint(&values, None, None, 0),
            Err(FrameError::NoTare)
        );
    }

    #[test]
    fn a_gain_changes_no_decision_about_noise() {
        let tare = tare(&[10.0, 11.0, 12.0].map(|frame| matrix(&[&[frame; 5]])));
        // The deviation is 1.4826 above the median of 11. The gain of the last cell is negative, so its sign is turned.
        let (quiet, loud) = (11.0 + 4.4, 11.0 + 4.5);
        let gain = matrix(&[&[1.0, 10.0, 0.01, 0.0, -10.0]]);
        let rule = Rule::noise(3.0).expect("in range");
        let imprint = |frame: [f64; 5]| {
            let mut values = matrix(&[&frame]);
            tare.subtract_from(&mut values).expect("of one size");
            for (value, gain) in values.values_mut().iter_mut().zip(gain.values()) {
                *value *= gain;
            }
            let imprint = rule.imprint(&values, Some(&tare), Some(&gain), 0);
            imprint.expect("all of one size").to_string()
        };
        let below = |value: f64| 22.0 - value;
        assert_eq!(imprint([quiet, quiet, quiet, quiet, below(quiet)]), ".....");
        assert_eq!(imprint([loud, loud, loud, loud, below(loud)]), "###.#");
        // If deviations are smaller than one step, the margin is one step.
        let rule = Rule::noise(0.1).expect("in range");
        let values = matrix(&[&[0.9, 9.0, 0.009, 0.0, 9.0]]);
        let imprint = rule.imprint(&values, Some(&tare), Some(&gain), 0);
        assert_eq!(imprint.map(|imprint| imprint.count()), Ok(0));
    }

    #[test]
    fn small_pieces_are_dropped() {
        let values = matrix(&[
            &[1.0, 1.0, 0.0, 1.0],
            &[1.0, 0.0, 0.0, 0.0],
            &[0.0, 0.0, 1.0, 1.0],
        ]);
        let imprint = |least| {
            let imprint = Rule::AtLeast(1.0).imprint(&values, None, None, least);
            imprint.expect("no tare is needed").to_string()
        };
        assert_eq!(imprint(1), "##.#\n#...\n..##");
        assert_eq!(imprint(2), "##..\n#...\n..##");
        assert_eq!(imprint(3), "##..\n#...\n....");
    }

    #[test]
    fn rules_out_of_range_are_refused() {
        for rule in [
            Rule::at_least(f64::NAN),
            Rule::percent(0.0),
            Rule::percent(100.1),
            Rule::hysteresis(1.0, f64::INFINITY),
            Rule::noise(-1.0),
        ] {
            assert!(matches!(rule, Err(FrameError::Rule { .. })), "{rule:?}");
        }
    }

    #[test]
    fn a_tare_of_one_frame_does_not_measure_noise() {
        let rule = Rule::noise(3.0).expect("in range");
        let of_frames = |count: usize| {
            let tare = tare(&vec![matrix(&[&[1.0, 1.0]]); count]);
            let imprint = rule.imprint(&matrix(&[&[0.9, 1.0]]), Some(&tare), None, 0);
            imprint.map(|imprint| imprint.to_string())
        };
        assert_eq!(of_frames(1), Err(FrameError::NoTare));
        // All values are equal, so one step is 1.
        assert_eq!(of_frames(2).as_deref(), Ok(".#"));
    }
}
