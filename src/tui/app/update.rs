//! Every change of the state begins here: with a message, or with the answer of a job.
//!
//! The top page receives the message, or the matrix if there is none. A notice stays until the next message from the
//! user.

use crate::tui::app::{
    App, Flow, Message, Notice, Page, RunState, TerminalEffect, from_prompt, give_prompt, inform,
    mouse, refuse,
};
use crate::tui::explain::Explain;
use crate::tui::help::Help;
use crate::tui::jobs::Answer;
use crate::tui::keys::{Context, Key, action};
use crate::tui::{explore, live, matrix, recognise};

/// The length, in bytes, from which nothing is added to a failure that nobody has read.
const MOST_SAID: usize = 300;

/// Handles a message, and applies the answers of jobs that have come. Returns what the terminal is to do.
pub fn update(app: &mut App, message: Message) -> Option<TerminalEffect> {
    app.following(|app| handle(app, message));
    loop {
        live::update::write_changes(app);
        recognise::page::follow(app);
        app.jobs.settle(app.pages.len());
        if let Some(answer) = app.jobs.next_answer(app.pages.len()) {
            app.following(|app| on_answer(app, answer));
        } else {
            break;
        }
    }
    explore::work::close_if_failed(app);
    recognise::page::stop_if_failed(app);
    let works = app.unsaved_work();
    app.jobs.keep(works);
    app.terminal.take()
}

fn handle(app: &mut App, message: Message) {
    match message {
        Message::Redraw => app.terminal = Some(TerminalEffect::Redraw),
        Message::Suspend => app.terminal = Some(TerminalEffect::Suspend),
        Message::Resized(columns, rows) => app.screen = (columns, rows),
        Message::Terminate => app.run_state = RunState::Terminated,
        Message::Unknown(key) => unknown(app, key),
        Message::Answered => {}
        Message::Mouse(mouse) => {
            if let Some(meant) = mouse::act(app, mouse) {
                handle(app, meant);
            }
        }
        message => {
            app.notice = None;
            perform(app, message);
        }
    }
}

/// Applies the answer of a job. A failure stays until the next key: what is said after it stands beside it, so that it
/// can be read. If the request was refused, the prompt that it came from opens again: so the user can correct it, and
/// the next keys do not reach the matrix. An answer without a notice leaves the old notice as it is.
fn on_answer(app: &mut App, answer: Answer) {
    let before = app.notice.take();
    answer(app);
    match &app.notice {
        None => give_prompt(app),
        Some(said) if said.is_refusal => app.pages.extend(app.prompt.take()),
        Some(_) => app.prompt = None,
    }
    app.notice = match (before, app.notice.take()) {
        (Some(mut first), Some(then)) if first.stays => {
            if !first.text.contains(&then.text) && first.text.len() < MOST_SAID {
                first.text += &format!("; {}", then.text);
            }
            Some(first)
        }
        (_, Some(then)) => Some(Notice {
            stays: then.is_refusal,
            ..then
        }),
        (before, None) => before,
    };
}

fn perform(app: &mut App, message: Message) {
    app.begin_action();
    // While the shape is held, its moves stay one step, even if help or another page is opened meanwhile.
    if !message.moves_shape() && app.held.is_none() {
        app.moves = None;
    }
    if matches!(message, Message::Paste(_)) && !app.context().takes_text() {
        return refuse(app, "pasted text goes into fields only");
    }
    match app.pages.pop() {
        Some(page) => on_page(app, page, &message),
        None => matrix::update::act(app, message),
    }
}

/// Handles a message on a page. Help opens over any page, with the keys of that page.
fn on_page(app: &mut App, mut page: Box<dyn Page>, message: &Message) {
    let place = app.pages.len();
    let context = app.context_on(Some(&*page));
    let flow = match message {
        Message::Cancel | Message::Quit if !page.cancels_itself() => Flow::Close,
        Message::Help => Flow::push(Help::new(context)),
        Message::Explain => Flow::push(Explain::new(app)),
        message => page.on(app, message),
    };
    let back = |app: &mut App, page| app.pages.insert(place.min(app.pages.len()), page);
    match flow {
        Flow::Stay => back(app, page),
        Flow::Close => page.closed(app),
        Flow::Push(next) => {
            back(app, page);
            app.pages.push(next);
        }
        Flow::Ask(act) => from_prompt(app, page, act),
    }
}

/// Names the key that lists those that do something.
fn unknown(app: &mut App, key: Key) {
    if key == Key::Esc
        && let Some(what) = app.jobs.give_up_reading(app.pages.len())
    {
        return inform(app, format!("{what}: stopped waiting"));
    }
    if app.unknown_keys.contains(&key) {
        return;
    }
    app.unknown_keys.push(key);
    let here = app.context();
    let mut text = format!("{} does nothing here", key.label());
    if here != Context::Help {
        text += &format!("; {} lists the keys", app.keymap.label(here, &action::HELP));
    }
    refuse(app, text);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::app::state::Options;

    #[test]
    fn a_failure_stays_until_the_next_key() {
        let mut app = App::new(&Options::plain(true));
        let after = |app: &mut App, said: fn(&mut App, String), text: &str| {
            let text = text.to_owned();
            app.jobs.later(move |app| said(app, text));
            update(app, Message::Answered);
            app.notice.clone()
        };
        let notice = |text: &str, stays| {
            Some(Notice {
                text: text.to_owned(),
                is_refusal: stays,
                stays,
            })
        };
        let full = "a.json: no space left";
        for reason in [full, full] {
            assert_eq!(after(&mut app, refuse, reason), notice(full, true));
        }
        let both = "a.json: no space left; written: b.svg";
        assert_eq!(
            after(&mut app, inform, "written: b.svg"),
            notice(both, true)
        );
        // It does not grow without end.
        for number in 0..99 {
            after(&mut app, refuse, &format!("{number}: no space left"));
        }
        let text = after(&mut app, inform, "written: b.svg")
            .expect("said")
            .text;
        assert!(
            text.starts_with(both) && text.len() < 2 * MOST_SAID,
            "{text}"
        );
        update(&mut app, Message::Help);
        assert_eq!(app.notice, None);
        // What the user is refused gives way to what is said next.
        update(&mut app, Message::Paste("text".to_owned()));
        let said = "written: b.svg";
        assert_eq!(after(&mut app, inform, said), notice(said, false));
    }
}
