//! The only writer of the state: a message goes in, and perhaps a wish for the world outside comes out.

use crate::tui::app::message::Message;
use crate::tui::app::state::{App, RunState};
use crate::tui::app::{dialog_update, library_event, mouse};
use crate::tui::runtime::effect::{Effect, TerminalEffect};
use crate::tui::{explore, matrix};

/// Does what a message says. A notice stays until the next message that is not an answer to the last one.
pub fn update(app: &mut App, message: Message) -> Option<Effect> {
    match message {
        Message::Redraw => return Some(Effect::Terminal(TerminalEffect::Redraw)),
        Message::Suspend => return Some(Effect::Terminal(TerminalEffect::Suspend)),
        Message::Resized(columns, rows) => {
            app.screen = (columns, rows);
            return Some(Effect::Terminal(TerminalEffect::Redraw));
        }
        Message::Terminate => {
            app.run_state = RunState::Terminated;
            return None;
        }
        Message::Library(answer) => return library_event::on_library(app, answer),
        Message::Worker(told) => return explore::worker_event::on_worker(app, told),
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
        Some(dialog) => dialog_update::act(app, dialog, message),
        None => matrix::update::act(app, message),
    }
}
