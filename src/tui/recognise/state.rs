//! The state of recognition: the set and its model, the touches, the answer to them, the quiz's score.

use std::sync::Arc;

use rand_core::SeedableRng;
use rand_pcg::Pcg64;

use crate::formats::Name;
use crate::imprint::Imprint;
use crate::recognition::{Answer, Evidence};
use crate::storage::ModelChoice;
use crate::tui::explore::message::SweepProgress;
use crate::tui::recognise::message::{Look, PoseSearch, Prepared};
use crate::tui::recognise::separate::state::Separate;
use crate::tui::recognise::trained::TrainedModel;
use crate::tui::widget::number::around;

/// How far the model of the chosen set is.
#[derive(Clone, Debug)]
pub enum ModelState {
    /// There is none: training was stopped, or failed, or never began.
    Missing,
    /// It is being trained or read.
    Preparing(Preparation),
    /// It is there.
    Ready(Arc<TrainedModel>),
}

/// A model on its way.
#[derive(Clone, Debug)]
pub struct Preparation {
    /// The number of the piece of work.
    pub number: u64,
    /// Poses of all shapes, once that is known; a model from a file has none.
    pub poses: Option<u64>,
    /// Poses that are done.
    pub done: u64,
    /// Whether a stop was requested.
    pub stopping: bool,
    /// Whether the page was opened for it.
    opened: bool,
    /// The set that comes back if this one cannot be read.
    before: Option<Box<SetBefore>>,
}

/// Why there is no model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoModel {
    /// In a sentence.
    pub reason: String,
    /// Whether the page closes: it was opened for a set that cannot be read.
    pub closes: bool,
}

/// The set before another one was chosen.
#[derive(Clone, Debug)]
struct SetBefore {
    /// The set.
    choice: ModelChoice,
    /// Its model; None if it had none.
    trained: Option<Arc<TrainedModel>>,
    /// The touches that were kept.
    kept: Vec<Imprint>,
    /// The score of its quiz.
    score: Score,
}

/// How the quiz goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Score {
    /// Shapes that were to be named.
    pub asked: u32,
    /// How many the user named right.
    pub right: u32,
    /// How many the best classifier names right.
    pub best: u32,
}

/// A search in progress.
#[derive(Clone, Debug)]
struct Looking {
    /// The number of the piece of work.
    number: u64,
    /// What is searched.
    search: PoseSearch,
    /// Whether a stop was requested; then nothing is taken from it.
    stopping: bool,
}

/// What to do about the search that the page needs.
#[derive(Clone, Debug)]
pub enum LookStep {
    /// To begin it.
    Begin(Box<PoseSearch>),
    /// To stop the one in progress, which is for something else. The next begins when that one is over, so that there
    /// are never two.
    Stop,
}

/// The state of the page.
#[derive(Clone, Debug)]
pub struct Recognition {
    /// The set.
    choice: ModelChoice,
    /// The names of stored models.
    stored: Vec<Name>,
    /// Its model.
    state: ModelState,
    /// The touches of the shape that were kept.
    kept: Vec<Imprint>,
    /// The imprint on the matrix.
    present: Imprint,
    /// Whether the last kept touch is the one on the matrix.
    present_kept: bool,
    /// The answer to all touches; None without a model or a touch.
    answer: Option<Answer>,
    /// What was searched last, and what was found; None if that failed.
    searched: Option<(PoseSearch, Option<Box<Look>>)>,
    /// The search in progress.
    looking: Option<Looking>,
    /// Whether outlines of poses are shown; None for where taxels are large.
    outlines: Option<bool>,
    /// The page of sizes, while it is closed.
    pub(super) separate: Option<Box<Separate>>,
    /// The score of the quiz.
    pub(super) score: Score,
    /// Where random touches come from.
    pub(super) random: Pcg64,
}

impl Recognition {
    /// The seven figures, without a model yet; random touches come from a seed.
    pub fn new(seed: u64) -> Self {
        Self {
            choice: ModelChoice::Figures,
            stored: Vec::new(),
            state: ModelState::Missing,
            kept: Vec::new(),
            present: Imprint::empty(1, 1),
            present_kept: false,
            answer: None,
            searched: None,
            looking: None,
            outlines: None,
            separate: None,
            score: Score::default(),
            random: Pcg64::seed_from_u64(seed),
        }
    }

    /// Chooses the set that is there at first, without a model.
    pub fn begin_with(&mut self, choice: ModelChoice) {
        self.choice = choice;
    }

    /// The set.
    pub fn choice(&self) -> &ModelChoice {
        &self.choice
    }

    /// How far its model is.
    pub fn state(&self) -> &ModelState {
        &self.state
    }

    /// Its model, once that is there.
    pub fn trained(&self) -> Option<&Arc<TrainedModel>> {
        match &self.state {
            ModelState::Ready(trained) => Some(trained),
            _ => None,
        }
    }

    /// The set that comes `by` further on, the first after the last.
    pub fn other(&self, by: i8) -> ModelChoice {
        let stored = self.stored.iter().cloned().map(ModelChoice::Stored);
        let mut all: Vec<ModelChoice> = ModelChoice::BUILT_IN.into_iter().chain(stored).collect();
        // A stored model that has been deleted stands behind all others.
        if !all.contains(&self.choice) {
            all.push(self.choice.clone());
        }
        let before = all.iter().take_while(|choice| **choice != self.choice);
        let next = around(before.count(), by, all.len());
        all.swap_remove(next)
    }

    /// Chooses a set, whose model is prepared by the piece of work of that number. Touches and score begin anew with
    /// another set. A stored model may be missing or damaged; then the set before it comes back. `opened`: the page was
    /// opened for it. A search that is still in progress is forgotten: its model is left.
    pub fn prepare(&mut self, choice: ModelChoice, number: u64, opened: bool) {
        let state = std::mem::replace(&mut self.state, ModelState::Missing);
        let (mut before, trained) = match state {
            ModelState::Preparing(preparation) => (preparation.before, None),
            ModelState::Ready(trained) => (None, Some(trained)),
            ModelState::Missing => (None, None),
        };
        if choice != self.choice {
            let set = SetBefore {
                choice: std::mem::replace(&mut self.choice, choice),
                trained,
                kept: std::mem::take(&mut self.kept),
                score: std::mem::take(&mut self.score),
            };
            self.present_kept = false;
            before = before.or_else(|| Some(Box::new(set)));
        }
        before = before.filter(|_| self.choice.is_read());
        self.state = ModelState::Preparing(Preparation {
            number,
            poses: None,
            done: 0,
            stopping: false,
            opened,
            before,
        });
        self.searched = None;
        self.looking = None;
        self.ask();
    }

    /// The model on its way, if it is that of a piece of work.
    fn preparation(&mut self, number: u64) -> Option<&mut Preparation> {
        match &mut self.state {
            ModelState::Preparing(preparation) if preparation.number == number => Some(preparation),
            _ => None,
        }
    }

    /// Takes how many poses a training has.
    pub fn take_poses(&mut self, number: u64, poses: u64) {
        if let Some(preparation) = self.preparation(number) {
            preparation.poses = Some(poses);
        }
    }

    /// Takes how far a training is.
    pub fn take_progress(&mut self, number: u64, progress: SweepProgress) {
        if let Some(preparation) = self.preparation(number) {
            preparation.done = progress.poses;
        }
    }

    /// Notes that the model on its way should stop; `false` if there is none, or a stop was requested already.
    pub fn stop(&mut self) -> bool {
        match &mut self.state {
            ModelState::Preparing(preparation) => {
                !std::mem::replace(&mut preparation.stopping, true)
            }
            _ => false,
        }
    }

    /// Notes that the model of a piece of work is not waited for any more.
    pub fn leave_model(&mut self, number: u64) {
        if self.preparation(number).is_some() {
            self.state = ModelState::Missing;
        }
    }

    /// Takes a model. Returns why there is none.
    pub fn take_model(&mut self, prepared: Prepared) -> Option<NoModel> {
        let preparation = self.preparation(prepared.number)?;
        let (before, opened) = (preparation.before.take(), preparation.opened);
        self.stored = prepared.stored;
        let reason = match prepared.trained {
            Ok(trained) => {
                // What was taken for the name of a stored model may be that of a file.
                self.choice = trained.choice.clone();
                self.state = ModelState::Ready(trained);
                self.ask();
                return None;
            }
            Err(reason) => reason,
        };
        self.state = ModelState::Missing;
        let closes = opened && before.is_some();
        if let Some(before) = before {
            self.take_back(*before);
        }
        Some(NoModel { reason, closes })
    }

    /// Goes back to the set before.
    fn take_back(&mut self, before: SetBefore) {
        let SetBefore {
            choice,
            trained,
            kept,
            score,
        } = before;
        self.choice = choice;
        self.present_kept = kept.last() == Some(&self.present);
        (self.kept, self.score) = (kept, score);
        self.state = trained.map_or(ModelState::Missing, ModelState::Ready);
        self.ask();
    }

    /// The touches that the answer is to: those kept, and the one on the matrix unless it is the last of them or empty.
    pub fn touches(&self) -> Vec<Imprint> {
        let present = (!self.present_kept && !self.present.is_empty()).then_some(self.present);
        self.kept.iter().copied().chain(present).collect()
    }

    /// How many touches were kept.
    pub fn kept(&self) -> usize {
        self.kept.len()
    }

    /// The imprint on the matrix.
    pub fn present(&self) -> &Imprint {
        &self.present
    }

    /// The answer; None without a model or a touch.
    pub fn answer(&self) -> Option<&Answer> {
        self.answer.as_ref()
    }

    /// The shape that the answer names.
    fn named(&self) -> Option<usize> {
        self.answer().and_then(|answer| answer.shape)
    }

    /// What was searched of the imprint on the matrix, once that is known. Touches that are kept or forgotten may change the
    /// name; then its pose is searched for anew.
    pub fn look(&self) -> Option<&Look> {
        let (search, look) = self.searched.as_ref()?;
        let is_present = self.search().as_ref() == Some(search);
        look.as_deref().filter(|_| is_present)
    }

    /// The search that the page needs; None without a model or a touch.
    fn search(&self) -> Option<PoseSearch> {
        let trained = Arc::clone(self.trained()?);
        (!self.present.is_empty()).then(|| PoseSearch {
            trained,
            imprint: self.present,
            named: self.named(),
        })
    }

    /// Takes what is on the matrix now.
    pub fn show(&mut self, imprint: Imprint) {
        if imprint != self.present {
            self.present = imprint;
            self.present_kept = false;
            self.ask();
        }
    }

    /// Keeps the touch on the matrix; `false` if it is kept already, or nothing is touched.
    pub fn add_touch(&mut self) -> bool {
        if self.present_kept || self.present.is_empty() {
            return false;
        }
        self.kept.push(self.present);
        self.present_kept = true;
        true
    }

    /// Keeps these touches of a shape in place of all others; the last of them is on the matrix.
    pub fn set_touches(&mut self, touches: Vec<Imprint>) {
        if let Some(&last) = touches.last() {
            self.present = last;
        }
        // One touch is that of the matrix.
        self.present_kept = touches.len() > 1;
        self.kept = if self.present_kept {
            touches
        } else {
            Vec::new()
        };
        self.ask();
    }

    /// Forgets the touches that were kept; `false` if there were none.
    pub fn forget(&mut self) -> bool {
        let any = !self.kept.is_empty();
        self.kept.clear();
        self.present_kept = false;
        self.ask();
        any
    }

    /// Computes the answer again.
    fn ask(&mut self) {
        let touches = self.touches();
        self.answer = match &self.state {
            ModelState::Ready(trained) if !touches.is_empty() => {
                Some(trained.model.recognise(Evidence::of(&touches)))
            }
            _ => None,
        };
    }

    /// What to do about the search that the page needs; None if nothing. Notes that it is done. A search that begins gets
    /// this number.
    pub fn step_look(&mut self, number: u64) -> Option<LookStep> {
        let search = self.search();
        if let Some(looking) = &self.looking {
            let is_needed = search.as_ref() == Some(&looking.search);
            return (!is_needed && self.stop_look()).then_some(LookStep::Stop);
        }
        let search = search?;
        // One that failed is not begun again.
        if (self.searched.as_ref()).is_some_and(|(searched, _)| *searched == search) {
            return None;
        }
        self.looking = Some(Looking {
            number,
            search: search.clone(),
            stopping: false,
        });
        Some(LookStep::Begin(Box::new(search)))
    }

    /// Notes that the search in progress should stop; `false` if there is none, or a stop was requested already.
    pub fn stop_look(&mut self) -> bool {
        let looking = self.looking.as_mut();
        looking.is_some_and(|looking| !std::mem::replace(&mut looking.stopping, true))
    }

    /// Whether outlines of poses are shown; None for where taxels are large.
    pub fn outlines(&self) -> Option<bool> {
        self.outlines
    }

    /// Shows outlines of poses, or hides them.
    pub fn show_outlines(&mut self, shown: bool) {
        self.outlines = Some(shown);
    }

    /// Takes what the search of a number found. Returns why that is nothing, or not all. A search that was stopped or
    /// forgotten is only over.
    pub fn take_look(&mut self, number: u64, found: Result<Box<Look>, String>) -> Option<String> {
        let looking = self.looking.take_if(|looking| looking.number == number);
        let looking = looking.filter(|looking| !looking.stopping)?;
        let refused = match &found {
            Ok(look) => look.refused.clone(),
            Err(reason) => Some(reason.clone()),
        };
        self.searched = Some((looking.search, found.ok()));
        refused
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Has the work of that number prepare a model.
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

    fn found() -> Box<Look> {
        Box::new(Look {
            nearest: None,
            pose: None,
            poses: Vec::new(),
            refused: None,
        })
    }

    #[test]
    fn what_comes_late_of_a_search_in_another_model_changes_nothing() {
        let mut page = Recognition::new(0);
        page.show(touch());
        with_model(&mut page, ModelChoice::Figures, 1);
        assert!(matches!(page.step_look(2), Some(LookStep::Begin(_))));
        assert!(page.step_look(3).is_none(), "it is in progress");
        with_model(&mut page, ModelChoice::Shipped, 4);
        assert!(matches!(page.step_look(5), Some(LookStep::Begin(_))));
        assert_eq!(page.take_look(2, Ok(found())), None);
        assert!(page.look().is_none(), "that was another model");
        assert!(page.step_look(6).is_none(), "the new one is in progress");
        assert_eq!(page.take_look(5, Ok(found())), None);
        assert!(page.look().is_some());
    }

    #[test]
    fn a_search_for_another_imprint_is_stopped_before_the_next_begins() {
        let mut page = Recognition::new(0);
        page.show(touch());
        with_model(&mut page, ModelChoice::Figures, 1);
        assert!(matches!(page.step_look(2), Some(LookStep::Begin(_))));
        let mut other = touch();
        other.set(0, 0, true);
        page.show(other);
        assert!(matches!(page.step_look(3), Some(LookStep::Stop)));
        assert!(page.step_look(3).is_none(), "it was stopped");
        // What a stopped search found is a part, also where the imprint is back.
        page.show(touch());
        assert_eq!(page.take_look(2, Ok(found())), None);
        assert!(page.look().is_none());
        assert!(matches!(page.step_look(3), Some(LookStep::Begin(_))));
    }

    #[test]
    fn a_search_that_fails_says_why_and_is_not_begun_again() {
        let mut page = Recognition::new(0);
        page.show(touch());
        with_model(&mut page, ModelChoice::Figures, 1);
        assert!(matches!(page.step_look(2), Some(LookStep::Begin(_))));
        let failed = page.take_look(2, Err("no thread".to_owned()));
        assert_eq!(failed.as_deref(), Some("no thread"));
        assert!(page.look().is_none(), "nothing is known of the imprint");
        assert!(page.step_look(3).is_none());
    }
}
