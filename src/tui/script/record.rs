//! Records what a user does as a script that repeats it, so that a bug report becomes a test.
//!
//! Each key is written in notation; a press and a release at the same position become a click, a press with drags
//! becomes a drag. Frames of a recording that come in between are counted. A comment notes what a script cannot
//! repeat: frames of a stream, and inputs while work is under way.

use std::fmt::Write;

use crate::acquire::{FrameSource, SourceName};
use crate::formats::StoredShape;
use crate::formats::value::counted;
use crate::tui::app::message::{Mouse, MouseKind};
use crate::tui::script::setting::ScriptSetting;
use crate::tui::terminal::input::Input;
use crate::tui::terminal::{Outcome, SessionEvent};

/// The comment before an input that came while work was under way.
const AT_WORK: &str = "# work was under way; a script finishes it before this input\n";

/// Turns events of a session into lines of a script, one after another.
#[derive(Clone, Debug)]
pub struct Recorder {
    /// The settings to write before the first line; empty after they were written.
    head: String,
    /// Whether the first size has been written.
    sized: bool,
    /// The position where the button was pressed, and those to which it was dragged; empty while it is up.
    held: Vec<(u16, u16)>,
}

impl Recorder {
    /// Creates a recorder; its script begins with the settings with which the program was started.
    pub fn new(start: &[ScriptSetting]) -> Self {
        let lines = start.iter().map(|setting| format!("{setting}\n"));
        Self {
            head: lines.collect(),
            sized: false,
            held: Vec::new(),
        }
    }

    /// Returns the lines for an event; empty if a later event completes them.
    pub fn lines(&mut self, event: SessionEvent<'_>) -> String {
        let head = std::mem::take(&mut self.head);
        let lines = match event {
            SessionEvent::Frames { source, count } => frames(source, count),
            SessionEvent::Input { input, at_work } => {
                let lines = self.input(input);
                if at_work && !lines.is_empty() {
                    AT_WORK.to_owned() + &lines
                } else {
                    lines
                }
            }
        };
        head + &lines
    }

    /// Returns the lines for an input.
    fn input(&mut self, input: &Input) -> String {
        let mut lines = String::new();
        if !matches!(input, Input::Mouse(_)) {
            // Any other input between press and release ends a drag.
            lines += &self.let_go();
        }
        match input {
            Input::Size(columns, rows) if !self.sized => {
                self.sized = true;
                lines += &format!("{}\n", ScriptSetting::Size(*columns, *rows));
            }
            Input::Size(columns, rows) => lines += &format!("Resize {columns}x{rows}\n"),
            Input::Key(key) => lines += &format!("Keys {key}\n"),
            Input::Paste(text) => {
                lines += &format!("Paste {}\n", serde_json::Value::from(text.as_str()));
            }
            Input::Mouse(mouse) => lines += &self.mouse(*mouse),
        }
        lines
    }

    /// Returns the line for a stored shape that the last input has used. It may stand anywhere in a script.
    pub fn shape(&self, shape: StoredShape) -> String {
        format!("{}\n", ScriptSetting::Shape(Box::new(shape)))
    }

    /// Returns the last lines: an unfinished drag, and the signal that ended the program.
    pub fn end(&mut self, outcome: Outcome) -> String {
        let mut lines = self.let_go();
        if let Some(name) = outcome.signal_name() {
            // Writing to a string cannot fail.
            let _ = writeln!(lines, "Signal {name}");
        }
        lines
    }

    /// Returns the command for a mouse event. Presses and drags are held back until the button is released.
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

    /// Returns the command for the events held back.
    fn let_go(&mut self) -> String {
        let way = std::mem::take(&mut self.held);
        let positions: Vec<String> = way
            .iter()
            .map(|(column, row)| format!("{column},{row}"))
            .collect();
        match positions.len() {
            0 => String::new(),
            1 => format!("Click {}\n", positions[0]),
            _ => format!("Drag {}\n", positions.join(" ")),
        }
    }
}

/// Returns the line for frames that have come. Frames of a stream cannot be repeated.
fn frames(source: &SourceName, count: u64) -> String {
    match FrameSource::named(source.clone()) {
        FrameSource::File(_) => format!("Frames {count}\n"),
        stream => {
            let (frames, name) = (counted(count, "frame"), stream.name());
            let name = name.escape_debug();
            format!("# {frames} of {name}: a script reads frames only from files\n")
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
        let script: String = inputs
            .iter()
            .map(|input| {
                recorder.lines(SessionEvent::Input {
                    input,
                    at_work: false,
                })
            })
            .collect();
        let frames = |source: &str| {
            let (source, count) = (&SourceName::new(source), 3);
            Recorder::new(&[]).lines(SessionEvent::Frames { source, count })
        };
        let script = script + &frames("touch.csv") + &frames("tcp://robot:7000");
        let script = script + &recorder.end(Outcome::Signal(15));
        let expected = "Set ascii on\nSize 80x24\nKeys <Space>\nKeys <lt>\nKeys #\nKeys <U+3000>\nKeys <S-Left>\n\
                        Paste \"a \\\"b\\\"\\n\"\nClick 3,4\nDrag 3,4 9,9\nScroll 1,1 -1\nClick 5,5\nKeys <F1>\n\
                        Resize 60x20\nFrames 3\n\
                        # 3 frames of tcp://robot:7000: a script reads frames only from files\nSignal TERM\n";
        assert_eq!(script, expected);
        assert_eq!(read(&script).map(|commands| commands.len()), Ok(16));
    }

    #[test]
    fn an_input_during_work_is_marked() {
        let mut recorder = Recorder::new(&[]);
        let mouse = |kind| {
            let (column, row) = (3, 4);
            Input::Mouse(Mouse { kind, column, row })
        };
        let inputs = [
            Input::Key(Key::Esc),
            mouse(MouseKind::Press),
            mouse(MouseKind::Release),
        ];
        let script: String = inputs
            .iter()
            .map(|input| {
                recorder.lines(SessionEvent::Input {
                    input,
                    at_work: true,
                })
            })
            .collect();
        assert_eq!(script, format!("{AT_WORK}Keys <Esc>\n{AT_WORK}Click 3,4\n"));
        assert_eq!(read(&script).map(|commands| commands.len()), Ok(2));
    }
}
