//! What messages do in a dialog. The dialog was taken off the stack, and goes back unless it is done with.

use tui_input::InputRequest;

use super::answer::{choose, look};
use super::change::{refuse, replace};
use super::matrix;
use crate::tui::app::App;
use crate::tui::command::read;
use crate::tui::command_dialog::CommandDialog;
use crate::tui::dialog::{Dialog, Question};
use crate::tui::form_dialog::FormDialog;
use crate::tui::key::Arrow;
use crate::tui::keymap::help_lines;
use crate::tui::list::ListDialog;
use crate::tui::message::{End, Erase, Message};
use crate::tui::name_dialog::NameDialog;
use crate::tui::request::Effect;

/// Does what a message says.
pub(super) fn act(app: &mut App, dialog: Dialog, message: Message) -> Option<Effect> {
    if matches!(message, Message::Cancel | Message::Quit) {
        return None;
    }
    match dialog {
        Dialog::Form(form) => in_form(app, *form, message),
        Dialog::List(list) => return in_list(app, list, message),
        Dialog::Name(name) => return in_name(app, name, message),
        Dialog::Command(command) => return in_command(app, command, message),
        Dialog::Question(question) => return at_question(app, question, &message),
        Dialog::Help(top) => {
            let top = match message {
                Message::Scroll(lines) => top
                    .saturating_add_signed(isize::from(lines))
                    .min(help_lines() - 1),
                _ => top,
            };
            app.dialogs.push(Dialog::Help(top));
        }
    }
    None
}

fn at_question(app: &mut App, question: Question, message: &Message) -> Option<Effect> {
    match (message, question.no) {
        (Message::Accept, _) => matrix::act(app, question.yes),
        (Message::Decline, Some(no)) => matrix::act(app, no),
        (Message::Decline, None) => None,
        (_, no) => {
            app.dialogs
                .push(Dialog::Question(Question { no, ..question }));
            None
        }
    }
}

fn in_form(app: &mut App, mut dialog: FormDialog, message: Message) {
    match message {
        Message::Accept => match dialog.form().error() {
            None => return replace(app, dialog.shown().clone()),
            Some((index, error)) => {
                dialog.edit(|form| form.set_focus(Some(index)));
                refuse(app, error.to_string());
            }
        },
        Message::Field(by) => dialog.move_focus(by),
        Message::Choose(arrow) => dialog.choose(arrow),
        Message::Type(character) => dialog.insert(character),
        Message::Step(direction) => dialog.edit(|form| form.step(direction)),
        Message::Erase(erase) => dialog.edit(|form| form.erase(erase)),
        Message::ToEdge(end) => dialog.edit(|form| form.to_edge(end)),
        Message::Paste(text) => {
            text.trim()
                .chars()
                .for_each(|character| dialog.edit(|form| form.insert(character)));
        }
        _ => {}
    }
    app.dialogs.push(Dialog::Form(Box::new(dialog)));
}

fn in_list(app: &mut App, mut list: ListDialog, message: Message) -> Option<Effect> {
    match message {
        Message::Accept => return choose(app, list),
        Message::Scroll(lines) => list.go(lines),
        Message::ScrollTo(End::First) => list.select(0),
        Message::ScrollTo(End::Last) => list.select(usize::MAX),
        Message::Type(character) => list.insert(character),
        Message::Paste(text) => text
            .trim()
            .chars()
            .for_each(|character| list.insert(character)),
        Message::Erase(Erase::All) => list.edit(InputRequest::DeleteLine),
        Message::Erase(_) => list.edit(InputRequest::DeletePrevChar),
        _ => {}
    }
    app.dialogs.push(Dialog::List(list));
    look(app)
}

/// What a message means in a line of text.
fn editing(message: &Message) -> Option<InputRequest> {
    Some(match message {
        Message::Choose(Arrow::Left) => InputRequest::GoToPrevChar,
        Message::Choose(Arrow::Right) => InputRequest::GoToNextChar,
        Message::ToEdge(End::First) => InputRequest::GoToStart,
        Message::ToEdge(End::Last) => InputRequest::GoToEnd,
        Message::Erase(Erase::All) => InputRequest::DeleteLine,
        Message::Erase(Erase::Before) => InputRequest::DeletePrevChar,
        Message::Erase(Erase::Under) => InputRequest::DeleteNextChar,
        _ => return None,
    })
}

fn in_command(app: &mut App, mut dialog: CommandDialog, message: Message) -> Option<Effect> {
    match message {
        Message::Accept => {
            let line = dialog.text().trim().to_owned();
            if line.is_empty() {
                return None;
            }
            match read(&line, app) {
                Ok(message) => {
                    app.commands.push(line);
                    return match message {
                        Message::Redraw => Some(Effect::Redraw),
                        other => matrix::act(app, other),
                    };
                }
                Err(error) => refuse(app, error),
            }
        }
        Message::Field(_) => dialog.complete(),
        Message::Choose(Arrow::Up | Arrow::Down) => {
            let now = app.commands.iter().rposition(|line| line == dialog.text());
            let next = match (&message, now) {
                (Message::Choose(Arrow::Up), None) => app.commands.len().checked_sub(1),
                (Message::Choose(Arrow::Up), Some(now)) => Some(now.saturating_sub(1)),
                (_, now) => now.map(|now| now + 1),
            };
            dialog.recall(
                next.and_then(|next| app.commands.get(next))
                    .map_or("", String::as_str),
            );
        }
        Message::Type(character) => dialog.insert(character),
        Message::Paste(text) => text
            .trim()
            .chars()
            .for_each(|character| dialog.insert(character)),
        other => editing(&other)
            .into_iter()
            .for_each(|request| dialog.edit(request)),
    }
    app.dialogs.push(Dialog::Command(dialog));
    None
}

fn in_name(app: &mut App, mut dialog: NameDialog, message: Message) -> Option<Effect> {
    match message {
        Message::Accept => match dialog.name() {
            Ok(name) => {
                return matrix::act(app, app.storing(name));
            }
            Err(error) => refuse(app, error.to_string()),
        },
        Message::Type(character) => dialog.insert(character),
        Message::Paste(text) => text
            .trim()
            .chars()
            .for_each(|character| dialog.insert(character)),
        other => editing(&other)
            .into_iter()
            .for_each(|request| dialog.edit(request)),
    }
    app.dialogs.push(Dialog::Name(dialog));
    None
}
