//! Flags made from the table of parameters: name, help text, and the values that were given.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Arg, ArgMatches};

use crate::cli::error::CliError;
use crate::figure::{Figure, FigureKind};
use crate::parameter::{PARAMETERS, Parameter, ParameterError, Unit, number};
use crate::picture::{PICTURE_PARAMETERS, Picture};
use crate::sensor::{SENSOR_PARAMETERS, Sensor};
use crate::storage::Existing;
use crate::tui::widget::columns::broken;

/// Help texts are broken so that they fit 80 columns beside the flags.
const HELP_WIDTH: usize = 52;

/// A number as it was given, for messages, and its value.
#[derive(Clone, Debug)]
struct Number {
    text: String,
    value: f64,
}

/// All parameters that some figure has, in the order of the table.
pub(crate) fn figure_parameters() -> impl Iterator<Item = Parameter> {
    PARAMETERS
        .iter()
        .map(|row| row.parameter)
        .filter(|&parameter| kinds_with(parameter).next().is_some())
}

fn kinds_with(parameter: Parameter) -> impl Iterator<Item = FigureKind> {
    FigureKind::ALL
        .into_iter()
        .filter(move |kind| kind.parameters().contains(&parameter))
}

/// The flag of a parameter; its range and default are those of the default sensor.
pub(crate) fn arg(parameter: Parameter) -> Arg {
    let default = match parameter {
        Parameter::Thickness | Parameter::Pitch => String::new(),
        _ => format!("; default {}", Sensor::default().default_value(parameter)),
    };
    arg_with(parameter, &default)
}

/// The same where a stored shape has values of its own, which stay as they are unless others are given.
pub(crate) fn arg_with_own(parameter: Parameter) -> Arg {
    match parameter {
        Parameter::Angle | Parameter::ZoomX | Parameter::ZoomY | Parameter::Pitch => arg(parameter),
        _ => arg_with(parameter, "; default its own"),
    }
}

fn arg_with(parameter: Parameter, default: &str) -> Arg {
    let row = parameter.row();
    let unit = match row.unit {
        Unit::Ratio => String::new(),
        unit => format!("{}, ", unit.symbol()),
    };
    let also = match parameter {
        Parameter::Pitch => "; gives lengths and areas in mm too",
        _ => "",
    };
    let range = Sensor::default().range(parameter);
    let meaning = capitalised(row.meaning);
    let help = format!("{meaning}{also} ({unit}{range}{default})");
    Arg::new(row.key)
        .long(parameter.flag())
        .value_name(match row.unit {
            Unit::Ratio => "NUMBER".to_owned(),
            unit => unit.symbol().to_ascii_uppercase(),
        })
        .help(wrapped(&help, HELP_WIDTH))
        // A minus sign begins a number here, not a flag.
        .allow_hyphen_values(true)
        .value_parser(parse)
}

fn parse(text: &str) -> Result<Number, String> {
    let value = number::read(text).ok_or_else(|| number::complaint(text))?;
    let text = text.trim().to_owned();
    Ok(Number { text, value })
}

/// Accepts one of some names, and gives what it stands for.
pub(super) fn one_of<T: Clone + Send + Sync + 'static, const N: usize>(
    names: [&'static str; N],
    named: fn(&str) -> Option<T>,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names).try_map(move |name| named(&name).ok_or("not one of the names"))
}

/// As clap writes its own help texts.
pub(crate) fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(characters).collect()
}

/// Breaks a text at spaces into lines of at most `width` columns.
pub(crate) fn wrapped(text: &str, width: usize) -> String {
    broken(text, width).join("\n")
}

/// The values that were given by flags, not checked yet.
#[derive(Clone, Debug, Default)]
pub(crate) struct Given(Vec<(Parameter, Number)>);

impl Given {
    /// Those of a command; it needs not have all the flags.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let given = |parameter: Parameter| {
            let number = matches.try_get_one::<Number>(parameter.row().key);
            Some((parameter, number.ok().flatten()?.clone()))
        };
        let parameters = PARAMETERS.iter().map(|row| row.parameter);
        Self(parameters.filter_map(given).collect())
    }

    /// The name of the first flag.
    pub(crate) fn first(&self) -> Option<String> {
        self.0.first().map(|(parameter, _)| parameter.flag())
    }

    /// Whether a value was given.
    pub(crate) fn has(&self, parameter: Parameter) -> bool {
        self.0.iter().any(|(given, _)| *given == parameter)
    }

    /// Gives a thing the values among `own`, one after the other.
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
                    expected: error.expected(),
                })?;
            }
        }
        Ok(thing)
    }

    /// A sensor with what was given.
    pub(crate) fn sensor(&self, sensor: Sensor) -> Result<Sensor, CliError> {
        self.fold(&SENSOR_PARAMETERS, sensor, Sensor::with)
    }

    /// The pitch in mm, where one was given.
    pub(crate) fn pitch(&self) -> Result<Option<f64>, CliError> {
        self.fold(&[Parameter::Pitch], None, |_, parameter, value| {
            Sensor::LARGEST.check(parameter, value).map(Some)
        })
    }

    /// The first flag that was given though this kind of figure has no such parameter.
    pub(crate) fn foreign(&self, kind: FigureKind) -> Option<Parameter> {
        figure_parameters()
            .filter(|&parameter| !kind.parameters().contains(&parameter))
            .find(|&parameter| self.0.iter().any(|(given, _)| *given == parameter))
    }

    /// The default figure of a kind with what was given.
    pub(crate) fn figure(&self, kind: FigureKind, sensor: &Sensor) -> Result<Figure, CliError> {
        let figure = Figure::default_of(kind, sensor);
        self.fold(kind.parameters(), figure, |figure, parameter, value| {
            figure.with(parameter, value, sensor)
        })
    }

    /// A picture with what was given.
    pub(crate) fn picture(&self, picture: Picture, sensor: &Sensor) -> Result<Picture, CliError> {
        self.fold(&PICTURE_PARAMETERS, picture, |picture, parameter, value| {
            picture.with(parameter, value, sensor)
        })
    }
}

/// What happens to files that are there, by `--force`.
pub(crate) fn existing(matches: &ArgMatches) -> Existing {
    if matches.get_flag("force") {
        Existing::Replaced
    } else {
        Existing::Kept
    }
}
