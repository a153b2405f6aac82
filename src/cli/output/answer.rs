//! Answers to touches, for people and as JSON.

use std::fmt::Write;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::value::RawValue;
use taxel_core::geometry::{Ellipse, Pen, Point, Side, Solid};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::{differing, short};
use taxel_core::pose::{Anchor, Axis, Placed, Pose, PoseGrid, Ranges};
use taxel_core::recognition::{
    AngleEstimate, Answer, AnswerState, Evidence, Model, Nearest, Noise, PoseEstimate, SearchMethod,
};
use taxel_core::sensor::Sensor;
use taxel_files::formats::value::{self, decimal, deviation, percent};

use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::bar;
use crate::cli::output::plot::{canvas_of_taxels, character};
use crate::tui::widget::plot::DotCanvas;

const SHOWN: usize = 8;

const BAR: usize = 30;

#[derive(Serialize)]
struct NearestJson<'a> {
    name: &'a str,
    distance: u32,
    imprint: &'a Imprint,
}

pub(crate) struct AnswerJson<'a> {
    pub(crate) model: &'a Model,
    pub(crate) answer: &'a Answer,
    pub(crate) noise: Option<Noise>,
    /// The nearest imprint of the model; None if all are larger than the matrix.
    pub(crate) nearest: Option<Nearest>,
    /// The number of shapes of the ranking to write; None for all.
    pub(crate) top: Option<usize>,
    pub(crate) asks_pose: bool,
    /// The place of the shape; None if it is unknown.
    pub(crate) pose: Option<PoseReport>,
    pub(crate) copied: Vec<(&'static str, &'a RawValue)>,
}

impl Serialize for AnswerJson<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let name = |shape: usize| self.model.shapes()[shape].name.as_str();
        let answer = self.answer;
        let mut map = serializer.serialize_map(None)?;
        for (key, value) in &self.copied {
            map.serialize_entry(key, value)?;
        }
        map.serialize_entry("answer", &answer.shape.map(name))?;
        map.serialize_entry("state", answer.state.name())?;
        if answer.state == AnswerState::Tied {
            let tied: Vec<&str> = answer.tied.iter().map(|&shape| name(shape)).collect();
            map.serialize_entry("tied", &tied)?;
        }
        map.serialize_entry("method", answer.method.name())?;
        map.serialize_entry("noise", &self.noise.map(|noise| noise.flip()))?;
        map.serialize_entry("at_rim", &answer.at_rim)?;
        let ranking = answer.ranking.iter().take(self.top.unwrap_or(usize::MAX));
        let ranking = ranking.map(|&(shape, probability)| Ranked {
            name: name(shape),
            probability,
        });
        map.serialize_entry("ranking", &ranking.collect::<Vec<_>>())?;
        let nearest = self.nearest.as_ref().map(|nearest| NearestJson {
            name: name(nearest.shape),
            distance: nearest.distance,
            imprint: &nearest.imprint,
        });
        map.serialize_entry("nearest", &nearest)?;
        if self.asks_pose {
            map.serialize_entry("pose", &self.pose.as_ref().map(PoseReport::json))?;
        }
        map.end()
    }
}

#[derive(Serialize)]
struct Ranked<'a> {
    name: &'a str,
    probability: f64,
}

/// An answer for people: the name and how far it can be trusted, bars, and the nearest imprint.
/// ```text
/// ellipse: likely
///   ellipse  ##########################         87.3 %
///   hexagon  ####                               12.7 %
/// nearest: ellipse, 2 taxels differ
///   ..##+...
///   ..##-...
///   # both   + only in the touch   - only in the nearest imprint
/// ```
pub(crate) struct AnswerText<'a> {
    pub(crate) model: &'a Model,
    pub(crate) touch: &'a Imprint,
    pub(crate) answer: &'a Answer,
    /// The number of shapes of the ranking to show; None for eight.
    pub(crate) top: Option<usize>,
    pub(crate) noise: Option<Noise>,
}

impl AnswerText<'_> {
    pub(crate) fn text(&self, charset: Charset) -> String {
        let touches = [*self.touch];
        let evidence = Evidence::of(&touches).under(self.noise.as_ref());
        let nearest = self.model.nearest_of(evidence);
        let mut text = self.verdict(nearest.is_some());
        // If no imprint of the model fits on the matrix, nothing was compared.
        if let (Some(noise), Some(nearest)) = (self.noise, &nearest) {
            // Cannot fail: the text is kept in memory.
            let _ = writeln!(
                text,
                "noise {}: {}",
                short(noise.flip()),
                compared(self.answer.method)
            );
            let unexplained = noise.unexplained(self.touch, nearest.distance);
            if let Some(warning) = unexplained.filter(|_| !self.answer.ranking.is_empty()) {
                let _ = writeln!(text, "{warning}");
            }
        }
        if self.answer.at_rim {
            text += "the imprint reaches the rim of the matrix: it may be cut off\n";
        }
        text += &self.ranking(charset);
        text += &self.nearest(nearest);
        charset.lines(&text)
    }

    fn name(&self, shape: usize) -> &str {
        &self.model.shapes()[shape].name
    }

    /// Returns the first line: the shape and how certain it is, or why there is none. `any_fits` tells whether any
    /// imprint of the model fits on the matrix.
    fn verdict(&self, any_fits: bool) -> String {
        match (self.answer.state, self.answer.shape) {
            (AnswerState::Tied, _) => {
                let tied = self.answer.tied.iter().map(|&shape| self.name(shape));
                let tied: Vec<&str> = tied.collect();
                format!("{}: tied\n", tied.join(" or "))
            }
            (AnswerState::Rejected, _) => {
                "rejected: no shape reaches the probability of --reject\n".to_owned()
            }
            (state, Some(shape)) => format!("{}: {}\n", self.name(shape), state.name()),
            (_, None) if any_fits => {
                "unknown: no shape of the model leaves this imprint\n".to_owned()
            }
            (_, None) => format!(
                "unknown: no imprint of the model fits on {} × {} taxels\n",
                self.touch.columns(),
                self.touch.rows()
            ),
        }
    }

    fn ranking(&self, charset: Charset) -> String {
        let top = self.top.unwrap_or(SHOWN);
        let shown = self.answer.ranking.iter().take(top);
        let names = charset.column(shown.clone().map(|&(shape, _)| self.name(shape)));
        let mut text = String::new();
        for (name, &(_, probability)) in names.iter().zip(shown) {
            let (bar, percent) = (bar(probability, BAR, charset), percent(probability));
            // Cannot fail: the text is kept in memory.
            let _ = writeln!(text, "  {name}  {bar:<BAR$}  {percent:>7}");
        }
        let rest = self.answer.ranking.len().saturating_sub(top);
        if rest > 0 {
            let _ = writeln!(text, "  and {rest} more");
        }
        text
    }

    fn nearest(&self, nearest: Option<Nearest>) -> String {
        let Some(nearest) = nearest.filter(|nearest| nearest.distance > 0) else {
            return String::new();
        };
        let (name, distance) = (self.name(nearest.shape), nearest.distance);
        let dead = self.noise.as_ref().and_then(Noise::dead);
        format!(
            "nearest: {name}, {}\n{}\
             \x20 # both   + only in the touch   - only in the nearest imprint{}\n",
            differing(distance),
            differences(self.touch, &nearest.imprint, dead),
            if dead.is_some() { "   x dead" } else { "" }
        )
    }
}

fn compared(method: SearchMethod) -> &'static str {
    match method {
        SearchMethod::Exact => "only the imprint itself is looked up",
        SearchMethod::OneFlip => "compared with imprints that differ by at most one taxel",
        SearchMethod::Scan => "compared with every imprint of the model in every place",
    }
}

/// Draws two imprints in the matrix of the touch: `#` both, `+` only the touch, `-` only the nearest, `.` neither,
/// `x` dead.
fn differences(touch: &Imprint, nearest: &Imprint, dead: Option<&Imprint>) -> String {
    let mut text = String::new();
    for row in 0..touch.rows() {
        text.push_str("  ");
        for column in 0..touch.columns() {
            let is_dead = dead.is_some_and(|dead| dead.get(column, row));
            text.push(match (touch.get(column, row), nearest.get(column, row)) {
                _ if is_dead => 'x',
                (true, true) => '#',
                (true, false) => '+',
                (false, true) => '-',
                (false, false) => '.',
            });
        }
        text.push('\n');
    }
    text
}

const DOTS: f64 = 4.0;

const PIECES: u16 = 128;

#[derive(Serialize)]
pub(crate) struct PoseJson<'a> {
    name: &'a str,
    poses: u64,
    centre: [f64; 2],
    centre_in_box: [f64; 2],
    centre_sd: [f64; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    centre_mm: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    centre_sd_mm: Option<[f64; 2]>,
    angle: Option<AngleJson>,
}

/// The angle of a pose, in degrees from 0 to the period: mean, standard deviation, and the fewest consecutive whole
/// degrees that contain 95 % of the poses.
#[derive(Serialize)]
struct AngleJson {
    mean: Option<f64>,
    sd: Option<f64>,
    /// The degrees after which the shape looks the same; written without a point if whole.
    #[serde(serialize_with = "integer_if_whole")]
    period: f64,
    /// The first of the consecutive degrees.
    from: u32,
    /// The number of consecutive degrees; they may pass the period and continue at 0.
    degrees: u32,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes it so")]
#[expect(clippy::cast_possible_truncation, reason = "at most 360")]
fn integer_if_whole<S: Serializer>(number: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    match number.fract() {
        0.0 => serializer.serialize_i64(*number as i64),
        _ => serializer.serialize_f64(*number),
    }
}

pub(crate) struct PoseReport {
    name: String,
    estimate: PoseEstimate,
    corner: [f64; 2],
    placed: Placed,
    /// The side of a cell in mm, if lengths are given in mm too.
    pitch_mm: Option<f64>,
}

impl PoseReport {
    /// Returns the pose of a shape of a model that left an imprint; None for an empty imprint. If there is no mean
    /// angle, the outline is drawn in the middle of the likeliest degrees.
    pub(crate) fn new(
        model: &Model,
        shape: usize,
        touch: &Imprint,
        estimate: PoseEstimate,
        pitch_mm: Option<f64>,
    ) -> Option<Self> {
        let bounds = touch.bounds()?;
        let named = model.shapes().get(shape)?;
        let [x, y] = estimate.position;
        let angle = estimate.angle.as_ref().map_or(0.0, |angle| {
            let (first, count) = angle.shortest_arc;
            angle
                .mean
                .unwrap_or(f64::from(first) + f64::from(count) / 2.0)
        });
        let own = *model.ranges();
        let still = Ranges::from_fn(|axis| match axis {
            Axis::ZoomX | Axis::ZoomY => own[axis].part(0..1).unwrap_or(own[axis]),
            _ => taxel_core::pose::DecimalRange::whole(0),
        });
        let source = named.source.clone();
        let grid = PoseGrid::new(source, Sensor::LARGEST, Anchor::Centre, still).ok()?;
        let pose = Pose::from_fn(|axis| match axis {
            Axis::X0 => x,
            Axis::Y0 => y,
            Axis::Angle => angle,
            _ => own[axis].value(0),
        });
        Some(Self {
            name: named.name.clone(),
            estimate,
            corner: [f64::from(bounds.left), f64::from(bounds.top)],
            placed: grid.placed_in(pose),
            pitch_mm,
        })
    }

    pub(crate) fn json(&self) -> PoseJson<'_> {
        let estimate = &self.estimate;
        let [x, y] = estimate.position;
        let in_mm = |pair: [f64; 2]| self.pitch_mm.map(|pitch| pair.map(|cells| cells * pitch));
        PoseJson {
            name: &self.name,
            poses: estimate.poses,
            centre: [x, y],
            centre_in_box: [x - self.corner[0], y - self.corner[1]],
            centre_sd: estimate.standard_deviation,
            centre_mm: in_mm([x, y]),
            centre_sd_mm: in_mm(estimate.standard_deviation),
            angle: estimate.angle.as_ref().map(|angle| AngleJson {
                mean: angle.mean,
                sd: angle.standard_deviation,
                period: angle.period,
                from: angle.shortest_arc.0,
                degrees: angle.shortest_arc.1,
            }),
        }
    }

    pub(crate) fn text(&self, touch: &Imprint, charset: Charset) -> String {
        let estimate = &self.estimate;
        let mut text = format!("centre {} cells", value::pose_centre(estimate, 1.0));
        if let Some(pitch) = self.pitch_mm {
            text += &format!(" ({} mm)", value::pose_centre(estimate, pitch));
        }
        text += &match &estimate.angle {
            None => "; it looks the same at every angle\n".to_owned(),
            Some(angle) => format!("\n{}\n", angle_in_words(angle, estimate.poses)),
        };
        charset.lines(&(text + &self.drawn(touch, charset)))
    }

    fn drawn(&self, touch: &Imprint, charset: Charset) -> String {
        let mut outline = Outline(canvas_of_taxels(touch.columns(), touch.rows()));
        self.placed.draw(&mut outline);
        let (full, empty) = charset.taxels();
        let mut rows: Vec<Vec<char>> = (0..touch.rows())
            .map(|row| {
                let taxels = (0..touch.columns()).flat_map(|column| {
                    let sign = if touch.get(column, row) { full } else { empty };
                    sign.chars()
                });
                taxels.collect()
            })
            .collect();
        for (column, row, dots) in outline.0.characters() {
            let cell = rows.get_mut(usize::from(row));
            if let Some(cell) = cell.and_then(|row| row.get_mut(usize::from(column))) {
                *cell = character(dots, charset);
            }
        }
        let lines = rows.into_iter().map(|row| {
            let row: String = row.into_iter().collect();
            format!("  {}\n", row.trim_end())
        });
        lines.collect()
    }
}

fn angle_in_words(angle: &AngleEstimate, poses: u64) -> String {
    let repeats = value::pose_repeats(angle);
    let Some((mean, spread)) = angle.known() else {
        return format!("angle any{repeats}");
    };
    let (mean, spread) = (decimal(mean, 1), deviation(spread, 1));
    let arc = value::pose_arc(angle, poses);
    format!("angle {mean}° ± {spread}°{repeats}; {arc}")
}

struct Outline(DotCanvas);

impl Outline {
    fn line(&mut self, from: (f64, f64), to: (f64, f64)) {
        let place = |(x, y): (f64, f64)| (x * DOTS, y * DOTS);
        self.0.line(place(from), place(to));
    }
}

impl Pen<f64> for Outline {
    fn edge(&mut self, from: Point<f64>, to: Point<f64>) {
        self.line((from.x, from.y), (to.x, to.y));
    }

    fn ellipse(&mut self, ellipse: &Ellipse<f64>, _material: Side) {
        let at = |piece: u16| {
            let turn = std::f64::consts::TAU * f64::from(piece) / f64::from(PIECES);
            let (sin, cos) = libm::sincos(turn);
            (
                ellipse.centre.x + ellipse.across.x * cos + ellipse.along.x * sin,
                ellipse.centre.y + ellipse.across.y * cos + ellipse.along.y * sin,
            )
        };
        for piece in 0..PIECES {
            self.line(at(piece), at(piece + 1));
        }
    }
}
