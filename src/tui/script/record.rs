//! Writes what a user does as a script: each key in notation; a press and a release at the same position as a click, a
//! press with drags as a drag.

use crate::tui::app::message::{Mouse, MouseKind};
use crate::tui::script::command::ScriptSetting;
use crate::tui::terminal::input::Input;

#[derive(Clone, Debug)]
pub struct Recorder {
    /// The settings to write before the first line; empty after they were written.
    head: String,
    sized: bool,
    /// The position where the button was pressed, and those to which it was dragged; empty while it is up.
    held: Vec<(u16, u16)>,
}

impl Recorder {
    pub fn new(start: &[ScriptSetting]) -> Self {
        let lines = start.iter().map(|setting| format!("{setting}\n"));
        Self {
            head: lines.collect(),
            sized: false,
            held: Vec::new(),
        }
    }

    /// Returns the lines for an input; empty if a later one completes them.
    pub fn lines(&mut self, input: &Input) -> String {
        let mut lines = std::mem::take(&mut self.head);
        if !matches!(input, Input::Mouse(_)) {
            // Any other input between press and release ends a drag.
            lines += &self.let_go();
        }
        lines += &match input {
            Input::Size(columns, rows) if !self.sized => {
                self.sized = true;
                format!("{}\n", ScriptSetting::Size(*columns, *rows))
            }
            Input::Size(columns, rows) => format!("Resize {columns}x{rows}\n"),
            Input::Key(key) => format!("Keys {key}\n"),
            Input::Paste(text) => format!("Paste {}\n", serde_json::Value::from(text.as_str())),
            Input::Mouse(mouse) => self.mouse(*mouse),
        };
        lines
    }

    /// Returns the last line: an unfinished drag.
    pub fn end(&mut self) -> String {
        self.let_go()
    }

    fn mouse(&mut self, Mouse { kind, column, row }: Mouse) -> String {
        let here = (column, row);
        match kind {
            MouseKind::Press => {
                let before = self.let_go();
                self.held = vec![here];
                before
            }
            MouseKind::Drag => {
                if !self.held.is_empty() {
                    self.held.push(here);
                }
                String::new()
            }
            MouseKind::Release => self.let_go(),
            // Where the wheel does something, a drag does nothing, and the other way round.
            MouseKind::ScrollUp => format!("Scroll {column},{row} -1\n"),
            MouseKind::ScrollDown => format!("Scroll {column},{row} 1\n"),
        }
    }

    fn let_go(&mut self) -> String {
        let way = std::mem::take(&mut self.held);
        let positions: Vec<String> = (way.iter())
            .map(|(column, row)| format!("{column},{row}"))
            .collect();
        match positions.len() {
            0 => String::new(),
            1 => format!("Click {}\n", positions[0]),
            _ => format!("Drag {}\n", positions.join(" ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::keys::key::{Arrow, Key};
    use crate::tui::script::command::read;

    #[test]
    fn a_record_can_be_read_as_a_script() {
        let mouse = |kind, column, row| Input::Mouse(Mouse { kind, column, row });
        let inputs = [
            Input::Size(80, 24),
            Input::Key(Key::Char(' ')),
            Input::Key(Key::Char('<')),
            Input::Key(Key::Char('#')),
            Input::Key(Key::Char('\u{3000}')),
            Input::Key(Key::ShiftArrow(Arrow::Left)),
            Input::Paste("a \"b\"\n".to_owned()),
            mouse(MouseKind::Press, 3, 4),
            mouse(MouseKind::Release, 3, 4),
            mouse(MouseKind::Press, 3, 4),
            mouse(MouseKind::Drag, 9, 9),
            mouse(MouseKind::Release, 9, 9),
            mouse(MouseKind::ScrollUp, 1, 1),
            mouse(MouseKind::Press, 5, 5),
            Input::Key(Key::Function(1)),
            mouse(MouseKind::Drag, 6, 6),
            mouse(MouseKind::Release, 6, 6),
            Input::Size(60, 20),
        ];
        let mut recorder = Recorder::new(&[ScriptSetting::Ascii(true)]);
        let script: String = inputs.iter().map(|input| recorder.lines(input)).collect();
        let script = script + &recorder.end();
        let expected = "Set ascii on\nSize 80x24\nKeys <Space>\nKeys <lt>\nKeys #\nKeys <U+3000>\nKeys <S-Left>\n\
                        Paste \"a \\\"b\\\"\\n\"\nClick 3,4\nDrag 3,4 9,9\nScroll 1,1 -1\nClick 5,5\nKeys <F1>\n\
                        Resize 60x20\n";
        assert_eq!(script, expected);
        assert_eq!(read(&script).map(|commands| commands.len()), Ok(14));
    }
}
