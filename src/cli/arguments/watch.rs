//! The arguments of `taxel watch`.
//!
//! They are the flags of `taxel frames` about processing and thresholds, and those of the source:
//! ```text
//! taxel watch /dev/ttyACM0 --baud 921600 --at-least 20     a serial line
//! taxel watch tcp://10.0.0.7:5000 --format lines           a connection
//! taxel watch grip.npy --speed 0.5 --loop                  a recording, played at its own rate
//! ```

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgMatches, Command};

use crate::acquire::{AcquireOptions, Playback};
use crate::cli::arguments::flags::{self, option, required, switch, whole};
use crate::cli::arguments::frames::{self, NamingArguments, ProcessingArguments};
use crate::cli::arguments::help::WATCH_EXAMPLES;
use crate::cli::arguments::{parameters, program};
use crate::cli::error::CliError;
use crate::cli::settings::sensors::SensorSettings;
use crate::formats::stream::StreamFormat;
use crate::storage::Existing;

#[derive(Clone, Debug)]
pub(crate) struct WatchArguments {
    /// A serial line, a FIFO, `tcp://HOST:PORT`, a recording, or `-` for standard input; which one is decided when it
    /// is opened.
    pub(crate) source: OsString,
    pub(crate) options: AcquireOptions,
    pub(crate) baud_named: bool,
    pub(crate) processing: ProcessingArguments,
    pub(crate) naming: NamingArguments,
    pub(crate) write: Option<PathBuf>,
    pub(crate) existing: Existing,
    /// The memory for the history of the page, in bytes.
    pub(crate) history_bytes: usize,
    /// Whether to print a line of JSON for each frame, even on a terminal.
    pub(crate) json: bool,
}

pub(crate) fn command() -> Command {
    let source = Arg::new("source")
        .value_name("SOURCE")
        .required(true)
        .value_parser(flags::name_or_path())
        .help("Serial line, FIFO, tcp://HOST:PORT, recording or file; '-' for\nstandard input");
    let names: Vec<&str> = StreamFormat::ALL.iter().map(|own| own.name()).collect();
    let what = format!("Format of the stream: auto, {}", names.join(", "));
    let format = option("format", "FORMAT", parameters::wrapped(&what, 52))
        .value_parser(PossibleValuesParser::new(
            std::iter::once("auto").chain(names),
        ))
        .hide_possible_values(true);
    let baud = option("baud", "BAUD", "Speed of a serial line; default 115200")
        .value_parser(whole::<u32>(AcquireOptions::BAUDS));
    let once = switch("once", "Read to the end as fast as possible, then stop")
        .conflicts_with_all(["loop", "speed"]);
    let again = switch("loop", "Start a recording again when it ends");
    let speed = option(
        "speed",
        "FACTOR",
        "Play a recording at FACTOR times its speed",
    )
    .value_parser(parse_speed);
    let write = option(
        "write",
        "FILE.npy",
        "Record all frames, for numpy and 'taxel frames'",
    )
    .value_parser(flags::npy());
    Command::new("watch")
        .about("Show or describe the frames of a sensor, live or played back")
        .after_help(WATCH_EXAMPLES)
        .arg(source)
        .args([format, baud, once, again, speed].map(|arg| arg.help_heading("Source")))
        .args(frames::processing())
        .args(frames::rules())
        .args(frames::naming())
        .args([write, flags::replace().requires("write"), flags::json()])
        .args(program::look().map(|arg| arg.conflicts_with("json")))
}

fn parse_speed(text: &str) -> Result<f64, String> {
    let speed = flags::parse_number(text)?;
    let allowed = Playback::allows(speed).then_some(speed);
    allowed.ok_or_else(|| format!("expected {}", Playback::SPEEDS))
}

fn playback(matches: &ArgMatches) -> Playback {
    if matches.get_flag("once") {
        return Playback::Once;
    }
    let speed = matches.get_one("speed").copied().unwrap_or(1.0);
    Playback::paced(speed, matches.get_flag("loop"))
}

impl WatchArguments {
    pub(crate) fn of(matches: &ArgMatches, settings: &SensorSettings) -> Result<Self, CliError> {
        let source = required(matches, "source")?;
        let processing = ProcessingArguments::of(matches, settings)?;
        let format = matches.get_one::<String>("format");
        let mut options = AcquireOptions::default();
        settings.apply(&mut options);
        if let Some(name) = format {
            options.format = name.parse().ok();
            options.stream_format = None;
        }
        options.size = processing.size;
        options.channel.clone_from(&processing.channel);
        options.baud = matches.get_one("baud").copied().unwrap_or(options.baud);
        options.playback = playback(matches);
        Ok(Self {
            source,
            options,
            baud_named: matches.contains_id("baud"),
            processing,
            naming: NamingArguments::of(matches),
            write: matches.get_one::<PathBuf>("write").cloned(),
            existing: flags::existing(matches),
            history_bytes: settings.history_bytes(),
            json: matches.get_flag("json"),
        })
    }
}
