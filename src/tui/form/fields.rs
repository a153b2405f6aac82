//! Fields of parameters. They know the table of parameters but no shapes.
//!
//! A [`ParameterField`] is the text of one parameter; a [`ParameterForm`] is a list of them, one of which may have
//! the focus. A field converts its text when it is asked for its value, and never keeps a value beside the text, so
//! the visible text is what counts. The exception is the initial value of a field, which stays exact as long as its
//! text is not changed. A field allows the same values as files, flags and commands.

use crate::parameter::{Parameter, ParameterError};
use crate::sensor::Sensor;
use crate::tui::app::message::Message;
use crate::tui::widget::text_field::TextField;

/// The greatest number of characters in a field.
const LONGEST: usize = 24;

/// A text field of one parameter.
#[derive(Clone, Debug)]
pub struct ParameterField {
    /// The parameter that it sets.
    parameter: Parameter,
    /// Whether it may be empty.
    optional: bool,
    /// The text.
    input: TextField,
    /// The initial value, which is always accepted: a shape that was moved or loaded may have more decimals than the
    /// form shows.
    initial: Option<f64>,
    /// The initial value as text.
    initial_text: String,
}

impl ParameterField {
    /// Creates a field that shows a value; it is empty if there is none.
    pub fn new(parameter: Parameter, value: Option<f64>, optional: bool) -> Self {
        let text = value.map_or(String::new(), |value| parameter.format(value));
        let mut input = TextField::new(text.clone(), LONGEST);
        input.enter();
        Self {
            parameter,
            optional,
            input,
            initial: value,
            initial_text: text,
        }
    }

    /// Returns the parameter that the field sets.
    pub fn parameter(&self) -> Parameter {
        self.parameter
    }

    /// Whether it may be empty.
    pub fn optional(&self) -> bool {
        self.optional
    }

    /// Returns the text of the field.
    pub fn text(&self) -> &str {
        self.input.text()
    }

    /// Returns true if the text differs from the initial one.
    pub fn changed(&self) -> bool {
        self.text() != self.initial_text
    }

    /// Returns the text with its cursor.
    pub fn input(&self) -> &TextField {
        &self.input
    }

    /// Whether the next character replaces the text.
    pub fn fresh(&self) -> bool {
        self.input.fresh()
    }

    /// Returns the value of the text; None if the field is optional and empty.
    ///
    /// # Errors
    /// Returns an error that says what is wrong with the text.
    pub fn value(&self, sensor: &Sensor) -> Result<Option<f64>, ParameterError> {
        if self.text() == self.initial_text && (self.initial.is_some() || self.optional) {
            return Ok(self.initial);
        }
        match (self.text().trim(), self.optional) {
            ("", true) => Ok(None),
            ("", false) => {
                let range = sensor.range(self.parameter);
                Err(ParameterError::Missing {
                    parameter: self.parameter,
                    range,
                })
            }
            (text, _) => sensor.read(self.parameter, text).map(Some),
        }
    }

    /// Adds or subtracts one unit of the last decimal. An empty field gets the default; a text that is not a number
    /// is kept.
    fn step(&mut self, direction: i8, sensor: &Sensor) {
        let value = match self.value(sensor) {
            Ok(Some(value)) => sensor.step(self.parameter, value, i32::from(direction)),
            Ok(None) => sensor.default_value(self.parameter),
            Err(ParameterError::Range { value, .. }) => {
                sensor.step(self.parameter, value, i32::from(direction))
            }
            Err(_) => return,
        };
        self.input.set(self.parameter.format(value));
        self.input.enter();
    }
}

/// A list of fields. One of them has the focus, or none if something beside the form has it.
#[derive(Clone, Debug)]
pub struct ParameterForm {
    /// The fields, from the top.
    fields: Vec<ParameterField>,
    /// The index of the field that has the focus.
    focus: Option<usize>,
    /// The sensor, which bounds the values.
    sensor: Sensor,
}

impl ParameterForm {
    /// Creates a form for a sensor; no field has the focus.
    pub fn new(fields: Vec<ParameterField>, sensor: Sensor) -> Self {
        Self {
            fields,
            focus: None,
            sensor,
        }
    }

    /// Returns the fields, from the top.
    pub fn fields(&self) -> &[ParameterField] {
        &self.fields
    }

    /// Returns the fields and drops the form.
    pub fn into_fields(self) -> Vec<ParameterField> {
        self.fields
    }

    /// Returns the sensor, which bounds the values.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// Returns the index of the field with the focus.
    pub fn focus(&self) -> Option<usize> {
        self.focus
    }

    /// Gives the focus to a field, or to none.
    pub fn set_focus(&mut self, focus: Option<usize>) {
        self.focus = focus.map(|index| index.min(self.fields.len().saturating_sub(1)));
        if let Some(field) = self.focused() {
            field.input.enter();
        }
    }

    /// Returns the value of a parameter; None if its field is empty, invalid or missing.
    pub fn value(&self, parameter: Parameter) -> Option<f64> {
        let field = self
            .fields
            .iter()
            .find(|field| field.parameter == parameter)?;
        field.value(&self.sensor).ok().flatten()
    }

    /// Returns the index of the first invalid field, and its error.
    pub fn error(&self) -> Option<(usize, ParameterError)> {
        let mut fields = self.fields.iter().enumerate();
        fields.find_map(|(index, field)| Some((index, field.value(&self.sensor).err()?)))
    }

    /// Returns the field with the focus.
    fn focused(&mut self) -> Option<&mut ParameterField> {
        self.fields.get_mut(self.focus?)
    }

    /// Passes a message to the field with the focus: it types, moves the cursor or deletes.
    pub fn take(&mut self, message: &Message) {
        if let Some(field) = self.focused() {
            field.input.take(message);
        }
    }

    /// Changes the number in the field with the focus by one unit of its last decimal.
    pub fn step(&mut self, direction: i8) {
        let sensor = self.sensor;
        if let Some(field) = self.focused() {
            field.step(direction, &sensor);
        }
    }
}
