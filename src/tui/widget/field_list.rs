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

/// An error in a field, or in all fields of a form together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormError {
    /// The message beside the field; it may have several lines if it is about all fields.
    pub brief: String,
    /// The message with the field's name.
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

/// A text field for a parameter.
pub trait FormField {
    /// Returns the parameter that the field is about.
    fn parameter(&self) -> Parameter;

    /// Returns the text with its cursor.
    fn input(&self) -> &TextField;

    /// Returns the text with its cursor, to be edited.
    fn input_mut(&mut self) -> &mut TextField;

    /// Returns the error in the text; None if it is valid for this sensor.
    fn error(&self, sensor: &Sensor) -> Option<FormError>;

    /// Returns the text of the field.
    fn text(&self) -> &str {
        self.input().text()
    }
}

/// A list of fields. One of them has the focus, or none if another row of the form has it.
#[derive(Clone, Debug)]
pub struct FieldList<F> {
    /// The fields, from the top.
    fields: Vec<F>,
    /// Whether the form has another row that can have the focus.
    other_row: bool,
    /// The index of the field that has the focus.
    focus: Option<usize>,
    /// The sensor, which bounds the values.
    sensor: Sensor,
}

impl<F: FormField> FieldList<F> {
    /// Creates a list for a sensor, in a form that may have another row; no field has the focus.
    pub fn new(fields: Vec<F>, other_row: bool, sensor: Sensor) -> Self {
        Self {
            fields,
            other_row,
            focus: None,
            sensor,
        }
    }

    /// Returns the fields, from the top.
    pub fn fields(&self) -> &[F] {
        &self.fields
    }

    /// Returns the fields, to be changed.
    pub fn fields_mut(&mut self) -> &mut [F] {
        &mut self.fields
    }

    /// Removes all fields and returns them.
    pub fn take_fields(&mut self) -> Vec<F> {
        std::mem::take(&mut self.fields)
    }

    /// Returns the sensor, which bounds the values.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// Returns the index of the field with the focus; None if another row has it.
    pub fn focus(&self) -> Option<usize> {
        self.focus
    }

    /// Gives the focus to a field, or to none.
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

    /// Returns the field with the focus.
    pub fn focused(&mut self) -> Option<&mut F> {
        self.fields.get_mut(self.focus?)
    }

    /// Returns the index of the first invalid field, and its error.
    pub fn error(&self) -> Option<(usize, FormError)> {
        let mut fields = self.fields.iter().enumerate();
        fields.find_map(|(index, field)| Some((index, field.error(&self.sensor)?)))
    }

    /// Handles a message: moves the focus; or types, moves or deletes in the field with the focus.
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
