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
