//! The flags of `taxel recognise NAME|FILE`.

use std::ffi::OsString;

use clap::{ArgMatches, Command};
use taxel_core::index::wide;
use taxel_core::parameter::Parameter;
use taxel_core::recognition::{Noise, NoiseError};

use crate::cli::arguments::flags::{
    self, jobs, json, of_sensor, option, parse_probability, switch, what, whole,
};
use crate::cli::arguments::help::RECOGNISE_EXAMPLES;
use crate::cli::arguments::model::DEFAULT_MODEL;

#[derive(Clone, Debug)]
pub(crate) struct RecogniseArguments {
    pub(crate) what: OsString,
    pub(crate) model: OsString,
    /// The number of shapes of the ranking to show; None for eight in text and all in JSON.
    pub(crate) top: Option<usize>,
    pub(crate) reject: Option<f64>,
    pub(crate) expect: Option<String>,
    pub(crate) noise: Option<Noise>,
    pub(crate) mask: Option<OsString>,
    pub(crate) pose: bool,
    /// The pitch in mm; if given, the place of the shape is in mm too.
    pub(crate) pitch_mm: Option<f64>,
    pub(crate) jobs: usize,
    pub(crate) json: bool,
}

pub(super) fn command() -> Command {
    let model = option(
        "model",
        "MODEL",
        "Name or file of a model; built in are figures\n(default), figures-30 and shapes",
    )
    .value_parser(flags::name_or_path())
    .default_value(DEFAULT_MODEL)
    .hide_default_value(true);
    let top =
        option("top", "K", "Show only the K likeliest shapes").value_parser(whole::<u32>(1..));
    let reject = option(
        "reject",
        "P",
        "Reject answers less probable than P (0 to 1)",
    )
    .value_parser(parse_probability);
    let expect = option(
        "expect",
        "NAME",
        "Exit with status 3 if this is not the answer",
    );
    let noise = option(
        "noise",
        "E",
        "Each taxel flips with this probability (below 0.5)",
    )
    .value_parser(parse_noise);
    let mask = option(
        "mask",
        "NAME|FILE",
        "Imprint whose active taxels are dead, stuck on or\noff; needs --noise",
    )
    .value_parser(flags::name_or_path())
    .requires("noise");
    let pose = switch("pose", "Say where the shape lies and how it is turned");
    Command::new("recognise")
        .alias("recognize")
        .about("Name the shape that left an imprint")
        .after_help(RECOGNISE_EXAMPLES)
        .arg(what(
            "Imprint: shape of the library, or file; '-' for standard input",
        ))
        .args([model, top, reject, expect, noise, mask, pose])
        .args(
            of_sensor(&[Parameter::Pitch])
                .into_iter()
                .map(|arg| arg.requires("pose")),
        )
        .args([jobs(), json()])
}

pub(crate) fn parse_noise(text: &str) -> Result<Noise, String> {
    let number = flags::parse_number(text)?;
    Noise::new(number).map_err(|error: NoiseError| error.expected().to_owned())
}

impl RecogniseArguments {
    pub(super) fn of(matches: &ArgMatches, pitch_mm: Option<f64>) -> Self {
        Self {
            what: flags::word(matches, "what"),
            model: flags::word(matches, "model"),
            top: matches.get_one::<u32>("top").map(|&top| wide(top)),
            reject: matches.get_one("reject").copied(),
            expect: matches.get_one::<String>("expect").cloned(),
            noise: matches.get_one::<Noise>("noise").copied(),
            mask: matches.get_one::<OsString>("mask").cloned(),
            pose: matches.get_flag("pose"),
            pitch_mm,
            jobs: flags::jobs_of(matches),
            json: matches.get_flag("json"),
        }
    }
}
