//! The steps of the history as a list: what each step did, with the present state marked. Enter goes to the state
//! after a step.
//!
//! ```text
//! History   4 steps
//!   0  the start
//!   1  ellipse rx 4.00 ry 4.00 at 4.00, 4.00, 0°
//! * 2  x0 4.00 → 4.31                                 the present state
//! > 3  taxel 8, 8 off                                 the selected row is reversed
//! ```

use ratatui::layout::{Position, Rect};
use taxel_files::formats::value::counted;

use crate::tui::app::{
    App, Canvas, Flow, Message, Page, Place, Placed, Reading, Wheel, compare_with, go_to,
};
use crate::tui::keys::Context;
use crate::tui::widget::{ListRows, Role, moved, write};

pub(crate) struct HistoryDialog {
    /// The start, then the steps.
    rows: Vec<String>,
    present: usize,
    selected: usize,
}

impl HistoryDialog {
    pub(crate) fn new((rows, present): (Vec<String>, usize)) -> Self {
        Self {
            rows,
            present,
            selected: present,
        }
    }

    fn visible(&self, area: Rect) -> ListRows {
        ListRows::around(write::below(area, 1), self.rows.len(), self.selected)
    }
}

impl Page for HistoryDialog {
    /// Comparing leaves the list open below.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let step = self.selected;
        match message {
            Message::Compare => {
                let state = app.history.after(step);
                if let Some(imprint) = state.map(|state| Reading::of(state).imprint) {
                    compare_with(app, &format!("the state after step {step}"), &imprint);
                }
            }
            Message::Quit => return Flow::Close,
            Message::Accept => {
                go_to(app, step);
                return Flow::Close;
            }
            _ => {
                if let Some(row) = moved(step, message) {
                    self.selected = row.min(self.rows.len() - 1);
                }
            }
        }
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::History, Place::Body, Wheel::Rows)
    }

    fn draw(&self, Canvas { theme, buffer, .. }: Canvas<'_>, area: Rect) -> Option<Position> {
        let count = format!("   {}", counted(self.rows.len() as u64 - 1, "step"));
        let head = [("History", Role::Title), (count.as_str(), Role::Quiet)];
        write::line(buffer, area, theme, head);
        let visible = self.visible(area);
        let width = (self.rows.len() - 1).to_string().len();
        for (index, row, text) in visible.visible(self.rows.iter()) {
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

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        self.visible(area).click(at, self.selected)
    }
}
