//! Handles messages while no page lies over the matrix, and messages that follow from a question or a command.

use std::path::Path;

use taxel_core::description::{DESCRIPTORS, Descriptor};
use taxel_core::parameter::Parameter;
use taxel_core::parameter::number::short;
use taxel_core::picture::Picture;
use taxel_core::quote::shortened;
use taxel_core::source::Source;
use taxel_files::formats::file::has_ending;
use taxel_files::formats::{Drawing, ExportFormat, Name, value};
use taxel_files::storage::{self, Existing, UNNAMED};

use crate::tui::app::change::{
    begin, change, compare_with, hold, inform, movable, put_back, refuse, replace, settle, shift,
    travel, turn, write_file, zoom,
};
use crate::tui::app::document::{Document, Reading};
use crate::tui::app::history::{DocumentOrigin, History};
use crate::tui::app::message::{Copied, Endpoint, Layer, Message, Purpose};
use crate::tui::app::state::{App, Display, RunState, STEPS, TerminalEffect};
use crate::tui::app::unsaved::quit;
use crate::tui::explain::Explain;
use crate::tui::explore::ExploreMessage;
use crate::tui::explore::work::explored;
use crate::tui::files::{self, FileToOpen};
use crate::tui::form::FormDialog;
use crate::tui::help::Help;
use crate::tui::jobs::answer;
use crate::tui::keys::action;
use crate::tui::keys::keymap::Context;
use crate::tui::library;
use crate::tui::list::open_list;
use crate::tui::matrix::layers::Layers;
use crate::tui::prompt::{CommandDialog, NameDialog};
use crate::tui::widget::write::around;
use crate::tui::{explore, live, recognise};

/// Copied descriptors, the rectangle and the choice of a region all need a region, and show this notice if there is
/// none.
const NO_REGION: &str = "no region: the matrix is empty";

pub(in crate::tui) fn act(app: &mut App, message: Message) {
    let (column, row) = app.cursor();
    match message {
        Message::New => empty(app),
        Message::Become(document) => replace(app, *document),
        Message::OpenFile(file) => open_file(app, *file),
        Message::WriteFile(name) => write(app, name),
        Message::Quit => quit(app),
        Message::QuitNow => app.run_state = RunState::Quit,
        Message::Copy(what) => copy(app, what),
        Message::Explore(asked) => explore::work::act(app, asked),
        Message::Live(asked) => live::update::act(app, &asked),
        Message::Recognise(asked) => recognise::page::act(app, &asked),
        Message::SaveAs(name) => library::save(app, name, false),
        Message::Named(purpose, name) => library::named(app, purpose, name),
        Message::Restore(name) => library::restore(app, name),
        Message::Compare => compare_with_before(app),
        Message::Load => open_list(app, Purpose::Load),
        Message::Delete => open_list(app, Purpose::Delete),
        Message::Picture => open_picture(app),
        // A held shape stays held, so that a form that is cancelled changes nothing.
        Message::Figure => app.open(FormDialog::figure(app.history.present())),
        Message::Sensor => app.open(FormDialog::sensor(app.history.present())),
        Message::Save => save(app, false),
        Message::Command => app.open(CommandDialog::over(Context::Matrix, app)),
        Message::Draw => draw_on(app),
        Message::Explain => app.open(Explain::new(app)),
        Message::Help => app.open(Help::new(app.context())),
        Message::Cursor(arrow) => {
            let (dx, dy) = arrow.step();
            put_cursor(
                app,
                column.saturating_add_signed(dx),
                row.saturating_add_signed(dy),
            );
        }
        Message::PointAt(column, row) => put_cursor(app, column, row),
        Message::ToColumn(Endpoint::First) => put_cursor(app, 0, row),
        Message::ToColumn(Endpoint::Last) => put_cursor(app, u8::MAX, row),
        Message::ToRow(Endpoint::First) => put_cursor(app, column, 0),
        Message::ToRow(Endpoint::Last) => put_cursor(app, column, u8::MAX),
        Message::Toggle => toggle(app),
        Message::Undo => travel(app, History::undo, "undone", "nothing to undo"),
        Message::Redo => travel(app, History::redo, "redone", "nothing to redo"),
        Message::Region(by) => choose_region(app, by),
        Message::Display => next_display(app),
        Message::Layer(layer) => switch_layer(app, layer),
        Message::SwitchPane => switch_pane(app),
        Message::Hold if app.held.is_some() => app.held = None,
        Message::Hold => hold(app),
        Message::PutBack => put_back(app),
        Message::Nudge(arrow) => {
            let (dx, dy) = arrow.step();
            shift(app, f64::from(dx) * app.step, f64::from(dy) * app.step);
        }
        Message::Move(dx, dy) => shift(app, dx, dy),
        Message::Turn(degrees) => turn(app, degrees),
        Message::Zoom(direction) => zoom(app, direction),
        Message::NudgeStep(direction) => change_step(app, direction),
        // The others mean something only on a page, or never reach the matrix.
        _ => {}
    }
}

fn empty(app: &mut App) {
    let origin = app.history.origin();
    if origin.name.is_none() && app.history.present().is_empty() {
        return refuse(app, "the matrix is empty already");
    }
    let empty = Document::empty(app.history.present().sensor);
    begin(app, DocumentOrigin::of(&empty), empty);
}

fn compare_with_before(app: &mut App) {
    match app.history.before().map(Reading::of) {
        Some(before) => compare_with(app, "the state before", &before.imprint),
        None => refuse(app, "nothing to compare with: this is the first state"),
    }
}

/// Opens the form of the picture or outline on the matrix, or of the stored shape on the matrix as a picture; without either, the
/// list to choose one from. The name in the form is that of the picture, or else of the document. The notice says
/// how to get to another shape, because the key for a picture leads here and no longer to the list.
fn open_picture(app: &mut App) {
    let present = app.history.present();
    let (source, name) = match (&present.source, app.loaded_imprint()) {
        (Some(source @ (Source::Picture(_) | Source::Outline(_))), _) => {
            let name = source.stored_name().or(app.stored_name());
            (source.clone(), name.unwrap_or("imprint"))
        }
        (None, Some((name, imprint))) => (Picture::at_home(*imprint).into(), name),
        _ => return open_list(app, Purpose::Picture),
    };
    let placed = Document::touched(present.sensor, source.named(name));
    app.open(FormDialog::picture(present, placed, name.to_owned()));
    let load = app.key_of(&action::LOAD);
    inform(app, format!("{load} loads another shape"));
}

/// Opens the prompt for a name. It proposes the name of the document if that is a shape of the user's own; a shipped
/// shape cannot be replaced.
pub(crate) fn save(app: &mut App, quits: bool) {
    if app.reading().imprint.is_empty() {
        return refuse(app, "nothing to save: the matrix is empty");
    }
    if library::is_saving(app) {
        return;
    }
    let name = match app.stored() {
        Some(stored) if stored.is_own() => stored.name.clone(),
        _ => {
            let origin = name_of_origin(app);
            let (mut name, mut number) = (origin.clone(), 1);
            while app.history.knows(&name) {
                number += 1;
                name = format!("{origin} {number}");
            }
            name
        }
    };
    app.open(NameDialog::proposing(&name, quits));
}

fn name_of_origin(app: &App) -> String {
    if let Some(stored) = app.stored() {
        return name_of_copy(&stored.name);
    }
    if let Some(proposed) = &app.history.origin().proposed {
        return proposed.clone();
    }
    match &app.history.present().source {
        Some(Source::Figure(figure)) => {
            let size = |&parameter: &Parameter| figure.get(parameter).map(short);
            let sizes: Vec<String> = figure.kind().sizes().iter().filter_map(size).collect();
            let name = format!("{} {}", figure.kind().name(), sizes.join(" x "));
            match figure.get(Parameter::Thickness) {
                Some(thickness) if figure.has_hole() => {
                    format!("{name} thickness {}", short(thickness))
                }
                _ => name,
            }
        }
        Some(source) => match source.stored_name() {
            Some(name) => format!("{name} moved"),
            None => source.noun().to_owned(),
        },
        None => "drawing".to_owned(),
    }
}

pub(in crate::tui) fn name_of_copy(name: &str) -> String {
    format!("{name} copy")
}

/// Shows the coverage in shades, then in percent, then the imprint again. Coverage is the share of a taxel that a shape
/// covers, so it is refused if there is no source.
fn next_display(app: &mut App) {
    if app.history.present().source.is_none() {
        app.display = Display::Imprint;
        return refuse(app, format!("no coverage to show: {}", has_none(app)));
    }
    let is_large = app.grid().is_some_and(|grid| grid.size.is_large());
    let text = match app.display {
        Display::Imprint => "coverage in shades",
        Display::Shades if is_large => "coverage in percent",
        Display::Shades => "coverage in percent; one digit stands for tens: 5 is 50 to 59 %",
        Display::Percent => "active taxels",
    };
    app.display = match app.display {
        Display::Imprint => Display::Shades,
        Display::Shades => Display::Percent,
        Display::Percent => Display::Imprint,
    };
    inform(app, text);
}

/// Begins to draw with the cursor, in the state that its taxel gets, or stops.
fn draw_on(app: &mut App) {
    if app.pen.take().is_some() {
        return inform(app, "no longer drawing");
    }
    let (column, row) = app.cursor();
    let active = !app.reading().imprint.get(column, row);
    toggle(app);
    app.pen = Some(active);
    let what = if active { "draw" } else { "erase" };
    let stop = app.key_of(&action::DRAW);
    inform(app, format!("the arrows {what}, {stop} stops"));
}

fn toggle(app: &mut App) {
    let mut document = app.history.present().clone();
    let (column, row) = app.cursor();
    document.edits.toggle(column, row);
    change(app, document);
}

fn switch_pane(app: &mut App) {
    if app.panes().is_some_and(|panes| panes.panel.is_some()) {
        return refuse(app, "both sides of the screen are visible");
    }
    app.shows_panel = !app.shows_panel;
}

/// Sends a text to the terminal, which may put it into its clipboard, but never reports whether it does. Descriptors
/// are one to a line, key and value with a tab between; the imprint is in the form of its text files.
fn copy(app: &mut App, what: Copied) {
    let seen = app.reading();
    let (name, text) = match (what, seen.description(app.chosen())) {
        (Copied::Imprint, _) => ("imprint", seen.imprint.to_string() + "\n"),
        (Copied::Descriptors, None) => return refuse(app, NO_REGION),
        (Copied::Descriptors, Some(description)) => {
            let line = |descriptor: &Descriptor| {
                let value = value::text((descriptor.measure)(&description), descriptor.dimension);
                format!("{}\t{}\n", descriptor.key, value.as_deref().unwrap_or("–"))
            };
            ("descriptors", DESCRIPTORS.iter().map(line).collect())
        }
    };
    let length = value::counted(text.chars().count() as u64, "character");
    inform(
        app,
        format!("{name} sent to your terminal's clipboard ({length})"),
    );
    app.terminal = Some(TerminalEffect::Copy(text));
}

fn has_none(app: &App) -> String {
    let (figure, place) = (app.key_of(&action::FIGURE), app.key_of(&action::PICTURE));
    if app.loaded_imprint().is_some() {
        format!("a stored imprint has none; {place} places it as a picture")
    } else if app.history.present().edits.is_empty() {
        format!("the matrix is empty; {figure} places a figure")
    } else {
        format!("a drawing has none; {figure} places a figure, which has")
    }
}

/// Shows a layer or hides it. The notice names it, and says why if there is nothing to see yet. Whether a layer is shown
/// by default depends on the size of taxels, so the switch inverts what is visible now.
fn switch_layer(app: &mut App, layer: Layer) {
    let Some(grid) = app.grid() else { return };
    let no_source = app
        .shown()
        .source
        .is_none()
        .then(|| format!(": {}", has_none(app)));
    let no_region = app.reading().regions.is_empty();
    let (name, missing, shown) = match layer {
        Layer::Outline => ("the outline", no_source, &mut app.layers.outline),
        Layer::Rectangle => (
            "rectangle, CG (G) and CD (D)",
            no_region.then(|| ", once there is a region".to_owned()),
            &mut app.layers.rectangle,
        ),
        Layer::Fit => (
            "the outline of the fitted shape",
            app.recognition
                .fitted
                .is_none()
                .then(|| ", once there is one".to_owned()),
            &mut app.layers.fit,
        ),
    };
    let show = !Layers::shown(*shown, &grid);
    *shown = Some(show);
    let text = if show {
        format!("with {name}{}", missing.unwrap_or_default())
    } else {
        format!("without {name}")
    };
    inform(app, text);
}

/// Takes the next larger or smaller step. A notice says if there is none. Refused if there is no shape to move.
fn change_step(app: &mut App, direction: i8) {
    if movable(app).is_none() {
        return;
    }
    let now = STEPS.iter().position(|&step| step == app.step);
    let next = now.and_then(|now| now.checked_add_signed(direction.into()));
    if let Some(&step) = next.and_then(|next| STEPS.get(next)) {
        app.step = step;
    } else {
        let end = ["smallest", "largest"][usize::from(direction > 0)];
        refuse(app, format!("{} is the {end} step", app.step));
    }
}

/// Puts the cursor on a taxel, or the nearest one on the sensor.
fn put_cursor(app: &mut App, column: u8, row: u8) {
    let sensor = app.history.present().sensor;
    app.cursor = (column.min(sensor.columns() - 1), row.min(sensor.rows() - 1));
    // The taxels of a run are one change, like those of a drag.
    if let Some(active) = app.pen {
        let (column, row) = app.cursor();
        let mut document = app.history.present().clone();
        if app.reading().imprint.get(column, row) != active {
            document.edits.toggle(column, row);
        }
        app.history.amend(document);
        settle(app);
    }
}

/// Until a region is chosen, the main region is described, and `by` counts from it.
fn choose_region(app: &mut App, by: i8) {
    // Also if the region stays the same: it may be out of sight.
    app.follows_region = true;
    let seen = app.reading();
    let Some((now, _)) = seen.region(app.chosen()) else {
        return refuse(app, NO_REGION);
    };
    let count = seen.regions.len();
    if count == 1 {
        return inform(app, "there is no other region");
    }
    app.history.choose(Some(around(now, by, count)));
}

/// Returns true unless the matrix would refuse a message. Only messages of keys with a hint are looked at. One without
/// an arm here keeps its hint, as on a page ([`crate::tui::app::page::Page::has_use_for`]): if it is refused, its key
/// says why.
pub(in crate::tui) fn is_usable(app: &App, message: &Message) -> bool {
    match message {
        Message::Undo => app.history.can_undo(),
        // With a single region, the key brings it into sight.
        Message::Region(_) => !app.reading().regions.is_empty(),
        Message::Explore(ExploreMessage::Open) => explored(app).is_some(),
        // A drawing has neither coverage nor a position.
        Message::Display | Message::Hold | Message::Turn(_) | Message::NudgeStep(_) => {
            app.history.present().source.is_some()
        }
        _ => true,
    }
}

const ENDINGS: &str = ".txt .csv .npy .json .svg";

fn write(app: &mut App, name: String) {
    if app.reading().imprint.is_empty() {
        return refuse(app, "nothing to write: the matrix is empty");
    }
    match content(app, &name) {
        Ok(content) => write_file(app, name, Existing::Kept, move |path, existing| {
            storage::write(path, &content, existing)
        }),
        Err(reason) => refuse(app, reason),
    }
}

fn content(app: &App, name: &str) -> Result<Vec<u8>, String> {
    let document = app.shown();
    if let Some(format) = ExportFormat::of_path(name) {
        let mut drawing = Drawing::new(&app.reading().imprint);
        if let Some(source) = &document.source {
            drawing = drawing.with_outline(source);
        }
        drawing.pitch_mm = Some(document.sensor.pitch_mm()).filter(|&pitch| pitch != 1.0);
        drawing.region = app.chosen().or(drawing.region);
        return Ok((format.write)(&drawing));
    }
    if !has_ending(name, "json") {
        let name = shortened(name);
        return Err(format!(
            "{name:?}: expected a name that ends in one of {ENDINGS}"
        ));
    }
    let own = Path::new(name).file_stem().and_then(|stem| stem.to_str());
    let own = app.stored_name().or(own).unwrap_or(UNNAMED);
    let name = Name::new(own).or_else(|_| Name::new(UNNAMED));
    let name = name.map_err(|error| error.to_string())?;
    Ok(document.to_shape(name).write().into_bytes())
}

fn open_file(app: &mut App, file: FileToOpen) {
    let (sensor, change) = (app.history.present().sensor, app.key_of(&action::SENSOR));
    app.jobs.read(format!("Opening {}", file.name), move |_| {
        let opened = files::open(&file, sensor, &change);
        answer(move |app| match opened {
            Ok((document, left_out)) => {
                let opened = format!("{} opened", file.name);
                let mut origin = DocumentOrigin::of(&document).called(&opened);
                let source = document.source.as_ref();
                origin.proposed = source.and_then(Source::stored_name).map(str::to_owned);
                begin(app, origin, document);
                app.history.choose(None);
                inform(
                    app,
                    opened + &left_out.map_or(String::new(), |own| format!("; {own}")),
                );
            }
            Err(reason) => refuse(app, format!("{}: {reason}", file.name)),
        })
    });
}
