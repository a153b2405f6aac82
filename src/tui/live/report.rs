//! How the live page handles the reports of its source.

use crate::formats::value::{counted, grouped};
use crate::tui::app::change::{inform, refuse};
use crate::tui::app::dialog::Dialog;
use crate::tui::app::state::App;
use crate::tui::live::message::{LiveEvent, RecordedFrames};
use crate::tui::live::state::Live;
use crate::tui::live::watch;
use crate::tui::runtime::effect::Effect;

/// Handles a report of the source. Reports of a source that is no longer watched are dropped, by their number; except
/// reports of a finished recording, because a recording is finished after its source is left.
pub(in crate::tui) fn on_worker(app: &mut App, number: u64, event: &LiveEvent) -> Option<Effect> {
    if let LiveEvent::NotNamed(by, reason) = event {
        return on_no_name(app, number, *by, reason);
    }
    on_frames(app, number, event);
    None
}

fn watched(app: &mut App, number: u64) -> Option<&mut Live> {
    watch::page(app).filter(|page| page.number() == number && !page.stopped())
}

/// Handles a model that cannot be used: shows the reason, and names imprints by the model before it, if there was one.
fn on_no_name(app: &mut App, source: u64, by: u64, reason: &str) -> Option<Effect> {
    let next = app.works + 1;
    let page = watched(app, source).filter(|page| page.names.is_by(by))?;
    page.names.fail(reason, next);
    let returned = (!page.names.is_by(by)).then(|| watch::name_by(page));
    app.works = next;
    refuse(app, reason);
    returned
}

fn on_frames(app: &mut App, number: u64, event: &LiveEvent) {
    match event {
        LiveEvent::Recorded(name, RecordedFrames { frames: 0, .. }) => {
            return inform(
                app,
                format!("{name}: no frame came, so nothing was written"),
            );
        }
        LiveEvent::Recorded(name, RecordedFrames { frames, left_out }) => {
            let frames = counted(*frames, "frame");
            let mut text = format!("{name}: {frames} recorded");
            if *left_out > 0 {
                text += &format!(", {} of another size left out", grouped(*left_out));
            }
            return inform(app, text);
        }
        LiveEvent::NotFinished(reason) => return refuse(app, reason.clone()),
        _ => {}
    }
    let is_open = matches!(app.dialogs.last(), Some(Dialog::Live(_)));
    let Some(page) = watched(app, number) else {
        return;
    };
    let troubles = |page: &Live| {
        let refusal = page.recording().refusal().map(str::to_owned);
        (page.trouble(), refusal)
    };
    let before = troubles(page);
    let error = page.error().cloned();
    match event {
        LiveEvent::Waiting
        | LiveEvent::NotNamed(..)
        | LiveEvent::Recorded(..)
        | LiveEvent::NotFinished(_) => {}
        LiveEvent::Arrived(batch) => {
            let moved = page.follow_recording(&batch.status);
            page.take(batch);
            if let Some(text) = moved {
                return inform(app, text);
            }
        }
        LiveEvent::Recording(name) => {
            page.set_recording(Some(name.clone()));
            return inform(app, format!("recording in {name}"));
        }
        LiveEvent::Named(by, named) => page.names.take(*by, (**named).clone()),
        LiveEvent::NotRecorded(reason) => page.fail_recording(reason.clone()),
    }
    let (trouble, refusal) = troubles(page);
    let is_wrong = page.error().is_some() && page.error() != error.as_ref();
    if is_open && (is_wrong || trouble.is_some() && trouble != before.0) {
        // The page shows the trouble; an old notice, such as that of the beginning of a recording, is no longer true.
        app.notice = None;
    } else if !is_open
        && let Some(reason) = refusal
        && before.1.as_ref() != Some(&reason)
    {
        refuse(app, reason);
    }
}
