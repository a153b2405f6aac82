//! The settings in effect, each with its origin.
//!
//! A flag beats the environment, the environment beats the file, the file beats the default. `taxel config` prints the
//! result as a settings file in which a comment names the origin of each line:
//! ```text
//! # ~/.config/taxel/config.toml
//! theme = "light"                        # file, line 1
//! color = "never"                        # environment, NO_COLOR
//! mouse = true                           # default
//! ```
//!
//! Empty environment variables count as unset, as is usual for `NO_COLOR`. The user's own file is read for every
//! command whose output depends on settings. An error in the file is an error of the command, with its place:
//! `~/.config/taxel/config.toml: line 3, column 9: …`.

use std::ffi::OsString;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::cli::error::CliError;
use crate::cli::output::charset::Charset;
use crate::cli::settings::file::{AUTO, CHARSETS, Config, MAX_BYTES, Wrong};
use crate::cli::settings::flags::Chosen;
use crate::cli::settings::sensors::{SENSOR_SETTINGS, SensorSettings, TABLES, Written};
use crate::formats::system_error::{is_missing, system_reason};
use crate::parameter::Parameter;
use crate::sensor::{SENSOR_PARAMETERS, Sensor};
use crate::storage::location;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::theme::{ColorDepth, Palette};

/// The environment variable that names the settings file.
pub(crate) const VARIABLE: &str = "TAXEL_CONFIG";

/// The settings file, or an empty one if there is none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Loaded {
    /// The path of the file, even if it does not exist; None if the user has no home.
    path: Option<PathBuf>,
    /// Whether the file exists.
    there: bool,
    /// The content; empty if there is no file.
    config: Config,
}

impl Loaded {
    /// Reads the settings file: that of `--config`, or else of `TAXEL_CONFIG`, or else the user's own. Only the
    /// user's own file may be missing.
    ///
    /// # Errors
    /// Returns [`CliError::Settings`] if the file cannot be read or has an error.
    pub(crate) fn find(asked: Option<PathBuf>) -> Result<Self, CliError> {
        let variable = std::env::var_os(VARIABLE).filter(|value| !value.is_empty());
        if let Some(path) = asked.or_else(|| variable.map(PathBuf::from)) {
            return Self::read(path, false);
        }
        let own = directories::ProjectDirs::from("", "", "taxel");
        own.map_or_else(
            || Ok(Self::default()),
            |own| Self::read(own.config_dir().join("config.toml"), true),
        )
    }

    /// Reads a settings file, but at most one byte more than [`MAX_BYTES`].
    fn read(path: PathBuf, may_be_missing: bool) -> Result<Self, CliError> {
        let name = path.display();
        let failure = |message: String| CliError::Settings {
            place: name.to_string(),
            message,
        };
        let mut bytes = Vec::new();
        let limit = MAX_BYTES as u64;
        let read = open(&path).and_then(|file| file.take(limit + 1).read_to_end(&mut bytes));
        let there = match read {
            Err(error) if may_be_missing && has_no_file(&path, &error) => false,
            Err(error) => return Err(failure(format!("cannot read: {}", system_reason(&error)))),
            Ok(_) => true,
        };
        if bytes.len() > MAX_BYTES {
            return Err(failure(Wrong::Large.to_string()));
        }
        let text = String::from_utf8(bytes).map_err(|_| failure("not UTF-8".to_owned()))?;
        let config = Config::read(&text).map_err(|error| CliError::Settings {
            place: name.to_string(),
            message: error.to_string(),
        })?;
        Ok(Self {
            path: Some(path),
            there,
            config,
        })
    }
}

/// Returns true if there is no settings file. A dangling link is one, because its target may be on a disk that is not
/// mounted.
fn has_no_file(path: &Path, error: &io::Error) -> bool {
    let leads_nowhere = |path: &Path| path.is_symlink() && !path.exists();
    is_missing(error) && !path.ancestors().any(leads_nowhere)
}

/// Opens the settings file. A pipe is refused: opening one waits for a writer, which may never come.
fn open(path: &Path) -> io::Result<File> {
    let kind = path.metadata()?.file_type();
    #[cfg(unix)]
    if std::os::unix::fs::FileTypeExt::is_fifo(&kind) {
        return Err(io::Error::other("a pipe, expected a regular file"));
    }
    #[cfg(not(unix))]
    let _ = kind;
    File::open(path)
}

/// The origin of a value, as `taxel config` shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
enum SettingOrigin {
    /// The program's default.
    Default,
    /// A line of the settings file.
    File(usize),
    /// An environment variable.
    Environment(&'static str),
    /// A flag, without its dashes.
    Flag(String),
}

impl fmt::Display for SettingOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Default => f.write_str("default"),
            Self::File(line) => write!(f, "file, line {line}"),
            Self::Environment(name) => write!(f, "environment, {name}"),
            Self::Flag(name) => write!(f, "flag, --{name}"),
        }
    }
}

/// A value with its origin.
#[derive(Clone, Debug)]
struct Settled<T> {
    /// The value in effect.
    value: T,
    /// The origin of the value.
    origin: SettingOrigin,
}

/// Picks the value of a setting: that of the flag, or else of the environment variable, or else of the file, or else
/// the default.
fn settled<T: Clone>(
    flag: Option<(T, &str)>,
    variable: Option<(T, &'static str)>,
    file: Option<&Written<T>>,
    default: T,
) -> Settled<T> {
    let flag = flag.map(|(value, name)| (value, SettingOrigin::Flag(name.to_owned())));
    let variable = variable.map(|(value, name)| (value, SettingOrigin::Environment(name)));
    let file = file.map(|own| (own.value.clone(), SettingOrigin::File(own.line)));
    let (value, origin) = flag
        .or(variable)
        .or(file)
        .unwrap_or((default, SettingOrigin::Default));
    Settled { value, origin }
}

/// All settings in effect. For a choice, None means `auto`.
#[derive(Clone, Debug)]
pub(crate) struct Effective {
    /// The settings file.
    loaded: Loaded,
    /// The palette of the screen.
    theme: Settled<Option<Palette>>,
    /// The number of colours that the screen uses; `NO_COLOR` means none.
    color: Settled<Option<ColorDepth>>,
    /// Whether text is ASCII only; for `auto`, the locale decides.
    charset: Settled<Option<bool>>,
    /// Whether the screen reacts to the mouse.
    mouse: Settled<bool>,
    /// The folder of the library; None if the user has no home.
    library: Settled<Option<PathBuf>>,
    /// The sensor of figures that are given without one.
    sensor: Sensor,
    /// The parameters of the sensor, each with its origin.
    of_sensor: Vec<(Parameter, SettingOrigin)>,
}

impl Effective {
    /// Combines the settings: `loaded` is the file, `chosen` the flags, and `variable` reads the environment.
    ///
    /// # Errors
    /// Returns [`CliError::Range`] if a flag of the sensor is out of range.
    pub(crate) fn new(
        loaded: Loaded,
        chosen: Chosen,
        variable: impl Fn(&'static str) -> Option<OsString>,
    ) -> Result<Self, CliError> {
        let set = |name| variable(name).filter(|value| !value.is_empty());
        let config = &loaded.config;
        let written = config.library.as_ref().map(|own| Written {
            value: location::below_home(&own.value),
            line: own.line,
        });
        let of_sensor = SENSOR_PARAMETERS.iter().map(|&parameter| {
            let mut entries = config.sensor_entries().iter();
            let origin = match entries.find(|own| own.value == parameter) {
                _ if chosen.sensor.has(parameter) => SettingOrigin::Flag(parameter.flag()),
                Some(own) => SettingOrigin::File(own.line),
                None => SettingOrigin::Default,
            };
            (parameter, origin)
        });
        Ok(Self {
            theme: settled(
                chosen.theme.map(|theme| (theme.made(), "theme")),
                None,
                config.theme.as_ref(),
                None,
            ),
            color: settled(
                chosen.color.map(|color| (color.made(), "color")),
                // https://no-color.org
                set("NO_COLOR").map(|_| (Some(ColorDepth::Never), "NO_COLOR")),
                config.color.as_ref(),
                None,
            ),
            charset: settled(
                chosen.ascii.then_some((Some(true), "ascii")),
                None,
                config.charset.as_ref(),
                None,
            ),
            mouse: settled(
                chosen.no_mouse.then_some((false, "no-mouse")),
                None,
                config.mouse.as_ref(),
                true,
            ),
            library: settled(
                chosen.library.map(|folder| (Some(folder), "library")),
                set(location::VARIABLE).map(|folder| (Some(folder.into()), location::VARIABLE)),
                written.as_ref(),
                location::folder(None, None).ok(),
            ),
            sensor: chosen.sensor.sensor(*config.sensor())?,
            of_sensor: of_sensor.collect(),
            loaded,
        })
    }

    /// Returns the palette; None if it depends on the terminal.
    pub(crate) fn theme(&self) -> Option<Palette> {
        self.theme.value
    }

    /// Returns the number of colours; None if it depends on the terminal.
    pub(crate) fn color(&self) -> Option<ColorDepth> {
        self.color.value
    }

    /// Returns true if the screen reacts to the mouse.
    pub(crate) fn mouse(&self) -> bool {
        self.mouse.value
    }

    /// Returns the library's folder; None if the user has no home and nothing names another folder.
    pub(crate) fn library(&self) -> Option<&PathBuf> {
        self.library.value.as_ref()
    }

    /// Returns the default sensor with the values of the file and the flags.
    pub(crate) fn sensor(&self) -> Sensor {
        self.sensor
    }

    /// Returns the settings of real sensors in the file.
    pub(crate) fn sensors(&self) -> &SensorSettings {
        self.loaded.config.sensors()
    }

    /// Returns the pitch in mm, if the file or a flag sets it. With the default pitch, nothing is shown in mm.
    pub(crate) fn pitch(&self) -> Option<f64> {
        let set = |(parameter, origin): &&(Parameter, SettingOrigin)| {
            *parameter == Parameter::Pitch && *origin != SettingOrigin::Default
        };
        let pitch = self.of_sensor.iter().find(set);
        pitch.map(|_| self.sensor.pitch_mm())
    }

    /// Returns all key bindings, with the changes of the file.
    pub(crate) fn keymap(&self) -> &Keymap {
        self.loaded.config.keymap()
    }

    /// Returns the character set of the command line's output: that of the settings, or else of the locale.
    pub(crate) fn charset(&self, locale: Charset) -> Charset {
        match self.charset.value {
            Some(true) => Charset::Ascii,
            Some(false) => Charset::Unicode,
            None => locale,
        }
    }

    /// Returns whether the screen is ASCII only; None if this depends on the locale and the terminal.
    pub(crate) fn ascii(&self) -> Option<bool> {
        self.charset.value
    }

    /// Returns all settings as the text of a settings file, in which a comment at the end of each line names the
    /// origin.
    pub(crate) fn text(&self, charset: Charset) -> String {
        let mut text = match &self.loaded.path {
            Some(path) => {
                let missing = if self.loaded.there {
                    ""
                } else {
                    " (not there)"
                };
                let path = path.display().to_string();
                format!("# {}{missing}\n", charset.line(&path))
            }
            None => "# no file\n".to_owned(),
        };
        let mut line = |entry: &str, origin: &SettingOrigin| text += &commented(entry, origin);
        let quoted = |text: &str| quoted(text, charset);
        let theme = named(&Palette::NAMES, self.theme.value.as_ref());
        line(&format!("theme = \"{theme}\""), &self.theme.origin);
        let color = named(&ColorDepth::NAMES, self.color.value.as_ref());
        line(&format!("color = \"{color}\""), &self.color.origin);
        let characters = named(&CHARSETS, self.charset.value.as_ref());
        line(&format!("charset = \"{characters}\""), &self.charset.origin);
        line(&format!("mouse = {}", self.mouse.value), &self.mouse.origin);
        let library = match &self.library.value {
            // The path is made absolute: a settings file means the same in every folder.
            Some(folder) => {
                let whole = std::path::absolute(folder).unwrap_or_else(|_| folder.clone());
                let lossy = || charset.line(&whole.to_string_lossy()).into_owned();
                // A settings file is UTF-8, so any other path cannot be in one.
                whole.to_str().map_or_else(
                    || format!("# library: {}; this path is not UTF-8, so it cannot be in a settings file", lossy()),
                    |whole| format!("library = {}", quoted(whole)),
                )
            }
            None => "# no library: no home folder".to_owned(),
        };
        line(&library, &self.library.origin);
        text + "\n[sensor]\n"
            + &self.sensor_text()
            + &self.sensors_text()
            + &self.keys_text(&quoted)
    }

    /// Returns the table `[sensor]`.
    fn sensor_text(&self) -> String {
        let line = |(parameter, origin): &(Parameter, SettingOrigin)| {
            let name = parameter.key_without_unit();
            let entry = match (parameter, origin) {
                // Even an entry with the default value would make lengths appear in mm.
                (Parameter::Pitch, SettingOrigin::Default) => "# pitch is not set".to_owned(),
                (parameter, _) => match self.sensor.get(*parameter) {
                    Some(value) => format!("{name} = {value}"),
                    None => format!("# {name} is not set"),
                },
            };
            commented(&entry, origin)
        };
        self.of_sensor.iter().map(line).collect()
    }

    /// Returns the tables `[source]` and `[frames]`.
    fn sensors_text(&self) -> String {
        let sensors = self.sensors();
        let mut text = String::new();
        for table in TABLES {
            text += &format!("\n[{table}]\n");
            for setting in SENSOR_SETTINGS.iter().filter(|row| row.table == table) {
                let (value, origin) = if let Some(own) = sensors.written(setting) {
                    (Some(own.value), SettingOrigin::File(own.line))
                } else {
                    let default = SensorSettings::default_text(setting.key);
                    (default, SettingOrigin::Default)
                };
                let entry = match value {
                    Some(value) => format!("{} = {value}", setting.name),
                    None => format!("# {} is not set", setting.name),
                };
                text += &commented(&entry, &origin);
            }
        }
        text
    }

    /// Returns the tables `[keys.…]`: every key with its action, and the keys that the file has freed.
    fn keys_text(&self, quoted: &impl Fn(&str) -> String) -> String {
        let changes = self.loaded.config.changes();
        let mut text = String::new();
        for context in Context::ALL {
            text += &format!("\n[keys.{}]\n", context.name());
            let here = || changes.iter().filter(|own| own.value.context == context);
            let bound = self.keymap().of(context).flat_map(|row| row.keys.iter());
            let bound = bound.map(|(key, action)| (*key, action.name));
            let freed = here().filter(|own| own.value.action.is_none());
            let freed = freed.map(|own| (own.value.key, "none"));
            for (key, action) in bound.chain(freed) {
                let change = here().find(|own| own.value.key == key);
                let origin =
                    change.map_or(SettingOrigin::Default, |own| SettingOrigin::File(own.line));
                let entry = format!("{} = \"{action}\"", quoted(&key.to_string()));
                text += &commented(&entry, &origin);
            }
        }
        text
    }
}

/// Returns a line of the text: the entry, then its origin as an aligned comment.
fn commented(entry: &str, origin: &SettingOrigin) -> String {
    format!("{entry:<37}  # {origin}\n")
}

/// Returns the name of a choice; `auto` for None.
fn named<T: PartialEq>(names: &[(&'static str, T)], value: Option<&T>) -> &'static str {
    let found = names.iter().find(|(_, own)| Some(own) == value);
    found.map_or(AUTO, |(name, _)| name)
}

/// Quotes a text as a TOML string. Characters that are not in the character set, or are invisible, are escaped.
fn quoted(text: &str, charset: Charset) -> String {
    let mut quoted = String::from("\"");
    for character in text.chars() {
        let plain = match charset {
            Charset::Ascii => matches!(character, ' '..='~'),
            Charset::Unicode => {
                charset.line(character.encode_utf8(&mut [0; 4])).len() == character.len_utf8()
            }
        };
        match character {
            '"' | '\\' => quoted.extend(['\\', character]),
            _ if plain => quoted.push(character),
            _ => quoted += &format!("\\U{:08X}", u32::from(character)),
        }
    }
    quoted + "\""
}
