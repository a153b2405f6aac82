//! Fields of parameters. They know the table of parameters but no shapes.
//!
//! A [`ParameterField`] is the text of one parameter. It converts its text when it is asked for its value, and never
//! keeps a value beside the text, so the visible text is what counts. The exception is its initial value, which stays
//! exact as long as the text is not changed. A field allows the same values as files, flags and commands.

use crate::parameter::{Parameter, ParameterError};
use crate::sensor::Sensor;
use crate::tui::widget::field_list::{FieldList, FormError, FormField};
use crate::tui::widget::text_field::TextField;

const LONGEST: usize = 24;

#[derive(Clone, Debug)]
pub struct ParameterField {
    parameter: Parameter,
    optional: bool,
    input: TextField,
    /// The initial value, which is always accepted: a shape that was moved or loaded may have more decimals than the
    /// form shows.
    initial: Option<f64>,
    initial_text: String,
}

impl ParameterField {
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

    pub fn optional(&self) -> bool {
        self.optional
    }

    pub fn changed(&self) -> bool {
        self.text() != self.initial_text
    }

    pub fn fresh(&self) -> bool {
        self.input.fresh()
    }

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

    /// An empty field gets the default; a text that is not a number is kept.
    fn step(&mut self, direction: i8, sensor: &Sensor) {
        let value = match self.value(sensor) {
            Ok(Some(value)) => sensor.step(self.parameter, value, i32::from(direction)),
            Ok(None) => sensor.default_value(self.parameter),
            Err(ParameterError::Range { value, .. } | ParameterError::Fraction { value, .. }) => {
                sensor.step(self.parameter, value, i32::from(direction))
            }
            Err(_) => return,
        };
        self.input.set(self.parameter.format(value));
        self.input.enter();
    }
}

impl FormField for ParameterField {
    fn parameter(&self) -> Parameter {
        self.parameter
    }

    fn input(&self) -> &TextField {
        &self.input
    }

    fn input_mut(&mut self) -> &mut TextField {
        &mut self.input
    }

    fn error(&self, sensor: &Sensor) -> Option<FormError> {
        self.value(sensor).err().map(FormError::from)
    }
}

pub type ParameterFields = FieldList<ParameterField>;

impl ParameterFields {
    pub fn value(&self, parameter: Parameter) -> Option<f64> {
        let mut fields = self.fields().iter();
        let field = fields.find(|field| field.parameter == parameter)?;
        field.value(self.sensor()).ok().flatten()
    }

    pub fn step(&mut self, direction: i8) {
        let sensor = *self.sensor();
        if let Some(field) = self.focused() {
            field.step(direction, &sensor);
        }
    }
}
