//! The searches for poses that may have left an imprint: which one is needed, in progress, or done.
//!
//! There are never two at a time: one that is no longer needed is stopped, and the next begins after it has ended.

use crate::tui::recognise::message::{PoseSearch, PoseSearchResult};

#[derive(Clone, Debug)]
pub enum SearchStep {
    Begin(Box<PoseSearch>),
    Stop,
}

#[derive(Clone, Debug)]
struct RunningSearch {
    number: u64,
    search: PoseSearch,
    /// Whether a stop was requested; then its result is dropped.
    stopping: bool,
}

/// The search in progress, and the last one that has ended. `needed` is the search that the page needs now; None
/// without a model or a touch.
#[derive(Clone, Debug, Default)]
pub(super) struct PoseSearches {
    /// The last search and its result; None if it failed.
    ended: Option<(PoseSearch, Option<Box<PoseSearchResult>>)>,
    running: Option<RunningSearch>,
}

impl PoseSearches {
    /// Forgets the search in progress, which is about a model that was replaced: its result is dropped.
    pub(super) fn forget_running(&mut self) {
        self.running = None;
    }

    pub(super) fn forget_result(&mut self) {
        self.ended = None;
    }

    pub(super) fn found(&self, needed: Option<&PoseSearch>) -> Option<&PoseSearchResult> {
        let (search, found) = self.ended.as_ref()?;
        found.as_deref().filter(|_| needed == Some(search))
    }

    pub(super) fn is_searching(&self, needed: Option<&PoseSearch>) -> bool {
        let ended = self.ended.as_ref().map(|(search, _)| search);
        self.running.is_some() || ended != needed
    }

    /// Returns the next step for the needed search, and records it; None if there is nothing to do. A search that
    /// begins gets this number.
    pub(super) fn step(&mut self, needed: Option<PoseSearch>, number: u64) -> Option<SearchStep> {
        if let Some(running) = &self.running {
            let is_needed = needed.as_ref() == Some(&running.search);
            return (!is_needed && self.stop()).then_some(SearchStep::Stop);
        }
        let search = needed?;
        // A search that failed is not begun again.
        if (self.ended.as_ref()).is_some_and(|(ended, _)| *ended == search) {
            return None;
        }
        self.running = Some(RunningSearch {
            number,
            search: search.clone(),
            stopping: false,
        });
        Some(SearchStep::Begin(Box::new(search)))
    }

    /// Requests that the search in progress stops; returns false if there is none, or if a stop was requested
    /// already.
    pub(super) fn stop(&mut self) -> bool {
        let running = self.running.as_mut();
        running.is_some_and(|running| !std::mem::replace(&mut running.stopping, true))
    }

    pub(super) fn take_result(
        &mut self,
        number: u64,
        found: Result<Box<PoseSearchResult>, String>,
    ) -> Option<String> {
        let running = self.running.take_if(|running| running.number == number);
        let running = running.filter(|running| !running.stopping)?;
        let refused = match &found {
            Ok(found) => found.refused.clone(),
            Err(reason) => Some(reason.clone()),
        };
        self.ended = Some((running.search, found.ok()));
        refused
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::imprint::Imprint;
    use crate::storage::ModelChoice;
    use crate::tui::recognise::trained::TrainedModel;

    fn search(rows: &str) -> PoseSearch {
        PoseSearch {
            trained: Arc::new(TrainedModel::of_a_bar(ModelChoice::Figures)),
            imprint: rows.parse::<Imprint>().expect("an imprint"),
            named: None,
        }
    }

    #[test]
    fn a_search_for_another_imprint_is_stopped_before_the_next_begins() {
        let (one, other) = (Some(search("##")), Some(search("#.")));
        let mut searches = PoseSearches::default();
        assert!(matches!(
            searches.step(one.clone(), 2),
            Some(SearchStep::Begin(_))
        ));
        assert!(matches!(
            searches.step(other.clone(), 3),
            Some(SearchStep::Stop)
        ));
        assert!(searches.step(other, 3).is_none(), "it was stopped");
        // The result of a stopped search is incomplete, even if the same imprint is on the matrix again.
        assert_eq!(
            searches.take_result(2, Ok(PoseSearchResult::of_nothing())),
            None
        );
        assert!(searches.found(one.as_ref()).is_none());
        assert!(matches!(searches.step(one, 3), Some(SearchStep::Begin(_))));
    }

    #[test]
    fn a_failed_search_gives_its_reason_and_is_not_repeated() {
        let one = Some(search("##"));
        let mut searches = PoseSearches::default();
        assert!(matches!(
            searches.step(one.clone(), 2),
            Some(SearchStep::Begin(_))
        ));
        let failed = searches.take_result(2, Err("no thread".to_owned()));
        assert_eq!(failed.as_deref(), Some("no thread"));
        assert!(
            searches.found(one.as_ref()).is_none(),
            "nothing is known of the imprint"
        );
        assert!(searches.step(one, 3).is_none());
    }
}
