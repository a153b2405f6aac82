//! The watched source and its page: opened, set aside, and opened again.

use std::path::PathBuf;
use std::sync::Arc;

use crate::acquire::SourceName;
use crate::storage::Existing;
use crate::tui::app::change::{inform, refuse};
use crate::tui::app::dialog::{Dialog, topmost};
use crate::tui::app::state::App;
use crate::tui::keys::action;
use crate::tui::keys::binding::Context;
use crate::tui::live::named_source::NamedSource;
use crate::tui::live::refusal::LiveRefusal;
use crate::tui::live::request::WatchRequest;
use crate::tui::live::state::Live;
use crate::tui::runtime::effect::{Effect, FileRequest, FrameWork};

pub(super) const NO_SOURCE: &str =
    "no source yet: ':watch SOURCE' watches a sensor or plays a recording";

const OPEN_ALREADY: &str = "this is the watched source; ':watch SOURCE' watches another one";

pub(in crate::tui) fn last_page(app: &App) -> Option<&Live> {
    let page = topmost!(&app.dialogs, Live).or(app.live.as_ref())?;
    Some(page)
}

/// Returns the file in which frames are recorded now, whether the page is open or not; None if nothing is recorded.
pub(in crate::tui) fn recording(app: &App) -> Option<&str> {
    let page = last_page(app).filter(|page| !page.stopped())?;
    page.recording().name()
}

/// Returns the page of the source that was watched last, open or not, to change it.
pub(super) fn page(app: &mut App) -> Option<&mut Live> {
    let page = topmost!(&mut app.dialogs, Live).or(app.live.as_mut())?;
    Some(page)
}

pub(in crate::tui) fn set_aside(app: &mut App) {
    if let Some(Dialog::Live(page)) = app
        .dialogs
        .pop_if(|dialog| matches!(dialog, Dialog::Live(_)))
    {
        app.live = Some(page);
    }
}

/// Requests a check of a source; it is watched if it can be read.
pub(super) fn check_source(app: &mut App, source: &NamedSource) -> Option<Effect> {
    let request = source.request(&app.watch_settings);
    // A second page would have no bytes to read, and the first one and its history would be gone.
    let reads_standard = |request: &WatchRequest| request.source == SourceName::Standard;
    if reads_standard(&request) && page(app).is_some_and(|page| reads_standard(page.request())) {
        refuse(app, LiveRefusal::ReadOnce.to_string());
        return None;
    }
    Some(Effect::File(FileRequest::Source(Arc::new(request))))
}

/// Opens a page for a source, in place of the one before. Late reports of the source before have its own number, and
/// are dropped.
pub(super) fn watch(app: &mut App, request: &Arc<WatchRequest>) -> Effect {
    app.works += 1;
    let mut page = Live::new(Arc::clone(request), app.works);
    page.set_recording(
        request
            .write
            .as_ref()
            .map(|(path, _)| path.to_string_lossy().into_owned()),
    );
    let write = request.write.clone();
    let watched = watch_source(&page, write);
    // It has led to this page, and is not opened again by what is refused here.
    app.prompt = None;
    app.live = None;
    app.dialogs
        .retain(|dialog| !matches!(dialog, Dialog::Live(_)));
    app.dialogs.push(Dialog::Live(Box::new(page)));
    watched
}

fn watch_source(page: &Live, write: Option<(PathBuf, Existing)>) -> Effect {
    Effect::Frames(FrameWork::Watch {
        number: page.number(),
        request: Arc::clone(page.request()),
        write,
        naming: page.names.request().cloned().map(Box::new),
    })
}

/// Opens the page of the last source. A source that was left is watched again: its history and settings are still
/// there; frames that came meanwhile are not. One that has ended is not: the page shows the frame that it showed. The
/// recording that was requested at the start is finished, and stays as it is.
pub(super) fn open(app: &mut App) -> Option<Effect> {
    if topmost!(&app.dialogs, Live).is_some() {
        refuse(app, OPEN_ALREADY);
        return None;
    }
    let Some(mut page) = app.live.take() else {
        refuse(app, NO_SOURCE);
        return None;
    };
    let mut effect = None;
    if page.stopped() {
        app.works += 1;
        effect = Some(if page.has_ended() {
            page.reopen(app.works);
            name_by(&page)
        } else {
            page.restart(app.works);
            say_not_recording(app, &mut page);
            watch_source(&page, None)
        });
    }
    app.dialogs.push(Dialog::Live(page));
    effect
}

pub(super) fn watch_again(app: &mut App, page: &mut Live) -> Option<Effect> {
    if let Err(refused) = page.check_again() {
        refuse(app, refused.to_string());
        return None;
    }
    app.works += 1;
    page.watch_again(app.works);
    say_not_recording(app, page);
    Some(watch_source(page, None))
}

fn say_not_recording(app: &mut App, page: &mut Live) {
    if page.take_stopped_recording() {
        let record = app.keymap().label(Context::Live, &action::RECORD);
        inform(
            app,
            format!("not recording any more; {record} records in a new file"),
        );
    }
}

pub(super) fn name_by(page: &Live) -> Effect {
    let naming = page.names.request().cloned().map(Box::new);
    Effect::Frames(FrameWork::NameBy(page.number(), naming))
}
