//! The lines at the foot: what made the imprint, the taxel under the cursor, notices and questions, hints.

use ratatui::buffer::Buffer;

use super::write;
use crate::formats::name::NameError;
use crate::tui::app::{App, Mode, Notice};
use crate::tui::binding::Binding;
use crate::tui::dialog::Dialog;
use crate::tui::document::Seen;
use crate::tui::keymap::KEYMAP;
use crate::tui::layout::Panes;
use crate::tui::message::Message;
use crate::tui::theme::Role;

/// What stands before the name to store under.
pub const NAME_LABEL: &str = "Save as: ";

/// Draws all of them.
pub fn draw(app: &App, seen: &Seen, buffer: &mut Buffer, panes: &Panes) {
    let theme = app.theme();
    write::line(
        buffer,
        panes.source,
        theme,
        [(source(app, seen).as_str(), Role::Text)],
    );
    let said = said(app);
    if said.is_none() || panes.taxel != panes.notice {
        write::line(
            buffer,
            panes.taxel,
            theme,
            [(taxel(app, seen, panes).as_str(), Role::Text)],
        );
    }
    if let Some((text, role)) = said {
        write::line(buffer, panes.notice, theme, [(text.as_str(), role)]);
    }
    hints(app, buffer, panes);
}

/// What made the imprint.
fn source(app: &App, seen: &Seen) -> String {
    let document = app.shown();
    let by_hand = document.turned.count();
    let taxels = if by_hand == 1 {
        "1 taxel".to_owned()
    } else {
        format!("{by_hand} taxels")
    };
    let name = app.stored_name().map_or(String::new(), |stored| {
        let changed = if app.unsaved() { "*" } else { "" };
        format!("{stored}{changed}: ")
    });
    let Some(source) = &document.source else {
        return name
            + &if by_hand == 0 {
                "empty: Space draws, f touches a figure".to_owned()
            } else {
                "drawn by hand".to_owned()
            };
    };
    let mut text = name + &source.to_string();
    if by_hand > 0 {
        text += &format!(" + {taxels} by hand");
    }
    if seen.beyond {
        text += "; reaches beyond the sensor";
    }
    text
}

/// The taxel under the cursor, and how the shape is held. Everything has a place of its own, whatever is before it: so
/// little is sent over the line when the cursor moves.
fn taxel(app: &App, seen: &Seen, panes: &Panes) -> String {
    let (column, row) = app.cursor;
    let narrow = panes.taxel.width < 60;
    let place = if narrow {
        format!("{column}, {row}")
    } else {
        format!("column {column}, row {row}")
    };
    let state = if seen.imprint.get(column, row) {
        "active"
    } else {
        "inactive"
    };
    let covered = match seen.coverage(column, row) {
        Some(coverage) => format!("covered {coverage:.6}  "),
        None => String::new(),
    };
    let held = match app.mode {
        Mode::Grab => format!("  held, step {}", app.step.length()),
        Mode::Draw => String::new(),
    };
    format!(
        "{place:<17}  {state:<8}  {covered}NA {} in all{held}",
        seen.imprint.count()
    )
}

/// The question that is asked, or the notice.
fn said(app: &App) -> Option<(String, Role)> {
    match app.dialogs.last() {
        Some(Dialog::Question(question)) => {
            let answers = if question.no.is_some() { "" } else { " (y/n)" };
            return Some((format!("{}{answers}", question.text), Role::Error));
        }
        Some(Dialog::Name(dialog)) if app.notice.is_none() => {
            let (text, role) = match dialog.name() {
                Ok(_) | Err(NameError::Empty) => (String::new(), Role::Quiet),
                Err(error) => (format!("  ! {error}"), Role::Error),
            };
            return Some((format!("{NAME_LABEL}{}{text}", dialog.text()), role));
        }
        Some(Dialog::Command(dialog)) if app.notice.is_none() => {
            let candidates = if dialog.candidates.is_empty() {
                String::new()
            } else {
                format!("   {}", dialog.candidates.join(" "))
            };
            return Some((format!(":{}{candidates}", dialog.text()), Role::Text));
        }
        _ => {}
    }
    app.notice.as_ref().map(|notice| match notice {
        Notice::Info(text) => (text.clone(), Role::Key),
        Notice::Refusal(text) => (format!("! {text}"), Role::Error),
    })
}

/// Keys that mean something now, as many as fit.
fn hints(app: &App, buffer: &mut Buffer, panes: &Panes) {
    let mut rest = panes.hints;
    let here = |binding: &&Binding| binding.context == app.context() && !binding.hint.is_empty();
    // Where the descriptors are a page of their own, its key comes first; elsewhere it does nothing.
    let page = |binding: &&Binding| {
        binding
            .keys
            .iter()
            .any(|(_, message)| *message == Message::Page)
    };
    let first = KEYMAP
        .iter()
        .filter(here)
        .filter(page)
        .filter(|_| panes.panel.is_none());
    let bindings = first.chain(KEYMAP.iter().filter(here).filter(|binding| !page(binding)));
    for (index, binding) in bindings.enumerate() {
        let gap = if index == 0 { "" } else { "  " };
        let keys = binding.short_labels();
        let needed = gap.len() + keys.chars().count() + 1 + binding.hint.chars().count();
        if needed > usize::from(rest.width) {
            break;
        }
        let pieces = [
            (gap, Role::Text),
            (keys.as_str(), Role::Key),
            (" ", Role::Text),
            (binding.hint, Role::Quiet),
        ];
        rest = write::right_of(rest, write::line(buffer, rest, app.theme(), pieces));
    }
}
