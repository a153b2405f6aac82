//! The flags of `taxel model touches`, and how they are read.

use std::ffi::OsString;

use clap::{ArgMatches, Command};

use crate::cli::arguments::flags::{
    self, json, number_of, option, parse_probability, quiet, seed, which_model, whole,
};
use crate::cli::arguments::help::MODEL_TOUCHES_EXAMPLES;

#[derive(Clone, Debug)]
pub(crate) struct TouchesArguments {
    pub(crate) model: OsString,
    pub(crate) until: f64,
    pub(crate) runs: u64,
    pub(crate) seed: u64,
    pub(crate) json: bool,
    pub(crate) quiet: bool,
}

pub(super) fn command() -> Command {
    let until = option(
        "until",
        "P",
        "How probable one shape must be (0 to 1); default 0.99",
    )
    .value_parser(parse_probability)
    .default_value("0.99")
    .hide_default_value(true);
    // The length of each run is kept until the mean is known: up to 120 MB.
    let runs = option("runs", "N", "Runs of each shape; default 10000")
        .value_parser(whole::<u64>(1..=10_000_000))
        .default_value("10000")
        .hide_default_value(true);
    Command::new("touches")
        .about("Simulate how many touches it takes to name a shape")
        .after_help(MODEL_TOUCHES_EXAMPLES)
        .args([which_model(), until, runs, seed(), json(), quiet()])
}

impl TouchesArguments {
    pub(super) fn of(matches: &ArgMatches) -> Self {
        Self {
            model: flags::word(matches, "model"),
            until: number_of(matches, "until", 0.99),
            runs: number_of(matches, "runs", 10_000),
            seed: number_of(matches, "seed", 0),
            json: matches.get_flag("json"),
            quiet: matches.get_flag("quiet"),
        }
    }
}
