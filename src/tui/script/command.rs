//! The commands of a script, one per line.
//!
//! ```text
//! Size 80x24          Resize 100x30       Set ascii on        Set theme light
//! Set columns 8       Set threshold 0.6   Set library "DIR"   (all of them: [`crate::tui::script::command`])
//! Keys f<Right><Tab>4.00<Enter>           vim notation; <lt>; <3x:Down>
//! Type "literal text" Paste "1.5"         Click 12,5   Click "Figure"   Drag 3,4 9,9   Scroll 12,5 -3
//! Screen [name]       State [json-pointer]
//! Expect /re/         ExpectNot /re/      ExpectAt 3,10 "text"   ExpectStyle 3,10 reverse
//! Signal HUP          Wait                Quit                Seed 7
//! Source touch.csv    Frames 3            the next frames of a file: the clock stands still
//! ```
//! Positions are column,row of the screen, from 0. `#` begins a comment line. `Quit` fails if the program has not
//! ended. A drag visits the given positions and no others, as a terminal reports them.

use std::fmt;
use std::path::PathBuf;

use regex_lite::{Regex, RegexBuilder};
use taxel_core::parameter::{Parameter, ParameterError};
use taxel_core::quote::{did_you_mean, shortened, unknown_name};
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_files::formats::{StoredShape, json};

use crate::tui::app::state::Options;
use crate::tui::keys::key::{Key, parse};
use crate::tui::widget::theme::{ColorDepth, Palette};

/// A position on the screen: column, row.
pub type ScreenPosition = (u16, u16);

#[derive(Clone, Debug)]
pub enum ScriptCommand {
    /// Sets how the program starts, and with what; comes before every command that needs a screen.
    Set(ScriptSetting),
    /// Changes the size while the program runs, to these columns and rows.
    Resize(u16, u16),
    Keys(Vec<Key>),
    Type(String),
    Paste(String),
    Click(ScreenPosition),
    ClickText(String),
    Drag(Vec<ScreenPosition>),
    Scroll(ScreenPosition, i16),
    Screen(String),
    State(String),
    /// Fails unless the screen matches.
    Expect(Regex),
    ExpectNot(Regex),
    /// Fails unless a text stands at a position.
    ExpectAt(ScreenPosition, String),
    /// Fails unless a character has a style, given by its letter.
    ExpectStyle(ScreenPosition, char),
    Signal(String),
    /// Waits for work to finish; it always has.
    Wait,
    /// Fails unless the program has ended.
    Quit,
    /// Watches a file with frames, which must be readable; reads no frame yet.
    Source(String),
    /// Reads and draws this many of the next frames; fails if there are fewer.
    Frames(usize),
}

type ReadCommand = fn(&str) -> Result<ScriptCommand, String>;

const COMMANDS: [(&str, ReadCommand); 21] = [
    ("Size", |text| {
        let (columns, rows) = stated_size(text)?;
        Ok(ScriptCommand::Set(ScriptSetting::Size(columns, rows)))
    }),
    ("Set", |text| read_setting(text).map(ScriptCommand::Set)),
    ("Seed", |text| {
        let seed = seed(text)?;
        Ok(ScriptCommand::Set(ScriptSetting::Seed(seed)))
    }),
    ("Resize", |text| {
        let (columns, rows) = stated_size(text)?;
        Ok(ScriptCommand::Resize(columns, rows))
    }),
    ("Keys", |text| {
        let keys = parse(text).map_err(|error| error.to_string())?;
        Ok(ScriptCommand::Keys(keys))
    }),
    ("Type", |text| quoted(text).map(ScriptCommand::Type)),
    ("Paste", |text| quoted(text).map(ScriptCommand::Paste)),
    ("Click", click),
    ("Drag", drag),
    ("Scroll", scroll),
    ("Screen", screen),
    ("State", |text| Ok(ScriptCommand::State(text.to_owned()))),
    ("Expect", |text| pattern(text).map(ScriptCommand::Expect)),
    ("ExpectNot", |text| {
        pattern(text).map(ScriptCommand::ExpectNot)
    }),
    ("ExpectAt", |text| {
        let (at, text) = two(text, "a text")?;
        Ok(ScriptCommand::ExpectAt(position(at)?, filled(text)?))
    }),
    ("ExpectStyle", |text| {
        let (at, name) = two(text, "a style")?;
        Ok(ScriptCommand::ExpectStyle(position(at)?, style(name)?))
    }),
    ("Signal", signal),
    ("Source", source),
    ("Frames", |text| frames(text).map(ScriptCommand::Frames)),
    ("Wait", |text| alone("Wait", text, ScriptCommand::Wait)),
    ("Quit", |text| alone("Quit", text, ScriptCommand::Quit)),
];

const STYLES: [(&str, char); 4] = [
    ("plain", '.'),
    ("reverse", 'R'),
    ("bold", 'B'),
    ("dim", 'D'),
];

const SIGNALS: [&str; 5] = ["HUP", "INT", "QUIT", "TERM", "TSTP"];

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{message}", line_name(*line))]
pub struct ScriptError {
    /// The line number, from 1; 0 for keys from the command line (`-k`).
    pub line: usize,
    pub message: String,
}

fn line_name(line: usize) -> String {
    if line == 0 {
        "-k: ".to_owned()
    } else {
        format!("line {line}: ")
    }
}

pub fn read(script: &str) -> Result<Vec<(usize, ScriptCommand)>, ScriptError> {
    let lines = script
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()));
    lines
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
        .map(|(number, line)| match command(line) {
            Ok(command) => Ok((number, command)),
            Err(message) => Err(ScriptError {
                line: number,
                message,
            }),
        })
        .collect()
}

fn command(line: &str) -> Result<ScriptCommand, String> {
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let command = COMMANDS.iter().find(|(name, _)| *name == word);
    let (_, read) = command.ok_or_else(|| unknown_name(word, &COMMANDS.map(|(name, _)| name)))?;
    read(rest.trim())
}

fn alone(name: &str, rest: &str, command: ScriptCommand) -> Result<ScriptCommand, String> {
    if rest.is_empty() {
        return Ok(command);
    }
    Err(format!(
        "{name} takes no argument, found {:?}",
        shortened(rest)
    ))
}

/// Reads what to click on: a text in quotes or a position.
fn click(text: &str) -> Result<ScriptCommand, String> {
    if text.starts_with('"') {
        return filled(text).map(ScriptCommand::ClickText);
    }
    position(text).map(ScriptCommand::Click)
}

fn screen(name: &str) -> Result<ScriptCommand, String> {
    if name.contains(char::is_control) {
        let found = shortened(name);
        return Err(format!(
            "a name for a screen has no control characters, found {found:?}"
        ));
    }
    Ok(ScriptCommand::Screen(name.to_owned()))
}

fn source(name: &str) -> Result<ScriptCommand, String> {
    if name.is_empty() {
        return Err("expected the name of a file with frames".to_owned());
    }
    Ok(ScriptCommand::Source(name.to_owned()))
}

fn signal(name: &str) -> Result<ScriptCommand, String> {
    if SIGNALS.contains(&name) {
        return Ok(ScriptCommand::Signal(name.to_owned()));
    }
    Err(format!("signal {}", unknown_name(name, &SIGNALS)))
}

fn frames(text: &str) -> Result<usize, String> {
    let number = text
        .parse()
        .ok()
        .filter(|count| (1..=10_000).contains(count));
    number.ok_or_else(|| {
        let found = shortened(text);
        format!("expected a whole number from 1 to 10000, found {found:?}")
    })
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| {
        let found = shortened(text);
        format!(
            "expected a whole number of at most {}, found {found:?}",
            u64::MAX
        )
    })
}

fn drag(text: &str) -> Result<ScriptCommand, String> {
    let positions: Result<Vec<_>, _> = text.split_whitespace().map(position).collect();
    let positions = positions?;
    if positions.len() < 2 {
        let found = shortened(text);
        return Err(format!(
            "expected two or more positions like 12,5, found {found:?}"
        ));
    }
    Ok(ScriptCommand::Drag(positions))
}

fn scroll(text: &str) -> Result<ScriptCommand, String> {
    let (at, turns) = two(text, "a number")?;
    let number = turns.parse().ok();
    let number = number.filter(|turns: &i16| turns.unsigned_abs() <= 1000);
    let number = number.ok_or_else(|| {
        let found = shortened(turns);
        format!("expected a whole number from -1000 to 1000, found {found:?}")
    })?;
    Ok(ScriptCommand::Scroll(position(at)?, number))
}

pub(in crate::tui::script) fn style_name(letter: char) -> &'static str {
    let style = STYLES.iter().find(|(_, own)| *own == letter);
    style.map_or("unknown", |(name, _)| name)
}

fn style(name: &str) -> Result<char, String> {
    let style = STYLES.iter().find(|(style, _)| *style == name);
    style.map(|(_, letter)| *letter).ok_or_else(|| {
        let names = STYLES.map(|(style, _)| style);
        format!("style {}", unknown_name(name, &names))
    })
}

fn two<'a>(text: &'a str, what: &str) -> Result<(&'a str, &'a str), String> {
    let (first, second) = text.split_once(char::is_whitespace).ok_or_else(|| {
        let found = shortened(text);
        format!("expected a position like 12,5 and then {what}, found {found:?}")
    })?;
    Ok((first, second.trim()))
}

/// Reads a size like `80x24`; columns and rows are at most 1000. The error does not quote the text, because a message
/// about a flag does so already.
pub(crate) fn size(text: &str) -> Result<(u16, u16), &'static str> {
    let numbers = text
        .split_once('x')
        .and_then(|(columns, rows)| Some((columns.parse().ok()?, rows.parse().ok()?)));
    numbers
        .filter(|(columns, rows): &(u16, u16)| {
            (1..=1000).contains(columns) && (1..=1000).contains(rows)
        })
        .ok_or("expected a size like 80x24, from 1x1 to 1000x1000")
}

fn stated_size(text: &str) -> Result<(u16, u16), String> {
    size(text).map_err(|error| format!("{error}, found {:?}", shortened(text)))
}

/// Reads a position like `12,5`: column and row of the screen.
fn position(text: &str) -> Result<ScreenPosition, String> {
    let numbers = text
        .split_once(',')
        .and_then(|(column, row)| Some((column.parse().ok()?, row.parse().ok()?)));
    let numbers = numbers.filter(|(column, row): &ScreenPosition| *column < 1000 && *row < 1000);
    numbers.ok_or_else(|| format!("expected column,row like 12,5, found {:?}", shortened(text)))
}

fn quoted(text: &str) -> Result<String, String> {
    serde_json::from_str(text).map_err(|_| {
        format!(
            "expected a string in double quotes, found {}",
            shortened(text)
        )
    })
}

/// Reads a text in quotes that is not empty: an empty one stands everywhere on the screen.
fn filled(text: &str) -> Result<String, String> {
    match quoted(text)? {
        empty if empty.is_empty() => Err("expected a text, found \"\"".to_owned()),
        text => Ok(text),
    }
}

/// The greatest compiled size of a pattern in bytes; it allows `.{1000}` and little more, since the time to search a
/// screen grows with this size.
const LARGEST_PATTERN: usize = 1 << 16;

/// The greatest length of a pattern in bytes; reading one takes a hundred times as much memory.
const LONGEST_PATTERN: usize = 1 << 14;

fn pattern(text: &str) -> Result<Regex, String> {
    let inner = text
        .strip_prefix('/')
        .and_then(|text| text.strip_suffix('/'));
    let inner = inner.ok_or_else(|| {
        format!(
            "expected a pattern between slashes, found {:?}",
            shortened(text)
        )
    })?;
    if inner.len() > LONGEST_PATTERN {
        return Err(format!(
            "pattern /{}/: has {} bytes, expected at most {LONGEST_PATTERN}",
            shortened(inner),
            inner.len()
        ));
    }
    let regex = RegexBuilder::new(inner).size_limit(LARGEST_PATTERN).build();
    regex.map_err(|error| format!("pattern /{}/: {error}", shortened(inner)))
}

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

pub fn read_setting(text: &str) -> Result<ScriptSetting, String> {
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
            assert_eq!(read_setting(text), Ok(setting), "{line}");
        }
    }
}
