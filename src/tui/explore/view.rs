//! The results of a sweep.
//!
//! ```text
//!  1 imprints   2 statistics   3 histogram   4 map …   a tab for each page; titles only where all of them fit
//! hexagon: 1,000 poses, 87 distinct imprints           what was swept, and how much was found
//!                                                      the page, see the table in `pages`
//! ```
//! Results of a stopped sweep say that they are only a part.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::pose::Axis;
use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot, Wheel};
use crate::tui::explore::map::layout::MapPane;
use crate::tui::explore::message::{ExploreMessage, ExplorePage};
use crate::tui::explore::pages;
use crate::tui::explore::results::Results;
use crate::tui::explore::statistics::StatisticsTable;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::number::narrow;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

impl Page for Results {
    fn context(&self) -> Context {
        pages::row(self.page()).context
    }

    fn slot(&self) -> Slot {
        Slot::Screen
    }

    fn draw(
        &self,
        theme: &Theme,
        _keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let parts = ResultPanes::of(area);
        for area in [parts.tabs, parts.summary, parts.page] {
            write::clear(buffer, area);
        }
        for (page, title, area) in parts.tabs(self.page()) {
            let role = if page == self.page() {
                Role::Focus
            } else {
                Role::Key
            };
            write::line(buffer, area, theme, [(title.as_str(), role)]);
        }
        let summary = self.summary(pages::row(self.page()).filtered);
        write::line(
            buffer,
            parts.summary,
            theme,
            [(summary.as_str(), Role::Text)],
        );
        (pages::row(self.page()).draw)(self, theme, buffer, parts.page)
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let parts = ResultPanes::of(area);
        let mut tabs = parts.tabs(self.page());
        let tab = tabs.find(|(_, _, area)| area.contains(at));
        if let Some((page, ..)) = tab {
            return Some(Message::Explore(ExploreMessage::Page(page)));
        }
        (pages::row(self.page()).click)(self, parts.page, at)
    }

    fn wheel(&self) -> Wheel {
        pages::row(self.page()).wheel
    }

    /// An empty list has nothing to compare, to put onto the matrix or to go to. Scrolling, turning and zooming have
    /// no use if all columns of the statistics are visible, if there is a single angle, or if the map has a single
    /// scale.
    fn has_use_for(&self, message: &Message, area: Rect) -> bool {
        let page = || ResultPanes::of(area).page;
        match (message, self.page()) {
            (Message::Accept | Message::Compare | Message::Explore(ExploreMessage::Follow), _) => {
                self.pose().is_some()
            }
            (Message::Explore(ExploreMessage::Columns(_)), ExplorePage::Statistics) => {
                StatisticsTable::of(page(), self).hides_columns()
            }
            (Message::Explore(ExploreMessage::Angle(_)), _) => {
                self.sweep().grid.counts()[Axis::Angle] > 1
            }
            // The map shows no descriptor.
            (Message::Explore(ExploreMessage::Feature(_)), ExplorePage::Map) => false,
            (Message::Zoom(_), ExplorePage::Map) => MapPane::of(page(), self).closest > 0,
            _ => true,
        }
    }

    /// The update of this page keeps the findings.
    fn cancels_itself(&self) -> bool {
        true
    }
}

/// The parts of the screen that shows results.
#[derive(Clone, Copy, Debug)]
pub struct ResultPanes {
    /// The tabs with the names of the pages.
    pub tabs: Rect,
    /// The summary of the findings.
    pub summary: Rect,
    /// The page.
    pub page: Rect,
}

impl ResultPanes {
    /// Divides an area into the parts.
    pub fn of(area: Rect) -> Self {
        let line = |index: u16| Rect {
            y: area.y + index.min(area.height),
            height: u16::from(index < area.height),
            ..area
        };
        Self {
            tabs: line(0),
            summary: line(1),
            page: write::below(area, 2),
        }
    }

    /// Returns the name of each page, and its place. If there is no room for all names, only the present page has
    /// one.
    pub fn tabs(&self, present: ExplorePage) -> impl Iterator<Item = (ExplorePage, String, Rect)> {
        let area = self.tabs;
        let name = move |page: ExplorePage, number: u16, named: bool| {
            if named || page == present {
                format!(" {number} {} ", pages::row(page).title)
            } else {
                format!(" {number} ")
            }
        };
        let pages = || ExplorePage::ALL.into_iter().zip(1_u16..);
        let all: usize = pages()
            .map(|(page, number)| name(page, number, true).len() + 1)
            .sum();
        let named = all <= usize::from(area.width);
        let mut x = area.x;
        pages().map(move |(page, number)| {
            let text = name(page, number, named);
            let left = x.min(area.right());
            let width = narrow(text.len()).min(area.right() - left);
            x = left + width + 1;
            (
                page,
                text,
                Rect {
                    x: left,
                    width,
                    ..area
                },
            )
        })
    }
}
