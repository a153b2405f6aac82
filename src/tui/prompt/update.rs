//! The effects of messages in the prompts.
//!
//! A prompt stays open until the typed line is valid, and opens again if its request is refused: at once by the
//! matrix, or later by the library. Completion asks the library for names where a command takes one; the answer
//! completes the word when it arrives.

use taxel_files::formats::value::counted;

use crate::tui::app::change::{from_prompt, refuse};
use crate::tui::app::dialog::Dialog;
use crate::tui::app::message::{LibraryRequest, Message};
use crate::tui::app::state::App;
use crate::tui::keys::action::Arguments;
use crate::tui::keys::key::Arrow;
use crate::tui::prompt::commands::wants_names;
use crate::tui::prompt::read::read;
use crate::tui::prompt::state::{CommandDialog, NameDialog};
use crate::tui::runtime::effect::{Effect, FileRequest, TerminalEffect};
use crate::tui::widget::text_field::TextField;
use crate::tui::{live, matrix};

/// Handles a message in the `:` prompt, which stays open until a command was understood.
pub(in crate::tui) fn in_command(
    app: &mut App,
    mut dialog: CommandDialog,
    message: Message,
) -> Option<Effect> {
    match message {
        Message::Accept => {
            let line = dialog.field.text().trim().to_owned();
            if line.is_empty() {
                return None;
            }
            let has_arguments = line.contains(' ');
            match read(&line, app) {
                Ok(message) => {
                    if app.commands.last() != Some(&line) {
                        app.commands.push(line);
                        dialog.set_given(&app.commands);
                    }
                    if !matches!(
                        message,
                        Message::Live(_) | Message::Help | Message::Redraw | Message::Suspend
                    ) {
                        live::update::set_aside(app);
                    }
                    return match message {
                        Message::Redraw => Some(Effect::Terminal(TerminalEffect::Redraw)),
                        Message::Suspend => Some(Effect::Terminal(TerminalEffect::Suspend)),
                        // Without arguments there is nothing to correct.
                        other if !has_arguments => matrix::update::act(app, other),
                        other => ask(app, other, Dialog::Command(dialog)),
                    };
                }
                Err(error) => refuse(app, error),
            }
        }
        Message::Field(_) => return complete(app, dialog),
        Message::Choose(Arrow::Down) => {
            if !dialog.later() {
                dialog.pick(true);
            }
        }
        Message::Choose(Arrow::Up) => {
            if !dialog.pick(false) {
                dialog.earlier();
            }
        }
        other => {
            dialog.edit(&other);
            say_left_out(app, &dialog.field);
        }
    }
    app.dialogs.push(Dialog::Command(dialog));
    None
}

fn say_left_out(app: &mut App, field: &TextField) {
    if field.left_out() > 0 {
        let characters = counted(field.left_out() as u64, "character");
        refuse(
            app,
            format!("the end of the text was left out: {characters}"),
        );
    }
}

fn complete(app: &mut App, mut dialog: CommandDialog) -> Option<Effect> {
    let wanted = wants_names(dialog.field.text());
    match wanted {
        None => dialog.complete(&[]),
        Some(_) => dialog.ask(),
    }
    let line = dialog.field.text().trim_start();
    let rest = line.split_once(' ').map_or("", |(_, rest)| rest);
    let last_word = rest.trim_start().to_owned();
    app.dialogs.push(Dialog::Command(dialog));
    wanted.map(|names| names_for(names, last_word))
}

/// A model may also be a path.
fn names_for(wanted: Arguments, last_word: String) -> Effect {
    match wanted {
        Arguments::File(_) | Arguments::FrameSource => Effect::File(FileRequest::Paths(last_word)),
        Arguments::Model if last_word.contains('/') => Effect::File(FileRequest::Paths(last_word)),
        Arguments::Model => Effect::Library(LibraryRequest::Models),
        Arguments::Deleted => Effect::Library(LibraryRequest::Trash),
        _ => Effect::Library(LibraryRequest::List),
    }
}

fn ask(app: &mut App, message: Message, prompt: Dialog) -> Option<Effect> {
    from_prompt(app, prompt, |app| matrix::update::act(app, message))
}

/// Handles a message in the prompt for a name, which stays open until the name is valid.
pub(in crate::tui) fn in_name(
    app: &mut App,
    mut dialog: NameDialog,
    message: Message,
) -> Option<Effect> {
    match message {
        Message::Accept => match dialog.name() {
            Ok(name) => {
                return ask(app, app.storing(name), Dialog::Name(dialog));
            }
            Err(error) => refuse(app, error.to_string()),
        },
        other => {
            dialog.field.take(&other);
            say_left_out(app, &dialog.field);
        }
    }
    app.dialogs.push(Dialog::Name(dialog));
    None
}
