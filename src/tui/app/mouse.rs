//! What the mouse does: it points at what keys do elsewhere, and paints taxels.

use crate::tui::app::change::{change, settle};
use crate::tui::app::dialog::Dialog;
use crate::tui::app::hit::{Target, at};
use crate::tui::app::message::{Message, Mouse, MouseKind};
use crate::tui::app::state::App;

/// Lines that a turn of the wheel scrolls.
const WHEEL: i16 = 3;

/// Does what the mouse says, or gives the message that a key would have given. A click beside everything does nothing,
/// and a notice stays.
pub(in crate::tui) fn act(app: &mut App, mouse: Mouse) -> Option<Message> {
    let target = at(app, mouse.column, mouse.row);
    match (mouse.kind, target) {
        (MouseKind::ScrollUp, _) => return scroll(app, -WHEEL),
        (MouseKind::ScrollDown, _) => return scroll(app, WHEEL),
        (MouseKind::Release, _) => app.paint = None,
        (MouseKind::Press, Some(Target::Option(message))) => {
            return app.dialogs.is_empty().then_some(message);
        }
        (MouseKind::Press, Some(Target::Taxel(column, row, whole))) => {
            app.notice = None;
            app.paint = Some((!app.reading().imprint.get(column, row), (column, row)));
            let mut document = app.history.present().clone();
            document.edits.toggle(column, row);
            change(app, document);
            if whole {
                app.cursor = (column, row);
            }
        }
        (MouseKind::Drag, Some(Target::Taxel(column, row, whole))) => {
            if let Some((active, from)) = app.paint {
                app.paint = Some((active, (column, row)));
                paint(app, active, from, (column, row));
                if whole {
                    app.cursor = (column, row);
                }
            }
        }
        (MouseKind::Press, Some(Target::Panel)) => return Some(Message::Region(1)),
        (MouseKind::Press, Some(Target::Kind)) => return Some(Message::ToField(None)),
        (MouseKind::Press, Some(Target::Field(index))) => {
            return Some(Message::ToField(Some(index)));
        }
        (MouseKind::Press, Some(Target::Row(index))) => return point_at_row(app, index),
        (MouseKind::Press, Some(Target::Means(message))) => return Some(message),
        _ => {}
    }
    None
}

/// Sets the taxels of a straight line: over a slow connection a quick drag is told at a few places only. The taxels of a
/// drag are one change: one undo takes all of them back.
fn paint(app: &mut App, active: bool, from: (u8, u8), to: (u8, u8)) {
    let imprint = app.reading().imprint;
    let mut document = app.history.present().clone();
    let steps = from.0.abs_diff(to.0).max(from.1.abs_diff(to.1)).max(1);
    for step in 0..=steps {
        let between = |a: u8, b: u8| {
            let (a, b, step, steps) = (
                i32::from(a),
                i32::from(b),
                i32::from(step),
                i32::from(steps),
            );
            u8::try_from((2 * a * steps + 2 * (b - a) * step + steps) / (2 * steps)).unwrap_or(0)
        };
        let (column, row) = (between(from.0, to.0), between(from.1, to.1));
        if imprint.get(column, row) != active {
            document.edits.toggle(column, row);
        }
    }
    app.history.amend(document);
    settle(app);
}

fn scroll(app: &App, lines: i16) -> Option<Message> {
    let scrolls = matches!(
        app.dialogs.last(),
        Some(Dialog::List(_) | Dialog::Help(_) | Dialog::Results(_))
    );
    scrolls.then_some(Message::Scroll(lines))
}

/// A click selects a row, a click on the selected row takes it.
fn point_at_row(app: &App, index: usize) -> Option<Message> {
    let Some(Dialog::List(list)) = app.dialogs.last() else {
        return None;
    };
    if list.selected() == index {
        return Some(Message::Accept);
    }
    let (to, from) = (
        i16::try_from(index).ok()?,
        i16::try_from(list.selected()).ok()?,
    );
    Some(Message::Scroll(to - from))
}
