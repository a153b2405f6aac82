//! The commands that describe one imprint, or one per line: `figure`, `picture`, `describe` and `batch`.

use std::path::PathBuf;

use clap::{Arg, ArgMatches, Command, value_parser};

use crate::cli::arguments::flags::{
    jobs, json, misused, of_sensor, required, sensor, sensor_of_imprints, what,
};
use crate::cli::arguments::help::{
    BATCH_EXAMPLES, DESCRIBE_EXAMPLES, FIGURE_EXAMPLES, PICTURE_EXAMPLES,
};
use crate::cli::arguments::kept;
use crate::cli::arguments::parameters::{self, Given};
use crate::cli::error::CliError;
use crate::cli::settings::resolved::Effective;
use crate::figure::FigureKind;
use crate::parameter::Parameter;
use crate::picture::PICTURE_PARAMETERS;
use crate::quote::joined;
use crate::sensor::{SENSOR_PARAMETERS, Sensor};
use crate::source::Source;

/// Defines `taxel figure KIND`, such as `taxel figure ellipse --x0 1.99 --radius-x 4`. There is a flag for each
/// parameter of any kind; [`Given::foreign`](parameters::Given::foreign) refuses those that the given kind does not
/// have. Angles are degrees clockwise as seen, lengths are in cell sides.
pub(super) fn figure() -> Command {
    let kinds = FigureKind::names();
    let kind = Arg::new("kind")
        .value_name("KIND")
        .required(true)
        .value_parser(parameters::one_of::<FigureKind, _>(kinds.clone()))
        .hide_possible_values(true)
        .help(parameters::wrapped(&joined(kinds, "or"), 64));
    let own = parameters::figure_parameters();
    Command::new("figure")
        .about("Touch a figure and describe its imprint")
        .after_help(FIGURE_EXAMPLES)
        .arg(kind)
        .args(own.map(|parameter| parameters::arg(parameter).help_heading("Figure")))
        .args(sensor())
        .args(kept::flags())
        .group(kept::group())
        .arg(json())
}

pub(super) fn picture() -> Command {
    let own = |parameter: Parameter| parameters::arg_with_own(parameter);
    Command::new("picture")
        .about("Move, zoom and turn a stored shape and describe its imprint")
        .after_help(PICTURE_EXAMPLES)
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .args(
            PICTURE_PARAMETERS
                .iter()
                .map(|&parameter| own(parameter).help_heading("Picture")),
        )
        .args(
            SENSOR_PARAMETERS
                .iter()
                .map(|&parameter| own(parameter).help_heading("Sensor")),
        )
        .args(kept::flags())
        .group(kept::group())
        .arg(json())
}

pub(super) fn describe() -> Command {
    Command::new("describe")
        .about("Describe an imprint or a stored shape")
        .after_help(DESCRIBE_EXAMPLES)
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .args(of_sensor(&[Parameter::Pitch]))
        .arg(json())
}

pub(super) fn batch() -> Command {
    Command::new("batch")
        .about("Describe poses, one JSON object per line")
        .after_help(BATCH_EXAMPLES)
        .arg(
            Arg::new("file")
                .value_name("FILE")
                .value_parser(value_parser!(PathBuf))
                .help("File of JSON lines; standard input if left out or '-'"),
        )
        .args(sensor_of_imprints())
        .arg(jobs())
}

pub(super) fn source(
    matches: &ArgMatches,
    command: &mut Command,
    name: &str,
    settings: &Effective,
) -> Result<(Source, Sensor), CliError> {
    let kind = required::<FigureKind>(matches, "kind")?;
    let given = Given::of(matches);
    if let Some(parameter) = given.foreign(kind) {
        let own = kind
            .parameters()
            .iter()
            .map(|own| format!("--{}", own.flag()));
        let message = format!(
            "'--{}' does not belong to '{}', which takes {}",
            parameter.flag(),
            kind.name(),
            joined(own, "and")
        );
        return Err(misused(command, name, &message));
    }
    let sensor = settings.sensor;
    let figure = Source::Figure(given.figure(kind, &sensor)?);
    Ok((figure, sensor))
}
