//! Parameters by their flags: `--radius-x 4` on the program's command line and on the screen's.

use crate::parameter::table::{PARAMETERS, Parameter};

impl Parameter {
    /// The name of its flag, without the dashes: its key with `-` for `_`, and without a unit, which stands in the help.
    pub fn flag(self) -> String {
        let key = self.row().key;
        key.strip_suffix("_mm").unwrap_or(key).replace('_', "-")
    }

    /// The parameter whose flag that is, without the dashes.
    ///
    /// ```
    /// use taxel::parameter::Parameter;
    /// assert_eq!(Parameter::from_flag("radius-x"), Some(Parameter::RadiusX));
    /// assert_eq!(Parameter::from_flag("radius_x"), None);
    /// ```
    pub fn from_flag(flag: &str) -> Option<Self> {
        let mut parameters = PARAMETERS.iter().map(|row| row.parameter);
        parameters.find(|own| own.flag() == flag)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_is_found_by_its_own_flag() {
        for row in PARAMETERS {
            let flag = row.parameter.flag();
            assert_eq!(Parameter::from_flag(&flag), Some(row.parameter), "{flag}");
        }
        assert_eq!(Parameter::Pitch.flag(), "pitch");
    }
}
