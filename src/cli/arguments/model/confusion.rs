//! The flags of `taxel model confusion`, and how they are read.
//!
//! The command answers one of several questions ([`Evaluated`]) about a model:
//! ```text
//! taxel model confusion figures                        from the whole imprint: the limit of any method
//! taxel model confusion figures --given na,p           as if only these descriptors were known
//! taxel model confusion figures --greedy | --pairs     which descriptors; which two shapes
//! taxel model confusion figures --classifier knn       by another method
//! taxel model confusion figures --noise 0:0.1:0.02     from touches whose taxels flip; with --given from descriptors
//! ```

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Command};

use crate::cli::arguments::flags::{
    self, EvaluationForm, json, number_of, option, parse_range, quiet, replace, report, seed,
    switch, which_model, whole,
};
use crate::cli::arguments::help::MODEL_CONFUSION_EXAMPLES;
use crate::cli::error::CliError;
use crate::formats::file::has_ending;
use crate::index::wide;
use crate::pose::DecimalRange;
use crate::recognition::{Classifier, ClassifierSettings, GivenDescriptors, Noise, Rounding};
use crate::sensor::MatrixSize;
use crate::storage::Existing;

#[derive(Clone, Debug)]
pub(crate) struct ConfusionArguments {
    pub(crate) model: OsString,
    pub(crate) of: Evaluated,
    pub(crate) roundings: Vec<Rounding>,
    pub(crate) classifiers: ClassifierSettings,
    pub(crate) form: EvaluationForm,
    pub(crate) export: Option<PathBuf>,
    pub(crate) existing: Existing,
    pub(crate) quiet: bool,
}

#[derive(Clone, Debug)]
pub(crate) enum Evaluated {
    Imprints,
    Given(GivenDescriptors),
    Greedy,
    Pairs,
    Classifier(Classifier),
    AllClassifiers,
    Noise(NoiseArguments),
}

#[derive(Clone, Debug)]
pub(crate) struct NoiseArguments {
    pub(crate) noise: DecimalRange,
    pub(crate) dead: Vec<u32>,
    /// The descriptors that are known in place of the imprint.
    pub(crate) given: Option<GivenDescriptors>,
    pub(crate) touches: u64,
    pub(crate) seed: u64,
    /// Columns and rows of the matrix; None for those of the model's sensor.
    pub(crate) size: Option<MatrixSize>,
}

pub(super) fn command() -> Command {
    Command::new("confusion")
        .about("Show which shapes one touch confuses, and the limit of any method")
        .after_help(MODEL_CONFUSION_EXAMPLES)
        .arg(which_model())
        .args(questions())
        .group(ArgGroup::new("descriptors").args(["given", "greedy"]))
        .group(ArgGroup::new("of").args(["greedy", "pairs", "classifier", "noise"]))
        .groups([
            flags::alone("with_classifier", "classifier"),
            flags::alone("with_noise", "noise"),
            flags::alone("with_export", "export"),
        ])
        .group(
            ArgGroup::new("not_given")
                .args(["greedy", "pairs"])
                .conflicts_with("given"),
        )
        .arg(
            option(
                "round",
                "KEY=STEP",
                "Round a descriptor to steps, such as cg_cd=0.01",
            )
            .action(ArgAction::Append)
            .value_parser(str::parse::<Rounding>)
            .requires("descriptors")
            .conflicts_with("classifier"),
        )
        .args(of_classifiers())
        .arg(seed())
        .args(output())
        .args(noisy())
}

fn questions() -> [Arg; 4] {
    let classifiers = Classifier::ALL.iter().map(|own| own.name()).chain(["all"]);
    [
        option(
            "given",
            "KEY,...",
            "Use only these descriptors, such as na,p",
        )
        .value_parser(str::parse::<GivenDescriptors>),
        switch("greedy", "Choose descriptors one by one until none helps"),
        switch(
            "pairs",
            "Print the error for each pair of shapes, by itself",
        ),
        option(
            "classifier",
            "NAME",
            "Another way to name shapes: z, knn, template, or\nall of them in a table",
        )
        .value_parser(PossibleValuesParser::new(classifiers))
        .hide_possible_values(true),
    ]
}

fn of_classifiers() -> [Arg; 3] {
    [
        ("neighbours", "Neighbours that vote in knn; default 1"),
        ("sample", "Poses of each shape that knn draws; default 2000"),
        (
            "templates",
            "Imprints of each shape for template; default 100",
        ),
    ]
    .map(|(name, help)| {
        option(name, "N", help)
            .value_parser(whole::<u32>(1..))
            .requires("with_classifier")
    })
}

fn output() -> [Arg; 5] {
    let export = option("export", "FILE", "Write the matrix as .csv or .svg")
        .value_parser(report())
        .conflicts_with_all(["greedy", "pairs"]);
    let csv = switch("csv", "Print comma-separated values")
        .conflicts_with_all(["json", "greedy", "pairs"]);
    let force = replace().requires("with_export");
    [export, force, json(), quiet(), csv]
}

fn noisy() -> [Arg; 4] {
    let noise = option(
        "noise",
        "START:END:STEP",
        "Test touches whose taxels flip with this\nprobability",
    )
    .value_parser(parse_noise_range);
    let dead = option(
        "dead",
        "N,...",
        "Also test with N dead taxels, drawn anew for\neach touch; default 0",
    )
    .value_delimiter(',')
    .value_parser(whole::<u32>(0..=4095));
    let touches = option("touches", "N", "Noisy touches of each shape; default 1000")
        .value_parser(whole::<u64>(1..=1_000_000_000));
    let matrix = option(
        "matrix",
        "CxR",
        "Columns and rows of the sensor for noisy\ntouches; default those of the model",
    )
    .value_parser(parse_matrix);
    let [dead, touches, matrix] = [dead, touches, matrix].map(|arg| arg.requires("with_noise"));
    [noise, dead, touches, matrix].map(|arg| arg.help_heading("Noise"))
}

/// Parses probabilities that a taxel flips, such as `0:0.1:0.02`. Both ends must be valid for [`Noise::new`].
fn parse_noise_range(text: &str) -> Result<DecimalRange, String> {
    let range = parse_range(text)?;
    for value in [range.value(0), range.last()] {
        Noise::new(value).map_err(|error| error.to_string())?;
    }
    Ok(range)
}

fn parse_matrix(text: &str) -> Result<MatrixSize, &'static str> {
    let expected = "expected columns and rows from 1 to 64, such as 16x16";
    let (columns, rows) = text.split_once('x').ok_or(expected)?;
    let side = |text: &str| text.trim().parse().map_err(|_| expected);
    MatrixSize::new(side(columns)?, side(rows)?).map_err(|_| expected)
}

impl ConfusionArguments {
    pub(super) fn of(matches: &ArgMatches) -> Result<Self, CliError> {
        check_classifier(matches)?;
        check_roundings(matches)?;
        let roundings = matches.get_many::<Rounding>("round").into_iter().flatten();
        let (of, export) = (Evaluated::of(matches), matches.get_one::<PathBuf>("export"));
        if let (Evaluated::AllClassifiers, Some(path)) = (&of, export)
            && !has_ending(path, "csv")
        {
            return Err(CliError::Ending {
                name: path.to_string_lossy().into_owned(),
                what: "the table of all classifiers",
                expected: ".csv",
            });
        }
        Ok(Self {
            model: flags::word(matches, "model"),
            of,
            roundings: roundings.copied().collect(),
            classifiers: classifiers(matches),
            form: EvaluationForm::of(matches),
            export: export.cloned(),
            existing: flags::existing(matches),
            quiet: matches.get_flag("quiet"),
        })
    }
}

fn check_classifier(matches: &ArgMatches) -> Result<(), CliError> {
    let name = matches.get_one::<String>("classifier").map(String::as_str);
    let is = |one: &str| name.is_some_and(|name| name == one || name == "all");
    let is_drawn = is("knn") || matches.contains_id("noise");
    let given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
    let unused = |flag, reason: String| Err(CliError::Unused { flag, reason });
    for (flag, has_effect) in [
        ("neighbours", is("knn")),
        ("sample", is("knn")),
        ("templates", is("template")),
        ("given", name != Some("template")),
    ] {
        if let Some(name) = name.filter(|_| given(flag) && !has_effect) {
            return unused(flag, format!("with --classifier {name}"));
        }
    }
    if given("seed") && !is_drawn {
        let reason = "without --noise or --classifier knn, which draw touches".to_owned();
        return unused("seed", reason);
    }
    Ok(())
}

fn check_roundings(matches: &ArgMatches) -> Result<(), CliError> {
    let roundings = matches.get_many::<Rounding>("round").into_iter().flatten();
    let keys: Vec<_> = roundings.map(Rounding::descriptor).collect();
    let given = matches.get_one::<GivenDescriptors>("given");
    for (index, key) in keys.iter().enumerate() {
        let name = key.key();
        let reason = if keys[..index].contains(key) {
            format!("for {name}, which has a step already")
        } else if given.is_some_and(|given| !given.descriptors().contains(key)) {
            format!("for {name}, which --given does not name")
        } else {
            continue;
        };
        let flag = "round";
        return Err(CliError::Unused { flag, reason });
    }
    Ok(())
}

impl Evaluated {
    /// Returns the question of the flags; without one, it is about whole imprints. clap makes sure that there is at
    /// most one.
    fn of(matches: &ArgMatches) -> Self {
        if let Some(name) = matches.get_one::<String>("classifier") {
            return name.parse().map_or(Self::AllClassifiers, Self::Classifier);
        }
        if let Some(&noise) = matches.get_one::<DecimalRange>("noise") {
            return Self::Noise(NoiseArguments::of(matches, noise));
        }
        if let Some(given) = matches.get_one::<GivenDescriptors>("given") {
            return Self::Given(given.clone());
        }
        match (matches.get_flag("greedy"), matches.get_flag("pairs")) {
            (true, _) => Self::Greedy,
            (false, true) => Self::Pairs,
            (false, false) => Self::Imprints,
        }
    }
}

impl NoiseArguments {
    fn of(matches: &ArgMatches, noise: DecimalRange) -> Self {
        let dead = matches.get_many::<u32>("dead");
        Self {
            noise,
            dead: dead.map_or_else(|| vec![0], |dead| dead.copied().collect()),
            given: matches.get_one("given").cloned(),
            touches: number_of(matches, "touches", 1000),
            seed: number_of(matches, "seed", 0),
            size: matches.get_one("matrix").copied(),
        }
    }
}

fn classifiers(matches: &ArgMatches) -> ClassifierSettings {
    let mut classifiers = ClassifierSettings::default();
    let limit = |id: &str, usual: usize| {
        let own = matches.get_one::<u32>(id);
        own.map_or(usual, |&number| wide(number))
    };
    classifiers.neighbours = limit("neighbours", classifiers.neighbours);
    classifiers.sample = limit("sample", classifiers.sample);
    classifiers.templates = limit("templates", classifiers.templates);
    classifiers.seed = number_of(matches, "seed", classifiers.seed);
    let given = matches.get_one::<GivenDescriptors>("given");
    classifiers.descriptors = given.map(|given| given.descriptors().to_vec());
    classifiers
}
