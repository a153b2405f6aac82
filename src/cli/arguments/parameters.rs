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

/// The width of help texts, in characters; with the flags on their left they fit into 80 columns.
const HELP_WIDTH: usize = 52;

/// A number with its text, for messages.
#[derive(Clone, Debug)]
struct Number {
    /// The text as typed, without blanks around it.
    text: String,
    /// The finite number.
    value: f64,
}

/// Returns the parameters that at least one kind of figure has, in the order of the table.
pub(crate) fn figure_parameters() -> impl Iterator<Item = Parameter> {
    PARAMETERS
        .iter()
        .map(|row| row.parameter)
        .filter(|&parameter| kinds_with(parameter).next().is_some())
}

/// Returns the kinds of figure that have a parameter.
fn kinds_with(parameter: Parameter) -> impl Iterator<Item = FigureKind> {
    FigureKind::ALL
        .iter()
        .copied()
        .filter(move |kind| kind.parameters().contains(&parameter))
}

/// Defines the flag of a parameter. Its help shows range and default for the default sensor.
pub(crate) fn arg(parameter: Parameter) -> Arg {
    let default = match parameter {
        Parameter::Thickness | Parameter::Pitch => String::new(),
        _ => format!("; default {}", Sensor::default().default_value(parameter)),
    };
    arg_with(parameter, &default)
}

/// Defines the flag of a parameter that a stored shape has a value for; without the flag, it keeps that value.
pub(crate) fn arg_with_own(parameter: Parameter) -> Arg {
    match parameter {
        Parameter::Angle | Parameter::ZoomX | Parameter::ZoomY | Parameter::Pitch => arg(parameter),
        _ => arg_with(parameter, "; default the shape's"),
    }
}

/// Defines the flag of a side of the sensor; without it, the side is large enough for all shapes of a model.
pub(crate) fn arg_fitting(side: Parameter) -> Arg {
    arg_with(side, "; default large enough for all shapes, at least 16")
}

/// Defines the flag of a parameter; `default` is the end of its help.
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

/// Parses a number; any other text is a usage error.
fn parse(text: &str) -> Result<Number, String> {
    let value = number::read(text).ok_or_else(|| number::complaint(text))?;
    let text = text.trim().to_owned();
    Ok(Number { text, value })
}

/// Makes a parser that accepts one of some names and returns the value with that name.
pub(super) fn one_of<T, N>(names: N) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = UnknownName> + Clone + Send + Sync + 'static,
    N: IntoIterator<Item = &'static str>,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse())
}

/// Returns a text with its first letter in upper case, as in clap's own help.
pub(crate) fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(characters).collect()
}

/// Breaks a text at spaces into lines of at most `width` columns.
pub(crate) fn wrapped(text: &str, width: usize) -> String {
    broken(text, width).join("\n")
}

/// The values given by flags. They are numbers, but may be out of range.
#[derive(Clone, Debug, Default)]
pub(crate) struct Given(Vec<(Parameter, Number)>);

impl Given {
    /// Reads the values of a command's flags. Flags that the command does not have count as not given.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let given = |parameter: Parameter| {
            let number = matches.try_get_one::<Number>(parameter.row().key);
            Some((parameter, number.ok().flatten()?.clone()))
        };
        let parameters = PARAMETERS.iter().map(|row| row.parameter);
        Self(parameters.filter_map(given).collect())
    }

    /// Returns the name of the first flag given.
    pub(crate) fn first(&self) -> Option<String> {
        self.0.first().map(|(parameter, _)| parameter.flag())
    }

    /// Returns true if a value was given.
    pub(crate) fn has(&self, parameter: Parameter) -> bool {
        self.0.iter().any(|(given, _)| *given == parameter)
    }

    /// Applies the given values of the parameters `own` to `thing`, one after the other, using `with`.
    ///
    /// # Errors
    /// Returns [`CliError::Range`] for the first value out of range.
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

    /// Returns a sensor with the given values.
    pub(crate) fn sensor(&self, sensor: Sensor) -> Result<Sensor, CliError> {
        self.fold(SENSOR_PARAMETERS, sensor, Sensor::with)
    }

    /// Returns the pitch in mm, if it was given.
    pub(crate) fn pitch(&self) -> Result<Option<f64>, CliError> {
        self.fold(&[Parameter::Pitch], None, |_, parameter, value| {
            Sensor::LARGEST.check(parameter, value).map(Some)
        })
    }

    /// Returns the first given parameter that this kind of figure does not have.
    pub(crate) fn foreign(&self, kind: FigureKind) -> Option<Parameter> {
        figure_parameters()
            .filter(|&parameter| !kind.parameters().contains(&parameter))
            .find(|&parameter| self.0.iter().any(|(given, _)| *given == parameter))
    }

    /// Returns the default figure of a kind with the given values.
    pub(crate) fn figure(&self, kind: FigureKind, sensor: &Sensor) -> Result<Figure, CliError> {
        let figure = Figure::default_of(kind, sensor);
        self.fold(kind.parameters(), figure, |figure, parameter, value| {
            figure.with(parameter, value, sensor)
        })
    }

    /// Returns a picture with the given values.
    pub(crate) fn picture(&self, picture: Picture, sensor: &Sensor) -> Result<Picture, CliError> {
        self.fold(PICTURE_PARAMETERS, picture, |picture, parameter, value| {
            picture.with(parameter, value, sensor)
        })
    }
}
