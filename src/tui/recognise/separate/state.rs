//! The state of the page of sizes: the results so far, the size under the cursor, the work in progress.

use std::sync::Arc;

use crate::formats::file::has_ending;
use crate::formats::separation::{SeparationCurve, csv, drawing};
use crate::recognition::{SeparationPoint, SmallestSize};
use crate::tui::app::message::Message;
use crate::tui::recognise::message::{SizeFound, SizesFound};
use crate::tui::recognise::separate::request::SeparationRequest;
use crate::tui::widget::rows::moved;

/// The wanted errors that keys can choose.
const WANTED: [f64; 11] = [
    0.0, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5,
];

/// The work in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeWork {
    /// The number of the piece of work.
    pub number: u64,
    /// The number of touches of a size.
    touches: u64,
    /// The number of touches that were done before it began.
    before: u64,
    /// The number of touches that are done.
    pub done: u64,
    /// The number of touches of all sizes.
    pub all: u64,
    /// The wanted error of its search.
    wanted: f64,
    /// Whether a stop was requested.
    pub stopping: bool,
}

/// The state of the work: the sizes that are still without results, and the search for the smallest size that reaches
/// the wanted error.
#[derive(Clone, Debug)]
enum Search {
    /// It is to begin.
    Waiting,
    /// It is in progress.
    Running(SizeWork),
    /// It was stopped, or failed: then it continues only on request.
    Stopped,
    /// It is done: the smallest size; None if no size reaches the wanted error.
    Done(Option<SmallestSize>),
}

/// The page of sizes.
#[derive(Clone, Debug)]
pub struct Separate {
    /// The request that the page answers.
    request: Arc<SeparationRequest>,
    /// The results, the smallest size first.
    found: Vec<SizeFound>,
    /// The state of the work.
    search: Search,
    /// The row of the table under the cursor.
    cursor: usize,
    /// Whether the user has moved the cursor; until then it goes to the wanted size.
    moved: bool,
}

impl Separate {
    /// Creates a page without results.
    pub fn new(request: SeparationRequest) -> Self {
        Self {
            request: Arc::new(request),
            found: Vec::new(),
            search: Search::Waiting,
            cursor: 0,
            moved: false,
        }
    }

    /// Returns the request that the page answers.
    pub fn request(&self) -> &Arc<SeparationRequest> {
        &self.request
    }

    /// Returns the results, the smallest size first.
    pub fn found(&self) -> &[SizeFound] {
        &self.found
    }

    /// Returns the row of the table under the cursor.
    pub fn cursor(&self) -> usize {
        self.cursor
    }

    /// Returns the result for the size under the cursor.
    pub fn selected(&self) -> Option<&SizeFound> {
        self.found.get(self.cursor)
    }

    /// Returns the smallest size that reaches the wanted error, or None inside if there is none; None if it was not
    /// searched for.
    pub fn smallest(&self) -> Option<Option<&SmallestSize>> {
        match &self.search {
            Search::Done(smallest) => Some(smallest.as_ref()),
            _ => None,
        }
    }

    /// Returns the work in progress.
    pub fn work(&self) -> Option<&SizeWork> {
        match &self.search {
            Search::Running(work) => Some(work),
            _ => None,
        }
    }

    /// Returns the work in progress, to change it.
    fn running(&mut self) -> Option<&mut SizeWork> {
        match &mut self.search {
            Search::Running(work) => Some(work),
            _ => None,
        }
    }

    /// Begins the remaining work under a number: the sizes without results, and the search. Returns the request and
    /// the known points; None while work is in progress, after it was stopped, or if there is nothing to do.
    pub fn begin(&mut self, number: u64) -> Option<(Arc<SeparationRequest>, Vec<SeparationPoint>)> {
        if !matches!(self.search, Search::Waiting) {
            return None;
        }
        let [before, all] = [self.found.len(), self.request.values().len()];
        let touches = self.request.separation().map_or(0, |set| set.touches());
        self.search = Search::Running(SizeWork {
            number,
            touches,
            before: touches * before as u64,
            done: touches * before as u64,
            all: touches * all as u64,
            wanted: self.request.wanted,
            stopping: false,
        });
        Some((Arc::clone(&self.request), self.points()))
    }

    /// Returns the known points.
    fn points(&self) -> Vec<SeparationPoint> {
        self.found.iter().map(|size| size.point.clone()).collect()
    }

    /// Records the progress of the work with this number.
    pub fn take_progress(&mut self, number: u64, done: u64) {
        if let Some(work) = self.running().filter(|work| work.number == number) {
            work.done = work.before + done;
        }
    }

    /// Allows stopped work to continue; returns false if none was stopped.
    pub fn go_on(&mut self) -> bool {
        let stopped = matches!(self.search, Search::Stopped);
        if stopped {
            self.search = Search::Waiting;
        }
        stopped
    }

    /// Requests that the work stops; returns false if there is none, or if a stop was requested already.
    pub fn stop(&mut self) -> bool {
        let work = self.running();
        work.is_some_and(|work| !std::mem::replace(&mut work.stopping, true))
    }

    /// Gives up the work in progress, for when the page closes: its further results are dropped.
    pub fn leave(&mut self) {
        if self.work().is_some() {
            self.search = Search::Stopped;
        }
    }

    /// Takes over results. Returns the reason if the work ended early.
    pub fn take_found(&mut self, found: SizesFound) -> Option<String> {
        let sizes = self.found.len() + found.sizes.len();
        let work = self.running().filter(|work| work.number == found.number)?;
        // Progress is reported now and then, results at once.
        work.done = work.done.max(work.touches * sizes as u64);
        let wanted = work.wanted;
        self.found.extend(found.sizes);
        match found.end? {
            // Another error may have been chosen meanwhile.
            Ok(_) if wanted != self.request.wanted => self.search = Search::Waiting,
            Ok(smallest) => self.search = Search::Done(smallest),
            Err(reason) => {
                self.search = Search::Stopped;
                return Some(reason);
            }
        }
        self.go_to_wanted();
        None
    }

    /// Puts the cursor onto the first size that reaches the wanted error, or else onto the last size, unless the user
    /// has moved it.
    fn go_to_wanted(&mut self) {
        if !self.moved {
            let wanted = self.request.wanted;
            let reaches = |size: &SizeFound| size.point.error() <= wanted;
            let first = self.found.iter().position(reaches);
            self.cursor = first.unwrap_or(self.found.len().saturating_sub(1));
        }
    }

    /// Chooses the next larger wanted error of the list, or the next smaller one if `by` is negative.
    pub fn want(&mut self, by: i8) {
        let now = self.request.wanted;
        let next = match by {
            0.. => WANTED.iter().copied().find(|error| *error > now),
            _ => WANTED.iter().rev().copied().find(|error| *error < now),
        };
        let Some(wanted) = next else { return };
        let request = SeparationRequest {
            wanted,
            ..(*self.request).clone()
        };
        self.want_as(request);
    }

    /// Takes over the wanted error from a request for the same sizes.
    pub fn want_as(&mut self, request: SeparationRequest) {
        if self.request.wanted != request.wanted {
            if self.work().is_none() {
                self.search = Search::Waiting;
            }
            self.moved = false;
        }
        self.request = Arc::new(request);
        self.go_to_wanted();
    }

    /// Moves the cursor.
    pub fn take(&mut self, message: &Message) {
        if let Some(row) = moved(self.cursor, message) {
            self.cursor = row.min(self.found.len().saturating_sub(1));
            self.moved = true;
        }
    }

    /// Returns the content of a file with this name, whose extension decides between numbers and curves.
    ///
    /// # Errors
    /// Returns what was expected of the name.
    pub fn file(&self, name: &str) -> Result<Vec<u8>, String> {
        let request = &self.request;
        let curves = [SeparationCurve {
            threshold: request.threshold,
            points: self.points(),
            smallest: self.smallest().flatten().cloned(),
        }];
        if has_ending(name, "csv") {
            return Ok(csv(request.axis, &curves).into_bytes());
        }
        if !has_ending(name, "svg") {
            return Err("expected a name that ends in .csv or .svg".to_owned());
        }
        let plot = drawing(request.axis, &curves, Some(request.wanted));
        Ok(plot.svg().into_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::ToTheEnd;
    use crate::storage::ModelChoice;
    use crate::tui::recognise::separate::request::SeparationFlags;
    use crate::tui::recognise::trained::TrainedModel;

    /// The bar stands beside the number of sizes that are found, perhaps by earlier work.
    #[test]
    fn the_progress_is_at_least_that_of_the_sizes_that_are_found() {
        let trained = Arc::new(TrainedModel::of_a_bar(ModelChoice::Figures));
        let mut page = Separate::new(SeparationFlags::NONE.request(trained));
        let request = Arc::clone(page.request());
        let set = request.separation().expect("a set");
        let point = set.at(request.axis, 0.5, request.threshold, &ToTheEnd);
        let size = SizeFound {
            point: point.expect("not stopped"),
            worst: None,
        };
        let found = |number, end| SizesFound {
            number,
            sizes: vec![size.clone()],
            end,
        };
        let done = |page: &Separate| {
            let work = page.work().expect("in progress");
            assert_eq!(work.all, 26 * set.touches());
            work.done / set.touches()
        };
        assert!(page.begin(1).is_some());
        assert_eq!(done(&page), 0);
        assert_eq!(page.take_found(found(1, None)), None);
        assert_eq!(done(&page), 1);
        let stopped = found(1, Some(Err("stopped".to_owned())));
        assert!(page.take_found(stopped).is_some() && page.go_on());
        assert!(page.begin(2).is_some());
        assert_eq!(done(&page), 2);
        page.take_progress(2, set.touches());
        assert_eq!(done(&page), 3);
    }
}
