//! The form in which an imprint is shown: `--json` or a table, with the pitch for millimetres.

use clap::ArgMatches;

use crate::cli::arguments::parameters::Given;
use crate::cli::error::CliError;
use crate::cli::settings::pitch::Pitch;
use crate::cli::settings::resolved::Effective;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    Json(Pitch),
    /// The matrix and a table, which is in mm too if the pitch is known.
    Table(Pitch),
}

impl Form {
    pub(super) fn of(matches: &ArgMatches, settings: &Effective) -> Result<Self, CliError> {
        let pitch = pitch_of(matches, settings)?;
        Ok(if matches.get_flag("json") {
            Self::Json(pitch)
        } else {
            Self::Table(pitch)
        })
    }
}

pub(super) fn pitch_of(matches: &ArgMatches, settings: &Effective) -> Result<Pitch, CliError> {
    Ok(Pitch {
        given: Given::of(matches).pitch()?,
        usual: settings.pitch,
    })
}
