//! The field for a name to store under, checked while typing.

use tui_input::{Input, InputRequest};

use crate::formats::name::{LONGEST, Name, NameError};

/// The field.
#[derive(Clone, Debug)]
pub struct NameDialog {
    input: Input,
}

impl NameDialog {
    /// A field that starts with a name.
    pub fn new(name: &str) -> Self {
        Self {
            input: Input::new(name.to_owned()),
        }
    }

    /// What was typed.
    pub fn text(&self) -> &str {
        self.input.value()
    }

    /// Where the cursor stands, in columns.
    pub fn cursor(&self) -> usize {
        self.input.visual_cursor()
    }

    /// The name.
    ///
    /// # Errors
    /// The first rule for names that it breaks.
    pub fn name(&self) -> Result<Name, NameError> {
        Name::new(self.text())
    }

    /// Types a character. A few more than a name may have are taken, so that the message about it is seen.
    pub fn insert(&mut self, character: char) {
        if !character.is_control() && self.text().chars().count() < LONGEST + 8 {
            self.edit(InputRequest::InsertChar(character));
        }
    }

    /// Moves or deletes.
    pub fn edit(&mut self, request: InputRequest) {
        let _ = self.input.handle(request);
    }
}
