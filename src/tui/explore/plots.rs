//! The tabs with axes: two descriptors of the imprints that the filter keeps, and one descriptor against the angle.
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
//!
//! ```text
//! NA (na) against the angle   line: mean, dashes: min, max       the descriptor, and the legend
//! na
//! 20 ┤⠉⠒⠤⣀
//!    └────┬────┬──── angle / °
//! angle 30°: min 16, mean 18.2, max 20                           at the cursor
//! ```
//! Left and right choose the angle, which the map shows too. The curve is over all positions at the zoom of the map.

use std::collections::BTreeMap;
use std::sync::Arc;

use ratatui::layout::{Position, Rect};
use rayon::prelude::*;
use taxel_core::atlas::{features, mean_direction};
use taxel_core::index::index;
use taxel_core::pose::{Axis, PoseIndex};
use taxel_core::sweep::SweepResult;
use taxel_files::formats::value::{counted, fitting};
use taxel_files::formats::{Plot, axis_ends};

use crate::tui::app::{App, Canvas, Message, Wheel, find_mut};
use crate::tui::explore::ExploreMessage;
use crate::tui::explore::map::turn;
use crate::tui::explore::results::{
    Chosen, NOTHING_TO_DRAW, Results, Tab, choose_descriptor, described, foot, named,
};
use crate::tui::jobs::{Slot, answer};
use crate::tui::keys::Context;
use crate::tui::widget::write::{around, below, row};
use crate::tui::widget::{PlotField, Role, draw_no_room};

const VALUE: usize = 9;
const LEGEND: &str = "  line: mean, dashes: min, max";

pub(super) static SCATTER: Tab = Tab {
    title: "scatter",
    context: Context::Scatter,
    filtered: true,
    wheel: Wheel::Step,
    drawing: Some(scatter_drawing),
    table: None,
    draw: draw_scatter,
    click: click_scatter,
    on: on_scatter,
};

pub(super) static ANGLES: Tab = Tab {
    title: "angles",
    context: Context::Angles,
    filtered: false,
    wheel: Wheel::Step,
    drawing: Some(angles_drawing),
    table: None,
    draw: draw_angles,
    click: click_angles,
    on: on_angles,
};

/// Returns the field between the first and the last line of a tab.
fn field(area: Rect, points: impl Iterator<Item = (f64, f64)> + Clone) -> Option<PlotField> {
    let middle = Rect {
        height: area.height.saturating_sub(2),
        ..below(area, 1)
    };
    let x = axis_ends(points.clone().map(|(x, _)| x));
    PlotField::of(middle, x, axis_ends(points.map(|(_, y)| y)))
}

fn mark(canvas: &mut Canvas<'_>, at: Position, sign: char) {
    let style = canvas.theme.style(Role::Cursor);
    canvas.buffer[at].set_char(sign).set_style(style);
}

fn on_scatter(results: &mut Results, app: &mut App, message: &Message, area: Rect) {
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

/// Returns the points of the imprints, with their rows in the list.
fn points(results: &Results) -> Vec<(usize, (f64, f64))> {
    let rows = results.list.rows.iter().enumerate();
    rows.filter_map(|(row, &id)| Some((row, point(results, id)?)))
        .collect()
}

/// A click selects the nearest imprint, or puts it onto the matrix if it is selected already.
fn click_scatter(results: &Results, area: Rect, at: Position) -> Option<Message> {
    let points = points(results);
    let field = field(area, points.iter().map(|(_, point)| *point))?;
    let (x, y) = field.dot(field.point(at)?);
    let far = |&&(_, point): &&(usize, (f64, f64))| {
        let (other_x, other_y) = field.dot(point);
        libm::hypot(other_x - x, other_y - y)
    };
    let nearest = points.iter();
    let (row, _) = *nearest.min_by(|one, other| far(one).total_cmp(&far(other)))?;
    if row == results.list.selected {
        return Some(Message::Accept);
    }
    Some(Message::Select(row))
}

/// Returns the position of the selected imprint.
fn draw_scatter(results: &Results, mut canvas: Canvas<'_>, area: Rect) -> Option<Position> {
    let points = points(results);
    let (x, y) = (results.across.feature(), results.chosen.feature());
    let count = counted(points.len() as u64, "imprint");
    let title = format!("{} against {}; {count}", described(y), described(x));
    canvas.text(area, &title, Role::Title);
    if points.is_empty() {
        let mut text = "no imprint has both values".to_owned();
        if results.list.rows.is_empty() {
            text = results.no_row();
        }
        canvas.text(row(area, 1), &text, Role::Quiet);
        return None;
    }
    let selected = results.selected();
    if let Some(entry) = &selected {
        let [across, up] = [&results.across, &results.chosen]
            .map(|chosen| chosen.text(canvas.theme, entry.id, VALUE));
        let poses = counted(entry.count, "pose");
        let text = format!(
            "imprint {}: {} {across}, {} {up}; {poses}",
            entry.id, x.key, y.key
        );
        canvas.text(foot(area), &text, Role::Text);
    }
    let all = points.iter().map(|(_, point)| *point);
    let Some(field) = field(area, all.clone()) else {
        draw_no_room(canvas.theme, canvas.buffer, area);
        return None;
    };
    field.draw_axes(canvas.theme, canvas.buffer, [&y.key, &x.key]);
    let style = canvas.theme.style(Role::Chosen);
    field.draw_points(canvas.theme, canvas.buffer, all, style);
    let at = field.character(point(results, selected?.id)?)?;
    mark(&mut canvas, at, 'X');
    Some(at)
}

fn scatter_drawing(results: &Results) -> Result<String, String> {
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

fn on_angles(results: &mut Results, app: &mut App, message: &Message, area: Rect) {
    match *message {
        Message::Explore(ExploreMessage::Angle(by)) => turn(results, app, by),
        Message::Explore(ExploreMessage::Point(index, _)) => results.place[Axis::Angle] = index,
        _ => choose_descriptor(results, app, message, area),
    }
}

/// Finds the imprints of each angle at the zooms of the map, if they were not asked for yet.
pub(super) fn find_angles(app: &mut App, results: &mut Results) {
    let zooms = [Axis::X0, Axis::Y0, Axis::Angle]
        .into_iter()
        .fold(results.place, |place, axis| place.with(axis, 0));
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

fn curve(results: &Results) -> Option<&AngleCurve> {
    results.curve.as_ref()?.1.as_ref()
}

fn spread(results: &Results) -> Vec<AngleSpread> {
    curve(results).map_or(Vec::new(), |curve| {
        curve.spread(results.sweep(), &results.chosen)
    })
}

fn angle_field(area: Rect, spread: &[AngleSpread]) -> Option<PlotField> {
    let all = CURVES.iter().flat_map(|(_, of, _)| points_of(spread, *of));
    field(area, all)
}

fn click_angles(results: &Results, area: Rect, at: Position) -> Option<Message> {
    let spread = spread(results);
    let (degrees, _) = angle_field(area, &spread)?.point(at)?;
    let far = |at: &&AngleSpread| (at.degrees - degrees).abs();
    let nearest = spread.iter();
    let nearest = nearest.min_by(|one, other| far(one).total_cmp(&far(other)))?;
    Some(Message::Explore(ExploreMessage::Point(nearest.index, 0)))
}

/// Returns the position of the mean at the chosen angle.
fn draw_angles(results: &Results, mut canvas: Canvas<'_>, area: Rect) -> Option<Position> {
    let (spread, feature) = (spread(results), results.chosen.feature());
    let mut title = format!("{} against the angle", named(feature));
    let curve = curve(results);
    let sampled = curve.map_or([(1, ""); 2], |curve| {
        [(curve.every_angle, "angle"), (curve.every_row, "y0")]
    });
    let mut sign = "; sampled: ";
    for (every, what) in sampled.into_iter().filter(|&(every, _)| every > 1) {
        title += &format!("{sign}1 in {every} {what}");
        sign = ", ";
    }
    canvas.line(area, [(&*title, Role::Title), (LEGEND, Role::Quiet)]);
    let now = results.place[Axis::Angle];
    let Some(here) = spread.iter().min_by_key(|at| at.index.abs_diff(now)) else {
        let text = match curve {
            None => "computing",
            Some(_) if feature.circular => "no pose has a direction, or the directions cancel",
            Some(_) => "no pose has a value",
        };
        canvas.text(row(area, 1), text, Role::Quiet);
        return None;
    };
    let angle = Axis::Angle.parameter().format(here.degrees);
    let mean = fitting(here.mean, VALUE);
    let text = match here.ends.map(|ends| ends.map(|end| fitting(end, VALUE))) {
        Some([min, max]) => format!("angle {angle}°: min {min}, mean {mean}, max {max}"),
        None => format!("angle {angle}°: mean {mean}"),
    };
    canvas.text(foot(area), &text, Role::Text);
    let Some(field) = angle_field(area, &spread) else {
        draw_no_room(canvas.theme, canvas.buffer, area);
        return None;
    };
    let across = canvas.theme.pick("angle/deg", "angle/°");
    field.draw_axes(canvas.theme, canvas.buffer, [&feature.key, across]);
    draw_curves(&field, &spread, &mut canvas);
    let at = field.character((here.degrees, here.mean))?;
    mark(&mut canvas, at, 'o');
    Some(at)
}

type SpreadValue = fn(&AngleSpread) -> Option<f64>;

/// The name, the value, and whether it is dashed. The mean is drawn over the others.
const CURVES: [(&str, SpreadValue, bool); 3] = [
    ("smallest", |at| Some(at.ends?[0]), true),
    ("largest", |at| Some(at.ends?[1]), true),
    ("mean", |at| Some(at.mean), false),
];

fn points_of(spread: &[AngleSpread], of: SpreadValue) -> impl Iterator<Item = (f64, f64)> + Clone {
    spread
        .iter()
        .filter_map(move |at| Some((at.degrees, of(at)?)))
}

fn draw_curves(field: &PlotField, spread: &[AngleSpread], canvas: &mut Canvas<'_>) {
    for (_, of, dashed) in CURVES {
        let mut dots = field.canvas();
        let places: Vec<_> = points_of(spread, of)
            .map(|point| field.dot(point))
            .collect();
        // Dashes continue from one piece of the curve to the next, however long the pieces are.
        let mut gone = 0.0;
        for (from, to) in places.iter().zip(places.iter().skip(1)) {
            let shown = |step: u32| !dashed || (gone + f64::from(step)).rem_euclid(6.0) < 3.0;
            dots.dashed(*from, *to, shown);
            gone += (to.0 - from.0).abs().max((to.1 - from.1).abs());
        }
        if let [only] = places[..] {
            dots.set(only);
        }
        let role = if dashed { Role::Text } else { Role::Chosen };
        let style = canvas.theme.style(role);
        field.draw_lines(canvas.theme, canvas.buffer, &dots, style);
    }
}

fn angles_drawing(results: &Results) -> Result<String, String> {
    let spread = spread(results);
    if spread.is_empty() {
        return Err(NOTHING_TO_DRAW.to_owned());
    }
    let mut plot = Plot::new("angle / °", &described(results.chosen.feature()));
    plot.title = results.summary(false);
    for (name, of, dashed) in CURVES {
        let points: Vec<_> = points_of(&spread, of).collect();
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

/// The mean value at an angle, and unless it is a direction, the smallest and the largest one.
struct AngleSpread {
    index: u64,
    degrees: f64,
    mean: f64,
    ends: Option<[f64; 2]>,
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
        let (range, circular) = (sweep.grid.ranges()[Axis::Angle], chosen.feature().circular);
        let spread = self.angles.iter().filter_map(|(index, imprints)| {
            let known = imprints.iter();
            let known: Vec<(f64, f64)> = known
                .filter_map(|(&id, &count)| Some((chosen.value(id)?, f64::from(count))))
                .collect();
            let (mean, ends) = if circular {
                (circular_mean(&known)?, None)
            } else {
                let all = || known.iter().map(|(value, _)| *value);
                let min = all().fold(f64::INFINITY, f64::min);
                let max = all().fold(f64::NEG_INFINITY, f64::max);
                (mean(&known, |value| value)?, Some([min, max]))
            };
            Some(AngleSpread {
                index: *index,
                degrees: range.value(*index),
                mean,
                ends,
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
                assert_eq!(at.ends.is_none(), feature.circular);
                if let Some([min, max]) = at.ends {
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
