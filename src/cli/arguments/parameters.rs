//! Flags made from the table of parameters, and their values.
//!
//! A row of the table gives a flag its name, value name and help with range and default. clap only checks that a
//! value is a number. Its range depends on the sensor, which other flags may change, so [`Given`] collects the
//! numbers, and they are checked when a sensor, figure or picture is made from them.

use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Arg, ArgMatches};

use crate::cli::error::CliError;
use crate::figure::{Figure, FigureKind};
use crate::parameter::{PARAMETERS, Parameter, ParameterError, Unit, UnknownName, number};
use crate::picture::{PICTURE_PARAMETERS, Picture};
use crate::sensor::{SENSOR_PARAMETERS, Sensor};
use crate::tui::widget::columns::broken;

const HELP_WIDTH: usize = 52;

#[derive(Clone, Debug)]
struct Number {
    text: String,
    value: f64,
}

pub(crate) fn figure_parameters() -> impl Iterator<Item = Parameter> {
    PARAMETERS
        .iter()
        .map(|row| row.parameter)
        .filter(|&parameter| kinds_with(parameter).next().is_some())
}

fn kinds_with(parameter: Parameter) -> impl Iterator<Item = FigureKind> {
    FigureKind::ALL
        .iter()
        .copied()
        .filter(move |kind| kind.parameters().contains(&parameter))
}

pub(crate) fn arg(parameter: Parameter) -> Arg {
    let default = match parameter {
        Parameter::Thickness | Parameter::Pitch => String::new(),
        _ => format!("; default {}", Sensor::default().default_value(parameter)),
    };
    arg_with(parameter, &default)
}

pub(crate) fn arg_with_own(parameter: Parameter) -> Arg {
    match parameter {
        Parameter::Angle | Parameter::ZoomX | Parameter::ZoomY | Parameter::Pitch => arg(parameter),
        _ => arg_with(parameter, "; default the shape's"),
    }
}

pub(crate) fn arg_fitting(side: Parameter) -> Arg {
    arg_with(side, "; default large enough for all shapes, at least 16")
}

fn arg_with(parameter: Parameter, default: &str) -> Arg {
    let row = parameter.row();
    let unit = match row.unit {
        Unit::Ratio => String::new(),
        unit => format!("{}, ", unit.name()),
    };
    let also = match parameter {
        Parameter::Pitch => "; adds mm to tables and drawings, not to JSON",
        _ => "",
    };
    let range = Sensor::default().range(parameter);
    let meaning = capitalised(row.meaning);
    let help = format!("{meaning}{also} ({unit}{range}{default})");
    Arg::new(row.key)
        .long(parameter.flag())
        .value_name(match row.unit {
            Unit::Ratio => "NUMBER".to_owned(),
            unit => unit.name().to_ascii_uppercase(),
        })
        .help(wrapped(&help, HELP_WIDTH))
        // A minus sign starts a number here, not a flag.
        .allow_hyphen_values(true)
        .value_parser(parse)
}

fn parse(text: &str) -> Result<Number, String> {
    let value = number::read(text).ok_or_else(|| number::complaint(text))?;
    let text = text.trim().to_owned();
    Ok(Number { text, value })
}

pub(super) fn one_of<T, N>(names: N) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = UnknownName> + Clone + Send + Sync + 'static,
    N: IntoIterator<Item = &'static str>,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse())
}

pub(crate) fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(characters).collect()
}

pub(crate) fn wrapped(text: &str, width: usize) -> String {
    broken(text, width).join("\n")
}

/// The values given by flags. They are numbers, but may be out of range.
#[derive(Clone, Debug, Default)]
pub(crate) struct Given(Vec<(Parameter, Number)>);

impl Given {
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let given = |parameter: Parameter| {
            let number = matches.try_get_one::<Number>(parameter.row().key);
            Some((parameter, number.ok().flatten()?.clone()))
        };
        let parameters = PARAMETERS.iter().map(|row| row.parameter);
        Self(parameters.filter_map(given).collect())
    }

    pub(crate) fn first(&self) -> Option<String> {
        self.0.first().map(|(parameter, _)| parameter.flag())
    }

    pub(crate) fn has(&self, parameter: Parameter) -> bool {
        self.0.iter().any(|(given, _)| *given == parameter)
    }

    fn fold<T>(
        &self,
        own: &[Parameter],
        mut thing: T,
        with: impl Fn(T, Parameter, f64) -> Result<T, ParameterError>,
    ) -> Result<T, CliError> {
        for (parameter, number) in &self.0 {
            if own.contains(parameter) {
                thing = with(thing, *parameter, number.value).map_err(|error| CliError::Range {
                    flag: parameter.flag(),
                    text: number.text.clone(),
                    complaint: error.complaint(),
                })?;
            }
        }
        Ok(thing)
    }

    pub(crate) fn sensor(&self, sensor: Sensor) -> Result<Sensor, CliError> {
        self.fold(SENSOR_PARAMETERS, sensor, Sensor::with)
    }

    pub(crate) fn pitch(&self) -> Result<Option<f64>, CliError> {
        self.fold(&[Parameter::Pitch], None, |_, parameter, value| {
            Sensor::LARGEST.check(parameter, value).map(Some)
        })
    }

    pub(crate) fn foreign(&self, kind: FigureKind) -> Option<Parameter> {
        figure_parameters()
            .filter(|&parameter| !kind.parameters().contains(&parameter))
            .find(|&parameter| self.0.iter().any(|(given, _)| *given == parameter))
    }

    pub(crate) fn figure(&self, kind: FigureKind, sensor: &Sensor) -> Result<Figure, CliError> {
        let figure = Figure::default_of(kind, sensor);
        self.fold(kind.parameters(), figure, |figure, parameter, value| {
            figure.with(parameter, value, sensor)
        })
    }

    pub(crate) fn picture(&self, picture: Picture, sensor: &Sensor) -> Result<Picture, CliError> {
        self.fold(PICTURE_PARAMETERS, picture, |picture, parameter, value| {
            picture.with(parameter, value, sensor)
        })
    }
}
