//! Answers to touches, for people and as JSON.

use std::fmt::Write;

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use serde_json::value::RawValue;

use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::bar;
use crate::cli::output::pose::PoseReport;
use crate::formats::value::percent;
use crate::imprint::Imprint;
use crate::parameter::number::{differing, short};
use crate::recognition::{Answer, AnswerState, Evidence, Model, Nearest, Noise, SearchMethod};

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
