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
    let said = said(app, panes);
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
        text += &format!(" + {by_hand} by hand");
    }
    if seen.beyond {
        text += "; reaches beyond the sensor";
    }
    text
}

/// The taxel under the cursor, and how the shape is held. Everything has a place of its own, whatever is before it, and
/// what changes together stands together: so little is sent over the line when the cursor moves.
fn taxel(app: &App, seen: &Seen, panes: &Panes) -> String {
    let (column, row) = app.cursor;
    let wide = |side: u8| (side - 1).to_string().len();
    let (across, down) = (wide(seen.imprint.columns()), wide(seen.imprint.rows()));
    let place = if panes.taxel.width < 60 {
        format!("{column:>across$}, {row:>down$}")
    } else {
        format!("column {column:>across$}, row {row:>down$}")
    };
    let covered = match seen.coverage(column, row) {
        Some(coverage) => format!("  covered {coverage:.6}"),
        None => String::new(),
    };
    let state = if seen.imprint.get(column, row) {
        "active"
    } else {
        "inactive"
    };
    let held = match app.mode {
        Mode::Grab => format!("  held, step {}", app.step.length()),
        Mode::Draw => String::new(),
    };
    format!(
        "{place}{covered}  {state:>8}  NA {} in all{held}",
        seen.imprint.count()
    )
}

/// The question that is asked, or the notice, or what a dialog says of itself.
fn said(app: &App, panes: &Panes) -> Option<(String, Role)> {
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
            return Some((format!("{NAME_LABEL}{}{text}", dialog.field.text()), role));
        }
        Some(Dialog::Command(dialog)) if app.notice.is_none() => {
            let line = format!(":{}", dialog.field.text());
            let room = usize::from(panes.notice.width).saturating_sub(line.chars().count());
            let line = line + &as_many_as_fit(&dialog.candidates, room);
            return Some((line, Role::Text));
        }
        Some(Dialog::Help(help)) if app.notice.is_none() => {
            let room = usize::from(panes.body.height);
            let (lines, top) = help.lines(room);
            let last = lines.len().min(top + room);
            let more = match (top, last == lines.len()) {
                (0, true) => return None,
                (_, true) => "the end",
                (_, false) => "more below: Down, PageDown",
            };
            let text = format!("lines {}-{last} of {}; {more}", top + 1, lines.len());
            return Some((text, Role::Key));
        }
        _ => {}
    }
    app.notice.as_ref().map(|notice| match notice {
        Notice::Info(text) => (text.clone(), Role::Key),
        Notice::Refusal(text) => (format!("! {text}"), Role::Error),
    })
}

/// Words after a gap, and how many more there are where not all of them fit.
fn as_many_as_fit(words: &[String], room: usize) -> String {
    let mut text = String::new();
    for (index, word) in words.iter().enumerate() {
        let gap = if index == 0 { "   " } else { " " };
        let left = words.len() - index;
        // The last one needs no room behind it for what is left then.
        let behind = match left {
            1 => String::new(),
            _ => format!(" … {} more", left - 1),
        };
        let used = text.chars().count() + gap.len() + word.chars().count();
        if used + behind.chars().count() > room {
            return text + &format!("{gap}… {left} more");
        }
        text += gap;
        text += word;
    }
    text
}

/// Keys that mean something now, as many as fit.
fn hints(app: &App, buffer: &mut Buffer, panes: &Panes) {
    let mut rest = panes.hints;
    let here = |binding: &&Binding| binding.context == app.context() && !binding.hint.is_empty();
    // Where the descriptors are a page of their own, its key comes first; elsewhere it does nothing.
    let page = |binding: &&Binding| binding.does(&Message::Page);
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
