//! What a trial of a model says, in words, as a table and as JSON: of `taxel model confusion --test`, and of
//! `taxel frames --expect-labels`.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;
use taxel_core::parameter::number::{differing, share};
use taxel_core::recognition::{Tally, Trial};
use taxel_files::formats::json;
use taxel_files::formats::value::{counted, percent};

use crate::cli::commands::model::Table;
use crate::cli::commands::model::confusion::square;
use crate::cli::output::evaluation::{cell, count, matrix_csv, shares};
use crate::cli::output::table::{Record, table};

pub(crate) struct TrialReport<'a> {
    pub(crate) trial: &'a Trial,
    /// What was named, such as `touch`.
    pub(crate) noun: &'static str,
    /// How the touches were drawn, or which frames are left out.
    pub(crate) note: String,
    /// The same at the beginning of JSON.
    pub(crate) keys: Vec<(&'static str, Value)>,
}

#[derive(Serialize)]
struct TrialJson<'a> {
    #[serde(flatten)]
    keys: Record<'a>,
    #[serde(flatten)]
    known: TallyJson<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    foreign: Option<TallyJson<'a>>,
}

#[derive(Serialize)]
struct TallyJson<'a> {
    labels: &'a [String],
    right: Value,
    wrong: Value,
    /// Of foreign shapes, these are the right ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    unknown: Option<Value>,
    differs: &'a BTreeMap<u32, u64>,
    confusion: Vec<Vec<Value>>,
}

impl<'a> TallyJson<'a> {
    fn of(tally: &'a Tally, unknown: Option<u128>) -> Self {
        let row = |counts: Vec<u128>| counts.into_iter().map(count).collect();
        Self {
            labels: &tally.labels,
            right: count(tally.right()),
            wrong: count(tally.wrong()),
            unknown: unknown.map(count),
            differs: &tally.differs,
            confusion: tally.confusion.rows().map(row).collect(),
        }
    }
}

impl TrialReport<'_> {
    fn foreign(&self) -> Option<&Tally> {
        Some(&self.trial.foreign).filter(|foreign| !foreign.labels.is_empty())
    }

    /// The shapes of the model, then the foreign ones, and the touches of each by the name that they got; the last are
    /// unknown.
    fn rows(&self) -> (Vec<String>, Vec<Vec<u128>>) {
        let tallies = [&self.trial.known, &self.trial.foreign].into_iter();
        let rows = tallies.flat_map(|own| own.labels.iter().cloned().zip(own.confusion.rows()));
        rows.unzip()
    }

    /// Right answers are in brackets: the name of a shape of the model, otherwise unknown.
    fn confusion(&self) -> String {
        let (labels, counts) = self.rows();
        let names = self.trial.known.labels.len();
        let cell = |row: usize, column: usize| cell(counts[row][column], column == row.min(names));
        let mut lines = square(&labels, names, cell);
        lines[0].extend(["unknown ", "right"].map(str::to_owned));
        for (row, counts) in counts.iter().enumerate() {
            let right = match counts.iter().sum() {
                0 => "–".to_owned(),
                touches => percent(share(counts[row.min(names)], touches)),
            };
            lines[row + 1].extend([cell(row, names), right]);
        }
        table(&lines, &[0])
    }
}

/// How many touches are right, wrong and unknown, and how well shapes fit them.
fn summary(tally: &Tally, noun: &str, of: &str, counts: &[(&str, u128, &str)]) -> String {
    let touches = tally.touches();
    let exact = tally.differs.get(&0).copied().unwrap_or_default();
    let median = tally.median_differs().map_or(String::new(), |median| {
        format!("median: {}", differing(median))
    });
    let exact = ("fits exactly", exact.into(), &*median);
    let counts = counts.iter().copied().chain([exact]);
    let title = format!("{} of {of}\n", counted(touches, noun));
    title + &shares(touches, counts)
}

impl Table for TrialReport<'_> {
    /// ```text
    /// 5,600 touches of shapes of the model
    /// right         5,598  >99.9 %
    /// wrong             0    0.0 %
    /// unknown           2   <0.1 %
    /// fits exactly  5,432   97.0 %  median: 0 taxels differ
    /// ```
    fn text(&self) -> String {
        let known = &self.trial.known;
        let counts = [
            ("right", known.right(), ""),
            ("wrong", known.wrong(), ""),
            ("unknown", known.unknown(), ""),
        ];
        let mut text = summary(known, self.noun, "shapes of the model", &counts);
        if let Some(foreign) = self.foreign() {
            let counts = [
                (
                    "unknown",
                    foreign.right(),
                    "right, since the model does not have them",
                ),
                ("wrong", foreign.wrong(), ""),
            ];
            text += &summary(foreign, self.noun, "foreign shapes", &counts);
        }
        text + &self.note + "\n\n" + &self.confusion()
    }

    fn csv(&self) -> Option<String> {
        let (labels, counts) = self.rows();
        let names = [&*self.trial.known.labels, &["unknown".to_owned()]].concat();
        Some(matrix_csv(&labels, &names, counts))
    }

    fn json(&self) -> String {
        let known = &self.trial.known;
        let answer = TrialJson {
            keys: Record(self.keys.clone()),
            known: TallyJson::of(known, Some(known.unknown())),
            foreign: self.foreign().map(|foreign| TallyJson::of(foreign, None)),
        };
        json::ascii(&answer) + "\n"
    }
}
