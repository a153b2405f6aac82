//! The angles tab: the chosen descriptor against the angle.
//!
//! ```text
//! na: active taxels against the angle   line: mean, dashes: min, max       the descriptor, and the legend
//! na
//! 20 ┤⠉⠒⠤⣀                                                                 over all positions
//!    └────┬────┬──── angle / °
//! angle 30°: min 16, mean 18.2, max 20                                     at the cursor
//! ```
//! Up and down choose the descriptor, left and right the angle, which the map shows too.

pub mod curve;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::formats::value::fitting;
use crate::formats::{PointPlot, axis_ends};
use crate::pose::Axis;
use crate::tui::app::message::Message;
use crate::tui::app::page::Wheel;
use crate::tui::explore::angles::curve::{AngleCurve, AngleSearch, AngleSpread};
use crate::tui::explore::message::ExploreMessage;
use crate::tui::explore::results::Results;
use crate::tui::explore::tab::{NOTHING_TO_DRAW, ResultsTab, choose_descriptor};
use crate::tui::keys::binding::Context;
use crate::tui::widget::plot::{PlotField, draw_no_room};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

const VALUE: usize = 9;

const LEGEND: &str = "  line: mean, dashes: min, max";

pub static TAB: ResultsTab = ResultsTab {
    title: "angles",
    context: Context::Angles,
    filtered: false,
    drawing: Some(drawing),
    table: None,
    wheel: Wheel::Step,
    draw,
    click,
    update: choose_descriptor,
};

fn spread(results: &Results) -> Vec<AngleSpread> {
    let curve = results.angle_curve();
    curve.map_or(Vec::new(), |curve| {
        curve.spread(results.sweep(), results.feature(), results.values())
    })
}

fn field(area: Rect, spread: &[AngleSpread]) -> Option<PlotField> {
    let area = Rect {
        height: area.height.saturating_sub(2),
        ..write::below(area, 1)
    };
    let values = spread.iter().flat_map(|at| [at.min, Some(at.mean), at.max]);
    let x = axis_ends(spread.iter().map(|at| at.degrees));
    PlotField::of(area, x, axis_ends(values.flatten()))
}

fn click(results: &Results, area: Rect, at: Position) -> Option<Message> {
    let spread = spread(results);
    let (degrees, _) = field(area, &spread)?.point(at)?;
    let far = |at: &&AngleSpread| (at.degrees - degrees).abs();
    let nearest = spread
        .iter()
        .min_by(|one, other| far(one).total_cmp(&far(other)))?;
    Some(Message::Explore(ExploreMessage::ToAngle(nearest.index)))
}

/// Returns the title: the name of the descriptor gives way to its key where the legend would have no room.
fn title(results: &Results, room: usize) -> String {
    let feature = results.feature();
    let sampled = results.angle_curve().map_or_else(String::new, sampled);
    let title = |name: &str| format!("{name} against the angle{sampled}");
    let title = [feature.label(), feature.key.clone()].map(|name| title(&name));
    let fits = |title: &&String| write::width(title) + write::width(LEGEND) <= room;
    title.iter().find(fits).unwrap_or(&title[1]).clone()
}

fn sampled(curve: &AngleCurve) -> String {
    let parts = [(curve.every_angle, "angle"), (curve.every_row, "y0")];
    let parts = parts.into_iter().filter(|&(every, _)| every > 1);
    let parts = parts.map(|(every, what)| format!("every {} {what}", ordinal(every)));
    let parts: Vec<String> = parts.collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!("; sampled: {}", parts.join(", "))
    }
}

fn ordinal(number: u64) -> String {
    let end = match (number % 10, number % 100) {
        (1..=3, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{number}{end}")
}

fn without_curve(results: &Results) -> &'static str {
    match results.angles() {
        Some(AngleSearch::Found(_)) if results.feature().circular => {
            "no pose has a direction, or the directions cancel"
        }
        Some(AngleSearch::Found(_)) => "no pose has a value",
        Some(AngleSearch::Failed) => "the imprints of each angle cannot be computed",
        Some(AngleSearch::Running) | None => "computing",
    }
}

/// Returns the position of the mean at the chosen angle.
fn draw(results: &Results, theme: &Theme, buffer: &mut Buffer, area: Rect) -> Option<Position> {
    let text = title(results, area.width.into());
    let end = write::text(buffer, area, theme, &text, Role::Title);
    let after = write::right_of(area, end);
    write::text(buffer, after, theme, LEGEND, Role::Quiet);
    let spread = spread(results);
    let Some(here) = nearest(results, &spread) else {
        let text = without_curve(results);
        write::text(buffer, write::row(area, 1), theme, text, Role::Quiet);
        return None;
    };
    if area.height > 1 {
        let foot = write::below(area, area.height - 1);
        let text = detail(&here);
        write::text(buffer, foot, theme, &text, Role::Text);
    }
    let Some(field) = field(area, &spread) else {
        draw_no_room(theme, buffer, area);
        return None;
    };
    let key = results.feature().key.as_str();
    let across = if theme.ascii { "angle/deg" } else { "angle/°" };
    field.draw_axes(theme, buffer, [key, across]);
    draw_curves(&field, &spread, theme, buffer);
    let at = field.character((here.degrees, here.mean))?;
    if let Some(cell) = buffer.cell_mut(at) {
        cell.set_char('o').set_style(theme.style(Role::Cursor));
    }
    Some(at)
}

fn draw_curves(field: &PlotField, spread: &[AngleSpread], theme: &Theme, buffer: &mut Buffer) {
    let quiet = theme.style(Role::Text);
    for (of, dashed) in CURVES {
        let mut canvas = field.canvas();
        let places = spread
            .iter()
            .map(|at| Some(field.dot((at.degrees, of(at)?))));
        let places: Vec<_> = places.collect();
        // Dashes continue from one piece of the curve to the next, however long the pieces are.
        let mut gone = 0.0;
        for pair in places.windows(2) {
            if let [Some(from), Some(to)] = *pair {
                let shown = |step: u32| !dashed || (gone + f64::from(step)).rem_euclid(6.0) < 3.0;
                canvas.dashed(from, to, shown);
                gone += (to.0 - from.0).abs().max((to.1 - from.1).abs());
            }
        }
        if let [Some(only)] = places[..] {
            canvas.set(only);
        }
        let style = if dashed {
            quiet
        } else {
            theme.style(Role::Chosen)
        };
        field.draw_lines(theme, buffer, &canvas, style);
    }
}

type SpreadValue = fn(&AngleSpread) -> Option<f64>;

/// The mean is drawn over the others.
const CURVES: [(SpreadValue, bool); 3] = [
    (|at| at.min, true),
    (|at| at.max, true),
    (|at| Some(at.mean), false),
];

fn nearest(results: &Results, spread: &[AngleSpread]) -> Option<AngleSpread> {
    let now = results.pose_index()[Axis::Angle];
    spread
        .iter()
        .min_by_key(|at| at.index.abs_diff(now))
        .copied()
}

fn detail(at: &AngleSpread) -> String {
    let formatted = |value: f64| fitting(value, VALUE);
    let angle = Axis::Angle.parameter().format(at.degrees);
    let ends = at.min.zip(at.max);
    ends.map_or_else(
        || format!("angle {angle}°: mean {}", formatted(at.mean)),
        |(min, max)| {
            format!(
                "angle {angle}°: min {}, mean {}, max {}",
                formatted(min),
                formatted(at.mean),
                formatted(max)
            )
        },
    )
}

fn drawing(results: &Results) -> Result<String, String> {
    let spread = spread(results);
    if spread.is_empty() {
        return Err(NOTHING_TO_DRAW.to_owned());
    }
    let feature = results.feature();
    let mut plot =
        PointPlot::new("angle / °", &feature.label()).with_title(&results.summary(false));
    let names = ["smallest", "largest", "mean"];
    for ((of, dashed), name) in CURVES.into_iter().zip(names) {
        let points: Vec<(f64, f64)> = spread
            .iter()
            .filter_map(|at| Some((at.degrees, of(at)?)))
            .collect();
        plot = match (points.is_empty(), dashed) {
            (true, _) => plot,
            (false, true) => plot.with_dashed_curve(name, &points),
            (false, false) => plot.with_curve(name, &points),
        };
    }
    Ok(plot.svg())
}
