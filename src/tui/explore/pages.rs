//! The table of pages of the results. A new page is a row here and a variant of [`ExplorePage`].

use crate::tui::explore::message::ExplorePage;
use crate::tui::explore::page::ResultsPage;
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
