//! `taxel model confusion`: how well one touch tells the shapes of a model apart.
//!
//! The best classifier is counted from all touches of the model, so its error is the limit of every method that sees
//! one touch.

use std::ffi::OsString;
use std::iter;

use clap::ArgGroup;
use serde_json::{Value, json};
use taxel_core::imprint::Imprint;
use taxel_core::index::wide;
use taxel_core::parameter::number::share;
use taxel_core::recognition::{
    Classifier, ClassifierEvaluation, ClassifierSettings, Evaluation, GivenDescriptors, Model,
    NamedShape, RandomTouches, Rounding,
};
use taxel_files::formats::name::folded;
use taxel_files::formats::value::{counted, grouped, percent, percentage};
use taxel_files::formats::{ConfusionMap, json};
use taxel_files::storage::FoundModel;

use crate::cli::Context;
use crate::cli::arguments::flags::{name_or_path, one_of, whole};
use crate::cli::commands::model::noise::NoiseFlags;
use crate::cli::commands::model::trial::TrialReport;
use crate::cli::commands::model::{
    SetFlags, Table, TableFlags, find, fits_in_table, ready, watched,
};
use crate::cli::failure::{Failure, Named};
use crate::cli::input::outlines::OutlineFlags;
use crate::cli::input::shapes;
use crate::cli::output::evaluation::{self, NamedBy, cell, count, matrix_csv, summary};
use crate::cli::output::table::{row, table};
use crate::cli::settings::Pitch;
use crate::naming::Terms;

const EXAMPLES: &str = "\
A row is a true shape, a column the name that the best classifier gives it; the
numbers count touches, one for each pose, multiplied by the weight of its shape
if the shapes have weights. 'certain' counts the touches whose imprint only one
shape can leave.

--test touches in random poses between those of the model, and answers as
'taxel recognise' does with the same --noise and --tolerance; the touches
themselves have no noise. --foreign also touches shapes that the model does not
have.

--given, --greedy and --round use descriptors that do not depend on the
position of the imprint: na, nae, ce, p, f, roundness, area, diagonals,
side_ratio, filling, cg_cd, cg_cd_direction. CG-CD at full precision is more of
a fingerprint than a measurement: --round cg_cd=0.01 shows what it is worth when
measured to a hundredth of a cell.

Without --test, --noise tests touches in random places on the sensor, whose
taxels flip.

Classifiers: z takes the shape whose mean is nearest, in standard deviations;
knn takes the shape of the nearest touches, template that of the nearest
imprint.

Examples:
  taxel model confusion parts
  taxel model confusion parts --test 200 --foreign washer key
  taxel model confusion parts --given na,p --json
  taxel model confusion parts --greedy --round cg_cd=0.01
  taxel model confusion parts --classifier knn
  taxel model confusion parts --noise 0:0.1:0.01 --touches 200
  taxel model confusion parts --export parts.svg";

/// Show which shapes one touch confuses, and the limit of any method
#[derive(Debug, clap::Args)]
#[command(
    after_help = EXAMPLES,
    group = ArgGroup::new("descriptors").args(["given", "greedy"]),
    group = ArgGroup::new("of").args(["greedy", "classifier", "noise"]),
    group = ArgGroup::new("with_classifier").arg("classifier"),
)]
pub(crate) struct Confusion {
    /// Name of a model, or its file
    #[arg(value_name = "MODEL", value_parser = name_or_path())]
    model: OsString,
    /// Answer N touches of each shape in random poses, as 'taxel recognise' does
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST_TESTED))]
    #[arg(conflicts_with_all = OTHERS)]
    test: Option<u64>,
    /// Also touch these shapes, which the model does not have: unknown is right
    #[arg(long, value_name = "FILE.jsonl|NAME", value_parser = name_or_path(), num_args = 1..)]
    #[arg(requires = "test", conflicts_with_all = OTHERS)]
    foreign: Vec<OsString>,
    /// Taxels that may differ from the fit; by default depends on the imprint
    #[arg(long, value_name = "K", value_parser = whole(0_u32..))]
    #[arg(requires = "test", conflicts_with_all = OTHERS)]
    tolerance: Option<u32>,
    /// Use only these descriptors, such as na,p
    #[arg(long, value_name = "KEY,...", conflicts_with = "noise")]
    given: Option<GivenDescriptors>,
    /// Choose descriptors one by one until none helps
    #[arg(long, conflicts_with = "export")]
    greedy: bool,
    /// Another way to name shapes: z, knn or template
    #[arg(long, value_name = "NAME", value_parser = one_of::<Classifier, _>(Classifier::ALL.iter().map(|own| own.name())))]
    #[arg(hide_possible_values = true)]
    classifier: Option<Classifier>,
    // A doc comment would want quotation marks around the key.
    #[arg(long, value_name = "KEY=STEP", requires = "descriptors")]
    #[arg(help = "Round a descriptor to steps, such as cg_cd=0.01")]
    #[arg(conflicts_with = "classifier")]
    round: Vec<Rounding>,
    /// Neighbours that vote in knn; default 1
    #[arg(long, value_name = "N", requires = "with_classifier", value_parser = whole(1_u32..))]
    neighbours: Option<u32>,
    /// Poses of each shape that knn draws; default 2000
    #[arg(long, value_name = "N", requires = "with_classifier", value_parser = whole(1_u32..))]
    sample: Option<u32>,
    /// Imprints of each shape for template; default 100
    #[arg(long, value_name = "N", requires = "with_classifier", value_parser = whole(1_u32..))]
    templates: Option<u32>,
    /// Seed of the random numbers; default 0
    #[arg(long, value_name = "N", value_parser = whole(0_u64..))]
    pub(super) seed: Option<u64>,
    /// Print the confusion matrix as comma-separated values
    #[arg(long, conflicts_with_all = ["json", "greedy"])]
    csv: bool,
    #[command(flatten)]
    pub(super) table: TableFlags,
    #[command(flatten)]
    noise: NoiseFlags,
}

/// The most shapes of a drawing, as of [`ConfusionMap`].
const MOST_DRAWN: usize = 64;

/// What does not go together with `--test`.
const OTHERS: [&str; 6] = [
    "given",
    "greedy",
    "classifier",
    "round",
    "touches",
    "export",
];

/// The most random touches of a shape: the answers to all of them are kept until they are counted.
const MOST_TESTED: u64 = 10_000_000;

impl Confusion {
    pub(super) fn run(self, cx: &Context) -> Result<(), Failure> {
        self.check()?;
        let found = find(&self.model, &cx.shelf)?;
        let foreign = self.foreign_shapes(&found, cx)?;
        self.check_model(&found)?;
        let model = ready(found, self.table.quiet)?;
        if let Some(each) = self.test {
            self.tested(&model, foreign, each, cx)
        } else if let Some(noise) = self.noise.noise {
            let rates = self.noise.rates(noise, &model, &self)?;
            self.table.give(&rates, false, cx)
        } else if self.greedy {
            cx.print(&self.chosen(&model))
        } else if let Some(classifier) = self.classifier {
            let reached = self.reached(classifier, &model)?;
            let (own, named) = (&reached.evaluation, NamedBy::Classifier);
            self.table
                .give(&Matrix(own, named, Some(&reached)), self.csv, cx)
        } else {
            let (limit, named) = match self.known() {
                Some(given) => (given.evaluate(&model), NamedBy::Descriptors),
                None => (Evaluation::of(&model), NamedBy::Imprint),
            };
            self.table.give(&Matrix(&limit, named, None), self.csv, cx)
        }
    }

    /// Refuses flags that would be ignored.
    fn check(&self) -> Result<(), Failure> {
        let is = |one| self.classifier == Some(one);
        let (no_knn, is_template) = (!is(Classifier::Knn), is(Classifier::Template));
        let is_curve = self.test.is_none() && self.noise.noise.is_some();
        let none_drawn = self.test.is_none() && !is_curve && no_knn;
        let without = "without --test, --noise or --classifier knn, which draw touches";
        let given = self.given.as_ref();
        let known =
            |own: &Rounding| given.is_none_or(|all| all.descriptors.contains(&own.descriptor));
        let unknown = !self.round.iter().all(known);
        let unused = [
            (
                "neighbours",
                self.neighbours.is_some() && no_knn,
                "without --classifier knn",
            ),
            (
                "sample",
                self.sample.is_some() && no_knn,
                "without --classifier knn",
            ),
            (
                "templates",
                self.templates.is_some() && !is_template,
                "without --classifier template",
            ),
            (
                "given",
                given.is_some() && is_template,
                "with --classifier template",
            ),
            ("seed", self.seed.is_some() && none_drawn, without),
            ("round", unknown, "for what --given does not name"),
            (
                "csv",
                self.csv && is_curve,
                "with --noise but without --test",
            ),
        ];
        if self.test.is_some() && self.noise.noise.is_some_and(|noise| noise.count() > 1) {
            let text = "--noise: with --test, expected one probability, not a range";
            return Err(Failure::usage(text));
        }
        let unused = unused.into_iter().find(|(_, is_unused, _)| *is_unused);
        unused.map_or(Ok(()), |(flag, _, reason)| {
            Err(Failure::usage(format!("--{flag} has no effect {reason}")))
        })
    }

    /// Refuses what the shapes and the sensor of a model do not allow, and a file that cannot be written: before the
    /// work, not after it.
    fn check_model(&self, found: &FoundModel) -> Result<(), Failure> {
        let shapes = found.shapes().len();
        let is_curve = self.noise.noise.is_some() && self.test.is_none();
        if !self.greedy && !is_curve {
            fits_in_table("confusion matrix", shapes)?;
        }
        if self.table.export.is_some() && !is_curve && shapes > MOST_DRAWN {
            let text = format!("{shapes} shapes, and a drawing shows at most {MOST_DRAWN}");
            return Err(Failure::new(text)).named("--export");
        }
        self.table.check()
    }

    /// The shapes of `--foreign`. One that the model has would be counted as wrong.
    fn foreign_shapes(&self, model: &FoundModel, cx: &Context) -> Result<Vec<NamedShape>, Failure> {
        let set = SetFlags {
            what: self.foreign.clone(),
            library_all: false,
            outlines: OutlineFlags::default(),
        };
        // Millimetres are divided as they were for the model's own shapes.
        let (given, usual) = (None, cx.settings.sensor.pitch);
        let usual = Pitch { given, usual }.of(Some(&model.sensor()));
        let pitch = Pitch { given, usual };
        let foreign = shapes::read_set(&set, pitch, &cx.shelf)?;
        let is_known = |own: &&NamedShape| {
            let mut known = model.shapes().iter();
            known.any(|known| folded(&known.name) == folded(&own.name))
        };
        match foreign.iter().find(is_known) {
            None => Ok(foreign),
            Some(own) => {
                let text = format!("the model has a shape named {:?}", own.name);
                Err(Failure::new(text)).named("--foreign")
            }
        }
    }

    /// Answers random touches as `taxel recognise` does with the same noise and tolerance.
    fn tested(
        &self,
        model: &Model,
        foreign: Vec<NamedShape>,
        each: u64,
        cx: &Context,
    ) -> Result<(), Failure> {
        let seed = self.seed.unwrap_or_default();
        let terms = Terms {
            noise: self.noise.noise.map(|noise| noise.value(0)),
            tolerance: self.tolerance,
            reject_below: None,
        };
        let answer = |touch: &Imprint| terms.answer(model, &[*touch], None);
        let touches = RandomTouches::new(model, foreign, each, seed)?;
        let trial = watched((touches.count(), "touches"), self.table.quiet, |progress| {
            touches.answer(model, &answer, progress)
        })?;
        let report = TrialReport {
            trial: &trial,
            noun: "touch",
            note: format!(
                "{} of each shape, seed {seed}",
                counted(each, "random touch")
            ),
            keys: vec![("test", each.into()), ("seed", seed.into())],
        };
        self.table.give(&report, self.csv, cx)
    }

    /// The descriptors that are known instead of the imprint, if only some are.
    fn known(&self) -> Option<GivenDescriptors> {
        let mut given = self.given.clone()?;
        given.roundings.clone_from(&self.round);
        Some(given)
    }

    fn reached(
        &self,
        classifier: Classifier,
        model: &Model,
    ) -> Result<ClassifierEvaluation, Failure> {
        let usual = ClassifierSettings::default();
        let settings = ClassifierSettings {
            descriptors: self.given.as_ref().map(|given| given.descriptors.clone()),
            neighbours: self.neighbours.map_or(usual.neighbours, wide),
            sample: self.sample.map_or(usual.sample, wide),
            templates: self.templates.map_or(usual.templates, wide),
            seed: self.seed.unwrap_or(usual.seed),
        };
        let all = (model.keys().len() as u64, "imprints");
        watched(all, self.table.quiet, |progress| {
            classifier.evaluate(model, &settings, progress)
        })
    }

    /// The error falls from row to row, at best to that of the whole imprint; `values` are the distinct combinations.
    fn chosen(&self, model: &Model) -> String {
        let chosen = model.choose_descriptors(&self.round);
        let limit = Evaluation::of(model);
        if self.table.json {
            let steps = chosen.iter().map(|step| {
                json!({
                    "descriptor": step.descriptor.key(),
                    "right": count(step.evaluation.right),
                    "error": step.evaluation.error(),
                    "values": step.evaluation.keys,
                })
            });
            let steps = steps.collect::<Value>();
            return json!({"chosen": steps, "limit": limit.error()}).to_string() + "\n";
        }
        let cells = |name: &str, own: &Evaluation| {
            row([name, &percent(own.error()), &grouped(own.keys as u64)])
        };
        let mut rows = vec![row(["descriptors chosen one by one", "error", "values"])];
        for step in &chosen {
            let name = format!("+ {}", step.descriptor.key());
            rows.push(cells(&name, &step.evaluation));
        }
        rows.push(cells("limit: the whole imprint", &limit));
        table(&rows, &[0])
    }
}

/// The rows of a table with a row for each label and a column for each of the first ones; both are numbered.
pub(super) fn square(
    labels: &[String],
    columns: usize,
    cell: impl Fn(usize, usize) -> String,
) -> Vec<Vec<String>> {
    let digits = labels.len().to_string().len();
    let numbers = (1..=columns).map(|number| format!("{number} "));
    let mut rows = vec![iter::once(String::new()).chain(numbers).collect()];
    for (row, label) in labels.iter().enumerate() {
        let name = format!("{:>digits$} {label}", row + 1);
        let cells = (0..columns).map(|column| cell(row, column));
        rows.push(iter::once(name).chain(cells).collect());
    }
    rows
}

struct Matrix<'a>(&'a Evaluation, NamedBy, Option<&'a ClassifierEvaluation>);

impl Table for Matrix<'_> {
    /// The matrix has the diagonal in brackets, zero as a dot, recall on the right, precision below.
    fn text(&self) -> String {
        let &Self(own, named, classifier) = self;
        let mut rows = square(&own.labels, own.labels.len(), |row, column| {
            cell(own.confusion.get(row, column), row == column)
        });
        rows[0].push("recall".to_owned());
        let mut precision = vec!["precision".to_owned()];
        for shape in 0..own.labels.len() {
            let right = own
                .precision(shape)
                .map(|share| percentage(share, 0) + "% ");
            precision.push(right.unwrap_or("– ".to_owned()));
            rows[shape + 1].push(own.recall(shape).map_or("–".to_owned(), percent));
        }
        rows.push(precision);
        let mut text = summary(own, named) + "\n" + &table(&rows, &[0]);
        let pairs = own.worst_pairs();
        let pairs = pairs.iter().take(3).map(|pair| {
            let &((one, other), touches) = pair;
            let [one, other] = [one, other].map(|shape| &own.labels[shape]);
            let part = percent(share(touches, own.touches));
            format!("{one} and {other} ({part})")
        });
        let pairs: Vec<String> = pairs.collect();
        if !pairs.is_empty() {
            text += &format!("most confused: {}\n", pairs.join(", "));
        }
        text + &classifier.map_or(String::new(), based_on)
    }

    fn csv(&self) -> Option<String> {
        let labels = &self.0.labels;
        Some(matrix_csv(labels, labels, self.0.confusion.rows()))
    }

    fn json(&self) -> String {
        json::ascii(&evaluation::record(self.0, self.2)) + "\n"
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

/// The features that a classifier used, those that it left out because they have only one value or copy another one,
/// and what it drew. Templates have no features: they compare imprints.
fn based_on(reached: &ClassifierEvaluation) -> String {
    let mut text = String::new();
    if reached.classifier != Classifier::Template {
        text += &format!("features: {}\n", reached.features.join(", "));
    }
    for (name, reason) in &reached.dropped {
        text += &format!("left out: {name}, {reason}\n");
    }
    if let Some((poses, seed)) = reached.sample {
        let (name, poses) = (reached.classifier.name(), grouped(poses as u64));
        text += &format!("{name} draws {poses} poses of each shape, with seed {seed}\n");
    }
    text
}
