//! Help: the list of the keys that work in a place, as they are currently set.

use ratatui::layout::{Position, Rect};

use crate::tui::app::{App, Canvas, Endpoint, Flow, Message, Page, Place, Placed, Wheel};
use crate::tui::keys::{Context, HelpLine, Keymap, action, help};
use crate::tui::widget::Role;
use crate::tui::widget::write::{self, broken};

/// The columns of the keys.
const KEYS: usize = 26;

#[derive(Clone, Debug)]
pub struct Help {
    context: Context,
    top: usize,
}

impl Help {
    pub fn new(context: Context) -> Self {
        Self { context, top: 0 }
    }

    /// The lines on the screen; of an entry, only the first one has the keys.
    fn lines(&self, keymap: &Keymap, columns: u16) -> Vec<HelpLine> {
        let room = usize::from(columns).saturating_sub(KEYS);
        let mut lines = Vec::new();
        for mut line in help(self.context, keymap) {
            let mut texts = broken(line.text, room);
            if texts.is_empty() || write::width(&line.keys) + 2 >= KEYS {
                texts.insert(0, "");
            }
            for text in texts {
                let keys = std::mem::take(&mut line.keys);
                lines.push(HelpLine { keys, text, ..line });
            }
        }
        lines
    }

    /// The first visible line, so that the screen is full.
    fn top(&self, lines: &[HelpLine], rows: u16) -> usize {
        self.top.min(lines.len().saturating_sub(rows.into()))
    }

    fn scroll(&mut self, by: i16, keymap: &Keymap, (columns, rows): (u16, u16)) {
        let lines = self.lines(keymap, columns);
        self.top = self.top(&lines, rows).saturating_add_signed(by.into());
        self.top = self.top(&lines, rows);
    }
}

impl Page for Help {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let (keymap, room) = (&app.keymap, app.body_size());
        // One line of the screenful before stays visible, for the reader's orientation.
        let page = room.1.saturating_sub(1).max(1).cast_signed();
        match *message {
            Message::Scroll(lines) => self.scroll(lines, keymap, room),
            Message::ScrollScreen(by) => self.scroll(page.saturating_mul(by.into()), keymap, room),
            Message::ScrollTo(Endpoint::First) => self.top = 0,
            Message::ScrollTo(Endpoint::Last) => self.scroll(i16::MAX, keymap, room),
            _ => {}
        }
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Help, Place::Body, Wheel::Rows)
    }

    fn draw(&self, mut canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let lines = self.lines(canvas.keymap, area.width);
        let visible = lines.iter().skip(self.top(&lines, area.height));
        for (line, row) in visible.zip(area.rows()) {
            if line.title.is_empty() {
                let keys = format!("  {:1$}", line.keys, KEYS - 2);
                canvas.line(row, [(&*keys, Role::Key), (line.text, Role::Text)]);
            } else {
                canvas.text(row, line.title, Role::Title);
            }
        }
        None
    }

    fn remark(&self, keymap: &Keymap, body: Rect) -> Option<(String, Role)> {
        let lines = self.lines(keymap, body.width);
        let top = self.top(&lines, body.height);
        let (last, all) = (lines.len().min(top + usize::from(body.height)), lines.len());
        let key = |action| keymap.label(Context::Help, action);
        let [down, page] = [&action::SCROLL_DOWN, &action::SCREEN_DOWN].map(key);
        let end = match (top, last == all) {
            (0, true) => return None,
            (_, true) => "; the end".to_owned(),
            _ => format!("; more below: {down}, {page}"),
        };
        Some((format!("lines {}-{last} of {all}{end}", top + 1), Role::Key))
    }
}
