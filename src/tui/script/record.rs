//! Writes what comes in as a script: a bug report becomes a test.

use crate::tui::message::{Mouse, MouseKind};
use crate::tui::terminal::input::Input;

/// Turns inputs into lines, one after another.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    /// Whether the first size is written already.
    sized: bool,
    /// Where the button went down, and where it was since.
    held: Vec<(u16, u16)>,
}

impl Recorder {
    /// The line of an input; empty where it is part of a line to come.
    pub fn line(&mut self, input: &Input) -> String {
        match input {
            Input::Size(columns, rows) => {
                let word = if std::mem::replace(&mut self.sized, true) {
                    "Resize"
                } else {
                    "Size"
                };
                format!("{word} {columns}x{rows}\n")
            }
            Input::Key(key) => format!("Keys {key}\n"),
            Input::Paste(text) => format!("Paste {}\n", serde_json::Value::from(text.as_str())),
            Input::Mouse(mouse) => self.mouse(*mouse),
        }
    }

    fn mouse(&mut self, Mouse { kind, column, row }: Mouse) -> String {
        let here = (column, row);
        match kind {
            MouseKind::Press => {
                self.held = vec![here];
                String::new()
            }
            MouseKind::Drag => {
                if !self.held.is_empty() {
                    self.held.push(here);
                }
                String::new()
            }
            MouseKind::Release => {
                let way = std::mem::take(&mut self.held);
                let places: Vec<String> = way
                    .iter()
                    .map(|(column, row)| format!("{column},{row}"))
                    .collect();
                match places.len() {
                    0 => String::new(),
                    1 => format!("Click {}\n", places[0]),
                    _ => format!("Drag {}\n", places.join(" ")),
                }
            }
            MouseKind::ScrollUp => format!("Scroll {column},{row} -1\n"),
            MouseKind::ScrollDown => format!("Scroll {column},{row} 1\n"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::key::{Arrow, Key};
    use crate::tui::script::command::read;

    #[test]
    fn what_is_recorded_is_a_script() {
        let mouse = |kind, column, row| Input::Mouse(Mouse { kind, column, row });
        let inputs = [
            Input::Size(80, 24),
            Input::Key(Key::Char(' ')),
            Input::Key(Key::Char('<')),
            Input::Key(Key::Char('#')),
            Input::Key(Key::ShiftArrow(Arrow::Left)),
            Input::Paste("a \"b\"\n".to_owned()),
            mouse(MouseKind::Press, 3, 4),
            mouse(MouseKind::Release, 3, 4),
            mouse(MouseKind::Press, 3, 4),
            mouse(MouseKind::Drag, 9, 9),
            mouse(MouseKind::Release, 9, 9),
            mouse(MouseKind::ScrollUp, 1, 1),
            Input::Size(60, 20),
        ];
        let mut recorder = Recorder::default();
        let script: String = inputs.iter().map(|input| recorder.line(input)).collect();
        let expected = "Size 80x24\nKeys <Space>\nKeys <lt>\nKeys #\nKeys <S-Left>\nPaste \"a \\\"b\\\"\\n\"\n\
                        Click 3,4\nDrag 3,4 9,9\nScroll 1,1 -1\nResize 60x20\n";
        assert_eq!(script, expected);
        assert_eq!(read(&script).map(|commands| commands.len()), Ok(10));
    }
}
