//! The map tab: which imprint each x0 and y0 leaves at one angle.
//!
//! ```text
//! letters   a letter, colour or shade for each imprint, different for neighbours
//! layout    cells, rulers, the pose at the cursor
//! visible   the imprints of the visible poses, kept while the same poses stay visible
//! view      draws the map
//! ```

pub mod letters;

pub mod layout;

pub mod visible;

pub mod view;

use ratatui::layout::{Position, Rect};

use crate::pose::Axis;
use crate::tui::app::message::{Endpoint, Message};
use crate::tui::app::page::Wheel;
use crate::tui::explore::map::layout::MapPane;
use crate::tui::explore::message::ExploreMessage;
use crate::tui::explore::results::Results;
use crate::tui::explore::tab::ResultsTab;
use crate::tui::keys::binding::Context;

pub static TAB: ResultsTab = ResultsTab {
    title: "map",
    context: Context::Map,
    filtered: false,
    drawing: Some(view::drawing),
    table: None,
    wheel: Wheel::Rows,
    draw: view::draw,
    click,
    update,
};

fn click(results: &Results, area: Rect, at: Position) -> Option<Message> {
    let (x0, y0) = MapPane::of(area, results).pose(at)?;
    Some(Message::Explore(ExploreMessage::Point(x0, y0)))
}

/// Zooms the map.
fn update(results: &mut Results, message: &Message, area: Rect) {
    let pane = MapPane::of(area, results);
    let stride = i64::try_from(pane.stride).unwrap_or(i64::MAX);
    match *message {
        Message::Cursor(arrow) => {
            let (dx, dy) = arrow.step();
            results.move_along(Axis::X0, i64::from(dx) * stride);
            results.move_along(Axis::Y0, i64::from(dy) * stride);
        }
        Message::Zoom(by) => results.zoom_map(by, pane.closest),
        Message::Scroll(lines) => results.move_along(Axis::Y0, i64::from(lines) * stride),
        Message::ScrollTo(Endpoint::First) => results.move_along(Axis::X0, i64::MIN),
        Message::ScrollTo(Endpoint::Last) => results.move_along(Axis::X0, i64::MAX),
        _ => {}
    }
}
