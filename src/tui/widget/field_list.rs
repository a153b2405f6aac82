//! A list of text fields for parameters, one of which may have the focus: the state of every form.
//!
//! A form has its own type of [`FormField`], which says what its text may be: a number, a range. Above or below the
//! fields there may be one more row that can have the focus, such as the kind of a figure; the form itself handles its
//! keys.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::parameter::{Parameter, ParameterError};
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
    pub(crate) fields: Vec<F>,
    other_row: bool,
    pub(crate) focus: Option<usize>,
    pub(crate) sensor: Sensor,
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

/// The places of the rows of a form, of which those scroll that do not fit.
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
        let first = focus.map_or(0, |focus| (focus + 1).saturating_sub(visible));
        Self {
            area,
            spacing,
            first,
            visible,
        }
    }

    /// Draws the fields, with labels and inputs of these widths, and returns the position of the cursor.
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
            if let Some(field) = list.fields.get(index) {
                let focused = list.focus == Some(index);
                let at = draw_field(theme, field, focused, widths, buffer, place);
                cursor = cursor.or(focused.then_some(at.0));
                draw_remarks(
                    theme,
                    field,
                    &list.sensor,
                    remark(field),
                    buffer,
                    (place, at.1),
                );
            }
        }
        cursor
    }

    pub fn visible(&self) -> impl Iterator<Item = (usize, Rect)> + use<> {
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

/// Draws label and text. A field with the focus is as wide as its text. Returns the position of the cursor, and the
/// column after the field.
fn draw_field<F: FormField>(
    theme: &Theme,
    field: &F,
    focused: bool,
    (label, least): (usize, usize),
    buffer: &mut Buffer,
    row: Rect,
) -> (Position, u16) {
    let most = usize::from(row.width).saturating_sub(label).max(least);
    let (role, at, width) = match (focused, write::width(field.text()) + 1) {
        (true, needed) => (
            Role::Focus,
            field.input().cursor(),
            needed.clamp(least, most),
        ),
        // Without the focus it is shown from its start.
        (false, _) => (Role::Text, 0, least),
    };
    let (shown, cursor) = write::field_columns(field.text(), at, width, theme);
    let name = format!("{:label$}", field.parameter().row().label);
    write::line(buffer, row, theme, [(&*name, Role::Text), (&*shown, role)]);
    let column = |after: usize| row.x.saturating_add(narrow(label + after));
    (Position::new(column(cursor), row.y), column(width + 1))
}

/// Draws what is allowed beside a field, and below it what is wrong with it or a remark; on a single line, the error
/// or both.
fn draw_remarks<F: FormField>(
    theme: &Theme,
    field: &F,
    sensor: &Sensor,
    remark: Option<&str>,
    buffer: &mut Buffer,
    (row, after): (Rect, u16),
) {
    let bare = sensor.range(field.parameter()).to_string();
    let range = field.parameter().row().unit.after(&bare);
    let error = field
        .error(sensor)
        .map(|error| format!("! {}", error.brief));
    let second = match (&error, remark) {
        (Some(error), _) => Some((error.as_str(), Role::Error)),
        (None, remark) => remark.map(|remark| (remark, Role::Quiet)),
    };
    let under = write::right_of(write::row(row, 1), row.x.saturating_add(2));
    // Beside the descriptors, what is allowed has no room beside the field.
    let beside = match row.width {
        ..40 if under.height > 0 => under,
        _ => write::right_of(row, after),
    };
    match second {
        Some((text, role)) if under.height > 0 => {
            if beside != under {
                write::text(buffer, beside, theme, &range, Role::Quiet);
            }
            write::text(buffer, under, theme, text, role);
        }
        Some((error, Role::Error)) => {
            write::text(buffer, beside, theme, error, Role::Error);
        }
        // Without the unit, both have room on a screen of 80 columns.
        Some((remark, role)) => {
            write::text(buffer, beside, theme, &format!("{bare}; {remark}"), role);
        }
        None => {
            write::text(buffer, beside, theme, &range, Role::Quiet);
        }
    }
}
