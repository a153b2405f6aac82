//! The lines at the foot: what made the imprint, the taxel under the cursor, notices and questions, hints.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::formats::NameError;
use crate::tui::app::dialog::Dialog;
use crate::tui::app::document::Reading;
use crate::tui::app::layout::Panes;
use crate::tui::app::message::Message;
use crate::tui::app::state::{App, Mode, Notice};
use crate::tui::explore::export::ENDINGS;
use crate::tui::keys::action;
use crate::tui::keys::binding::{Binding, Context};
use crate::tui::widget::theme::Role;
use crate::tui::widget::write;

/// What stands before the name to store under.
const NAME_LABEL: &str = "Save as: ";

/// What stands before the name of a file to write.
const EXPORT_LABEL: &str = "Export to: ";

/// What is said where the shape is not wholly on the sensor. It stays where what is before it has to be shortened.
const BEYOND: &str = "; reaches beyond the sensor";

/// Draws all of them; answers where the cursor is, where a name or a command is typed.
pub fn draw(app: &App, seen: &Reading, buffer: &mut Buffer, panes: &Panes) -> Option<Position> {
    let theme = app.theme();
    // Results have the place of what is said of the matrix.
    if !matches!(app.pane(), Some(Dialog::Results(_))) {
        let beyond = if seen.beyond { BEYOND } else { "" };
        let room = usize::from(panes.source.width).saturating_sub(beyond.len());
        let source = source(app);
        let source = theme.text(&source);
        let source = write::fitted(&source, room, theme);
        let pieces = [&*source, beyond].map(|piece| (piece, Role::Text));
        write::line(buffer, panes.source, theme, pieces);
        write::line(
            buffer,
            panes.taxel,
            theme,
            [(taxel(app, seen, panes).as_str(), Role::Text)],
        );
    }
    hints(app, buffer, panes);
    let cursor = match app.dialogs.last() {
        Some(Dialog::Name(dialog)) => {
            let typed = (NAME_LABEL, dialog.field.text(), dialog.field.cursor());
            Some(field(app, typed, "", buffer, panes.notice))
        }
        Some(Dialog::Command(dialog)) => {
            let typed = (":", dialog.field.text(), dialog.field.cursor());
            let used = 1 + write::width(dialog.field.text());
            let room = usize::from(panes.notice.width).saturating_sub(used);
            let candidates = as_many_as_fit(&dialog.candidates, room);
            Some(field(app, typed, &candidates, buffer, panes.notice))
        }
        Some(Dialog::Export(dialog)) => {
            let typed = (EXPORT_LABEL, dialog.field.text(), dialog.field.cursor());
            let endings = format!("   ({ENDINGS})");
            Some(field(app, typed, &endings, buffer, panes.notice))
        }
        _ => None,
    };
    if let Some((text, role)) = said(app, panes) {
        // What is typed keeps its line, and what is said about it stands above.
        let last = Rect {
            y: panes.notice.y - u16::from(cursor.is_some()),
            ..panes.notice
        };
        let lines = write::broken(&theme.text(&text), usize::from(last.width)).len();
        let room = last.bottom().saturating_sub(panes.body.y);
        let height = u16::try_from(lines).unwrap_or(room).clamp(1, room.max(1));
        let block = Rect {
            y: last.bottom() - height,
            height,
            ..last
        };
        write::clear(buffer, block);
        write::wrapped(buffer, block, theme, &text, role);
    }
    cursor
}

/// A label, what is typed and what follows; answers where the cursor is. Of a text that is too long the part before the
/// cursor is shown.
fn field(
    app: &App,
    (label, text, cursor): (&str, &str, usize),
    after: &str,
    buffer: &mut Buffer,
    area: Rect,
) -> Position {
    write::clear(buffer, area);
    let room = usize::from(area.width).saturating_sub(label.len());
    let (shown, column) = write::window(text, cursor, room);
    let pieces = [label, shown, after].map(|piece| (piece, Role::Text));
    write::line(buffer, area, app.theme(), pieces);
    let column = u16::try_from(label.len() + column).unwrap_or(u16::MAX);
    Position::new(area.x.saturating_add(column), area.y)
}

/// What made the imprint.
fn source(app: &App) -> String {
    let document = app.shown();
    let by_hand = document.edits.count();
    let name = app.stored_name().map_or(String::new(), |stored| {
        let changed = if app.unsaved() { "*" } else { "" };
        format!("{stored}{changed}: ")
    });
    let Some(source) = &document.source else {
        return name
            + &if by_hand == 0 {
                let (draw, figure) = (app.key_of(&action::TOGGLE), app.key_of(&action::FIGURE));
                format!("empty: {draw} draws, {figure} places a figure")
            } else {
                "drawn by hand".to_owned()
            };
    };
    let mut text = name + &source.to_string();
    if by_hand > 0 {
        text += &format!(" + {by_hand} by hand");
    }
    text
}

/// The taxel under the cursor, and how the shape is held. Everything has a place of its own, whatever is before it, and
/// what changes together stands together: so little is sent over the line when the cursor moves.
fn taxel(app: &App, seen: &Reading, panes: &Panes) -> String {
    let (column, row) = app.cursor();
    let wide = |side: u8| (side - 1).to_string().len();
    let (across, down) = (wide(seen.imprint.columns()), wide(seen.imprint.rows()));
    let place = format!("{column:>across$}, {row:>down$}");
    let state = if seen.imprint.get(column, row) {
        "active"
    } else {
        "inactive"
    };
    let coverage = seen.coverage(column, row);
    let all = format!("NA {} in all", seen.imprint.count());
    // The step of what moves and zooms the shape, where there is one.
    let step = match (app.shown().source, app.mode) {
        (None, _) => String::new(),
        (Some(_), Mode::Draw) => format!("step {}", app.step.length()),
        (Some(_), Mode::Grab) => format!("held, step {}", app.step.length()),
    };
    let width = usize::from(panes.taxel.width);
    if width >= if step.is_empty() { 60 } else { 80 } {
        let place = format!("column {column:>across$}, row {row:>down$}");
        let covered = coverage.map(|coverage| format!("  covered {coverage:.6}"));
        let covered = covered.unwrap_or_default();
        let gap = if step.is_empty() { "" } else { "  " };
        return format!("{place}{covered}  {state:>8}  {all}{gap}{step}");
    }
    // What can be found elsewhere gives way first; no word is cut.
    let coverage = coverage.map(|coverage| format!("{coverage:.6}"));
    let coverage = coverage.unwrap_or_default();
    let line = |pieces: &[&str]| {
        let pieces = pieces.iter().filter(|piece| !piece.is_empty());
        pieces.copied().collect::<Vec<_>>().join("  ")
    };
    let state = format!("{state:>8}");
    let lines = [
        line(&[&place, &coverage, &state, &step, &all]),
        line(&[&place, &coverage, &state, &step]),
        line(&[&place, &state, &step]),
    ];
    write::first_fitting(&lines.each_ref().map(String::as_str), width).to_owned()
}

/// The question that is asked, what is wrong with a name, or the notice.
fn said(app: &App, panes: &Panes) -> Option<(String, Role)> {
    match app.dialogs.last() {
        Some(Dialog::Question(question)) => {
            let key = |answer| app.keymap().label(Context::Question, answer);
            let answers = match question.no {
                Some(_) => String::new(),
                None => format!(" ({}/{})", key(&action::ACCEPT), key(&action::DECLINE)),
            };
            return Some((format!("{}{answers}", question.text), Role::Error));
        }
        Some(Dialog::Name(dialog)) if app.notice.is_none() => {
            let error = dialog.name().err();
            let error = error.filter(|error| *error != NameError::Empty)?;
            return Some((format!("! {error}"), Role::Error));
        }
        Some(Dialog::Help(help)) if app.notice.is_none() => {
            let (lines, top) = help.lines(app.keymap(), panes.body.as_size().into());
            let last = lines.len().min(top + usize::from(panes.body.height));
            let key = |action| app.keymap().label(Context::Help, action);
            let more = match (top, last == lines.len()) {
                (0, true) => return None,
                (_, true) => "the end".to_owned(),
                (_, false) => format!(
                    "more below: {}, {}",
                    key(&action::SCROLL_DOWN),
                    key(&action::PAGE_DOWN)
                ),
            };
            let text = format!("lines {}-{last} of {}; {more}", top + 1, lines.len());
            // A second line would lie over the last one of the list.
            let short = format!("{last} of {}", lines.len());
            let fitting = write::first_fitting(&[&text, &short], panes.notice.width.into());
            return Some((fitting.to_owned(), Role::Key));
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
    let context = app.context();
    let screen = context.screen().unwrap_or(context);
    let here = |binding: &&Binding| !binding.hint.is_empty() && !binding.keys.is_empty();
    let hinted = |context| app.keymap().of(context).filter(here);
    let own = || hinted(context).chain(hinted(screen).filter(move |_| screen != context));
    // Where the descriptors are a page of their own, its key comes first; elsewhere it does nothing.
    let page = |binding: &&Binding| binding.does(&Message::SwitchPage);
    let first = own().filter(page).filter(|_| panes.panel.is_none());
    let bindings = first.chain(own().filter(|binding| !page(binding)));
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
