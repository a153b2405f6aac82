//! Bytes from the terminal become keys, pasted text and mouse events.
//!
//! ```text
//! a  é  字                           characters, in UTF-8
//! CR  TAB  DEL or Ctrl-H            Enter, Tab, Backspace
//! 1 to 26                           Ctrl with a letter
//! ESC [ A   ESC O A                 arrows, Home, End, F1 to F4; ESC [ 1 ; 2 A with Shift, ESC [ a in rxvt
//! ESC [ 3 ~                         Delete, Page Up, Page Down, Home, End, F1 to F12 by number
//! ESC [ Z                           Shift-Tab
//! ESC [ 27 u                        Esc, Enter, Tab and Backspace by their code
//! ESC [ [ A                         F1 to F5 on the Linux console
//! ESC O M                           Enter of the number pad
//! ESC [ < 0 ; x ; y M               mouse, as it is asked for; m at the end when the button is released
//! ESC [ M button x y                mouse in the old form, which some terminals send all the same
//! ESC [ 200 ~ … ESC [ 201 ~         pasted text
//! ESC [ 0 n                         the status of the terminal, which was asked for
//! ESC ] … BEL   ESC P … ESC \       an answer of the terminal, skipped
//! ```
//! Sequences may arrive in pieces, over a slow line in single bytes. Only a few things have a time limit: an ESC by
//! itself, which may be a key or the beginning of a sequence; an answer of the terminal to an earlier program, whose
//! rest would otherwise be read as keys; and the rest of a pasted text. Unknown sequences are skipped as a whole.
//!
//! ESC before a character is the key Esc, then the character: nothing here is bound to Alt, and a quick Esc over a
//! slow line arrives together with the next key. ESC ESC is Alt-Esc, which is one Esc. While an answer about the
//! terminal's status is pending, an ESC by itself is a key only if the next byte shows it: it may be the first byte
//! of the answer, cut off by the line.
//!
//! The sequences are those of xterm's ctlseqs and of ECMA-48.

use std::time::Duration;

use crate::tui::app::message::{Mouse, MouseKind};
use crate::tui::keys::key::{Arrow, Key};

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Input {
    Key(Key),
    Paste(String),
    Mouse(Mouse),
    /// The size of the screen, in columns and rows; it does not come from the keyboard.
    Size(u16, u16),
}

const MOMENT: Duration = Duration::from_millis(50);
/// How long the reader waits for the rest of a pasted text; some terminals never send its end.
const PASTE_MOMENT: Duration = Duration::from_secs(1);

/// The greatest number of bytes kept of a sequence; no terminal sends a longer one.
const LONGEST: usize = 64;
/// The length at which pasted text is cut off, in bytes; the rest is dropped.
const LONGEST_PASTE: usize = 1 << 20;

const ESC: u8 = 0x1b;
const BEL: u8 = 0x07;
const PASTE_END: &[u8] = b"\x1b[201~";

/// The state of the reader: its place in a sequence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum InputState {
    #[default]
    Ground,
    Escape,
    LateEscape,
    Single,
    Sequence,
    /// In a function key of the Linux console: ESC [ [, then one more byte.
    Function,
    /// In a mouse report of the old form: three bytes follow ESC [ M.
    OldMouse,
    /// In an answer: ESC ] or ESC P up to BEL or ESC \.
    Answer,
    Paste,
    /// In a character of several bytes, with the number of bytes still to come.
    Character(u8),
}

/// Reads keys, pastes and mouse events from bytes, as they arrive.
#[derive(Debug, Default)]
pub struct InputReader {
    state: InputState,
    /// The bytes of the sequence so far.
    held: Vec<u8>,
    doubled: bool,
    found: Vec<Input>,
    has_status: bool,
}

impl InputReader {
    /// Reads bytes and returns the events that they complete.
    pub fn read(&mut self, bytes: &[u8]) -> Vec<Input> {
        for &byte in bytes {
            self.step(byte);
        }
        std::mem::take(&mut self.found)
    }

    /// Returns true if the terminal has reported its status since the last call.
    pub fn take_status(&mut self) -> bool {
        std::mem::take(&mut self.has_status)
    }

    /// Returns how long to wait for more bytes before a call of [`InputReader::on_timeout`]; None means for ever.
    /// `is_asked`: whether an answer about the status is pending.
    pub fn patience(&self, is_asked: bool) -> Option<Duration> {
        match self.state {
            InputState::LateEscape if is_asked => None,
            InputState::Escape | InputState::LateEscape | InputState::Answer => Some(MOMENT),
            InputState::Paste => Some(PASTE_MOMENT),
            _ => None,
        }
    }

    /// Ends an incomplete sequence because no more bytes came in time, and returns the events that this yields.
    pub fn on_timeout(&mut self, is_asked: bool) -> Vec<Input> {
        match self.state {
            InputState::Escape if is_asked => {
                self.state = InputState::LateEscape;
                return Vec::new();
            }
            InputState::Escape | InputState::LateEscape => self.key(Key::Esc),
            InputState::Paste => self.paste(self.held.len()),
            _ => {}
        }
        self.ground();
        std::mem::take(&mut self.found)
    }

    fn key(&mut self, key: Key) {
        self.found.push(Input::Key(key));
    }

    /// Drops the sequence so far.
    fn ground(&mut self) {
        self.state = InputState::Ground;
        self.held.clear();
    }

    fn step(&mut self, byte: u8) {
        match self.state {
            InputState::Ground => self.plain(byte),
            InputState::Escape => self.after_escape(byte),
            InputState::LateEscape if byte == b'[' => self.state = InputState::Sequence,
            InputState::LateEscape => {
                self.ground();
                self.key(Key::Esc);
                self.plain(byte);
            }
            InputState::Paste => self.in_paste(byte),
            InputState::Answer => self.in_answer(byte),
            InputState::OldMouse => self.in_old_mouse(byte),
            InputState::Character(left) => self.in_character(byte, left),
            // A control character breaks a sequence off.
            _ if byte < 0x20 => {
                self.ground();
                self.plain(byte);
            }
            InputState::Function => {
                self.ground();
                if let b'A'..=b'E' = byte {
                    self.key(Key::Function(byte - b'A' + 1));
                }
            }
            InputState::Single => {
                self.ground();
                match byte {
                    b'M' => self.key(Key::Enter),
                    // With numbers before it, this is the place of the cursor, which an earlier program asked for.
                    b'R' => self.key(Key::Function(3)),
                    _ => self.letter(byte, false),
                }
            }
            InputState::Sequence => self.in_sequence(byte),
        }
    }

    fn in_answer(&mut self, byte: u8) {
        match (byte, self.held.pop()) {
            (BEL, _) | (b'\\', Some(ESC)) => self.ground(),
            (ESC, _) => self.held.push(ESC),
            (_, Some(ESC)) => {
                self.doubled = false;
                self.after_escape(byte);
            }
            (..0x20, _) => {
                self.ground();
                self.plain(byte);
            }
            _ => {}
        }
    }

    /// Reads a mouse report in the old form: `ESC [ M button x y`, each byte 32 more than its value.
    fn in_old_mouse(&mut self, byte: u8) {
        self.held.push(byte);
        if let [button, x, y] = self.held[..] {
            let value = |byte: u8| u16::from(byte.saturating_sub(32));
            self.mouse(value(button), value(x), value(y), button & 3 == 3);
            self.ground();
        }
    }

    /// Reads a character of several bytes, of which `left` are still to come.
    fn in_character(&mut self, byte: u8, left: u8) {
        if byte & 0xc0 != 0x80 {
            // The character is incomplete, and this byte begins something new.
            self.ground();
            return self.plain(byte);
        }
        self.held.push(byte);
        self.state = InputState::Character(left - 1);
        if left == 1 {
            let text = std::str::from_utf8(&self.held).ok();
            let character = text.and_then(|text| text.chars().next());
            // U+0080 to U+009F are control characters of one byte elsewhere.
            if let Some(character) = character.filter(|character| !character.is_control()) {
                self.key(Key::Char(character));
            }
            self.ground();
        }
    }

    fn in_sequence(&mut self, byte: u8) {
        match byte {
            b'[' if self.held.is_empty() => self.state = InputState::Function,
            // Shift-arrows of rxvt.
            b'a'..=b'd' if self.held.is_empty() => {
                self.ground();
                self.letter(byte.to_ascii_uppercase(), true);
            }
            b'M' if self.held.is_empty() => self.state = InputState::OldMouse,
            0x40..=0x7e => {
                let held = std::mem::take(&mut self.held);
                self.ground();
                self.sequence(&held, byte);
            }
            _ if self.held.len() < LONGEST => self.held.push(byte),
            _ => {}
        }
    }

    fn plain(&mut self, byte: u8) {
        match byte {
            ESC => {
                self.state = InputState::Escape;
                self.doubled = false;
            }
            b'\r' | b'\n' => self.key(Key::Enter),
            b'\t' => self.key(Key::Tab),
            // Serial terminals send Ctrl-H for the key that others send DEL for.
            0x08 | 0x7f => self.key(Key::Backspace),
            0x01..=0x1a => self.key(Key::Ctrl(char::from(byte - 1 + b'a'))),
            b' '..=b'~' => self.key(Key::Char(char::from(byte))),
            0xc2..=0xf4 => {
                self.held.push(byte);
                self.state = InputState::Character(match byte {
                    0xc2..=0xdf => 1,
                    0xe0..=0xef => 2,
                    _ => 3,
                });
            }
            _ => {}
        }
    }

    fn after_escape(&mut self, byte: u8) {
        self.ground();
        match byte {
            b'[' => self.state = InputState::Sequence,
            b'O' => self.state = InputState::Single,
            b']' | b'P' | b'_' | b'^' => self.state = InputState::Answer,
            // Alt-Esc; or Alt with a key that is a sequence itself, where the second ESC begins it.
            ESC => {
                self.state = InputState::Escape;
                self.doubled = true;
            }
            _ => {
                self.key(Key::Esc);
                self.plain(byte);
            }
        }
    }

    fn sequence(&mut self, parameters: &[u8], last: u8) {
        // Bytes that are not text are not parameters either.
        let Ok(text) = std::str::from_utf8(parameters) else {
            return;
        };
        if let Some(report) = text.strip_prefix('<') {
            let [button, x, y] = numbers(report);
            return self.mouse(button, x, y, last == b'm');
        }
        if text.starts_with(['?', '>', '=']) {
            return;
        }
        let [first, modifiers, _] = numbers(text);
        let shifted = modifiers.saturating_sub(1) & 1 == 1;
        // A second number such as "2:3" reports that a key was released.
        let released = text
            .split(';')
            .nth(1)
            .is_some_and(|part| part.ends_with(":3"));
        match last {
            _ if released => {}
            b'~' => match first {
                1 | 7 => self.key(Key::Home),
                3 => self.key(Key::Delete),
                4 | 8 => self.key(Key::End),
                5 => self.key(Key::PageUp),
                6 => self.key(Key::PageDown),
                200 => self.state = InputState::Paste,
                number => {
                    if let Some(key) = function_key(number) {
                        self.key(key);
                    }
                }
            },
            b'Z' => self.key(Key::BackTab),
            b'n' => {
                self.has_status = true;
                if self.doubled {
                    // No key is behind this one: the ESC before it was a key of its own.
                    self.key(Key::Esc);
                }
            }
            // The Delete of st; the F1 of others has numbers here, or comes after ESC O.
            b'P' if parameters.is_empty() => self.key(Key::Delete),
            b'u' => match (u8::try_from(first), shifted) {
                (Ok(27), _) => self.key(Key::Esc),
                (Ok(b'\t'), true) => self.key(Key::BackTab),
                (Ok(byte @ (b'\r' | b'\t' | 0x7f)), _) => self.plain(byte),
                _ => {}
            },
            _ => self.letter(last, shifted),
        }
    }

    fn letter(&mut self, letter: u8, shifted: bool) {
        let arrow = match letter {
            b'A' => Arrow::Up,
            b'B' => Arrow::Down,
            b'C' => Arrow::Right,
            b'D' => Arrow::Left,
            b'H' => return self.key(Key::Home),
            b'F' => return self.key(Key::End),
            b'P' => return self.key(Key::Function(1)),
            b'Q' => return self.key(Key::Function(2)),
            b'S' => return self.key(Key::Function(4)),
            _ => return,
        };
        self.key(if shifted {
            Key::ShiftArrow(arrow)
        } else {
            Key::Arrow(arrow)
        });
    }

    /// Adds an event of the left button or the wheel. In the sequence columns and rows count from 1, in the event
    /// from 0; a 0 in the sequence, which is wrong, becomes 0.
    fn mouse(&mut self, button: u16, x: u16, y: u16, released: bool) {
        let kind = match button & !0b1_1100 {
            64 => MouseKind::ScrollUp,
            65 => MouseKind::ScrollDown,
            0 | 3 if released => MouseKind::Release,
            0 => MouseKind::Press,
            32 => MouseKind::Drag,
            _ => return,
        };
        self.found.push(Input::Mouse(Mouse {
            kind,
            column: x.saturating_sub(1),
            row: y.saturating_sub(1),
        }));
    }

    fn in_paste(&mut self, byte: u8) {
        self.held.push(byte);
        if self.held.ends_with(PASTE_END) {
            self.paste(self.held.len() - PASTE_END.len());
            self.ground();
        } else if self.held.len() > LONGEST_PASTE + PASTE_END.len() {
            // Keeps the last bytes, which may be the beginning of the end mark.
            self.held.remove(LONGEST_PASTE);
        }
    }

    /// Adds the first `length` bytes of the pasted text as an event, with line ends as `\n`.
    fn paste(&mut self, length: usize) {
        let text = String::from_utf8_lossy(&self.held[..length.min(LONGEST_PASTE)]);
        let text = text.replace("\r\n", "\n").replace('\r', "\n");
        self.found.push(Input::Paste(text));
    }
}

fn function_key(number: u16) -> Option<Key> {
    let groups = [(11..=15, 10), (17..=21, 11), (23..=24, 12)];
    let (_, before) = groups
        .into_iter()
        .find(|(group, _)| group.contains(&number))?;
    u8::try_from(number - before).ok().map(Key::Function)
}

/// Reads up to three numbers between semicolons; a missing or malformed one is 0. In each, a colon and what follows
/// it are skipped.
fn numbers(text: &str) -> [u16; 3] {
    let mut numbers = [0; 3];
    for (number, part) in numbers.iter_mut().zip(text.split(';')) {
        let digits = part.split_once(':').map_or(part, |(digits, _)| digits);
        if let Ok(value) = digits.parse() {
            *number = value;
        }
    }
    numbers
}

#[cfg(test)]
mod tests;
