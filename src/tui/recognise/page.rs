//! The page of recognition: the set and its model, the touches, and what keys do. Its state outlasts the page.

use std::sync::Arc;

use rand_core::SeedableRng;
use rand_pcg::Pcg64;
use ratatui::layout::{Position, Rect};
use taxel_core::imprint::Imprint;
use taxel_core::recognition::Answer;
use taxel_core::sensor::MatrixSize;
use taxel_core::source::Source;
use taxel_files::storage::ModelChoice;

use crate::naming::Terms;
use crate::tui::app::{
    App, Canvas, Flow, Message, Page, Place, Placed, Wheel, begin_drawn, inform, refuse,
};
use crate::tui::jobs::{self, answer};
use crate::tui::keys::{Context, action};
use crate::tui::matrix;
use crate::tui::recognise::panel;
use crate::tui::recognise::trained::TrainedModel;
use crate::tui::recognise::{RecogniseMessage, next_model};

pub(crate) struct Recognition {
    pub(crate) choice: ModelChoice,
    /// The model of that set; None if it was not asked for yet, or could not be had.
    trained: Option<Arc<TrainedModel>>,
    /// Another set, or the same one, whose model is read or trained.
    pub(super) preparing: Option<Preparation>,
    pub(super) kept: Vec<Imprint>,
    /// The touch on the matrix.
    pub(super) present: Imprint,
    /// The threshold at which a shape touched the matrix.
    threshold: Option<f64>,
    pub(crate) terms: Terms,
    /// The answer about all touches.
    pub(super) answer: Option<Answer>,
    /// The shape of the answer, fitted to the touch on the matrix.
    pub(crate) fitted: Option<Source>,
    /// What it leaves there; if nothing is fitted, the nearest imprint of the model.
    like: Option<Imprint>,
    random: Pcg64,
}

pub(super) struct Preparation {
    pub(super) choice: ModelChoice,
    /// Whether a random touch is made once the model is ready, unless the user does something else meanwhile.
    then_touches: bool,
    /// Whether the page was opened for this set: it closes if the set cannot be read.
    opened: bool,
}

impl Recognition {
    /// Begins with the shapes of the library, without a model; random touches come from a seed.
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            choice: ModelChoice::Library,
            trained: None,
            preparing: None,
            kept: Vec::new(),
            present: Imprint::empty(MatrixSize::SMALLEST),
            threshold: None,
            terms: Terms::default(),
            answer: None,
            fitted: None,
            like: None,
            random: Pcg64::seed_from_u64(seed),
        }
    }

    pub(super) fn choice(&self) -> &ModelChoice {
        let preparing = self.preparing.as_ref();
        preparing.map_or(&self.choice, |preparing| &preparing.choice)
    }

    /// Returns the model that answers: none while another one is prepared.
    pub(crate) fn model(&self) -> Option<&Arc<TrainedModel>> {
        self.trained.as_ref().filter(|_| self.preparing.is_none())
    }

    /// Returns the kept touches, and the one on the matrix unless it is empty or is the last kept one.
    pub(super) fn touches(&self) -> Vec<Imprint> {
        let present = self.is_new_touch().then_some(self.present);
        self.kept.iter().copied().chain(present).collect()
    }

    pub(super) fn is_new_touch(&self) -> bool {
        !self.present.is_empty() && self.kept.last() != Some(&self.present)
    }

    /// Returns the threshold at which a shape touched the matrix, if the model was trained at another one: the imprints
    /// of the model are then not those of this sensor.
    pub(super) fn other_threshold(&self) -> Option<f64> {
        let trained = self.model()?.model.sensor().threshold();
        self.threshold.filter(|&threshold| threshold != trained)
    }

    pub(crate) fn compared_with(&self) -> Option<&Imprint> {
        self.like.as_ref().filter(|&like| *like != self.present)
    }

    pub(crate) fn has_use_for(&self, message: &Message) -> bool {
        match message {
            Message::Recognise(RecogniseMessage::Keep) => self.is_new_touch(),
            Message::Recognise(RecogniseMessage::Forget) => !self.kept.is_empty(),
            Message::Recognise(RecogniseMessage::Touch) => {
                self.preparing.is_some() || self.model().is_some()
            }
            _ => true,
        }
    }

    fn ask(&mut self) {
        (self.answer, self.fitted, self.like) = (None, None, None);
        let touches = self.touches();
        let Some(trained) = self.model().filter(|_| !touches.is_empty()) else {
            return;
        };
        let model = &trained.model;
        let answer = self.terms.answer(model, &touches, None);
        // Of several touches, the answer is about the one that differs most.
        let is_only = touches[..] == [self.present];
        let fit = match &answer.fit {
            Some(fit) if !is_only => model.fit(fit.shape, &self.present, None),
            fit => fit.clone(),
        };
        let nearest = answer.nearest.as_ref().filter(|_| is_only);
        let like = fit.as_ref().map(|fit| fit.imprint);
        self.like = like.or(nearest.map(|nearest| nearest.imprint));
        (self.answer, self.fitted) = (Some(answer), fit.map(|fit| fit.source));
    }
}

/// Follows the matrix. A page that is closed does not.
fn show(app: &mut App) {
    let (imprint, document) = (app.reading().imprint, app.shown());
    let threshold = document.sensor.threshold();
    let threshold = document.source.as_ref().map(|_| threshold);
    let page = &mut app.recognition;
    page.threshold = threshold;
    if imprint != page.present {
        page.present = imprint;
        page.ask();
    }
}

/// Gives up the preparation of a model that has failed without an answer of its own.
pub(crate) fn stop_if_failed(app: &mut App) {
    if app.recognition.preparing.is_some() && !app.jobs.is_running(jobs::Slot::Model) {
        app.recognition.preparing = None;
    }
}

/// Brings the page up to date: called after every change.
pub(crate) fn follow(app: &mut App) {
    if is_open(app) {
        show(app);
    }
}

/// The page of recognition on the stack. Its state outlasts it, so the program keeps that.
struct RecognisePage;

impl Page for RecognisePage {
    /// Unknown messages go to the matrix.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let page = &mut app.recognition;
        if *message == Message::Accept {
            match page.preparing {
                None if page.trained.is_none() => prepare(app, None, false),
                None => refuse(app, "the model is ready"),
                Some(_) => refuse(app, "the model is not ready yet"),
            }
            return Flow::Stay;
        }
        if let Some(preparing) = &mut page.preparing {
            preparing.then_touches = false;
        }
        match message {
            Message::Recognise(asked) => carry_out(app, asked, true),
            message => matrix::update::act(app, message.clone()),
        }
        Flow::Stay
    }

    fn closed(self: Box<Self>, app: &mut App) {
        close(app);
    }

    fn placed(&self) -> Placed {
        (Context::Recognise, Place::Panel, Wheel::Idle)
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        panel::draw(&canvas.app.recognition, canvas, area);
        None
    }
}

fn is_open(app: &App) -> bool {
    app.page::<RecognisePage>().is_some()
}

/// Carries out what a key or a command asks for. A command may come while the page is closed; its result must be
/// visible.
pub(crate) fn act(app: &mut App, asked: &RecogniseMessage) {
    let is_open = is_open(app);
    carry_out(app, asked, is_open);
}

fn carry_out(app: &mut App, asked: &RecogniseMessage, is_open: bool) {
    if let RecogniseMessage::Seed(seed) = asked {
        app.recognition.random = Pcg64::seed_from_u64(*seed);
        return inform(app, format!("random touches begin with the seed {seed}"));
    }
    if *asked == RecogniseMessage::NextModel {
        let now = app.recognition.choice().clone();
        return next_model(app, ModelChoice::Library, Some(now), |app, next| {
            let next = next.unwrap_or(ModelChoice::Library);
            inform(app, next.to_string());
            act(app, &RecogniseMessage::Choose(next));
        });
    }
    let choice = match asked {
        RecogniseMessage::Choose(choice) => Some(choice.clone()),
        _ => None,
    };
    if !is_open {
        app.open(RecognisePage);
        app.shows_panel = true;
    }
    if choice.is_some() || *asked == RecogniseMessage::Open || !is_open {
        prepare(app, choice, !is_open);
    }
    match asked {
        RecogniseMessage::Keep => keep(app),
        RecogniseMessage::Forget => forget(app),
        RecogniseMessage::Terms(terms) => {
            app.recognition.terms = *terms;
            app.recognition.ask();
        }
        RecogniseMessage::Touch => {
            let page = &mut app.recognition;
            match (page.model().cloned(), &mut page.preparing) {
                (Some(trained), _) => touch(app, &trained),
                (None, Some(preparing)) => {
                    preparing.then_touches = true;
                    inform(app, "a model is prepared first");
                }
                _ => refuse(app, "the model is not prepared yet"),
            }
        }
        _ => {}
    }
}

/// Has the model prepared if there is none, or if it is that of another set. A training may take long: a set whose model
/// is ready or on its way is not prepared again. But when the page was `opened` just now or its set is asked for, a file
/// that was written since is read again, and new shapes of the library are trained.
fn prepare(app: &mut App, choice: Option<ModelChoice>, opened: bool) {
    let page = &mut app.recognition;
    let looks_again = opened || choice.is_some();
    let choice = choice.unwrap_or_else(|| page.choice().clone());
    let is_ready = page.trained.is_some() && !(looks_again && choice.may_change());
    if choice == *page.choice() && (page.preparing.is_some() || is_ready) {
        return;
    }
    let known = page.trained.clone().filter(|_| choice == page.choice);
    page.preparing = Some(Preparation {
        choice: choice.clone(),
        then_touches: false,
        opened,
    });
    page.ask();
    let models = app.jobs.models.clone();
    app.jobs.run(jobs::Slot::Model, move |progress| {
        let trained = TrainedModel::prepare(&models, choice, known, progress);
        answer(move |app| take_model(app, trained))
    });
}

/// Has the model of the library prepared anew if it answers on an open page; otherwise that is done when it is opened.
pub(crate) fn library_changed(app: &mut App) {
    if is_open(app) && *app.recognition.choice() == ModelChoice::Library {
        app.recognition.preparing = None;
        prepare(app, Some(ModelChoice::Library), false);
    }
}

/// Takes the model that was prepared. If it could not be read, the set before it stays.
fn take_model(app: &mut App, trained: Result<Arc<TrainedModel>, String>) {
    let page = &mut app.recognition;
    let Some(preparing) = page.preparing.take() else {
        return;
    };
    let choice = preparing.choice;
    let is_other = choice.is_read() && choice != page.choice;
    match trained {
        Ok(trained) => {
            // What was given as the name of a stored model may be that of a file.
            page.choice = trained.choice.clone();
            page.trained = Some(trained);
            page.ask();
            let has_keys = app.top_mut::<RecognisePage>().is_some();
            if preparing.then_touches && has_keys {
                act(app, &RecogniseMessage::Touch);
            }
        }
        Err(reason) => {
            if !is_other {
                (page.choice, page.trained) = (choice, None);
            }
            page.ask();
            if is_other && preparing.opened {
                app.pages.retain(|page| !page.is::<RecognisePage>());
                close(app);
            }
            refuse(app, reason);
        }
    }
}

/// Puts a random touch onto the matrix and tells its shape. Kept touches are forgotten: they were of another shape, and
/// the answer is about one shape only.
fn touch(app: &mut App, trained: &TrainedModel) {
    let sensor = app.history.present().sensor;
    let page = &mut app.recognition;
    page.kept.clear();
    let Some((shape, sensor, imprint)) = trained.random_touch(sensor, &mut page.random) else {
        return;
    };
    begin_drawn(app, sensor, &imprint, "random touch");
    app.held = None;
    let undo = app.key_of(&action::UNDO);
    let name = trained.name(shape);
    inform(app, format!("a random touch of {name}; {undo} undoes it"));
}

/// Keeps the touch on the matrix. Kept touches count as touches of the same shape.
fn keep(app: &mut App) {
    show(app);
    let page = &mut app.recognition;
    if page.present.is_empty() {
        return refuse(app, "nothing is touched");
    }
    if !page.is_new_touch() {
        return refuse(app, "this touch is already kept");
    }
    page.kept.push(page.present);
    match page.kept.len() {
        1 => inform(app, "1 touch kept; now touch the shape elsewhere"),
        count => inform(app, format!("{count} touches kept")),
    }
}

fn forget(app: &mut App) {
    let page = &mut app.recognition;
    if page.kept.is_empty() {
        return refuse(app, "no touches are kept");
    }
    page.kept.clear();
    page.ask();
    inform(app, "the kept touches are forgotten");
}

fn close(app: &mut App) {
    if app.recognition.preparing.take().is_some() {
        app.jobs.forget(jobs::Slot::Model);
    }
    app.shows_panel = false;
    app.held = None;
}
