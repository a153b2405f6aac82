//! The lines at the bottom of the screen.
//!
//! ```text
//! ellipse rx 4.00 ry 4.00 at 4.00, 4.00, 0° + 1 by hand              what made the imprint
//! column  8, row  8  1.000000    active  NA 52 in all                the taxel under the cursor: coverage, state
//! saved as washer                                                    a notice, a question, or a prompt
//! Space toggle  u undo  ? help                                       keys that mean something now
//! ```
//! On a low screen, without a title, the name stands before the source. On a lower one the taxel shares its line with
//! notices, and on the lowest the first line is missing. A notice that needs several lines grows upwards.

use ratatui::buffer::Buffer;
use ratatui::layout::Position;

use crate::description::Descriptor;
use crate::formats::value;
use crate::tui::app::document::Reading;
use crate::tui::app::layout::Panes;
use crate::tui::app::menu;
use crate::tui::app::notice;
use crate::tui::app::page::{Page, Slot};
use crate::tui::app::state::App;
use crate::tui::app::title::name;
use crate::tui::keys::action;
use crate::tui::keys::binding::Context;
use crate::tui::widget::theme::Role;
use crate::tui::widget::write;

/// The text after the source if the shape is not wholly on the sensor. It is never shortened; the text before it is.
const BEYOND: &str = "; reaches beyond the sensor";

pub fn draw(app: &App, buffer: &mut Buffer, panes: &Panes) -> Option<Position> {
    let (theme, seen) = (app.theme(), app.reading());
    if !hides_matrix(app) {
        let beyond = if seen.beyond { BEYOND } else { "" };
        let room = usize::from(panes.source.width).saturating_sub(beyond.len());
        let source = source(app, panes);
        let source = theme.text(&source);
        let source = write::fitted(&source, room, theme);
        let in_form = app.pane().map(Page::slot) == Some(Slot::Form);
        let line = if in_form && panes.form_panel.is_none() {
            described(app, seen)
        } else {
            taxel(app, seen)
        };
        let pieces = [&*source, beyond].map(|piece| (piece, Role::Text));
        write::line(buffer, panes.source, theme, pieces);
        write::text(buffer, panes.taxel, theme, &line, Role::Text);
    }
    menu::draw(theme, buffer, &menu::hints(app, panes));
    let prompt = app.top_page();
    let prompt = prompt.filter(|page| page.slot() == Slot::Prompt);
    if let Some(page) = prompt {
        page.draw_over(theme, buffer, panes.body);
    }
    let cursor = prompt.and_then(|page| page.draw(theme, app.keymap(), buffer, panes.notice));
    let top = app.top_page();
    if let Some((text, role)) = notice::notice(app, panes, top) {
        let block = notice::block(app, panes, &text);
        write::clear(buffer, block);
        write::wrapped(buffer, block, theme, &text, role);
    }
    cursor
}

fn hides_matrix(app: &App) -> bool {
    let pages = app.pages().filter(|page| page.has_pane());
    let slots: Vec<Slot> = pages.map(Page::slot).collect();
    match slots.last() {
        Some(Slot::Body) => slots.contains(&Slot::Screen),
        top => top == Some(&Slot::Screen),
    }
}

fn source(app: &App, panes: &Panes) -> String {
    let document = app.shown();
    let by_hand = document.edits.count();
    // Where there is no title, the name stands here.
    let own = name(app).filter(|_| panes.title.height == 0);
    let name = own.map_or(String::new(), |name| format!("{name}: "));
    let Some(source) = &document.source else {
        // The text is the same before and after the first taxel, which saves a dozen bytes then.
        let (draw, figure) = (app.key_of(&action::TOGGLE), app.key_of(&action::FIGURE));
        let place = app.key_of(&action::PICTURE);
        let origin = app.history.origin();
        let (made, keys) = match origin.brought_by.as_deref() {
            _ if app.loaded_imprint().is_some() => (
                "stored shape",
                format!("{place} moves and turns it, {draw} draws"),
            ),
            // An imprint from elsewhere is there to be read, not to be drawn on.
            Some(brought_by) if !app.reading().imprint.is_empty() => {
                return name + brought_by;
            }
            brought_by => (
                brought_by.unwrap_or("drawn by hand"),
                format!("{draw} draws, {figure} places a figure"),
            ),
        };
        // Over most pages these keys do something else.
        return if app.context().leads_to(Context::Matrix) {
            format!("{name}{made}: {keys}")
        } else {
            name + made
        };
    };
    let mut text = name + &source.to_string();
    if by_hand > 0 {
        text += &format!(" + {by_hand} by hand");
    }
    text
}

/// Returns the main descriptors. A form that covers all descriptors leaves these visible, so that the user sees them
/// change with each key.
fn described(app: &App, seen: &Reading) -> String {
    let all = format!("NA {} in all", seen.imprint.count());
    let Some(description) = seen.description(app.chosen()) else {
        return all;
    };
    let text = |key: &&str| {
        let descriptor = Descriptor::from_key(key)?;
        let text = value::text((descriptor.measure)(&description), descriptor.dimension)?;
        Some(format!("{} {text}", descriptor.symbol))
    };
    let main = ["na", "nae", "p", "f"].iter().filter_map(text);
    // If the region is the whole imprint, its own count says so.
    let rest = description.na != seen.imprint.count();
    let all = rest.then_some(all);
    main.chain(all).collect::<Vec<_>>().join("  ")
}

/// Returns the line about the taxel under the cursor and the step of moving. Every part has a fixed place, and parts
/// that change together stand together: so little is sent over the line when the cursor moves.
fn taxel(app: &App, seen: &Reading) -> String {
    let all = format!("NA {} in all", seen.imprint.count());
    // The step of moving and zooming, if there is a shape to move.
    let held = if app.held.is_some() { "held, " } else { "" };
    let step = app.shown().source.as_ref();
    let step = step.map_or(String::new(), |_| {
        format!("{held}step {}", app.step.length())
    });
    let (column, row) = app.cursor();
    let wide = |side: u8| (side - 1).to_string().len();
    let (across, down) = (wide(seen.imprint.columns()), wide(seen.imprint.rows()));
    let active = seen.imprint.get(column, row);
    let state = format!("{:>8}", if active { "active" } else { "inactive" });
    let covered = seen.coverage(column, row);
    let covered = covered.map_or(String::new(), |coverage| format!("covered {coverage:.6}"));
    let place = format!("column {column:>across$}, row {row:>down$}");
    let mut pieces = vec![place, covered, state, all, step];
    pieces.retain(|piece| !piece.is_empty());
    pieces.join("  ")
}
