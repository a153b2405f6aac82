//! The prompt for the letter of a mark: the next letter marks what is selected, or goes to what it marks.
//!
//! ```text
//! Mark imprint 12 by a letter:                  after m
//! Go to the mark: a imprint 12, b imprint 60    after ', with the marks that there are
//! ```

use std::borrow::Cow;

use crate::tui::app::line_prompt::LinePrompt;
use crate::tui::keys::binding::Context;
use crate::tui::widget::text_field::TextField;

/// What a letter is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkPurpose {
    /// To mark what is selected.
    Set,
    /// To go to what is marked.
    Jump,
}

/// The prompt.
#[derive(Clone, Debug)]
pub struct MarkDialog {
    /// What the letter is for.
    pub purpose: MarkPurpose,
    /// What stands before the cursor.
    text: String,
    /// The place of the letter.
    field: TextField,
}

impl MarkDialog {
    /// A prompt with a text of what the letter does.
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
