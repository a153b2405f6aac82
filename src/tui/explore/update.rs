//! Handles messages over the results of a sweep, and in the prompt for the name of an export. The other prompts have
//! [`crate::tui::explore::prompts`].
//!
//! Messages that mean the same on all tabs are handled here: the tab, the descriptor, the order, the map's angle and
//! zoom. Scrolling and selecting are left to the tab's own row in [`crate::tui::explore::view`].

use taxel_core::pose::Axis;
use taxel_core::touch::Plane;
use taxel_files::formats::value::{counted, grouped};
use taxel_files::storage::{Existing, is_poses};

use crate::tui::app::change::{change, compare_with, inform, let_go, refuse, write_file};
use crate::tui::app::document::{Document, Reading};
use crate::tui::app::message::Message;
use crate::tui::app::page::Flow;
use crate::tui::app::state::App;
use crate::tui::explore::message::{ExploreMessage, ExploreTab, name_of};
use crate::tui::explore::prompts::{ExportDialog, ExportKind, FilterDialog};
use crate::tui::explore::results::Results;
use crate::tui::explore::view;
use crate::tui::explore::work::{act, open_ranges, tab_area};
use crate::tui::keys::action;
use crate::tui::runtime::perform;

/// Closed results are kept, and Explore opens them again for the same shape.
pub(crate) fn in_results(results: &mut Results, app: &mut App, message: &Message) -> Flow {
    match message {
        Message::Accept => return put_onto_matrix(results, app),
        Message::Cancel | Message::Quit => return Flow::Close,
        Message::Compare => compare(app, results),
        Message::Explore(ExploreMessage::Export) => return Flow::push(export_of(results)),
        Message::Explore(ExploreMessage::Filter) => return Flow::push(FilterDialog::new(results)),
        Message::Explore(ExploreMessage::Ranges) => {
            open_ranges(app, Some(&results.sweep().grid));
        }
        message => {
            if let Message::Explore(asked) = message {
                change_view(app, results, asked);
            }
            let area = tab_area(app, results);
            let before = results.map_zoom;
            (view::row(results.tab).update)(results, message, area);
            if let (Message::Zoom(by), ExploreTab::Map) = (message, results.tab)
                && results.map_zoom == before
            {
                let end = ["this is the whole range", "every pose has its letter"];
                refuse(app, end[usize::from(*by > 0)]);
            }
        }
    }
    Flow::Stay
}

/// Refused if nothing is selected.
fn compare(app: &mut App, results: &Results) {
    let entry = results.rows_from(results.list.selected()).next();
    match entry {
        Some((_, entry)) => compare_with(app, &format!("imprint {}", entry.id), &entry.imprint),
        None => refuse(app, "nothing is selected here"),
    }
}

/// Returns the prompt for a file. It proposes the tab's drawing or table if it has one, otherwise the table of
/// imprints.
fn export_of(results: &Results) -> ExportDialog {
    // A slash would separate folders.
    let name = name_of(results.sweep().grid.source()).replace('/', "-");
    let row = view::row(results.tab);
    let name = match (row.drawing, row.table) {
        (Some(_), _) => format!("{name}-{}.svg", row.title),
        (_, Some(_)) => format!("{name}-{}.csv", row.title),
        _ => format!("{name}.csv"),
    };
    ExportDialog::proposing(&name, ExportKind::of(results))
}

/// Handles messages that change only what is shown, not the document, so that there is nothing to undo.
fn change_view(app: &mut App, results: &mut Results, asked: &ExploreMessage) {
    match *asked {
        ExploreMessage::Tab(tab) => results.open_tab(tab),
        ExploreMessage::NextTab(by) => results.next_tab(by),
        ExploreMessage::Feature(_) if results.tab == ExploreTab::Map => {
            refuse(app, "the map shows no descriptor");
        }
        ExploreMessage::Feature(by) => results.next_feature(by),
        ExploreMessage::Sort(by) => results.sort(by),
        ExploreMessage::SortHere => results.sort(results.list.heading()),
        ExploreMessage::Find => find(app, results),
        ExploreMessage::Follow => follow(app, results),
        ExploreMessage::Point(x0, y0) => results.point(x0, y0),
        ExploreMessage::Angle(by) => match only_one(app, results, Axis::Angle) {
            Some(text) => refuse(app, text),
            None => results.turn(by),
        },
        ExploreMessage::ToAngle(index) => results.to_angle(index),
        ExploreMessage::Along(axis, by) => match only_one(app, results, axis) {
            Some(text) => refuse(app, text),
            None => results.move_along(axis, by.into()),
        },
        _ => {}
    }
}

fn only_one(app: &App, results: &Results, axis: Axis) -> Option<String> {
    let grid = &results.sweep().grid;
    let name = axis.parameter().row().short;
    if !grid.axes().any(|own| own == axis) {
        return Some(format!("a figure has no {name}"));
    }
    let here = view::row(results.tab).context;
    let ranges = app.keymap().label(here, &action::RANGES);
    let is_only = grid.counts()[axis] == 1;
    is_only.then(|| format!("only one {name} was swept; {ranges} explores other ranges"))
}

/// Selects the imprint on the matrix, or the same imprint at another place: a shape moved by whole cells leaves an
/// imprint moved by as many taxels. A notice says where it lies on the matrix, relative to the one in the list.
fn find(app: &mut App, results: &mut Results) {
    let imprint = app.reading().imprint;
    if let Some(id) = results.id(&imprint) {
        if let Err(reason) = results.go_to_imprint(id) {
            refuse(app, reason);
        }
        return;
    }
    match results.sweep().atlas.find_shifted(&imprint) {
        Some(found) => {
            if let Err(reason) = results.go_to_imprint(found.id) {
                return refuse(app, reason);
            }
            let way = |by: i8, noun: &str, [less, more]: [&str; 2]| {
                let count = counted(by.unsigned_abs(), noun);
                let towards = if by < 0 { less } else { more };
                (by != 0).then(|| format!("{count} {towards}"))
            };
            let ways = [
                way(found.right, "column", ["to the left", "to the right"]),
                way(found.down, "row", ["up", "down"]),
            ];
            let ways: Vec<String> = ways.into_iter().flatten().collect();
            let ways = ways.join(" and ");
            inform(
                app,
                format!("the same imprint; on the matrix it lies {ways}"),
            );
        }
        None => refuse(app, "the imprint on the matrix is not among these"),
    }
}

/// Refused for a pose whose imprint a stopped sweep has not found.
fn follow(app: &mut App, results: &mut Results) {
    let Some(pose) = results.pose() else {
        return refuse(app, "nothing is selected here");
    };
    if !matches!(results.tab, ExploreTab::Map | ExploreTab::Angles) {
        results.go_to_pose(pose);
        return results.open_tab(ExploreTab::Map);
    }
    match results.go_to_imprint_at(pose) {
        Ok(()) => results.open_tab(ExploreTab::Imprints),
        Err(reason) => refuse(app, reason),
    }
}

/// Puts the shape onto the matrix in the present pose, with just the imprint that the sweep found. The user may have
/// another sensor by now. Taxels that it reads differently are set by hand, so that the imprint is the selected one.
fn put_onto_matrix(results: &Results, app: &mut App) -> Flow {
    let grid = &results.sweep().grid;
    let Some(pose) = results.pose() else {
        refuse(app, "nothing is selected here");
        return Flow::Stay;
    };
    let source = match grid.source_at(grid.pose(pose)) {
        Ok(source) => source,
        Err(error) => {
            refuse(app, error.to_string());
            return Flow::Stay;
        }
    };
    let imprint = Plane::new(*grid.sensor()).touch(&grid.placed(pose));
    let mut document = Document::touched(app.history.present().sensor, source);
    document.edits = Reading::of(&document).imprint.differing(&imprint);
    let number = results
        .id(&imprint)
        .map_or(String::new(), |id| format!("imprint {id} "));
    let_go(app);
    change(app, document);
    app.history.choose(None);
    let undo = app.key_of(&action::UNDO);
    let explore = app.key_of(&action::EXPLORE);
    inform(
        app,
        format!("{number}on the matrix; {undo} takes it back, {explore} returns to Explore"),
    );
    Flow::Close
}

pub(crate) fn in_export(dialog: &mut ExportDialog, app: &mut App, message: &Message) -> Flow {
    if *message == Message::Accept {
        match dialog.name() {
            Ok(name) => return export(app, name),
            Err(error) => refuse(app, error),
        }
    } else {
        dialog.field.take(message);
    }
    Flow::Stay
}

/// The export of a sweep shows its progress, and opens the prompt again itself.
fn export(app: &mut App, name: String) -> Flow {
    let Some(results) = app.results_below() else {
        return Flow::Close;
    };
    if let Some(file) = view::file(results, &name, tab_area(app, results)) {
        return Flow::ask(|app| write_file(app, name, file, Existing::Kept));
    }
    if let Some(missing) = missing_poses(results, &name) {
        refuse(app, missing);
        return Flow::Stay;
    }
    let effect = act(app, ExploreMessage::Write(name, Existing::Kept));
    perform(app, effect);
    Flow::Close
}

/// Returns why a file of poses cannot be written; None if all poses were swept, or if the file holds something else.
fn missing_poses(results: &Results, name: &str) -> Option<String> {
    let result = results.sweep();
    (is_poses(name) && !result.complete()).then(|| {
        format!(
            ".npy needs all poses: only {} of {} were swept",
            grouped(result.poses),
            grouped(result.grid.poses())
        )
    })
}
