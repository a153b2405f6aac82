//! Exploring all imprints of a shape: the form, the work, and the pages of what was found.

use crate::tui::explore::{histogram, imprints, map, statistics};
use ratatui::buffer::Buffer;
use ratatui::layout::Position;

use crate::formats::value::{counted, grouped};
use crate::tui::app::layout::Panes;
use crate::tui::app::state::App;
use crate::tui::explore::message::{ExplorePage, name_of};
use crate::tui::explore::panes::ResultPanes;
use crate::tui::explore::results::Results;
use crate::tui::widget::theme::Role;
use crate::tui::widget::write;

/// Draws the results; answers where the cursor is.
pub fn draw(app: &App, results: &Results, buffer: &mut Buffer, panes: &Panes) -> Option<Position> {
    let parts = ResultPanes::of(panes);
    for area in [parts.tabs, parts.summary, parts.page] {
        write::clear(buffer, area);
    }
    for (page, title, area) in parts.tabs(results.page()) {
        let role = if page == results.page() {
            Role::Focus
        } else {
            Role::Key
        };
        write::line(buffer, area, app.theme(), [(title.as_str(), role)]);
    }
    let pieces = [(summary(results), Role::Text)];
    let pieces = pieces.iter().map(|(text, role)| (text.as_str(), *role));
    write::line(buffer, parts.summary, app.theme(), pieces);
    match results.page() {
        ExplorePage::Imprints => imprints::view::draw(app, results, buffer, parts.page),
        ExplorePage::Statistics => statistics::view::draw(app, results, buffer, parts.page),
        ExplorePage::Histogram => {
            histogram::view::draw(app, results, buffer, parts.page);
            None
        }
        ExplorePage::Map => map::view::draw(app, results, buffer, parts.page),
    }
}

/// How much there is; first of all, whether it is all.
fn summary(results: &Results) -> String {
    let result = results.sweep();
    let poses = if result.complete() {
        counted(result.poses, "pose")
    } else {
        format!(
            "a part: {} of {}",
            grouped(result.poses),
            counted(result.grid.poses(), "pose")
        )
    };
    let what = name_of(result.grid.source());
    let distinct = counted(result.atlas.len() as u64, "distinct imprint");
    format!("{what}: {poses}, {distinct}")
}
