//! What an evaluation of a model says, in words and as a line of JSON. All numbers are counted touches, not estimates.

use serde::ser::{Serialize, SerializeMap, Serializer};
use taxel_core::parameter::number::share;
use taxel_core::recognition::{ClassifierEvaluation, ConfusionMatrix, Evaluation};
use taxel_files::formats::value::{counted, grouped, percent};

use crate::cli::output::table::{row, table};

/// A count in JSON: a number, or a text if it is beyond 64 bits, as weights may cause.
#[derive(Clone, Copy)]
pub(crate) struct Count(pub(crate) u128);

impl Serialize for Count {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match u64::try_from(self.0) {
            Ok(count) => serializer.serialize_u64(count),
            Err(_) => serializer.collect_str(&self.0),
        }
    }
}

pub(crate) struct EvaluationJson<'a> {
    pub(crate) evaluation: &'a Evaluation,
    pub(crate) classifier: Option<&'a ClassifierEvaluation>,
}

impl Serialize for EvaluationJson<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let own = self.evaluation;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("labels", &own.labels)?;
        map.serialize_entry("touches", &Count(own.touches))?;
        map.serialize_entry("right", &Count(own.right))?;
        map.serialize_entry("accuracy", &own.accuracy())?;
        map.serialize_entry("error", &own.error())?;
        map.serialize_entry("certain", &own.certainty.map(|own| Count(own.touches)))?;
        map.serialize_entry("tied", &Count(own.tied))?;
        map.serialize_entry("right_in_top_two", &Count(own.right_in_top_two))?;
        map.serialize_entry("information_bits", &own.information_bits)?;
        map.serialize_entry("prior_bits", &own.prior_bits)?;
        map.serialize_entry("keys", &own.keys)?;
        map.serialize_entry("keys_of_one_shape", &own.certainty.map(|own| own.keys))?;
        map.serialize_entry("confusion", &Rows(&own.confusion))?;
        if let Some(reached) = self.classifier {
            map.serialize_entry("classifier", reached.classifier.name())?;
            map.serialize_entry("features", &reached.features)?;
            map.serialize_entry("dropped", &reached.dropped)?;
            if let Some(sample) = reached.sample {
                map.serialize_entry("sample", &sample.per_shape)?;
                map.serialize_entry("seed", &sample.seed)?;
            }
        }
        map.end()
    }
}

/// A row is a true shape, a column the name that it is given.
struct Rows<'a>(&'a ConfusionMatrix);

impl Serialize for Rows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let row = |counts: Vec<u128>| counts.into_iter().map(Count).collect::<Vec<_>>();
        serializer.collect_seq(self.0.rows().map(row))
    }
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
    let values = counted(keys, "distinct combination") + " of their values";
    let (distinct, limit, certain) = match named {
        NamedBy::Imprint => (
            imprints,
            "the limit: no method does better",
            "leaves the same imprint",
        ),
        NamedBy::Classifier => (imprints, "", ""),
        NamedBy::Descriptors => (
            values,
            "no method that sees only these descriptors does better",
            "has the same values",
        ),
    };
    let certain = format!("no other shape {certain}");
    let (touches, shapes) = (counted(own.touches, "touch"), own.labels.len() as u64);
    let mut text = format!("{touches} of {}, {distinct}\n", counted(shapes, "shape"));
    if own.is_weighted() {
        text += WEIGHTED;
    }
    let row = |name: &str, count: u128, note: &str| {
        row([
            name,
            &grouped(count),
            &percent(share(count, own.touches)),
            note,
        ])
    };
    let mut rows = vec![
        row("right", own.right, ""),
        row("wrong", own.touches - own.right, limit),
    ];
    rows.extend(
        own.certainty
            .map(|own| row("certain", own.touches, &certain)),
    );
    rows.push(row(
        "tied",
        own.tied,
        "the first of the tied shapes is named",
    ));
    rows.push(row("in top two", own.right_in_top_two, ""));
    text += &table(&rows, &[0, 3]);
    let (bits, of) = (own.information_bits, own.prior_bits);
    text + &format!("information  {bits:.4} of {of:.4} bits\n")
}
