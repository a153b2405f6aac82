//! The settings in effect: a flag beats the environment, the environment beats the file, the file beats the default.
//!
//! Empty environment variables count as unset, as is usual for `NO_COLOR`. The user's own file is read for every
//! command whose output depends on settings. An error in the file is an error of the command, with its place:
//! `~/.config/taxel/config.toml: line 3, column 9: …`.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use taxel_core::parameter::Parameter;
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_files::formats::file::{is_missing, system_reason};
use taxel_files::storage::{LIBRARY_VARIABLE, below_home, usual_folder};

use crate::cli::arguments::parameters::Given;
use crate::cli::commands::screen::Look;
use crate::cli::error::CliError;
use crate::cli::output::charset::Charset;
use crate::cli::settings::file::{AUTO, CHARSETS, Config, MAX_BYTES, Wrong};
use crate::cli::settings::sensors::{SENSOR_SETTINGS, SensorSettings, TABLES};
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::widget::theme::{ColorDepth, Palette};

pub(crate) const VARIABLE: &str = "TAXEL_CONFIG";

#[derive(Clone, Debug, Default)]
pub(crate) struct Loaded {
    /// The path of the file, even if it does not exist; None if the user has no home.
    path: Option<PathBuf>,
    there: bool,
    config: Config,
}

impl Loaded {
    /// Reads the settings file: that of `--config`, or else of `TAXEL_CONFIG`, or else the user's own. Only the
    /// user's own file may be missing.
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

#[derive(Clone, Debug)]
pub(crate) struct Effective {
    loaded: Loaded,
    chosen: Chosen,
    pub(crate) theme: Option<Palette>,
    pub(crate) color: Option<ColorDepth>,
    pub(crate) ascii: Option<bool>,
    pub(crate) mouse: bool,
    /// The folder of the library; None if the user has no home and nothing names another folder.
    pub(crate) library: Option<PathBuf>,
    pub(crate) sensor: Sensor,
    /// The pitch in mm, if the file or a flag sets it. With the default pitch, nothing is shown in mm.
    pub(crate) pitch: Option<f64>,
}

impl Effective {
    pub(crate) fn new(
        loaded: Loaded,
        chosen: Chosen,
        variable: impl Fn(&'static str) -> Option<OsString>,
    ) -> Result<Self, CliError> {
        let set = |name| variable(name).filter(|value| !value.is_empty());
        let config = &loaded.config;
        // https://no-color.org
        let no_color = || set("NO_COLOR").map(|_| Choice::Made(ColorDepth::Never));
        let chosen_again = chosen.clone();
        let color = chosen.color.or_else(no_color).or(config.color);
        let ascii = chosen.ascii.then_some(Choice::Made(true));
        let library = chosen
            .library
            .or_else(|| set(LIBRARY_VARIABLE).map(PathBuf::from));
        let library = library.or_else(|| match &config.library {
            Some(own) => below_home(own),
            None => usual_folder(),
        });
        let sensor = chosen.sensor.sensor(*config.sensor())?;
        let is_pitched = chosen.sensor.has(Parameter::Pitch)
            || config.sensor_entries().contains(&Parameter::Pitch);
        Ok(Self {
            theme: chosen.theme.or(config.theme).and_then(Choice::made),
            color: color.and_then(Choice::made),
            ascii: ascii.or(config.charset).and_then(Choice::made),
            mouse: !chosen.no_mouse && config.mouse.unwrap_or(true),
            library,
            sensor,
            pitch: is_pitched.then(|| sensor.pitch_mm()),
            loaded,
            chosen: chosen_again,
        })
    }

    /// These settings with the flags of the screen and the sensor.
    pub(crate) fn with(&self, look: &Look, sensor: &Given) -> Result<Self, CliError> {
        let chosen = Chosen {
            theme: look.theme,
            color: look.color,
            no_mouse: look.no_mouse,
            sensor: sensor.clone(),
            ascii: self.chosen.ascii,
            library: self.chosen.library.clone(),
        };
        Self::new(self.loaded.clone(), chosen, std::env::var_os)
    }

    pub(crate) fn sensors(&self) -> &SensorSettings {
        self.loaded.config.sensors()
    }

    pub(crate) fn keymap(&self) -> &Keymap {
        self.loaded.config.keymap()
    }

    pub(crate) fn charset(&self, locale: Charset) -> Charset {
        match self.ascii {
            Some(true) => Charset::Ascii,
            Some(false) => Charset::Unicode,
            None => locale,
        }
    }

    pub(crate) fn text(&self, charset: Charset) -> String {
        let quoted = |text: &str| quoted(text, charset);
        let path = match &self.loaded.path {
            Some(path) => {
                let path = path.display().to_string();
                let missing = if self.loaded.there {
                    ""
                } else {
                    " (not there)"
                };
                format!("{}{missing}", charset.line(&path))
            }
            None => "no file".to_owned(),
        };
        let library = match &self.library {
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
        format!(
            "# {path}\ntheme = \"{}\"\ncolor = \"{}\"\ncharset = \"{}\"\nmouse = {}\n{library}\n{}{}{}",
            named(&Palette::NAMES, self.theme.as_ref()),
            named(&ColorDepth::NAMES, self.color.as_ref()),
            named(&CHARSETS, self.ascii.as_ref()),
            self.mouse,
            self.sensor_text(),
            self.sensors_text(),
            self.keys_text(&quoted)
        )
    }

    fn sensor_text(&self) -> String {
        let entries = SENSOR_PARAMETERS.iter().map(|&parameter| {
            let value = match parameter {
                // Even an entry with the default value would make lengths appear in mm.
                Parameter::Pitch => self.pitch,
                _ => self.sensor.get(parameter),
            };
            entry(parameter.key_without_unit(), value)
        });
        "\n[sensor]\n".to_owned() + &entries.collect::<String>()
    }

    fn sensors_text(&self) -> String {
        let mut text = String::new();
        for table in TABLES {
            text += &format!("\n[{table}]\n");
            for setting in SENSOR_SETTINGS.iter().filter(|row| row.table == table) {
                let value = self.sensors().shown(setting);
                let value = value.or_else(|| SensorSettings::default_text(setting.key));
                text += &entry(setting.name, value);
            }
        }
        text
    }

    fn keys_text(&self, quoted: &impl Fn(&str) -> String) -> String {
        let mut text = String::new();
        for context in Context::all() {
            text += &format!("\n[keys.{}]\n", context.name());
            let bound = self.keymap().of(context).flat_map(|row| row.keys.iter());
            let bound = bound.map(|(key, action)| (*key, action.name));
            let changes = self.loaded.config.changes().iter();
            let freed = changes.filter(|own| own.context == context && own.action.is_none());
            for (key, action) in bound.chain(freed.map(|own| (own.key, "none"))) {
                text += &format!("{} = \"{action}\"\n", quoted(&key.to_string()));
            }
        }
        text
    }
}

fn entry(name: &str, value: Option<impl std::fmt::Display>) -> String {
    match value {
        Some(value) => format!("{name} = {value}\n"),
        None => format!("# {name} is not set\n"),
    }
}

fn named<T: PartialEq>(names: &[(&'static str, T)], value: Option<&T>) -> &'static str {
    let found = names.iter().find(|(_, own)| Some(own) == value);
    found.map_or(AUTO, |(name, _)| name)
}

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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Choice<T> {
    /// `auto`: the program chooses, even if the file says otherwise.
    Auto,
    Made(T),
}

impl<T> Choice<T> {
    pub(crate) fn made(self) -> Option<T> {
        match self {
            Self::Auto => None,
            Self::Made(value) => Some(value),
        }
    }
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Chosen {
    pub(crate) theme: Option<Choice<Palette>>,
    pub(crate) color: Option<Choice<ColorDepth>>,
    pub(crate) ascii: bool,
    pub(crate) no_mouse: bool,
    pub(crate) library: Option<PathBuf>,
    pub(crate) sensor: Given,
}

/// The sources of the pitch in mm that are known before a stored shape is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pitch {
    pub(crate) given: Option<f64>,
    pub(crate) usual: Option<f64>,
}

impl Pitch {
    /// Returns the pitch in effect, in mm: that of the flag, or else of a stored shape's sensor, or else of the
    /// settings; None if none of them sets one.
    ///
    /// A sensor with the default pitch counts as not setting one: shapes stored without a pitch have it too.
    pub(crate) fn of(self, sensor: Option<&Sensor>) -> Option<f64> {
        let own = sensor.map(Sensor::pitch_mm);
        let own = own.filter(|&pitch| pitch != Sensor::default().pitch_mm());
        self.given.or(own).or(self.usual)
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::parameter::Parameter;

    use super::*;

    #[test]
    fn a_flag_overrides_the_sensor_which_overrides_the_settings() {
        let fine = Sensor::default().with(Parameter::Pitch, 2.5);
        let (plain, fine) = (Sensor::default(), fine.expect("in range"));
        let none = Pitch::default();
        assert_eq!((none.of(None), none.of(Some(&plain))), (None, None));
        assert_eq!(none.of(Some(&fine)), Some(2.5));
        let usual = Pitch {
            usual: Some(4.0),
            ..none
        };
        assert_eq!(usual.of(Some(&plain)), Some(4.0));
        assert_eq!(usual.of(Some(&fine)), Some(2.5));
        let given = Pitch {
            given: Some(1.0),
            ..usual
        };
        assert_eq!(given.of(Some(&fine)), Some(1.0));
    }
}
