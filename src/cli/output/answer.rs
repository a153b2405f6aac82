//! Answers to touches, for people and as JSON.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::value::RawValue;
use taxel_core::geometry::{Ellipse, Pen, Point, Side, Solid};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::{differing, short};
use taxel_core::recognition::{
    AngleEstimate, Answer, AnswerState, Nearest, Noise, PlacedSource, PoseEstimate, SearchMethod,
};
use taxel_files::formats::value::{self, decimal, deviation, percent};

use crate::cli::commands::recognise::Namer;
use crate::cli::output::charset::Charset;
use crate::cli::output::plot::draw_over;
use crate::cli::output::table::bar;
use crate::tui::widget::plot::DotCanvas;
use crate::verdict::verdict;

const SHOWN: usize = 8;

const BAR: usize = 30;

/// The answer of recognition to one or several touches, in words and as JSON: of `taxel recognise`, and of frames that
/// are named.
pub(crate) struct Recognition<'a> {
    pub(crate) namer: &'a Namer,
    pub(crate) answer: Answer,
    /// The place of the shape; None if it is unknown.
    pub(crate) pose: Option<PoseReport>,
    /// The keys of a line that its answer repeats.
    pub(crate) copied: Vec<(&'static str, Box<RawValue>)>,
}

impl Serialize for Recognition<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Ranked<'a> {
            name: &'a str,
            probability: f64,
        }
        #[derive(Serialize)]
        struct NearestJson<'a> {
            name: &'a str,
            distance: u32,
            imprint: &'a Imprint,
        }
        let name = |shape: usize| self.name(shape);
        let answer = &self.answer;
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
        map.serialize_entry("noise", &self.namer.noise.map(|noise| noise.flip()))?;
        map.serialize_entry("at_rim", &answer.at_rim)?;
        let ranking = answer
            .ranking
            .iter()
            .take(self.namer.top.unwrap_or(usize::MAX));
        let ranking = ranking.map(|&(shape, probability)| Ranked {
            name: name(shape),
            probability,
        });
        map.serialize_entry("ranking", &ranking.collect::<Vec<_>>())?;
        let nearest = self.answer.nearest.as_ref().map(|nearest| NearestJson {
            name: name(nearest.shape),
            distance: nearest.distance,
            imprint: &nearest.imprint,
        });
        map.serialize_entry("nearest", &nearest)?;
        if self.namer.asks_pose {
            map.serialize_entry("pose", &self.pose.as_ref().map(PoseReport::json))?;
        }
        map.end()
    }
}

impl Recognition<'_> {
    /// The answer to one touch for people: the name and how far it can be trusted, bars, and the nearest imprint.
    /// ```text
    /// ellipse: likely
    ///   ellipse  ##########################         87.3 %
    ///   hexagon  ####                               12.7 %
    /// nearest: ellipse, 2 taxels differ
    ///   ..##+...
    ///   ..##-...
    ///   # both   + only in the touch   - only in the nearest imprint
    /// ```
    pub(crate) fn text(&self, touch: &Imprint) -> String {
        let answer = &self.answer;
        let mut text = verdict(answer, &self.namer.model) + "\n";
        // If no imprint of the model fits on the matrix, nothing was compared.
        if let (Some(noise), Some(_)) = (self.namer.noise, &answer.nearest) {
            let compared = match answer.method {
                SearchMethod::Exact => "only the imprint itself is looked up",
                SearchMethod::OneFlip => "compared with imprints that differ by at most one taxel",
                SearchMethod::Scan => "compared with every imprint of the model in every place",
            };
            text += &format!("noise {}: {compared}\n", short(noise.flip()));
        }
        if answer.at_rim {
            text += "the imprint reaches the rim of the matrix: it may be cut off\n";
        }
        let top = self.namer.top.unwrap_or(SHOWN);
        let shown = answer.ranking.iter().take(top);
        let names = Charset::current().column(shown.clone().map(|&(shape, _)| self.name(shape)));
        for (name, &(_, probability)) in names.iter().zip(shown) {
            let (bar, percent) = (bar(probability, BAR), percent(probability));
            text += &format!("  {name}  {bar:<BAR$}  {percent:>7}\n");
        }
        if answer.ranking.len() > top {
            text += &format!("  and {} more\n", answer.ranking.len() - top);
        }
        if let Some(nearest) = self.answer.nearest.as_ref().filter(|own| own.distance > 0) {
            text += &self.differences(touch, nearest);
        }
        let pose = match &self.pose {
            Some(pose) => pose.text(touch),
            None if self.namer.asks_pose => {
                "no pose of the model is known for this imprint\n".to_owned()
            }
            None => String::new(),
        };
        Charset::current().lines(&text) + &pose
    }

    pub(crate) fn name(&self, shape: usize) -> &str {
        &self.namer.model.shapes()[shape].name
    }

    /// Draws the touch and the nearest imprint in one matrix.
    fn differences(&self, touch: &Imprint, nearest: &Nearest) -> String {
        let dead = self.namer.noise.as_ref().and_then(Noise::dead);
        let sign = |column, row| {
            let is = |imprint: &Imprint| imprint.get(column, row);
            match (is(touch), is(&nearest.imprint)) {
                _ if dead.is_some_and(is) => 'x',
                (true, true) => '#',
                (true, false) => '+',
                (false, true) => '-',
                (false, false) => '.',
            }
        };
        let (name, distance) = (self.name(nearest.shape), differing(nearest.distance));
        let mut text = format!("nearest: {name}, {distance}\n");
        for row in 0..touch.rows() {
            text += "  ";
            text.extend((0..touch.columns()).map(|column| sign(column, row)));
            text.push('\n');
        }
        text += "  # both   + only in the touch   - only in the nearest imprint";
        text + if dead.is_some() { "   x dead\n" } else { "\n" }
    }
}

#[derive(Serialize)]
struct PoseJson<'a> {
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
/// degrees that contain 95 % of the poses. They may pass the period and continue at 0.
#[derive(Serialize)]
struct AngleJson {
    mean: Option<f64>,
    sd: Option<f64>,
    /// The degrees after which the shape looks the same; written without a point if whole.
    period: serde_json::Value,
    from: u32,
    degrees: u32,
}

/// Where the shape of an answer lies.
pub(crate) struct PoseReport {
    pub(crate) name: String,
    pub(crate) estimate: PoseEstimate,
    /// The top left corner of the imprint's box.
    pub(crate) corner: [f64; 2],
    /// The pose nearest to the mean.
    pub(crate) placed: Option<PlacedSource>,
    /// The side of a cell in mm, if lengths are given in mm too.
    pub(crate) pitch_mm: Option<f64>,
}

impl PoseReport {
    fn json(&self) -> PoseJson<'_> {
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
                #[expect(clippy::cast_possible_truncation, reason = "at most 360")]
                period: match angle.period.fract() {
                    0.0 => (angle.period as i64).into(),
                    _ => angle.period.into(),
                },
                from: angle.shortest_arc.0,
                degrees: angle.shortest_arc.1,
            }),
        }
    }

    fn text(&self, touch: &Imprint) -> String {
        let estimate = &self.estimate;
        let mut text = format!("centre {} cells", value::pose_centre(estimate, 1.0));
        if let Some(pitch) = self.pitch_mm {
            text += &format!(" ({} mm)", value::pose_centre(estimate, pitch));
        }
        text += &match &estimate.angle {
            None => "; it looks the same at every angle\n".to_owned(),
            Some(angle) => format!("\n{}\n", angle_in_words(angle, estimate.poses)),
        };
        Charset::current().lines(&text) + &self.drawn(touch)
    }

    /// Draws the outline over the touch.
    fn drawn(&self, touch: &Imprint) -> String {
        let (columns, lines) = (u16::from(touch.columns()), u16::from(touch.rows()));
        let mut outline = Outline {
            canvas: DotCanvas::new(2 * columns, lines),
            by: [0.0; 2],
        };
        if let Some(placed) = &self.placed {
            outline.by = placed.by;
            placed.source.draw(&mut outline);
        }
        let (full, empty) = Charset::current().taxels();
        let mut rows = Vec::new();
        for row in 0..touch.rows() {
            let taxel = |column| if touch.get(column, row) { full } else { empty };
            let taxels = (0..touch.columns()).flat_map(|column| taxel(column).chars());
            rows.push(taxels.collect::<Vec<char>>());
        }
        draw_over(&mut rows, &outline.canvas, Charset::current());
        let line = |row: Vec<char>| format!("  {}\n", row.iter().collect::<String>().trim_end());
        rows.into_iter().map(line).collect()
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

/// Draws an outline, moved by some cells. A taxel is two characters wide, so it has four dots in both directions.
struct Outline {
    canvas: DotCanvas,
    by: [f64; 2],
}

impl Pen<f64> for Outline {
    fn edge(&mut self, from: Point<f64>, to: Point<f64>) {
        let [dx, dy] = self.by;
        let place = |point: Point<f64>| (4.0 * (point.x + dx), 4.0 * (point.y + dy));
        self.canvas.line(place(from), place(to));
    }

    fn ellipse(&mut self, ellipse: &Ellipse<f64>, _material: Side) {
        const PIECES: u16 = 128;
        let own = *ellipse;
        let at = |piece: u16| {
            let turn = std::f64::consts::TAU * f64::from(piece) / f64::from(PIECES);
            let (sin, cos) = libm::sincos(turn);
            Point {
                x: own.centre.x + own.across.x * cos + own.along.x * sin,
                y: own.centre.y + own.across.y * cos + own.along.y * sin,
            }
        };
        for piece in 0..PIECES {
            self.edge(at(piece), at(piece + 1));
        }
    }
}
