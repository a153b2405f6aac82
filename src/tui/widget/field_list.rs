//! A list of text fields for parameters, one of which may have the focus: the state of every form.
//!
//! A form has its own type of [`FormField`], which says what its text may be: a number, a range. Above or below the
//! fields there may be one more row that can have the focus, such as the kind of a figure; the form itself handles its
//! keys.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::parameter::{Parameter, ParameterError, Range};
use taxel_core::sensor::Sensor;

use crate::tui::app::message::Message;
use crate::tui::keys::key::Arrow;
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, around, narrow};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormError {
    pub brief: String,
    pub full: String,
}

impl From<ParameterError> for FormError {
    fn from(error: ParameterError) -> Self {
        Self {
            brief: error.expected(),
            full: error.labelled(),
        }
    }
}

pub trait FormField {
    fn parameter(&self) -> Parameter;

    fn input(&self) -> &TextField;

    fn input_mut(&mut self) -> &mut TextField;

    fn error(&self, sensor: &Sensor) -> Option<FormError>;

    fn text(&self) -> &str {
        self.input().text()
    }
}

/// One of them has the focus, or none if another row of the form has it.
#[derive(Clone, Debug)]
pub struct FieldList<F> {
    fields: Vec<F>,
    other_row: bool,
    focus: Option<usize>,
    sensor: Sensor,
}

impl<F: FormField> FieldList<F> {
    pub fn new(fields: Vec<F>, other_row: bool, sensor: Sensor) -> Self {
        Self {
            fields,
            other_row,
            focus: None,
            sensor,
        }
    }

    pub fn fields(&self) -> &[F] {
        &self.fields
    }

    pub fn fields_mut(&mut self) -> &mut [F] {
        &mut self.fields
    }

    pub fn take_fields(&mut self) -> Vec<F> {
        std::mem::take(&mut self.fields)
    }

    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    pub fn focus(&self) -> Option<usize> {
        self.focus
    }

    pub fn set_focus(&mut self, focus: Option<usize>) {
        self.focus = focus.map(|index| index.min(self.fields.len().saturating_sub(1)));
        if let Some(field) = self.focused() {
            field.input_mut().enter();
        }
    }

    /// Moves the focus by `by` rows; the first row follows the last. The other row lies between these two.
    pub fn move_focus(&mut self, by: i8) {
        let other = usize::from(self.other_row);
        let now = self.focus.map_or(0, |index| index + other);
        let next = around(now, by, self.fields.len() + other);
        self.set_focus(next.checked_sub(other));
    }

    pub fn focused(&mut self) -> Option<&mut F> {
        self.fields.get_mut(self.focus?)
    }

    pub fn error(&self) -> Option<(usize, FormError)> {
        let mut fields = self.fields.iter().enumerate();
        fields.find_map(|(index, field)| Some((index, field.error(&self.sensor)?)))
    }

    pub fn take(&mut self, message: &Message) {
        match message {
            Message::Field(by) => self.move_focus(*by),
            Message::ToField(field) => self.set_focus(*field),
            Message::Choose(Arrow::Up) => self.move_focus(-1),
            Message::Choose(Arrow::Down) => self.move_focus(1),
            message => {
                if let Some(field) = self.focused() {
                    field.input_mut().take(message);
                }
            }
        }
    }
}

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
        let bare = self.range.to_string();
        let range = self.field.parameter().row().unit.after(&bare);
        let (beside, below) = match (self.remark.filter(|_| self.error.is_none()), under) {
            (None, _) => (range, None),
            (Some(remark), Some(under)) => (range, Some((under, remark))),
            // Without the unit, both have room on a screen of 80 columns.
            (Some(remark), None) => (format!("{bare}; {remark}"), None),
        };
        write::text(buffer, area, theme, &beside, Role::Quiet);
        if let Some((under, remark)) = below {
            write::text(buffer, under, theme, remark, Role::Quiet);
        }
    }
}
