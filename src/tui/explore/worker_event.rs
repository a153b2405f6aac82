//! What workers tell: how far they are, what was found, what was written.

use std::sync::Arc;

use crate::formats::value::grouped;
use crate::storage::Existing;
use crate::tui::app::change::{inform, refuse};
use crate::tui::app::dialog::{Dialog, Question};
use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::explore::export::ExportDialog;
use crate::tui::explore::message::{ExploreMessage, Findings, WorkerEvent};
use crate::tui::explore::results::Results;
use crate::tui::explore::running::state::{Running, WorkKind};
use crate::tui::runtime::effect::Effect;

/// Takes what a worker tells.
pub(crate) fn on_worker(app: &mut App, told: WorkerEvent) -> Option<Effect> {
    match told {
        WorkerEvent::Progress(number, progress) => {
            if let Some(running) = running(app, number) {
                running.progress = Some(progress);
            }
        }
        WorkerEvent::Estimate(grid, time) => {
            let mut dialogs = app.dialogs.iter_mut().rev();
            let form = dialogs.find_map(|dialog| match dialog {
                Dialog::Ranges(form) => Some(form),
                _ => None,
            });
            if let Some(form) = form {
                form.take_estimate(&grid, time);
            }
        }
        WorkerEvent::Swept(number, findings) => take_findings(app, number, findings),
        WorkerEvent::Written(number, name) => {
            if finish(app, number).is_some() {
                inform(app, format!("written: {name}"));
            }
        }
        WorkerEvent::Exists(number, name) => {
            if let Some(place) = finish(app, number) {
                let text = format!("{name} is there already. Replace it?");
                let yes = Message::Explore(ExploreMessage::Write(name, Existing::Replaced));
                ask(app, place, Dialog::Question(Question::new(text, yes)));
            }
        }
        WorkerEvent::Failed(number, reason) => {
            let name = running(app, number).and_then(|running| match &running.job {
                WorkKind::Write(name, _) if !running.stopping => Some(name.clone()),
                _ => None,
            });
            if let Some(place) = finish(app, number) {
                // To be put right.
                if let Some(name) = name {
                    ask(app, place, Dialog::Export(ExportDialog::new(&name)));
                }
                refuse(app, reason);
            }
        }
        WorkerEvent::Refused(reason) => refuse(app, reason),
    }
    None
}

/// Asks for something in the place of the work that wants to know it; help that lies over that is closed.
fn ask(app: &mut App, place: usize, dialog: Dialog) {
    app.dialogs.truncate(place);
    app.dialogs.push(dialog);
}

/// The work of that number, if it is still waited for.
fn running(app: &mut App, number: u64) -> Option<&mut Running> {
    let mut dialogs = app.dialogs.iter_mut();
    dialogs.find_map(|dialog| match dialog {
        Dialog::Running(running) if running.number == number => Some(running),
        _ => None,
    })
}

/// Takes the work of that number away; answers where it lay.
fn finish(app: &mut App, number: u64) -> Option<usize> {
    let own =
        |dialog: &Dialog| matches!(dialog, Dialog::Running(running) if running.number == number);
    let place = app.dialogs.iter().position(own)?;
    app.dialogs.remove(place);
    app.notice = None;
    Some(place)
}

/// Results in place of the work, and of earlier results.
fn take_findings(app: &mut App, number: u64, findings: Arc<Findings>) {
    let Some(place) = finish(app, number) else {
        return;
    };
    let result = &findings.sweep;
    if result.poses == 0 {
        return refuse(app, "stopped before anything was complete");
    }
    if !result.complete() {
        inform(
            app,
            format!(
                "stopped after {} of {} poses",
                grouped(result.poses),
                grouped(result.grid.poses())
            ),
        );
    }
    let results = Dialog::Results(Box::new(Results::new(findings)));
    app.dialogs.insert(place, results);
    let earlier = app.dialogs[..place]
        .iter()
        .position(|dialog| matches!(dialog, Dialog::Results(_)));
    if let Some(earlier) = earlier {
        app.dialogs.remove(earlier);
    }
    app.results = None;
}
