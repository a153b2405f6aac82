//! Fields of parameters. They know the table of parameters but no shapes.
//!
//! A [`ParameterField`] is the text of one parameter; a [`ParameterForm`] is a list of them, one of which may have the
//! focus. A field converts its text when it is asked for its value, and never keeps a value beside the text, so what
//! one sees is what counts. The exception is the value that a field starts with, which stays exact as long as its text
//! is not changed. What a field allows is what files, flags and commands allow.

use crate::parameter::{Parameter, ParameterError};
use crate::sensor::Sensor;
use crate::tui::app::message::Message;
use crate::tui::widget::text_field::TextField;

/// No field takes more characters.
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
    /// What stood there at first, which is always taken: a shape that was moved or loaded may have more decimals
    /// than the form's own.
    initial: Option<f64>,
    /// That value as text.
    initial_text: String,
}

impl ParameterField {
    /// A field that shows a value; empty without one.
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

    /// Which parameter it sets.
    pub fn parameter(&self) -> Parameter {
        self.parameter
    }

    /// Whether it may be empty.
    pub fn optional(&self) -> bool {
        self.optional
    }

    /// Its text.
    pub fn text(&self) -> &str {
        self.input.text()
    }

    /// Whether it was changed since it was made.
    pub fn changed(&self) -> bool {
        self.text() != self.initial_text
    }

    /// Where its cursor stands, in columns.
    pub fn cursor(&self) -> usize {
        self.input.cursor()
    }

    /// Whether the next character replaces the text.
    pub fn fresh(&self) -> bool {
        self.input.fresh()
    }

    /// The value in the text; none of an empty field that may be empty.
    ///
    /// # Errors
    /// What is wrong with the text.
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

    /// Adds one unit of the last decimal, or subtracts it. An empty field starts with the default; a text that is no
    /// number stays.
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

/// Fields, one of which has the focus; or none, where something beside the form has it.
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
    /// A form for a sensor; no field has the focus.
    pub fn new(fields: Vec<ParameterField>, sensor: Sensor) -> Self {
        Self {
            fields,
            focus: None,
            sensor,
        }
    }

    /// Its fields, from the top.
    pub fn fields(&self) -> &[ParameterField] {
        &self.fields
    }

    /// Takes the fields out.
    pub fn into_fields(self) -> Vec<ParameterField> {
        self.fields
    }

    /// The sensor, which bounds the values.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// Which field has the focus.
    pub fn focus(&self) -> Option<usize> {
        self.focus
    }

    /// Gives a field the focus, or none.
    pub fn set_focus(&mut self, focus: Option<usize>) {
        self.focus = focus.map(|index| index.min(self.fields.len().saturating_sub(1)));
        if let Some(field) = self.focused() {
            field.input.enter();
        }
    }

    /// The value of a parameter; none where its field is empty, wrong or missing.
    pub fn value(&self, parameter: Parameter) -> Option<f64> {
        let field = self
            .fields
            .iter()
            .find(|field| field.parameter == parameter)?;
        field.value(&self.sensor).ok().flatten()
    }

    /// The first field that is wrong, and why.
    pub fn error(&self) -> Option<(usize, ParameterError)> {
        let mut fields = self.fields.iter().enumerate();
        fields.find_map(|(index, field)| Some((index, field.value(&self.sensor).err()?)))
    }

    /// The field that has the focus.
    fn focused(&mut self) -> Option<&mut ParameterField> {
        self.fields.get_mut(self.focus?)
    }

    /// Types, moves or deletes in the field that has the focus.
    pub fn take(&mut self, message: &Message) {
        if let Some(field) = self.focused() {
            field.input.take(message);
        }
    }

    /// Changes the number in the field by its last decimal.
    pub fn step(&mut self, direction: i8) {
        let sensor = self.sensor;
        if let Some(field) = self.focused() {
            field.step(direction, &sensor);
        }
    }
}
