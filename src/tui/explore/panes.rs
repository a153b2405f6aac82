//! The screen of results: the names of the pages, how much there is, and the page.

use ratatui::layout::Rect;

use crate::tui::app::layout::{Panes, below};
use crate::tui::explore::message::ExplorePage;
use crate::tui::widget::columns::narrow;

/// The parts of the screen of results.
#[derive(Clone, Copy, Debug)]
pub struct ResultPanes {
    /// The names of the pages.
    pub tabs: Rect,
    /// How much there is.
    pub summary: Rect,
    /// The page.
    pub page: Rect,
}

impl ResultPanes {
    /// All between the menu and the line of notices.
    pub fn of(panes: &Panes) -> Self {
        let area = Rect {
            height: panes.notice.y.saturating_sub(panes.body.y),
            ..panes.body
        };
        let line = |index: u16| Rect {
            y: area.y + index.min(area.height),
            height: u16::from(index < area.height),
            ..area
        };
        Self {
            tabs: line(0),
            summary: line(1),
            page: below(area, 2),
        }
    }

    /// The name of each page, and where it stands. Where there is no room for all names, only the present one has one.
    pub fn tabs(&self, present: ExplorePage) -> impl Iterator<Item = (ExplorePage, String, Rect)> {
        let area = self.tabs;
        let name = move |page: ExplorePage, number: u16, named: bool| {
            if named || page == present {
                format!(" {number} {} ", page.title())
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
