//! The angles tab: the chosen descriptor against the angle, over all positions at the zoom of the map.
//!
//! ```text
//! NA (na) against the angle   line: mean, dashes: min, max       the descriptor, and the legend
//! na
//! 20 ┤⠉⠒⠤⣀
//!    └────┬────┬──── angle / °
//! angle 30°: min 16, mean 18.2, max 20                           at the cursor
//! ```
//! Up and down choose the descriptor, left and right the angle, which the map shows too.

use std::collections::BTreeMap;
use std::sync::Arc;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use rayon::prelude::*;
use taxel_core::atlas::mean_direction;
use taxel_core::index::index;
use taxel_core::pose::{Axis, PoseIndex};
use taxel_core::sweep::SweepResult;
use taxel_files::formats::value::fitting;
use taxel_files::formats::{Plot, axis_ends};

use crate::tui::app::message::Message;
use crate::tui::app::page::{Wheel, find_mut};
use crate::tui::app::state::App;
use crate::tui::explore::ExploreMessage;
use crate::tui::explore::map::turn;
use crate::tui::explore::results::{
    Chosen, NOTHING_TO_DRAW, Results, Tab, choose_descriptor, described, foot, middle, named,
};
use crate::tui::jobs::{Slot, answer};
use crate::tui::keys::keymap::Context;
use crate::tui::widget::plot::{PlotField, draw_no_room};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

const LEGEND: &str = "  line: mean, dashes: min, max";

pub(super) static TAB: Tab = Tab {
    title: "angles",
    context: Context::Angles,
    filtered: false,
    wheel: Wheel::Step,
    drawing: Some(drawing),
    table: None,
    draw,
    click,
    on,
};

fn on(results: &mut Results, app: &mut App, message: &Message, area: Rect) {
    match *message {
        Message::Explore(ExploreMessage::Angle(by)) => turn(results, app, by),
        Message::Explore(ExploreMessage::Point(index, _)) => results.place[Axis::Angle] = index,
        _ => choose_descriptor(results, app, message, area),
    }
}

/// Finds the imprints of each angle at the zooms of the map, if they were not asked for yet.
pub(super) fn find(app: &mut App, results: &mut Results) {
    let zooms = results
        .place
        .with(Axis::X0, 0)
        .with(Axis::Y0, 0)
        .with(Axis::Angle, 0);
    let asked = results.curve.as_ref().map(|(asked, _)| *asked);
    if asked == Some(zooms) {
        return;
    }
    results.curve = Some((zooms, None));
    let findings = Arc::clone(&results.findings);
    app.jobs.run(Slot::Angles, move |_| {
        let curve = AngleCurve::of(&findings.sweep, zooms);
        answer(move |app| {
            let results = find_mut::<Results>(&mut app.pages).or(app.results.as_deref_mut());
            if let Some(results) = results.filter(|own| Arc::ptr_eq(&own.findings, &findings)) {
                results.curve = Some((zooms, Some(curve)));
            }
        })
    });
}

fn spread(results: &Results) -> Vec<AngleSpread> {
    let curve = results.angles();
    curve.map_or(Vec::new(), |curve| {
        curve.spread(results.sweep(), &results.chosen)
    })
}

fn field(area: Rect, spread: &[AngleSpread]) -> Option<PlotField> {
    let values = spread.iter().flat_map(|at| [at.min, Some(at.mean), at.max]);
    let x = axis_ends(spread.iter().map(|at| at.degrees));
    PlotField::of(middle(area), x, axis_ends(values.flatten()))
}

fn click(results: &Results, area: Rect, at: Position) -> Option<Message> {
    let spread = spread(results);
    let (degrees, _) = field(area, &spread)?.point(at)?;
    let far = |at: &&AngleSpread| (at.degrees - degrees).abs();
    let nearest = spread
        .iter()
        .min_by(|one, other| far(one).total_cmp(&far(other)))?;
    Some(Message::Explore(ExploreMessage::Point(nearest.index, 0)))
}

fn title(results: &Results) -> String {
    let mut title = format!("{} against the angle", named(results.chosen.feature()));
    if let Some(curve) = results.angles() {
        let parts = [(curve.every_angle, "angle"), (curve.every_row, "y0")];
        let parts = parts.into_iter().filter(|&(every, _)| every > 1);
        let parts: Vec<String> = parts
            .map(|(every, what)| format!("1 in {every} {what}"))
            .collect();
        if !parts.is_empty() {
            title += &format!("; sampled: {}", parts.join(", "));
        }
    }
    title
}

/// Returns the position of the mean at the chosen angle.
fn draw(results: &Results, theme: &Theme, buffer: &mut Buffer, area: Rect) -> Option<Position> {
    let title = title(results);
    write::line(
        buffer,
        area,
        theme,
        [(&*title, Role::Title), (LEGEND, Role::Quiet)],
    );
    let (spread, feature) = (spread(results), results.chosen.feature());
    let now = results.place[Axis::Angle];
    let Some(here) = spread.iter().min_by_key(|at| at.index.abs_diff(now)) else {
        let text = match results.angles() {
            None => "computing",
            Some(_) if feature.circular => "no pose has a direction, or the directions cancel",
            Some(_) => "no pose has a value",
        };
        write::text(buffer, write::row(area, 1), theme, text, Role::Quiet);
        return None;
    };
    let [min, mean, max] = [here.min.unwrap_or(0.0), here.mean, here.max.unwrap_or(0.0)]
        .map(|value| fitting(value, 9));
    let values = if feature.circular {
        format!("mean {mean}")
    } else {
        format!("min {min}, mean {mean}, max {max}")
    };
    let angle = Axis::Angle.parameter().format(here.degrees);
    let text = format!("angle {angle}°: {values}");
    write::text(buffer, foot(area), theme, &text, Role::Text);
    let Some(field) = field(area, &spread) else {
        draw_no_room(theme, buffer, area);
        return None;
    };
    let across = if theme.ascii { "angle/deg" } else { "angle/°" };
    field.draw_axes(theme, buffer, [&feature.key, across]);
    draw_curves(&field, &spread, theme, buffer);
    let at = field.character((here.degrees, here.mean))?;
    buffer[at]
        .set_char('o')
        .set_style(theme.style(Role::Cursor));
    Some(at)
}

type SpreadValue = fn(&AngleSpread) -> Option<f64>;

/// The name, the value, and whether it is dashed. The mean is drawn over the others.
const CURVES: [(&str, SpreadValue, bool); 3] = [
    ("smallest", |at| at.min, true),
    ("largest", |at| at.max, true),
    ("mean", |at| Some(at.mean), false),
];

fn draw_curves(field: &PlotField, spread: &[AngleSpread], theme: &Theme, buffer: &mut Buffer) {
    for (_, of, dashed) in CURVES {
        let mut canvas = field.canvas();
        let places = spread.iter();
        let places: Vec<_> = places
            .map(|at| Some(field.dot((at.degrees, of(at)?))))
            .collect();
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
        let role = if dashed { Role::Text } else { Role::Chosen };
        field.draw_lines(theme, buffer, &canvas, theme.style(role));
    }
}

fn drawing(results: &Results) -> Result<String, String> {
    let spread = spread(results);
    if spread.is_empty() {
        return Err(NOTHING_TO_DRAW.to_owned());
    }
    let mut plot = Plot::new("angle / °", &described(results.chosen.feature()));
    plot.title = results.summary(false);
    for (name, of, dashed) in CURVES {
        let points = spread.iter();
        let points: Vec<(f64, f64)> = points
            .filter_map(|at| Some((at.degrees, of(at)?)))
            .collect();
        if !points.is_empty() {
            plot = plot.with_line(name, &points, dashed);
        }
    }
    Ok(plot.svg())
}

const MOST_ANGLES: u64 = 720;

const MOST_ROWS: u64 = 8_000;

/// How often each imprint occurs at each angle, at one zoom. Of a fine sweep only some angles and rows are visited.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AngleCurve {
    every_angle: u64,
    every_row: u64,
    angles: Vec<(u64, BTreeMap<u32, u32>)>,
}

/// The smallest, mean and largest value at an angle. Directions have only a mean.
struct AngleSpread {
    index: u64,
    degrees: f64,
    min: Option<f64>,
    mean: f64,
    max: Option<f64>,
}

impl AngleCurve {
    pub(crate) fn of(sweep: &SweepResult, zooms: PoseIndex) -> Self {
        let [columns, rows, angles, ..] = sweep.grid.counts().into_array();
        let every_angle = angles.div_ceil(MOST_ANGLES).max(1);
        let each = (MOST_ROWS / angles.div_ceil(every_angle)).max(1);
        let every_row = rows.div_ceil(each).max(1);
        let found = |angle: u64| {
            let mut imprints = BTreeMap::new();
            let mut add = |rows| {
                let ids = sweep.ids(zooms.with(Axis::Angle, angle), 0..columns, rows);
                for id in ids.into_iter().flatten() {
                    *imprints.entry(id).or_insert(0) += 1;
                }
            };
            if every_row == 1 {
                add(0..rows);
            } else {
                let some = (0..rows).step_by(index(every_row));
                some.for_each(|row| add(row..row + 1));
            }
            (angle, imprints)
        };
        let sampled: Vec<u64> = (0..angles).step_by(index(every_angle)).collect();
        Self {
            every_angle,
            every_row,
            angles: sampled.into_par_iter().map(found).collect(),
        }
    }

    /// Angles at which no pose has a value, or directions cancel, are left out.
    fn spread(&self, sweep: &SweepResult, chosen: &Chosen) -> Vec<AngleSpread> {
        let range = sweep.grid.ranges()[Axis::Angle];
        let spread = self.angles.iter().filter_map(|(index, imprints)| {
            let known = imprints.iter();
            let known: Vec<(f64, f64)> = known
                .filter_map(|(&id, &count)| Some((chosen.value(id)?, f64::from(count))))
                .collect();
            let plain = !chosen.feature().circular;
            let all = || known.iter().map(|(value, _)| *value);
            Some(AngleSpread {
                index: *index,
                degrees: range.value(*index),
                min: plain.then(|| all().fold(f64::INFINITY, f64::min)),
                mean: if plain {
                    mean(&known, |value| value)
                } else {
                    circular_mean(&known)
                }?,
                max: plain.then(|| all().fold(f64::NEG_INFINITY, f64::max)),
            })
        });
        spread.collect()
    }
}

/// Each value stands with how often it occurs.
fn mean(known: &[(f64, f64)], of: fn(f64) -> f64) -> Option<f64> {
    let count: f64 = known.iter().map(|(_, count)| count).sum();
    let sum: f64 = known.iter().map(|(value, count)| of(*value) * count).sum();
    (count > 0.0).then(|| sum / count)
}

fn circular_mean(known: &[(f64, f64)]) -> Option<f64> {
    let x = mean(known, |degrees| libm::cos(degrees.to_radians()))?;
    let y = mean(known, |degrees| libm::sin(degrees.to_radians()))?;
    mean_direction(x, y)
}

#[cfg(test)]
mod tests {
    use taxel_core::atlas::features;
    use taxel_core::figure::FigureKind;
    use taxel_core::index::wide;

    use super::*;
    use crate::tui::explore::Findings;
    use crate::tui::explore::results::tests::sweep;

    fn found(y0: &str, angle: &str) -> Findings {
        Findings::new(sweep(FigureKind::Rectangle, ["5:5.9:0.1", y0, angle]))
    }

    #[test]
    fn each_angle_has_the_values_of_its_positions() {
        let found = found("5:5.3:0.1", "0:80:20");
        let curve = AngleCurve::of(&found.sweep, PoseIndex::new([0; 5]));
        assert_eq!((curve.every_angle, curve.every_row), (1, 1));
        for (number, feature) in features().iter().enumerate() {
            let chosen = Chosen::new(&found, number);
            let spread = curve.spread(&found.sweep, &chosen);
            assert_eq!(spread.len(), 5, "{}", feature.key);
            for at in spread {
                let place = PoseIndex::new([0, 0, at.index, 0, 0]);
                let ids = found.sweep.ids(place, 0..10, 0..4);
                let own = ids.iter().filter_map(|id| chosen.values[wide((*id)?)]);
                let own: Vec<f64> = own.collect();
                assert_eq!(at.min.is_none(), feature.circular);
                if let (Some(min), Some(max)) = (at.min, at.max) {
                    assert!(own.iter().all(|value| (min..=max).contains(value)));
                    let count = f64::from(u32::try_from(own.len()).expect("few"));
                    let mean = own.iter().sum::<f64>() / count;
                    assert!((at.mean - mean).abs() < 1e-9, "{}", feature.key);
                }
            }
        }
    }

    #[test]
    fn directions_have_a_circular_mean_unless_they_cancel() {
        let west = circular_mean(&[(170.0, 1.0), (-170.0, 1.0)]).expect("a mean");
        assert!((west.abs() - 180.0).abs() < 1e-9, "{west}");
        let mean = circular_mean(&[(10.0, 3.0), (50.0, 0.0)]).expect("a mean");
        assert!((mean - 10.0).abs() < 1e-9);
        let thirds = [(-110.0, 700.0), (10.0, 700.0), (130.0, 700.0)];
        assert_eq!(circular_mean(&[(90.0, 1.0), (-90.0, 1.0)]), None);
        assert_eq!(circular_mean(&thirds), None);
    }

    #[test]
    fn only_part_of_a_large_grid_is_visited() {
        let found = found("5:5.99:0.01", "0:89.9:0.1");
        let curve = AngleCurve::of(&found.sweep, PoseIndex::new([0; 5]));
        assert_eq!((curve.every_angle, curve.every_row), (2, 6));
        let spread = curve.spread(&found.sweep, &Chosen::new(&found, 0));
        assert_eq!(spread.len(), 450);
        assert_eq!((spread[1].index, spread[449].index), (2, 898));
    }
}
