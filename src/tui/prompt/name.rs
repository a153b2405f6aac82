//! The field for a name to store under, checked while typing.

use crate::formats::name::LONGEST;
use crate::formats::{Name, NameError};
use crate::tui::widget::text_field::TextField;

/// A few characters more than a name may have are taken, so that the message about it is seen.
const TYPED: usize = LONGEST + 8;

/// The field.
#[derive(Clone, Debug)]
pub struct NameDialog {
    /// What was typed.
    pub field: TextField,
}

impl NameDialog {
    /// A field that starts with a name.
    pub fn new(name: &str) -> Self {
        Self {
            field: TextField::new(name, TYPED),
        }
    }

    /// The name.
    ///
    /// # Errors
    /// The first rule for names that it breaks.
    pub fn name(&self) -> Result<Name, NameError> {
        Name::new(self.field.text())
    }
}
