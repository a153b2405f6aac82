//! A form: a text field a parameter. It knows the table of parameters and no shapes.

use tui_input::{Input, InputRequest};

use super::key::Arrow;
use super::message::{End, Erase};
use crate::parameter::{Parameter, ParameterError};

/// No field takes more characters.
const LONGEST: usize = 24;

/// A text field of one parameter.
#[derive(Clone, Debug)]
pub struct Field {
    parameter: Parameter,
    optional: bool,
    input: Input,
    /// What stood there at first, which is always taken: a shape that was moved or loaded may have more decimals
    /// than the form's own.
    initial: Option<f64>,
    initial_text: String,
    /// The field was just entered: the first character replaces everything.
    fresh: bool,
}

impl Field {
    /// A field that shows a value; empty without one.
    pub fn new(parameter: Parameter, value: Option<f64>, optional: bool) -> Self {
        let text = value
            .map(|value| parameter.format(value))
            .unwrap_or_default();
        Self {
            parameter,
            optional,
            input: Input::new(text.clone()),
            initial: value,
            initial_text: text,
            fresh: true,
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
        self.input.value()
    }

    /// Where its cursor stands, in columns.
    pub fn cursor(&self) -> usize {
        self.input.visual_cursor()
    }

    /// Whether the next character replaces the text.
    pub fn fresh(&self) -> bool {
        self.fresh
    }

    /// The value in the text; none of an empty field that may be empty.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn value(&self, side: u8) -> Result<Option<f64>, ParameterError> {
        if self.text() == self.initial_text && (self.initial.is_some() || self.optional) {
            return Ok(self.initial);
        }
        match (self.text().trim(), self.optional) {
            ("", true) => Ok(None),
            ("", false) => {
                let range = self.parameter.form_range(side);
                Err(ParameterError::Missing {
                    parameter: self.parameter,
                    range,
                })
            }
            (text, _) => self.parameter.read_form(text, side).map(Some),
        }
    }

    fn request(&mut self, request: InputRequest) {
        self.fresh = false;
        // What the library answers is only whether anything changed, which the view sees by itself.
        let _ = self.input.handle(request);
    }

    fn insert(&mut self, character: char) {
        if std::mem::take(&mut self.fresh) {
            self.input.reset();
        }
        if !character.is_control() && self.text().chars().count() < LONGEST {
            self.request(InputRequest::InsertChar(character));
        }
    }

    fn step(&mut self, direction: i8, side: u8) {
        let value = match self.value(side) {
            Ok(Some(value)) => self.parameter.step(value, i32::from(direction), side),
            Ok(None) => self.parameter.default(side),
            Err(ParameterError::Range { value, .. } | ParameterError::Decimals { value, .. }) => {
                self.parameter.step(value, i32::from(direction), side)
            }
            Err(_) => return,
        };
        self.input = Input::new(self.parameter.format(value));
        self.fresh = true;
    }
}

/// Fields, one of which has the focus; or none, where something beside the form has it.
#[derive(Clone, Debug)]
pub struct Form {
    fields: Vec<Field>,
    focus: Option<usize>,
    side: u8,
}

impl Form {
    /// A form for a sensor whose larger side is `side`; no field has the focus.
    pub fn new(fields: Vec<Field>, side: u8) -> Self {
        Self {
            fields,
            focus: None,
            side,
        }
    }

    /// Its fields, from the top.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// Takes the fields out.
    pub fn into_fields(self) -> Vec<Field> {
        self.fields
    }

    /// The larger side of the sensor, which bounds the values.
    pub fn side(&self) -> u8 {
        self.side
    }

    /// Which field has the focus.
    pub fn focus(&self) -> Option<usize> {
        self.focus
    }

    /// Gives a field the focus, or none.
    pub fn set_focus(&mut self, focus: Option<usize>) {
        self.focus = focus.map(|index| index.min(self.fields.len().saturating_sub(1)));
        if let Some(field) = self.focused() {
            field.fresh = true;
            let _ = field.input.handle(InputRequest::GoToEnd);
        }
    }

    /// The value of a parameter; none where its field is empty, wrong or missing.
    pub fn value(&self, parameter: Parameter) -> Option<f64> {
        let field = self
            .fields
            .iter()
            .find(|field| field.parameter == parameter)?;
        field.value(self.side).ok().flatten()
    }

    /// The first field that is wrong, and why.
    pub fn error(&self) -> Option<(usize, ParameterError)> {
        let mut fields = self.fields.iter().enumerate();
        fields.find_map(|(index, field)| Some((index, field.value(self.side).err()?)))
    }

    fn focused(&mut self) -> Option<&mut Field> {
        self.fields.get_mut(self.focus?)
    }

    /// Types a character.
    pub fn insert(&mut self, character: char) {
        if let Some(field) = self.focused() {
            field.insert(character);
        }
    }

    /// Deletes in the field.
    pub fn erase(&mut self, erase: Erase) {
        let Some(field) = self.focused() else { return };
        let everything = field.fresh;
        match erase {
            Erase::Before if !everything => field.request(InputRequest::DeletePrevChar),
            Erase::Under if !everything => field.request(InputRequest::DeleteNextChar),
            _ => field.request(InputRequest::DeleteLine),
        }
    }

    /// Moves in the field by a character.
    pub fn move_cursor(&mut self, arrow: Arrow) {
        if let Some(field) = self.focused() {
            match arrow {
                Arrow::Left => field.request(InputRequest::GoToPrevChar),
                _ => field.request(InputRequest::GoToNextChar),
            }
        }
    }

    /// Moves to an end of the field.
    pub fn to_edge(&mut self, end: End) {
        if let Some(field) = self.focused() {
            match end {
                End::First => field.request(InputRequest::GoToStart),
                End::Last => field.request(InputRequest::GoToEnd),
            }
        }
    }

    /// Changes the number in the field by its last decimal.
    pub fn step(&mut self, direction: i8) {
        let side = self.side;
        if let Some(field) = self.focused() {
            field.step(direction, side);
        }
    }
}
