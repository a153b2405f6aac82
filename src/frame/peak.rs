//! The frame with the greatest pressure.

/// The frame with the greatest sum of values so far; the first one if several are equal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    best: Option<(u64, f64)>,
}

impl Peak {
    /// Compares the sum of another frame; true if it is the new peak.
    pub fn add(&mut self, number: u64, sum: f64) -> bool {
        let is_peak = self.best.is_none_or(|(_, best)| sum > best);
        if is_peak {
            self.best = Some((number, sum));
        }
        is_peak
    }

    /// Returns the number of the frame; None before the first one.
    pub fn number(&self) -> Option<u64> {
        self.best.map(|(number, _)| number)
    }
}
