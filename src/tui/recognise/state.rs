//! The state of recognition: the set and its model, the touches, the answer to them, the quiz's score.

use std::sync::Arc;

use rand_core::SeedableRng;
use rand_pcg::Pcg64;

use crate::formats::Name;
use crate::imprint::Imprint;
use crate::recognition::{Answer, Evidence};
use crate::tui::explore::message::SweepProgress;
use crate::tui::recognise::message::{Look, Prepared};
use crate::tui::recognise::separate::state::Separate;
use crate::tui::recognise::sets::{ModelChoice, TrainedModel};
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
    /// What was searched last.
    look: Option<Box<Look>>,
    /// Whether a search is under way.
    looking: bool,
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
            look: None,
            looking: false,
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
    /// opened for it.
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
        self.look = None;
        self.looking = false;
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
        let look = self.look.as_deref()?;
        let trained = self.trained()?;
        let same = look.imprint == self.present && look.named == self.named();
        (same && Arc::ptr_eq(&look.trained, trained)).then_some(look)
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

    /// The imprint to search for next, with the shape whose pose is wanted; None while a search is under way, or where
    /// there is nothing to search for. Notes that it is under way.
    pub fn begin_look(&mut self) -> Option<(Arc<TrainedModel>, Imprint, Option<usize>)> {
        let trained = Arc::clone(self.trained()?);
        if self.looking || self.present.is_empty() || self.look().is_some() {
            return None;
        }
        self.looking = true;
        Some((trained, self.present, self.named()))
    }

    /// Notes that a search failed, so that this imprint is not searched for again.
    pub fn fail_look(&mut self) {
        if let Some(trained) = self.trained().cloned() {
            self.take_look(Look {
                trained,
                imprint: self.present,
                named: self.named(),
                nearest: None,
                pose: None,
                poses: Vec::new(),
            });
        }
    }

    /// Whether outlines of poses are shown; None for where taxels are large.
    pub fn outlines(&self) -> Option<bool> {
        self.outlines
    }

    /// Shows outlines of poses, or hides them.
    pub fn show_outlines(&mut self, shown: bool) {
        self.outlines = Some(shown);
    }

    /// Takes what was searched.
    pub fn take_look(&mut self, look: Look) {
        self.looking = false;
        self.look = Some(Box::new(look));
    }
}
