//! The steps of the history as a list: what each did, the present state marked; Enter goes to the state after a step.
//!
//! ```text
//! History   4 steps
//!   0  the start
//!   1  ellipse rx 4.00 ry 4.00 at 4.00, 4.00, 0°
//! * 2  x0 4.00 → 4.31                                 the present state
//! > 3  taxel 8, 8 switched                            the selected row is reversed
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::formats::value::counted;
use crate::tui::app::message::{Endpoint, Message};
use crate::tui::app::page::{Page, Slot};
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// The list of steps.
#[derive(Clone, Debug)]
pub struct HistoryDialog {
    /// What each step did, the oldest first.
    steps: Vec<String>,
    /// How many of them lead to the present state.
    present: usize,
    /// The selected row; row 0 is the state before all steps.
    selected: usize,
}

impl HistoryDialog {
    /// The list, the present state selected.
    pub fn new(steps: Vec<String>, present: usize) -> Self {
        Self {
            steps,
            present,
            selected: present,
        }
    }

    /// The number of steps that lead to the selected state.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// Selects another row, so many lines further down.
    pub fn scroll(&mut self, lines: i16) {
        let to = self.selected.saturating_add_signed(lines.into());
        self.selected = to.min(self.steps.len());
    }

    /// Selects the first or the last row.
    pub fn scroll_to(&mut self, end: Endpoint) {
        self.selected = match end {
            Endpoint::First => 0,
            Endpoint::Last => self.steps.len(),
        };
    }

    /// The first visible row in an area.
    fn first(&self, area: Rect) -> usize {
        let visible = area.height.saturating_sub(1);
        write::first_of(visible, self.steps.len() + 1, self.selected)
    }
}

impl Page for HistoryDialog {
    fn context(&self) -> Context {
        Context::History
    }

    fn slot(&self) -> Slot {
        Slot::Body
    }

    fn draw(
        &self,
        theme: &Theme,
        _keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        write::clear(buffer, area);
        let count = format!("   {}", counted(self.steps.len() as u64, "step"));
        let head = [("History", Role::Title), (count.as_str(), Role::Quiet)];
        write::line(buffer, area, theme, head);
        let first = self.first(area);
        let visible = usize::from(area.height.saturating_sub(1));
        let width = self.steps.len().to_string().len();
        let start = ["the start"];
        let rows = start
            .into_iter()
            .chain(self.steps.iter().map(String::as_str));
        let mut cursor = None;
        for (index, text) in rows.enumerate().skip(first).take(visible) {
            let row = write::row(area, index - first + 1);
            let selected = index == self.selected;
            // Signs beside the reversed row, for terminals that cannot reverse.
            let sign = if selected { '>' } else { ' ' };
            let present = if index == self.present { '*' } else { ' ' };
            let line = format!("{sign}{present}{index:>width$}  {text}");
            let role = if selected { Role::Focus } else { Role::Text };
            write::line(buffer, row, theme, [(line.as_str(), role)]);
            if selected {
                cursor = Some(Position::new(row.x, row.y));
            }
        }
        cursor
    }

    /// A click selects a row, a click on the selected row goes there.
    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let line = usize::from(at.y.checked_sub(area.y + 1)?);
        let row = Some(self.first(area) + line).filter(|&row| row <= self.steps.len())?;
        if row == self.selected {
            return Some(Message::Accept);
        }
        let (to, from) = (i16::try_from(row).ok()?, i16::try_from(self.selected).ok()?);
        Some(Message::Scroll(to - from))
    }

    fn scrolls(&self) -> bool {
        true
    }
}
