//! What the mouse points at among the results.

use ratatui::layout::Position;

use crate::tui::app::layout::Panes;
use crate::tui::app::message::Message;
use crate::tui::explore::imprints::layout::ImprintList;
use crate::tui::explore::map::layout::MapPane;
use crate::tui::explore::message::{ExploreMessage, ExplorePage};
use crate::tui::explore::panes::ResultPanes;
use crate::tui::explore::results::Results;
use crate::tui::explore::statistics::layout::StatisticsTable;

/// What the mouse means on the screen of results.
pub fn at(panes: &Panes, results: &Results, place: Position) -> Option<Message> {
    let parts = ResultPanes::of(panes);
    let mut tabs = parts.tabs(results.page());
    let tab = tabs.find(|(_, _, area)| area.contains(place));
    if let Some((page, ..)) = tab {
        return Some(Message::Explore(ExploreMessage::Page(page)));
    }
    match results.page() {
        ExplorePage::Imprints => {
            let list = ImprintList::of(parts.page, results);
            let row = list.row(place, results)?;
            Some(if row == results.selected() {
                Message::Accept
            } else {
                Message::Explore(ExploreMessage::Select(row))
            })
        }
        ExplorePage::Statistics => {
            let row = StatisticsTable::of(parts.page, results).row(place)?;
            Some(Message::Explore(ExploreMessage::Select(row)))
        }
        ExplorePage::Histogram => None,
        ExplorePage::Map => {
            let (x0, y0) = MapPane::of(parts.page, results).pose(place)?;
            Some(Message::Explore(ExploreMessage::Point(x0, y0)))
        }
    }
}
