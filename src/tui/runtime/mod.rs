//! What the screen asks of the outside world and has not made a closure of yet: see [`crate::tui::jobs`].
//!
//! ```text
//! effect      what update may ask for: frames, the terminal
//! disk        files that are opened and written
//! frames      a source of frames: watched, recorded
//! ```

pub mod effect;

pub(crate) mod disk;

pub(crate) mod frames;

pub(crate) mod reminders;

pub use crate::tui::jobs::Jobs as World;
pub use crate::tui::runtime::frames::check as check_source;

use std::sync::Arc;

use taxel_files::acquire::{FrameRecorder, RecorderError};
use taxel_files::formats::recording::RecordedView;

use crate::frames::recording::Recording;
use crate::tui::app::change::refuse;
use crate::tui::app::message::WorkerEvent;
use crate::tui::app::state::App;
use crate::tui::app::update::on_worker;
use crate::tui::jobs::{Jobs, answer};
use crate::tui::live::message::LiveEvent;
use crate::tui::runtime::effect::{Effect, FrameWork};

/// Begins what an update asks for. Answers that are there at once come after the present message, like all others.
pub(crate) fn perform(app: &mut App, effect: Option<Effect>) {
    match effect {
        Some(Effect::Terminal(effect)) => app.terminal = Some(effect),
        Some(Effect::Frames(work)) => frames(app, work),
        None => {}
    }
}

fn frames(app: &mut App, work: FrameWork) {
    let watcher = &mut app.jobs.frames;
    match work {
        FrameWork::Watch {
            number,
            request,
            write,
        } => {
            stop_watching(app);
            app.jobs.frames.watch(number, request, write);
        }
        FrameWork::StopWatching => stop_watching(app),
        FrameWork::Record(metadata) => match watcher.start_recording() {
            Ok(number) => {
                let access = Arc::clone(&app.jobs.access);
                app.jobs.disk("Starting a recording", move |_| {
                    let begun = frames::record_in_free_file(&access, &metadata);
                    answer(move |app| recording_begun(app, number, begun))
                });
            }
            Err(refused) => refuse(app, refused),
        },
        FrameWork::StopRecording => {
            if let Some((number, recording)) = watcher.end_recording() {
                end_recording(app, number, recording);
            }
        }
        FrameWork::WriteMetadata(view) => {
            if let Some((number, recording)) = watcher.recording() {
                let what = format!("Saving the metadata of {}", recording.path().display());
                app.jobs.disk(what, move |_| {
                    let RecordedView { rule, tare, marks } = *view;
                    let written = recording.write(|recorder| {
                        recorder.describe(|own| {
                            (own.rule, own.tare, own.marks) = (rule, tare, marks);
                        })
                    });
                    answer(move |app| after_writing(app, number, written))
                });
            }
        }
    }
}

fn stop_watching(app: &mut App) {
    if let Some((number, recording)) = app.jobs.frames.stop() {
        end_recording(app, number, recording);
    }
}

fn end_recording(app: &mut App, number: u64, recording: Arc<Recording>) {
    let what = format!("Saving {}", recording.path().display());
    app.jobs.disk(what, move |_| {
        let ended = frames::finish(&recording);
        answer(move |app| {
            if let Some(event) = ended {
                on_worker(app, WorkerEvent::Live(number, event));
            }
        })
    });
}

/// A failure ends the recording.
fn after_writing<T>(app: &mut App, number: u64, written: Result<T, RecorderError>) {
    if let Err(error) = written {
        let failed = LiveEvent::NotRecorded(error.to_string());
        on_worker(app, WorkerEvent::Live(number, failed));
    }
}

fn recording_begun(app: &mut App, number: u64, begun: Result<(String, Arc<Recording>), String>) {
    let (event, recording) = match begun {
        Ok((name, recording)) => (LiveEvent::Recording(name), Some(recording)),
        Err(refused) => (LiveEvent::NotRecorded(refused), None),
    };
    // The recording to end: the new one if its source was left meanwhile, or another one that was still open.
    let over = (app.jobs.frames).recording_started(number, recording);
    if let Some(over) = over {
        end_recording(app, number, over);
    }
    on_worker(app, WorkerEvent::Live(number, event));
}

/// Finishes changes and recordings and writes unsaved work at once, because the program is about to end. Returns lines
/// about everything that is not on the disk.
pub fn end(app: &mut App) -> Vec<String> {
    stop_watching(app);
    let mut lines = Jobs::finish(app);
    if !lines.is_empty() && !app.unsaved_work().is_empty() {
        lines.push("the next start offers it as unsaved work\n".to_owned());
    }
    lines
}

/// Writes everything out because the program is about to be stopped, perhaps for ever. Everything goes on when it is
/// continued.
pub fn flush(app: &mut App) -> Vec<String> {
    if let Some((number, recording)) = app.jobs.frames.recording() {
        let what = format!("Saving {}", recording.path().display());
        app.jobs.disk(what, move |_| {
            let written = recording.write(FrameRecorder::flush);
            answer(move |app| after_writing(app, number, written))
        });
    }
    Jobs::finish(app)
}
