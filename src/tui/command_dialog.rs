//! The field of the command line at the foot of the screen, with the lines that were given before.

use tui_input::{Input, InputRequest};

use super::commands::complete;

/// No command is longer.
const LONGEST: usize = 200;

/// The field.
#[derive(Clone, Debug, Default)]
pub struct CommandDialog {
    input: Input,
    /// What the last word could become, after Tab.
    pub candidates: Vec<&'static str>,
}

impl CommandDialog {
    /// What was typed.
    pub fn text(&self) -> &str {
        self.input.value()
    }

    /// Where the cursor stands, in columns.
    pub fn cursor(&self) -> usize {
        self.input.visual_cursor()
    }

    /// Types a character.
    pub fn insert(&mut self, character: char) {
        if !character.is_control() && self.text().chars().count() < LONGEST {
            self.edit(InputRequest::InsertChar(character));
        }
    }

    /// Moves or deletes.
    pub fn edit(&mut self, request: InputRequest) {
        self.candidates.clear();
        let _ = self.input.handle(request);
    }

    /// Completes the last word.
    pub fn complete(&mut self) {
        let (line, candidates) = complete(self.text());
        self.input = Input::new(line);
        self.candidates = if candidates.len() > 1 {
            candidates
        } else {
            Vec::new()
        };
    }

    /// Shows an earlier line.
    pub fn recall(&mut self, line: &str) {
        self.candidates.clear();
        self.input = Input::new(line.to_owned());
    }
}
