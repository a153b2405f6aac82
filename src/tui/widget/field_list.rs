//! A list of text fields for parameters, one of which may have the focus: what all forms share.
//!
//! A form says by its `check` what the text of a field may be: a number, a range. Above or below the fields there may be
//! a row of choices, such as the kind of a figure, that can have the focus, too; the form itself handles its keys.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::parameter::{Parameter, ParameterError};
use taxel_core::sensor::Sensor;

use crate::tui::app::Message;
use crate::tui::keys::Arrow;
use crate::tui::widget::write::{self, around, narrow};
use crate::tui::widget::{Role, TextField, Theme};

pub(crate) struct FormError {
    pub(crate) brief: String,
    pub(crate) full: String,
}

impl From<ParameterError> for FormError {
    fn from(error: ParameterError) -> Self {
        Self {
            brief: error.expected(),
            full: error.labelled(),
        }
    }
}

pub(crate) struct Field {
    pub(crate) parameter: Parameter,
    pub(crate) input: TextField,
    /// What the form wrote into it; None for a text of the user's own.
    pub(crate) proposed: Option<String>,
    /// The value of the proposed text, which may have fewer decimals: those of a shape that was moved or loaded.
    pub(crate) initial: Option<f64>,
}

impl Field {
    pub(crate) fn text(&self) -> &str {
        self.input.text()
    }

    pub(crate) fn is_proposed(&self) -> bool {
        self.proposed.as_deref() == Some(self.text())
    }
}

pub(crate) struct FieldList {
    pub(crate) fields: Vec<Field>,
    pub(crate) has_choice: bool,
    /// None if the row of choices has it.
    pub(crate) focus: Option<usize>,
    pub(crate) sensor: Sensor,
    pub(crate) check: fn(&Field, &Sensor) -> Result<(), FormError>,
}

impl FieldList {
    pub(crate) fn set_focus(&mut self, focus: Option<usize>) {
        self.focus = focus.map(|index| index.min(self.fields.len().saturating_sub(1)));
        if let Some(field) = self.focused() {
            field.input.enter();
        }
    }

    /// Moves the focus by `by` rows; the first row follows the last. The choices lie between these two.
    pub(crate) fn move_focus(&mut self, by: i8) {
        let other = usize::from(self.has_choice);
        let now = self.focus.map_or(0, |index| index + other);
        let next = around(now, by, self.fields.len() + other);
        self.set_focus(next.checked_sub(other));
    }

    pub(crate) fn focused(&mut self) -> Option<&mut Field> {
        self.fields.get_mut(self.focus?)
    }

    pub(crate) fn error(&self) -> Option<(usize, FormError)> {
        let mut fields = self.fields.iter().enumerate();
        fields.find_map(|(index, field)| Some((index, (self.check)(field, &self.sensor).err()?)))
    }

    pub(crate) fn take(&mut self, message: &Message) {
        match message {
            Message::Field(by) => self.move_focus(*by),
            Message::ToField(field) => self.set_focus(*field),
            Message::Choose(Arrow::Up) => self.move_focus(-1),
            Message::Choose(Arrow::Down) => self.move_focus(1),
            message => {
                if let Some(field) = self.focused() {
                    field.input.take(message);
                }
            }
        }
    }
}

/// Draws the row of choices: its label, the chosen one between arrows, and a remark.
pub(crate) fn draw_choice(
    theme: &Theme,
    (label, chosen): (&str, &str),
    focused: bool,
    remark: (&str, Role),
    buffer: &mut Buffer,
    row: Rect,
) {
    let role = if focused { Role::Focus } else { Role::Text };
    let pieces = [
        (label, Role::Text),
        ("< ", Role::Quiet),
        (chosen, role),
        (" > ", Role::Quiet),
        remark,
    ];
    write::line(buffer, row, theme, pieces);
}

/// The places of the rows of a form, of which those scroll that do not fit.
#[derive(Clone, Copy)]
pub(crate) struct FieldRows {
    area: Rect,
    /// The number of lines of a row: two if there is room, otherwise one.
    spacing: u16,
    first: usize,
    visible: usize,
}

impl FieldRows {
    /// Computes the places of rows in an area, so that the one with the focus is visible. Above them there is room for
    /// a number of `fixed` rows, which don't scroll; the focus is None if one of these has it.
    pub(crate) fn of(area: Rect, fixed: u16, rows: usize, focus: Option<usize>) -> Self {
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

    /// Draws the fields, with labels and inputs of these widths: what is allowed beside a field, and below it what is
    /// wrong with it or a remark; on a single line, the error or both. Returns the position of the cursor.
    pub(crate) fn draw(
        &self,
        theme: &Theme,
        list: &FieldList,
        widths: (usize, usize),
        remark: impl Fn(&Field) -> Option<&'static str>,
        buffer: &mut Buffer,
    ) -> Option<Position> {
        let mut cursor = None;
        for ((_, row), (index, field)) in self
            .visible()
            .zip(list.fields.iter().enumerate().skip(self.first))
        {
            let focused = list.focus == Some(index);
            let (at, after) = draw_field(theme, field, focused, widths, buffer, row);
            cursor = cursor.or(focused.then_some(at));
            let bare = list.sensor.range(field.parameter).to_string();
            let allowed = field.parameter.row().unit.after(&bare);
            let second = match (list.check)(field, &list.sensor) {
                Err(error) => Some((format!("! {}", error.brief), Role::Error)),
                Ok(()) => remark(field).map(|remark| (remark.to_owned(), Role::Quiet)),
            };
            let under = write::right_of(write::row(row, 1), row.x.saturating_add(2));
            // Beside the descriptors, what is allowed has no room beside the field.
            let beside = match row.width {
                ..40 if under.height > 0 => under,
                _ => write::right_of(row, after),
            };
            let (place, text, role) = match second {
                None => (beside, allowed, Role::Quiet),
                Some((text, role)) if under.height > 0 => {
                    if beside != under {
                        write::text(buffer, beside, theme, &allowed, Role::Quiet);
                    }
                    (under, text, role)
                }
                Some((error, Role::Error)) => (beside, error, Role::Error),
                // Without the unit, both have room on a screen of 80 columns.
                Some((remark, role)) => (beside, format!("{bare}; {remark}"), role),
            };
            write::text(buffer, place, theme, &text, role);
        }
        cursor
    }

    pub(crate) fn visible(&self) -> impl Iterator<Item = (usize, Rect)> + use<> {
        let rows = *self;
        (0..rows.visible).map(move |index| {
            let below = write::below(rows.area, narrow(index) * rows.spacing);
            let height = rows.spacing;
            (rows.first + index, Rect { height, ..below })
        })
    }

    pub(crate) fn at(&self, y: u16) -> Option<usize> {
        let mut rows = self.visible();
        let row = rows.find(|(_, lines)| (lines.top()..lines.bottom()).contains(&y));
        row.map(|(index, _)| index)
    }

    pub(crate) fn rest(&self, pane: Rect) -> Rect {
        let end = self.area.y + narrow(self.visible) * self.spacing;
        write::below(pane, end - pane.y)
    }
}

/// Draws label and text. A field with the focus is as wide as its text. Returns the position of the cursor, and the
/// column after the field.
fn draw_field(
    theme: &Theme,
    field: &Field,
    focused: bool,
    (label, least): (usize, usize),
    buffer: &mut Buffer,
    row: Rect,
) -> (Position, u16) {
    let most = usize::from(row.width).saturating_sub(label).max(least);
    let (role, at, width) = match (focused, write::width(field.text()) + 1) {
        (true, needed) => (Role::Focus, field.input.cursor(), needed.clamp(least, most)),
        // Without the focus it is shown from its start.
        (false, _) => (Role::Text, 0, least),
    };
    let (shown, cursor) = write::field_text(field.text(), at, width, theme);
    let shown = write::fitted(&shown, width, theme);
    let fill = " ".repeat(width - write::width(&shown));
    let name = format!("{:label$}", field.parameter.row().label);
    write::line(
        buffer,
        row,
        theme,
        [(&*name, Role::Text), (&*shown, role), (&*fill, role)],
    );
    let column = |after: usize| row.x.saturating_add(narrow(label + after));
    (Position::new(column(cursor), row.y), column(width + 1))
}
