//! A list of text fields for parameters, one of which may have the focus: the state of every form.
//!
//! A form has its own type of [`FormField`], which says what its text may be: a number, a range. Above or below the
//! fields there may be one more row that can have the focus, such as the kind of a figure; the form itself handles its
//! keys.

use crate::parameter::{Parameter, ParameterError};
use crate::sensor::Sensor;
use crate::tui::app::message::Message;
use crate::tui::keys::key::Arrow;
use crate::tui::widget::number::around;
use crate::tui::widget::text_field::TextField;

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
