//! Help: the list of the keys that mean something in a place, as they are now.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::page::{Page, Slot};
use crate::tui::keys::action;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::{HelpLine, Keymap, help};
use crate::tui::widget::columns::broken;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// The list of the keys of a place.
#[derive(Clone, Debug)]
pub struct Help {
    /// The place whose keys are listed.
    context: Context,
    /// The index of the first visible line.
    top: usize,
}

impl Help {
    /// The list of a place, from its first line on.
    pub fn new(context: Context) -> Self {
        Self { context, top: 0 }
    }

    /// Its lines in an area of this many columns and rows, and the index of the first visible one.
    pub fn lines(&self, keymap: &Keymap, (columns, rows): (u16, u16)) -> (Vec<HelpLine>, usize) {
        let lines: Vec<HelpLine> = help(self.context, keymap)
            .into_iter()
            .flat_map(|line| broken_line(line, columns.into()))
            .collect();
        let last_top = lines.len().saturating_sub(rows.into());
        let top = self.top.min(last_top);
        (lines, top)
    }

    /// Scrolls down by a number of lines, in an area of this many columns and rows.
    pub fn scroll(&mut self, lines: i16, keymap: &Keymap, room: (u16, u16)) {
        let (_, top) = self.lines(keymap, room);
        self.top = top.saturating_add_signed(isize::from(lines));
        (_, self.top) = self.lines(keymap, room);
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
        write::clear(buffer, area);
        let (lines, top) = self.lines(keymap, area.as_size().into());
        let indent = indent(area.width.into());
        for (index, line) in lines.into_iter().skip(top).enumerate() {
            let row = write::row(area, index);
            match line {
                HelpLine::Place(context) => {
                    write::line(buffer, row, theme, [(context.title(), Role::Title)]);
                }
                HelpLine::Keys(keys, text) => {
                    let keys = format!("{:indent$}", format!("  {keys}"));
                    let pieces = [(keys.as_str(), Role::Key), (text, Role::Text)];
                    write::line(buffer, row, theme, pieces);
                }
                HelpLine::More(text) => {
                    let text = format!("{:indent$}{text}", "");
                    write::line(buffer, row, theme, [(text.as_str(), Role::Text)]);
                }
            }
        }
        None
    }

    fn scrolls(&self) -> bool {
        true
    }

    /// Which lines are visible, where not all of them are.
    fn remark(&self, keymap: &Keymap, body: Rect) -> Option<(String, Role)> {
        let (lines, top) = self.lines(keymap, body.as_size().into());
        let last = lines.len().min(top + usize::from(body.height));
        let key = |action| keymap.label(Context::Help, action);
        let more = match (top, last == lines.len()) {
            (0, true) => return None,
            (_, true) => "the end".to_owned(),
            (_, false) => format!(
                "more below: {}, {}",
                key(&action::SCROLL_DOWN),
                key(&action::PAGE_DOWN)
            ),
        };
        let text = format!("lines {}-{last} of {}; {more}", top + 1, lines.len());
        // A second line would hide the last one of the list.
        let short = format!("{last} of {}", lines.len());
        let fitting = write::first_fitting(&[&text, &short], body.width.into());
        Some((fitting.to_owned(), Role::Key))
    }
}

/// The column where the meaning of the keys begins: to the right of the keys, or near the left edge, under them, on a
/// narrow screen.
fn indent(columns: usize) -> usize {
    /// The column of the meaning where there is room beside the keys.
    const BESIDE: usize = 26;
    if columns >= BESIDE + 20 { BESIDE } else { 4 }
}

/// A line of help, broken into as many as it needs.
fn broken_line(line: HelpLine, columns: usize) -> Vec<HelpLine> {
    let HelpLine::Keys(keys, text) = line else {
        return vec![line];
    };
    let indent = indent(columns);
    let mut pieces = broken(text, columns.saturating_sub(indent)).into_iter();
    let beside = (keys.len() + 2 < indent).then(|| pieces.next()).flatten();
    let first = HelpLine::Keys(keys, beside.unwrap_or(""));
    std::iter::once(first)
        .chain(pieces.map(HelpLine::More))
        .collect()
}
