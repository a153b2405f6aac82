//! What messages do in a dialog. The dialog was taken off the stack, and goes back unless it is done with.

use crate::tui::app::change::{refuse, replace};
use crate::tui::app::dialog::{Dialog, Help, Question};
use crate::tui::app::layout::Panes;
use crate::tui::app::library_event::{choose, look};
use crate::tui::app::message::{Endpoint, Message};
use crate::tui::app::state::App;
use crate::tui::explore;
use crate::tui::explore::message::ExploreMessage;
use crate::tui::form::state::FormDialog;
use crate::tui::keys::action::Arguments;
use crate::tui::keys::key::Arrow;
use crate::tui::matrix;
use crate::tui::prompt::command::read;
use crate::tui::prompt::commands::wants_names;
use crate::tui::prompt::name::NameDialog;
use crate::tui::prompt::state::CommandDialog;
use crate::tui::runtime::effect::{Effect, LibraryRequest, TerminalEffect};
use crate::tui::shapes::state::ListDialog;

/// Does what a message says.
pub(in crate::tui) fn act(app: &mut App, dialog: Dialog, message: Message) -> Option<Effect> {
    let message = match (&dialog, message) {
        // Work that nobody waits for any more does not go on.
        (Dialog::Running(_), Message::Cancel | Message::Quit) => {
            Message::Explore(ExploreMessage::Stop)
        }
        (_, message) => message,
    };
    if matches!(message, Message::Cancel | Message::Quit) {
        explore::start::put_away(app, dialog);
        return None;
    }
    if message == Message::Help {
        let help = Help::new(dialog.context());
        app.dialogs.extend([dialog, Dialog::Help(help)]);
        return None;
    }
    match dialog {
        Dialog::Form(form) => in_form(app, *form, message),
        Dialog::List(list) => return in_list(app, list, message),
        Dialog::Name(name) => return in_name(app, name, message),
        Dialog::Command(command) => return in_command(app, command, message),
        Dialog::Question(question) => return at_question(app, question, &message),
        Dialog::Help(help) => in_help(app, help, &message),
        Dialog::Ranges(form) => return explore::start::in_ranges(app, form, message),
        Dialog::Running(running) => return explore::start::in_running(app, running, &message),
        Dialog::Results(results) => return explore::update::in_results(app, results, message),
        Dialog::Export(dialog) => return explore::update::in_export(app, dialog, &message),
    }
    None
}

fn in_help(app: &mut App, mut help: Help, message: &Message) {
    if let Message::Scroll(lines) = message {
        let room = Panes::shown(app).map_or((0, 0), |panes| panes.body.as_size().into());
        help.scroll(*lines, app.keymap(), room);
    }
    app.dialogs.push(Dialog::Help(help));
}

fn at_question(app: &mut App, question: Question, message: &Message) -> Option<Effect> {
    match (message, question.no) {
        (Message::Accept, _) => matrix::update::act(app, question.yes),
        (Message::Decline, Some(no)) => matrix::update::act(app, no),
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
                refuse(app, error.labelled());
            }
        },
        Message::Field(by) => dialog.move_focus(by),
        // The kind, being there already: the next one.
        Message::ToField(None) if dialog.form().focus().is_none() => dialog.choose(Arrow::Right),
        Message::ToField(field) => dialog.edit(|form| form.set_focus(field)),
        Message::Choose(arrow) => dialog.choose(arrow),
        Message::Type(character) => dialog.insert(character),
        Message::Step(direction) => dialog.edit(|form| form.step(direction)),
        other => dialog.edit(|form| form.take(&other)),
    }
    app.dialogs.push(Dialog::Form(Box::new(dialog)));
}

fn in_list(app: &mut App, mut list: ListDialog, message: Message) -> Option<Effect> {
    match message {
        Message::Accept => return choose(app, list),
        Message::Scroll(lines) => list.go(lines),
        Message::ScrollTo(Endpoint::First) => list.select(0),
        Message::ScrollTo(Endpoint::Last) => list.select(usize::MAX),
        other => list.edit(&other),
    }
    app.dialogs.push(Dialog::List(list));
    look(app)
}

fn in_command(app: &mut App, mut dialog: CommandDialog, message: Message) -> Option<Effect> {
    match message {
        Message::Accept => {
            let line = dialog.field.text().trim().to_owned();
            if line.is_empty() {
                return None;
            }
            match read(&line, app) {
                Ok(message) => {
                    if app.commands.last() != Some(&line) {
                        app.commands.push(line);
                    }
                    return match message {
                        Message::Redraw => Some(Effect::Terminal(TerminalEffect::Redraw)),
                        Message::Suspend => Some(Effect::Terminal(TerminalEffect::Suspend)),
                        other => matrix::update::act(app, other),
                    };
                }
                Err(error) => refuse(app, error),
            }
        }
        Message::Field(_) => {
            let wanted = wants_names(dialog.field.text());
            if wanted.is_none() {
                dialog.complete(&[]);
            }
            app.dialogs.push(Dialog::Command(dialog));
            // The names are completed when they are known.
            return wanted.map(|names| {
                Effect::Library(match names {
                    Arguments::Deleted => LibraryRequest::Trash,
                    _ => LibraryRequest::List,
                })
            });
        }
        Message::Choose(Arrow::Up) => dialog.earlier(&app.commands),
        Message::Choose(Arrow::Down) => dialog.later(&app.commands),
        other => dialog.edit(&other),
    }
    app.dialogs.push(Dialog::Command(dialog));
    None
}

fn in_name(app: &mut App, mut dialog: NameDialog, message: Message) -> Option<Effect> {
    match message {
        Message::Accept => match dialog.name() {
            Ok(name) => {
                return matrix::update::act(app, app.storing(name));
            }
            Err(error) => refuse(app, error.to_string()),
        },
        other => {
            dialog.field.take(&other);
        }
    }
    app.dialogs.push(Dialog::Name(dialog));
    None
}
