//! How the live page handles messages. The source keeps running while the imprint is on the matrix, and ends when the
//! page is closed.

use std::sync::Arc;

use taxel_core::frame::{FrameSize, Rule};
use taxel_files::acquire::FrameSource;
use taxel_files::formats::Name;
use taxel_files::formats::recording::RecordingMetadata;
use taxel_files::formats::value::counted;

use crate::tui::app::{
    App, Document, DocumentOrigin, Endpoint, Flow, Message, begin, find_mut, inform, refuse, status,
};
use crate::tui::files;
use crate::tui::jobs::answer;
use crate::tui::keys::{Arrow, Context, action};
use crate::tui::live::{
    FrameBatch, HeatLayer, Live, LiveMessage, NO_FRAME, NamedSource, READ_ONCE, WatchRequest,
    names, reading, source, view,
};
use crate::tui::prompt::CommandDialog;

/// Handles a request over the matrix. Requests about the open page, such as a tare, do nothing here, because no page
/// is open.
pub fn act(app: &mut App, asked: &LiveMessage) {
    match asked {
        LiveMessage::Watch(request) => watch(app, request),
        LiveMessage::Source(source) => check_source(app, source),
        LiveMessage::Open => open(app),
        LiveMessage::AtLeast(rule) => set_threshold(app, *rule),
        LiveMessage::Size(size) => watch_with(app, *size),
        LiveMessage::Terms(terms) => names::name_on(app, *terms),
        _ => {}
    }
}

fn set_threshold(app: &mut App, rule: Rule) {
    let Some(page) = page(app) else {
        return refuse(app, NO_SOURCE);
    };
    page.choose(rule);
    let value = reading::rule_text(rule, &page.unit());
    let text = format!("{}: threshold {value}", page.request.name());
    inform(app, text);
}

/// Watches the source of the page from its start, with this size of a frame, and with the threshold of the page.
fn watch_with(app: &mut App, size: FrameSize) {
    let reason = match page(app) {
        None => NO_SOURCE,
        Some(page) if page.request.source == FrameSource::Standard => READ_ONCE,
        Some(page) => {
            let mut request = WatchRequest::clone(&page.request);
            request.options.size = Some(size);
            request.pipeline.processing.apply_rule(page.rule());
            return watch(app, &Arc::new(request));
        }
    };
    refuse(app, reason);
}

/// Handles a message over the page. Esc goes back to the source from a frozen frame; otherwise it leaves the page, and
/// ends the source. Enter keeps the source, because users often come back for the next imprint.
pub fn in_live(page: &mut Live, app: &mut App, message: &Message) -> Flow {
    page.see_notices();
    match message {
        Message::Cancel if !page.history.follows() && !page.status.state.is_final() => {
            page.history.follow();
            page.read();
        }
        Message::Cancel | Message::Quit => {
            page.stop();
            source::stop(app);
            return Flow::Close;
        }
        Message::Accept => match reading::document(page) {
            Some(document) => {
                put_on_matrix(app, page, document);
                return Flow::Close;
            }
            None => refuse_imprint(app, page),
        },
        Message::Scroll(by) => go(app, page, *by, "frame", Live::scrub),
        Message::ScrollTo(Endpoint::First) => drop(page.stay_at(0)),
        Message::ScrollTo(Endpoint::Last) => {
            page.history.follow();
            page.read();
        }
        Message::SwitchPane => page.only_panel ^= true,
        Message::Live(asked) => adjust(app, page, asked),
        Message::Command => return Flow::push(CommandDialog::over(Context::Live, app)),
        _ => {}
    }
    Flow::Stay
}

/// Goes to another frame of the history, or says that there is no earlier or later one of `what` is looked for.
fn go(
    app: &mut App,
    page: &mut Live,
    by: impl Into<i64>,
    what: &str,
    scrub: fn(&mut Live, i64) -> bool,
) {
    let by = by.into();
    if !scrub(page, by) {
        let text = match by {
            ..0 => format!("no earlier {what} in the history"),
            _ if page.status.state.is_final() => format!("no later {what}"),
            _ => format!("no later {what} yet"),
        };
        refuse(app, text);
    }
}

/// Changes how frames are shown, or begins and ends a recording.
fn adjust(app: &mut App, page: &mut Live, asked: &LiveMessage) {
    match asked {
        LiveMessage::Tare => match page.tare_now() {
            Ok(frames) => inform(app, tare_of(page, frames)),
            Err(refused) => refuse(app, refused),
        },
        LiveMessage::NoTare if page.drop_tare() => inform(app, "tare removed"),
        LiveMessage::NoTare => refuse(app, "there is no tare"),
        LiveMessage::Threshold(direction) => page.step_threshold(*direction),
        LiveMessage::Percent => page.switch_unit(),
        LiveMessage::Freeze => page.freeze(),
        LiveMessage::Second(by) => go(app, page, *by, "frame", Live::scrub_second),
        LiveMessage::Touch(by) => go(app, page, *by, "touch", Live::scrub_touch),
        LiveMessage::NextLayer => next_layer(app, page),
        LiveMessage::Plot => page.plotted ^= 1,
        LiveMessage::Numbers => page.numbers ^= true,
        LiveMessage::OwnRange => {
            page.range.is_own ^= true;
            let text = if page.range.is_own {
                "the shades cover this frame's values"
            } else {
                "the shades cover all values so far"
            };
            inform(app, text);
        }
        LiveMessage::Window(towards) => look_further(app, page, *towards),
        LiveMessage::FollowContact => {
            page.looked_at = None;
            inform(app, "the view follows the contact");
        }
        LiveMessage::Record => record(app, page),
        LiveMessage::Mark => match page.mark() {
            Some((number, true)) => inform(app, format!("frame {number}: marked")),
            Some((number, false)) => inform(app, format!("frame {number}: mark removed")),
            None => refuse(app, NO_FRAME),
        },
        LiveMessage::NameShape => names::name_by_next(app, &page.names),
        LiveMessage::Again => match page.check_again() {
            Ok(()) => restart(app, page),
            Err(refused) => refuse(app, refused),
        },
        LiveMessage::Source(source) => check_source(app, source),
        // The others are typed after `:`, and reach the page from there.
        _ => {}
    }
}

/// Returns the notice about a tare that was made just now of this number of frames. If the page stays at a frame, these
/// end with it, and the notice says so.
fn tare_of(page: &Live, frames: u64) -> String {
    let origin = page.pipeline.origin.filter(|_| !page.history.follows());
    let last = origin.and_then(|origin| origin.last);
    match (last.map(|(number, _)| number), frames) {
        (Some(number), 1) => format!("tare of frame {number}"),
        (Some(number), _) => format!("tare of the {frames} frames up to frame {number}"),
        (None, 1) => "tare of 1 frame".to_owned(),
        (None, _) => format!("tare of the last {}", counted(frames, "frame")),
    }
}

fn next_layer(app: &mut App, page: &mut Live) {
    page.layer = page.layer.next();
    page.read();
    let shows_raw = page.pipeline.origin.is_none() && page.pipeline.processing.gain.is_none();
    match page.layer {
        HeatLayer::Tared if shows_raw => inform(app, "no tare: the values are the raw ones"),
        HeatLayer::Imprint if page.rule().is_none() => {
            inform(app, "no threshold, so there is no imprint");
        }
        _ => {}
    }
}

fn look_further(app: &mut App, page: &mut Live, towards: Arrow) {
    let area = app.panes();
    let area = area.map(|panes| status::page_area(app, &panes, page));
    match area.and_then(|area| view::beyond(page, &app.theme, area, towards)) {
        Some(next) => page.looked_at = Some(next),
        None => refuse(app, "no more taxels in this direction"),
    }
}

/// Puts the imprint onto the matrix; the source keeps running. The imprint counts as unsaved, because no source sends
/// the same frame again. If the recording gives the size of its cells but lengths are not in mm, the notice says why.
fn put_on_matrix(app: &mut App, page: &Live, document: Document) {
    let number = page.reading.as_ref().map(|reading| reading.frame.number);
    let without_mm = page.status.channel.why_not_in_mm();
    let source = page.request.name();
    let frame = number.map_or("a frame".to_owned(), |number| format!("frame {number}"));
    // Not every source has a name that a shape may have.
    let stem = source.rsplit_once('.').map_or(&*source, |(stem, _)| stem);
    let named = Name::new(&format!("{frame} of {stem}"));
    let proposed = named.map_or_else(|_| frame.clone(), |name| name.to_string());
    let origin = DocumentOrigin {
        proposed: Some(proposed),
        ..DocumentOrigin::unsaved(&document).called(format!("imprint of {frame}, {source}"))
    };
    begin(app, origin, document);
    let back = app.key_of(&action::WATCH);
    let mut text = format!("the imprint of {frame}; {back} goes back to the source");
    if let Some(reason) = without_mm {
        text += &format!("; {reason}");
    }
    inform(app, text);
}

fn refuse_imprint(app: &mut App, page: &Live) {
    let mut text = page.no_imprint();
    if page.reading.is_some() && page.rule().is_none() {
        let key = app.keymap.label(Context::Live, &action::THRESHOLD_UP);
        text += &format!("; {key} sets one");
    }
    refuse(app, text);
}

/// Writes threshold, tare and marks beside the recording if they have changed since they were written last.
pub fn write_changes(app: &mut App) {
    let page = page(app).filter(|page| !page.stopped);
    if let Some(view) = page.and_then(Live::take_changed_view) {
        source::write(app, "Saving the metadata of", move |recorder| {
            recorder.describe(|own| {
                (own.rule, own.tare, own.marks) = (view.rule, view.tare, view.marks);
            })
        });
    }
}

/// Begins a recording, or ends it. The frames are written as they come, without view, tare or threshold; the
/// metadata of the recording says how they were looked at last.
fn record(app: &mut App, page: &mut Live) {
    if page.recording.name.is_some() {
        page.begin_recording(None);
        return source::end_recording(app);
    }
    if page.status.state.is_final() {
        return refuse(app, "the source has ended, so there is nothing to record");
    }
    page.recording.from = page.history.numbers().end;
    let channel = &page.status.channel;
    let metadata = RecordingMetadata {
        source: page.request.source.name(),
        unit: channel.unit.clone(),
        pitch_mm: channel.pitch_mm,
        rule: page.rule(),
        tare: page.pipeline.processing.tare.clone(),
        seconds_per_frame: channel.seconds_per_frame,
        ..RecordingMetadata::default()
    };
    source::record(app, metadata);
}

/// Takes what has come from the source of that number.
pub(crate) fn arrived(app: &mut App, number: u64, batch: &FrameBatch) {
    report(app, number, |page| page.take(batch));
}

/// Notes the file in which frames are recorded from now on, or why they are not.
pub fn begun_in(app: &mut App, number: u64, file: Result<String, String>) {
    match file {
        Ok(name) => {
            inform(app, format!("recording in {name}"));
            report(app, number, |page| page.begin_recording(Some(name)));
        }
        Err(reason) => report(app, number, |page| page.fail_recording(reason)),
    }
}

/// Changes the page by a report of its source; one of a source that is no longer watched is dropped.
fn report(app: &mut App, number: u64, change: impl FnOnce(&mut Live)) {
    let is_open = app.pages.last().is_some_and(|page| page.is::<Live>());
    let Some(page) = page(app).filter(|page| page.number == number && !page.stopped) else {
        return;
    };
    let wrong = |page: &Live| (page.trouble(), page.error().cloned());
    let (before, refused) = (wrong(page), page.recording.refusal.clone());
    change(page);
    let (now, refusal) = (wrong(page), page.recording.refusal.clone());
    if is_open && now != before && now != (None, None) {
        // The page shows the trouble; an old notice, such as that of the beginning of a recording, is no longer true.
        app.notice = None;
    } else if !is_open
        && refusal != refused
        && let Some(reason) = refusal
    {
        refuse(app, reason);
    }
}

pub(super) const NO_SOURCE: &str =
    "no source yet: ':watch SOURCE' watches a sensor or plays a recording";

const OPEN_ALREADY: &str = "this is the watched source; ':watch SOURCE' watches another one";

pub fn last_page(app: &App) -> Option<&Live> {
    app.page().or(app.live.as_deref())
}

/// Returns the file in which frames are recorded now, whether the page is open or not; None if nothing is recorded.
pub fn recording(app: &App) -> Option<&str> {
    let page = last_page(app).filter(|page| !page.stopped)?;
    page.recording.name.as_deref()
}

/// Returns the page of the source that was watched last, open or not, to change it.
pub fn page(app: &mut App) -> Option<&mut Live> {
    find_mut(&mut app.pages).or(app.live.as_deref_mut())
}

pub fn set_aside(app: &mut App) {
    if let Some(page) = app.pages.pop_if(|page| page.is::<Live>()) {
        page.closed(app);
    }
}

/// Requests a check of a source; it is watched if it can be read.
fn check_source(app: &mut App, source: &NamedSource) {
    let named = source.source();
    // A second page would have no bytes to read, and the first one and its history would be gone.
    if named == FrameSource::Standard && page(app).is_some_and(|page| page.request.source == named)
    {
        return refuse(app, READ_ONCE);
    }
    let (models, access) = (app.jobs.models.clone(), Arc::clone(&app.jobs.access));
    let (source, settings) = (source.clone(), app.watch_settings.clone());
    app.jobs
        .read(format!("Opening {}", named.name()), move |_| {
            let found = source.request(&settings);
            let found = found.and_then(|own| files::watchable(Arc::new(own), &models, &access));
            answer(|app| match found {
                Ok(request) => watch(app, &request),
                Err(refused) => refuse(app, refused),
            })
        });
}

/// Opens a page for a source, in place of the one before. Late reports of the source before have its own number, and
/// are dropped.
fn watch(app: &mut App, request: &Arc<WatchRequest>) {
    app.works += 1;
    let mut page = Live::new(Arc::clone(request), app.works);
    let path = (request.write.as_ref()).map(|(path, _)| path.to_string_lossy());
    page.begin_recording(path.map(Into::into));
    source::watch(app, page.number, Arc::clone(request), true);
    // It has led to this page, and is not opened again by what is refused here.
    app.prompt = None;
    app.live = None;
    app.pages.retain(|page| !page.is::<Live>());
    let model = page.names.choice.clone();
    app.open(page);
    names::name_by(app, model);
}

/// Opens the page of the last source as it was left. If the source can go on, its frames are watched again; those that
/// came meanwhile are lost. A finished recording is played again only when asked for.
fn open(app: &mut App) {
    if app.pages.iter().any(|page| page.is::<Live>()) {
        return refuse(app, OPEN_ALREADY);
    }
    let Some(mut page) = app.live.take() else {
        return refuse(app, NO_SOURCE);
    };
    if std::mem::take(&mut page.stopped) && !page.status.state.is_final() {
        restart(app, &mut page);
    }
    app.pages.push(page);
}

fn restart(app: &mut App, page: &mut Live) {
    app.works += 1;
    page.restart(app.works);
    source::watch(app, page.number, Arc::clone(&page.request), false);
}

#[cfg(test)]
mod tests {
    use taxel_core::frame::{Frame, FrameSize};

    use super::*;

    #[test]
    fn a_threshold_set_by_key_still_drops_small_pieces() {
        let mut request = WatchRequest::new("none");
        request.pipeline.processing.least = 4;
        let mut page = Live::new(Arc::new(request), 7);
        let mut frame = Frame::new(FrameSize::new(8, 8).expect("an allowed size"));
        frame.values_mut()[9] = 30.0;
        page.take(&FrameBatch {
            frames: vec![Arc::new(frame)],
            ..FrameBatch::default()
        });
        page.step_threshold(1);
        assert_eq!(page.rule().map(|set| set.least), Some(4));
        let imprint = page.reading.and_then(|reading| reading.imprint);
        assert_eq!(imprint.map(|imprint| imprint.count()), Some(0));
    }
}
