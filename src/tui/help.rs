//! Help: the list of the keys that work in a place, as they are currently set. It can be searched:
//! [`crate::tui::search`].

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::change::refuse;
use crate::tui::app::dialog::Dialog;
use crate::tui::app::message::{Endpoint, Message};
use crate::tui::app::page::{Page, Slot, Wheel};
use crate::tui::app::state::App;
use crate::tui::keys::action;
use crate::tui::keys::keymap::{Context, HelpLine, Keymap, help};
use crate::tui::runtime::effect::Effect;
use crate::tui::search::{SearchDialog, no_search};
use crate::tui::widget::rows::{Search, contains, marked, number};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;
use crate::tui::widget::write::broken;

#[derive(Clone, Debug)]
pub struct Help {
    context: Context,
    /// An entry has other lines on a screen of another width.
    top: (usize, usize),
    pub search: Search,
}

type Lines = Vec<(usize, HelpLine)>;

impl Help {
    pub fn new(context: Context) -> Self {
        Self {
            context,
            top: (0, 0),
            search: Search::default(),
        }
    }

    fn lines(&self, keymap: &Keymap, (columns, rows): (u16, u16)) -> (Lines, usize) {
        let broken = |(entry, line)| {
            let lines = broken_line(line, columns.into()).into_iter();
            lines.map(move |line| (entry, line))
        };
        let entries = (0..).zip(help(self.context, keymap));
        let lines: Lines = entries.flat_map(broken).collect();
        let (entry, line) = self.top;
        let first = lines.partition_point(|(own, _)| *own < entry);
        let next = lines.partition_point(|(own, _)| *own <= entry);
        let top = (first + line).min(next.saturating_sub(1));
        let last_top = lines.len().saturating_sub(rows.into());
        (lines, top.min(last_top))
    }

    /// Scrolls down by `by` lines, or up if negative, in an area of this many columns and rows.
    pub fn scroll(&mut self, by: i16, keymap: &Keymap, room: (u16, u16)) {
        let (lines, top) = self.lines(keymap, room);
        self.set_top(&lines, top.saturating_add_signed(by.into()), room.1);
    }

    fn set_top(&mut self, lines: &Lines, line: usize, rows: u16) {
        let line = line.min(lines.len().saturating_sub(rows.into()));
        let entry = lines.get(line).map_or(0, |(entry, _)| *entry);
        let first = lines.partition_point(|(own, _)| *own < entry);
        self.top = (entry, line - first);
    }

    pub fn search_for(
        &mut self,
        wanted: &str,
        keymap: &Keymap,
        room: (u16, u16),
    ) -> Option<(usize, usize)> {
        let entries = matches(self.context, keymap, wanted);
        let (lines, top) = self.lines(keymap, room);
        let from = lines.get(top).map_or(0, |(entry, _)| *entry);
        let entry = self.search.begin(wanted, &entries, from)?;
        self.show(entry, keymap, room);
        number(entry, &entries)
    }

    pub fn go_to_match(&mut self, by: i8, keymap: &Keymap, room: (u16, u16)) -> bool {
        let entries = matches(self.context, keymap, self.search.wanted());
        let from = self.search.entry();
        let Some(entry) = from.and_then(|from| self.search.go(from, by, &entries)) else {
            return false;
        };
        self.show(entry, keymap, room);
        true
    }

    /// Makes an entry visible: if it is out of sight, scrolls so that a third of the lines is above it.
    fn show(&mut self, entry: usize, keymap: &Keymap, room: (u16, u16)) {
        let (lines, top) = self.lines(keymap, room);
        let rows = usize::from(room.1);
        let own = |(index, _): &(usize, HelpLine)| *index == entry;
        let (first, last) = (lines.iter().position(own), lines.iter().rposition(own));
        if let (Some(first), Some(last)) = (first, last)
            && (first < top || last >= top + rows)
        {
            self.set_top(&lines, first.saturating_sub(rows / 3), room.1);
        }
    }

    /// Draws a line, with the matches of the search marked. `here`: the search is at this entry, which then has a
    /// sign, for terminals that cannot reverse.
    fn draw_line(
        &self,
        theme: &Theme,
        line: &HelpLine,
        here: bool,
        buffer: &mut Buffer,
        row: Rect,
    ) {
        let wanted = self.search.wanted();
        let mut pieces = Vec::new();
        let pad;
        match line {
            HelpLine::Place(context) => pieces.extend(marked(context.title(), wanted, Role::Title)),
            HelpLine::Keys(keys, text) => {
                pieces.push((if here { "> " } else { "  " }, Role::Key));
                pieces.extend(marked(keys, wanted, Role::Key));
                pad = " ".repeat(INDENT.saturating_sub(2 + write::width(keys)));
                pieces.push((&pad, Role::Key));
                pieces.extend(marked(text, wanted, Role::Text));
            }
            HelpLine::More(text) => {
                pad = " ".repeat(INDENT);
                pieces.push((&pad, Role::Text));
                pieces.extend(marked(text, wanted, Role::Text));
            }
        }
        write::line(buffer, row, theme, pieces);
    }
}

impl Page for Help {
    fn context(&self) -> Context {
        Context::Help
    }

    fn slot(&self) -> Slot {
        Slot::Body
    }

    fn draw(
        &self,
        theme: &Theme,
        keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let (lines, top) = self.lines(keymap, area.as_size().into());
        let here = self.search.entry();
        let mut cursor = None;
        for (index, (entry, line)) in lines.iter().skip(top).enumerate() {
            let row = write::row(area, index);
            let here = here == Some(*entry);
            self.draw_line(theme, line, here, buffer, row);
            if here && row.height > 0 && cursor.is_none() {
                cursor = Some(Position::new(row.x, row.y));
            }
        }
        cursor
    }

    fn wheel(&self) -> Wheel {
        Wheel::Rows
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        self.search.entry().is_some() || !matches!(message, Message::Match(_))
    }

    fn cancels_itself(&self) -> bool {
        self.search.entry().is_some()
    }

    fn remark(&self, keymap: &Keymap, body: Rect) -> Option<(String, Role)> {
        let (lines, top) = self.lines(keymap, body.as_size().into());
        let last = lines.len().min(top + usize::from(body.height));
        let key = |action| keymap.label(Context::Help, action);
        let more = match (top, last == lines.len()) {
            (0, true) => None,
            (_, true) => Some("the end".to_owned()),
            (_, false) => Some(format!(
                "more below: {}, {}",
                key(&action::SCROLL_DOWN),
                key(&action::SCREEN_DOWN)
            )),
        };
        let visible =
            more.map(|more| format!("lines {}-{last} of {}; {more}", top + 1, lines.len()));
        let entries = matches(self.context, keymap, self.search.wanted());
        let found = self.search.entry();
        let found = found.and_then(|entry| number(entry, &entries));
        let found = found.map(|(number, all)| format!("match {number} of {all}"));
        let text: Vec<String> = found.into_iter().chain(visible).collect();
        (!text.is_empty()).then(|| (text.join("; "), Role::Key))
    }
}

fn matches(context: Context, keymap: &Keymap, wanted: &str) -> Vec<usize> {
    let has = |line: &HelpLine| match line {
        HelpLine::Place(context) => contains(context.title(), wanted),
        HelpLine::Keys(keys, text) => contains(keys, wanted) || contains(text, wanted),
        HelpLine::More(text) => contains(text, wanted),
    };
    let entries = (0..).zip(help(context, keymap));
    entries
        .filter(|(_, line)| has(line))
        .map(|(entry, _)| entry)
        .collect()
}

const INDENT: usize = 26;

fn broken_line(line: HelpLine, columns: usize) -> Vec<HelpLine> {
    let HelpLine::Keys(keys, text) = line else {
        return vec![line];
    };
    let mut pieces = broken(text, columns.saturating_sub(INDENT)).into_iter();
    let beside = (keys.len() + 2 < INDENT).then(|| pieces.next()).flatten();
    let first = HelpLine::Keys(keys, beside.unwrap_or(""));
    std::iter::once(first)
        .chain(pieces.map(HelpLine::More))
        .collect()
}

/// Cancel leaves the search; without a search, help closes before Cancel and Quit come here.
pub(in crate::tui) fn in_help(app: &mut App, mut help: Help, message: &Message) -> Option<Effect> {
    let (keymap, room) = (app.keymap(), app.body_size());
    let mut refused = None;
    match *message {
        Message::Scroll(lines) => help.scroll(lines, keymap, room),
        Message::ScrollScreen(by) => {
            // One line of the screenful before stays visible, for the reader's orientation.
            let page = room.1.saturating_sub(1).max(1).cast_signed();
            help.scroll(page.saturating_mul(by.into()), keymap, room);
        }
        Message::ScrollTo(Endpoint::First) => help.scroll(i16::MIN, keymap, room),
        Message::ScrollTo(Endpoint::Last) => help.scroll(i16::MAX, keymap, room),
        Message::Match(by) if !help.go_to_match(by, keymap, room) => {
            refused = Some(no_search(keymap, Context::Help));
        }
        Message::Search => {
            let dialog = SearchDialog::new(help.clone());
            app.dialogs
                .extend([Dialog::Help(help), Dialog::Search(dialog)]);
            return None;
        }
        Message::Cancel => help.search.end(),
        Message::Quit => return None,
        _ => {}
    }
    app.dialogs.push(Dialog::Help(help));
    if let Some(text) = refused {
        refuse(app, text);
    }
    None
}
