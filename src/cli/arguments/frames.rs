//! The arguments of `taxel frames` and `taxel watch`.
//!
//! Flags about processing are applied to frames in this order:
//! ```text
//! --frame N | --label L | --peak | --all             which frames; none of them: a listing
//! --crop --flip --turn --mask --tare --gain          from the recording's values to those that count
//! --at-least | --percent | --low --high | --deviations   from values to active taxels; --least drops small pieces
//! ```
//! Only one rule can be given. Values are in the recording's own unit.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgGroup, ArgMatches, Args, Command, FromArgMatches, value_parser};
use taxel_core::frame::{Crop, FrameError, FrameSize, Label, Rule, RuleOrigin, SetRule, View};
use taxel_core::parameter::{Parameter, number};
use taxel_files::acquire::{AcquireOptions, Playback};
use taxel_files::formats::recording::{Column, Format, ReadOptions, TimeColumn};
use taxel_files::storage::Existing;

use crate::cli::arguments::flags::{
    self, json, name_or_path, of_sensor, option, parse_number, required, switch, whole,
};
use crate::cli::arguments::help::{FRAMES_EXAMPLES, WATCH_EXAMPLES};
use crate::cli::commands::export::KeepFlags;
use crate::cli::commands::recognise::NamingFlags;
use crate::cli::commands::screen::Look;
use crate::cli::error::CliError;
use crate::cli::settings::sensors::{LEAST, SensorSettings};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum FrameChoice {
    /// The frame of this number, from 0.
    Number(u64),
    Label(Label),
    Peak,
    All,
    NoiseReport,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct ProcessingArguments {
    pub(crate) size: Option<FrameSize>,
    pub(crate) time_column: Option<TimeColumn>,
    pub(crate) label_column: Option<Column>,
    pub(crate) channel: Option<String>,
    pub(crate) view: View,
    /// The file with an imprint of the cells without a value, placed as the frame is seen after the turn.
    pub(crate) mask: Option<PathBuf>,
    /// The number of frames for the tare; 0 for no tare, None for that of the recording.
    pub(crate) tare: Option<u64>,
    pub(crate) tare_from: RuleOrigin,
    /// A recording of one frame: the factors that cells are multiplied by after the tare.
    pub(crate) gain: Option<PathBuf>,
    /// The threshold; None for that of the recording.
    pub(crate) rule: Option<Rule>,
    pub(crate) rule_from: RuleOrigin,
    pub(crate) least: u32,
}

#[derive(Clone, Debug)]
pub(crate) struct FramesArguments {
    pub(crate) file: PathBuf,
    /// The frames to answer; None lists all channels.
    pub(crate) choice: Option<FrameChoice>,
    pub(crate) processing: ProcessingArguments,
    pub(crate) heat: bool,
    /// Whether frames are a table; all frames of all channels without a choice.
    pub(crate) csv: bool,
    pub(crate) naming: NamingFlags,
}

pub(crate) fn command() -> Command {
    let file = Arg::new("file")
        .value_name("FILE")
        .required(true)
        .value_parser(value_parser!(PathBuf))
        .help("Recording; '-' for standard input");
    let frame =
        option("frame", "N", "Frame N of the channel, from 0").value_parser(whole::<u64>(0..));
    let label = option("label", "L", "The frame with the label L in the recording")
        .allow_hyphen_values(true)
        .value_parser(value_parser!(Label));
    let peak = switch(
        "peak",
        "The frame with the greatest sum, after tare and gain",
    );
    let every = switch("all", "All frames, one after the other");
    let flips = switch(
        "noise-report",
        "How often taxels flip, and which are dead or stuck",
    );
    let choices = ["frame", "label", "peak", "all", "noise-report"];
    let command = Command::new("frames")
        .about("List a recording of a real sensor, or describe its frames")
        .after_help(FRAMES_EXAMPLES)
        .arg(file)
        .args([frame, label, peak, every, flips].map(|arg| arg.help_heading("Frames")))
        .group(ArgGroup::new("choice").args(choices))
        .group(
            ArgGroup::new("answered")
                .args(choices)
                .arg("csv")
                .multiple(true),
        )
        .args(processing().map(|arg| match arg.get_id().as_str() {
            // A listing shows values as they are, wherever they lie.
            "tare" | "gain" | "flip" | "turn" => arg.requires("answered"),
            _ => arg,
        }))
        .args(rules().map(|arg| arg.requires("answered")))
        .args(
            naming()
                .into_iter()
                .map(|arg| arg.requires("choice").conflicts_with("noise-report")),
        )
        .args(
            of_sensor(&[Parameter::Pitch])
                .into_iter()
                .map(|arg| arg.requires("choice").conflicts_with("noise-report")),
        )
        .args([json().conflicts_with_all(["heat", "csv"]), csv(), heat()]);
    keeping(command)
}

/// Defines `--csv`, which has a line for each frame and no place for other answers.
fn csv() -> Arg {
    let help = "Print CSV, one line per frame: force, contact,\ncentre of pressure, descriptors";
    let others = ["noise-report", "heat", "model", "save", "export"];
    switch("csv", help).conflicts_with_all(others)
}

/// Defines `--heat`, which shows values. It excludes `--json`, which has no place for values, and a report on many
/// frames.
fn heat() -> Arg {
    switch("heat", "Show the values as shades, also in drawings")
        .requires("choice")
        .conflicts_with("noise-report")
}

/// Defines the flags that keep frames. With `--export`, each frame gets its own file. `--save` stores a single
/// shape, so it excludes `--all`, and fails for a label that several frames have.
fn keeping(command: Command) -> Command {
    KeepFlags::augment_args(command)
        .mut_arg("save", |arg| {
            arg.requires("choice").conflicts_with_all(["all", "noise-report"])
        })
        .mut_arg("export", |arg| {
            arg.requires("choice").help(
                "Write the imprint, or a drawing of it, with the frame's number in the name, such as touch-0.svg for \
                 touch.svg; with --noise-report the mask",
            )
        })
        .mut_arg("force", |arg| {
            arg.help("Replace existing shapes and files, but never the recording")
        })
}

/// Defines the flags that prepare frames. `--rows` and `--columns` have ids of their own: they are not those of a
/// sensor, and go further.
pub(crate) fn processing() -> [Arg; 11] {
    let side = |id: &'static str, flag: &'static str, title: &str| {
        Arg::new(id)
            .long(flag)
            .value_name(flag.to_ascii_uppercase())
            .value_parser(whole::<u16>(FrameSize::SIDES))
            .help(format!("{title}, if the recording does not state them"))
    };
    [
        side("frame_columns", "columns", "Columns").requires("frame_rows"),
        side("frame_rows", "rows", "Rows").requires("frame_columns"),
        option(
            "time-column",
            "X[:UNIT]",
            "Column with the time: its name, or its number\nfrom 1; UNIT is s, ms, us or ns",
        )
        .value_parser(str::parse::<TimeColumn>),
        option(
            "label-column",
            "X",
            "Column with the label: its name, or its number\nfrom 1",
        )
        .value_parser(str::parse::<Column>),
        option(
            "channel",
            "NAME",
            "The channel to read, if there are several",
        ),
        option(
            "crop",
            "C,R,COLSxROWS",
            "Keep a part: COLS x ROWS cells from column C,\nrow R on, counted from 0",
        )
        .value_parser(parse_crop)
        // A negative column is then refused by the parser, not taken for a flag.
        .allow_hyphen_values(true),
        option("flip", "AXIS", "Reverse columns (x), rows (y) or both (xy)")
            .value_parser(["x", "y", "xy"])
            .hide_possible_values(true),
        option(
            "turn",
            "DEGREES",
            "Turn clockwise by 90, 180 or 270 degrees",
        )
        .value_parser(["90", "180", "270"])
        .hide_possible_values(true),
        option(
            "mask",
            "FILE",
            "Imprint whose active taxels are dead cells;\nthese get no value",
        )
        .value_parser(value_parser!(PathBuf)),
        option(
            "tare",
            "N",
            "Subtract the median of each cell over the first\nN frames",
        )
        .value_parser(whole::<u64>(0..)),
        option("gain", "FILE", "Table of factors, one for each cell")
            .value_parser(value_parser!(PathBuf)),
    ]
    .map(|arg| arg.help_heading("Processing"))
}

pub(crate) fn naming() -> Vec<Arg> {
    let naming = NamingFlags::augment_args(Command::new(""));
    naming.get_arguments().cloned().collect()
}

/// Defines the flags that decide which values are active. `--high` is not a rule by itself: it goes with `--low`.
/// `--deviations` needs a tare, whose frames show the noise of each cell.
pub(crate) fn rules() -> [Arg; 6] {
    let value = |flag: &'static str, value: &'static str, help: &'static str| {
        option(flag, value, help)
            .allow_hyphen_values(true)
            .value_parser(parse_number)
    };
    let others = |own: &'static str| {
        ["at-least", "percent", "low", "deviations"]
            .into_iter()
            .filter(move |other| *other != own)
    };
    let least = option("least", "K", "Drop pieces of fewer than K taxels")
        .alias("min-taxels")
        .value_parser(whole::<u32>(LEAST));
    [
        value(
            "at-least",
            "T",
            "Active at T or more, in the recording's unit",
        )
        .conflicts_with_all(others("at-least")),
        value(
            "percent",
            "P",
            "Active at P percent of the largest value or more",
        )
        .conflicts_with_all(others("percent")),
        value(
            "low",
            "A",
            "Active at A or more if connected to a cell of B\nor more",
        )
        .requires("high")
        .conflicts_with_all(others("low")),
        // clap would let --low be missing if another rule excludes it.
        value("high", "B", "Active at B or more")
            .requires("low")
            .conflicts_with_all(others("low")),
        value(
            "deviations",
            "K",
            "Active at K standard deviations of the cell's noise\nor more; needs a tare",
        )
        .requires("tare")
        .conflicts_with_all(others("deviations")),
        least,
    ]
    .map(|arg| arg.help_heading("Threshold"))
}

/// Parses `12,12,16x16`: the left column and the top row, from 0, then columns × rows. Whether it fits the frames is
/// checked later.
fn parse_crop(text: &str) -> Result<Crop, &'static str> {
    let parts = || {
        let (left, rest) = text.split_once(',')?;
        let (top, size) = rest.split_once(',')?;
        let (columns, rows) = size.split_once(['x', '×'])?;
        let number = |text: &str| text.trim().parse::<u16>().ok();
        Some(Crop {
            left: number(left)?,
            top: number(top)?,
            columns: number(columns).filter(|&columns| columns > 0)?,
            rows: number(rows).filter(|&rows| rows > 0)?,
        })
    };
    parts().ok_or("expected the first column and row, then columns x rows, as in 12,12,16x16")
}

impl FramesArguments {
    pub(crate) fn of(matches: &ArgMatches, settings: &SensorSettings) -> Result<Self, CliError> {
        let file = required(matches, "file")?;
        let choice = match (matches.get_one("frame"), matches.get_one("label")) {
            (Some(&number), _) => Some(FrameChoice::Number(number)),
            (_, Some(label)) => Some(FrameChoice::Label(Label::clone(label))),
            _ if matches.get_flag("peak") => Some(FrameChoice::Peak),
            _ if matches.get_flag("all") => Some(FrameChoice::All),
            _ if matches.get_flag("noise-report") => Some(FrameChoice::NoiseReport),
            _ => None,
        };
        Ok(Self {
            file,
            choice,
            processing: ProcessingArguments::of(matches, settings)?,
            heat: matches.get_flag("heat"),
            csv: matches.get_flag("csv"),
            naming: NamingFlags::from_arg_matches(matches)?,
        })
    }
}

impl ProcessingArguments {
    pub(crate) fn of(matches: &ArgMatches, settings: &SensorSettings) -> Result<Self, CliError> {
        let asked = rule(matches)?;
        let rule_from = if asked.is_some() {
            RuleOrigin::Flag
        } else {
            RuleOrigin::Settings
        };
        let side = |id| matches.get_one::<u16>(id).copied();
        let flip = matches.get_one::<String>("flip");
        let flips = |axis: char| flip.is_some_and(|flip| flip.contains(axis));
        let turn = matches.get_one::<String>("turn").map(String::as_str);
        let path = |id| matches.get_one::<PathBuf>(id).cloned();
        let tare = matches.get_one("tare").copied();
        Ok(Self {
            size: FrameSize::of_sides(side("frame_columns"), side("frame_rows")),
            time_column: matches.get_one("time-column").cloned(),
            label_column: matches.get_one("label-column").cloned(),
            channel: matches.get_one::<String>("channel").cloned(),
            view: View {
                crop: matches.get_one("crop").copied(),
                flip_x: flips('x'),
                flip_y: flips('y'),
                quarter_turns: match turn {
                    Some("90") => 1,
                    Some("180") => 2,
                    Some("270") => 3,
                    _ => 0,
                },
                mask: None,
            },
            mask: path("mask"),
            tare: tare.or(settings.tare()),
            tare_from: tare.map_or(RuleOrigin::Settings, |_| RuleOrigin::Flag),
            gain: path("gain"),
            rule: asked.or_else(|| settings.rule()),
            rule_from,
            least: (matches.get_one("least").copied())
                .or(settings.least())
                .unwrap_or_default(),
        })
    }
}

impl ProcessingArguments {
    /// How the recording is read.
    pub(crate) fn reading(&self) -> ReadOptions {
        ReadOptions {
            size: self.size,
            time_column: self.time_column.clone(),
            label_column: self.label_column.clone(),
            ..ReadOptions::default()
        }
    }

    pub(crate) fn set_rule(&self) -> Option<SetRule> {
        let (least, from) = (self.least, self.rule_from);
        self.rule.map(|rule| SetRule { rule, least, from })
    }

    /// Returns the message about a tare that cannot be made. If frames are lacking for a tare of the settings, it
    /// names the settings.
    pub(crate) fn tare_refused(&self, error: &FrameError) -> String {
        match (error, self.tare_from) {
            (FrameError::Tare { .. }, RuleOrigin::Settings) => {
                format!("{error} (tare under [frames] in the settings; --tare 0 turns it off)")
            }
            _ => error.to_string(),
        }
    }
}

fn rule(matches: &ArgMatches) -> Result<Option<Rule>, CliError> {
    let value = |id: &str| matches.get_one::<f64>(id).copied();
    let out_of_range = |flag: &str, value: f64| {
        let (flag, text) = (flag.to_owned(), number::short(value));
        move |error: FrameError| {
            let complaint = match error {
                FrameError::Rule { allowed, .. } => {
                    format!("is out of range (allowed: {allowed})")
                }
                FrameError::Order { high, .. } => {
                    format!("is above --high {}", number::short(high))
                }
                error => format!("is not allowed: {error}"),
            };
            CliError::Range {
                flag,
                text,
                complaint,
            }
        }
    };
    let made = |flag: &str, make: fn(f64) -> Result<Rule, FrameError>| {
        value(flag).map(|value| make(value).map_err(out_of_range(flag, value)))
    };
    if let Some((low, high)) = value("low").zip(value("high")) {
        return Rule::hysteresis(low, high).map(Some).map_err(|error| {
            let is_high = matches!(error, FrameError::Rule { what: "high", .. });
            let (flag, value) = if is_high {
                ("high", high)
            } else {
                ("low", low)
            };
            out_of_range(flag, value)(error)
        });
    }
    made("at-least", Rule::at_least)
        .or_else(|| made("percent", Rule::percent))
        .or_else(|| made("deviations", Rule::noise))
        .transpose()
}

#[derive(Clone, Debug)]
pub(crate) struct WatchArguments {
    /// A serial line, a FIFO, `tcp://HOST:PORT`, a recording, or `-` for standard input; which one is decided when it
    /// is opened.
    pub(crate) source: OsString,
    pub(crate) options: AcquireOptions,
    pub(crate) baud_named: bool,
    pub(crate) processing: ProcessingArguments,
    pub(crate) naming: NamingFlags,
    pub(crate) write: Option<PathBuf>,
    pub(crate) existing: Existing,
    /// The memory for the history of the page, in bytes.
    pub(crate) history_bytes: usize,
    /// Whether to print a line of JSON for each frame, even on a terminal.
    pub(crate) json: bool,
}

pub(crate) fn watch() -> Command {
    let source = Arg::new("source")
        .value_name("SOURCE")
        .required(true)
        .value_parser(name_or_path())
        .help("Serial line, FIFO, tcp://HOST:PORT, recording or file; '-' for\nstandard input");
    let names: Vec<&str> = Format::of_streams().map(|(name, _)| name).collect();
    let what = format!("Format of the stream: auto, {}", names.join(", "));
    let format = option("format", "FORMAT", flags::wrapped(&what, 52))
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
        .args(processing())
        .args(rules())
        .args(naming())
        .args([write, flags::replace().requires("write"), json()])
        .args(look().into_iter().map(|arg| arg.conflicts_with("json")))
}

fn parse_speed(text: &str) -> Result<f64, String> {
    let speed = parse_number(text)?;
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
            options.format = Format::of_stream(name).ok();
            options.stream_format = None;
        }
        options.size = processing.size;
        options.time_column.clone_from(&processing.time_column);
        options.label_column.clone_from(&processing.label_column);
        options.channel.clone_from(&processing.channel);
        options.baud = matches.get_one("baud").copied().or(options.baud);
        options.playback = playback(matches);
        Ok(Self {
            source,
            options,
            baud_named: matches.contains_id("baud"),
            processing,
            naming: NamingFlags::from_arg_matches(matches)?,
            write: matches.get_one::<PathBuf>("write").cloned(),
            existing: flags::existing(matches),
            history_bytes: settings.history_bytes(),
            json: matches.get_flag("json"),
        })
    }
}

fn look() -> Vec<Arg> {
    let look = Look::augment_args(Command::new(""));
    look.get_arguments().cloned().collect()
}
