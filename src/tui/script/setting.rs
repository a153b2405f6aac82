//! Settings of a script, before its first other command: how the program starts, and what it finds.
//!
//! ```text
//! Size 80x24          Set ascii on        Set theme light    Set color 256
//! Set columns 8       Set rows 8          Set threshold 0.6  Set pitch 0.5
//! Seed 7
//! Set library "DIR"   Set shape {...}     Set leftover {...}
//! ```
//! `shape` puts a shape into the user's library; it is given as the content of its file, in one line. It may also
//! stand between later commands; of two with the same name, the last counts. `leftover` is unsaved work of a program
//! that crashed. Without `Set library`, a script has a library of its own, which is removed afterwards.

use std::fmt;
use std::path::PathBuf;

use crate::formats::{StoredShape, json};
use crate::parameter::{Parameter, ParameterError};
use crate::quote::{did_you_mean, shortened};
use crate::sensor::{SENSOR_PARAMETERS, Sensor};
use crate::tui::app::state::Options;
use crate::tui::widget::theme::{ColorDepth, Palette};

#[derive(Clone, Debug, PartialEq)]
pub enum ScriptSetting {
    Size(u16, u16),
    Ascii(bool),
    Color(ColorDepth),
    Theme(Palette),
    Sensor(Parameter, f64),
    Library(PathBuf),
    Seed(u64),
    Shape(Box<StoredShape>),
    /// Unsaved work of a program that crashed.
    Leftover(Box<StoredShape>),
}

const NAMES: [&str; 10] = [
    "ascii",
    "color",
    "theme",
    "columns",
    "rows",
    "threshold",
    "pitch",
    "library",
    "shape",
    "leftover",
];

const SWITCH: [(&str, bool); 2] = [("on", true), ("off", false)];

pub fn read(text: &str) -> Result<ScriptSetting, String> {
    let (name, value) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    let value = value.trim();
    match name {
        "ascii" => chosen(name, value, &SWITCH).map(ScriptSetting::Ascii),
        "color" => chosen(name, value, &ColorDepth::NAMES).map(ScriptSetting::Color),
        "theme" => chosen(name, value, &Palette::NAMES).map(ScriptSetting::Theme),
        "library" => serde_json::from_str::<PathBuf>(value)
            .map(ScriptSetting::Library)
            .map_err(|_| {
                format!(
                    "expected a folder in double quotes, found {}",
                    shortened(value)
                )
            }),
        "shape" => shape(name, value).map(ScriptSetting::Shape),
        "leftover" => shape(name, value).map(ScriptSetting::Leftover),
        _ => match Parameter::from_flag(name).filter(|own| SENSOR_PARAMETERS.contains(own)) {
            Some(parameter) => number(parameter, value).map_err(|error| error.to_string()),
            None => Err(format!(
                "{:?} cannot be set, expected one of {}{}",
                shortened(name),
                NAMES.join(", "),
                did_you_mean(name, NAMES)
            )),
        },
    }
}

fn chosen<T: Copy>(name: &str, value: &str, choices: &[(&str, T)]) -> Result<T, String> {
    let choice = choices.iter().find(|(choice, _)| *choice == value);
    choice.map(|(_, meaning)| *meaning).ok_or_else(|| {
        let names: Vec<&str> = choices.iter().map(|(choice, _)| *choice).collect();
        format!(
            "Set {name} takes one of {}, found {:?}",
            names.join(", "),
            shortened(value)
        )
    })
}

fn number(parameter: Parameter, value: &str) -> Result<ScriptSetting, ParameterError> {
    let value = Sensor::LARGEST.read(parameter, value)?;
    Ok(ScriptSetting::Sensor(parameter, value))
}

fn shape(name: &str, value: &str) -> Result<Box<StoredShape>, String> {
    StoredShape::read(value.as_bytes())
        .map(Box::new)
        .map_err(|error| format!("Set {name}: {error}"))
}

impl fmt::Display for ScriptSetting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size(columns, rows) => write!(f, "Size {columns}x{rows}"),
            Self::Seed(seed) => write!(f, "Seed {seed}"),
            Self::Ascii(ascii) => write!(f, "Set ascii {}", name_of(*ascii, &SWITCH)),
            Self::Color(depth) => write!(f, "Set color {}", name_of(*depth, &ColorDepth::NAMES)),
            Self::Theme(palette) => write!(f, "Set theme {}", name_of(*palette, &Palette::NAMES)),
            Self::Sensor(parameter, value) => write!(f, "Set {} {value}", parameter.flag()),
            Self::Library(folder) => {
                let folder = serde_json::Value::from(folder.to_string_lossy());
                write!(f, "Set library {folder}")
            }
            Self::Shape(shape) => write!(f, "Set shape {}", in_a_line(shape)),
            Self::Leftover(shape) => write!(f, "Set leftover {}", in_a_line(shape)),
        }
    }
}

fn name_of<T: Copy + PartialEq>(value: T, choices: &[(&'static str, T)]) -> &'static str {
    let choice = choices.iter().find(|(_, meaning)| *meaning == value);
    choice.map_or("", |(name, _)| name)
}

fn in_a_line(shape: &StoredShape) -> String {
    json::text(shape)
}

/// Returns the settings with which the program was started: its appearance, seed and sensor.
pub fn of_options(options: &Options) -> Vec<ScriptSetting> {
    let (theme, sensor) = (options.theme, options.sensor);
    let look = [
        ScriptSetting::Ascii(theme.ascii),
        ScriptSetting::Color(theme.depth),
        ScriptSetting::Theme(theme.palette),
        ScriptSetting::Seed(options.seed),
    ];
    let value = |parameter| Some(ScriptSetting::Sensor(parameter, sensor.get(parameter)?));
    let values = SENSOR_PARAMETERS.iter().copied().filter_map(value);
    look.into_iter().chain(values).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::Sensor;
    use crate::tui::widget::theme::Theme;

    #[test]
    fn settings_are_read_as_they_were_written() {
        let shape = b"{\"format\":\"taxel-shape/1\",\"name\":\"a b\",\"sensor\":{\"columns\":2,\"rows\":1,\"threshold\":0.1},\
                      \"imprint\":[\"#.\"]}";
        let shape = Box::new(StoredShape::read(shape).expect("a shape"));
        let options = Options {
            sensor: Sensor::default(),
            theme: Theme {
                ascii: false,
                console: false,
                depth: ColorDepth::TwoFiftySix,
                palette: Palette::Light,
            },
            seed: 7,
        };
        let mut settings = of_options(&options);
        settings.extend([
            ScriptSetting::Library("a \"b\"/c".into()),
            ScriptSetting::Sensor(Parameter::Threshold, 0.1),
            ScriptSetting::Shape(shape.clone()),
            ScriptSetting::Leftover(shape),
        ]);
        for setting in settings {
            let line = setting.to_string();
            let Some(text) = line.strip_prefix("Set ") else {
                assert_eq!(line, "Seed 7");
                continue;
            };
            assert_eq!(read(text), Ok(setting), "{line}");
        }
    }
}
