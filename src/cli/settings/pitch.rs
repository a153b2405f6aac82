//! In which size of cells lengths are told in mm too.

use crate::sensor::Sensor;

/// What is known of the pitch, in mm, besides a stored shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pitch {
    /// By a flag.
    pub(crate) given: Option<f64>,
    /// By the settings.
    pub(crate) usual: Option<f64>,
}

impl Pitch {
    /// The pitch that counts: that of the flag, else of the sensor, else of the settings; none where nobody has said one.
    /// The default of a sensor, which every stored shape has that was never told otherwise, says nothing.
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
    fn a_flag_goes_before_the_sensor_and_that_before_the_settings() {
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
