//! Answers to touches: for people, and as JSON.

use std::fmt::Write;

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use serde_json::value::RawValue;

use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::{bar, percent};
use crate::cli::output::pose::PoseReport;
use crate::imprint::Imprint;
use crate::recognition::{Answer, AnswerState, Evidence, Method, Model, Nearest, Noise};

/// How many shapes a text shows, unless another number is asked for.
const SHOWN: usize = 8;

/// Characters of the longest bar.
const BAR: usize = 30;

/// The nearest imprint as an object of JSON.
#[derive(Serialize)]
struct NearestJson<'a> {
    name: &'a str,
    distance: u32,
    imprint: Vec<String>,
}

/// An answer as an object of JSON, its keys in the order of the documentation.
pub(crate) struct AnswerJson<'a> {
    pub(crate) model: &'a Model,
    pub(crate) answer: &'a Answer,
    pub(crate) method: Method,
    pub(crate) noise: Option<Noise>,
    pub(crate) nearest: Option<Nearest>,
    pub(crate) top: Option<usize>,
    /// Whether it was asked where the shape lies.
    pub(crate) asks_pose: bool,
    /// Where the shape lies; None if it cannot be said.
    pub(crate) pose: Option<PoseReport>,
    /// Keys of the question that come first.
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
        map.serialize_entry("method", self.method.name())?;
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
            imprint: nearest.imprint.lines().collect(),
        });
        map.serialize_entry("nearest", &nearest)?;
        if self.asks_pose {
            map.serialize_entry("pose", &self.pose.as_ref().map(PoseReport::json))?;
        }
        map.end()
    }
}

/// A shape of the ranking.
#[derive(Serialize)]
struct Ranked<'a> {
    name: &'a str,
    probability: f64,
}

/// An answer for people: the name and how far it can be trusted, bars, and the nearest imprint.
pub(crate) fn text(
    model: &Model,
    touch: &Imprint,
    answer: &Answer,
    (top, noise): (Option<usize>, Option<Noise>),
    charset: Charset,
) -> String {
    let name = |shape: usize| model.shapes()[shape].name.as_str();
    let mut text = match (answer.state, answer.shape) {
        (AnswerState::Tied, _) => {
            let tied: Vec<&str> = answer.tied.iter().map(|&shape| name(shape)).collect();
            format!("{}: tied\n", tied.join(" or "))
        }
        (AnswerState::Rejected, _) => "rejected: no shape is as probable as asked for\n".to_owned(),
        (state, Some(shape)) => format!("{}: {}\n", name(shape), state.name()),
        (_, None) => "unknown: no shape of the model leaves this imprint\n".to_owned(),
    };
    if let Some(noise) = noise {
        let _ = writeln!(
            text,
            "noise {}: every key in every place is compared",
            noise.flip()
        );
    }
    if answer.at_rim {
        text += "the imprint reaches the rim of the matrix: it may be cut off\n";
    }
    let shown = answer.ranking.iter().take(top.unwrap_or(SHOWN));
    let width = shown.clone().map(|&(shape, _)| name(shape).chars().count());
    let width = width.max().unwrap_or_default();
    for &(shape, probability) in shown {
        let _ = writeln!(
            text,
            "  {:<width$}  {:<BAR$}  {:>7}",
            name(shape),
            bar(probability, BAR, charset),
            percent(probability)
        );
    }
    let rest = answer.ranking.len().saturating_sub(top.unwrap_or(SHOWN));
    if rest > 0 {
        let _ = writeln!(text, "  and {rest} more");
    }
    let touches = [*touch];
    if let Some(nearest) = model.nearest_of(Evidence::of(&touches))
        && nearest.distance > 0
    {
        let noun = if nearest.distance == 1 {
            "taxel differs"
        } else {
            "taxels differ"
        };
        let _ = writeln!(
            text,
            "nearest: {}, {} {noun}",
            name(nearest.shape),
            nearest.distance
        );
        text += &differences(touch, &nearest.imprint);
        text += "  # both   + only in the touch   - only in the nearest imprint\n";
    }
    charset.lines(&text)
}

/// Two imprints of one size in one matrix.
fn differences(touch: &Imprint, nearest: &Imprint) -> String {
    let mut text = String::new();
    for row in 0..touch.rows() {
        text.push_str("  ");
        for column in 0..touch.columns() {
            text.push(match (touch.get(column, row), nearest.get(column, row)) {
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
