//! The results of a sweep.
//!
//! ```text
//!  1 imprints   2 statistics   3 histogram   4 map …   the tabs
//! hexagon: 1,000 poses, 87 distinct imprints           what was swept, and how much was found
//!                                                      the open tab, see the table in `tabs`
//! ```
//! Results of a stopped sweep say that they are only a part.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::pose::Axis;
use taxel_files::formats::file::has_ending;

use crate::tui::app::message::Message;
use crate::tui::app::page::{Flow, Page, Slot, Wheel};
use crate::tui::app::state::App;
use crate::tui::explore::map::layout::MapPane;
use crate::tui::explore::message::{ExploreMessage, ExploreTab};
use crate::tui::explore::results::Results;
use crate::tui::explore::update::in_results;
use crate::tui::explore::{angles, histogram, imprints, map, scatter, statistics};
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::widget::rows::moved;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};

impl Page for Results {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        in_results(self, app, message)
    }

    fn closed(self: Box<Self>, app: &mut App) {
        app.results = Some(self);
    }

    fn context(&self) -> Context {
        row(self.tab).context
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
        for (tab, title, area) in parts.titles() {
            let role = if tab == self.tab {
                Role::Focus
            } else {
                Role::Key
            };
            write::text(buffer, area, theme, &title, role);
        }
        let summary = self.summary(row(self.tab).filtered);
        write::text(buffer, parts.summary, theme, &summary, Role::Text);
        (row(self.tab).draw)(self, theme, buffer, parts.tab)
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let parts = ResultPanes::of(area);
        let mut tabs = parts.titles();
        let tab = tabs.find(|(_, _, area)| area.contains(at));
        if let Some((tab, ..)) = tab {
            return Some(Message::Explore(ExploreMessage::Tab(tab)));
        }
        (row(self.tab).click)(self, parts.tab, at)
    }

    fn wheel(&self) -> Wheel {
        row(self.tab).wheel
    }

    /// Scrolling, turning and zooming have no use if there is a single
    /// angle, or if the map has a single scale.
    fn has_use_for(&self, message: &Message, area: Rect) -> bool {
        let tab = || ResultPanes::of(area).tab;
        match (message, self.tab) {
            (Message::Accept | Message::Compare | Message::Explore(ExploreMessage::Follow), _) => {
                self.pose().is_some()
            }
            (Message::Explore(ExploreMessage::Angle(_)), _) => {
                self.sweep().grid.counts()[Axis::Angle] > 1
            }
            // The map shows no descriptor.
            (Message::Explore(ExploreMessage::Feature(_)), ExploreTab::Map) => false,
            (Message::Zoom(_), ExploreTab::Map) => MapPane::of(tab(), self).closest > 0,
            _ => true,
        }
    }

    fn cancels_itself(&self) -> bool {
        true
    }
}

#[derive(Clone, Copy, Debug)]
pub struct ResultPanes {
    pub titles: Rect,
    pub summary: Rect,
    pub tab: Rect,
}

impl ResultPanes {
    pub fn of(area: Rect) -> Self {
        let line = |index: u16| Rect {
            y: area.y + index.min(area.height),
            height: u16::from(index < area.height),
            ..area
        };
        Self {
            titles: line(0),
            summary: line(1),
            tab: write::below(area, 2),
        }
    }

    pub fn titles(&self) -> impl Iterator<Item = (ExploreTab, String, Rect)> {
        let area = self.titles;
        let mut x = area.x;
        ExploreTab::ALL
            .into_iter()
            .zip(1_u16..)
            .map(move |(tab, number)| {
                let text = format!(" {number} {} ", row(tab).title);
                let left = x.min(area.right());
                let width = narrow(text.len()).min(area.right() - left);
                x = left + width + 1;
                (
                    tab,
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

pub fn row(tab: ExploreTab) -> &'static ResultsTab {
    match tab {
        ExploreTab::Imprints => &imprints::TAB,
        ExploreTab::Statistics => &statistics::TAB,
        ExploreTab::Histogram => &histogram::TAB,
        ExploreTab::Map => &map::TAB,
        ExploreTab::Scatter => &scatter::TAB,
        ExploreTab::Angles => &angles::TAB,
    }
}

/// None for a file that holds the results of the whole sweep.
pub(super) fn file(results: &Results, name: &str, area: Rect) -> Option<Result<Vec<u8>, String>> {
    let tab = row(results.tab);
    if has_ending(name, "svg") {
        return Some(match tab.drawing {
            Some(drawing) => drawing(results).map(String::into_bytes),
            None => Err(no_drawing()),
        });
    }
    let table = tab.table.filter(|_| has_ending(name, "csv"))?;
    Some(Ok(table(results, area).into_bytes()))
}

fn no_drawing() -> String {
    let rows = ExploreTab::ALL.into_iter().map(row);
    let drawn = rows.filter(|row| row.drawing.is_some());
    let titles: Vec<&str> = drawn.map(|row| row.title).collect();
    let titles = titles.join(", ");
    format!("this page has no drawing for .svg; {titles} have one")
}

type TabDrawing = fn(&Results) -> Result<String, String>;

pub(super) const NOTHING_TO_DRAW: &str = "there is nothing to draw";

/// The functions get the area of the tab.
#[derive(Debug)]
pub struct ResultsTab {
    pub title: &'static str,
    pub context: Context,
    pub filtered: bool,
    pub drawing: Option<TabDrawing>,
    /// The field is None for tabs with a drawing, and for the list of imprints, whose file has all imprints.
    pub table: Option<fn(&Results, Rect) -> String>,
    pub wheel: Wheel,
    pub draw: fn(&Results, &Theme, &mut Buffer, Rect) -> Option<Position>,
    pub click: fn(&Results, Rect, Position) -> Option<Message>,
    pub update: fn(&mut Results, &Message, Rect),
}

pub(in crate::tui) fn choose_descriptor(results: &mut Results, message: &Message, _area: Rect) {
    if let Some(row) = moved(results.feature, message) {
        results.choose_feature(row);
    }
}
