//! The only writer of the state: a message goes in, and perhaps a wish for the world outside comes out.

mod change;

mod answer;

mod explore;

mod matrix;

mod dialog;

mod mouse;

use super::app::{App, Life};
use super::message::Message;
use super::request::{Effect, TerminalEffect};

/// Does what a message says. A notice stays until the next message that is not an answer to the last one.
pub fn update(app: &mut App, message: Message) -> Option<Effect> {
    match message {
        Message::Redraw => return Some(Effect::Terminal(TerminalEffect::Redraw)),
        Message::Suspend => return Some(Effect::Terminal(TerminalEffect::Suspend)),
        Message::Resized(columns, rows) => {
            app.screen = (columns, rows);
            return Some(Effect::Terminal(TerminalEffect::Redraw));
        }
        Message::Killed => {
            app.life = Life::Killed;
            return None;
        }
        Message::Answer(answer) => return answer::take(app, answer),
        Message::Told(told) => return explore::hear(app, told),
        Message::Mouse(mouse) => {
            let meant = mouse::act(app, mouse)?;
            return update(app, meant);
        }
        _ => {}
    }
    app.notice = None;
    // A key between press and release: what is dragged on would change another document than the press did.
    app.paint = None;
    match app.dialogs.pop() {
        Some(dialog) => dialog::act(app, dialog, message),
        None => matrix::act(app, message),
    }
}
