//! The state of recognition: the set and its model, the touches, the answer about them.

use std::sync::Arc;

use rand_core::SeedableRng;
use rand_pcg::Pcg64;
use taxel_core::imprint::Imprint;
use taxel_core::recognition::{Answer, Evidence, Nearest, PlacedSource, PoseEstimate};
use taxel_core::sensor::MatrixSize;
use taxel_core::source::Source;
use taxel_files::formats::Name;
use taxel_files::storage::ModelChoice;

use crate::tui::explore::message::SweepProgress;
use crate::tui::recognise::trained::TrainedModel;
use crate::tui::widget::write::other;

#[derive(Clone, Debug)]
pub enum ModelState {
    /// There is none: training was stopped, failed or was never begun.
    Missing,
    Preparing(Preparation),
    Ready(Arc<TrainedModel>),
}

#[derive(Clone, Debug)]
pub struct Preparation {
    pub number: u64,
    /// The number of poses of all shapes, once it is known; None for a model from a file.
    pub poses: Option<u64>,
    pub done: u64,
    pub stopping: bool,
    request: Option<RecogniseMessage>,
    known: Option<Arc<TrainedModel>>,
    opened: bool,
    /// The set to return to if this one cannot be read.
    before: Option<Box<SetBefore>>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoModel {
    pub reason: String,
    /// Whether the page closes, because it was opened for a set that cannot be read.
    pub closes: bool,
    pub prepares_again: bool,
}

#[derive(Clone, Debug)]
struct SetBefore {
    choice: ModelChoice,
    /// The model of the set; None if it had none.
    trained: Option<Arc<TrainedModel>>,
    preparing: bool,
}

#[derive(Clone, Debug)]
pub struct Recognition {
    choice: ModelChoice,
    /// The set that could not be read last: the next step through the sets goes on from there.
    unreadable: Option<ModelChoice>,
    pub(in crate::tui) stored: Vec<Name>,
    state: ModelState,
    kept: Vec<Imprint>,
    present: Imprint,
    /// The shape that left it, in its pose; None if no shape did.
    source: Option<Source>,
    /// The threshold at which a shape touched the matrix; None if no shape does.
    pub(in crate::tui) threshold: Option<f64>,
    kept_source: Option<Source>,
    present_kept: bool,
    /// The answer about all touches; None without a model or a touch.
    answer: Option<Answer>,
    searches: PoseSearches,
    /// Whether outlines of poses are shown; None shows them if taxels are large.
    pub(in crate::tui) outlines: Option<bool>,
    pub(super) random: Pcg64,
}

impl Recognition {
    /// Creates the state with the seven figures, without a model; random touches come from a seed.
    pub fn new(seed: u64) -> Self {
        Self {
            choice: ModelChoice::Figures,
            unreadable: None,
            stored: Vec::new(),
            state: ModelState::Missing,
            kept: Vec::new(),
            present: Imprint::empty(MatrixSize::SMALLEST),
            source: None,
            threshold: None,
            kept_source: None,
            present_kept: false,
            answer: None,
            searches: PoseSearches::default(),
            outlines: None,
            random: Pcg64::seed_from_u64(seed),
        }
    }

    pub fn begin_with(&mut self, choice: ModelChoice) {
        self.choice = choice;
    }

    pub fn choice(&self) -> &ModelChoice {
        &self.choice
    }

    pub fn state(&self) -> &ModelState {
        &self.state
    }

    pub fn trained(&self) -> Option<&Arc<TrainedModel>> {
        match &self.state {
            ModelState::Ready(trained) => Some(trained),
            _ => None,
        }
    }

    /// Returns the set `by` places after the chosen one, or after one that could not be read since; after the last set
    /// comes the first.
    pub fn other(&self, by: i8) -> ModelChoice {
        let stored = self.stored.iter().cloned().map(ModelChoice::Stored);
        let all = ModelChoice::BUILT_IN
            .iter()
            .cloned()
            .chain(stored)
            .collect();
        other(all, &self.choice, self.unreadable.as_ref(), by)
    }

    /// Chooses a set, whose model is prepared by the work with this number. Kept touches stay, so that sets can be
    /// compared. A stored model may be missing or damaged; then the earlier
    /// set returns. `opened`: whether the page was opened for this set. A search in progress is forgotten, because it
    /// is about the old model.
    pub fn prepare(&mut self, choice: ModelChoice, number: u64, opened: bool) {
        let state = std::mem::replace(&mut self.state, ModelState::Missing);
        let (mut before, trained, preparing) = match state {
            ModelState::Preparing(now) => (now.before, now.known, !now.stopping),
            ModelState::Ready(trained) => (None, Some(trained), false),
            ModelState::Missing => (None, None, false),
        };
        let known = trained.clone().filter(|_| choice == self.choice);
        if choice != self.choice {
            let set = SetBefore {
                choice: std::mem::replace(&mut self.choice, choice),
                trained,
                preparing,
            };
            self.searches.ended = None;
            before = before.or_else(|| Some(Box::new(set)));
        }
        before = before.filter(|_| self.choice.is_read());
        self.state = ModelState::Preparing(Preparation {
            number,
            poses: None,
            done: 0,
            stopping: false,
            request: None,
            known,
            opened,
            before,
        });
        self.searches.running = None;
        self.ask();
    }

    fn preparation(&mut self, number: u64) -> Option<&mut Preparation> {
        match &mut self.state {
            ModelState::Preparing(preparation) if preparation.number == number => Some(preparation),
            _ => None,
        }
    }

    pub fn take_poses(&mut self, number: u64, poses: u64) {
        if let Some(preparation) = self.preparation(number) {
            preparation.poses = Some(poses);
        }
    }

    pub fn take_progress(&mut self, number: u64, progress: SweepProgress) {
        if let Some(preparation) = self.preparation(number) {
            preparation.done = progress.poses;
        }
    }

    /// Requests that the preparation stops; returns false if there is none, or if a stop was requested already.
    pub fn stop(&mut self) -> bool {
        match &mut self.state {
            ModelState::Preparing(preparation) => {
                !std::mem::replace(&mut preparation.stopping, true)
            }
            _ => false,
        }
    }

    /// Records a request that is carried out once the model that is being prepared is ready. Returns false if none is,
    /// or if a stop was requested.
    pub fn request_later(&mut self, request: RecogniseMessage) -> bool {
        match &mut self.state {
            ModelState::Preparing(preparation) if !preparation.stopping => {
                preparation.request = Some(request);
                true
            }
            _ => false,
        }
    }

    /// Forgets the request that waits for the model: the user does something else now.
    pub fn withdraw(&mut self) {
        if let ModelState::Preparing(preparation) = &mut self.state {
            preparation.request = None;
        }
    }

    pub fn take_request(&mut self, number: u64) -> Option<RecogniseMessage> {
        self.preparation(number)?.request.take()
    }

    pub fn take_model(&mut self, prepared: Prepared) -> Option<NoModel> {
        self.preparation(prepared.number)?;
        self.stored = prepared.stored;
        match prepared.trained {
            Ok(trained) => {
                // What was given as the name of a stored model may be that of a file.
                self.choice = trained.choice.clone();
                self.unreadable = None;
                self.state = ModelState::Ready(trained);
                self.ask();
                None
            }
            Err(reason) => self.fail(prepared.number, reason),
        }
    }

    pub fn fail(&mut self, number: u64, reason: String) -> Option<NoModel> {
        let preparation = self.preparation(number)?;
        let (before, opened) = (preparation.before.take(), preparation.opened);
        let stopping = preparation.stopping;
        self.state = ModelState::Missing;
        let mut failed = NoModel {
            reason,
            closes: false,
            prepares_again: false,
        };
        if let Some(before) = before {
            failed.closes = opened;
            failed.prepares_again = before.preparing && !opened && !stopping;
            self.take_back(*before);
        }
        Some(failed)
    }

    fn take_back(&mut self, before: SetBefore) {
        self.unreadable = Some(std::mem::replace(&mut self.choice, before.choice));
        self.state = before
            .trained
            .map_or(ModelState::Missing, ModelState::Ready);
        self.ask();
    }

    /// Returns the touches that the answer is about: the kept ones, and the one on the matrix unless it is empty or
    /// is the last kept one.
    pub fn touches(&self) -> Vec<Imprint> {
        let present = (!self.present_kept && !self.present.is_empty()).then_some(self.present);
        self.kept.iter().copied().chain(present).collect()
    }

    pub fn kept(&self) -> usize {
        self.kept.len()
    }

    pub fn is_kept(&self) -> bool {
        self.present_kept
    }

    pub fn present(&self) -> &Imprint {
        &self.present
    }

    /// Returns the answer; None without a model or a touch.
    pub fn answer(&self) -> Option<&Answer> {
        self.answer.as_ref()
    }

    fn named(&self) -> Option<usize> {
        self.answer().and_then(|answer| answer.shape)
    }

    /// Returns the result of the search for the imprint on the matrix, once it is known. Keeping or forgetting
    /// touches may change the name; then a new search for its poses begins.
    pub fn found(&self) -> Option<&PoseSearchResult> {
        self.searches.found(self.search().as_ref())
    }

    pub fn is_searching(&self) -> bool {
        self.searches.is_searching(self.search().as_ref())
    }

    /// Returns the search that the page needs; None without a model or a touch.
    fn search(&self) -> Option<PoseSearch> {
        let trained = Arc::clone(self.trained()?);
        (!self.present.is_empty()).then(|| PoseSearch {
            trained,
            imprint: self.present,
            named: self.named(),
        })
    }

    /// Returns the threshold at which a shape touched the matrix, if the model was trained at another one: the imprints
    /// of the model are then not those of this sensor.
    pub fn other_threshold(&self) -> Option<f64> {
        let trained = self.trained()?.model.sensor().threshold();
        self.threshold.filter(|&threshold| threshold != trained)
    }

    pub fn show(&mut self, imprint: Imprint, source: Option<&Source>) {
        if imprint != self.present || source != self.source.as_ref() {
            (self.present, self.source) = (imprint, source.cloned());
            let is_last = self.kept.last() == Some(&self.present);
            self.present_kept = is_last && self.kept_source == self.source;
            self.ask();
        }
    }

    /// Keeps the touch on the matrix; returns false if it is kept already, or if nothing is touched.
    pub fn add_touch(&mut self) -> bool {
        if self.present_kept || self.present.is_empty() {
            return false;
        }
        self.kept.push(self.present);
        self.kept_source = self.source.clone();
        self.present_kept = true;
        true
    }

    /// Forgets the kept touches; returns false if there were none.
    pub fn forget(&mut self) -> bool {
        let any = !self.kept.is_empty();
        self.kept.clear();
        self.present_kept = false;
        self.ask();
        any
    }

    fn ask(&mut self) {
        let touches = self.touches();
        self.answer = match &self.state {
            ModelState::Ready(trained) if !touches.is_empty() => {
                Some(trained.model.recognise(Evidence::of(&touches)))
            }
            _ => None,
        };
    }

    /// Returns the next step for the search that the page needs, and records it; None if there is nothing to do. A
    /// search that begins gets this number.
    pub fn step_search(&mut self, number: u64) -> Option<SearchStep> {
        self.searches.step(self.search(), number)
    }

    /// Requests that the search in progress stops; returns false if there is none, or if a stop was requested
    /// already.
    pub fn stop_search(&mut self) -> bool {
        self.searches.stop()
    }

    /// Returns whether outlines of poses are shown; None shows them if taxels are large.
    pub fn outlines(&self) -> Option<bool> {
        self.outlines
    }

    pub fn take_result(
        &mut self,
        number: u64,
        found: Result<Box<PoseSearchResult>, String>,
    ) -> Option<String> {
        self.searches.take_result(number, found)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum RecogniseMessage {
    Open,
    Choose(ModelChoice),
    NextModel(i8),
    Touch,
    Keep,
    Forget,
    Poses,
    Confusion,
    Seed(u64),
    /// Selects a cell of the confusion matrix: row, column.
    SelectCell(usize, usize),
}

#[derive(Clone, Debug, PartialEq)]
pub struct PoseSearch {
    pub trained: Arc<TrainedModel>,
    pub imprint: Imprint,
    /// The index of the shape that the answer names; None if it names none.
    pub named: Option<usize>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct PoseSearchResult {
    pub nearest: Option<Nearest>,
    /// The index of the named shape, or of the nearest imprint's shape if none is named, and the poses in which it
    /// leaves the nearest imprint.
    pub pose: Option<(usize, PoseEstimate)>,
    pub poses: Vec<PlacedSource>,
    pub refused: Option<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    pub number: u64,
    pub(in crate::tui) stored: Vec<Name>,
    pub trained: Result<Arc<TrainedModel>, String>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum RecognitionEvent {
    /// A training began: its number, and its number of poses.
    Begun(u64, u64),
    Prepared(Box<Prepared>),
    /// The search with this number has ended: its result, or the reason why it failed.
    Searched(u64, Result<Box<PoseSearchResult>, String>),
}

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
    pub(in crate::tui) ended: Option<(PoseSearch, Option<Box<PoseSearchResult>>)>,
    running: Option<RunningSearch>,
}

impl PoseSearches {
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
    use taxel_core::imprint::Imprint;
    use taxel_files::storage::ModelChoice;

    use super::*;

    fn with_model(page: &mut Recognition, choice: ModelChoice, number: u64) {
        page.prepare(choice.clone(), number, false);
        let prepared = Prepared {
            number,
            stored: Vec::new(),
            trained: Ok(Arc::new(TrainedModel::of_a_bar(choice))),
        };
        assert_eq!(page.take_model(prepared), None);
    }

    fn touch() -> Imprint {
        "........\n.######.\n.######.\n........"
            .parse()
            .expect("an imprint")
    }

    #[test]
    fn a_training_that_made_way_for_a_damaged_model_begins_again() {
        let mut page = Recognition::new(0);
        let damaged = ModelChoice::File("damaged.npz".into());
        page.prepare(ModelChoice::Shipped, 1, false);
        page.prepare(damaged.clone(), 2, false);
        let failed = page.fail(2, "damaged".to_owned());
        assert!(failed.is_some_and(|failed| failed.prepares_again));
        // A training that was stopped does not.
        page.prepare(ModelChoice::Shipped, 3, false);
        assert!(page.stop());
        page.prepare(damaged, 4, false);
        let failed = page.fail(4, "damaged".to_owned());
        assert!(failed.is_some_and(|failed| !failed.prepares_again));
    }

    #[test]
    fn kept_touches_outlast_the_choice_of_another_set() {
        let mut page = Recognition::new(0);
        page.show(touch(), None);
        with_model(&mut page, ModelChoice::Figures, 1);
        assert!(page.add_touch());
        with_model(&mut page, ModelChoice::Shipped, 2);
        assert_eq!(page.touches(), [touch()]);
    }
}
