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

use std::collections::BTreeMap;
use std::sync::Arc;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use rayon::prelude::*;
use taxel_core::atlas::{Feature, mean_direction};
use taxel_core::index::{index, wide};
use taxel_core::pose::{Axis, PoseIndex};
use taxel_core::sweep::SweepResult;
use taxel_files::formats::value::fitting;
use taxel_files::formats::{Plot, axis_ends};

use crate::tui::app::message::Message;
use crate::tui::app::page::Wheel;
use crate::tui::explore::message::ExploreMessage;
use crate::tui::explore::results::Results;
use crate::tui::explore::view::{NOTHING_TO_DRAW, ResultsTab, choose_descriptor};
use crate::tui::keys::keymap::Context;
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
    let now = results.pose_index[Axis::Angle];
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
    let mut plot = Plot::new("angle / °", &feature.label());
    plot.title = results.summary(false);
    let names = ["smallest", "largest", "mean"];
    for ((of, dashed), name) in CURVES.into_iter().zip(names) {
        let points: Vec<(f64, f64)> = spread
            .iter()
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

#[derive(Clone, Debug)]
pub enum AngleSearch {
    Running,
    Found(Arc<AngleCurve>),
    /// They cannot be found.
    Failed,
}

#[derive(Clone, Debug, PartialEq)]
pub struct AngleCurve {
    pub every_angle: u64,
    pub every_row: u64,
    angles: Vec<(u64, BTreeMap<u32, u32>)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleSpread {
    pub index: u64,
    /// The angle in degrees.
    pub degrees: f64,
    pub min: Option<f64>,
    pub mean: f64,
    pub max: Option<f64>,
}

pub(in crate::tui::explore) fn zooms_of(place: PoseIndex) -> PoseIndex {
    place
        .with(Axis::X0, 0)
        .with(Axis::Y0, 0)
        .with(Axis::Angle, 0)
}

impl AngleCurve {
    pub fn of(sweep: &SweepResult, place: PoseIndex) -> Self {
        let counts = sweep.grid.counts();
        let (columns, rows, angles) = (counts[Axis::X0], counts[Axis::Y0], counts[Axis::Angle]);
        let every_angle = angles.div_ceil(MOST_ANGLES).max(1);
        let each = (MOST_ROWS / angles.div_ceil(every_angle)).max(1);
        let every_row = rows.div_ceil(each).max(1);
        let zooms = zooms_of(place);
        let found = |angle: u64| {
            let mut imprints = BTreeMap::new();
            for row in (0..rows).step_by(index(every_row)) {
                let at = zooms.with(Axis::Angle, angle);
                let end = if every_row == 1 { rows } else { row + 1 };
                for id in sweep.ids(at, 0..columns, row..end).into_iter().flatten() {
                    *imprints.entry(id).or_insert(0) += 1;
                }
                if every_row == 1 {
                    break;
                }
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

    /// `values` has the value of each imprint, by number.
    pub fn spread(
        &self,
        sweep: &SweepResult,
        feature: &Feature,
        values: &[Option<f64>],
    ) -> Vec<AngleSpread> {
        let range = sweep.grid.ranges()[Axis::Angle];
        let mut spread = Vec::with_capacity(self.angles.len());
        for (index, imprints) in &self.angles {
            let known = imprints
                .iter()
                .filter_map(|(&id, &count)| Some(((*values.get(wide(id))?)?, f64::from(count))));
            let known: Vec<(f64, f64)> = known.collect();
            let mean = if feature.circular {
                circular_mean(&known)
            } else {
                mean(&known, |value| value)
            };
            let Some(mean) = mean else {
                continue;
            };
            let plain = !feature.circular;
            let all = || known.iter().map(|(value, _)| *value);
            spread.push(AngleSpread {
                index: *index,
                degrees: range.value(*index),
                min: plain.then(|| all().fold(f64::INFINITY, f64::min)),
                mean,
                max: plain.then(|| all().fold(f64::NEG_INFINITY, f64::max)),
            });
        }
        spread
    }
}

fn mean(known: &[(f64, f64)], of: fn(f64) -> f64) -> Option<f64> {
    let count: f64 = known.iter().map(|(_, count)| count).sum();
    let sum: f64 = known.iter().map(|(value, count)| of(*value) * count).sum();
    (count > 0.0).then(|| sum / count)
}

/// Returns the circular mean of directions in degrees, given how often each occurs. None if there are no directions,
/// or if they cancel.
fn circular_mean(known: &[(f64, f64)]) -> Option<f64> {
    let x = mean(known, |degrees| libm::cos(degrees.to_radians()))?;
    let y = mean(known, |degrees| libm::sin(degrees.to_radians()))?;
    mean_direction(x, y)
}

#[cfg(test)]
mod tests {
    use taxel_core::atlas::features;
    use taxel_core::figure::{Figure, FigureKind};
    use taxel_core::pose::{Anchor, PoseGrid, Ranges};
    use taxel_core::sensor::Sensor;
    use taxel_core::source::Source;
    use taxel_core::sweep::Sweep;

    use super::*;

    fn sweep(y0: &str, angle: &str) -> SweepResult {
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, range("5:5.9:0.1"))
            .with(Axis::Y0, range(y0))
            .with(Axis::Angle, range(angle));
        let figure = Figure::default_of(FigureKind::Rectangle, &Sensor::default());
        let grid = PoseGrid::new(
            Source::Figure(figure),
            Sensor::default(),
            Anchor::Corner,
            ranges,
        );
        Sweep::new(&grid.expect("in range")).run()
    }

    #[test]
    fn each_angle_has_the_values_of_its_positions() {
        let sweep = sweep("5:5.3:0.1", "0:80:20");
        let curve = AngleCurve::of(&sweep, PoseIndex::new([3, 2, 1, 0, 0]));
        assert_eq!((curve.every_angle, curve.every_row), (1, 1));
        for (number, feature) in features().iter().enumerate() {
            let values = sweep.atlas.values(number);
            let spread = curve.spread(&sweep, feature, &values);
            assert_eq!(spread.len(), 5, "{}", feature.key);
            for at in spread {
                let place = PoseIndex::new([0, 0, at.index, 0, 0]);
                let ids = sweep.ids(place, 0..10, 0..4);
                let own: Vec<f64> = ids.iter().filter_map(|id| values[wide((*id)?)]).collect();
                let within = |value: f64| {
                    at.min.is_none_or(|min| min <= value) && at.max.is_none_or(|max| value <= max)
                };
                assert!(own.iter().all(|&value| within(value)), "{}", feature.key);
                assert_eq!(at.min.is_none(), feature.circular);
                if !feature.circular {
                    let count = f64::from(u32::try_from(own.len()).expect("few"));
                    let mean = own.iter().sum::<f64>() / count;
                    assert!((at.mean - mean).abs() < 1e-9, "{}", feature.key);
                }
            }
        }
    }

    #[test]
    fn directions_have_a_circular_mean() {
        let mean = |known: &[(f64, f64)]| circular_mean(known).expect("a mean");
        let west = mean(&[(170.0, 1.0), (-170.0, 1.0)]);
        assert!((west.abs() - 180.0).abs() < 1e-9, "{west}");
        assert!((mean(&[(10.0, 3.0), (50.0, 0.0)]) - 10.0).abs() < 1e-9);
    }

    #[test]
    fn directions_that_cancel_have_no_mean() {
        let opposite = [(90.0, 1.0), (-90.0, 1.0)];
        let thirds = [(-110.0, 700.0), (10.0, 700.0), (130.0, 700.0)];
        assert_eq!(circular_mean(&opposite), None);
        assert_eq!(circular_mean(&thirds), None);
    }

    #[test]
    fn only_part_of_a_large_grid_is_visited() {
        let sweep = sweep("5:5.99:0.01", "0:89.9:0.1");
        let curve = AngleCurve::of(&sweep, PoseIndex::new([0; 5]));
        assert_eq!((curve.every_angle, curve.every_row), (2, 6));
        let spread = curve.spread(&sweep, &features()[0], &sweep.atlas.values(0));
        assert_eq!(spread.len(), 450);
        assert_eq!((spread[1].index, spread[449].index), (2, 898));
    }
}
