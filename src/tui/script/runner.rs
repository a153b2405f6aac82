//! A script: reads its lines and carries them out, and stops at the first expectation that does not hold.
//!
//! ```text
//! Size 80x24            before the first command that needs a screen: settings
//! Keys f<Enter>         changes the program
//! Expect /ellipse/      looks at it; a failure shows the line, the reason and the screen
//! Screen start          prints the screen
//! --- screen start 80x24 cursor 8,9 ---
//! n New   l Load   …
//! ```
//! Positions are column,row of the screen, from 0. `#` begins a comment line. A script is read as a whole first: if a
//! line is malformed, none is carried out. Long work is finished before the next command, so that a script always prints
//! the same.

use std::fmt::Display;
use std::fs;
use std::ops::{ControlFlow, RangeInclusive};
use std::path::{Component, Path, PathBuf};
use std::str::FromStr;

use regex_lite::{Regex, RegexBuilder};
use serde_json::{Value, json};
use taxel_core::parameter::Parameter;
use taxel_core::quote::{did_you_mean, shortened, unknown_name};
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_files::formats::file::system_reason;
use taxel_files::formats::value::counted;
use taxel_files::formats::{DescribedImprint, StoredShape};
use taxel_files::storage::{Library, below_home};

use crate::tui::app::{App, Message, Mouse, MouseKind, Options};
use crate::tui::jobs::Jobs;
use crate::tui::keys::{Key, Keymap, parse};
use crate::tui::script::session::Session;
use crate::tui::widget::{ColorDepth, Palette, write};

#[derive(Clone, Debug)]
pub struct ScriptOptions {
    pub options: Options,
    /// Columns and rows of the screen, unless the script sets them.
    pub size: (u16, u16),
    pub styles: bool,
    pub keymap: Keymap,
    /// The folder of the script, below which the screens are that it expects.
    pub folder: PathBuf,
    /// Whether the script may write only below its folder, and use no library of the user's.
    pub is_confined: bool,
    /// Whether the files of expected screens are written.
    pub update: bool,
}

/// What a script prints, and the screen that this is, if it is one, with its name, which may be empty.
#[derive(Debug)]
pub struct Shown<'a> {
    pub text: &'a str,
    pub screen: Option<(&'a str, &'a Session)>,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}{screen}")]
pub struct ScriptFailure {
    pub message: String,
    /// The screen at this time, in lines of its own.
    pub screen: String,
    /// 1 if something expected is not so, 2 if the script is wrong, 3 if the program had ended.
    pub status: u8,
}

impl ScriptFailure {
    fn new(status: u8, message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            screen: String::new(),
            status,
        }
    }

    /// A script that is wrong; the line number counts from 1.
    pub fn malformed(line: usize, message: &str) -> Self {
        Self::new(2, format!("line {line}: {message}"))
    }
}

/// An expectation that does not hold.
impl From<String> for ScriptFailure {
    fn from(message: String) -> Self {
        Self::new(1, message)
    }
}

/// What a command does; a failure has no line yet.
type Act = Box<dyn Fn(&mut Runner<'_>) -> Result<(), ScriptFailure>>;

/// A command that needs the program to run.
#[expect(clippy::unnecessary_wraps, reason = "as the rows of the table end")]
fn act(
    act: impl Fn(&mut Runner<'_>) -> Result<(), ScriptFailure> + 'static,
) -> Result<Act, String> {
    Ok(Box::new(move |runner| {
        runner.goes_on()?;
        act(runner)
    }))
}

fn drive(drive: impl Fn(&mut Session) + 'static) -> Result<Act, String> {
    act(move |runner| {
        drive(&mut runner.session);
        Ok(())
    })
}

/// A command that fails with the message that `look` returns.
fn expect(look: impl Fn(&Session) -> Option<String> + 'static) -> Result<Act, String> {
    act(move |runner| look(&runner.session).map_or(Ok(()), |message| Err(message.into())))
}

/// Its name, and what reads its argument.
type Command = (&'static str, fn(&str) -> Result<Act, String>);

/// The commands that need the program to run.
const COMMANDS: [Command; 16] = [
    ("Resize", |text| {
        let (columns, rows) = stated_size(text)?;
        drive(move |session| session.resize(columns, rows))
    }),
    ("Keys", |text| {
        let keys = parse(text).map_err(|error| error.to_string())?;
        act(move |runner| runner.press(&keys))
    }),
    ("Type", |text| {
        let keys: Vec<Key> = quoted(text)?.chars().map(Key::Char).collect();
        act(move |runner| runner.press(&keys))
    }),
    ("Paste", |text| {
        let text = quoted(text)?;
        drive(move |session| session.send(Message::Paste(text.clone())))
    }),
    ("Click", |text| {
        if !text.starts_with('"') {
            let at = position(text)?;
            return drive(move |session| drag(session, &[at]));
        }
        let text = filled(text)?;
        act(move |runner| {
            let at = find(&runner.session.screen(), &text)
                .ok_or_else(|| format!("no {:?} to click on", shortened(&text)))?;
            drag(&mut runner.session, &[at]);
            Ok(())
        })
    }),
    ("Drag", |text| {
        let positions: Result<Vec<_>, _> = text.split_whitespace().map(position).collect();
        let positions = positions?;
        match positions.len() {
            0 | 1 => Err(expected("two or more positions like 12,5", text)),
            _ => drive(move |session| drag(session, &positions)),
        }
    }),
    ("Scroll", |text| {
        let (at, turns) = two(text, "a number")?;
        let (at, turns) = (position(at)?, whole(turns, -1000, 1000_i16)?);
        let kind = if turns < 0 {
            MouseKind::ScrollUp
        } else {
            MouseKind::ScrollDown
        };
        drive(move |session| (0..turns.unsigned_abs()).for_each(|_| mouse(session, kind, at)))
    }),
    ("Screen", |name| {
        if name.contains(char::is_control) {
            let found = shortened(name);
            return Err(format!(
                "a name for a screen has no control characters, found {found:?}"
            ));
        }
        let name = name.to_owned();
        act(move |runner| runner.print_screen(&name))
    }),
    ("State", |pointer| {
        let pointer = pointer.to_owned();
        act(move |runner| {
            let state = state(runner.session.app());
            let part = state.pointer(&pointer);
            let part = part.ok_or_else(|| format!("the state has no {:?}", shortened(&pointer)))?;
            runner.print(&format!("{part}\n"), None)
        })
    }),
    ("Expect", |text| {
        let (pattern, shown) = pattern(text)?;
        expect(move |session| {
            (!pattern.is_match(&session.screen())).then(|| format!("no {shown} on the screen"))
        })
    }),
    ("ExpectNot", |text| {
        let (pattern, shown) = pattern(text)?;
        expect(move |session| {
            (pattern.is_match(&session.screen())).then(|| format!("{shown} is on the screen"))
        })
    }),
    ("ExpectScreen", |name| {
        let name = file_name(name, "a screen")?;
        act(move |runner| runner.expect_screen(&name))
    }),
    ("Source", |name| {
        let name = file_name(name, "frames")?;
        act(move |runner| Ok(runner.session.watch(&name)?))
    }),
    ("Frames", |text| {
        let count = whole(text, 1, 10_000)?;
        act(move |runner| {
            let found = runner.session.frames(count);
            if found == count {
                return Ok(());
            }
            let expected = counted(count as u64, "frame");
            let why = runner.session.end_of_frames();
            Err(format!("expected {expected}, found {found}: {why}").into())
        })
    }),
    // All work is finished already.
    ("Wait", |text| {
        alone("Wait", text)?;
        Ok(Box::new(|_| Ok(())))
    }),
    ("Quit", |text| {
        alone("Quit", text)?;
        Ok(Box::new(|runner| {
            let has_ended = runner.session.app().ended().then_some(());
            has_ended.ok_or_else(|| "the program has not ended".to_owned().into())
        }))
    }),
];

/// How the program starts, and with what: read from the lines before the first command.
struct Start {
    options: ScriptOptions,
    library: Option<Library>,
    shapes: Vec<StoredShape>,
    leftovers: Vec<StoredShape>,
}

const BEFORE: [&str; 3] = ["Size", "Seed", "Set"];

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

impl Start {
    fn read(&mut self, word: &str, rest: &str) -> Result<(), String> {
        match word {
            "Size" => self.options.size = stated_size(rest)?,
            "Seed" => self.options.options.seed = whole(rest, 0, u64::MAX)?,
            _ => {
                let (name, value) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                self.set(name, value.trim())?;
            }
        }
        Ok(())
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        let Options { sensor, theme, .. } = &mut self.options.options;
        let parameter = Parameter::from_flag(name).filter(|own| SENSOR_PARAMETERS.contains(own));
        let shape = || {
            let shape = StoredShape::read(value.as_bytes());
            shape.map_err(|error| format!("Set {name}: {error}"))
        };
        match name {
            "ascii" => theme.ascii = chosen(name, value, &[("on", true), ("off", false)])?,
            "color" => theme.depth = chosen(name, value, &ColorDepth::NAMES)?,
            "theme" => theme.palette = chosen(name, value, &Palette::NAMES)?,
            "library" if self.options.is_confined => {
                let text = "Set library needs --allow-outside; without that line, the script has its own library";
                return Err(text.to_owned());
            }
            "library" => {
                let folder = quoted(value)?;
                let folder = below_home(&folder).ok_or("no home folder, so ~ cannot be used")?;
                self.library = Some(Library::open(folder));
            }
            "shape" => {
                let shape = shape()?;
                let same = |own: &StoredShape| own.name.same(shape.name.as_str());
                self.shapes.retain(|own| !same(own));
                self.shapes.push(shape);
            }
            // Unsaved work of a program that crashed.
            "leftover" => self.leftovers.push(shape()?),
            name => {
                let parameter = parameter.ok_or_else(|| {
                    let all = NAMES.join(", ");
                    let meant = did_you_mean(name, NAMES);
                    let name = shortened(name);
                    format!("{name:?} cannot be set, expected one of {all}{meant}")
                })?;
                let value = Sensor::LARGEST.read(parameter, value);
                let set = value.and_then(|value| sensor.with(parameter, value));
                *sensor = set.map_err(|error| error.to_string())?;
            }
        }
        Ok(())
    }

    /// Returns the world for the script: `own`, unless the script sets a library or its shapes.
    fn world(&self, own: Jobs) -> Result<Jobs, String> {
        let has_shapes = !self.shapes.is_empty() || !self.leftovers.is_empty();
        let world = match &self.library {
            Some(_) if has_shapes => {
                let text = "Set library cannot be used with Set shape or Set leftover";
                return Err(text.to_owned());
            }
            Some(library) => Jobs::for_script(library.clone()),
            None if has_shapes => Jobs::with_contents(&self.shapes, &self.leftovers)
                .map_err(|error| format!("the script's own library: {error}"))?,
            None => own,
        };
        if self.options.is_confined {
            return Ok(world.confined_to(self.options.folder.clone()));
        }
        Ok(world)
    }
}

/// Runs a script in a world, after some keys. `show` gets the output piece by piece, and can stop the script. Without
/// any command, the screen is printed. A script that sets a library or its shapes has a world of its own instead.
pub fn run(
    script: &str,
    keys: &[Key],
    options: &ScriptOptions,
    world: Jobs,
    show: &mut dyn FnMut(Shown<'_>) -> ControlFlow<()>,
) -> Result<(), ScriptFailure> {
    let mut start = Start {
        options: options.clone(),
        library: None,
        shapes: Vec::new(),
        leftovers: Vec::new(),
    };
    let (mut acts, mut last_set) = (Vec::<(usize, Act)>::new(), 1);
    for (number, line) in (1..).zip(script.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let command = COMMANDS.iter().find(|(name, _)| *name == word);
        let read = match command {
            Some((_, read)) => read(rest.trim()).map(|act| acts.push((number, act))),
            None if !BEFORE.contains(&word) => {
                let names = COMMANDS.iter().map(|(name, _)| *name);
                let names: Vec<&str> = BEFORE.into_iter().chain(names).collect();
                Err(unknown_name(word, &names))
            }
            None if acts.is_empty() => {
                last_set = number;
                start.read(word, rest.trim())
            }
            None => {
                let text = "Size, Seed and Set must come before any command that needs a screen";
                Err(text.to_owned())
            }
        };
        read.map_err(|message| ScriptFailure::malformed(number, &message))?;
    }
    let world = start.world(world);
    let world = world.map_err(|message| ScriptFailure::malformed(last_set, &message))?;
    let options = &start.options;
    let mut app = App::new(&options.options);
    app.keymap = options.keymap.clone();
    let mut runner = Runner {
        session: Session::of(app, world, options.size.0, options.size.1),
        options,
        show,
    };
    for &key in keys {
        runner.session.press(key);
    }
    if acts.is_empty() {
        acts.push((1, Box::new(|runner| runner.print_screen(""))));
    }
    for (line, act) in acts {
        act(&mut runner).map_err(|mut failure| {
            failure.message = format!("line {line}: {}", failure.message);
            if failure.status == 1 && failure.screen.is_empty() {
                failure.screen = marked("|", &runner.session.screen());
            }
            failure
        })?;
    }
    Ok(())
}

fn marked(mark: &str, screen: &str) -> String {
    let rows = screen
        .lines()
        .map(|row| format!("\n  {mark} {}", row.trim_end()));
    rows.collect()
}

struct Runner<'a> {
    session: Session,
    options: &'a ScriptOptions,
    show: &'a mut dyn FnMut(Shown<'_>) -> ControlFlow<()>,
}

impl Runner<'_> {
    fn goes_on(&self) -> Result<(), ScriptFailure> {
        if self.session.app().ended() {
            return Err(ScriptFailure::new(3, "the program had already ended"));
        }
        Ok(())
    }

    fn press(&mut self, keys: &[Key]) -> Result<(), ScriptFailure> {
        for &key in keys {
            self.goes_on()?;
            self.session.press(key);
        }
        Ok(())
    }

    fn print(&mut self, text: &str, name: Option<&str>) -> Result<(), ScriptFailure> {
        let screen = name.map(|name| (name, &self.session));
        match (self.show)(Shown { text, screen }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err("the output was closed".to_owned().into()),
        }
    }

    fn print_screen(&mut self, name: &str) -> Result<(), ScriptFailure> {
        let session = &self.session;
        let ((columns, rows), cursor) = (session.size(), session.cursor());
        let space = if name.is_empty() { "" } else { " " };
        let cursor = cursor.map_or("no cursor".to_owned(), |cursor| {
            format!("cursor {},{}", cursor.x, cursor.y)
        });
        let mut text = format!("--- screen{space}{name} {columns}x{rows} {cursor} ---\n");
        text += &session.screen();
        if self.options.styles {
            text += &format!("--- styles ---\n{}", session.styles());
        }
        self.print(&text, Some(name))
    }

    /// Compares the screen with a file, or writes the file.
    fn expect_screen(&self, name: &str) -> Result<(), ScriptFailure> {
        let path = self.options.folder.join(name);
        let screen = self.session.screen();
        let failed = |what: &str, error: &std::io::Error| {
            format!("{name}: cannot {what}: {}", system_reason(error))
        };
        if self.options.update {
            let is_inside = |part: Component<'_>| matches!(part, Component::Normal(_));
            if self.options.is_confined && !Path::new(name).components().all(is_inside) {
                return Err(format!("{name}: a script writes only below its folder").into());
            }
            return Ok(fs::write(&path, screen).map_err(|error| failed("write", &error))?);
        }
        let saved = fs::read_to_string(&path)
            .map_err(|error| failed("read", &error) + "; --update writes it")?;
        let [expected, drawn] = [&saved, &screen].map(|text| text.lines().map(str::trim_end));
        if expected.eq(drawn) {
            return Ok(());
        }
        let (saved, found) = (marked("-", &saved), marked("+", &screen));
        let message = format!("the screen is not that of {name}; --update writes it");
        Err(ScriptFailure {
            screen: format!("\nexpected{saved}\nfound{found}"),
            ..message.into()
        })
    }
}

fn mouse(session: &mut Session, kind: MouseKind, (column, row): (u16, u16)) {
    session.send(Message::Mouse(Mouse { kind, column, row }));
}

/// Presses the button at the first position, visits the others as a terminal reports them, and releases it.
fn drag(session: &mut Session, way: &[(u16, u16)]) {
    for (index, &at) in way.iter().enumerate() {
        let kind = match index {
            0 => MouseKind::Press,
            _ => MouseKind::Drag,
        };
        mouse(session, kind, at);
    }
    if let Some(&last) = way.last() {
        mouse(session, MouseKind::Release, last);
    }
}

fn find(screen: &str, text: &str) -> Option<(u16, u16)> {
    screen.lines().enumerate().find_map(|(row, line)| {
        let column = write::width(&line[..line.find(text)?]);
        Some((u16::try_from(column).ok()?, u16::try_from(row).ok()?))
    })
}

fn state(app: &App) -> Value {
    let document = app.shown();
    let seen = app.reading();
    let answer = json!(DescribedImprint(&seen.imprint));
    let (column, row) = app.cursor();
    json!({
        "document": { "sensor": document.sensor, "source": document.source, "name": app.stored_name() },
        "unsaved": app.unsaved(),
        "cursor": [column, row],
        "region": seen.region(app.chosen()).map(|(index, _)| index),
        "imprint": answer["imprint"], "na": answer["na"], "regions": answer["regions"],
    })
}

fn expected(what: &str, found: &str) -> String {
    format!("expected {what}, found {:?}", shortened(found))
}

fn alone(name: &str, rest: &str) -> Result<(), String> {
    match rest {
        "" => Ok(()),
        _ => Err(format!(
            "{name} takes no argument, found {:?}",
            shortened(rest)
        )),
    }
}

fn file_name(name: &str, what: &str) -> Result<String, String> {
    match name {
        "" => Err(format!("expected the name of a file with {what}")),
        name => Ok(name.to_owned()),
    }
}

fn whole<T: Copy + FromStr + PartialOrd + Display>(
    text: &str,
    least: T,
    most: T,
) -> Result<T, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (&least..=&most).contains(&number));
    number.ok_or_else(|| expected(&format!("a whole number from {least} to {most}"), text))
}

fn two<'a>(text: &'a str, what: &str) -> Result<(&'a str, &'a str), String> {
    let (first, second) = text
        .split_once(char::is_whitespace)
        .ok_or_else(|| expected(&format!("a position like 12,5 and then {what}"), text))?;
    Ok((first, second.trim()))
}

/// Reads a size like `80x24`; columns and rows are at most 1000. The error does not quote the text, because a message
/// about a flag does so already.
pub(crate) fn size(text: &str) -> Result<(u16, u16), &'static str> {
    pair(text, 'x', 1..=1000).ok_or("expected a size like 80x24, from 1x1 to 1000x1000")
}

fn stated_size(text: &str) -> Result<(u16, u16), String> {
    size(text).map_err(|error| format!("{error}, found {:?}", shortened(text)))
}

/// Reads a position like `12,5`: column and row of the screen.
fn position(text: &str) -> Result<(u16, u16), String> {
    pair(text, ',', 0..=999).ok_or_else(|| expected("column,row like 12,5", text))
}

fn pair(text: &str, between: char, allowed: RangeInclusive<u16>) -> Option<(u16, u16)> {
    let (first, second) = text.split_once(between)?;
    let numbers = (first.parse().ok()?, second.parse().ok()?);
    (allowed.contains(&numbers.0) && allowed.contains(&numbers.1)).then_some(numbers)
}

fn quoted(text: &str) -> Result<String, String> {
    serde_json::from_str(text).map_err(|_| {
        let found = shortened(text);
        format!("expected a string in double quotes, found {found}")
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

/// Reads a pattern between slashes, and returns it with its text for messages.
fn pattern(text: &str) -> Result<(Regex, String), String> {
    let inner = text
        .strip_prefix('/')
        .and_then(|text| text.strip_suffix('/'));
    let inner = inner.ok_or_else(|| expected("a pattern between slashes", text))?;
    let shown = format!("/{}/", shortened(inner));
    if inner.len() > LONGEST_PATTERN {
        let length = inner.len();
        return Err(format!(
            "pattern {shown}: has {length} bytes, expected at most {LONGEST_PATTERN}"
        ));
    }
    let regex = RegexBuilder::new(inner).size_limit(LARGEST_PATTERN).build();
    match regex {
        Ok(regex) => Ok((regex, shown)),
        Err(error) => Err(format!("pattern {shown}: {error}")),
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
