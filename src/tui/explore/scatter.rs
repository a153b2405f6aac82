//! The scatter tab: two descriptors of every imprint that the filter keeps, one against the other.
//!
//! ```text
//! p: perimeter against na: active taxels; 62 imprints      the descriptors, and how many imprints have both values
//! p                     · 1   o 2–9   O 10–99   @ 100+     how many imprints share a character
//! 24 ┤      · oX O                                         X is the selected imprint
//!    └────┬────┬──── na
//! imprint 5: na 22, p 20; 4 poses                          the selected imprint
//! ```
//! Up and down choose the vertical descriptor, which is the one of the other tabs too; left and right choose the
//! horizontal one. A click selects the nearest imprint.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::atlas::{AtlasEntry, features};
use taxel_core::index::wide;
use taxel_files::formats::value::counted;
use taxel_files::formats::{Plot, axis_ends};

use crate::tui::app::message::Message;
use crate::tui::app::page::Wheel;
use crate::tui::explore::imprints::no_row;
use crate::tui::explore::message::ExploreMessage;
use crate::tui::explore::results::Results;
use crate::tui::explore::view::{NOTHING_TO_DRAW, ResultsTab, choose_descriptor};
use crate::tui::keys::keymap::Context;
use crate::tui::widget::plot::{PlotField, draw_no_room};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

const VALUE: usize = 9;

pub static TAB: ResultsTab = ResultsTab {
    title: "scatter",
    context: Context::Scatter,
    filtered: true,
    drawing: Some(drawing),
    table: None,
    wheel: Wheel::Step,
    draw,
    click,
    update,
};

fn update(results: &mut Results, message: &Message, area: Rect) {
    match *message {
        Message::Explore(ExploreMessage::Columns(by)) => results.next_x_feature(by),
        Message::Select(row) => results.list.select(row),
        _ => choose_descriptor(results, message, area),
    }
}

fn point(results: &Results, entry: &AtlasEntry) -> Option<(f64, f64)> {
    let index = wide(entry.id);
    let [x, y] = [results.x_values(), results.values()];
    Some(((*x.get(index)?)?, (*y.get(index)?)?))
}

fn points(results: &Results) -> Vec<(usize, (f64, f64))> {
    let rows = results.rows_from(0);
    rows.filter_map(|(row, entry)| Some((row, point(results, &entry)?)))
        .collect()
}

fn field(area: Rect, points: &[(usize, (f64, f64))]) -> Option<PlotField> {
    let area = Rect {
        height: area.height.saturating_sub(2),
        ..write::below(area, 1)
    };
    let x = axis_ends(points.iter().map(|(_, point)| point.0));
    let y = axis_ends(points.iter().map(|(_, point)| point.1));
    PlotField::of(area, x, y)
}

/// Returns the message of a click: it selects the nearest imprint, or puts it onto the matrix if it is selected
/// already.
fn click(results: &Results, area: Rect, at: Position) -> Option<Message> {
    let points = points(results);
    let field = field(area, &points)?;
    let (x, y) = field.dot(field.point(at)?);
    let far = |(_, point): &&(usize, (f64, f64))| {
        let (other_x, other_y) = field.dot(*point);
        libm::hypot(other_x - x, other_y - y)
    };
    let nearest = points
        .iter()
        .min_by(|one, other| far(one).total_cmp(&far(other)));
    nearest.map(|&(row, _)| {
        if row == results.list.selected() {
            Message::Accept
        } else {
            Message::Select(row)
        }
    })
}

fn title(results: &Results, count: usize) -> String {
    let (x, y) = (&features()[results.x_feature()], results.feature());
    format!(
        "{} against {}; {}",
        y.label(),
        x.label(),
        counted(count as u64, "imprint")
    )
}

/// Returns the position of the selected imprint.
fn draw(results: &Results, theme: &Theme, buffer: &mut Buffer, area: Rect) -> Option<Position> {
    let points = points(results);
    let title = title(results, points.len());
    write::text(buffer, area, theme, &title, Role::Title);
    if points.is_empty() {
        let text = if results.list.row_count() == 0 {
            no_row(results)
        } else {
            "no imprint has both values".to_owned()
        };
        let pieces = [(text.as_str(), Role::Quiet)];
        write::line(buffer, write::row(area, 1), theme, pieces);
        return None;
    }
    let selected = results.rows_from(results.list.selected()).next();
    let foot = write::below(area, area.height.saturating_sub(1));
    if let Some((_, entry)) = selected.filter(|_| area.height > 1) {
        let text = detail(theme, results, &entry);
        write::text(buffer, foot, theme, &text, Role::Text);
    }
    let Some(field) = field(area, &points) else {
        draw_no_room(theme, buffer, area);
        return None;
    };
    let x_key = features()[results.x_feature()].key.as_str();
    field.draw_axes(theme, buffer, [results.feature().key.as_str(), x_key]);
    let style = theme.style(Role::Chosen);
    let all = points.iter().map(|(_, point)| *point);
    field.draw_points(theme, buffer, all, style);
    let (_, entry) = selected?;
    let at = field.character(point(results, &entry)?)?;
    if let Some(cell) = buffer.cell_mut(at) {
        cell.set_char('X').set_style(theme.style(Role::Cursor));
    }
    Some(at)
}

fn detail(theme: &Theme, results: &Results, entry: &AtlasEntry) -> String {
    let formatted = |values: &[Option<f64>]| {
        let value = values.get(wide(entry.id)).copied().flatten();
        theme.number(value, VALUE)
    };
    format!(
        "imprint {}: {} {}, {} {}; {}",
        entry.id,
        features()[results.x_feature()].key,
        formatted(results.x_values()),
        results.feature().key,
        formatted(results.values()),
        counted(entry.count, "pose")
    )
}

fn drawing(results: &Results) -> Result<String, String> {
    let points: Vec<(f64, f64)> = points(results).into_iter().map(|(_, at)| at).collect();
    if points.is_empty() {
        return Err(NOTHING_TO_DRAW.to_owned());
    }
    let (x, y) = (&features()[results.x_feature()], results.feature());
    let mut plot = Plot::new(&x.label(), &y.label());
    plot.title = results.summary(true);
    plot.points = points;
    let selected = results.rows_from(results.list.selected()).next();
    plot.chosen = selected.and_then(|(_, entry)| point(results, &entry));
    Ok(plot.svg())
}
