//! What a trial of a model says, in words, as a table, as JSON and as a drawing: of `taxel model confusion --test`, and
//! of `taxel frames --expect-labels`.

use std::collections::{BTreeMap, BTreeSet};
use std::iter;

use serde::Serialize;
use serde_json::Value;
use taxel_core::parameter::number::{differing, share};
use taxel_core::recognition::{Tally, Trial};
use taxel_files::formats::value::{counted, csv_line, grouped, percent};
use taxel_files::formats::{ConfusionMap, json};

use crate::cli::commands::model::Table;
use crate::cli::output::evaluation::{cell, count};
use crate::cli::output::table::{Record, row, table};

/// The most shapes of a table with all of them. Of more, it has those with mistakes.
const MOST_SHOWN: usize = 12;

pub(crate) struct TrialReport<'a> {
    pub(crate) trial: &'a Trial,
    /// What was named, such as `touch`.
    pub(crate) noun: &'static str,
    /// How the touches were drawn, or which frames are left out.
    pub(crate) note: String,
    /// The same at the beginning of JSON.
    pub(crate) keys: Vec<(&'static str, Value)>,
}

/// A line of the confusion table.
struct Row<'a> {
    label: &'a str,
    /// The touches by the name that they got; the last are unknown.
    counts: Vec<u128>,
    /// The column of right answers.
    right: usize,
}

impl Row<'_> {
    /// The columns of wrong answers.
    fn mistakes(&self) -> impl Iterator<Item = usize> {
        let columns = self.counts.iter().enumerate();
        let columns = columns.filter(|&(column, &count)| count > 0 && column != self.right);
        columns.map(|(column, _)| column)
    }
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

    /// The shapes of the model, then the foreign ones.
    fn rows(&self) -> Vec<Row<'_>> {
        let tallies = [&self.trial.known, &self.trial.foreign].into_iter();
        let rows = tallies.flat_map(|tally| {
            let rows = tally.labels.iter().zip(tally.confusion.rows()).enumerate();
            rows.map(|(row, (label, counts))| Row {
                label,
                counts,
                right: tally.right_column(row),
            })
        });
        rows.collect()
    }

    fn columns(&self) -> Vec<String> {
        let names = self.trial.known.labels.iter().cloned();
        names.chain(iter::once("unknown".to_owned())).collect()
    }

    /// How many touches are right, wrong and unknown, and how well shapes fit them.
    fn summary(&self, tally: &Tally, of: &str, counts: &[(&str, u128, &str)]) -> String {
        let touches = tally.touches();
        let exact = tally.differs.get(&0).copied().unwrap_or_default();
        let median = tally.median_differs().map_or(String::new(), |median| {
            format!("median: {}", differing(median))
        });
        let exact = ("fits exactly", exact.into(), &*median);
        let rows = counts.iter().copied().chain([exact]);
        let rows = rows.map(|(name, count, note)| {
            let part = percent(share(count, touches));
            row([name, &grouped(count), &part, note])
        });
        let title = format!("{} of {of}\n", counted(touches, self.noun));
        title + &table(&rows.collect::<Vec<_>>(), &[0, 3])
    }

    /// The confusion table, or the part of it with mistakes if it is large; empty if there are none then.
    fn confusion(&self) -> String {
        let rows = self.rows();
        let names = self.trial.known.labels.len();
        let all = rows.len() <= MOST_SHOWN;
        let taken: BTreeSet<usize> = rows.iter().flat_map(Row::mistakes).collect();
        let is_shown = |number: usize, row: &Row| {
            all || row.mistakes().next().is_some() || number < names && taken.contains(&number)
        };
        let shown: Vec<(usize, &Row)> = rows
            .iter()
            .enumerate()
            .filter(|(number, row)| is_shown(*number, row))
            .collect();
        let is_used = |&column: &usize| all || shown.iter().any(|(_, row)| row.counts[column] > 0);
        let columns: Vec<usize> = (0..=names).filter(is_used).collect();
        if shown.is_empty() {
            return String::new();
        }
        let title = |&column: &usize| {
            if column == names {
                "unknown ".to_owned()
            } else {
                format!("{} ", column + 1)
            }
        };
        let titles = columns.iter().map(title);
        let titles = iter::once(String::new()).chain(titles);
        let mut lines = vec![titles.chain(["right".to_owned()]).collect()];
        let digits = rows.len().to_string().len();
        for (number, row) in shown {
            let label = format!("{:>digits$} {}", number + 1, row.label);
            let cells = columns.iter();
            let cells = cells.map(|&column| cell(row.counts[column], column == row.right));
            let right = match row.counts.iter().sum() {
                0 => "–".to_owned(),
                touches => percent(share(row.counts[row.right], touches)),
            };
            let line = iter::once(label).chain(cells).chain([right]);
            lines.push(line.collect());
        }
        let left_out = if all {
            ""
        } else {
            "shapes without mistakes are left out\n"
        };
        format!("\n{}{left_out}", table(&lines, &[0]))
    }
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
        let mut text = self.summary(known, "shapes of the model", &counts);
        if let Some(foreign) = self.foreign() {
            let counts = [
                (
                    "unknown",
                    foreign.right(),
                    "right, since the model does not have them",
                ),
                ("wrong", foreign.wrong(), ""),
            ];
            text += &self.summary(foreign, "foreign shapes", &counts);
        }
        text + &self.note + "\n" + &self.confusion()
    }

    fn csv(&self) -> String {
        let columns = self.columns();
        let titles = iter::once("true").chain(columns.iter().map(String::as_str));
        let mut table = csv_line(titles);
        for row in self.rows() {
            let counts = row.counts.iter().map(u128::to_string);
            table += &csv_line(iter::once(row.label.to_owned()).chain(counts));
        }
        table
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

    fn svg(&self) -> Option<String> {
        let rows = self.rows();
        let labels: Vec<String> = rows.iter().map(|row| row.label.to_owned()).collect();
        let counts = rows.into_iter().map(|row| row.counts);
        let mut map = ConfusionMap::new(&labels, &self.columns(), counts)?;
        let known = &self.trial.known;
        map.title = format!("right {}", percent(share(known.right(), known.touches())));
        Some(map.svg())
    }
}
