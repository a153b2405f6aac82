//! `taxel model confusion`: how well one touch tells the shapes of a model apart.
//!
//! The best classifier is counted from all touches of the model, so its error is the limit of every method that sees
//! one touch.

use std::ffi::OsString;
use std::iter;

use clap::ArgGroup;
use clap::builder::PossibleValuesParser;
use serde_json::json;
use taxel_core::index::wide;
use taxel_core::parameter::number::share;
use taxel_core::recognition::{
    Classifier, ClassifierEvaluation, ClassifierSettings, Evaluation, GivenDescriptors, Model,
    Rounding,
};
use taxel_files::formats::value::{grouped, percent, percentage};
use taxel_files::formats::{ConfusionMap, json};
use taxel_files::storage::FoundModel;

use crate::cli::Context;
use crate::cli::arguments::flags::{name_or_path, whole};
use crate::cli::commands::model::noise::NoiseFlags;
use crate::cli::commands::model::{Table, TableFlags, find, fits_in_table, ready, watched};
use crate::cli::failure::Failure;
use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::{Count, EvaluationJson, NamedBy, summary};
use crate::cli::output::table::{row, table};

const EXAMPLES: &str = "\
A row is a true shape, a column the name that the best classifier gives it; the
numbers count touches, one for each pose, multiplied by the weight of its shape
if the shapes have weights. 'certain' counts the touches whose imprint only one
shape can leave.

--given, --greedy and --round use descriptors that do not depend on the
position of the imprint: na, nae, ce, p, f, roundness, area, diagonals,
side_ratio, filling, cg_cd, cg_cd_direction. CG-CD at full precision is more of
a fingerprint than a measurement: --round cg_cd=0.01 shows what it is worth when
measured to a hundredth of a cell.

--noise tests touches in random places on the sensor. Imprints that do not fit
on a smaller --matrix are left out, and standard error says how many.

Classifiers: z takes the shape whose mean is nearest, in standard deviations;
knn takes the shape of the nearest touches, template that of the nearest
imprint.

Examples:
  taxel model confusion parts
  taxel model confusion parts --given na,p --json
  taxel model confusion parts --greedy --round cg_cd=0.01
  taxel model confusion parts --classifier all
  taxel model confusion parts --noise 0:0.1:0.01 --dead 0,4 --touches 200
  taxel model confusion parts --export parts.svg";

/// Show which shapes one touch confuses, and the limit of any method
#[derive(Debug, clap::Args)]
#[command(
    after_help = EXAMPLES,
    group = ArgGroup::new("descriptors").args(["given", "greedy"]),
    group = ArgGroup::new("of").args(["greedy", "pairs", "classifier", "noise"]),
    group = ArgGroup::new("not_given").args(["greedy", "pairs"]).conflicts_with("given"),
    group = ArgGroup::new("with_classifier").arg("classifier"),
)]
pub(super) struct Confusion {
    /// Name of a model, or its file
    #[arg(value_name = "MODEL", value_parser = name_or_path())]
    model: OsString,
    /// Use only these descriptors, such as na,p
    #[arg(long, value_name = "KEY,...")]
    given: Option<GivenDescriptors>,
    /// Choose descriptors one by one until none helps
    #[arg(long, conflicts_with_all = ["csv", "export"])]
    greedy: bool,
    /// Print the error for each pair of shapes, by itself
    #[arg(long, conflicts_with_all = ["csv", "export"])]
    pairs: bool,
    /// Another way to name shapes: z, knn, template, or all of them in a table
    #[arg(long, value_name = "NAME", value_parser = classifiers(), hide_possible_values = true)]
    classifier: Option<String>,
    /// Round a descriptor to steps, such as cg_cd=0.01
    #[arg(
        long,
        value_name = "KEY=STEP",
        requires = "descriptors",
        conflicts_with = "classifier"
    )]
    round: Vec<Rounding>,
    /// Neighbours that vote in knn; default 1
    #[arg(long, value_name = "N", value_parser = whole::<u32>(1..), requires = "with_classifier")]
    neighbours: Option<u32>,
    /// Poses of each shape that knn draws; default 2000
    #[arg(long, value_name = "N", value_parser = whole::<u32>(1..), requires = "with_classifier")]
    sample: Option<u32>,
    /// Imprints of each shape for template; default 100
    #[arg(long, value_name = "N", value_parser = whole::<u32>(1..), requires = "with_classifier")]
    templates: Option<u32>,
    /// Seed of the random numbers; default 0
    #[arg(long, value_name = "N", value_parser = whole::<u64>(0..))]
    pub(super) seed: Option<u64>,
    #[command(flatten)]
    pub(super) table: TableFlags,
    #[command(flatten)]
    noise: NoiseFlags,
}

const ALL: &str = "all";

fn classifiers() -> PossibleValuesParser {
    let names = Classifier::ALL.iter().map(|own| own.name());
    PossibleValuesParser::new(names.chain([ALL]))
}

impl Confusion {
    pub(super) fn run(self, cx: &Context) -> Result<(), Failure> {
        self.check()?;
        let found = find(&self.model, &cx.shelf)?;
        self.check_model(&found)?;
        let model = ready(found, self.table.quiet, cx.charset)?;
        if let Some(noise) = self.noise.noise {
            let table = self.noise.table(noise, &model, &self, cx)?;
            return self.table.give(&table, cx);
        }
        if self.greedy {
            return self.print_greedy(&model, cx);
        }
        if self.pairs {
            return self.print_pairs(&model, cx);
        }
        let limit = match self.known() {
            Some(given) if self.classifier.is_none() => given.evaluate(&model),
            _ => Evaluation::of(&model),
        };
        let reached = |classifier| self.reached(classifier, &model, cx);
        match self.classifier.as_deref().map(str::parse) {
            None => {
                let table = Matrix(&limit, None, self.given.is_some());
                self.table.give(&table, cx)
            }
            Some(Ok(classifier)) => {
                let reached = reached(classifier)?;
                let table = Matrix(&reached.evaluation, Some(&reached), false);
                self.table.give(&table, cx)
            }
            Some(Err(_)) => {
                let all = Classifier::ALL
                    .iter()
                    .map(|&classifier| reached(classifier));
                let reached = all.collect::<Result<_, _>>()?;
                self.table.give(&Classifiers { reached, limit }, cx)
            }
        }
    }

    /// Refuses flags that would be ignored.
    fn check(&self) -> Result<(), Failure> {
        let unused = |flag: &str, reason: String| {
            Err(Failure::usage(format!("--{flag} has no effect {reason}")))
        };
        let name = self.classifier.as_deref().unwrap_or_default();
        let is = |one: &str| name == one || name == ALL;
        for (flag, is_used) in [
            ("neighbours", is("knn") || self.neighbours.is_none()),
            ("sample", is("knn") || self.sample.is_none()),
            ("templates", is("template") || self.templates.is_none()),
            ("given", name != "template" || self.given.is_none()),
        ] {
            if !is_used {
                return unused(flag, format!("with --classifier {name}"));
            }
        }
        if self.seed.is_some() && self.noise.noise.is_none() && !is("knn") {
            let reason = "without --noise or --classifier knn, which draw touches";
            return unused("seed", reason.to_owned());
        }
        for (index, own) in self.round.iter().enumerate() {
            let is_same = |other: &Rounding| other.descriptor == own.descriptor;
            let given = self.given.as_ref();
            let key = own.descriptor.key();
            if self.round[..index].iter().any(is_same) {
                return unused("round", format!("for {key}, which has a step already"));
            } else if given.is_some_and(|given| !given.descriptors.contains(&own.descriptor)) {
                return unused("round", format!("for {key}, which --given does not name"));
            }
        }
        Ok(())
    }

    /// Refuses what the shapes and the sensor of a model do not allow, and a file that cannot be written: before the
    /// work, not after it.
    fn check_model(&self, found: &FoundModel) -> Result<(), Failure> {
        let shapes: Vec<String> = found.shapes().iter().map(|own| own.name.clone()).collect();
        let is_matrix = !self.greedy
            && !self.pairs
            && self.noise.noise.is_none()
            && self.classifier.as_deref() != Some(ALL);
        if self.pairs {
            fits_in_table("--pairs", shapes.len())?;
        }
        if is_matrix {
            fits_in_table("confusion matrix", shapes.len())?;
        }
        self.noise.check(&found.sensor())?;
        if let Some(path) = self.table.draws().map(|path| path.display()) {
            if self.classifier.as_deref() == Some(ALL) {
                let text = "expected a name that ends in .csv, for the table of all classifiers";
                return Err(Failure::new(format!("{path}: {text}")));
            }
            if is_matrix && ConfusionMap::new(&shapes, []).is_none() {
                let text = "shapes, and a drawing shows at most 64; .csv takes all";
                return Err(Failure::new(format!("{path}: {} {text}", shapes.len())));
            }
        }
        self.table.check()
    }

    /// The descriptors that are known instead of the imprint, if only some are.
    pub(super) fn known(&self) -> Option<GivenDescriptors> {
        let mut given = self.given.clone()?;
        given.roundings.clone_from(&self.round);
        Some(given)
    }

    fn reached(
        &self,
        classifier: Classifier,
        model: &Model,
        cx: &Context,
    ) -> Result<ClassifierEvaluation, Failure> {
        let usual = ClassifierSettings::default();
        let or = |given: Option<u32>, usual| given.map_or(usual, wide);
        let settings = ClassifierSettings {
            descriptors: self.given.as_ref().map(|given| given.descriptors.clone()),
            neighbours: or(self.neighbours, usual.neighbours),
            sample: or(self.sample, usual.sample),
            templates: or(self.templates, usual.templates),
            seed: self.seed.unwrap_or_default(),
        };
        let all = (model.keys().len() as u64, "imprints");
        watched(all, self.table.quiet, cx, |progress| {
            classifier.evaluate(model, &settings, progress)
        })
    }

    /// The error falls from row to row, at best to that of the whole imprint; `values` are the distinct combinations.
    fn print_greedy(&self, model: &Model, cx: &Context) -> Result<(), Failure> {
        let chosen = model.choose_descriptors(&self.round);
        let limit = Evaluation::of(model);
        if self.table.json {
            let steps = chosen.iter().map(|step| {
                json!({
                    "descriptor": step.descriptor.key(),
                    "right": Count(step.evaluation.right),
                    "error": step.evaluation.error(),
                    "values": step.evaluation.keys,
                })
            });
            let steps: Vec<_> = steps.collect();
            let answer = json!({"chosen": steps, "limit": limit.error()});
            return cx.print(&(answer.to_string() + "\n"));
        }
        let step_row = |name: &str, own: &Evaluation| {
            row([name, &percent(own.error()), &grouped(own.keys as u64)])
        };
        let mut rows = vec![row(["descriptors chosen one by one", "error", "values"])];
        for step in &chosen {
            rows.push(step_row(
                &format!("+ {}", step.descriptor.key()),
                &step.evaluation,
            ));
        }
        rows.push(step_row("limit: the whole imprint", &limit));
        cx.print(&table(&rows, &[0], cx.charset))
    }

    /// The matrix is symmetric: each entry is the error of the best classifier if there were only these two shapes.
    fn print_pairs(&self, model: &Model, cx: &Context) -> Result<(), Failure> {
        let errors = model.pair_errors();
        let names = model.shapes().iter().map(|shape| shape.name.clone());
        let labels: Vec<String> = names.collect();
        if self.table.json {
            let answer = json!({"labels": labels, "errors": errors});
            return cx.print(&(json::ascii(&answer) + "\n"));
        }
        let rows = square(&labels, |row, column| match row == column {
            true => "–".to_owned(),
            false => percentage(errors[row][column], 2),
        });
        let text = table(&rows, &[0], cx.charset);
        cx.print(&(text + "errors in percent, for each pair alone\n"))
    }
}

/// The rows of a table with a row and a column for each shape; columns are numbered.
fn square(labels: &[String], cell: impl Fn(usize, usize) -> String) -> Vec<Vec<String>> {
    let shapes = labels.len();
    let digits = shapes.to_string().len();
    let numbers = (1..=shapes).map(|number| format!("{number} "));
    let mut rows = vec![iter::once(String::new()).chain(numbers).collect()];
    for (row, label) in labels.iter().enumerate() {
        let name = format!("{:>digits$} {label}", row + 1);
        let cells = (0..shapes).map(|column| cell(row, column));
        rows.push(iter::once(name).chain(cells).collect());
    }
    rows
}

/// An evaluation, the classifier if it is not the best one, and whether only given descriptors are known.
struct Matrix<'a>(&'a Evaluation, Option<&'a ClassifierEvaluation>, bool);

impl Table for Matrix<'_> {
    /// The matrix has the diagonal in brackets, zero as a dot, recall on the right, precision below.
    fn text(&self, charset: Charset) -> String {
        let &Self(own, classifier, is_given) = self;
        let named = match (classifier, is_given) {
            (Some(_), _) => NamedBy::Classifier,
            (None, true) => NamedBy::Descriptors,
            (None, false) => NamedBy::Imprint,
        };
        let dot = match charset {
            Charset::Ascii => ".",
            Charset::Unicode => "·",
        };
        let mut rows = square(&own.labels, |row, column| {
            match (own.confusion.get(row, column), row == column) {
                (touches, true) => format!("[{touches}]"),
                (0, false) => format!("{dot} "),
                (touches, false) => format!("{touches} "),
            }
        });
        let none = || "–".to_owned();
        rows[0].push("recall".to_owned());
        for (shape, row) in rows[1..].iter_mut().enumerate() {
            row.push(own.recall(shape).map_or_else(none, percent));
        }
        let precision = (0..own.labels.len()).map(|shape| {
            let precision = own.precision(shape);
            precision.map_or_else(none, |share| percentage(share, 0) + "%") + " "
        });
        rows.push(
            iter::once("precision".to_owned())
                .chain(precision)
                .collect(),
        );
        let mut text = summary(own, named) + "\n" + &table(&rows, &[0], charset);
        let pairs = own.worst_pairs();
        let pairs = pairs.iter().take(3).map(|pair| {
            let [one, other] = [pair.one, pair.other].map(|shape| &own.labels[shape]);
            let part = percent(share(pair.touches, own.touches));
            format!("{one} and {other} ({part})")
        });
        let pairs: Vec<String> = pairs.collect();
        if !pairs.is_empty() {
            text += &format!("most confused: {}\n", pairs.join(", "));
        }
        charset.lines(&(text + &classifier.map_or(String::new(), features) + &sampled(classifier)))
    }

    /// A heading row of names, then a row for each true shape.
    fn csv(&self) -> String {
        let mut table = csv::Writer::from_writer(Vec::new());
        let mut write = |name: &str, cells: &[String]| {
            let cells = cells.iter().map(String::as_str);
            // Cannot fail: the table is kept in memory, and all rows have the same length.
            let _ = table.write_record(iter::once(name).chain(cells));
        };
        write("true", &self.0.labels);
        for (name, row) in self.0.labels.iter().zip(self.0.confusion.rows()) {
            write(name, &row.iter().map(u128::to_string).collect::<Vec<_>>());
        }
        let _ = table.flush();
        String::from_utf8_lossy(table.get_ref()).into_owned()
    }

    fn json(&self) -> String {
        let (evaluation, classifier) = (self.0, self.1);
        json::ascii(&EvaluationJson {
            evaluation,
            classifier,
        }) + "\n"
    }

    fn svg(&self) -> Option<String> {
        let mut map = ConfusionMap::new(&self.0.labels, self.0.confusion.rows())?;
        map.title = format!("error {}", percent(self.0.error()));
        if let Some(certainty) = self.0.certainty {
            let certain = percent(share(certainty.touches, self.0.touches));
            map.title += &format!(", certain {certain}");
        }
        Some(map.svg())
    }
}

/// The features that a classifier used, and those that it left out because they have only one value or copy another
/// one. Templates have none: they compare imprints.
fn features(reached: &ClassifierEvaluation) -> String {
    if reached.classifier == Classifier::Template {
        return String::new();
    }
    let dropped = reached.dropped.iter();
    let dropped = dropped.map(|(name, reason)| format!("left out: {name}, {reason}\n"));
    format!("features: {}\n", reached.features.join(", ")) + &dropped.collect::<String>()
}

fn sampled<'a>(reached: impl IntoIterator<Item = &'a ClassifierEvaluation>) -> String {
    let drawn = reached.into_iter().filter_map(|own| {
        let (name, sample) = (own.classifier.name(), own.sample?);
        let (poses, seed) = (grouped(sample.per_shape as u64), sample.seed);
        Some(format!(
            "{name} draws {poses} poses of each shape, with seed {seed}\n"
        ))
    });
    drawn.collect()
}

/// All classifiers, and the limit of one touch in the last row.
struct Classifiers {
    reached: Vec<ClassifierEvaluation>,
    limit: Evaluation,
}

impl Classifiers {
    fn rows<'a>(
        &'a self,
        limit: &'static str,
    ) -> impl Iterator<Item = (&'static str, &'a Evaluation)> {
        let reached = self.reached.iter();
        let reached = reached.map(|own| (own.classifier.name(), &own.evaluation));
        reached.chain([(limit, &self.limit)])
    }
}

fn top_two(own: &Evaluation) -> f64 {
    share(own.right_in_top_two, own.touches)
}

impl Table for Classifiers {
    fn text(&self, charset: Charset) -> String {
        let mut rows = vec![row(["classifier", "error", "top two", "information"])];
        for (name, own) in self.rows("limit of one touch") {
            let bits = format!("{:.3} bits", own.information_bits);
            let (error, top_two) = (percent(own.error()), percent(top_two(own)));
            rows.push(row([name, &error, &top_two, &bits]));
        }
        let features = self.reached.first().map_or(String::new(), features);
        table(&rows, &[0], charset) + &charset.lines(&(features + &sampled(&self.reached)))
    }

    fn csv(&self) -> String {
        let mut text = String::from("classifier,error,right_in_top_two,information_bits\n");
        for (name, own) in self.rows("limit") {
            let (error, top_two, bits) = (own.error(), top_two(own), own.information_bits);
            text += &format!("{name},{error},{top_two},{bits}\n");
        }
        text
    }

    fn json(&self) -> String {
        let errors = self.rows("limit").map(|(name, own)| (name, own.error()));
        json::text(&errors.collect::<std::collections::BTreeMap<_, _>>()) + "\n"
    }

    fn svg(&self) -> Option<String> {
        None
    }
}
