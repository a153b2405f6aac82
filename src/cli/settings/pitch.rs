//! The pitch for lengths in mm. Lengths are always given in cells, and also in mm if a pitch is known.

use crate::sensor::Sensor;

/// The sources of the pitch in mm that are known before a stored shape is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pitch {
    pub(crate) given: Option<f64>,
    pub(crate) usual: Option<f64>,
}

impl Pitch {
    /// Returns the pitch in effect, in mm: that of the flag, or else of a stored shape's sensor, or else of the
    /// settings; None if none of them sets one.
    ///
    /// A sensor with the default pitch counts as not setting one: shapes stored without a pitch have it too.
    pub(crate) fn of(self, sensor: Option<&Sensor>) -> Option<f64> {
        let own = sensor.map(Sensor::pitch_mm);
        let own = own.filter(|&pitch| pitch != Sensor::default().pitch_mm());
        self.given.or(own).or(self.usual)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::Parameter;

    #[test]
    fn a_flag_overrides_the_sensor_which_overrides_the_settings() {
        let fine = Sensor::default().with(Parameter::Pitch, 2.5);
        let (plain, fine) = (Sensor::default(), fine.expect("in range"));
        let none = Pitch::default();
        assert_eq!((none.of(None), none.of(Some(&plain))), (None, None));
        assert_eq!(none.of(Some(&fine)), Some(2.5));
        let usual = Pitch {
            usual: Some(4.0),
            ..none
        };
        assert_eq!(usual.of(Some(&plain)), Some(4.0));
        assert_eq!(usual.of(Some(&fine)), Some(2.5));
        let given = Pitch {
            given: Some(1.0),
            ..usual
        };
        assert_eq!(given.of(Some(&fine)), Some(1.0));
    }
}
