//! The lines at the bottom of the screen.
//!
//! ```text
//! ellipse rx 4.00 ry 4.00 at 4.00, 4.00, 0° + 1 by hand              what made the imprint
//! column  8, row  8  1.000000    active  NA 52 in all                the taxel under the cursor: coverage, state
//! saved as washer                                                    a notice, a question, or a prompt
//! Space toggle  u undo  ? help                                       keys that mean something now
//! ```
//! On a low screen, without a title, the name stands before the source. On a lower one the taxel shares its line with
//! notices, and on the lowest the first line is missing. A notice that needs several lines grows upwards.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::description::Descriptor;
use taxel_core::parameter::Parameter;
use taxel_core::sensor::Sensor;
use taxel_files::formats::value;

use crate::tui::app::change::is_other;
use crate::tui::app::document::Reading;
use crate::tui::app::menu;
use crate::tui::app::page::{Page, Slot, find};
use crate::tui::app::question::Question;
use crate::tui::app::state::{App, Notice};
use crate::tui::app::view::Panes;
use crate::tui::keys::action;
use crate::tui::keys::keymap::Context;
use crate::tui::live::update::recording;
use crate::tui::widget::theme::Role;
use crate::tui::widget::write;

/// The text after the source if the shape is not wholly on the sensor. It is never shortened; the text before it is.
const BEYOND: &str = "; reaches beyond the sensor";

pub fn draw(app: &App, buffer: &mut Buffer, panes: &Panes) -> Option<Position> {
    let (theme, seen) = (app.theme(), app.reading());
    if !hides_matrix(app) {
        let beyond = if seen.beyond { BEYOND } else { "" };
        let room = usize::from(panes.source.width).saturating_sub(beyond.len());
        let source = source(app, panes);
        let source = theme.text(&source);
        let source = write::fitted(&source, room, theme);
        let in_form = app.pane().map(Page::slot) == Some(Slot::Form);
        let line = if in_form && panes.form_panel.is_none() {
            described(app, seen)
        } else {
            taxel(app, seen)
        };
        let pieces = [&*source, beyond].map(|piece| (piece, Role::Text));
        write::line(buffer, panes.source, theme, pieces);
        write::text(buffer, panes.taxel, theme, &line, Role::Text);
    }
    menu::draw(theme, buffer, &menu::hints(app, panes));
    let prompt = app.top_page();
    let prompt = prompt.filter(|page| page.slot() == Slot::Prompt);
    if let Some(page) = prompt {
        page.draw_over(theme, buffer, panes.body);
    }
    let cursor = prompt.and_then(|page| page.draw(theme, app.keymap(), buffer, panes.notice));
    let top = app.top_page();
    if let Some((text, role)) = notice(app, panes, top) {
        let block = block(app, panes, &text);
        write::clear(buffer, block);
        write::wrapped(buffer, block, theme, &text, role);
    }
    cursor
}

fn hides_matrix(app: &App) -> bool {
    let pages = app.pages().filter(|page| page.has_pane());
    let slots: Vec<Slot> = pages.map(Page::slot).collect();
    match slots.last() {
        Some(Slot::Body) => slots.contains(&Slot::Screen),
        top => top == Some(&Slot::Screen),
    }
}

fn source(app: &App, panes: &Panes) -> String {
    let document = app.shown();
    let by_hand = document.edits.count();
    // Where there is no title, the name stands here.
    let own = name(app).filter(|_| panes.title.height == 0);
    let name = own.map_or(String::new(), |name| format!("{name}: "));
    let Some(source) = &document.source else {
        // The text is the same before and after the first taxel, which saves a dozen bytes then.
        let (draw, figure) = (app.key_of(&action::TOGGLE), app.key_of(&action::FIGURE));
        let place = app.key_of(&action::PICTURE);
        let origin = app.history.origin();
        let (made, keys) = match origin.brought_by.as_deref() {
            _ if app.loaded_imprint().is_some() => (
                "stored shape",
                format!("{place} moves and turns it, {draw} draws"),
            ),
            // An imprint from elsewhere is there to be read, not to be drawn on.
            Some(brought_by) if !app.reading().imprint.is_empty() => {
                return name + brought_by;
            }
            brought_by => (
                brought_by.unwrap_or("drawn by hand"),
                format!("{draw} draws, {figure} places a figure"),
            ),
        };
        // Over most pages these keys do something else.
        return if app.context().leads_to(Context::Matrix) {
            format!("{name}{made}: {keys}")
        } else {
            name + made
        };
    };
    let mut text = name + &source.to_string();
    if by_hand > 0 {
        text += &format!(" + {by_hand} by hand");
    }
    text
}

/// Returns the main descriptors. A form that covers all descriptors leaves these visible, so that the user sees them
/// change with each key.
fn described(app: &App, seen: &Reading) -> String {
    let all = format!("NA {} in all", seen.imprint.count());
    let Some(description) = seen.description(app.chosen()) else {
        return all;
    };
    let text = |key: &&str| {
        let descriptor = Descriptor::from_key(key)?;
        let text = value::text((descriptor.measure)(&description), descriptor.dimension)?;
        Some(format!("{} {text}", descriptor.symbol))
    };
    let main = ["na", "nae", "p", "f"].iter().filter_map(text);
    // If the region is the whole imprint, its own count says so.
    let rest = description.na != seen.imprint.count();
    let all = rest.then_some(all);
    main.chain(all).collect::<Vec<_>>().join("  ")
}

/// Returns the line about the taxel under the cursor and the step of moving. Every part has a fixed place, and parts
/// that change together stand together: so little is sent over the line when the cursor moves.
fn taxel(app: &App, seen: &Reading) -> String {
    let all = format!("NA {} in all", seen.imprint.count());
    // The step of moving and zooming, if there is a shape to move.
    let held = if app.held.is_some() { "held, " } else { "" };
    let pen = if app.pen.is_some() { "drawing" } else { "" };
    let step = app.shown().source.as_ref();
    let step = step.map_or(String::new(), |_| format!("{held}step {}", app.step));
    let (column, row) = app.cursor();
    let wide = |side: u8| (side - 1).to_string().len();
    let (across, down) = (wide(seen.imprint.columns()), wide(seen.imprint.rows()));
    let active = seen.imprint.get(column, row);
    let state = format!("{:>8}", if active { "active" } else { "inactive" });
    let covered = seen.coverage(column, row);
    let covered = covered.map_or(String::new(), |coverage| format!("covered {coverage:.6}"));
    let place = format!("column {column:>across$}, row {row:>down$}");
    let mut pieces = vec![place, covered, state, all, step, pen.to_owned()];
    pieces.retain(|piece| !piece.is_empty());
    pieces.join("  ")
}

/// A question stands after the notice.
pub fn notice(app: &App, panes: &Panes, top: Option<&dyn Page>) -> Option<(String, Role)> {
    let last = app.pages.len().saturating_sub(1);
    if let Some(question) = find::<Question>(&app.pages[last..]) {
        return Some((asked(app, panes, question), Role::Error));
    }
    let remark = top.and_then(|page| page.remark(app.keymap(), panes.body));
    let notice = app.notice.as_ref().map(|notice| match notice {
        Notice::Info(text) => (text.clone(), Role::Key),
        Notice::Refusal(text) | Notice::Failure(text) => (format!("! {text}"), Role::Error),
    });
    let waiting = || Some((app.jobs.waiting()?, Role::Key));
    let notice = notice.or_else(waiting);
    match (notice, top.and_then(Page::alarm)) {
        (Some((text, Role::Error)), Some(alarm)) => Some((format!("{text}; {alarm}"), Role::Error)),
        // The mark of an error stands before the error alone.
        (Some((text, _)), Some(alarm)) => Some((format!("{text}; ! {alarm}"), Role::Error)),
        (notice, _) => notice.or(remark),
    }
}

/// Returns a question with its answers, after the notice. Where there is too little room, the notice is left out,
/// then the sentences before the question: the answers are always there.
fn asked(app: &App, panes: &Panes, question: &Question) -> String {
    let answers = question.answers(app.keymap());
    // A question without sentences before it may be too long itself: it has a name in it.
    let (start, end) = match question.about.as_str() {
        "" => (&*question.text, answers),
        about => (about, format!("{} {answers}", question.text)),
    };
    let room = panes.notice.bottom().saturating_sub(panes.body.y);
    let fits = |text: &String| lines(app, panes, text) <= usize::from(room);
    let said = match &app.notice {
        Some(Notice::Info(said) | Notice::Refusal(said) | Notice::Failure(said)) => {
            format!("{said}. ")
        }
        None => String::new(),
    };
    let texts = [format!("{said}{start} {end}"), format!("{start} {end}")];
    texts.into_iter().find(fits).unwrap_or(end)
}

fn lines(app: &App, panes: &Panes, text: &str) -> usize {
    write::broken(&app.theme().text(text), usize::from(panes.notice.width)).len()
}

/// A prompt keeps its line, and the notice stands above it.
pub fn block(app: &App, panes: &Panes, text: &str) -> Rect {
    let is_typed = |page: &dyn Page| page.slot() == Slot::Prompt;
    let is_typed = app.top_page().is_some_and(is_typed);
    let last = Rect {
        y: panes.notice.y - u16::from(is_typed),
        ..panes.notice
    };
    let lines = lines(app, panes, text);
    let room = last.bottom().saturating_sub(panes.body.y);
    let height = u16::try_from(lines).unwrap_or(room).clamp(1, room.max(1));
    Rect {
        y: last.bottom() - height,
        height,
        ..last
    }
}

pub fn page_area(app: &App, panes: &Panes, page: &dyn Page) -> Rect {
    let area = panes.area(page.slot());
    if !page.makes_room() {
        return area;
    }
    let top = app.top_page();
    let over = top.filter(|top| matches!(top.slot(), Slot::Prompt | Slot::Question));
    let text = notice(app, panes, over.or(Some(page))).map(|(text, _)| text);
    let end = text.map_or(area.bottom(), |text| block(app, panes, &text).y);
    Rect {
        height: end.min(area.bottom()).saturating_sub(area.y),
        ..area
    }
}

pub fn title(app: &App) -> String {
    let sensor = &app.shown().sensor;
    let pitch = sensor.pitch_mm();
    let is_set = pitch != sensor.default_value(Parameter::Pitch);
    // The page of the recording is closed or covered.
    let is_recording = recording(app).is_some();
    let parts = [
        Some(sensor.size().to_string()),
        Some(format!("threshold {}", threshold(sensor))),
        is_set.then(|| format!("pitch {pitch} mm")),
        name(app),
        is_recording.then(|| "recording".to_owned()),
    ];
    // In ASCII a dot would be an asterisk, and that is the mark of changes.
    let between = if app.theme().ascii { ", " } else { " · " };
    parts
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(between)
}

/// Returns the name of the document on the matrix, with `*` if it was changed since it was saved. None if it has no
/// name, and if a form shows something else in place of it.
pub(in crate::tui) fn name(app: &App) -> Option<String> {
    let stored = app.stored_name()?;
    if !app.pages.is_empty() && is_other(app, app.shown()) {
        return None;
    }
    let changed = if app.is_changed() { "*" } else { "" };
    Some(format!("{stored}{changed}"))
}

fn threshold(sensor: &Sensor) -> String {
    let (exact, short) = (
        sensor.threshold().to_string(),
        format!("{:.2}", sensor.threshold()),
    );
    if exact.len() > short.len() {
        exact
    } else {
        short
    }
}
