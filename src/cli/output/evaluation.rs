//! What an evaluation of a model says, in words and as a line of JSON. All numbers are counted touches, not estimates.

use std::iter;

use serde_json::{Value, json};
use taxel_core::parameter::number::share;
use taxel_core::recognition::{ClassifierEvaluation, Evaluation};
use taxel_files::formats::value::{counted, csv_line, grouped, percent};

use crate::cli::output::table::{Record, row, table};

/// A count in JSON: a number, or a text if it is beyond 64 bits, as weights may cause.
pub(crate) fn count(count: u128) -> Value {
    u64::try_from(count).map_or_else(|_| count.to_string().into(), Value::from)
}

/// A cell of a confusion table: right touches are in brackets, zero is a dot.
pub(crate) fn cell(touches: u128, is_right: bool) -> String {
    match (touches, is_right) {
        (touches, true) => format!("[{touches}]"),
        (0, false) => "· ".to_owned(),
        (touches, false) => format!("{touches} "),
    }
}

/// Lines of CSV: a true shape, and its touches by the name that they are given.
pub(crate) fn matrix_csv(
    labels: &[String],
    names: &[String],
    counts: impl IntoIterator<Item = Vec<u128>>,
) -> String {
    let line = |name: &str, cells: Vec<String>| csv_line(iter::once(name.to_owned()).chain(cells));
    let mut lines = line("true", names.to_vec());
    for (label, counts) in labels.iter().zip(counts) {
        lines += &line(label, counts.iter().map(u128::to_string).collect());
    }
    lines
}

/// A line for each count, with its share of all touches and a note.
pub(crate) fn shares<'a>(
    touches: u128,
    counts: impl IntoIterator<Item = (&'a str, u128, &'a str)>,
) -> String {
    let rows = counts.into_iter().map(|(name, count, note)| {
        let part = percent(share(count, touches));
        row([name, &grouped(count), &part, note])
    });
    table(&rows.collect::<Vec<_>>(), &[0, 3])
}

/// An evaluation in JSON. In `confusion`, a row is a true shape, a column the name that it is given.
pub(crate) fn record(
    own: &Evaluation,
    classifier: Option<&ClassifierEvaluation>,
) -> Record<'static> {
    let row = |counts: Vec<u128>| counts.into_iter().map(count).collect::<Value>();
    let (certainty, rows) = (own.certainty, own.confusion.rows().map(row));
    let mut record = vec![
        ("labels", json!(own.labels)),
        ("touches", count(own.touches)),
        ("right", count(own.right)),
        ("accuracy", json!(own.accuracy())),
        ("error", json!(own.error())),
        ("certain", json!(certainty.map(|own| count(own.touches)))),
        ("tied", count(own.tied)),
        ("right_in_top_two", count(own.right_in_top_two)),
        ("information_bits", json!(own.information_bits)),
        ("prior_bits", json!(own.prior_bits)),
        ("keys", json!(own.keys)),
        ("keys_of_one_shape", json!(certainty.map(|own| own.keys))),
        ("confusion", rows.collect()),
    ];
    if let Some(reached) = classifier {
        record.push(("classifier", json!(reached.classifier.name())));
        record.push(("features", json!(reached.features)));
        record.push(("dropped", json!(reached.dropped)));
        if let Some((poses, seed)) = reached.sample {
            record.push(("sample", json!(poses)));
            record.push(("seed", json!(seed)));
        }
    }
    Record(record)
}

/// What the classifier of an evaluation knows of a touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NamedBy {
    Imprint,
    Descriptors,
    /// What is left of the imprint by a classifier that is not the best one.
    Classifier,
}

pub(crate) const WEIGHTED: &str = "each touch counts with the weight of its shape\n";

pub(crate) fn summary(own: &Evaluation, named: NamedBy) -> String {
    let keys = own.keys as u64;
    let imprints = counted(keys, "distinct imprint") + " up to shifts";
    let (distinct, limit, certain) = match named {
        NamedBy::Imprint => (
            imprints,
            "the limit: no method does better",
            "no other shape leaves the same imprint",
        ),
        NamedBy::Classifier => (imprints, "", ""),
        NamedBy::Descriptors => (
            counted(keys, "distinct combination") + " of their values",
            "no method that sees only these descriptors does better",
            "no other shape has the same values",
        ),
    };
    let (touches, shapes) = (counted(own.touches, "touch"), own.labels.len() as u64);
    let mut text = format!("{touches} of {}, {distinct}\n", counted(shapes, "shape"));
    if own.is_weighted() {
        text += WEIGHTED;
    }
    let certain = own.certainty.map(|own| ("certain", own.touches, certain));
    let counts = [
        Some(("right", own.right, "")),
        Some(("wrong", own.touches - own.right, limit)),
        certain,
        Some(("tied", own.tied, "the first of the tied shapes is named")),
        Some(("in top two", own.right_in_top_two, "")),
    ];
    text += &shares(own.touches, counts.into_iter().flatten());
    let (bits, of) = (own.information_bits, own.prior_bits);
    text + &format!("information  {bits:.4} of {of:.4} bits\n")
}

#[cfg(test)]
mod tests {
    use super::count;

    #[test]
    fn counts_beyond_64_bits_are_texts() {
        let most = u128::from(u64::MAX);
        assert_eq!(count(most), u64::MAX);
        assert_eq!(count(most + 1), "18446744073709551616");
    }
}
