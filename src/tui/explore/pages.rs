//! The table of pages of the results. A new page is a row here and a variant of [`ExplorePage`].

use ratatui::layout::Rect;

use crate::formats::DrawingFormat;
use crate::formats::ending::has_ending;
use crate::tui::explore::message::ExplorePage;
use crate::tui::explore::page::ResultsPage;
use crate::tui::explore::results::Results;
use crate::tui::explore::{angles, histogram, imprints, map, scatter, statistics};

/// Returns the row of a page.
pub fn row(page: ExplorePage) -> &'static ResultsPage {
    match page {
        ExplorePage::Imprints => &imprints::PAGE,
        ExplorePage::Statistics => &statistics::PAGE,
        ExplorePage::Histogram => &histogram::PAGE,
        ExplorePage::Map => &map::PAGE,
        ExplorePage::Scatter => &scatter::PAGE,
        ExplorePage::Angles => &angles::PAGE,
    }
}

/// Returns the content of a file of that name if it holds what the open page shows: its drawing, or the numbers of its
/// table, whose page has this area. None for a file that holds the results of the whole sweep.
///
/// # Errors
/// Returns why the page cannot be drawn.
pub(super) fn file(results: &Results, name: &str, area: Rect) -> Option<Result<Vec<u8>, String>> {
    let page = row(results.page());
    if let Some(format) = DrawingFormat::of_path(name) {
        return Some(match page.drawing {
            Some(drawing) => drawing(results, format),
            None => Err(no_drawing(format)),
        });
    }
    let table = page.table.filter(|_| has_ending(name, "csv"))?;
    Some(Ok(table(results, area).into_bytes()))
}

/// Returns the reason why a page that is a table is not drawn, with the pages that are.
fn no_drawing(format: DrawingFormat) -> String {
    let rows = ExplorePage::ALL.into_iter().map(row);
    let drawn = rows.filter(|row| row.drawing.is_some());
    let titles: Vec<&str> = drawn.map(|row| row.title).collect();
    let titles = titles.join(", ");
    format!("this page has no drawing for .{format}; {titles} have one")
}
