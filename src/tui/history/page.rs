//! The page with the list of steps.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::formats::value::counted;
use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot, Wheel};
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::rows::ListRows;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// The list of steps.
#[derive(Clone, Debug)]
pub struct HistoryDialog {
    /// The description of the state before all steps.
    start: String,
    /// The descriptions of the steps, the oldest first.
    steps: Vec<String>,
    /// The number of steps that lead to the present state.
    present: usize,
    /// The selected row; row 0 is the state before all steps.
    selected: usize,
}

/// The description of the state that the program begins with.
const START: &str = "the start";

impl HistoryDialog {
    /// Creates the list, with the present state selected. `start` is what brought the oldest state, in words; None if
    /// the program began with it.
    pub fn new(start: Option<&str>, steps: Vec<String>, present: usize) -> Self {
        Self {
            start: start.unwrap_or(START).to_owned(),
            steps,
            present,
            selected: present,
        }
    }

    /// Returns the number of steps that lead to the selected state.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// Selects a row, or the last one if it lies beyond.
    pub fn select(&mut self, row: usize) {
        self.selected = row.min(self.steps.len());
    }

    /// Returns the text of each row, the start first.
    fn rows(&self) -> impl Iterator<Item = &str> {
        std::iter::once(&self.start)
            .chain(&self.steps)
            .map(String::as_str)
    }

    /// Returns the visible rows in an area, below the heading.
    fn visible(&self, area: Rect) -> ListRows {
        ListRows::around(write::below(area, 1), self.steps.len() + 1, self.selected)
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
        let count = format!("   {}", counted(self.steps.len() as u64, "step"));
        let head = [("History", Role::Title), (count.as_str(), Role::Quiet)];
        write::line(buffer, area, theme, head);
        let visible = self.visible(area);
        let width = self.steps.len().to_string().len();
        for (index, row, text) in visible.visible(self.rows()) {
            let selected = index == self.selected;
            // Signs mark the rows, too, for terminals that cannot reverse.
            let sign = if selected { '>' } else { ' ' };
            let present = if index == self.present { '*' } else { ' ' };
            let role = if selected { Role::Focus } else { Role::Text };
            let number = format!("{sign}{present}{index:>width$}  ");
            write::line(buffer, row, theme, [(number.as_str(), role), (text, role)]);
        }
        visible.position(self.selected)
    }

    /// Selects a row on a click; a click on the selected row goes to its state.
    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        self.visible(area).click(at, self.selected)
    }

    fn wheel(&self) -> Wheel {
        Wheel::Rows
    }
}
