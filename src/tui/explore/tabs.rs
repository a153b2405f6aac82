//! The table of tabs of the results. A new tab is a row here and a variant of [`ExploreTab`].

use ratatui::layout::Rect;

use crate::formats::file::has_ending;
use crate::tui::explore::message::ExploreTab;
use crate::tui::explore::results::Results;
use crate::tui::explore::tab::ResultsTab;
use crate::tui::explore::{angles, histogram, imprints, map, scatter, statistics};

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
    let tab = row(results.tab());
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
