//! The prompt for the letter of a mark: the next letter marks the selection, or goes to the mark of that letter.
//!
//! ```text
//! Mark imprint 12 by a letter:                  after m
//! Go to the mark: a imprint 12, b imprint 60    after ', with the existing marks
//! ```

use std::borrow::Cow;

use crate::tui::app::line_prompt::LinePrompt;
use crate::tui::keys::binding::Context;
use crate::tui::widget::text_field::TextField;

/// The purpose of the letter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkPurpose {
    /// Mark the selection.
    Set,
    /// Go to a mark.
    Jump,
}

/// The prompt for the letter of a mark.
#[derive(Clone, Debug)]
pub struct MarkDialog {
    /// The purpose of the letter.
    pub purpose: MarkPurpose,
    /// The text before the cursor.
    text: String,
    /// The field for the letter.
    field: TextField,
}

impl MarkDialog {
    /// Creates a prompt with a text that says what the letter does.
    pub fn new(purpose: MarkPurpose, text: String) -> Self {
        Self {
            purpose,
            text: text + " ",
            field: TextField::new("", 1),
        }
    }
}

impl LinePrompt for MarkDialog {
    const CONTEXT: Context = Context::Mark;

    fn label(&self) -> &str {
        &self.text
    }

    /// Always empty: the first letter is the answer.
    fn field(&self) -> &TextField {
        &self.field
    }

    fn behind(&self, _columns: u16) -> Cow<'_, str> {
        "".into()
    }
}
