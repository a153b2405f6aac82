//! The flags of figures, pictures, sensors and grids, made from the table of parameters: a row gives a flag its name,
//! value name and help with range and default.
//!
//! A command flattens a group of them, such as [`SensorFlags`], into its arguments. clap only checks that a value is a
//! number. Its range depends on the sensor, which other flags may change, so a group collects the numbers, and they are
//! checked when a sensor, figure or picture is made from them.

use std::ops::Deref;

use clap::{Arg, ArgMatches, Args, Command, Error, FromArgMatches};
use taxel_core::figure::{Figure, FigureKind};
use taxel_core::parameter::{PARAMETERS, Parameter, ParameterError, Unit, number};
use taxel_core::picture::PICTURE_PARAMETERS;
use taxel_core::pose::{Axis, DecimalRange, GivenRanges, RangeError, Ranges};
use taxel_core::quote::joined;
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_core::source::Source;

use crate::cli::failure::Failure;
use crate::cli::settings::{Pitch, Settings};

/// The groups, by number: heading, parameters, and what the help says about the value of a flag that is left out. A
/// command flattens `Flags<NUMBER>` into its arguments.
fn group(number: usize) -> (&'static str, Vec<Parameter>, fn(Parameter) -> String) {
    let is_axis = |own: &Parameter| Axis::ALL.iter().any(|axis| axis.parameter() == *own);
    let sizes = || figure_parameters().filter(|own| !is_axis(own));
    let fitting = |own| match own {
        Parameter::Threshold | Parameter::Pitch => usual(own),
        _ => "; default large enough for all shapes, at least 16".to_owned(),
    };
    match number {
        0 => ("Figure", figure_parameters().collect(), usual),
        1 => ("Figure", sizes().collect(), usual),
        2 => ("Picture", PICTURE_PARAMETERS.to_vec(), of_shape),
        3 => ("Sensor", SENSOR_PARAMETERS.to_vec(), usual),
        4 => ("Sensor", SENSOR_PARAMETERS.to_vec(), of_shape),
        5 => ("Sensor", SENSOR_PARAMETERS.to_vec(), fitting),
        6 => ("Sensor", vec![Parameter::Threshold], |_| {
            "; default that of the model, or 0.5".to_owned()
        }),
        _ => ("Sensor", vec![Parameter::Pitch], usual),
    }
}

/// All parameters of all kinds of figures.
pub(crate) type FigureFlags = Flags<0>;

/// The sizes and the thickness of figures, without their place, for sweeps.
pub(crate) type SizeFlags = Flags<1>;

pub(crate) type PictureFlags = Flags<2>;

pub(crate) type SensorFlags = Flags<3>;

/// The sensor of a stored shape.
pub(crate) type OwnSensorFlags = Flags<4>;

/// A sensor that is large enough for all shapes unless its sides are given.
pub(crate) type FittingSensorFlags = Flags<5>;

/// The threshold of a model's sensor.
pub(crate) type ThresholdFlag = Flags<6>;

pub(crate) type PitchFlag = Flags<7>;

/// The values that a group of flags gives.
#[derive(Clone, Debug, Default)]
pub(crate) struct Flags<const GROUP: usize>(Given);

impl<const GROUP: usize> Deref for Flags<GROUP> {
    type Target = Given;

    fn deref(&self) -> &Given {
        &self.0
    }
}

impl<const GROUP: usize> Args for Flags<GROUP> {
    fn augment_args(command: Command) -> Command {
        let (heading, parameters, default) = group(GROUP);
        let flag = |own| arg(own, &default(own)).help_heading(heading);
        command.args(parameters.into_iter().map(flag))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<const GROUP: usize> FromArgMatches for Flags<GROUP> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let given = group(GROUP).1.into_iter().filter_map(|parameter| {
            let number = matches.try_get_one::<Number>(parameter.row().key);
            Some((parameter, number.ok().flatten()?.clone()))
        });
        Ok(Self(Given(given.collect())))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

fn usual(parameter: Parameter) -> String {
    match parameter {
        Parameter::Thickness | Parameter::Pitch => String::new(),
        _ => format!("; default {}", Sensor::default().default_value(parameter)),
    }
}

fn of_shape(parameter: Parameter) -> String {
    match parameter {
        Parameter::Angle | Parameter::ZoomX | Parameter::ZoomY | Parameter::Pitch => {
            usual(parameter)
        }
        _ => "; default the shape's".to_owned(),
    }
}

pub(crate) fn figure_parameters() -> impl Iterator<Item = Parameter> {
    let all = PARAMETERS.iter().map(|row| row.parameter);
    all.filter(|parameter| {
        let mut kinds = FigureKind::ALL.iter();
        kinds.any(|kind| kind.parameters().contains(parameter))
    })
}

pub(crate) fn arg(parameter: Parameter, default: &str) -> Arg {
    let row = parameter.row();
    let (unit, value_name) = match row.unit {
        Unit::Ratio => (String::new(), "NUMBER".to_owned()),
        unit => (
            format!("{}, ", unit.name()),
            unit.name().to_ascii_uppercase(),
        ),
    };
    let also = match parameter {
        Parameter::Pitch => "; converts lengths in mm, adds mm to tables and drawings",
        _ => "",
    };
    let range = Sensor::default().range(parameter);
    let meaning = capitalised(row.meaning);
    Arg::new(row.key)
        .long(parameter.flag())
        .value_name(value_name)
        .help(format!("{meaning}{also} ({unit}{range}{default})"))
        // A minus sign starts a number here, not a flag.
        .allow_hyphen_values(true)
        .value_parser(parse)
}

#[derive(Clone, Debug)]
struct Number {
    text: String,
    value: f64,
}

fn parse(text: &str) -> Result<Number, String> {
    let value = number::read(text).ok_or_else(|| number::complaint(text))?;
    let text = text.trim().to_owned();
    Ok(Number { text, value })
}

fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(characters).collect()
}

/// The values given by flags. They are numbers, but may be out of range.
#[derive(Clone, Debug, Default)]
pub(crate) struct Given(Vec<(Parameter, Number)>);

impl Given {
    /// The first flag that is given, without its dashes.
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
    ) -> Result<T, Failure> {
        for (parameter, number) in &self.0 {
            if own.contains(parameter) {
                thing = with(thing, *parameter, number.value).map_err(|error| {
                    let (flag, complaint) = (parameter.flag(), error.complaint());
                    Failure::new(format!("--{flag} {} {complaint}", number.text))
                })?;
            }
        }
        Ok(thing)
    }

    pub(crate) fn sensor(&self, sensor: Sensor) -> Result<Sensor, Failure> {
        self.fold(SENSOR_PARAMETERS, sensor, Sensor::with)
    }

    /// The pitch that the flag gives, and that of the settings.
    pub(crate) fn pitch(&self, settings: &Settings) -> Result<Pitch, Failure> {
        let given = self.fold(&[Parameter::Pitch], None, |_, parameter, value| {
            Sensor::LARGEST.check(parameter, value).map(Some)
        })?;
        let usual = settings.sensor.pitch;
        Ok(Pitch { given, usual })
    }

    /// A figure with the given values. Flags that its kind does not have are refused.
    pub(crate) fn figure(&self, kind: FigureKind, sensor: &Sensor) -> Result<Figure, Failure> {
        let own = kind.parameters();
        if let Some(foreign) = figure_parameters().find(|it| self.has(*it) && !own.contains(it)) {
            let flags = own.iter().map(|own| format!("--{}", own.flag()));
            return Err(Failure::usage(format!(
                "'--{}' does not belong to '{}', which takes {}",
                foreign.flag(),
                kind.name(),
                joined(flags, "and")
            )));
        }
        let figure = Figure::default_of(kind, sensor);
        self.fold(own, figure, |figure, parameter, value| {
            figure.with(parameter, value, sensor)
        })
    }

    /// A picture or an outline with the given values.
    pub(crate) fn picture(&self, source: Source, sensor: &Sensor) -> Result<Source, Failure> {
        self.fold(PICTURE_PARAMETERS, source, |source, parameter, value| {
            source.with(parameter, value, sensor)
        })
    }
}

/// The ranges of a grid of poses, such as `--x0 5:5.99:0.01`.
#[derive(Clone, Debug)]
pub(crate) struct RangeFlags(pub(crate) GivenRanges);

impl Args for RangeFlags {
    fn augment_args(command: Command) -> Command {
        command.args(Axis::ALL.map(|axis| match axis {
            Axis::X0 | Axis::Y0 => range(axis, "one cell in which nothing is cut off"),
            _ => range(axis, &Ranges::default()[axis].to_string()),
        }))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for RangeFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        Ok(Self(GivenRanges::from_fn(|axis| {
            let range = matches.get_one(&format!("range_{}", axis.name()));
            range.copied()
        })))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

fn range(axis: Axis, default: &str) -> Arg {
    let (row, flag) = (axis.parameter().row(), axis.parameter().flag());
    let meaning = capitalised(row.meaning);
    Arg::new(format!("range_{}", row.key))
        .long(flag)
        .value_name("RANGE")
        .allow_hyphen_values(true)
        .value_parser(parse_range)
        .help_heading("Grid")
        .help(format!("{meaning}; default {default}"))
}

/// Parses a range. clap quotes the argument, so the message does not quote the whole of it again.
pub(crate) fn parse_range(text: &str) -> Result<DecimalRange, String> {
    text.parse().map_err(|error: RangeError| match &error {
        RangeError::Form(_) => error.expected(),
        RangeError::Number(part) if part == text => number::complaint(text),
        _ => error.to_string(),
    })
}
