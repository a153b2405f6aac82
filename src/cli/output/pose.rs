//! The place of a recognised shape: in words, as JSON, and as its outline over the touch.
//!
//! ```text
//! centre 3.00 ± 0.13, 3.00 ± 0.13 cells (7.50 ± 0.32, 7.50 ± 0.32 mm)
//! angle 30.2° ± 1.4° (repeats every 180°); 95 % of 66 poses: 27°..32°
//! ```
//! A position is that of the centre about which the shape turns, in cells of the touch, x to the right, y down. All
//! poses of the model that leave the imprint count equally; `±` is their standard deviation. Angles are degrees as in
//! flags, modulo the angle after which the shape looks the same.

use serde::{Serialize, Serializer};

use crate::cli::output::charset::Charset;
use crate::cli::output::plot::{canvas_of_taxels, character};
use crate::formats::value;
use crate::formats::value::{decimal, deviation};
use crate::geometry::{Ellipse, Pen, Point, Side, Solid};
use crate::imprint::Imprint;
use crate::pose::{Anchor, Axis, Placed, Pose, PoseGrid, Ranges};
use crate::recognition::{AngleEstimate, Model, PoseEstimate};
use crate::sensor::Sensor;
use crate::tui::widget::dots::DotCanvas;

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
            _ => crate::pose::DecimalRange::whole(0),
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
