//! The effects of messages in a form.
//!
//! Accept puts the form's document onto the matrix if all fields are valid; otherwise it moves the focus to the first
//! invalid field and shows its error. Every other message edits the fields, and the matrix follows.

use crate::figure::FigureKind;
use crate::quote::quoted_character;
use crate::tui::app::change::{refuse, replace};
use crate::tui::app::dialog::Dialog;
use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::form::state::FormDialog;
use crate::tui::keys::key::Arrow;
use crate::tui::runtime::effect::Effect;

/// Handles a message. The form stays open unless it is accepted.
pub(in crate::tui) fn update(
    app: &mut App,
    mut dialog: Box<FormDialog>,
    message: Message,
) -> Option<Effect> {
    let on_kind = dialog.form().focus().is_none();
    match message {
        Message::Accept => match dialog.form().error() {
            None => {
                if let Some(figure) = dialog.made_figure() {
                    app.forms.note_figure(figure, &dialog.shown().sensor);
                }
                replace(app, dialog.shown().clone());
                return None;
            }
            Some((index, error)) => {
                dialog.edit(|form| form.set_focus(Some(index)));
                refuse(app, error.full);
            }
        },
        // A click on the kind, if it already has the focus, chooses the next kind.
        Message::ToField(None) | Message::Choose(Arrow::Right) if on_kind => {
            dialog.choose_next_kind();
        }
        Message::Choose(Arrow::Left) if on_kind => dialog.choose_previous_kind(),
        Message::Type(character) => {
            if !dialog.insert(character) {
                let kind = quoted_character(character);
                refuse(
                    app,
                    format!("no kind begins with {kind}; kinds: {}", kinds()),
                );
            }
        }
        Message::Paste(text) => {
            if !dialog.paste(&text) {
                refuse(app, format!("no kind named {text:?}; kinds: {}", kinds()));
            }
        }
        Message::Defaults => dialog.set_defaults(),
        Message::Step(_) | Message::Erase(_) | Message::ToEdge(_) if on_kind => {
            refuse(app, "an arrow or a letter chooses the kind");
        }
        Message::Step(direction) => dialog.edit(|form| form.step(direction)),
        other => dialog.edit(|form| form.take(&other)),
    }
    app.dialogs.push(Dialog::Form(dialog));
    None
}

fn kinds() -> String {
    FigureKind::names().join(", ")
}
