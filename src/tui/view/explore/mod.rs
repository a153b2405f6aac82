//! Exploring all imprints of a shape: the form, the work, and the pages of what was found.

pub mod ranges;

pub mod running;

pub mod imprints;

pub mod statistics;

pub mod histogram;

pub mod map;

use ratatui::buffer::Buffer;
use ratatui::layout::Position;

use super::write;
use crate::formats::value::{counted, grouped};
use crate::tui::app::App;
use crate::tui::explore::results::Results;
use crate::tui::explore_layout::panes::ResultPanes;
use crate::tui::exploring::{ExplorePage, name_of};
use crate::tui::layout::Panes;
use crate::tui::theme::Role;

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
        ExplorePage::Imprints => imprints::draw(app, results, buffer, parts.page),
        ExplorePage::Statistics => statistics::draw(app, results, buffer, parts.page),
        ExplorePage::Histogram => {
            histogram::draw(app, results, buffer, parts.page);
            None
        }
        ExplorePage::Map => map::draw(app, results, buffer, parts.page),
    }
}

/// How much there is; first of all, whether it is all.
fn summary(results: &Results) -> String {
    let survey = results.survey();
    let poses = if survey.complete() {
        counted(survey.poses, "pose")
    } else {
        format!(
            "a part: {} of {}",
            grouped(survey.poses),
            counted(survey.grid.poses(), "pose")
        )
    };
    let what = name_of(survey.grid.source());
    let distinct = counted(survey.atlas.len() as u64, "distinct imprint");
    format!("{what}: {poses}, {distinct}")
}
