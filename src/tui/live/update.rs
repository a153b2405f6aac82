//! How the live page handles messages. The source keeps running while the imprint is on the matrix, and ends when the
//! page is closed.

use std::path::PathBuf;
use std::sync::Arc;

use taxel_core::frame::{FrameError, FrameSize, Rule};
use taxel_files::acquire::FrameSource;
use taxel_files::formats::recording::RecordingMetadata;
use taxel_files::formats::value::{counted, grouped};
use taxel_files::storage::{Existing, ModelChoice, ModelFolder};

use crate::tui::app::change::{inform, refuse};
use crate::tui::app::dialog::{Dialog, topmost};
use crate::tui::app::message::{Endpoint, Message};
use crate::tui::app::state::App;
use crate::tui::app::status;
use crate::tui::jobs::answer;
use crate::tui::keys::action;
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::Context;
use crate::tui::live::message::{
    LiveEvent, LiveMessage, NamedSource, RecordedFrames, WatchRequest,
};
use crate::tui::live::reading::{self, HeatLayer};
use crate::tui::live::state::Live;
use crate::tui::live::{threshold, view};
use crate::tui::prompt::state::CommandDialog;
use crate::tui::runtime::disk::files;
use crate::tui::runtime::effect::{Effect, FrameWork};
use crate::tui::runtime::perform;

/// Handles a request over the matrix. Requests about the open page, such as a tare, do nothing here, because no page
/// is open.
pub(in crate::tui) fn act(app: &mut App, asked: &LiveMessage) -> Option<Effect> {
    match asked {
        LiveMessage::Watch(request) => Some(watch(app, request)),
        LiveMessage::Source(source) => check_source(app, source),
        LiveMessage::Open => open(app),
        LiveMessage::AtLeast(rule) => {
            set_threshold(app, *rule);
            None
        }
        LiveMessage::Size(size) => watch_with(app, *size),
        _ => None,
    }
}

fn set_threshold(app: &mut App, rule: Rule) {
    let Some(page) = page(app) else {
        refuse(app, NO_SOURCE);
        return;
    };
    page.choose(rule);
    let value = threshold::text(rule, &page.unit());
    let text = format!("{}: threshold {value}", page.request().name());
    inform(app, text);
}

/// Watches the source of the page from its start, with this size of a frame, and with the threshold of the page.
fn watch_with(app: &mut App, size: FrameSize) -> Option<Effect> {
    let Some(page) = page(app) else {
        refuse(app, NO_SOURCE);
        return None;
    };
    if page.request().source == FrameSource::Standard {
        refuse(app, LiveRefusal::ReadOnce.to_string());
        return None;
    }
    let mut request = WatchRequest::clone(page.request());
    request.options.size = Some(size);
    request.pipeline.processing.apply_rule(page.rule());
    Some(watch(app, &Arc::new(request)))
}

/// Handles a message over the page. Closing ends the source and keeps the page; Enter keeps both, because users often
/// come back for the next imprint.
pub(in crate::tui) fn in_live(
    app: &mut App,
    mut page: Box<Live>,
    message: Message,
) -> Option<Effect> {
    let mut effect = None;
    page.see_notices();
    match message {
        Message::Cancel | Message::Quit => {
            page.stop();
            app.live = Some(page);
            return Some(Effect::Frames(FrameWork::StopWatching));
        }
        Message::Accept => match reading::document(&page) {
            Some(document) => {
                reading::take(app, page, document);
                return None;
            }
            None => reading::refuse_imprint(app, &page),
        },
        Message::Scroll(by) => scrub(app, &mut page, by),
        Message::ScrollTo(Endpoint::First) => page.to_oldest(),
        Message::ScrollTo(Endpoint::Last) => page.to_newest(),
        Message::SwitchPane => page.display.only_panel ^= true,
        Message::Live(asked) => effect = adjust(app, &mut page, &asked),
        Message::Command => {
            let prompt = CommandDialog::new(&app.commands);
            app.dialogs
                .extend([Dialog::Live(page), Dialog::Command(prompt)]);
            return None;
        }
        _ => {}
    }
    app.dialogs.push(Dialog::Live(page));
    effect
}

/// Shows a later frame or, with a negative number, an earlier one; says so if there is none.
fn scrub(app: &mut App, page: &mut Live, by: i16) {
    if !page.scrub(by.into()) {
        let text = match by {
            ..0 => "no earlier frame in the history",
            _ if page.has_ended() => "no later frame",
            _ => "no later frame yet",
        };
        refuse(app, text);
    }
}

/// Changes how frames are shown, or begins and ends a recording.
fn adjust(app: &mut App, page: &mut Live, asked: &LiveMessage) -> Option<Effect> {
    match asked {
        LiveMessage::Tare => match page.tare_now() {
            Ok(frames) => inform(app, tare_of(page, frames)),
            Err(refused) => refuse(app, refused.to_string()),
        },
        LiveMessage::NoTare if page.drop_tare() => inform(app, "tare removed"),
        LiveMessage::NoTare => refuse(app, "there is no tare"),
        LiveMessage::Threshold(direction) => page.step_threshold(*direction),
        LiveMessage::Percent => page.switch_unit(),
        LiveMessage::Freeze => page.freeze(),
        LiveMessage::PeakHold => page.switch_peak(),
        LiveMessage::NextLayer => next_layer(app, page),
        LiveMessage::Plot => page.plotted = page.plotted.other(),
        LiveMessage::Numbers => page.display.numbers ^= true,
        LiveMessage::OwnRange => {
            let own = page.switch_range();
            let text = if own {
                "the shades cover this frame's values"
            } else {
                "the shades cover all values so far"
            };
            inform(app, text);
        }
        LiveMessage::Window(towards) => look_further(app, page, *towards),
        LiveMessage::FollowContact => {
            page.display.looked_at = None;
            inform(app, "the view follows the contact");
        }
        LiveMessage::Record => match record(page) {
            Ok(effect) => return Some(effect),
            Err(refused) => refuse_recording(app, page, &refused),
        },
        LiveMessage::Mark => mark(app, page),
        // The next one may be a model of the user.
        LiveMessage::NameShape => {
            page.names.awaits_models = true;
            app.jobs.read("Listing the models", |library| {
                let names = ModelFolder::of(library.folder()).names();
                let names: Vec<String> = names.iter().map(ToString::to_string).collect();
                answer(move |app| {
                    let effect = name_by_next(app, &names);
                    perform(app, effect);
                })
            });
        }
        LiveMessage::Again => return watch_again(app, page),
        LiveMessage::Source(source) => return check_source(app, source),
        // These are typed after `:`, and reach the page from there.
        LiveMessage::Open
        | LiveMessage::Watch(_)
        | LiveMessage::AtLeast(_)
        | LiveMessage::Size(_) => {}
    }
    None
}

fn refuse_recording(app: &mut App, page: &Live, refused: &LiveRefusal) {
    let key = |action| app.keymap().label(Context::Live, action);
    let (again, record) = (key(&action::WATCH_AGAIN), key(&action::RECORD));
    let how = match page.check_again() {
        Ok(()) => format!("; {again}, then {record}, records it"),
        Err(_) => String::new(),
    };
    refuse(app, format!("{refused}{how}"));
}

/// Returns the notice about a tare that was made just now of this number of frames. If the page stays at a frame, these
/// end with it, and the notice says so.
fn tare_of(page: &Live, frames: u64) -> String {
    let origin = page.pipeline.origin().filter(|_| !page.cursor.follows());
    match (origin.and_then(|origin| origin.last), frames) {
        (Some((number, _)), 1) => format!("tare of frame {number}"),
        (Some((number, _)), _) => format!("tare of the {frames} frames up to frame {number}"),
        (None, 1) => "tare of 1 frame".to_owned(),
        (None, _) => format!("tare of the last {}", counted(frames, "frame")),
    }
}

fn next_layer(app: &mut App, page: &mut Live) {
    let reason = match page.next_layer() {
        HeatLayer::Tared if page.shows_raw() => "no tare: the values are the raw ones",
        HeatLayer::Imprint if page.rule().is_none() => "no threshold, so there is no imprint",
        _ => return,
    };
    inform(app, reason);
}

pub(in crate::tui) fn name_by_next(app: &mut App, own: &[String]) -> Option<Effect> {
    let number = app.works + 1;
    let page = topmost!(&mut app.dialogs, Live)?;
    if !std::mem::take(&mut page.names.awaits_models) {
        return None;
    }
    app.works = number;
    let own = own.iter().map(|name| ModelChoice::from_text(name));
    page.names.next(own, number);
    let effect = name_by(page);
    let text = match page.names.request() {
        Some(naming) => format!("shapes are named by {}", naming.choice),
        None => "shapes are not named".to_owned(),
    };
    inform(app, text);
    Some(effect)
}

fn look_further(app: &mut App, page: &mut Live, towards: Arrow) {
    if page.display.only_panel {
        let key = app.keymap().label(Context::Live, &action::PANEL);
        return refuse(app, format!("the taxels are hidden; {key} shows them"));
    }
    let area = app.panes();
    let area = area.map(|panes| status::page_area(app, &panes, page));
    let next = area.and_then(|area| view::beyond(page, app.theme(), area, towards));
    if next.is_none() {
        let hides = area.is_some_and(|area| view::hides_taxels(page, area));
        return refuse(
            app,
            if hides || page.reading().is_none() {
                "no more taxels in this direction"
            } else {
                "all taxels are visible"
            },
        );
    }
    if page.display.looked_at.is_none() {
        let key = app.keymap().label(Context::Live, &action::FOLLOW_CONTACT);
        inform(
            app,
            format!("these taxels stay in sight; {key} shows the contact again"),
        );
    }
    page.display.looked_at = next;
}

fn mark(app: &mut App, page: &mut Live) {
    match page.mark() {
        Ok((number, true)) => inform(app, format!("frame {number}: marked")),
        Ok((number, false)) => inform(app, format!("frame {number}: mark removed")),
        Err(refused) => refuse(app, refused.to_string()),
    }
}

/// Returns the next work of the page: new metadata of the recording if threshold, tare or marks have changed
/// since it was written last; otherwise the search for the name of the shown imprint.
///
/// They change by keys, by frames that are withdrawn with their marks, and while the recording is being begun.
pub(in crate::tui) fn next_work(app: &mut App) -> Option<Effect> {
    let page = page(app).filter(|page| !page.stopped())?;
    if let Some(view) = page.take_changed_view() {
        return Some(Effect::Frames(FrameWork::WriteMetadata(Box::new(view))));
    }
    let imprint = page.ask_name()?;
    Some(Effect::Frames(FrameWork::Name(Box::new(imprint))))
}

/// Begins a recording, or ends it. The frames are written as they come, without view, tare or threshold; the
/// metadata of the recording says how they were looked at last.
fn record(page: &mut Live) -> Result<Effect, LiveRefusal> {
    if page.recording().name().is_some() {
        page.set_recording(None);
        return Ok(Effect::Frames(FrameWork::StopRecording));
    }
    if page.status().state.is_final() {
        return Err(LiveRefusal::SourceEnded);
    }
    page.recording.request(page.cursor.next_number());
    let channel = page.status().channel.as_deref();
    let metadata = RecordingMetadata {
        source: page.request().source.name(),
        unit: channel.and_then(|channel| channel.unit.clone()),
        pitch_mm: channel.and_then(|channel| channel.pitch_mm),
        rule: page.rule(),
        tare: page.pipeline.processing.tare.clone(),
        seconds_per_frame: channel.and_then(|channel| channel.seconds_per_frame),
        // Frames that were marked before are not in the recording.
        marks: Vec::new(),
        ended: None,
        ended_by: None,
    };
    Ok(Effect::Frames(FrameWork::Record(Box::new(metadata))))
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LiveRefusal {
    #[error("no frame yet")]
    NoFrame,
    #[error("this frame is no longer in the history")]
    LeftHistory,
    #[error("frame {0} came before the source was watched again; frames since then can be marked")]
    EarlierWatch(u64),
    /// The frames cannot be processed together.
    #[error(transparent)]
    Frame(#[from] FrameError),
    #[error("the source has ended, so there is nothing to record")]
    SourceEnded,
    /// The source is standard input, whose bytes are gone once they are read.
    #[error("standard input cannot be read twice")]
    ReadOnce,
    #[error("the source has not ended yet")]
    NotEnded,
    /// There is no threshold, so it is unknown which values are active.
    #[error("no threshold, so no imprint")]
    NoThreshold,
    #[error("no imprint before the tare: {taken} of {wanted} frames")]
    TareIsMade { taken: u64, wanted: u64 },
    /// The frame cannot be made into an imprint.
    #[error("no imprint: {0}")]
    NoImprint(FrameError),
}

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
    page(app).filter(|page| page.number() == number && !page.stopped())
}

/// Handles a model that cannot be used: shows the reason, and names imprints by the model before it, if there was one.
fn on_no_name(app: &mut App, source: u64, by: u64, reason: &str) -> Option<Effect> {
    let next = app.works + 1;
    let page = watched(app, source).filter(|page| page.names.is_by(by))?;
    page.names.fail(reason, next);
    let returned = (!page.names.is_by(by)).then(|| name_by(page));
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
    let reads_standard = |request: &WatchRequest| request.source == FrameSource::Standard;
    if reads_standard(&request) && page(app).is_some_and(|page| reads_standard(page.request())) {
        refuse(app, LiveRefusal::ReadOnce.to_string());
        return None;
    }
    let (models, access) = (app.jobs.models().clone(), Arc::clone(&app.jobs.access));
    app.jobs
        .read(format!("Opening {}", request.name()), move |_| {
            let found = files::watchable(Arc::new(request), &models, &access);
            answer(|app| match found {
                Ok(request) => {
                    let effect = watch(app, &request);
                    perform(app, Some(effect));
                }
                Err(refused) => refuse(app, refused),
            })
        });
    None
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
    if page.recording.take_stopped() {
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

#[cfg(test)]
mod tests {
    use taxel_core::frame::{Frame, FrameSize};

    use super::*;
    use crate::tui::live::message::FrameBatch;

    /// A recording that is played in a loop: its numbers begin again.
    #[test]
    fn marks_from_before_a_recording_do_not_get_into_it() {
        let mut page = Live::new(Arc::new(WatchRequest::new("none")), 7);
        let take = |page: &mut Live, number| {
            let mut frame = Frame::new(FrameSize::new(2, 2).expect("an allowed size"));
            frame.number = number;
            page.take(&FrameBatch {
                frames: vec![Arc::new(frame)],
                ..FrameBatch::default()
            });
            assert_eq!(page.mark(), Ok((number, true)));
        };
        for number in [5, 6, 0] {
            take(&mut page, number);
        }
        let requested = record(&mut page);
        assert!(matches!(
            requested,
            Ok(Effect::Frames(FrameWork::Record(_)))
        ));
        // The recording has begun before the page hears of it.
        take(&mut page, 1);
        page.set_recording(Some("touch-1.npy".to_owned()));
        take(&mut page, 6);
        let view = page.take_changed_view().expect("frames were marked");
        let numbers: Vec<u64> = view.marks.iter().map(|mark| mark.number).collect();
        assert_eq!(numbers, [1, 6]);
        assert_eq!(page.marks().len(), 5);
    }

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
        let imprint = page.reading().and_then(|reading| reading.imprint);
        assert_eq!(imprint.map(|imprint| imprint.count()), Some(0));
    }
}
