//! The effects of the mouse: it paints taxels, and otherwise does what a key would, also on the lines that name keys.
//!
//! A press on a taxel switches it, and a drag from there gives all taxels on its way the same state, as one change. A
//! press on a piece that is not described chooses it; a second press switches its taxel.
//! Where two taxels share a character, a press switches the one with the cursor, otherwise the upper one. On a page,
//! the page itself decides what a click means ([`crate::tui::app::page::Page::click`]).

use ratatui::layout::{Position, Rect};

use crate::tui::app::change::{change, settle};
use crate::tui::app::message::{Message, Mouse, MouseKind};
use crate::tui::app::page::{Page, Slot, Wheel};
use crate::tui::app::state::{App, NarrowPane};
use crate::tui::app::{menu, status};
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
    Key(Message),
    /// A taxel: column, row, and whether the whole matrix is visible, so that the cursor may go there without
    /// scrolling it.
    Taxel(u8, u8, bool),
    Panel,
    Page(Message),
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
                app.paint = Some(Paint {
                    from: (column, row),
                    begun: true,
                    ..own
                });
                if whole {
                    app.cursor = (column, row);
                }
            }
        }
        (MouseKind::Press, Some(Target::Panel)) => return Some(Message::Region(1)),
        (MouseKind::Press, Some(Target::Key(message) | Target::Page(message))) => {
            return Some(message);
        }
        _ => {}
    }
    None
}

/// The taxels of a drag are one change: one undo takes all of them back.
fn paint(
    app: &mut App,
    Paint {
        active,
        from,
        begun,
    }: Paint,
    to: (u8, u8),
) {
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
            taxels((2 * a * steps + 2 * (b - a) * step + steps) / (2 * steps))
        };
        let (column, row) = (between(from.0, to.0), between(from.1, to.1));
        if imprint.get(column, row) != active {
            document.edits.toggle(column, row);
        }
    }
    if begun {
        app.history.amend(document);
        settle(app);
    } else {
        change(app, document);
    }
}

/// Returns the message of a notch of the wheel, up if negative; None if there is nothing to scroll.
fn scroll(app: &App, notch: i16) -> Option<Message> {
    let top = app.top_page();
    let lines = top.map_or(Wheel::Idle, Page::wheel).lines()?;
    Some(Message::Scroll(notch * lines))
}

fn at(app: &App, column: u16, row: u16) -> Option<Target> {
    let panes = app.panes()?;
    let place = Position::new(column, row);
    let inside = |area: Rect| area.contains(place);
    let items = match place {
        _ if inside(panes.menu) => Some(menu::menu(app, panes.menu)),
        _ if inside(panes.hints) => Some(menu::hints(app, &panes)),
        _ => None,
    };
    if let Some(items) = items {
        let mut meanings = items.iter().map(|item| item.click(place));
        return meanings.find_map(|meaning| meaning).map(Target::Key);
    }
    if let Some(page) = app.top_page() {
        // A narrow screen shows the matrix or the panel.
        let hidden = page.slot() == Slot::Panel
            && panes.panel.is_none()
            && app.narrow_pane == NarrowPane::Matrix;
        let area = status::page_area(app, &panes, page);
        if inside(area) && !hidden {
            return page.click(area, place).map(Target::Page);
        }
        if !page.leaves_matrix() {
            return None;
        }
    }
    let beside = panes.panel;
    if beside.is_some_and(inside) {
        return Some(Target::Panel);
    }
    // On a small screen the descriptors may have the place of the matrix.
    if beside.is_none() && app.narrow_pane == NarrowPane::Panel {
        return inside(panes.content).then_some(Target::Panel);
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
