//! The distinct imprints: a row each, thumbnails from the selected one on, and all about that one.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::atlas::{AtlasEntry, SortKey};
use crate::formats::value::{counted, fitting, grouped};
use crate::pose::Pose;
use crate::tui::app::state::App;
use crate::tui::explore::imprints::layout::{ImprintList, SHARE, VALUE};
use crate::tui::explore::results::Results;
use crate::tui::widget::theme::Role;
use crate::tui::widget::{thumbnail, write};

/// Draws the page; answers where the selected row is.
pub fn draw(app: &App, results: &Results, buffer: &mut Buffer, page: Rect) -> Option<Position> {
    let list = ImprintList::of(page, results);
    let theme = app.theme();
    let head = heading(app, results, &list);
    write::line(buffer, list.head, theme, [(head.as_str(), Role::Title)]);
    let visible = usize::from(list.rows.height);
    let mut cursor = None;
    for (index, entry) in results.rows_from(list.first).take(visible) {
        let row = write::row(list.rows, index - list.first);
        let selected = index == results.selected();
        let (sign, role) = if selected {
            ("> ", Role::Focus)
        } else {
            ("  ", Role::Text)
        };
        let text = row_text(app, results, &list, &entry);
        let pieces = [(sign, Role::Key), (text.as_str(), role)];
        write::line(buffer, row, theme, pieces);
        if selected {
            cursor = Some(Position::new(row.x, row.y));
            let text = detail(app, results, &entry);
            write::line(buffer, list.detail, theme, [(text.as_str(), Role::Text)]);
        }
    }
    if let Some(area) = list.gallery {
        draw_gallery(app, results, buffer, area);
    }
    cursor
}

/// The headings, an arrow at what the rows are sorted by.
fn heading(app: &App, results: &Results, list: &ImprintList) -> String {
    let (by, descending) = results.sort_key();
    let marked = |title: &str, key: SortKey| {
        let arrow = (by == key).then(|| app.theme().sorted(descending));
        arrow.into_iter().chain(title.chars()).collect::<String>()
    };
    let (id, poses) = (list.id, list.poses);
    let mut text = format!(
        "  {:>id$} {:>poses$} {:>SHARE$}",
        marked("#", SortKey::FirstPose),
        marked("poses", SortKey::Poses),
        "%"
    );
    for &(axis, width) in &list.place {
        text += &format!(" {:>width$}", axis.parameter().row().short);
    }
    let key: String = results.feature().key.chars().take(VALUE - 1).collect();
    text += &format!(
        " {:>2} {:>2} {:>VALUE$}",
        marked("p", SortKey::Pieces),
        marked("h", SortKey::Holes),
        marked(&key, SortKey::Value)
    );
    text
}

fn row_text(app: &App, results: &Results, list: &ImprintList, entry: &AtlasEntry) -> String {
    let (id, poses) = (list.id, list.poses);
    let mut text = format!(
        "{:>id$} {:>poses$} {:>SHARE$}",
        entry.id,
        grouped(entry.count),
        share(results, entry)
    );
    let pose = results.sweep().grid.pose(entry.first_pose);
    for &(axis, width) in &list.place {
        text += &format!(" {:>width$}", axis.parameter().format(pose[axis]));
    }
    text += &format!(" {:>2} {:>2}", entry.summary.pieces, entry.summary.holes);
    text += &format!(" {:>VALUE$}", number(app, results, entry));
    text
}

/// In percent.
fn share(results: &Results, entry: &AtlasEntry) -> String {
    let share = crate::formats::atlas::share(results.sweep(), entry) * 100.0;
    format!("{share:.2}")
}

/// The chosen descriptor's value.
fn number(app: &App, results: &Results, entry: &AtlasEntry) -> String {
    let index = usize::try_from(entry.id).unwrap_or(usize::MAX);
    let value = results.values().get(index).copied().flatten();
    value.map_or_else(
        || app.theme().none().to_owned(),
        |value| fitting(value, VALUE - 1),
    )
}

/// All about an imprint in one line.
fn detail(app: &App, results: &Results, entry: &AtlasEntry) -> String {
    let pose = results.sweep().grid.pose(entry.first_pose);
    let count = |count: u16, noun: &str| counted(count.into(), noun);
    format!(
        "imprint {} at {}; {}, {}, {} {}",
        entry.id,
        place(results, &pose),
        count(entry.summary.pieces, "piece"),
        count(entry.summary.holes, "hole"),
        results.feature().key,
        number(app, results, entry)
    )
}

/// A pose in words.
pub(in crate::tui) fn place(results: &Results, pose: &Pose) -> String {
    let grid = &results.sweep().grid;
    let values = grid.axes().map(|axis| {
        let parameter = axis.parameter();
        let text = parameter.format(pose[axis]);
        format!("{} {text}", parameter.row().short)
    });
    values.collect::<Vec<_>>().join(", ")
}

/// Thumbnails of the selected imprint and those after it, in lines from left to right.
fn draw_gallery(app: &App, results: &Results, buffer: &mut Buffer, area: Rect) {
    let theme = app.theme();
    let Some((_, first)) = results.rows_from(results.selected()).next() else {
        return;
    };
    let (width, height) = thumbnail::size(app, &first.imprint);
    let (width, height) = (
        width.min(area.width),
        height.min(area.height.saturating_sub(1)),
    );
    if width == 0 || height == 0 {
        return;
    }
    let across = (area.width + 2) / (width + 2);
    // A caption stands over each.
    let down = area.height / (height + 1);
    let places =
        (0..down.max(1)).flat_map(|line| (0..across.max(1)).map(move |column| (column, line)));
    for ((column, line), (index, entry)) in places.zip(results.rows_from(results.selected())) {
        let place = Rect {
            x: area.x + column * (width + 2),
            y: area.y + line * (height + 1),
            width,
            height: height + 1,
        };
        let place = place.intersection(area);
        let sign = if index == results.selected() {
            ">"
        } else {
            "#"
        };
        let caption = format!("{sign}{}", entry.id);
        write::line(buffer, place, theme, [(caption.as_str(), Role::Key)]);
        thumbnail::draw(app, &entry.imprint, buffer, write::below(place, 1));
    }
}
