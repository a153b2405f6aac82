//! Evaluations of models: as a table for people, as comma-separated values, and as a line of JSON. Rows are the true shapes,
//! columns the names they are given. All numbers are counted touches, not estimates.

use std::fmt::Write;
use std::iter;

use serde::ser::{Serialize, SerializeMap, Serializer};
use serde_json::json;
use taxel_core::parameter::number::share;
use taxel_core::recognition::{
    ChosenDescriptor, Classifier, ClassifierEvaluation, ConfusionMatrix, Evaluation,
};
use taxel_files::formats::value::{counted, grouped, percent, percentage};

use crate::cli::output::charset::Charset;
use crate::tui::widget::write::width;

pub(crate) struct EvaluationJson<'a> {
    pub(crate) evaluation: &'a Evaluation,
    pub(crate) classifier: Option<&'a ClassifierEvaluation>,
}

impl Serialize for EvaluationJson<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let own = self.evaluation;
        let certain = own.certainty.map(|certainty| number(certainty.touches));
        let keys_of_one_shape = own.certainty.map(|certainty| certainty.keys);
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("labels", &own.labels)?;
        map.serialize_entry("touches", &number(own.touches))?;
        map.serialize_entry("right", &number(own.right))?;
        map.serialize_entry("accuracy", &own.accuracy())?;
        map.serialize_entry("error", &own.error())?;
        map.serialize_entry("certain", &certain)?;
        map.serialize_entry("tied", &number(own.tied))?;
        map.serialize_entry("right_in_top_two", &number(own.right_in_top_two))?;
        map.serialize_entry("information_bits", &own.information_bits)?;
        map.serialize_entry("prior_bits", &own.prior_bits)?;
        map.serialize_entry("keys", &own.keys)?;
        map.serialize_entry("keys_of_one_shape", &keys_of_one_shape)?;
        map.serialize_entry("confusion", &MatrixRows(&own.confusion))?;
        if let Some(reached) = self.classifier {
            map.serialize_entry("classifier", reached.classifier.name())?;
            map.serialize_entry("features", &reached.features)?;
            let dropped = reached
                .dropped
                .iter()
                .map(|(name, reason)| (name.as_str(), *reason));
            map.serialize_entry("dropped", &dropped.collect::<Vec<_>>())?;
            if let Some(sample) = reached.sample {
                map.serialize_entry("sample", &sample.per_shape)?;
                map.serialize_entry("seed", &sample.seed)?;
            }
        }
        map.end()
    }
}

struct MatrixRows<'a>(&'a ConfusionMatrix);

impl Serialize for MatrixRows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let row = |counts: Vec<u128>| counts.into_iter().map(number).collect::<Vec<_>>();
        serializer.collect_seq(self.0.rows().map(row))
    }
}

/// Returns a count as JSON. A count beyond 64 bits does not fit in memory anyway, but a weight may cause one; it
/// becomes a text.
pub(crate) fn number(count: u128) -> serde_json::Value {
    match u64::try_from(count) {
        Ok(count) => json!(count),
        Err(_) => json!(count.to_string()),
    }
}

/// Draws a bar for a share, of at most `width` characters. The length is rounded, so a small share may have no bar.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "a share is from 0 to 1, a width that of a terminal"
)]
pub(crate) fn bar(share: f64, width: usize, charset: Charset) -> String {
    let full = match charset {
        Charset::Ascii => "#",
        Charset::Unicode => "█",
    };
    full.repeat((share * width as f64).round() as usize)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NamedBy {
    Imprint,
    Descriptors,
    Classifier,
}

impl NamedBy {
    fn remark(self) -> &'static str {
        match self {
            Self::Imprint => "  the limit: no method does better",
            Self::Descriptors => "  no method that sees only these descriptors does better",
            Self::Classifier => "",
        }
    }

    fn certain(self) -> &'static str {
        match self {
            Self::Descriptors => "  no other shape has the same values",
            Self::Imprint | Self::Classifier => "  no other shape leaves the same imprint",
        }
    }

    fn distinct(self, number: u64) -> String {
        match self {
            Self::Imprint | Self::Classifier => {
                counted(number, "distinct imprint") + " up to shifts"
            }
            Self::Descriptors => counted(number, "distinct combination") + " of their values",
        }
    }
}

pub(crate) const WEIGHTED: &str = "each touch counts with the weight of its shape\n";

pub(crate) fn summary(evaluation: &Evaluation, named: NamedBy) -> String {
    let of_touches = |part: u128| percent(share(part, evaluation.touches));
    let Evaluation {
        touches,
        right,
        certainty,
        tied,
        right_in_top_two,
        ..
    } = evaluation;
    let mut text = format!(
        "{} of {}, {}\n",
        counted(*touches, "touch"),
        counted(evaluation.labels.len() as u64, "shape"),
        named.distinct(evaluation.keys as u64)
    );
    if evaluation.is_weighted() {
        text += WEIGHTED;
    }
    let mut line = |name: &str, value: u128, note: &str| {
        // Cannot fail: the text is kept in memory.
        let _ = writeln!(
            text,
            "{name:<12} {:>16}  {:>7}{note}",
            grouped(value),
            of_touches(value)
        );
    };
    line("right", *right, "");
    line("wrong", touches - right, named.remark());
    if let Some(certainty) = certainty {
        line("certain", certainty.touches, named.certain());
    }
    line("tied", *tied, "  the first of the tied shapes is named");
    line("in top two", *right_in_top_two, "");
    let _ = writeln!(
        text,
        "information  {:.4} of {:.4} bits",
        evaluation.information_bits, evaluation.prior_bits
    );
    text
}

/// Returns the matrix: a row for each true shape, a column for each name, the diagonal in brackets, zero as a dot;
/// recall on the right, precision below. Columns are numbered. The first one begins after the longest name. A column
/// is as wide as its largest number with brackets, so that the diagonal does not shift its row. Precision is `–` for
/// a name that is never given.
pub(crate) fn matrix(evaluation: &Evaluation, charset: Charset) -> String {
    let labels = &evaluation.labels;
    let dot = match charset {
        Charset::Ascii => ".",
        Charset::Unicode => "·",
    };
    let cell = |row: usize, column: usize| {
        let touches = evaluation.confusion.get(row, column);
        match (touches, row == column) {
            (touches, true) => format!("[{touches}]"),
            (0, false) => format!("{dot} "),
            (touches, false) => format!("{touches} "),
        }
    };
    let shapes = labels.len();
    let numbers = shapes.to_string().len();
    let names = charset.column(labels.iter().map(String::as_str));
    let name = names.first().map_or(0, |name| width(name));
    let mut widths = Vec::new();
    for column in 0..shapes {
        let cells = (0..shapes).map(|row| cell(row, column).chars().count());
        widths.push(cells.max().unwrap_or_default().max(numbers + 1));
    }
    let mut text = format!("{:1$}", "", name + numbers + 1);
    for (column, width) in widths.iter().enumerate() {
        let _ = write!(text, " {:>1$} ", column + 1, width - 1);
    }
    text += "   recall\n";
    for (row, label) in names.iter().enumerate() {
        let _ = write!(text, "{:>numbers$} {label}", row + 1);
        for (column, width) in widths.iter().enumerate() {
            let _ = write!(text, " {:>width$}", cell(row, column));
        }
        let recall = evaluation.recall(row);
        let recall = recall.map_or_else(|| "–".to_owned(), percent);
        let _ = writeln!(text, "  {recall:>7}");
    }
    let _ = write!(text, "{:1$}", "", numbers + 1);
    let _ = write!(text, "{:<1$}", "precision", name.max(9));
    let mut first = name.max(9) - name;
    for (column, width) in widths.iter().enumerate() {
        let precision = match evaluation.precision(column) {
            Some(share) => format!("{}%", percentage(share, 0)),
            None => "–".to_owned(),
        };
        let width = (width - 1).saturating_sub(std::mem::take(&mut first));
        let _ = write!(text, " {precision:>width$} ");
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    charset.lines(&text)
}

/// Returns the worst pairs, at most three: `most confused: disc and block (1.6 %)`. It is empty if no shape is taken
/// for another. Both directions of a pair are added; the share is that of all touches.
pub(crate) fn worst_pairs(evaluation: &Evaluation, charset: Charset) -> String {
    let pairs = evaluation.worst_pairs();
    let said = pairs.iter().take(3).map(|pair| {
        format!(
            "{} and {} ({})",
            evaluation.labels[pair.one],
            evaluation.labels[pair.other],
            percent(share(pair.touches, evaluation.touches))
        )
    });
    match said.collect::<Vec<_>>().join(", ") {
        said if said.is_empty() => String::new(),
        said => charset.lines(&format!("most confused: {said}\n")),
    }
}

/// Returns the matrix as comma-separated values: a heading row of names, then a row for each true shape. Names with a
/// comma, a quotation mark or a line end are quoted, quotation marks doubled (RFC 4180):
/// ```text
/// true,bar,disc
/// bar,1800,0
/// disc,0,1728
/// ```
pub(crate) fn csv(evaluation: &Evaluation) -> String {
    let mut table = csv::Writer::from_writer(Vec::new());
    let mut write = |name: &str, cells: &[String]| {
        let cells = cells.iter().map(String::as_str);
        // Cannot fail: the table is kept in memory, and all rows have the same length.
        let _ = table.write_record(iter::once(name).chain(cells));
    };
    write("true", &evaluation.labels);
    for (name, row) in evaluation.labels.iter().zip(evaluation.confusion.rows()) {
        write(name, &row.iter().map(u128::to_string).collect::<Vec<_>>());
    }
    let _ = table.flush();
    String::from_utf8_lossy(table.get_ref()).into_owned()
}

/// Returns the descriptors in the order in which they were chosen, and the limit in the last row. The error falls
/// from row to row, at best to that of the whole imprint; `values` are the distinct combinations:
/// ```text
/// descriptors chosen one by one    error   values
/// + f                              5.6 %       61
/// + cg_cd                          2.1 %      118
/// limit: the whole imprint         1.6 %      845
/// ```
pub(crate) fn greedy(chosen: &[ChosenDescriptor], limit: &Evaluation, charset: Charset) -> String {
    let mut text = String::from("descriptors chosen one by one    error   values\n");
    for step in chosen {
        let _ = writeln!(
            text,
            "+ {:<24} {:>11}  {:>7}",
            step.descriptor.key(),
            percent(step.evaluation.error()),
            grouped(step.evaluation.keys as u64)
        );
    }
    let _ = writeln!(
        text,
        "{:<26} {:>11}  {:>7}",
        "limit: the whole imprint",
        percent(limit.error()),
        grouped(limit.keys as u64)
    );
    charset.lines(&text)
}

/// Returns the table of all classifiers, with the limit in the last row:
/// ```text
/// classifier             error  top two  information
/// knn                    8.4 %   99.9 %   1.179 bits
/// limit of one touch     1.6 %  100.0 %   1.538 bits
/// ```
pub(crate) fn classifiers(
    reached: &[ClassifierEvaluation],
    limit: &Evaluation,
    charset: Charset,
) -> String {
    let mut text = String::from("classifier             error  top two  information\n");
    let mut line = |name: &str, evaluation: &Evaluation| {
        let _ = writeln!(
            text,
            "{name:<18} {:>9}  {:>7}  {:>6.3} bits",
            percent(evaluation.error()),
            percent(share(evaluation.right_in_top_two, evaluation.touches)),
            evaluation.information_bits
        );
    };
    for own in reached {
        line(own.classifier.name(), &own.evaluation);
    }
    line("limit of one touch", limit);
    let drawn = reached.iter().map(sampled).collect::<String>();
    charset.lines(&(text + &features(reached.first()) + &drawn))
}

pub(crate) fn classifiers_csv(reached: &[ClassifierEvaluation], limit: &Evaluation) -> String {
    let mut text = String::from("classifier,error,right_in_top_two,information_bits\n");
    let classifiers = reached
        .iter()
        .map(|own| (own.classifier.name(), &own.evaluation));
    for (name, own) in classifiers.chain([("limit", limit)]) {
        let top_two = share(own.right_in_top_two, own.touches);
        // Cannot fail: the text is kept in memory.
        let _ = writeln!(
            text,
            "{name},{},{top_two},{}",
            own.error(),
            own.information_bits
        );
    }
    text
}

pub(crate) fn sampled(reached: &ClassifierEvaluation) -> String {
    let Some(sample) = reached.sample else {
        return String::new();
    };
    format!(
        "{} draws {} poses of each shape, with seed {}\n",
        reached.classifier.name(),
        grouped(sample.per_shape as u64),
        sample.seed
    )
}

/// Returns the features that a classifier used, and those that it left out because they have only one value or copy
/// another one. It is empty without a classifier, and for templates, which compare imprints.
pub(crate) fn features(reached: Option<&ClassifierEvaluation>) -> String {
    let Some(reached) = reached.filter(|own| own.classifier != Classifier::Template) else {
        return String::new();
    };
    let mut text = format!("features: {}\n", reached.features.join(", "));
    for (name, reason) in &reached.dropped {
        let _ = writeln!(text, "left out: {name}, {reason}");
    }
    text
}

/// Returns the errors of pairs, in percent. The matrix is symmetric: each entry is the error of the best classifier
/// if there were only these two shapes.
pub(crate) fn pairs(labels: &[String], errors: &[Vec<f64>], charset: Charset) -> String {
    let names = charset.column(labels.iter().map(String::as_str));
    let name = names.first().map_or(0, |name| width(name));
    let numbers = labels.len().to_string().len();
    let mut text = format!("{:1$}", "", name + numbers + 1);
    for column in 1..=labels.len() {
        let _ = write!(text, " {column:>6}");
    }
    text.push('\n');
    for (row, (label, errors)) in names.iter().zip(errors).enumerate() {
        let _ = write!(text, "{:>numbers$} {label}", row + 1);
        for (column, error) in errors.iter().enumerate() {
            let cell = if row == column {
                String::from("–")
            } else {
                percentage(*error, 2)
            };
            let _ = write!(text, " {cell:>6}");
        }
        text.push('\n');
    }
    text += "errors in percent, for each pair alone\n";
    charset.lines(&text)
}

#[cfg(test)]
mod tests {
    use taxel_core::figure::Figure;
    use taxel_core::pose::{Anchor, Axis, Ranges};
    use taxel_core::recognition::{ImprintKey, KeyTable, Model, ModelHead, NamedShape, ShapeCount};
    use taxel_core::sensor::Sensor;
    use taxel_files::formats::json;

    use super::*;

    fn keys<const N: usize>(imprints: [&str; N]) -> KeyTable {
        let mut keys = KeyTable::default();
        for imprint in imprints {
            keys.add(&ImprintKey::of(&imprint.parse().expect("an imprint")));
        }
        keys
    }

    #[test]
    fn counts_beyond_64_bits_are_texts_wherever_they_stand() {
        let bar = Figure::rectangle(4.0, 2.0).on(&Sensor::default());
        let shapes = vec![NamedShape::new("bar", bar.expect("in range")).weighted(u32::MAX)];
        let (mut ranges, poses) = (Ranges::default(), 1000 * 1000 * 36_000);
        for (axis, range) in [
            (Axis::X0, "5:5.999:0.001"),
            (Axis::Y0, "5:5.999:0.001"),
            (Axis::Angle, "0:359.99:0.01"),
        ] {
            ranges = ranges.with(axis, range.parse().expect("a range"));
        }
        let head = ModelHead::new(shapes, Sensor::default(), Anchor::Centre, ranges, poses);
        let keys = keys(["####\n####"]);
        let model = Model::of_table(head, &keys, |_| [ShapeCount::new(0, poses)]);
        let limit = Evaluation::of(&model.expect("a model"));
        let text = json::text(&EvaluationJson {
            evaluation: &limit,
            classifier: None,
        });
        for part in [
            "\"touches\":",
            "\"right\":",
            "\"certain\":",
            "\"right_in_top_two\":",
            "\"confusion\":[[",
        ] {
            let count = format!("{part}\"154618822620000000000\"");
            assert!(text.contains(&count), "{count}: {text}");
        }
        assert!(text.contains("\"tied\":0,"), "{text}");
    }

    #[test]
    fn a_share_that_is_not_exactly_0_or_1_does_not_look_like_it_in_any_table() {
        let bar = |length| {
            let bar = Figure::rectangle(length, 2.0).on(&Sensor::default());
            bar.expect("in range")
        };
        let shapes = [("long", 4.0), ("short", 3.0)];
        let shapes = shapes.map(|(name, length)| NamedShape::new(name, bar(length)));
        let mut ranges = Ranges::default();
        for (axis, range) in [
            (Axis::X0, "5:5.999:0.001"),
            (Axis::Y0, "5"),
            (Axis::Angle, "0"),
        ] {
            ranges = ranges.with(axis, range.parse().expect("a range"));
        }
        let head = ModelHead::new(
            shapes.to_vec(),
            Sensor::default(),
            Anchor::Centre,
            ranges,
            1000,
        );
        let counts = [
            vec![ShapeCount::new(0, 1000), ShapeCount::new(1, 1)],
            vec![ShapeCount::new(1, 999)],
        ];
        let keys = keys(["####\n####", "###\n###"]);
        let model = Model::of_table(head, &keys, |key| counts[key].clone()).expect("a model");
        let table = matrix(&Evaluation::of(&model), Charset::Unicode);
        assert!(table.contains("[1000]"), "{table}");
        let precision = table.lines().last().expect("a line");
        let found: Vec<&str> = precision.split_whitespace().collect();
        assert_eq!(found, ["precision", ">99%", "100%"]);
        let labels = ["long", "short"].map(str::to_owned);
        let table = pairs(
            &labels,
            &[vec![0.0, 1e-5], vec![1e-5, 0.0]],
            Charset::Unicode,
        );
        assert_eq!(table.matches("<0.01").count(), 2, "{table}");
    }
}
