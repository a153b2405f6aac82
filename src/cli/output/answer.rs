//! Answers to touches, for people and as JSON.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::value::RawValue;
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::parameter::number::differing;
use taxel_core::recognition::{AngleEstimate, Answer, AnswerState, PoseEstimate};
use taxel_files::formats::value::{self, decimal, deviation, percent};

use crate::cli::commands::recognise::Namer;
use crate::cli::output::charset::Charset;
use crate::cli::output::table::bar;
use crate::naming::verdict;

/// The most shapes in words, and the least probability of those after the first, unless their number is given.
const SHOWN: usize = 8;
const LEAST: f64 = 0.001;

const BAR: usize = 30;

/// The answer of recognition to one or several touches, in words and as JSON: of `taxel recognise`, and of frames that
/// are named.
pub(crate) struct Recognition<'a> {
    pub(crate) namer: &'a Namer,
    pub(crate) answer: Answer,
    /// The taxels that were left out.
    pub(crate) dead: Option<&'a Imprint>,
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
        struct FitJson<'a> {
            name: &'a str,
            differs: u32,
            x0: Option<f64>,
            y0: Option<f64>,
            angle: Option<f64>,
            #[serde(skip_serializing_if = "Option::is_none")]
            zoom_x: Option<f64>,
            #[serde(skip_serializing_if = "Option::is_none")]
            zoom_y: Option<f64>,
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
        map.serialize_entry("noise", &self.namer.terms.flip())?;
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
        let fit = answer.fit.as_ref().map(|fit| {
            let at = |parameter| fit.source.get(parameter);
            let zooms = [Parameter::ZoomX, Parameter::ZoomY].map(at);
            let is_zoomed = zooms.iter().flatten().any(|&zoom| zoom != 1.0);
            let [zoom_x, zoom_y] = zooms.map(|zoom| zoom.filter(|_| is_zoomed));
            FitJson {
                name: name(fit.shape),
                differs: fit.differs,
                x0: at(Parameter::X0),
                y0: at(Parameter::Y0),
                angle: at(Parameter::Angle),
                zoom_x,
                zoom_y,
            }
        });
        map.serialize_entry("fit", &fit)?;
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
    /// The answer to one touch for people: the verdict, bars, and the taxels that differ.
    /// ```text
    /// ellipse  87.3 %  2 taxels differ at 5.04, 6.10, 40.5°
    ///   ellipse  ##########################         87.3 %
    ///   hexagon  ####                               12.7 %
    ///   . . # # + . . .
    ///   . . # # - . . .
    ///   # both   + only in the touch   - only in the fitted shape
    /// ```
    pub(crate) fn text(&self, touch: &Imprint) -> String {
        let answer = &self.answer;
        let mut text = verdict(answer, &self.namer.model) + "\n";
        if answer.at_rim {
            text += "the imprint reaches the rim of the matrix: it may be cut off\n";
        }
        if answer.state == AnswerState::Unknown && !answer.ranking.is_empty() {
            text += "if it were one of these:\n";
        }
        let worth = |&&(_, probability): &&(usize, f64)| probability >= LEAST;
        let usual = answer.ranking.iter().take(SHOWN).take_while(worth).count();
        let top = self.namer.top.unwrap_or(usual.max(1));
        let shown = answer.ranking.iter().take(top);
        let names = Charset::current().column(shown.clone().map(|&(shape, _)| self.name(shape)));
        for (name, &(_, probability)) in names.iter().zip(shown) {
            let (bar, percent) = (bar(probability, BAR), percent(probability));
            text += &format!("  {name}  {bar:<BAR$}  {percent:>7}\n");
        }
        if answer.ranking.len() > top {
            text += &format!("  and {} more\n", answer.ranking.len() - top);
        }
        match (&self.pose, answer.shape) {
            (Some(pose), _) => text += &pose.text(),
            (None, Some(_)) if self.namer.asks_pose => {
                text += "spread of the pose unknown: no pose of a fine grid leaves this imprint\n";
            }
            _ => {}
        }
        Charset::current().lines(&text) + &self.drawn(touch)
    }

    pub(crate) fn name(&self, shape: usize) -> &str {
        &self.namer.model.shapes()[shape].name
    }

    /// Draws the touch and what the fitted shape leaves, or the nearest imprint if nothing was fitted, in one matrix.
    /// Empty if there is nothing to see beside the touch.
    fn drawn(&self, touch: &Imprint) -> String {
        let (answer, charset) = (&self.answer, Charset::current());
        let mut text = String::new();
        let (other, what) = match (&answer.fit, &answer.nearest) {
            (Some(fit), _) => (&fit.imprint, "fitted shape"),
            (None, Some(nearest)) if nearest.distance > 0 => {
                let (name, distance) = (self.name(nearest.shape), differing(nearest.distance));
                text = charset.lines(&format!("nearest: {name}, {distance}\n"));
                (&nearest.imprint, "nearest imprint")
            }
            _ => return text,
        };
        let is_dead = |column, row| self.dead.is_some_and(|dead| dead.get(column, row));
        let (full, empty) = charset.taxels();
        let taxel = |column, row| match (touch.get(column, row), other.get(column, row)) {
            _ if is_dead(column, row) => "x ",
            (true, true) => full,
            (true, false) => "+ ",
            (false, true) => "- ",
            (false, false) => empty,
        };
        let mut is_marked = false;
        let mut drawn = String::new();
        for row in 0..touch.rows() {
            let signs = (0..touch.columns()).map(|column| taxel(column, row));
            let signs = signs.collect::<String>();
            is_marked |= signs.contains(['x', '+', '-']);
            drawn += &format!("  {}\n", signs.trim_end());
        }
        if is_marked {
            let both = &full[..full.len() / 2];
            text += &drawn;
            text += &format!("  {both} both   + only in the touch   - only in the {what}");
            text += if self.dead.is_some() {
                "   x dead\n"
            } else {
                "\n"
            };
        }
        text
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

    fn text(&self) -> String {
        let estimate = &self.estimate;
        let mut text = format!("centre {} cells", value::pose_centre(estimate, 1.0));
        if let Some(pitch) = self.pitch_mm {
            text += &format!(" ({} mm)", value::pose_centre(estimate, pitch));
        }
        text + &match &estimate.angle {
            None => "; it looks the same at every angle\n".to_owned(),
            Some(angle) => format!("\n{}\n", angle_in_words(angle, estimate.poses)),
        }
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
