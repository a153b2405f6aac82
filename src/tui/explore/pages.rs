//! The table of pages of the results, in the order of their tabs. A new page is a row here and a variant of
//! [`ExplorePage`].

use crate::tui::explore::message::ExplorePage;
use crate::tui::explore::page::ResultsPage;
use crate::tui::explore::{angles, histogram, imprints, map, scatter, statistics};

/// All pages, a row for each.
pub static PAGES: [&ResultsPage; ExplorePage::ALL.len()] = [
    &imprints::PAGE,
    &statistics::PAGE,
    &histogram::PAGE,
    &map::PAGE,
    &scatter::PAGE,
    &angles::PAGE,
];

/// Returns the row of a page.
pub fn row(page: ExplorePage) -> &'static ResultsPage {
    PAGES[page as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_page_has_its_row_at_its_index() {
        for page in ExplorePage::ALL {
            assert_eq!(row(page).page, page);
        }
    }
}
