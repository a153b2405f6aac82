//! The rows of a form: labels, text fields, what the fields take, and what is wrong with them.
//!
//! ```text
//! Radius x  4.00      above 0, up to 16 cells         label, text, range
//!   ! expected a number                               what is wrong with it
//! Thickness           above 0, up to 16 cells
//!   empty: solid                                      a remark
//! ```
//! With enough room a row has two lines. In a narrow pane the range stands under the field, and an error replaces it
//! there. In a low pane every row has one line, and an error replaces the range. The row with the focus is always
//! visible: in a low pane, rows above it scroll out.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::parameter::Range;
use crate::tui::widget::field_list::{FieldList, FormField};
use crate::tui::widget::number::narrow;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

pub const WIDE: u16 = 40;

#[derive(Clone, Copy, Debug)]
pub struct FieldRows {
    area: Rect,
    /// The number of lines of a row: two if there is room, otherwise one.
    spacing: u16,
    first: usize,
    visible: usize,
}

impl FieldRows {
    /// Computes the places of rows in an area, so that the one with the focus is visible. Above them there is room for
    /// a number of `fixed` rows, which don't scroll; the focus is None if one of these has it.
    pub fn of(area: Rect, fixed: u16, rows: usize, focus: Option<usize>) -> Self {
        let two_lines = usize::from(area.height / 2) >= usize::from(fixed) + rows;
        let spacing = if two_lines { 2 } else { 1 };
        let area = write::below(area, fixed * spacing);
        let visible = usize::from(area.height / spacing).min(rows);
        Self {
            area,
            spacing,
            first: focus.map_or(0, |focus| (focus + 1).saturating_sub(visible)),
            visible,
        }
    }

    pub fn draw<F: FormField>(
        &self,
        theme: &Theme,
        list: &FieldList<F>,
        widths: (usize, usize),
        remark: impl Fn(&F) -> Option<&'static str>,
        buffer: &mut Buffer,
    ) -> Option<Position> {
        let mut cursor = None;
        for (index, place) in self.visible() {
            let Some(field) = list.fields().get(index) else {
                break;
            };
            let focused = list.focus() == Some(index);
            let row = FieldRow {
                field,
                focused,
                range: list.sensor().range(field.parameter()),
                remark: remark(field),
                error: field.error(list.sensor()).map(|error| error.brief),
            };
            let at = row.draw(theme, widths, buffer, place);
            cursor = cursor.or(focused.then_some(at));
        }
        cursor
    }

    pub fn visible(&self) -> impl Iterator<Item = (usize, Rect)> {
        let rows = *self;
        (0..rows.visible).map(move |index| {
            let below = write::below(rows.area, narrow(index) * rows.spacing);
            let height = rows.spacing;
            (rows.first + index, Rect { height, ..below })
        })
    }

    pub fn at(&self, y: u16) -> Option<usize> {
        let mut rows = self.visible();
        let row = rows.find(|(_, lines)| (lines.top()..lines.bottom()).contains(&y));
        row.map(|(index, _)| index)
    }

    pub fn rest(&self, pane: Rect) -> Rect {
        let end = self.area.y + narrow(self.visible) * self.spacing;
        write::below(pane, end - pane.y)
    }
}

#[derive(Clone, Debug)]
struct FieldRow<'a, F> {
    field: &'a F,
    focused: bool,
    range: Range,
    remark: Option<&'static str>,
    error: Option<String>,
}

impl<F: FormField> FieldRow<'_, F> {
    /// Returns the position that the text cursor has in the field.
    fn draw(
        &self,
        theme: &Theme,
        (label, input): (usize, usize),
        buffer: &mut Buffer,
        area: Rect,
    ) -> Position {
        // Without the focus a field is shown from its start; with the focus, its cursor must be visible.
        let at = if self.focused {
            self.field.input().cursor()
        } else {
            0
        };
        let (shown, cursor) = write::field_columns(self.field.text(), at, input, theme);
        let role = if self.focused {
            Role::Focus
        } else {
            Role::Text
        };
        let name = format!("{:label$}", self.field.parameter().row().label);
        let line = write::row(area, 0);
        write::line(buffer, line, theme, [(&*name, Role::Text), (&*shown, role)]);
        let beside = write::right_of(line, area.x.saturating_add(narrow(label + input + 1)));
        let under = write::right_of(write::row(area, 1), area.x.saturating_add(2));
        let (first, second) = match (area.height, area.width >= WIDE) {
            (2, true) => (beside, Some(under)),
            (2, false) => (under, None),
            _ => (beside, None),
        };
        if self.error.is_none() || second.is_some() {
            self.draw_range(theme, buffer, first, second);
        }
        if let Some(error) = &self.error {
            let place = second.unwrap_or(first);
            let text = format!("! {error}");
            write::text(buffer, place, theme, &text, Role::Error);
        }
        Position::new(area.x.saturating_add(narrow(label + cursor)), area.y)
    }

    fn draw_range(&self, theme: &Theme, buffer: &mut Buffer, area: Rect, under: Option<Rect>) {
        let range = self.range.to_string();
        let range = self.field.parameter().row().unit.after(&range);
        let (beside, below) = match (self.remark.filter(|_| self.error.is_none()), under) {
            (None, _) => (range.to_string(), None),
            (Some(remark), Some(under)) => (range.to_string(), Some((under, remark))),
            (Some(remark), None) => (format!("{range}; {remark}"), None),
        };
        write::text(buffer, area, theme, &beside, Role::Quiet);
        if let Some((under, remark)) = below {
            write::text(buffer, under, theme, remark, Role::Quiet);
        }
    }
}
