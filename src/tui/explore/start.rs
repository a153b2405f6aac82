//! The way to results: what is asked for over the matrix, the form of ranges, work under way.

use std::sync::Arc;

use crate::pose::PoseGrid;
use crate::tui::app::change::{inform, refuse};
use crate::tui::app::dialog::Dialog;
use crate::tui::app::message::Message;
use crate::tui::app::state::{App, Mode};
use crate::tui::explore::export::is_poses;
use crate::tui::explore::message::ExploreMessage;
use crate::tui::explore::ranges::state::{RangesForm, explored};
use crate::tui::explore::results::Results;
use crate::tui::explore::running::state::{Running, WorkKind};
use crate::tui::runtime::effect::{Effect, Work};

/// What is asked for over the matrix or at a question.
pub(crate) fn act(app: &mut App, asked: ExploreMessage) -> Option<Effect> {
    match asked {
        ExploreMessage::Open => open(app),
        ExploreMessage::Ranges => open_ranges(app),
        ExploreMessage::Start(grid) => Some(start(app, *grid)),
        ExploreMessage::Write(name, existing) => {
            let found = Arc::clone(app.results_below()?.findings());
            let poses = is_poses(&name).then(|| found.sweep.grid.poses());
            let number = begin(app, WorkKind::Write(name.clone(), poses));
            Some(Effect::Work(Work::Write(number, found, name, existing)))
        }
        _ => None,
    }
}

/// The last results where they are those of the shape on the matrix, else a form.
fn open(app: &mut App) -> Option<Effect> {
    app.mode = Mode::Draw;
    match app.results.take() {
        Some(results) if is_of(app, &results) => {
            app.dialogs.push(Dialog::Results(results));
            None
        }
        others => {
            app.results = others;
            open_ranges(app)
        }
    }
}

/// Whether results are those of the shape on the matrix, wherever it is now.
fn is_of(app: &App, results: &Results) -> bool {
    let grid = &results.sweep().grid;
    let present = app.history.present();
    explored(present).is_some_and(|source| grid.is_of(&source, &present.sensor))
}

/// The form, with the ranges of the results below it or those that were last.
fn open_ranges(app: &mut App) -> Option<Effect> {
    let below = app.dialogs.last().and_then(|dialog| match dialog {
        Dialog::Results(results) => Some(results.sweep().grid.clone()),
        _ => None,
    });
    let present = app.history.present();
    let Some(source) = explored(present) else {
        refuse(app, app.nothing_to_explore());
        return None;
    };
    let mut form = RangesForm::new(present, source, below.as_ref());
    let effect = measure(&mut form);
    app.dialogs.push(Dialog::Ranges(Box::new(form)));
    effect
}

/// Asks how long the grid of a form takes, once for each.
fn measure(form: &mut RangesForm) -> Option<Effect> {
    let grid = form.unmeasured()?;
    Some(Effect::Work(Work::Measure(Box::new(grid))))
}

fn start(app: &mut App, grid: PoseGrid) -> Effect {
    let number = begin(app, WorkKind::Sweep(Box::new(grid.clone())));
    Effect::Work(Work::Sweep(number, Box::new(grid)))
}

/// A new piece of work, and its number.
fn begin(app: &mut App, job: WorkKind) -> u64 {
    app.works += 1;
    app.dialogs
        .push(Dialog::Running(Running::new(app.works, job)));
    app.works
}

/// What a dialog leaves when it is closed: results are looked at again.
pub(crate) fn put_away(app: &mut App, dialog: Dialog) {
    if let Dialog::Results(results) = dialog {
        app.results = Some(results);
    }
}

pub(crate) fn in_ranges(
    app: &mut App,
    mut form: Box<RangesForm>,
    message: Message,
) -> Option<Effect> {
    match message {
        Message::Accept => match form.grid() {
            Ok(grid) => return Some(start(app, grid)),
            Err(trouble) => {
                if trouble.field.is_some() {
                    form.set_focus(trouble.field);
                }
                refuse(app, trouble.full);
            }
        },
        message => form.take(&message),
    }
    let effect = measure(&mut form);
    app.dialogs.push(Dialog::Ranges(form));
    effect
}

pub(crate) fn in_running(app: &mut App, mut running: Running, message: &Message) -> Option<Effect> {
    let stops = *message == Message::Explore(ExploreMessage::Stop);
    if stops {
        running.stopping = true;
        inform(app, "stopping");
    }
    app.dialogs.push(Dialog::Running(running));
    stops.then_some(Effect::Work(Work::Stop))
}
