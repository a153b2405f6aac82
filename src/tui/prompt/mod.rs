//! The prompts, which take one line at the foot of the screen: a name to save under, and `:` commands.
//!
//! The earlier commands are those of the running program. Up steps through them, Down through what is offered; between
//! them is the line that was being typed.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_files::formats::Name;
use taxel_files::formats::name::LONGEST;
use taxel_files::storage::{Library, ModelChoice, ModelFolder, ShapeOrigin};

use crate::tui::app::change::refuse;
use crate::tui::app::message::Message;
use crate::tui::app::page::{Canvas, Flow, Page, Place, Placed, Wheel};
use crate::tui::app::state::App;
use crate::tui::files;
use crate::tui::jobs::answer;
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::library::sentence;
use crate::tui::prompt::commands::{Names, begun, complete, offers, read, wants_names};
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};
use crate::tui::{library, live, matrix};

pub mod commands;

#[derive(Clone, Debug)]
pub struct NameDialog {
    field: TextField,
    /// Whether the program ends once the shape is saved.
    quits: bool,
}

impl NameDialog {
    pub fn proposing(name: &str, quits: bool) -> Self {
        // Longer than a name may be, so that one sees the message about a long name.
        let mut field = TextField::new(name, LONGEST + 8);
        field.enter();
        Self { field, quits }
    }
}

impl Page for NameDialog {
    /// The prompt stays open until the name is valid.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        match (message, Name::new(self.field.text())) {
            (Message::Accept, Ok(name)) => {
                let quits = self.quits;
                return Flow::ask(move |app| library::save(app, name, quits));
            }
            (Message::Accept, Err(error)) => refuse(app, error.to_string()),
            _ => _ = self.field.take(message),
        }
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Name, Place::Prompt, Wheel::Idle)
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        Some(canvas.prompt(area, "Save as: ", &self.field, ""))
    }

    fn remark(&self, _keymap: &Keymap, _body: Rect) -> Option<(String, Role)> {
        let text = self.field.text();
        let error = Name::new(text).err().filter(|_| !text.is_empty())?;
        Some((format!("! {error}"), Role::Error))
    }
}

#[derive(Clone, Debug)]
pub struct CommandDialog {
    /// The page that the prompt lies over.
    page: Context,
    field: TextField,
    /// What may stand in place of the last word, if it is not decided.
    candidates: Vec<String>,
    given: Vec<String>,
    /// Which line is shown: the typed one at 0, an earlier one below, an offered one above.
    at: isize,
    typed: String,
}

impl CommandDialog {
    pub fn over(page: Context, app: &App) -> Self {
        Self {
            page,
            field: TextField::new("", 1000),
            candidates: Vec::new(),
            given: app.commands.clone(),
            at: 0,
            typed: String::new(),
        }
    }

    /// The line that is shown is now the typed one.
    fn edited(&mut self) {
        (self.at, self.typed) = (0, self.field.text().to_owned());
    }

    /// Goes to an earlier line or back from it, or down the offers.
    fn go(&mut self, by: isize) {
        let (begun, to) = (self.typed.trim_start(), self.at + by);
        let line = match to {
            0 => Some(self.typed.clone()),
            ..0 => self.given.iter().rev().nth(to.unsigned_abs() - 1).cloned(),
            // What is offered for a command whose arguments are being typed comes last, and would replace them.
            _ => offers(&self.typed, &self.given, self.page)
                .into_iter()
                .map(|offer| offer.line)
                .filter(|line| line.starts_with(begun) || !begun.contains(' '))
                .nth(to.unsigned_abs() - 1),
        };
        if let Some(line) = line {
            self.candidates.clear();
            self.field.set(line);
            self.at = to;
        }
    }

    fn complete(&mut self, names: &[String]) {
        let (line, candidates) = complete(self.field.text(), names, self.page);
        self.field.set(line);
        self.edited();
        let is_decided = candidates.len() < 2;
        self.candidates = if is_decided { Vec::new() } else { candidates };
    }

    /// Completes the last word with names of the disk, unless something else was typed when they arrive.
    fn complete_from_disk(&mut self, app: &mut App, wanted: Names) {
        let asked = self.field.text().to_owned();
        let last_word = begun(&asked).map_or("", |(_, rest)| rest).to_owned();
        app.jobs.read("Listing the names", move |library| {
            let names = names(library, wanted, &last_word);
            answer(move |app| match names {
                Ok(names) => {
                    if let Some(own) = app.top_mut::<Self>()
                        && own.field.text() == asked
                    {
                        own.complete(&names);
                    }
                }
                Err(reason) => refuse(app, reason),
            })
        });
    }

    fn accept(&mut self, app: &mut App) -> Flow {
        let line = self.field.text().trim().to_owned();
        if line.is_empty() {
            return Flow::Close;
        }
        let message = match read(&line, app) {
            Ok(message) => message,
            Err(error) => {
                refuse(app, error);
                return Flow::Stay;
            }
        };
        let has_arguments = line.contains(' ');
        if app.commands.last() != Some(&line) {
            app.commands.push(line);
            self.given.clone_from(&app.commands);
        }
        if !matches!(
            message,
            Message::Live(_) | Message::Help | Message::SwitchPane
        ) {
            live::update::set_aside(app);
        }
        if has_arguments {
            return Flow::ask(|app| matrix::update::act(app, message));
        }
        // There is nothing to correct.
        matrix::update::act(app, message);
        Flow::Close
    }
}

/// A model may also be a path.
fn names(library: &Library, wanted: Names, last_word: &str) -> Result<Vec<String>, String> {
    let sentence = |error| sentence(library, &error);
    match wanted {
        Names::Paths => Ok(files::paths(last_word)),
        Names::Models if last_word.contains('/') => Ok(files::paths(last_word)),
        Names::Models => {
            let sets = ModelChoice::BUILT_IN
                .iter()
                .map(|set| set.name().to_owned());
            let own = ModelFolder::of(library.folder()).names().into_iter();
            Ok(sets.chain(own.map(|name| name.to_string())).collect())
        }
        Names::Deleted => match library.deleted().map_err(sentence)? {
            names if names.is_empty() => Err("nothing has been deleted".to_owned()),
            names => Ok(names),
        },
        // Shipped shapes cannot be deleted or replaced.
        Names::Shapes { own } => {
            let mut entries = library.list().map_err(sentence)?;
            entries.retain(|entry| !own || entry.origin == ShapeOrigin::Own);
            Ok(entries.into_iter().map(|entry| entry.name).collect())
        }
    }
}

impl Page for CommandDialog {
    /// The prompt stays open until a command was understood.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        match message {
            Message::Accept => return self.accept(app),
            Message::Field(_) => match wants_names(self.field.text()) {
                Some(wanted) => self.complete_from_disk(app, wanted),
                None => self.complete(&[]),
            },
            Message::Choose(Arrow::Down) => self.go(1),
            Message::Choose(Arrow::Up) => self.go(-1),
            message => {
                self.candidates.clear();
                if self.field.take(message) {
                    self.edited();
                }
            }
        }
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Command, Place::Prompt, Wheel::Idle)
    }

    /// Behind the line: as many candidates as fit, and the number of the others; of paths, the last parts.
    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let used = 1 + write::width(self.field.text());
        let room = usize::from(area.width).saturating_sub(used);
        let mut text = String::new();
        for (index, word) in self.candidates.iter().enumerate() {
            let inner = word.strip_suffix('/').unwrap_or(word);
            let word = &word[inner.rfind('/').map_or(0, |slash| slash + 1)..];
            // Two spaces separate words, because a name may contain one.
            let gap = if index == 0 { "   " } else { "  " };
            let left = self.candidates.len() - index;
            let others = if left > 1 { "  … 99 more".len() } else { 0 };
            if write::width(&text) + gap.len() + write::width(word) + others > room {
                text += &format!("{gap}… {left} more");
                break;
            }
            text = text + gap + word;
        }
        Some(canvas.prompt(area, ":", &self.field, &text))
    }

    fn draw_over(&self, theme: &Theme, buffer: &mut Buffer, body: Rect) {
        let offers = offers(&self.typed, &self.given, self.page);
        let picked = usize::try_from(self.at - 1).ok();
        let height = body.height.min(9).min(narrow(offers.len()));
        let y = body.bottom() - height;
        let area = Rect { y, height, ..body };
        write::clear(buffer, area);
        let first = write::first_of(height, offers.len(), picked.unwrap_or_default());
        let widest = offers.iter().map(|offer| write::width(&offer.line)).max();
        let indent = widest.unwrap_or(0).min(40);
        for (index, offer) in offers.iter().enumerate().skip(first).take(height.into()) {
            let here = picked == Some(index);
            let role = if here { Role::Focus } else { Role::Key };
            let line = format!("{:indent$}", offer.line);
            let gap = if offer.follows.is_empty() { "" } else { "  " };
            let pieces = [
                (if here { "> " } else { "  " }, Role::Text),
                (line.as_str(), role),
                ("  ", Role::Text),
                (&offer.follows, Role::Quiet),
                (gap, Role::Text),
                (offer.help.as_deref().unwrap_or("earlier"), Role::Quiet),
            ];
            write::line(buffer, write::row(area, index - first), theme, pieces);
        }
    }
}
