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
use taxel_files::formats::value;

use crate::tui::app::view::Panes;
use crate::tui::app::{App, Canvas, Page, Place, Question, Reading, find, is_other, menu};
use crate::tui::keys::{Context, action};
use crate::tui::live::update::recording;
use crate::tui::widget::Role;
use crate::tui::widget::write::{self, narrow};

/// The text after the source if the shape is not wholly on the sensor. It is never shortened; the text before it is.
const BEYOND: &str = "; reaches beyond the sensor";

pub(crate) fn draw(app: &App, buffer: &mut Buffer, panes: &Panes) -> Option<Position> {
    let (theme, seen) = (&app.theme, app.reading());
    if !hides_matrix(app) {
        let beyond = if seen.beyond { BEYOND } else { "" };
        let room = usize::from(panes.source.width).saturating_sub(beyond.len());
        let source = source(app, panes);
        let source = theme.text(&source);
        let source = write::fitted(&source, room, theme);
        let pieces = [&*source, beyond].map(|piece| (piece, Role::Text));
        write::line(buffer, panes.source, theme, pieces);
        let in_form = app.pane().map(Page::place) == Some(Place::Form);
        let line = if in_form && panes.form_panel.is_none() {
            described(app, seen)
        } else {
            taxel(app, seen)
        };
        write::text(buffer, panes.taxel, theme, &line, Role::Text);
    }
    menu::draw(theme, buffer, &menu::hints(app, panes));
    let top = app.top_page();
    let prompt = top.filter(|page| page.place() == Place::Prompt);
    let cursor = prompt.and_then(|page| {
        page.draw_over(theme, buffer, panes.body);
        page.draw(Canvas::of(app, buffer), panes.notice)
    });
    if let Some((text, role)) = notice(app, panes, top) {
        let block = block(app, panes, &text);
        write::clear(buffer, block);
        write::wrapped(buffer, block, theme, &text, role);
    }
    cursor
}

fn hides_matrix(app: &App) -> bool {
    let mut slots = app.pages().filter(|page| page.has_pane()).map(Page::place);
    match slots.next_back() {
        Some(Place::Body) => slots.any(|slot| slot == Place::Screen),
        top => top == Some(Place::Screen),
    }
}

fn source(app: &App, panes: &Panes) -> String {
    let document = app.shown();
    // Where there is no title, the name stands here.
    let own = name(app).filter(|_| panes.title.height == 0);
    let name = own.map_or(String::new(), |name| format!("{name}: "));
    if let Some(source) = &document.source {
        return match document.edits.count() {
            0 => format!("{name}{source}"),
            by_hand => format!("{name}{source} + {by_hand} by hand"),
        };
    }
    let (draw, place) = (app.key_of(&action::TOGGLE), app.key_of(&action::PICTURE));
    let brought_by = app.history.origin().brought_by.as_deref();
    let (made, keys) = match brought_by {
        _ if app.loaded_imprint().is_some() => (
            "stored shape",
            format!("{place} moves and turns it, {draw} draws"),
        ),
        // An imprint from elsewhere is there to be read, not to be drawn on.
        Some(brought_by) if !app.reading().imprint.is_empty() => return name + brought_by,
        // The text is the same before and after the first taxel, which saves a dozen bytes then.
        brought_by => {
            let figure = app.key_of(&action::FIGURE);
            let made = brought_by.unwrap_or("drawn by hand");
            (made, format!("{draw} draws, {figure} places a figure"))
        }
    };
    // Over most pages these keys do something else.
    if app.context().leads_to(Context::Matrix) {
        format!("{name}{made}: {keys}")
    } else {
        name + made
    }
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
    let (column, row) = app.cursor();
    let wide = |side: u8| (side - 1).to_string().len();
    let (across, down) = (wide(seen.imprint.columns()), wide(seen.imprint.rows()));
    let covered = seen.coverage(column, row);
    let is_active = seen.imprint.get(column, row);
    let state = if is_active { "  active" } else { "inactive" };
    // The step of moving and zooming, if there is a shape to move.
    let held = if app.held.is_some() { "held, " } else { "" };
    let step = app.shown().source.as_ref();
    let pieces = [
        Some(format!("column {column:>across$}, row {row:>down$}")),
        covered.map(|coverage| format!("covered {coverage:.6}")),
        Some(state.to_owned()),
        Some(format!("NA {} in all", seen.imprint.count())),
        step.map(|_| format!("{held}step {}", app.step)),
        app.pen.map(|_| "drawing".to_owned()),
    ];
    pieces.into_iter().flatten().collect::<Vec<_>>().join("  ")
}

/// A question stands after the notice.
fn notice(app: &App, panes: &Panes, top: Option<&dyn Page>) -> Option<(String, Role)> {
    let last = app.pages.len().saturating_sub(1);
    if let Some(question) = find::<Question>(&app.pages[last..]) {
        return Some((asked(app, question), Role::Error));
    }
    let notice = app.notice.as_ref().map(|said| {
        if said.is_refusal {
            (format!("! {}", said.text), Role::Error)
        } else {
            (said.text.clone(), Role::Key)
        }
    });
    let notice = notice.or_else(|| Some((app.jobs.waiting()?, Role::Key)));
    match (notice, top.and_then(Page::alarm)) {
        (Some((text, role)), Some(alarm)) => {
            // The mark of an error stands before the error alone.
            let mark = if role == Role::Error { "" } else { "! " };
            Some((format!("{text}; {mark}{alarm}"), Role::Error))
        }
        (notice, _) => notice.or_else(|| top?.remark(&app.keymap, panes.body)),
    }
}

/// Returns a question with its answers, after the notice.
fn asked(app: &App, question: &Question) -> String {
    let end = format!("{} {}", question.text, question.answers(&app.keymap));
    let said = app.notice.as_ref().map(|said| format!("{}.", said.text));
    let about = Some(question.about.clone()).filter(|about| !about.is_empty());
    let sentences = [said, about, Some(end)].into_iter().flatten();
    sentences.collect::<Vec<_>>().join(" ")
}

/// A prompt keeps its line, and the notice stands above it.
fn block(app: &App, panes: &Panes, text: &str) -> Rect {
    let is_typed = app.top_page().map(Page::place) == Some(Place::Prompt);
    let bottom = panes.notice.bottom() - u16::from(is_typed);
    let room = bottom.saturating_sub(panes.body.y).max(1);
    let text = app.theme.text(text);
    let lines = write::broken(&text, usize::from(panes.notice.width)).len();
    let height = narrow(lines).clamp(1, room);
    Rect {
        y: bottom - height,
        height,
        ..panes.notice
    }
}

/// Returns the place of a page. The live page, where messages stay as long as their reason, ends above a notice of
/// several lines instead of being covered by it.
pub(crate) fn page_area(app: &App, panes: &Panes, page: &dyn Page) -> Rect {
    let area = panes.area(page.place());
    if page.context() != Context::Live {
        return area;
    }
    let over = app.top_page().filter(|top| !top.has_pane());
    let said = notice(app, panes, over.or(Some(page)));
    let end = said.map_or(area.bottom(), |(text, _)| block(app, panes, &text).y);
    Rect {
        height: end.min(area.bottom()).saturating_sub(area.y),
        ..area
    }
}

pub fn title(app: &App) -> String {
    let sensor = &app.shown().sensor;
    let threshold = sensor.threshold();
    let texts = [threshold.to_string(), format!("{threshold:.2}")];
    let threshold = texts
        .into_iter()
        .max_by_key(String::len)
        .unwrap_or_default();
    let pitch = sensor.pitch_mm();
    let is_set = pitch != sensor.default_value(Parameter::Pitch);
    // The page of the recording is closed or covered.
    let is_recording = recording(app).is_some();
    let parts = [
        Some(sensor.size().to_string()),
        Some(format!("threshold {threshold}")),
        is_set.then(|| format!("pitch {pitch} mm")),
        name(app),
        is_recording.then(|| "recording".to_owned()),
    ];
    // In ASCII a dot would be an asterisk, and that is the mark of changes.
    let between = if app.theme.ascii { ", " } else { " · " };
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
    // An empty one may differ, too, although nothing is lost.
    let is_changed = *app.history.present() != app.history.origin().saved;
    let changed = if is_changed { "*" } else { "" };
    Some(format!("{stored}{changed}"))
}
