//! Reads the settings file, TOML, and checks its values.
//!
//! Every entry is optional. An unknown entry or a wrong value is an error with its line and column, so a misspelled key
//! is never silently ignored:
//! ```
//! use taxel::cli::settings::file::Config;
//! let config = Config::read("theme = 'light'\n[sensor]\ncolumns = 32\n[keys.matrix]\nx = 'toggle'\n").unwrap();
//! assert_eq!(config.sensor_entries().len(), 1);
//! let error = Config::read("theme = 'light'\ncolour = 'never'\n").unwrap_err();
//! assert_eq!(error.to_string(),
//!     "line 2, column 1: unknown key \"colour\", expected one of theme, color, charset, mouse, library, sensor, source, frames, keys; \
//!      did you mean \"color\"?");
//! ```

use taxel_core::parameter::{Parameter, ParameterError};
use taxel_core::quote::{did_you_mean, shortened_message};
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_files::formats::recording::Format;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::cli::settings::resolved::Choice;
use crate::cli::settings::sensors::{
    FormatSetting, SENSOR_SETTINGS, SensorSetting, SensorSettings, SettingKind,
};
use crate::tui::keys::action;
use crate::tui::keys::key::{Key, parse};
use crate::tui::keys::keymap::{Change, Context, Keymap, KeymapError};
use crate::tui::widget::theme::{ColorDepth, Palette};

pub(crate) const AUTO: &str = "auto";

const TOP: [&str; 9] = [
    "theme", "color", "charset", "mouse", "library", "sensor", "source", "frames", "keys",
];

pub(crate) const CHARSETS: [(&str, bool); 2] = [("ascii", true), ("unicode", false)];

/// The largest settings file, in bytes. The parser may need seventy times the size of a hostile file.
pub const MAX_BYTES: usize = 64 << 10;

#[derive(Clone, Debug, Default)]
pub struct Config {
    pub(crate) theme: Option<Choice<Palette>>,
    pub(crate) color: Option<Choice<ColorDepth>>,
    pub(crate) charset: Option<Choice<bool>>,
    pub(crate) mouse: Option<bool>,
    pub(crate) library: Option<String>,
    sensor: Sensor,
    sensor_entries: Vec<Parameter>,
    sensors: SensorSettings,
    changes: Vec<Change>,
    keymap: Keymap,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: {wrong}")]
pub struct ConfigError {
    /// The line, from 1.
    pub line: usize,
    /// The column in characters, from 1.
    pub column: usize,
    pub wrong: Wrong,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Wrong {
    #[error("larger than 64 KiB, the limit for a file of settings")]
    Large,
    #[error("{0}")]
    Syntax(String),
    #[error(
        "unknown key {found:?}, expected one of {}{}",
        expected.join(", "),
        did_you_mean(found, expected.iter().copied())
    )]
    Unknown {
        found: String,
        expected: Vec<&'static str>,
    },
    #[error("expected {expected}, found {found}")]
    Value { expected: String, found: String },
    #[error(transparent)]
    Sensor(#[from] ParameterError),
    #[error("{0:?} is not a key that can be bound, expected one such as x, <Tab> or <C-x>")]
    Key(String),
    #[error(transparent)]
    Keymap(#[from] KeymapError),
}

type TomlEntry<'t, 'i> = (&'t str, usize, &'t Spanned<DeValue<'i>>);

type Refusal = (usize, Wrong);

impl Config {
    pub fn read(text: &str) -> Result<Self, ConfigError> {
        Self::of(text).map_err(|(byte, wrong)| {
            let (line, column) = line_and_column(text, byte);
            ConfigError {
                line,
                column,
                wrong,
            }
        })
    }

    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    pub fn sensor_entries(&self) -> &[Parameter] {
        &self.sensor_entries
    }

    pub(crate) fn sensors(&self) -> &SensorSettings {
        &self.sensors
    }

    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    pub fn keymap(&self) -> &Keymap {
        &self.keymap
    }

    fn of(text: &str) -> Result<Self, Refusal> {
        if text.len() > MAX_BYTES {
            return Err((0, Wrong::Large));
        }
        let table = DeTable::parse(text).map_err(|error| syntax(text, &error))?;
        let mut config = Self::default();
        for entry in entries(table.get_ref()) {
            config.take(text, entry)?;
        }
        Ok(config)
    }

    fn take(&mut self, text: &str, entry: TomlEntry<'_, '_>) -> Result<(), Refusal> {
        let (key, byte, value) = entry;
        match key {
            "theme" => self.theme = Some(choice(&Palette::NAMES, value)?),
            "color" => self.color = Some(choice(&ColorDepth::NAMES, value)?),
            "charset" => self.charset = Some(choice(&CHARSETS, value)?),
            "mouse" => {
                let wanted = value.get_ref().as_bool();
                self.mouse = Some(wanted.ok_or_else(|| other_kind("true or false", value))?);
            }
            "library" => {
                let path = string(value)?;
                if !path.starts_with('/') && !path.starts_with("~/") {
                    let expected = "a path that starts with / or ~/".to_owned();
                    return Err(unfit(expected, path, value));
                }
                self.library = Some(path.to_owned());
            }
            "sensor" => {
                for (key, byte, value) in entries(table(value)?) {
                    let mut known = SENSOR_PARAMETERS.iter().copied();
                    let known = known.find(|own| own.key_without_unit() == key);
                    let parameter = known.ok_or_else(|| {
                        let names = SENSOR_PARAMETERS.iter().map(|own| own.key_without_unit());
                        unknown(key, byte, &names.collect::<Vec<_>>())
                    })?;
                    let number = number(text, value)?;
                    self.sensor = self
                        .sensor
                        .with(parameter, number)
                        .map_err(|error| (value.span().start, error.into()))?;
                    self.sensor_entries.push(parameter);
                }
            }
            "source" | "frames" => self.take_sensors(text, key, value)?,
            "keys" => self.bind_keys(value)?,
            _ => return Err(unknown(key, byte, &TOP)),
        }
        Ok(())
    }

    fn take_sensors(
        &mut self,
        text: &str,
        name: &str,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<(), Refusal> {
        let rows = || SENSOR_SETTINGS.iter().filter(|row| row.table == name);
        let mut places = Vec::new();
        for (key, byte, value) in entries(table(value)?) {
            let row = rows().find(|row| row.name == key).ok_or_else(|| {
                let names: Vec<&'static str> = rows().map(|row| row.name).collect();
                unknown(key, byte, &names)
            })?;
            fill_sensor(&mut self.sensors, text, row, value)?;
            places.push((row.key, byte));
        }
        let conflict = self.sensors.conflict();
        let found = conflict.and_then(|(key, expected, other)| {
            let place = places.iter().find(|(own, _)| *own == key)?;
            let name = |key| rows().find(|row| row.key == key).map(|row| row.name);
            let names = other.and_then(name).into_iter().chain(name(key));
            let found = names.collect::<Vec<_>>().join(" and ");
            let expected = expected.to_owned();
            Some((place.1, Wrong::Value { expected, found }))
        });
        found.map_or(Ok(()), Err)
    }

    fn bind_keys(&mut self, value: &Spanned<DeValue<'_>>) -> Result<(), Refusal> {
        let mut spans = Vec::new();
        for (name, byte, value) in entries(table(value)?) {
            let known = Context::all().find(|own| own.name() == name);
            let context = known.ok_or_else(|| {
                unknown(
                    name,
                    byte,
                    &Context::all().map(Context::name).collect::<Vec<_>>(),
                )
            })?;
            for (key, byte, value) in entries(table(value)?) {
                let action = match string(value)? {
                    "none" => None,
                    name => {
                        let action = action::named(name);
                        Some(action.ok_or_else(|| no_action(context, name, value))?)
                    }
                };
                let key = one_key(key).ok_or_else(|| (byte, Wrong::Key(shortened_message(key))))?;
                spans.push((byte, value.span().start));
                self.changes.push(Change {
                    context,
                    key,
                    action,
                });
            }
        }
        self.keymap = Keymap::with(&self.changes).map_err(|(index, error)| {
            let (key, value) = spans[index];
            let byte = if matches!(error, KeymapError::Elsewhere { .. }) {
                value
            } else {
                key
            };
            (byte, error.into())
        })?;
        Ok(())
    }
}

/// Returns the entries of a table in the order in which they are written, so that the first error is reported.
fn entries<'t, 'i>(table: &'t DeTable<'i>) -> Vec<TomlEntry<'t, 'i>> {
    let mut entries: Vec<TomlEntry<'_, '_>> = table
        .iter()
        .map(|(key, value)| (&**key.get_ref(), key.span().start, value))
        .collect();
    entries.sort_by_key(|(_, byte, _)| *byte);
    entries
}

fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line = before.split('\n').count();
    let column = before.rfind('\n').map_or(before, |end| &before[end + 1..]);
    (line, column.chars().count() + 1)
}

fn one_key(text: &str) -> Option<Key> {
    match parse(text).ok()?[..] {
        [key] => Some(key),
        _ => None,
    }
}

fn choice<T: Copy, const N: usize>(
    names: &[(&'static str, T); N],
    value: &Spanned<DeValue<'_>>,
) -> Result<Choice<T>, Refusal> {
    let text = string(value)?;
    let known = names.iter().find(|(name, _)| *name == text);
    if known.is_none() && text != AUTO {
        let others: Vec<String> = names.iter().map(|(name, _)| format!("{name:?}")).collect();
        let expected = format!("one of \"{AUTO}\", {}", others.join(", "));
        return Err(unfit(expected, text, value));
    }
    Ok(known.map_or(Choice::Auto, |(_, own)| Choice::Made(*own)))
}

fn string<'t>(value: &'t Spanned<DeValue<'_>>) -> Result<&'t str, Refusal> {
    let text = value.get_ref().as_str();
    text.ok_or_else(|| other_kind("text in quotes", value))
}

fn table<'t, 'i>(value: &'t Spanned<DeValue<'i>>) -> Result<&'t DeTable<'i>, Refusal> {
    let table = value.get_ref().as_table();
    table.ok_or_else(|| other_kind("a table", value))
}

fn fill_sensor(
    sensors: &mut SensorSettings,
    text: &str,
    row: &SensorSetting,
    value: &Spanned<DeValue<'_>>,
) -> Result<(), Refusal> {
    let (is_filled, found) = if let SettingKind::Format { fill } = row.kind {
        let name = string(value)?;
        let format = Format::of_stream(name).ok();
        let is_known = format.is_some() || name == AUTO;
        (is_known && fill(sensors, FormatSetting(format)), name)
    } else {
        let number = number(text, value)?;
        (row.kind.fill(sensors, number), written(text, value))
    };
    if is_filled {
        return Ok(());
    }
    Err(unfit(row.kind.expected(), found, value))
}

fn number(text: &str, value: &Spanned<DeValue<'_>>) -> Result<f64, Refusal> {
    let (digits, decimal) = match value.get_ref() {
        DeValue::Integer(number) => (number.as_str(), number.radix() == 10),
        DeValue::Float(number) => (number.as_str(), true),
        _ => return Err(other_kind("a number", value)),
    };
    let number = digits.parse().ok().filter(|_| decimal);
    number.ok_or_else(|| unfit("a decimal number".to_owned(), written(text, value), value))
}

fn written<'t>(text: &'t str, value: &Spanned<DeValue<'_>>) -> &'t str {
    &text[value.span()]
}

fn unknown(found: &str, byte: usize, expected: &[&'static str]) -> Refusal {
    let (found, expected) = (shortened_message(found), expected.to_vec());
    (byte, Wrong::Unknown { found, expected })
}

fn unfit(expected: String, found: &str, value: &Spanned<DeValue<'_>>) -> Refusal {
    let found = format!("{:?}", shortened_message(found));
    (value.span().start, Wrong::Value { expected, found })
}

fn no_action(context: Context, found: &str, value: &Spanned<DeValue<'_>>) -> Refusal {
    let actions = context.actions().into_iter();
    let names = actions.map(|action| action.name).chain(["none"]);
    let near = did_you_mean(found, names);
    let expected = "an action that 'taxel config' lists, or \"none\"".to_owned();
    let found = format!("{:?}{near}", shortened_message(found));
    (value.span().start, Wrong::Value { expected, found })
}

fn syntax(text: &str, error: &toml::de::Error) -> Refusal {
    let span = error.span().unwrap_or(0..0);
    let message = match (error.message(), text.get(span.clone())) {
        ("duplicate key", Some(key)) => {
            format!("key {:?} is given twice", key.trim_matches(['"', '\'']))
        }
        (message, _) => message.replace('\n', "; "),
    };
    (span.start, Wrong::Syntax(shortened_message(&message)))
}

fn other_kind(expected: &str, value: &Spanned<DeValue<'_>>) -> Refusal {
    let found = value.get_ref().type_str();
    let (expected, found) = (expected.to_owned(), found.to_owned());
    (value.span().start, Wrong::Value { expected, found })
}
