//! Help: the list of the keys that work in a place, as they are currently set, and the search in it.
//!
//! ```text
//! Search: undo   1 of 3          which match is in sight, of how many; the list follows what is typed
//! Search: unod   no match        the list stays where it was
//! ```

use ratatui::layout::{Position, Rect};

use crate::tui::app::{App, Canvas, Endpoint, Flow, Message, Page, Place, Placed, Wheel, refuse};
use crate::tui::keys::{Context, HelpLine, Keymap, action, help};
use crate::tui::widget::write::{self, around, broken};
use crate::tui::widget::{Role, TextField, contains, marked};

/// The columns of the keys.
const KEYS: usize = 26;

#[derive(Clone, Debug)]
pub struct Help {
    context: Context,
    top: usize,
    wanted: String,
    /// The entries that contain the wanted text, and the place of the shown one among them.
    matches: Vec<usize>,
    at: usize,
}

impl Help {
    pub fn new(context: Context) -> Self {
        Self {
            context,
            top: 0,
            wanted: String::new(),
            matches: Vec::new(),
            at: 0,
        }
    }

    /// The lines on the screen with their entries, of which only the first line has the keys.
    fn lines(&self, keymap: &Keymap, columns: u16) -> Vec<(usize, HelpLine)> {
        let room = usize::from(columns).saturating_sub(KEYS);
        let mut lines = Vec::new();
        for (entry, mut line) in help(self.context, keymap).into_iter().enumerate() {
            let mut texts = broken(line.text, room);
            if texts.is_empty() || write::width(&line.keys) + 2 >= KEYS {
                texts.insert(0, "");
            }
            for text in texts {
                let keys = std::mem::take(&mut line.keys);
                lines.push((entry, HelpLine { keys, text, ..line }));
            }
        }
        lines
    }

    /// The first visible line, so that the screen is full.
    fn top(&self, lines: &[(usize, HelpLine)], rows: u16) -> usize {
        self.top.min(lines.len().saturating_sub(rows.into()))
    }

    fn scroll(&mut self, by: i16, keymap: &Keymap, (columns, rows): (u16, u16)) {
        let lines = self.lines(keymap, columns);
        self.top = self.top(&lines, rows).saturating_add_signed(by.into());
        self.top = self.top(&lines, rows);
    }

    /// Goes to the first match of a text from the first visible entry on, then from the start.
    fn search(&mut self, wanted: &str, keymap: &Keymap, room: (u16, u16)) {
        let has = |line: &HelpLine| {
            let texts = [line.title, &line.keys, line.text];
            texts.iter().any(|text| contains(text, wanted))
        };
        let all = help(self.context, keymap).into_iter().enumerate();
        let matches = all.filter(|(_, line)| has(line));
        self.matches = matches.map(|(entry, _)| entry).collect();
        wanted.clone_into(&mut self.wanted);
        let lines = self.lines(keymap, room.0);
        let top = lines.get(self.top(&lines, room.1));
        let from = top.map_or(0, |(entry, _)| *entry);
        let ahead = self.matches.iter().position(|&entry| entry >= from);
        self.at = ahead.unwrap_or(0);
        self.show_match(keymap, room);
    }

    fn found(&self) -> Option<usize> {
        self.matches.get(self.at).copied()
    }

    /// The number of the match in sight, and how many there are.
    fn number(&self) -> Option<(usize, usize)> {
        (!self.matches.is_empty()).then_some((self.at + 1, self.matches.len()))
    }

    /// Makes the match visible: if it is out of sight, scrolls so that a third of the lines is above it.
    fn show_match(&mut self, keymap: &Keymap, (columns, rows): (u16, u16)) {
        let Some(entry) = self.found() else { return };
        let lines = self.lines(keymap, columns);
        let (top, height) = (self.top(&lines, rows), usize::from(rows));
        let first = lines.partition_point(|(own, _)| *own < entry);
        let end = lines.partition_point(|(own, _)| *own <= entry);
        if first < top || end > top + height {
            self.top = first.saturating_sub(height / 3);
        }
    }
}

impl Page for Help {
    /// Cancel leaves the search; without a search, help closes before Cancel and Quit come here.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let (keymap, room) = (&app.keymap, app.body_size());
        // One line of the screenful before stays visible, for the reader's orientation.
        let page = room.1.saturating_sub(1).max(1).cast_signed();
        match *message {
            Message::Scroll(lines) => self.scroll(lines, keymap, room),
            Message::ScrollScreen(by) => self.scroll(page.saturating_mul(by.into()), keymap, room),
            Message::ScrollTo(Endpoint::First) => self.top = 0,
            Message::ScrollTo(Endpoint::Last) => self.scroll(i16::MAX, keymap, room),
            Message::Match(_) if self.matches.is_empty() => {
                let search = keymap.label(Context::Help, &action::SEARCH);
                refuse(app, format!("nothing to go to: {search} searches"));
            }
            Message::Match(by) => {
                self.at = around(self.at, by, self.matches.len());
                self.show_match(keymap, room);
            }
            Message::Search => {
                return Flow::push(SearchDialog {
                    field: TextField::new("", 60),
                    before: self.clone(),
                    found: None,
                });
            }
            Message::Cancel => self.matches.clear(),
            Message::Quit => return Flow::Close,
            _ => {}
        }
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Help, Place::Body, Wheel::Rows)
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let (theme, keymap, buffer) = (canvas.theme, canvas.keymap, canvas.buffer);
        let lines = self.lines(keymap, area.width);
        let (top, found) = (self.top(&lines, area.height), self.found());
        let wanted = found.map_or("", |_| self.wanted.as_str());
        let mut cursor = None;
        for (index, (entry, line)) in lines.iter().skip(top).enumerate() {
            let row = write::row(area, index);
            let here = found == Some(*entry) && row.height > 0;
            let is_first = here && cursor.is_none();
            cursor = cursor.or(here.then_some(row.as_position()));
            let mut pieces = marked(line.title, wanted, Role::Title);
            let pad = " ".repeat(KEYS.saturating_sub(2 + write::width(&line.keys)));
            if line.title.is_empty() {
                // A sign, for terminals that cannot reverse.
                pieces.push((if is_first { "> " } else { "  " }, Role::Key));
                pieces.extend(marked(&line.keys, wanted, Role::Key));
                pieces.push((&pad, Role::Key));
                pieces.extend(marked(line.text, wanted, Role::Text));
            }
            write::line(buffer, row, theme, pieces);
        }
        cursor
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        !self.matches.is_empty() || !matches!(message, Message::Match(_))
    }

    fn cancels_itself(&self) -> bool {
        !self.matches.is_empty()
    }

    fn remark(&self, keymap: &Keymap, body: Rect) -> Option<(String, Role)> {
        let lines = self.lines(keymap, body.width);
        let top = self.top(&lines, body.height);
        let (last, all) = (lines.len().min(top + usize::from(body.height)), lines.len());
        let key = |action| keymap.label(Context::Help, action);
        let [down, page] = [&action::SCROLL_DOWN, &action::SCREEN_DOWN].map(key);
        let visible = match (top, last == all) {
            (0, true) => None,
            (_, true) => Some(format!("lines {}-{last} of {all}; the end", top + 1)),
            _ => Some(format!(
                "lines {}-{last} of {all}; more below: {down}, {page}",
                top + 1
            )),
        };
        let found = self.number();
        let found = found.map(|(number, all)| format!("match {number} of {all}"));
        let text: Vec<String> = found.into_iter().chain(visible).collect();
        (!text.is_empty()).then(|| (text.join("; "), Role::Key))
    }
}

#[derive(Clone, Debug)]
pub struct SearchDialog {
    field: TextField,
    before: Help,
    /// The number of the match in sight, and how many there are.
    found: Option<(usize, usize)>,
}

impl Page for SearchDialog {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let mut help = self.before.clone();
        let cancelled = matches!(message, Message::Cancel | Message::Quit);
        if !cancelled {
            self.field.take(message);
            help.search(self.field.text(), &app.keymap, app.body_size());
            self.found = help.number();
        }
        if let Some(below) = app.top_mut::<Help>() {
            *below = help;
        }
        let text = self.field.text();
        match message {
            Message::Accept if self.found.is_none() && !text.is_empty() => {
                refuse(app, format!("no match for {text:?}"));
            }
            Message::Accept => {}
            _ if cancelled => {}
            _ => return Flow::Stay,
        }
        Flow::Close
    }

    fn placed(&self) -> Placed {
        (Context::Search, Place::Prompt, Wheel::Idle)
    }

    /// The page below has to be restored.
    fn cancels_itself(&self) -> bool {
        true
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let found = match self.found {
            _ if self.field.text().is_empty() => "   a key, or a word of what it does".to_owned(),
            None => "   no match".to_owned(),
            Some((number, all)) => format!("   {number} of {all}"),
        };
        Some(canvas.prompt(area, "Search: ", &self.field, &found))
    }
}
