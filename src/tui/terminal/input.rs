//! What a user does at the terminal, as crossterm reads it.

use std::panic::catch_unwind;
use std::sync::mpsc::Sender;
use std::thread;

use crossterm::event::{
    self, KeyCode, KeyEvent, KeyEventKind, KeyModifiers, MouseButton, MouseEvent, MouseEventKind,
};
use signal_hook::consts::SIGHUP;

use crate::tui::app::{Mouse, MouseKind};
use crate::tui::keys::{Arrow, Key};
use crate::tui::terminal::event_loop::Event;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Input {
    Key(Key),
    Paste(String),
    Mouse(Mouse),
    /// The size of the screen, in columns and rows.
    Size(u16, u16),
}

/// Reads on a thread of its own: crossterm waits for the rest of half a key, and never returns from a terminal that is
/// gone (<https://github.com/crossterm-rs/crossterm/issues/793>).
pub(super) fn read(events: Sender<Event>) {
    thread::spawn(move || {
        loop {
            // A panic of its parser loses a key, not the keyboard.
            match catch_unwind(event::read) {
                Ok(Ok(read)) => {
                    for input in inputs(read) {
                        let _ = events.send(Event::Input(input));
                    }
                }
                Ok(Err(_)) => {
                    let _ = events.send(Event::Signal(SIGHUP));
                    return;
                }
                Err(_) => {}
            }
        }
    });
}

fn inputs(read: event::Event) -> Vec<Input> {
    match read {
        event::Event::Key(key) => keys(key).into_iter().map(Input::Key).collect(),
        event::Event::Paste(text) => {
            vec![Input::Paste(text.replace("\r\n", "\n").replace('\r', "\n"))]
        }
        event::Event::Mouse(event) => mouse(event).into_iter().map(Input::Mouse).collect(),
        event::Event::Resize(columns, rows) => vec![Input::Size(columns, rows)],
        event::Event::FocusGained | event::Event::FocusLost => Vec::new(),
    }
}

/// Nothing here is bound to Alt, and a quick Esc over a slow line arrives together with the next key: Alt with a
/// character is Esc, then the character.
fn keys(event: KeyEvent) -> Vec<Key> {
    let has = |modifier| event.modifiers.contains(modifier);
    let arrow = |arrow| {
        if has(KeyModifiers::SHIFT) {
            Key::ShiftArrow(arrow)
        } else {
            Key::Arrow(arrow)
        }
    };
    let key = match event.code {
        _ if event.kind == KeyEventKind::Release => return Vec::new(),
        KeyCode::Char(letter) if has(KeyModifiers::CONTROL) => match letter {
            // Serial terminals send Ctrl-H for the key that others send DEL for.
            'h' => Key::Backspace,
            'j' => Key::Enter,
            'a'..='z' => Key::Ctrl(letter),
            _ => return Vec::new(),
        },
        KeyCode::Char(character) if !character.is_control() => Key::Char(character),
        KeyCode::Enter => Key::Enter,
        KeyCode::Esc => Key::Esc,
        KeyCode::Tab => Key::Tab,
        KeyCode::BackTab => Key::BackTab,
        KeyCode::Backspace => Key::Backspace,
        KeyCode::Delete => Key::Delete,
        KeyCode::Home => Key::Home,
        KeyCode::End => Key::End,
        KeyCode::PageUp => Key::PageUp,
        KeyCode::PageDown => Key::PageDown,
        KeyCode::F(number @ 1..=12) => Key::Function(number),
        KeyCode::Left => arrow(Arrow::Left),
        KeyCode::Right => arrow(Arrow::Right),
        KeyCode::Up => arrow(Arrow::Up),
        KeyCode::Down => arrow(Arrow::Down),
        _ => return Vec::new(),
    };
    if has(KeyModifiers::ALT) && matches!(event.code, KeyCode::Char(_)) {
        vec![Key::Esc, key]
    } else {
        vec![key]
    }
}

fn mouse(event: MouseEvent) -> Option<Mouse> {
    let kind = match event.kind {
        MouseEventKind::Down(MouseButton::Left) => MouseKind::Press,
        MouseEventKind::Drag(MouseButton::Left) => MouseKind::Drag,
        MouseEventKind::Up(MouseButton::Left) => MouseKind::Release,
        MouseEventKind::ScrollUp => MouseKind::ScrollUp,
        MouseEventKind::ScrollDown => MouseKind::ScrollDown,
        _ => return None,
    };
    let (column, row) = (event.column, event.row);
    Some(Mouse { kind, column, row })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_terminals_send_differently_are_the_same() {
        let (none, control) = (KeyModifiers::NONE, KeyModifiers::CONTROL);
        for (code, modifiers, expected) in [
            (
                KeyCode::Char('X'),
                KeyModifiers::SHIFT,
                vec![Key::Char('X')],
            ),
            (KeyCode::Char('h'), control, vec![Key::Backspace]),
            (KeyCode::Char('j'), control, vec![Key::Enter]),
            (KeyCode::Char('l'), control, vec![Key::Ctrl('l')]),
            (KeyCode::Char('4'), control, vec![]),
            (
                KeyCode::Char('q'),
                KeyModifiers::ALT,
                vec![Key::Esc, Key::Char('q')],
            ),
            (KeyCode::Up, KeyModifiers::ALT, vec![Key::Arrow(Arrow::Up)]),
            (
                KeyCode::Left,
                KeyModifiers::SHIFT,
                vec![Key::ShiftArrow(Arrow::Left)],
            ),
            (KeyCode::F(12), none, vec![Key::Function(12)]),
            (KeyCode::CapsLock, none, vec![]),
        ] {
            assert_eq!(keys(KeyEvent::new(code, modifiers)), expected, "{code:?}");
        }
    }
}
