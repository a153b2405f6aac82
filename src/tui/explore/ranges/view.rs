//! The form of ranges, beside the matrix.
//!
//! ```text
//! Explore: hexagon                          what is swept
//! x0      5:5.99:0.01    -16 to 16 cells    a field
//! y0      5:5.99:0.01    -16 to 16 cells
//! Anchor  < corner >     top left, before turning
//! 3,600,000 poses, about 20 seconds         the number of poses, and the time that a sweep takes
//! ! the sensor cuts off 1,200 poses         the number of poses in which the shape reaches beyond the sensor
//! without 1 taxel set by hand               what the sweep ignores
//! ```
//! Fields are drawn by [`crate::tui::widget::field_rows`].

use std::time::Duration;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::formats::value::{counted, time_in_words};
use crate::pose::Anchor;
use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot};
use crate::tui::explore::ranges::state::RangesForm;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::field_rows::FieldRows;
use crate::tui::widget::number::narrow;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

const LABEL: usize = 8;
const INPUT: usize = 16;

impl Page for RangesForm {
    fn context(&self) -> Context {
        Context::Ranges
    }

    fn slot(&self) -> Slot {
        Slot::Form
    }

    fn draw(
        &self,
        theme: &Theme,
        _keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let title = self.title();
        write::text(buffer, area, theme, &title, Role::Title);
        let rows = rows(self, area);
        let fields = self.form();
        let mut cursor = rows.draw(theme, fields, (LABEL, INPUT), |_| None, buffer);
        let mut others = rows
            .visible()
            .skip_while(|(index, _)| *index < fields.fields().len());
        if let Some((_, row)) = others.next() {
            let at = draw_anchor(theme, self, buffer, row);
            cursor = cursor.or(fields.focus().is_none().then_some(at));
        }
        draw_summary(theme, self, buffer, rows.rest(area));
        cursor
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let row = rows(self, area).at(at.y)?;
        Some(Message::ToField(
            (row < self.form().fields().len()).then_some(row),
        ))
    }
}

/// The title is above them; below them are three lines, or as many as the rows leave, but at least one.
fn rows(form: &RangesForm, area: Rect) -> FieldRows {
    let (below, rows) = (write::below(area, 1), form.form().fields().len() + 1);
    let foot = below.height.saturating_sub(narrow(rows)).clamp(1, 3);
    let height = below.height.saturating_sub(foot);
    let focus = form.form().focus().unwrap_or(rows - 1);
    FieldRows::of(Rect { height, ..below }, 0, rows, Some(focus))
}

fn draw_anchor(theme: &Theme, form: &RangesForm, buffer: &mut Buffer, row: Rect) -> Position {
    let label = format!("{:LABEL$}", "Anchor");
    let (name, meaning) = match form.anchor() {
        Anchor::Corner => ("corner", "top left, before turning"),
        Anchor::Centre => ("centre", "point it turns about"),
    };
    let role = if form.form().focus().is_none() {
        Role::Focus
    } else {
        Role::Text
    };
    let pieces = [
        (label.as_str(), Role::Text),
        ("< ", Role::Quiet),
        (name, role),
        (" > ", Role::Quiet),
        (meaning, Role::Quiet),
    ];
    write::line(buffer, row, theme, pieces);
    Position::new(row.x.saturating_add(narrow(LABEL)), row.y)
}

fn draw_summary(theme: &Theme, form: &RangesForm, buffer: &mut Buffer, area: Rect) {
    let (text, role) = match form.grid() {
        Ok(grid) => {
            let poses = counted(grid.poses(), "pose");
            let time = form.estimate().map(|time| format!(", {}", about(time)));
            (poses + time.as_deref().unwrap_or(""), Role::Text)
        }
        // A wrong field shows its own error.
        Err(_) if form.form().error().is_some() => (String::new(), Role::Text),
        Err(error) => {
            for (index, line) in error.brief.lines().enumerate() {
                let pieces = [("! ", Role::Error), (line, Role::Error)];
                write::line(buffer, write::row(area, index), theme, pieces);
            }
            return;
        }
    };
    write::text(buffer, write::row(area, 0), theme, &text, role);
    let mut line = 1;
    if let Some(cut_off) = form.cut_off().filter(|&poses| poses > 0) {
        let all = form.grid().is_ok_and(|grid| grid.poses() == cut_off);
        let text = match cut_off {
            _ if all => "! the sensor cuts off every pose".to_owned(),
            1 => "! the sensor cuts off 1 pose".to_owned(),
            _ => format!("! the sensor cuts off {}", counted(cut_off, "pose")),
        };
        let row = write::row(area, line);
        write::text(buffer, row, theme, &text, Role::Error);
        line += 1;
    }
    if form.by_hand() > 0 {
        let taxels = counted(form.by_hand(), "taxel");
        let text = format!("without {taxels} set by hand");
        let row = write::row(area, line);
        write::text(buffer, row, theme, &text, Role::Quiet);
    }
}

pub fn about(time: Duration) -> String {
    if time < Duration::from_secs(1) {
        return "under a second".to_owned();
    }
    format!("about {}", time_in_words(time.as_secs_f64()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_given_in_a_fitting_unit() {
        let said = [0, 1, 99, 100, 5_999, 7_300, 172_800, 400_000_000];
        let said = said.map(|seconds| about(Duration::from_secs(seconds)));
        assert_eq!(
            said,
            [
                "under a second",
                "about 1 second",
                "about 99 seconds",
                "about 100 seconds",
                "about 100 minutes",
                "about 2 hours",
                "about 2 days",
                "about 4,630 days"
            ]
        );
    }
}
