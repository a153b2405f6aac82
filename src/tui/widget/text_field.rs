//! A line of text that is typed and edited, the same in forms, lists and prompts.
//!
//! In a field that was just entered, the next typed character replaces the text, as in most programs with forms;
//! moving the cursor first keeps the text.

use tui_input::{Input, InputRequest};

use crate::tui::app::{Endpoint, Erase, Message};
use crate::tui::keys::Arrow;

#[derive(Clone, Debug)]
pub struct TextField {
    input: Input,
    longest: usize,
    /// Whether the field was just entered, so that the next typed character replaces the text.
    pub(crate) fresh: bool,
}

impl TextField {
    /// At most `longest` characters can be typed.
    pub fn new(text: impl Into<String>, longest: usize) -> Self {
        Self {
            input: Input::new(text.into()),
            longest,
            fresh: false,
        }
    }

    pub fn enter(&mut self) {
        let _ = self.input.handle(InputRequest::GoToEnd);
        self.fresh = true;
    }

    pub fn text(&self) -> &str {
        self.input.value()
    }

    pub fn cursor(&self) -> usize {
        self.input.visual_cursor()
    }

    pub fn set(&mut self, text: impl Into<String>) {
        self.input = Input::new(text.into());
        self.fresh = false;
    }

    pub fn take(&mut self, message: &Message) -> bool {
        let replaces = matches!(
            message,
            Message::Type(_) | Message::Paste(_) | Message::Erase(_)
        );
        if self.fresh && replaces {
            self.set("");
        }
        let taken = self.does(message);
        self.fresh &= !taken;
        taken
    }

    /// Does what a message means, even if the field was just entered.
    fn does(&mut self, message: &Message) -> bool {
        let request = match message {
            Message::Type(character) => {
                self.insert(*character);
                return true;
            }
            Message::Paste(text) => {
                // A line break separates words, as does the tab between two cells of a spreadsheet; a line of text
                // has no other place for them.
                let words = text.split(['\r', '\n', '\t']).map(str::trim);
                let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
                for character in words.join(" ").chars() {
                    self.insert(character);
                }
                return true;
            }
            Message::Choose(Arrow::Left) => InputRequest::GoToPrevChar,
            Message::Choose(Arrow::Right) => InputRequest::GoToNextChar,
            Message::ToEdge(Endpoint::First) => InputRequest::GoToStart,
            Message::ToEdge(Endpoint::Last) => InputRequest::GoToEnd,
            Message::Erase(Erase::All) => InputRequest::DeleteLine,
            Message::Erase(Erase::Before) => InputRequest::DeletePrevChar,
            Message::Erase(Erase::Under) => InputRequest::DeleteNextChar,
            _ => return false,
        };
        let _ = self.input.handle(request);
        true
    }

    fn insert(&mut self, character: char) {
        if !character.is_control() && self.text().chars().count() < self.longest {
            let _ = self.input.handle(InputRequest::InsertChar(character));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(messages: &[Message]) -> (String, usize) {
        let mut field = TextField::new("abc", 6);
        for message in messages {
            assert!(field.take(message), "{message:?}");
        }
        (field.text().to_owned(), field.cursor())
    }

    #[test]
    fn a_field_limits_its_length_and_drops_control_characters() {
        let pasted = Message::Paste("  d\u{1b}\te f g\n".to_owned());
        assert_eq!(after(&[pasted]), ("abcd e".to_owned(), 6));
        let cells = Message::Paste("3.5\t7".to_owned());
        assert_eq!(after(&[Message::Erase(Erase::All), cells]).0, "3.5 7");
        let lines = Message::Paste("1\r\n\n2\r3".to_owned());
        assert_eq!(after(&[Message::Erase(Erase::All), lines]).0, "1 2 3");
        let mut field = TextField::new("abc", 6);
        assert!(!field.take(&Message::Accept));
        assert!(!field.take(&Message::Choose(Arrow::Up)));
    }
}
