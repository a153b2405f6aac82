//! Runs a script: carries out its commands one by one, prints what they ask for, and stops at the first expectation
//! that does not hold.
//!
//! ```text
//! Size 80x24            before the first command that needs a screen: settings
//! Keys f<Enter>         changes the program
//! Expect /ellipse/      looks at it; a failure shows the line, the reason and the screen
//! Screen start          prints the screen
//! --- screen start 80x24 cursor 8,9 ---
//! n New   l Load   …
//! ```
//! A script is read as a whole first: if a line is malformed, none is carried out. Long work is finished before the
//! next command, so that a script always prints the same.

use std::ops::ControlFlow;
use std::path::PathBuf;

use serde_json::{Value, json};
use taxel_core::quote::shortened;
use taxel_files::formats::value::counted;
use taxel_files::formats::{DescribedImprint, StoredShape};
use taxel_files::storage::{Library, below_home};

use crate::tui::app::message::{Message, Mouse, MouseKind};
use crate::tui::app::state::{App, Options};
use crate::tui::keys::key::Key;
use crate::tui::keys::keymap::Keymap;
use crate::tui::recognise::state::RecogniseMessage;
use crate::tui::runtime::World;
use crate::tui::script::command::{
    ScreenPosition, ScriptCommand, ScriptError, ScriptSetting, read, style_name,
};
use crate::tui::script::session::Session;
use crate::tui::widget::write;

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScriptFailure {
    #[error("line {line}: {message}\n{screen}")]
    Expectation {
        /// The line number, from 1.
        line: usize,
        message: String,
        screen: String,
    },
    #[error(transparent)]
    Script(#[from] ScriptError),
    /// There is no folder for the script's own library, or its shapes cannot be put there.
    #[error("the script's own library: {0}")]
    World(String),
    #[error("stopped: the output was closed")]
    Stopped,
    #[error("line {line}: the program had already ended")]
    Ended { line: usize },
}

/// Runs a script in a world, after some keys. `print` gets the output piece by piece, and can stop the script.
/// Without any command, the screen is printed. A script that sets a library or its shapes has a world of its own
/// instead.
pub fn run(
    script: &str,
    keys: &[Key],
    settings: &ScriptOptions,
    world: World,
    mut print: impl FnMut(&str) -> ControlFlow<()>,
) -> Result<(), ScriptFailure> {
    run_shown(script, keys, settings, world, &mut |shown| match shown {
        ScriptOutput::Text(text) => print(text),
        ScriptOutput::Screen(..) => ControlFlow::Continue(()),
    })
}

#[derive(Debug)]
pub enum ScriptOutput<'a> {
    Text(&'a str),
    /// The name of a screen, which may be empty, and the session that shows it; its text is printed next.
    Screen(&'a str, &'a Session),
}

/// Runs a script like [`run`], but passes each screen itself, too: [`Session::svg`] draws it.
pub fn run_shown(
    script: &str,
    keys: &[Key],
    settings: &ScriptOptions,
    world: World,
    show: &mut impl FnMut(ScriptOutput<'_>) -> ControlFlow<()>,
) -> Result<(), ScriptFailure> {
    let commands = read(script)?;
    let start = ScriptStart::of(&commands, settings)?;
    let rest = &commands[start.lines..];
    let world = start.world(world).map_err(ScriptFailure::World)?;
    let settings = &start.settings;
    let app = App::new(&settings.options).with_keymap(settings.keymap.clone());
    let mut session = Session::of(app, world, settings.size.0, settings.size.1);
    for &key in keys {
        session.press(key);
    }
    if commands.is_empty() {
        show_screen(&session, "", settings, show)?;
    }
    for (line, command) in rest {
        if !observe(&session, *line, command, settings, show)? {
            act(&mut session, *line, command)?;
        }
    }
    Ok(())
}

/// Carries out a command that changes the program.
fn act(session: &mut Session, line: usize, command: &ScriptCommand) -> Result<(), ScriptFailure> {
    if session.app().ended() {
        return Err(ScriptFailure::Ended { line });
    }
    match command {
        ScriptCommand::Resize(columns, rows) => session.resize(*columns, *rows),
        ScriptCommand::Keys(keys) => {
            for &key in keys {
                if session.app().ended() {
                    return Err(ScriptFailure::Ended { line });
                }
                session.press(key);
            }
        }
        ScriptCommand::Type(text) => text
            .chars()
            .for_each(|character| session.press(Key::Char(character))),
        ScriptCommand::Paste(text) => session.send(Message::Paste(text.clone())),
        ScriptCommand::Click(at) => click(session, *at),
        ScriptCommand::ClickText(text) => {
            let at = find(&session.screen(), text);
            click(
                session,
                at.ok_or_else(|| {
                    let text = shortened(text);
                    fails(session, line, format!("no {text:?} to click on"))
                })?,
            );
        }
        ScriptCommand::Drag(way) => drag(session, way),
        ScriptCommand::Scroll(at, turns) => {
            let kind = if *turns < 0 {
                MouseKind::ScrollUp
            } else {
                MouseKind::ScrollDown
            };
            (0..turns.unsigned_abs()).for_each(|_| mouse(session, kind, *at));
        }
        ScriptCommand::Set(ScriptSetting::Seed(seed)) => {
            session.send(Message::Recognise(RecogniseMessage::Seed(*seed)));
        }
        ScriptCommand::Source(name) => {
            let watched = session.watch(name);
            watched.map_err(|message| fails(session, line, message))?;
        }
        ScriptCommand::Frames(count) => {
            take_frames(session, *count).map_err(|message| fails(session, line, message))?;
        }
        ScriptCommand::Signal(name) if name == "TSTP" => session.send(Message::Redraw),
        // Unsaved work is in the journal already; the program ends without a question.
        ScriptCommand::Signal(_) => session.send(Message::Terminate),
        // The shape is in the library from the start.
        ScriptCommand::Set(ScriptSetting::Shape(_)) => {}
        _ => {
            let message = "Size and Set must come before any command that needs a screen";
            return Err(wrong(line, message.to_owned()));
        }
    }
    Ok(())
}

fn take_frames(session: &mut Session, count: usize) -> Result<(), String> {
    let found = session.frames(count);
    if found == count {
        return Ok(());
    }
    let expected = counted(count as u64, "frame");
    let why = session.end_of_frames();
    Err(format!("expected {expected}, found {found}: {why}"))
}

fn drag(session: &mut Session, way: &[ScreenPosition]) {
    for (index, &at) in way.iter().enumerate() {
        let kind = if index == 0 {
            MouseKind::Press
        } else {
            MouseKind::Drag
        };
        mouse(session, kind, at);
    }
    if let Some(&last) = way.last() {
        mouse(session, MouseKind::Release, last);
    }
}

fn observe(
    session: &Session,
    line: usize,
    command: &ScriptCommand,
    settings: &ScriptOptions,
    show: &mut impl FnMut(ScriptOutput<'_>) -> ControlFlow<()>,
) -> Result<bool, ScriptFailure> {
    let fails = |message: String| Err(fails(session, line, message));
    let observes = !matches!(command, ScriptCommand::Quit | ScriptCommand::Wait);
    if observes && session.app().ended() {
        return Err(ScriptFailure::Ended { line });
    }
    match command {
        ScriptCommand::Screen(name) => show_screen(session, name, settings, show)?,
        ScriptCommand::State(pointer) => match state(session).pointer(pointer) {
            Some(part) => printed(show(ScriptOutput::Text(&format!("{part}\n"))))?,
            None => return fails(format!("the state has no {:?}", shortened(pointer))),
        },
        ScriptCommand::Quit if !session.app().ended() => {
            return fails("the program has not ended".to_owned());
        }
        ScriptCommand::Quit | ScriptCommand::Wait => {}
        command => match expect(session, command) {
            Some(Err(message)) => return fails(message),
            Some(Ok(())) => {}
            None => return Ok(false),
        },
    }
    Ok(true)
}

/// Compares the screen with what a command expects; None if the command expects nothing.
fn expect(session: &Session, command: &ScriptCommand) -> Option<Result<(), String>> {
    let failure = match command {
        ScriptCommand::Expect(pattern) => (!pattern.is_match(&session.screen()))
            .then(|| format!("no /{}/ on the screen", shortened(pattern.as_str()))),
        ScriptCommand::ExpectNot(pattern) => pattern
            .is_match(&session.screen())
            .then(|| format!("/{}/ is on the screen", shortened(pattern.as_str()))),
        ScriptCommand::ExpectAt((column, row), text) => {
            let shown = session.screen();
            let line = line_of(&shown, *row);
            let rest = line.chars().skip(character_at(line, *column));
            let found: String = rest.take(text.chars().count()).collect();
            (found != *text).then(|| {
                let (found, text) = (shortened(&found), shortened(text));
                format!("at {column},{row} there is {found:?}, expected {text:?}")
            })
        }
        ScriptCommand::ExpectStyle((column, row), letter) => {
            let index = character_at(line_of(&session.screen(), *row), *column);
            let found = line_of(&session.styles(), *row).chars().nth(index);
            (found != Some(*letter)).then(|| {
                let expected = style_name(*letter);
                match found.map(style_name) {
                    Some(found) => {
                        format!("at {column},{row} the style is {found}, expected {expected}")
                    }
                    None => format!("{column},{row} is not on the screen, expected {expected}"),
                }
            })
        }
        _ => return None,
    };
    Some(failure.map_or(Ok(()), Err))
}

fn show_screen(
    session: &Session,
    name: &str,
    settings: &ScriptOptions,
    show: &mut impl FnMut(ScriptOutput<'_>) -> ControlFlow<()>,
) -> Result<(), ScriptFailure> {
    printed(show(ScriptOutput::Screen(name, session)))?;
    printed(show(ScriptOutput::Text(&screen(session, name, settings))))
}

fn printed(flow: ControlFlow<()>) -> Result<(), ScriptFailure> {
    match flow {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(ScriptFailure::Stopped),
    }
}

/// Returns the error for a line that cannot be carried out.
fn wrong(line: usize, message: String) -> ScriptFailure {
    ScriptError { line, message }.into()
}

fn fails(session: &Session, line: usize, message: String) -> ScriptFailure {
    let screen = session
        .screen()
        .lines()
        .map(|row| format!("  | {row}\n"))
        .collect();
    ScriptFailure::Expectation {
        line,
        message,
        screen,
    }
}

fn mouse(session: &mut Session, kind: MouseKind, (column, row): ScreenPosition) {
    session.send(Message::Mouse(Mouse { kind, column, row }));
}

fn click(session: &mut Session, at: ScreenPosition) {
    mouse(session, MouseKind::Press, at);
    mouse(session, MouseKind::Release, at);
}

fn find(screen: &str, text: &str) -> Option<ScreenPosition> {
    screen.lines().enumerate().find_map(|(row, line)| {
        let column = write::width(&line[..line.find(text)?]);
        Some((u16::try_from(column).ok()?, u16::try_from(row).ok()?))
    })
}

/// Returns the index of the character in a column; a wide character takes two columns.
fn character_at(line: &str, column: u16) -> usize {
    let (mut end, column) = (0, usize::from(column));
    let before = line.chars().take_while(|character| {
        end += write::width(character.encode_utf8(&mut [0; 4]));
        end <= column
    });
    before.count() + column.saturating_sub(write::width(line))
}

/// Returns a row of a screen; empty below the last one.
fn line_of(grid: &str, row: u16) -> &str {
    grid.lines().nth(row.into()).unwrap_or("")
}

fn screen(session: &Session, name: &str, settings: &ScriptOptions) -> String {
    let (columns, rows) = session.size();
    let cursor = session.cursor();
    if settings.json {
        let lines = |grid: String| grid.lines().map(str::to_owned).collect::<Vec<_>>();
        let object = json!({
            "screen": name, "size": [columns, rows],
            "cursor": cursor.map(|cursor| [cursor.x, cursor.y]),
            "rows": lines(session.screen()), "styles": lines(session.styles()),
        });
        return format!("{object}\n");
    }
    let name = if name.is_empty() {
        String::new()
    } else {
        format!(" {name}")
    };
    let cursor = cursor.map_or("no cursor".to_owned(), |cursor| {
        format!("cursor {},{}", cursor.x, cursor.y)
    });
    let header = format!("--- screen{name} {columns}x{rows} {cursor} ---\n");
    let styles = if settings.styles {
        format!("--- styles ---\n{}", session.styles())
    } else {
        String::new()
    };
    header + &session.screen() + &styles
}

fn state(session: &Session) -> Value {
    let app = session.app();
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

#[derive(Clone, Debug)]
pub struct ScriptOptions {
    pub options: Options,
    /// Columns and rows of the screen, unless the script sets them.
    pub size: (u16, u16),
    pub styles: bool,
    pub json: bool,
    pub keymap: Keymap,
    /// The only folder below which the script may write; None if it may write anywhere and use any library.
    pub folder: Option<PathBuf>,
}

#[derive(Debug)]
pub(super) struct ScriptStart<'a> {
    /// The options, changed by the script's settings.
    pub(super) settings: ScriptOptions,
    pub(super) lines: usize,
    library: Option<(usize, Library)>,
    /// The shapes of the user's library; only the last of those with the same name.
    shapes: Vec<&'a StoredShape>,
    leftovers: Vec<&'a StoredShape>,
}

impl<'a> ScriptStart<'a> {
    /// Reads the start from the commands of a script, each with its line. `settings` apply where the script sets
    /// nothing.
    ///
    /// `Set shape` may also come later in a script, because a recorder learns only then which shapes are used. These
    /// shapes, too, exist from the start.
    pub(super) fn of(
        commands: &'a [(usize, ScriptCommand)],
        settings: &ScriptOptions,
    ) -> Result<Self, ScriptError> {
        let is_setting = |command: &ScriptCommand| matches!(command, ScriptCommand::Set(_));
        let lines = commands
            .iter()
            .take_while(|(_, command)| is_setting(command));
        let mut start = Self {
            settings: settings.clone(),
            lines: lines.count(),
            library: None,
            shapes: Vec::new(),
            leftovers: Vec::new(),
        };
        for (index, (line, command)) in commands.iter().enumerate() {
            match command {
                ScriptCommand::Set(ScriptSetting::Shape(shape)) => start.put(shape),
                ScriptCommand::Set(setting) if index < start.lines => {
                    let set = start.set(*line, setting);
                    set.map_err(|message| ScriptError {
                        line: *line,
                        message,
                    })?;
                }
                _ => {}
            }
        }
        match start.library {
            Some((line, _)) if !start.shapes.is_empty() || !start.leftovers.is_empty() => {
                let message = "Set library cannot be used with Set shape or Set leftover";
                Err(ScriptError {
                    line,
                    message: message.to_owned(),
                })
            }
            _ => Ok(start),
        }
    }

    fn put(&mut self, shape: &'a StoredShape) {
        let same = |own: &&StoredShape| own.name.same(shape.name.as_str());
        match self.shapes.iter().position(same) {
            Some(index) => self.shapes[index] = shape,
            None => self.shapes.push(shape),
        }
    }

    fn set(&mut self, line: usize, setting: &'a ScriptSetting) -> Result<(), String> {
        let options = &mut self.settings.options;
        match setting {
            ScriptSetting::Size(columns, rows) => self.settings.size = (*columns, *rows),
            ScriptSetting::Seed(seed) => options.seed = *seed,
            ScriptSetting::Ascii(ascii) => options.theme.ascii = *ascii,
            ScriptSetting::Color(depth) => options.theme.depth = *depth,
            ScriptSetting::Theme(palette) => options.theme.palette = *palette,
            ScriptSetting::Sensor(parameter, value) => {
                let sensor = options.sensor.with(*parameter, *value);
                options.sensor = sensor.map_err(|error| error.to_string())?;
            }
            ScriptSetting::Library(_) if self.settings.folder.is_some() => {
                return Err("Set library needs --allow-outside; without that line, the script has its own library"
                    .to_owned());
            }
            ScriptSetting::Library(folder) => {
                let folder = below_home(&folder.to_string_lossy())
                    .ok_or("no home folder, so ~ cannot be used")?;
                self.library = Some((line, Library::open(folder)));
            }
            ScriptSetting::Shape(_) => {}
            ScriptSetting::Leftover(shape) => self.leftovers.push(shape),
        }
        Ok(())
    }

    /// Returns the world for the script: `own`, unless the script sets a library or its shapes.
    pub(super) fn world(&self, own: World) -> Result<World, String> {
        let world = match &self.library {
            Some((_, library)) => World::for_script(library.clone()),
            None if self.shapes.is_empty() && self.leftovers.is_empty() => own,
            None => World::with_contents(&self.shapes, &self.leftovers)?,
        };
        Ok(match &self.settings.folder {
            Some(folder) => world.confined_to(folder.clone()),
            None => world,
        })
    }
}
