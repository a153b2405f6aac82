//! The effects of messages in the prompts.
//!
//! A prompt stays open until the typed line is valid, and opens again if its request is refused: at once by the
//! matrix, or later by the library. Completion asks the library for names where a command takes one; the answer
//! completes the word when it arrives.

use taxel_files::formats::value::counted;
use taxel_files::storage::{Library, ModelChoice, ModelFolder, ShapeOrigin};

use crate::tui::app::change::refuse;
use crate::tui::app::message::Message;
use crate::tui::app::page::Flow;
use crate::tui::app::state::App;
use crate::tui::jobs::answer;
use crate::tui::keys::key::Arrow;
use crate::tui::prompt::commands::{Names, read, wants_names};
use crate::tui::prompt::state::{CommandDialog, NameDialog};
use crate::tui::runtime::disk::files;
use crate::tui::shapes::library::sentence;
use crate::tui::widget::text_field::TextField;
use crate::tui::{live, matrix, shapes};

/// The prompt stays open until a command was understood.
pub(crate) fn in_command(dialog: &mut CommandDialog, app: &mut App, message: &Message) -> Flow {
    match message {
        Message::Accept => {
            let line = dialog.field.text().trim().to_owned();
            if line.is_empty() {
                return Flow::Close;
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
                        Message::Live(_) | Message::Help | Message::SwitchPane
                    ) {
                        live::update::set_aside(app);
                    }
                    // Without arguments there is nothing to correct.
                    if has_arguments {
                        return Flow::ask(|app| matrix::update::act(app, message));
                    }
                    matrix::update::act(app, message);
                    return Flow::Close;
                }
                Err(error) => refuse(app, error),
            }
        }
        Message::Field(_) => complete(app, dialog),
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
            dialog.edit(other);
            say_left_out(app, &dialog.field);
        }
    }
    Flow::Stay
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

fn complete(app: &mut App, dialog: &mut CommandDialog) {
    let wanted = wants_names(dialog.field.text());
    match wanted {
        None => dialog.complete(&[]),
        Some(_) => dialog.ask(),
    }
    let line = dialog.field.text().trim_start();
    let rest = line.split_once(' ').map_or("", |(_, rest)| rest);
    let last_word = rest.trim_start().to_owned();
    if let Some(wanted) = wanted {
        complete_from_disk(app, wanted, last_word);
    }
}

/// Completes the last word by the names that may stand there. A model may also be a path.
fn complete_from_disk(app: &mut App, wanted: Names, last_word: String) {
    app.jobs.read("Listing the names", move |library| {
        let names = names(library, wanted, &last_word);
        answer(|app| match names {
            Ok(names) => {
                if let Some(command) = app.top_mut::<CommandDialog>() {
                    command.complete_asked(&names);
                }
            }
            Err(reason) => refuse(app, reason),
        })
    });
}

fn names(library: &Library, wanted: Names, last_word: &str) -> Result<Vec<String>, String> {
    let sentence = |error| sentence(library, &error);
    match wanted {
        Names::Paths => Ok(files::paths(last_word)),
        Names::Models if last_word.contains('/') => Ok(files::paths(last_word)),
        Names::Models => {
            let sets = ModelChoice::BUILT_IN.iter();
            let sets = sets.map(|set| set.name().to_owned());
            let own = ModelFolder::of(library.folder()).names().into_iter();
            Ok(sets.chain(own.map(|name| name.to_string())).collect())
        }
        Names::Deleted => match library.deleted().map_err(sentence)? {
            names if names.is_empty() => Err("nothing has been deleted".to_owned()),
            names => Ok(names),
        },
        // Shipped shapes cannot be deleted or replaced.
        Names::Shapes { own } => {
            let entries = library.list().map_err(sentence)?.into_iter();
            let offered = entries.filter(|entry| !own || entry.origin == ShapeOrigin::Own);
            Ok(offered.map(|entry| entry.name).collect())
        }
    }
}

/// The prompt stays open until the name is valid.
pub(crate) fn in_name(dialog: &mut NameDialog, app: &mut App, message: &Message) -> Flow {
    if *message == Message::Accept {
        match dialog.name() {
            Ok(name) => {
                let quits = dialog.quits;
                return Flow::ask(move |app| shapes::library::save(app, name, quits));
            }
            Err(error) => refuse(app, error.to_string()),
        }
    } else {
        dialog.field.take(message);
        say_left_out(app, &dialog.field);
    }
    Flow::Stay
}
