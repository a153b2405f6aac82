//! The effects of messages on the page of recognition. The answer follows the matrix: `next_work`
//! is called after every message.

use std::sync::Arc;

use rand_core::SeedableRng;
use rand_pcg::Pcg64;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_files::storage::ModelChoice;

use crate::tui::app::change::{begin_drawn, inform, let_go, refuse};
use crate::tui::app::message::Message;
use crate::tui::app::page::{Flow, Page, Slot};
use crate::tui::app::state::{App, NarrowPane};
use crate::tui::explore::message::SweepProgress;
use crate::tui::keys::action;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::matrix;
use crate::tui::matrix::layers::Layers;
use crate::tui::recognise::confusion::Confusion;
use crate::tui::recognise::state::{
    ModelState, NoModel, RecogniseMessage, RecognitionEvent, SearchStep,
};
use crate::tui::recognise::trained::TrainedModel;
use crate::tui::runtime::effect::{Effect, Work};
use crate::tui::runtime::perform;
use crate::tui::widget::theme::Theme;

/// The page of recognition on the stack. Its state outlasts it, so the program keeps that.
struct RecognisePage;

impl Page for RecognisePage {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let effect = in_recognition(app, message.clone());
        perform(app, effect);
        Flow::Close
    }

    fn of_app<'a>(&self, app: &'a App) -> Option<&'a dyn Page> {
        Some(&app.recognition)
    }

    fn context(&self) -> Context {
        Context::Recognise
    }

    fn slot(&self) -> Slot {
        Slot::Panel
    }

    fn draw(&self, _: &Theme, _: &Keymap, _: &mut Buffer, _: Rect) -> Option<Position> {
        None
    }
}

fn is_open(app: &App) -> bool {
    app.page::<RecognisePage>().is_some()
}

fn open_for(app: &mut App, asked: RecogniseMessage) -> Option<Effect> {
    let choice = match &asked {
        RecogniseMessage::Choose(choice) => Some(choice.clone()),
        RecogniseMessage::NextModel(by) => Some(app.recognition.other(*by)),
        _ => None,
    };
    let effect = open(app, choice);
    match asked {
        RecogniseMessage::Open | RecogniseMessage::Choose(_) | RecogniseMessage::NextModel(_) => {
            effect
        }
        RecogniseMessage::Keep | RecogniseMessage::Forget => act(app, asked).or(effect),
        asked if effect.is_some() => {
            wait_for_model(app, asked);
            effect
        }
        asked => act(app, asked),
    }
}

pub(in crate::tui) fn act(app: &mut App, asked: RecogniseMessage) -> Option<Effect> {
    // A command may come while the page is closed; its result must be visible.
    if !is_open(app) && !matches!(asked, RecogniseMessage::Seed(_)) {
        return open_for(app, asked);
    }
    match asked {
        RecogniseMessage::Open => open(app, None),
        RecogniseMessage::Choose(choice) => open(app, Some(choice)),
        RecogniseMessage::NextModel(by) => next_model(app, by),
        RecogniseMessage::Touch => {
            with_model(app, asked, |app, trained| touch(app, &trained));
            None
        }
        RecogniseMessage::Keep => {
            add_touch(app);
            None
        }
        RecogniseMessage::Forget => {
            forget(app);
            None
        }
        RecogniseMessage::Confusion => {
            with_model(app, asked, |app, trained| {
                app.open(Confusion::new(trained));
            });
            None
        }
        RecogniseMessage::Poses => {
            with_model(app, asked, |app, _| show_poses(app));
            None
        }
        RecogniseMessage::Seed(seed) => {
            app.recognition.random = Pcg64::seed_from_u64(seed);
            inform(app, format!("random touches begin with the seed {seed}"));
            None
        }
        RecogniseMessage::SelectCell(..) => None,
    }
}

/// Opens the model that comes `by` further on. The notice names it, since the panel may be out of sight, and says how
/// models of the user's own come about, as long as there are none.
fn next_model(app: &mut App, by: i8) -> Option<Effect> {
    let page = &app.recognition;
    let (choice, has_own) = (page.other(by), !page.stored.is_empty());
    let mut text = choice.to_string();
    if !has_own {
        text += "; train your own with 'taxel model train' in a shell";
    }
    let effect = open(app, Some(choice));
    inform(app, text);
    effect
}

/// Opens the page, and has the model prepared if there is none, or if it is that of another set. A training may take
/// long: a set whose model is ready or on its way is not prepared again. But a file is read again if it was written
/// since, when the page is opened or its set is asked for. The model arrives as an event with the number given here;
/// an event with another number is out of date.
fn open(app: &mut App, choice: Option<ModelChoice>) -> Option<Effect> {
    let opened = !is_open(app);
    let looks_again = opened || choice.is_some();
    if opened {
        app.open(RecognisePage);
        app.narrow_pane = NarrowPane::Panel;
    }
    let page = &mut app.recognition;
    let choice = choice.unwrap_or_else(|| page.choice().clone());
    let is_present = choice == *page.choice();
    let is_prepared = match page.state() {
        ModelState::Missing => false,
        ModelState::Preparing(_) => is_present,
        ModelState::Ready(_) => is_present && !(looks_again && choice.is_read()),
    };
    if is_prepared {
        return None;
    }
    let known = page.trained().filter(|_| is_present).cloned();
    app.works += 1;
    let number = app.works;
    page.prepare(choice.clone(), number, opened);
    Some(Effect::Work(Work::Prepare(number, choice, known)))
}

/// Carries out a request once the model that is being prepared is ready; refuses it if none is.
fn wait_for_model(app: &mut App, asked: RecogniseMessage) {
    if app.recognition.request_later(asked) {
        inform(app, "a model is prepared first");
    } else {
        refuse(app, "the model is not prepared yet");
    }
}

fn with_model(
    app: &mut App,
    asked: RecogniseMessage,
    carry_out: impl FnOnce(&mut App, Arc<TrainedModel>),
) {
    match app.recognition.trained().cloned() {
        Some(trained) => carry_out(app, trained),
        None => wait_for_model(app, asked),
    }
}

/// Hides the outlines of poses if they are visible, otherwise shows them. At first the size of the taxels decides, so
/// this depends on what is visible, not on the setting.
fn show_poses(app: &mut App) {
    let Some(grid) = app.grid() else { return };
    // A page that was closed has not followed the matrix.
    let (imprint, source) = (app.reading().imprint, app.shown().source.clone());
    let page = &mut app.recognition;
    page.show(imprint, source.as_ref());
    let seen = Layers::shown(page.outlines(), &grid);
    page.outlines = Some(!seen);
    let said = match page.found() {
        _ if seen => Ok("without poses"),
        None if page.is_searching() => Ok("the poses are still being searched for"),
        Some(found) if !found.poses.is_empty() => {
            Ok("the likeliest pose; others of the 95 % faintly")
        }
        _ if page.present().is_empty() => Err("no pose to show: nothing is touched".to_owned()),
        None => Err("no pose to show: the search failed".to_owned()),
        Some(found) => {
            let none = "no pose to show: no shape of the model leaves this imprint";
            Err(found.refused.clone().unwrap_or_else(|| none.to_owned()))
        }
    };
    match said {
        Ok(text) => inform(app, text),
        Err(reason) => refuse(app, reason),
    }
}

/// Puts a random touch onto the matrix and tells its shape. Kept touches are forgotten: they were of another shape, and
/// the answer is about one shape only.
fn touch(app: &mut App, trained: &TrainedModel) {
    let sensor = app.history.present().sensor;
    app.recognition.forget();
    let Some((shape, sensor, imprint)) = trained.random_touch(sensor, &mut app.recognition.random)
    else {
        return;
    };
    begin_drawn(app, sensor, &imprint, "random touch");
    let_go(app);
    let undo = app.key_of(&action::UNDO);
    let name = trained.name(shape);
    inform(app, format!("a random touch of {name}; {undo} undoes it"));
}

fn forget(app: &mut App) {
    if app.recognition.forget() {
        inform(app, "the kept touches are forgotten");
    } else {
        refuse(app, "no touches are kept");
    }
}

/// Keeps the touch on the matrix. Kept touches count as touches of the same shape; the answer considers them all
/// together.
fn add_touch(app: &mut App) {
    // A page that was closed has not followed the matrix.
    let (imprint, source) = (app.reading().imprint, app.shown().source.clone());
    let page = &mut app.recognition;
    page.show(imprint, source.as_ref());
    let is_empty = page.present().is_empty();
    match (page.add_touch(), page.kept()) {
        (true, 1) => inform(app, "1 touch kept; now touch the shape elsewhere"),
        (true, count) => inform(app, format!("{count} touches kept")),
        (false, _) if is_empty => refuse(app, "nothing is touched"),
        (false, _) => refuse(app, "this touch is already kept"),
    }
}

/// Handles a message over the page; unknown messages go to the matrix. During a training, Cancel and Quit first stop
/// the training and leave the page open; a second time they close it. A closed page is kept with its model and its
/// touches.
pub(in crate::tui) fn in_recognition(app: &mut App, message: Message) -> Option<Effect> {
    match message {
        Message::Cancel | Message::Quit => {
            if app.recognition.stop() {
                app.open(RecognisePage);
                inform(app, "stopping");
                return Some(Effect::Work(Work::StopPreparing));
            }
            close(app)
        }
        message => {
            app.recognition.withdraw();
            app.open(RecognisePage);
            match message {
                Message::Accept => prepare_again(app),
                message => {
                    matrix::update::act(app, message);
                    None
                }
            }
        }
    }
}

/// Prepares the set again after a stop, unless its model is ready or on its way.
fn prepare_again(app: &mut App) -> Option<Effect> {
    let page = &mut app.recognition;
    let text = match page.state() {
        ModelState::Missing => return open(app, None),
        ModelState::Preparing(_) => {
            page.request_later(RecogniseMessage::Open);
            "the model is not ready yet"
        }
        ModelState::Ready(_) => "the model is ready: nothing was stopped",
    };
    refuse(app, text);
    None
}

fn close(app: &mut App) -> Option<Effect> {
    let stops = app.recognition.stop_search();
    app.narrow_pane = NarrowPane::Matrix;
    let_go(app);
    stops.then_some(Effect::Work(Work::StopFindingPoses))
}

/// Handles a message over the confusion matrix. Enter puts the imprint of the cell onto the matrix and closes the
/// page; it is refused if the cell has no imprint.
pub(crate) fn in_confusion(page: &mut Confusion, app: &mut App, message: &Message) -> Flow {
    if *message == Message::Accept {
        let sensor = app.history.present().sensor;
        if let Some((sensor, imprint)) = page.imprint_on(sensor) {
            begin_drawn(app, sensor, &imprint, &page.of_cell());
            return Flow::Close;
        }
        refuse(app, "there is no imprint in this cell");
    }
    page.take(message);
    Flow::Stay
}

pub(in crate::tui) fn on_worker(app: &mut App, event: RecognitionEvent) -> Option<Effect> {
    let has_keys = app.top_mut::<RecognisePage>().is_some();
    let page = &mut app.recognition;
    match event {
        RecognitionEvent::Begun(number, poses) => page.take_poses(number, poses),
        RecognitionEvent::Prepared(prepared) => {
            let request = page.take_request(prepared.number);
            let failed = page.take_model(*prepared);
            if failed.is_some() {
                return without_model(app, failed);
            }
            let request = request.filter(|_| has_keys)?;
            // A notice that it is not ready, or is prepared first, would be wrong now.
            inform(app, "the model is ready");
            return act(app, request);
        }
        RecognitionEvent::Searched(number, found) => {
            if let Some(reason) = page.take_result(number, found) {
                refuse(app, reason);
            }
        }
    }
    None
}

pub(in crate::tui) fn on_failure(app: &mut App, number: u64, reason: &str) -> Option<Effect> {
    let failed = app.recognition.fail(number, reason.to_owned());
    without_model(app, failed)
}

fn without_model(app: &mut App, failed: Option<NoModel>) -> Option<Effect> {
    let NoModel {
        reason,
        closes,
        prepares_again,
    } = failed?;
    if closes && is_open(app) {
        app.pages.retain(|page| !page.is::<RecognisePage>());
        // While a model is prepared, no search is in progress.
        let _ = close(app);
    }
    refuse(app, reason);
    prepares_again.then(|| open(app, None)).flatten()
}

pub(in crate::tui) fn on_progress(app: &mut App, number: u64, progress: SweepProgress) {
    app.recognition.take_progress(number, progress);
}

pub(in crate::tui) fn next_work(app: &mut App) -> Option<Effect> {
    if !is_open(app) {
        return None;
    }
    let (imprint, document) = (app.reading().imprint, app.shown());
    let (threshold, source) = (document.sensor.threshold(), document.source.clone());
    let page = &mut app.recognition;
    page.show(imprint, source.as_ref());
    page.threshold = source.map(|_| threshold);
    let number = app.works + 1;
    Some(Effect::Work(match page.step_search(number)? {
        SearchStep::Begin(search) => {
            app.works = number;
            Work::FindPoses(number, search)
        }
        SearchStep::Stop => Work::StopFindingPoses,
    }))
}
