//! The settings in force: those of the file, changed by the environment and the flags.
//!
//! The file is TOML; everything in it is optional. What it does not know is an error with its line and column, so a
//! misspelt key is never silently ignored. Empty environment variables count as unset, as is usual for `NO_COLOR`.
//! ```
//! use taxel::cli::settings::Settings;
//! assert!(Settings::read("theme = 'light'\n[sensor]\ncolumns = 32\n[keys.matrix]\nx = 'toggle'\n").is_ok());
//! let error = Settings::read("theme = 'light'\ncolour = 'never'\n").unwrap_err();
//! assert!(error.starts_with("line 2, column 1: unknown field `colour`, expected one of `theme`, `color`"));
//! ```

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use taxel_core::frame::{FrameSize, Processing, Rule, RuleOrigin, SetRule};
use taxel_core::parameter::{Parameter, ParameterError, UnknownName};
use taxel_core::quote::shortened_message;
use taxel_core::sensor::Sensor;
use taxel_files::acquire::AcquireOptions;
use taxel_files::formats::file::is_missing;
use taxel_files::formats::recording::Format;
use taxel_files::storage::{LIBRARY_VARIABLE, below_home, usual_folder};

use crate::cli::arguments::parameters::Given;
use crate::cli::commands::screen::Look;
use crate::cli::failure::{Failure, Named};
use crate::cli::output::charset::Charset;
use crate::frames::{HISTORY_BYTES, Pipeline, WatchRequest};
use crate::tui::keys::action::{self, Action};
use crate::tui::keys::{Change, Context, Key, Keymap, parse};
use crate::tui::widget::{ColorDepth, Palette};

const VARIABLE: &str = "TAXEL_CONFIG";

/// The largest settings file, in bytes. The parser may need seventy times the size of a hostile file.
const MAX_BYTES: u64 = 64 << 10;

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    pub(crate) theme: Choice<Palette>,
    pub(crate) color: Choice<ColorDepth>,
    pub(crate) charset: Choice<Charset>,
    pub(crate) mouse: bool,
    /// The folder of the library; None if the user has no home and nothing names another folder.
    #[serde(deserialize_with = "below", serialize_with = "absolute")]
    pub(crate) library: Option<PathBuf>,
    pub(crate) sensor: SensorSettings,
    #[serde(deserialize_with = "whole_size")]
    pub(crate) source: SourceSettings,
    #[serde(deserialize_with = "one_rule")]
    pub(crate) frames: FrameSettings,
    keys: Keys,
    /// The path of the file and whether it is there; None if the user has no home.
    #[serde(skip)]
    file: Option<(PathBuf, bool)>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: Choice::Auto,
            color: Choice::Auto,
            charset: Choice::Auto,
            mouse: true,
            library: usual_folder(),
            sensor: SensorSettings::default(),
            source: SourceSettings::default(),
            frames: FrameSettings::default(),
            keys: Keys::default(),
            file: None,
        }
    }
}

/// The sensor of simulated touches.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
#[serde(try_from = "SensorTable", into = "SensorTable")]
pub(crate) struct SensorSettings {
    pub(crate) sensor: Sensor,
    /// The pitch in mm, if it is set. With the default pitch, nothing is shown in mm.
    pub(crate) pitch: Option<f64>,
}

#[derive(Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
struct SensorTable {
    columns: Option<u16>,
    rows: Option<u16>,
    threshold: Option<f64>,
    pitch: Option<f64>,
}

impl TryFrom<SensorTable> for SensorSettings {
    type Error = ParameterError;

    fn try_from(table: SensorTable) -> Result<Self, ParameterError> {
        let values = [
            (Parameter::Columns, table.columns.map(f64::from)),
            (Parameter::Rows, table.rows.map(f64::from)),
            (Parameter::Threshold, table.threshold),
            (Parameter::Pitch, table.pitch),
        ];
        let mut sensor = Sensor::default();
        for (parameter, value) in values {
            if let Some(value) = value {
                sensor = sensor.with(parameter, value)?;
            }
        }
        let pitch = table.pitch;
        Ok(Self { sensor, pitch })
    }
}

impl From<SensorSettings> for SensorTable {
    fn from(own: SensorSettings) -> Self {
        Self {
            columns: Some(own.sensor.columns().into()),
            rows: Some(own.sensor.rows().into()),
            threshold: Some(own.sensor.threshold()),
            pitch: own.pitch,
        }
    }
}

/// Streams of real sensors.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(crate) struct SourceSettings {
    format: StreamFormat,
    #[serde(deserialize_with = "whole::<_, _, 50, 20_000_000>")]
    baud: Option<u32>,
    rows: Option<u16>,
    columns: Option<u16>,
}

/// The format of a stream by its name; None for `auto`.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(try_from = "String", into = "&'static str")]
struct StreamFormat(Option<&'static Format>);

impl TryFrom<String> for StreamFormat {
    type Error = UnknownName;

    fn try_from(name: String) -> Result<Self, UnknownName> {
        let is_auto = name == "auto";
        let format = (!is_auto).then(|| Format::of_stream(&name)).transpose()?;
        Ok(Self(format))
    }
}

impl From<StreamFormat> for &'static str {
    fn from(format: StreamFormat) -> Self {
        let format = format.0.and_then(|format| format.stream);
        format.unwrap_or("auto")
    }
}

impl Default for SourceSettings {
    fn default() -> Self {
        Self {
            format: StreamFormat(None),
            baud: Some(AcquireOptions::BAUD),
            rows: None,
            columns: None,
        }
    }
}

/// Frames of real sensors, live or recorded.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(crate) struct FrameSettings {
    at_least: Option<f64>,
    percent: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    #[serde(deserialize_with = "whole::<_, _, 1, 4096>")]
    pub(crate) least: Option<u32>,
    #[serde(deserialize_with = "whole::<_, _, 0, 1_000_000>")]
    pub(crate) tare: Option<u64>,
    #[serde(deserialize_with = "history")]
    pub(crate) history_bytes: usize,
}

impl Default for FrameSettings {
    fn default() -> Self {
        Self {
            at_least: None,
            percent: None,
            low: None,
            high: None,
            least: None,
            tare: None,
            history_bytes: HISTORY_BYTES,
        }
    }
}

impl FrameSettings {
    /// The threshold, or None if none is set; the error says what is expected.
    fn rule(&self) -> Result<Option<Rule>, String> {
        let rule = match (self.at_least, self.percent, self.low, self.high) {
            (None, None, None, None) => return Ok(None),
            (Some(threshold), None, None, None) => Rule::at_least(threshold),
            (None, Some(percent), None, None) => Rule::percent(percent),
            (None, None, Some(low), Some(high)) => Rule::hysteresis(low, high),
            _ => return Err("expected at_least, percent, or low and high".to_owned()),
        };
        rule.map(Some).map_err(|error| error.to_string())
    }
}

/// The keys of the screen: `[keys.PLACE]` has lines `"KEY" = "ACTION"`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(try_from = "BTreeMap<Place, BTreeMap<BoundKey, Act>>")]
struct Keys {
    changes: Vec<Change>,
    keymap: Keymap,
}

#[derive(Deserialize, PartialEq, Eq, PartialOrd, Ord)]
#[serde(try_from = "String")]
struct Place(Context);

impl TryFrom<String> for Place {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let known = Context::all().find(|own| own.name() == name).map(Self);
        known.ok_or_else(|| format!("no place named {name:?}; 'taxel config' lists them"))
    }
}

/// A key as it is written: two spellings of one key are not the same entry, so that it is found out.
#[derive(Deserialize, PartialEq, Eq, PartialOrd, Ord)]
#[serde(try_from = "String")]
struct BoundKey(String);

impl BoundKey {
    fn key(&self) -> Option<Key> {
        parse(&self.0).ok()?.first().copied()
    }
}

impl TryFrom<String> for BoundKey {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        if parse(&text).is_ok_and(|keys| keys.len() == 1) {
            return Ok(Self(text));
        }
        let expected = "expected one such as x, <Tab> or <C-x>";
        Err(format!(
            "{text:?} is not a key that can be bound, {expected}"
        ))
    }
}

#[derive(Deserialize)]
#[serde(try_from = "String")]
struct Act(Option<&'static Action>);

impl TryFrom<String> for Act {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        if name == "none" {
            return Ok(Self(None));
        }
        let action = action::named(&name).map(|action| Self(Some(action)));
        action.ok_or_else(|| {
            format!("expected an action that 'taxel config' lists, or \"none\", found {name:?}")
        })
    }
}

impl TryFrom<BTreeMap<Place, BTreeMap<BoundKey, Act>>> for Keys {
    type Error = String;

    fn try_from(places: BTreeMap<Place, BTreeMap<BoundKey, Act>>) -> Result<Self, String> {
        let mut changes = Vec::new();
        for (place, keys) in places {
            for (key, action) in keys {
                changes.extend(key.key().map(|key| Change {
                    context: place.0,
                    key,
                    action: action.0,
                }));
            }
        }
        // What holds anyway is no change, as in the output of 'taxel config'.
        let usual = Keymap::default();
        changes.retain(|change| {
            let mut keys = usual.of(change.context).flat_map(|row| row.keys.iter());
            !keys.any(|(key, action)| *key == change.key && Some(*action) == change.action)
        });
        let keymap = Keymap::with(&changes)?;
        Ok(Self { changes, keymap })
    }
}

impl Serialize for Keys {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(Context::all().map(|place| {
            let rows = self.keymap.of(place).flat_map(|row| row.keys.iter());
            let bound = rows.map(|(key, action)| (key.to_string(), action.name));
            let changes = self.changes.iter();
            let freed = changes.filter(|own| own.context == place && own.action.is_none());
            let freed = freed.map(|own| (own.key.to_string(), "none"));
            (place.name(), bound.chain(freed).collect::<BTreeMap<_, _>>())
        }))
    }
}

impl Settings {
    /// Reads the text of a settings file. An error begins with its line and column.
    pub fn read(text: &str) -> Result<Self, String> {
        toml::from_str(text).map_err(|error| {
            let before = &text[..error.span().map_or(0, |span| span.start).min(text.len())];
            let line = before.split('\n').count();
            let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
            let message = shortened_message(&error.message().replace('\n', "; "));
            format!("line {line}, column {column}: {message}")
        })
    }

    /// Reads the settings file: that of `--config`, or else of `TAXEL_CONFIG`, or else the user's own. Only the
    /// user's own file may be missing.
    pub(crate) fn find(asked: Option<PathBuf>) -> Result<Self, Failure> {
        let variable = std::env::var_os(VARIABLE).filter(|value| !value.is_empty());
        let asked = asked.or_else(|| variable.map(PathBuf::from));
        let own = || directories::ProjectDirs::from("", "", "taxel");
        let (path, may_be_missing) = match asked {
            Some(path) => (path, false),
            None => match own() {
                Some(own) => (own.config_dir().join("config.toml"), true),
                None => return Ok(Self::default()),
            },
        };
        let mut text = String::new();
        let read = File::open(&path).and_then(|file| {
            let mut file = file.take(MAX_BYTES + 1);
            file.read_to_string(&mut text)
        });
        let too_large = "larger than 64 KiB, the limit for a file of settings";
        let settings = match read {
            Err(error) if may_be_missing && is_missing(&error) => Ok(Self::default()),
            Err(error) => Err(error).named("cannot read"),
            Ok(length) if length as u64 > MAX_BYTES => Err(Failure::new(too_large)),
            Ok(_) => Self::read(&text).map_err(Failure::new),
        };
        let settings = settings.named(path.display());
        let is_there = path.exists();
        Ok(Self {
            file: Some((path, is_there)),
            ..settings.map_err(|failure| failure.with_status(2))?
        })
    }

    pub(crate) fn with_environment(mut self) -> Self {
        let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
        // https://no-color.org
        if set("NO_COLOR").is_some() {
            self.color = Choice::Made(ColorDepth::Never);
        }
        if let Some(folder) = set(LIBRARY_VARIABLE) {
            self.library = Some(folder.into());
        }
        self
    }

    /// These settings with the flags of the screen and the sensor.
    pub(crate) fn with(&self, look: &Look, given: &Given) -> Result<Self, Failure> {
        let sensor = given.sensor(self.sensor.sensor)?;
        let is_pitched = self.sensor.pitch.is_some() || given.has(Parameter::Pitch);
        Ok(Self {
            theme: look.theme.unwrap_or(self.theme),
            color: look.color.unwrap_or(self.color),
            mouse: self.mouse && !look.no_mouse,
            sensor: SensorSettings {
                sensor,
                pitch: is_pitched.then(|| sensor.pitch_mm()),
            },
            ..self.clone()
        })
    }

    pub fn keymap(&self) -> &Keymap {
        &self.keys.keymap
    }

    /// What `:watch SOURCE` on the screen begins with.
    pub(crate) fn watch_request(&self) -> WatchRequest {
        let mut request = WatchRequest::new("");
        let (source, options) = (&self.source, &mut request.options);
        options.stream_format = source.format.0;
        options.baud = source.baud.or(options.baud);
        options.stream_size = FrameSize::of_sides(source.columns, source.rows);
        let (least, from) = (self.frames.least.unwrap_or_default(), RuleOrigin::Settings);
        let mut processing = Processing::default();
        processing.least = least;
        // It was checked when it was read.
        let rule = self.frames.rule().ok().flatten();
        processing.apply_rule(rule.map(|rule| SetRule { rule, least, from }));
        request.pipeline = Pipeline::new(processing, self.frames.tare, from);
        request.history_bytes = self.frames.history_bytes;
        request
    }

    /// The settings in force as a settings file, below a comment with the path of their file.
    pub(crate) fn text(&self) -> Result<String, Failure> {
        let path = match &self.file {
            Some((path, true)) => path.display().to_string(),
            Some((path, false)) => format!("{} (not there)", path.display()),
            None => "no file".to_owned(),
        };
        let path = Charset::current().line(&path);
        Ok(format!("# {path}\n{}", toml::to_string(self)?))
    }
}

/// `auto`, with which the program chooses, or a value by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Choice<T> {
    #[default]
    Auto,
    Made(T),
}

pub(crate) trait Choosable: Copy + PartialEq + Send + Sync + 'static {
    const NAMED: &'static [(&'static str, Self)];
}

impl Choosable for Palette {
    const NAMED: &'static [(&'static str, Self)] = &Self::NAMES;
}

impl Choosable for ColorDepth {
    const NAMED: &'static [(&'static str, Self)] = &Self::NAMES;
}

impl Choosable for Charset {
    const NAMED: &'static [(&'static str, Self)] =
        &[("ascii", Self::Ascii), ("unicode", Self::Unicode)];
}

impl<T: Choosable> Choice<T> {
    pub(crate) fn names() -> impl Iterator<Item = &'static str> {
        std::iter::once("auto").chain(T::NAMED.iter().map(|(name, _)| *name))
    }

    pub(crate) fn named(name: &str) -> Option<Self> {
        let known = T::NAMED.iter().find(|(own, _)| *own == name);
        let known = known.map(|(_, value)| Self::Made(*value));
        known.or((name == "auto").then_some(Self::Auto))
    }

    pub(crate) fn made(self) -> Option<T> {
        match self {
            Self::Auto => None,
            Self::Made(value) => Some(value),
        }
    }
}

impl<'de, T: Choosable> Deserialize<'de> for Choice<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let name = String::deserialize(from)?;
        Self::named(&name).ok_or_else(|| {
            let names = Self::names().collect::<Vec<_>>().join(", ");
            D::Error::custom(format!("expected one of {names}, found {name:?}"))
        })
    }
}

impl<T: Choosable> Serialize for Choice<T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut named = T::NAMED.iter();
        let name = self.made().and_then(|own| named.find(|(_, it)| *it == own));
        to.serialize_str(name.map_or("auto", |(name, _)| name))
    }
}

/// A whole number within a range.
fn whole<'de, T, D, const LEAST: i64, const MOST: i64>(from: D) -> Result<Option<T>, D::Error>
where
    T: TryFrom<i64>,
    D: Deserializer<'de>,
{
    let number = i64::deserialize(from)?;
    let allowed = (LEAST..=MOST).contains(&number).then_some(number);
    let expected = || D::Error::custom(format!("expected a whole number from {LEAST} to {MOST}"));
    let number = allowed.and_then(|number| T::try_from(number).ok());
    number.map(Some).ok_or_else(expected)
}

fn history<'de, D: Deserializer<'de>>(from: D) -> Result<usize, D::Error> {
    let bytes = whole::<_, _, 65_536, 1_099_511_627_776>(from)?;
    Ok(bytes.unwrap_or(HISTORY_BYTES))
}

fn whole_size<'de, D: Deserializer<'de>>(from: D) -> Result<SourceSettings, D::Error> {
    let own = SourceSettings::deserialize(from)?;
    let sides = (own.columns.is_some(), own.rows.is_some());
    if sides != (false, false) && FrameSize::of_sides(own.columns, own.rows).is_none() {
        let (least, most) = FrameSize::SIDES.into_inner();
        let expected = format!("expected rows and columns together, {least} to {most} each");
        return Err(D::Error::custom(expected));
    }
    Ok(own)
}

fn one_rule<'de, D: Deserializer<'de>>(from: D) -> Result<FrameSettings, D::Error> {
    let own = FrameSettings::deserialize(from)?;
    own.rule().map_err(D::Error::custom)?;
    Ok(own)
}

fn below<'de, D: Deserializer<'de>>(from: D) -> Result<Option<PathBuf>, D::Error> {
    let path = String::deserialize(from)?;
    if !path.starts_with('/') && !path.starts_with("~/") {
        let expected = "expected a path that starts with / or ~/";
        return Err(D::Error::custom(expected));
    }
    Ok(below_home(&path))
}

/// Writes the folder so that it means the same from everywhere.
#[expect(clippy::ref_option, reason = "serde passes it so")]
fn absolute<S: Serializer>(folder: &Option<PathBuf>, to: S) -> Result<S::Ok, S::Error> {
    let absolute = folder
        .as_ref()
        .map(|own| std::path::absolute(own).unwrap_or(own.clone()));
    absolute
        .map(|own| own.to_string_lossy().into_owned())
        .serialize(to)
}

/// The sources of the pitch in mm that are known before a stored shape is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pitch {
    pub(crate) given: Option<f64>,
    pub(crate) usual: Option<f64>,
}

impl Pitch {
    /// The pitch in effect, in mm: that of the flag, or else of a stored shape's sensor, or else of the settings; None
    /// if none of them sets one.
    ///
    /// A sensor with the default pitch counts as not setting one: shapes stored without a pitch have it too.
    pub(crate) fn of(self, sensor: Option<&Sensor>) -> Option<f64> {
        let own = sensor.map(Sensor::pitch_mm);
        let own = own.filter(|&pitch| pitch != Sensor::default().pitch_mm());
        self.given.or(own).or(self.usual)
    }
}
