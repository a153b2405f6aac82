//! The effects of the mouse: it paints taxels, and otherwise does what a key would, also on the lines that name keys.
//!
//! A press on a taxel switches it, and a drag from there gives all taxels on its way the same state, as one change. A
//! press on a piece that is not described chooses it; a second press switches its taxel.
//! Where two taxels share a character, a press switches the one with the cursor, otherwise the upper one. On a page,
//! the page itself decides what a click means ([`crate::tui::app::page::Page::click`]).

use ratatui::layout::{Position, Rect};

use crate::tui::app::{App, Message, Mouse, MouseKind, Place, change, menu, settle, status};
use crate::tui::keys::Context;
use crate::tui::widget::write::taxels;

/// A drag over the taxels.
#[derive(Clone, Copy, Debug)]
pub struct Paint {
    active: bool,
    from: (u8, u8),
    /// Whether a taxel was switched already.
    begun: bool,
}

#[derive(Clone, Debug, PartialEq)]
enum Target {
    Message(Message),
    /// A taxel: column, row, and whether the whole matrix is visible, so that the cursor may go there without
    /// scrolling it.
    Taxel(u8, u8, bool),
}

/// Handles an event of the mouse, or returns the message that a key would have sent. A click on nothing does nothing,
/// and a notice stays.
pub(in crate::tui) fn act(app: &mut App, mouse: Mouse) -> Option<Message> {
    let target = at(app, mouse.column, mouse.row);
    match (mouse.kind, target) {
        (MouseKind::ScrollUp, _) => return scroll(app, -1),
        (MouseKind::ScrollDown, _) => return scroll(app, 1),
        (MouseKind::Release, _) => app.paint = None,
        (MouseKind::Press, Some(Target::Taxel(column, row, whole))) => {
            app.begin_action();
            let (reading, from) = (app.reading(), (column, row));
            let active = !reading.imprint.get(column, row);
            let described = reading.region(app.chosen()).map(|(index, _)| index);
            let mut pieces = reading.regions.iter();
            let piece = pieces.position(|piece| piece.taxels().get(column, row));
            let other = piece.filter(|_| !active && piece != described);
            let begun = other.is_none();
            app.paint = Some(Paint {
                active,
                from,
                begun,
            });
            if begun {
                let mut document = app.history.present().clone();
                document.edits.toggle(column, row);
                change(app, document);
            } else {
                app.history.choose(other);
            }
            if whole {
                app.cursor = (column, row);
            }
        }
        (MouseKind::Drag, Some(Target::Taxel(column, row, whole))) => {
            let moved = |paint: &Paint| paint.from != (column, row);
            if let Some(own) = app.paint.filter(moved) {
                paint(app, own, (column, row));
                if whole {
                    app.cursor = (column, row);
                }
            }
        }
        (MouseKind::Press, Some(Target::Message(message))) => return Some(message),
        _ => {}
    }
    None
}

/// The taxels of a drag are one change: one undo takes all of them back.
fn paint(app: &mut App, own: Paint, to: (u8, u8)) {
    let from = own.from;
    let imprint = app.reading().imprint;
    let mut document = app.history.present().clone();
    let steps = from.0.abs_diff(to.0).max(from.1.abs_diff(to.1)).max(1);
    for step in 0..=steps {
        let between = |a: u8, b: u8| {
            let [a, b, step, steps] = [a, b, step, steps].map(i32::from);
            taxels((2 * a * steps + 2 * (b - a) * step + steps) / (2 * steps))
        };
        let (column, row) = (between(from.0, to.0), between(from.1, to.1));
        if imprint.get(column, row) != own.active {
            document.edits.toggle(column, row);
        }
    }
    if own.begun {
        app.history.amend(document);
        settle(app);
    } else {
        change(app, document);
    }
    app.paint = Some(Paint {
        from: to,
        begun: true,
        ..own
    });
}

/// Returns the message of a notch of the wheel, up if negative; None if there is nothing to scroll.
fn scroll(app: &App, notch: i16) -> Option<Message> {
    let lines = app.top_page().map_or(0, |page| page.wheel() as i16);
    (lines > 0).then_some(Message::Scroll(notch * lines))
}

fn at(app: &App, column: u16, row: u16) -> Option<Target> {
    let panes = app.panes()?;
    let at = Position::new(column, row);
    let inside = |area: Rect| area.contains(at);
    let items = match at {
        _ if inside(panes.menu) => Some(menu::menu(app, panes.menu)),
        _ if inside(panes.hints) => Some(menu::hints(app, &panes)),
        _ => None,
    };
    if let Some(items) = items {
        return items
            .iter()
            .find_map(|item| item.click(at))
            .map(Target::Message);
    }
    if let Some(page) = app.top_page() {
        // A narrow screen shows the matrix or the panel.
        let hidden = page.place() == Place::Panel && panes.panel.is_none() && !app.shows_panel;
        let area = status::page_area(app, &panes, page);
        if inside(area) && !hidden {
            return page.click(area, at).map(Target::Message);
        }
        if page.context() != Context::Recognise {
            return None;
        }
    }
    // On a small screen the descriptors may have the place of the matrix.
    let narrow = Some(panes.content).filter(|_| app.shows_panel);
    let panel = panes.panel.or(narrow);
    if panel.is_some_and(inside) {
        return Some(Target::Message(Message::Region(1)));
    }
    let grid = app.grid().filter(|_| inside(panes.matrix))?;
    // Of two that share a character, the one with the cursor is meant, otherwise the upper one.
    let cursor = app.cursor();
    let own = grid.at(column, row).find(|&taxel| taxel == cursor);
    let (column, row) = own.or_else(|| grid.at(column, row).next())?;
    Some(Target::Taxel(column, row, grid.is_whole()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::app::change::begin_drawn;
    use crate::tui::app::state::Options;
    use crate::tui::app::update::update;

    #[test]
    fn a_drag_ends_when_another_document_comes() {
        let mut app = App::new(&Options::plain(true));
        let places = (0..24).flat_map(|row| (0..80).map(move |column| (column, row)));
        let is_taxel =
            |&(column, row): &(u16, u16)| matches!(at(&app, column, row), Some(Target::Taxel(..)));
        let taxels: Vec<(u16, u16)> = places.filter(is_taxel).collect();
        let (first, last) = (taxels[0], taxels[taxels.len() - 1]);
        let mouse = |kind, (column, row)| Message::Mouse(Mouse { kind, column, row });
        update(&mut app, mouse(MouseKind::Press, first));
        let drawn = app.reading().imprint;
        update(&mut app, mouse(MouseKind::Drag, last));
        assert!(app.reading().imprint.count() > drawn.count());
        app.jobs.later(move |app| {
            let sensor = app.history.present().sensor;
            begin_drawn(app, sensor, &drawn, "another");
        });
        update(&mut app, Message::Answered);
        update(&mut app, mouse(MouseKind::Drag, first));
        assert_eq!(app.reading().imprint, drawn);
    }
}
