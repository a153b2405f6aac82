//! The scatter tab: two descriptors of every imprint that the filter keeps, one against the other.
//!
//! ```text
//! P (p): outline length against NA (na): active taxels; 62 imprints    the descriptors, how many have both values
//! p                     · 1   o 2–9   O 10–99   @ 100+                 how many imprints share a character
//! 24 ┤      · oX O                                                     X is the selected imprint
//!    └────┬────┬──── na
//! imprint 5: na 22, p 20; 4 poses                                      the selected imprint
//! ```
//! Up and down choose the vertical descriptor, which is the one of the other tabs too; left and right choose the
//! horizontal one. A click selects the nearest imprint.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::atlas::features;
use taxel_files::formats::value::counted;
use taxel_files::formats::{Plot, axis_ends};

use crate::tui::app::message::Message;
use crate::tui::app::page::Wheel;
use crate::tui::app::state::App;
use crate::tui::explore::ExploreMessage;
use crate::tui::explore::results::{
    Chosen, NOTHING_TO_DRAW, Results, Tab, choose_descriptor, described, foot, middle,
};
use crate::tui::keys::keymap::Context;
use crate::tui::widget::plot::{PlotField, draw_no_room};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, around};

const VALUE: usize = 9;

pub(super) static TAB: Tab = Tab {
    title: "scatter",
    context: Context::Scatter,
    filtered: true,
    wheel: Wheel::Step,
    drawing: Some(drawing),
    table: None,
    draw,
    click,
    on,
};

fn on(results: &mut Results, app: &mut App, message: &Message, area: Rect) {
    match *message {
        Message::Explore(ExploreMessage::Columns(by)) => {
            let number = around(results.across.number, by, features().len());
            results.across = Chosen::new(&results.findings, number);
        }
        Message::Select(row) => results.list.select(row),
        _ => choose_descriptor(results, app, message, area),
    }
}

fn point(results: &Results, id: u32) -> Option<(f64, f64)> {
    Some((results.across.value(id)?, results.chosen.value(id)?))
}

fn points(results: &Results) -> Vec<(usize, (f64, f64))> {
    let rows = results.list.rows.iter().enumerate();
    rows.filter_map(|(row, &id)| Some((row, point(results, id)?)))
        .collect()
}

fn field(area: Rect, points: &[(usize, (f64, f64))]) -> Option<PlotField> {
    let x = axis_ends(points.iter().map(|(_, point)| point.0));
    let y = axis_ends(points.iter().map(|(_, point)| point.1));
    PlotField::of(middle(area), x, y)
}

/// A click selects the nearest imprint, or puts it onto the matrix if it is selected already.
fn click(results: &Results, area: Rect, at: Position) -> Option<Message> {
    let points = points(results);
    let field = field(area, &points)?;
    let (x, y) = field.dot(field.point(at)?);
    let far = |&&(_, point): &&(usize, (f64, f64))| {
        let (other_x, other_y) = field.dot(point);
        libm::hypot(other_x - x, other_y - y)
    };
    let nearest = points
        .iter()
        .min_by(|one, other| far(one).total_cmp(&far(other)));
    let (row, _) = *nearest?;
    let again = row == results.list.selected;
    Some(if again {
        Message::Accept
    } else {
        Message::Select(row)
    })
}

/// Returns the position of the selected imprint.
fn draw(results: &Results, theme: &Theme, buffer: &mut Buffer, area: Rect) -> Option<Position> {
    let points = points(results);
    let (x, y) = (results.across.feature(), results.chosen.feature());
    let count = counted(points.len() as u64, "imprint");
    let title = format!("{} against {}; {count}", described(y), described(x));
    write::text(buffer, area, theme, &title, Role::Title);
    if points.is_empty() {
        let text = if results.list.rows.is_empty() {
            results.no_row()
        } else {
            "no imprint has both values".to_owned()
        };
        write::text(buffer, write::row(area, 1), theme, &text, Role::Quiet);
        return None;
    }
    let selected = results.selected();
    if let Some(entry) = &selected {
        let text = format!(
            "imprint {}: {} {}, {} {}; {}",
            entry.id,
            x.key,
            results.across.text(theme, entry.id, VALUE),
            y.key,
            results.chosen.text(theme, entry.id, VALUE),
            counted(entry.count, "pose")
        );
        write::text(buffer, foot(area), theme, &text, Role::Text);
    }
    let Some(field) = field(area, &points) else {
        draw_no_room(theme, buffer, area);
        return None;
    };
    field.draw_axes(theme, buffer, [&y.key, &x.key]);
    let all = points.iter().map(|(_, point)| *point);
    field.draw_points(theme, buffer, all, theme.style(Role::Chosen));
    let at = field.character(point(results, selected?.id)?)?;
    buffer[at]
        .set_char('X')
        .set_style(theme.style(Role::Cursor));
    Some(at)
}

fn drawing(results: &Results) -> Result<String, String> {
    let points = points(results);
    if points.is_empty() {
        return Err(NOTHING_TO_DRAW.to_owned());
    }
    let [x, y] = [&results.across, &results.chosen].map(|chosen| described(chosen.feature()));
    let mut plot = Plot::new(&x, &y);
    plot.title = results.summary(true);
    plot.points = points.into_iter().map(|(_, at)| at).collect();
    let selected = results.selected();
    plot.chosen = selected.and_then(|entry| point(results, entry.id));
    Ok(plot.svg())
}
