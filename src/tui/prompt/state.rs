//! The field of the command line at the foot of the screen, with the lines that were given before.

use crate::tui::app::message::Message;
use crate::tui::prompt::commands::complete;
use crate::tui::widget::text_field::TextField;

/// No command is longer.
const LONGEST: usize = 200;

/// The field.
#[derive(Clone, Debug)]
pub struct CommandDialog {
    /// What was typed.
    pub field: TextField,
    /// What the last word could become, after Tab.
    pub candidates: Vec<String>,
    /// Which of the earlier lines it shows, counted from the last one on; none: what is being typed.
    recalled: Option<usize>,
    /// What was typed before an earlier line was asked for.
    draft: String,
}

impl Default for CommandDialog {
    fn default() -> Self {
        Self {
            field: TextField::new("", LONGEST),
            candidates: Vec::new(),
            recalled: None,
            draft: String::new(),
        }
    }
}

impl CommandDialog {
    /// Types, moves or deletes.
    pub fn edit(&mut self, message: &Message) {
        self.candidates.clear();
        if self.field.take(message) {
            self.recalled = None;
        }
    }

    /// Completes the last word, or the name of a shape, of which `names` are all that there are.
    pub fn complete(&mut self, names: &[String]) {
        let (line, candidates) = complete(self.field.text(), names);
        self.field.set(line);
        self.candidates = candidates;
        if self.candidates.len() == 1 {
            self.candidates.clear();
        }
    }

    /// Shows the line before the one that is shown, of those that were given; the first one has none before it.
    pub fn earlier(&mut self, lines: &[String]) {
        let next = self.recalled.map_or(0, |recalled| recalled + 1);
        if next < lines.len() {
            if self.recalled.is_none() {
                self.field.text().clone_into(&mut self.draft);
            }
            self.show(Some(next), lines);
        }
    }

    /// Shows the line after the one that is shown; after the last one, what was being typed.
    pub fn later(&mut self, lines: &[String]) {
        if let Some(recalled) = self.recalled {
            self.show(recalled.checked_sub(1), lines);
        }
    }

    fn show(&mut self, recalled: Option<usize>, lines: &[String]) {
        self.recalled = recalled;
        self.candidates.clear();
        let line = recalled.and_then(|recalled| lines.iter().rev().nth(recalled));
        self.field.set(line.unwrap_or(&self.draft).clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn earlier_lines_are_gone_through_one_by_one() {
        let lines = ["new", "grab", "new"].map(str::to_owned);
        let mut dialog = CommandDialog::default();
        dialog.edit(&Message::Type('z'));
        let mut shown = Vec::new();
        for earlier in [true, true, true, true, false, false, false, false] {
            if earlier {
                dialog.earlier(&lines);
            } else {
                dialog.later(&lines);
            }
            shown.push(dialog.field.text().to_owned());
        }
        assert_eq!(
            shown,
            ["new", "grab", "new", "new", "grab", "new", "z", "z"]
        );
    }
}
