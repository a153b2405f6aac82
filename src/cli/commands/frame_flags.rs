//! The flags of `taxel frames`, `taxel watch` and `:watch`: how frames are read, and how they become imprints.
//!
//! They are applied in this order:
//! ```text
//! --crop --flip --turn --mask --tare --gain              from the recording's values to those that count
//! --at-least | --percent | --low --high | --deviations   from values to active taxels; --least drops small pieces
//! ```
//! Values are in the recording's own unit.

use std::ffi::OsStr;
use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use taxel_core::frame::{Crop, FrameError, FrameSize, Rule, RuleOrigin, SetRule, View};
use taxel_core::parameter::number::short;
use taxel_files::acquire::{AcquireOptions, FrameSource, Playback};
use taxel_files::formats::recording::{Column, Format, ReadOptions, TimeColumn};
use taxel_files::storage::ModelChoice;

use crate::cli::arguments::flags::{parse_number, whole};
use crate::cli::commands::recognise::NamingFlags;
use crate::cli::failure::Failure;
use crate::cli::input::recording;
use crate::frames::{Pipeline, WatchRequest};

#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Processing")]
pub(crate) struct FrameFlags {
    /// Columns, if the recording does not state them
    #[arg(id = "frame_columns", long = "columns", value_name = "COLUMNS")]
    #[arg(value_parser = whole(FrameSize::SIDES), requires = "frame_rows")]
    columns: Option<u16>,
    /// Rows, if the recording does not state them
    #[arg(id = "frame_rows", long = "rows", value_name = "ROWS")]
    #[arg(value_parser = whole(FrameSize::SIDES), requires = "frame_columns")]
    rows: Option<u16>,
    #[arg(long, value_name = "X[:UNIT]")]
    #[arg(help = "Column with the time: its name, or its number\nfrom 1; UNIT is s, ms, us or ns")]
    time_column: Option<TimeColumn>,
    #[arg(long, value_name = "X")]
    #[arg(help = "Column with the label: its name, or its number\nfrom 1")]
    label_column: Option<Column>,
    /// The channel to read, if there are several
    #[arg(long, value_name = "NAME")]
    pub(crate) channel: Option<String>,
    // A negative column is then refused by the parser, not taken for a flag.
    #[arg(long, value_name = "C,R,COLSxROWS", value_parser = parse_crop, allow_hyphen_values = true)]
    #[arg(help = "Keep a part: COLS x ROWS cells from column C,\nrow R on, counted from 0")]
    crop: Option<Crop>,
    /// Reverse columns (x), rows (y) or both (xy)
    #[arg(long, value_name = "AXIS", value_parser = ["x", "y", "xy"], hide_possible_values = true)]
    flip: Option<String>,
    /// Turn clockwise by 90, 180 or 270 degrees
    #[arg(long, value_name = "DEGREES", value_parser = quarter_turns(), hide_possible_values = true)]
    turn: Option<u8>,
    #[arg(long, value_name = "FILE")]
    #[arg(help = "Imprint whose active taxels are dead cells;\nthese get no value")]
    mask: Option<PathBuf>,
    #[arg(long, value_name = "N", value_parser = whole::<u64>(0..))]
    #[arg(help = "Subtract the median of each cell over the first\nN frames")]
    tare: Option<u64>,
    /// Table of factors, one for each cell
    #[arg(long, value_name = "FILE")]
    gain: Option<PathBuf>,
    #[command(flatten)]
    threshold: ThresholdFlags,
}

#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Threshold")]
struct ThresholdFlags {
    /// Active at T or more, in the recording's unit
    #[arg(long, value_name = "T", value_parser = parse_number, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["percent", "low", "high", "deviations"])]
    at_least: Option<f64>,
    /// Active at P percent of the largest value or more
    #[arg(long, value_name = "P", value_parser = parse_number, allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["low", "high", "deviations"])]
    percent: Option<f64>,
    #[arg(long, value_name = "A", value_parser = parse_number, allow_hyphen_values = true)]
    #[arg(requires = "high", conflicts_with = "deviations")]
    #[arg(help = "Active at A or more if connected to a cell of B\nor more")]
    low: Option<f64>,
    /// Active at B or more
    #[arg(long, value_name = "B", value_parser = parse_number, allow_hyphen_values = true)]
    #[arg(requires = "low", conflicts_with = "deviations")]
    high: Option<f64>,
    #[arg(long, value_name = "K", value_parser = parse_number, allow_hyphen_values = true)]
    #[arg(requires = "tare")]
    #[arg(help = "Active at K standard deviations of the cell's noise\nor more; needs a tare")]
    deviations: Option<f64>,
    /// Drop pieces of fewer than K taxels
    #[arg(long, alias = "min-taxels", value_name = "K", value_parser = whole::<u32>(1..=4096))]
    least: Option<u32>,
}

impl FrameFlags {
    /// How a recording is read.
    pub(crate) fn reading(&self) -> ReadOptions {
        ReadOptions {
            size: self.size(),
            time_column: self.time_column.clone(),
            label_column: self.label_column.clone(),
            ..ReadOptions::default()
        }
    }

    pub(crate) fn size(&self) -> Option<FrameSize> {
        FrameSize::of_sides(self.columns, self.rows)
    }

    /// Whether mask or gain come from standard input.
    pub(crate) fn reads_standard(&self) -> bool {
        let mut files = [&self.mask, &self.gain].into_iter().flatten();
        files.any(|path| path.as_os_str() == "-")
    }

    /// How frames are processed; `usual` says what the flags leave open. Reads mask and gain.
    pub(crate) fn pipeline(&self, usual: &Pipeline) -> Result<Pipeline, Failure> {
        let flips = |axis| self.flip.as_ref().is_some_and(|flip| flip.contains(axis));
        let mask = self.mask.as_deref().map(recording::dead_cells);
        let mut processing = usual.processing.clone();
        processing.view = View {
            crop: self.crop,
            flip_x: flips('x'),
            flip_y: flips('y'),
            quarter_turns: self.turn.unwrap_or_default(),
            mask: mask.transpose()?,
        };
        processing.gain = self.gain.as_deref().map(recording::gain).transpose()?;
        processing.least = self.threshold.least.unwrap_or(processing.least);
        if let Some(rule) = self.threshold.rule()? {
            let (least, from) = (processing.least, RuleOrigin::Flag);
            processing.apply_rule(Some(SetRule { rule, least, from }));
        }
        Ok(match self.tare {
            Some(_) => Pipeline::new(processing, self.tare, RuleOrigin::Flag),
            None => Pipeline {
                processing,
                ..usual.clone()
            },
        })
    }
}

impl ThresholdFlags {
    fn rule(&self) -> Result<Option<Rule>, Failure> {
        let refused = |flag: &str, value: f64, error: FrameError| {
            let why = match error {
                FrameError::Rule { allowed, .. } => format!("is out of range (allowed: {allowed})"),
                FrameError::Order { high, .. } => format!("is above --high {}", short(high)),
                error => format!("is not allowed: {error}"),
            };
            Failure::new(format!("--{flag} {} {why}", short(value)))
        };
        if let (Some(low), Some(high)) = (self.low, self.high) {
            let both = Rule::hysteresis(low, high).map_err(|error| match error {
                FrameError::Rule { what: "high", .. } => refused("high", high, error),
                error => refused("low", low, error),
            });
            return both.map(Some);
        }
        let rules = [
            ("at-least", self.at_least, Rule::at_least as fn(f64) -> _),
            ("percent", self.percent, Rule::percent),
            ("deviations", self.deviations, Rule::noise),
        ];
        let given = rules.into_iter().find_map(|(flag, value, make)| {
            let value = value?;
            Some(make(value).map_err(|error| refused(flag, value, error)))
        });
        given.transpose()
    }
}

fn quarter_turns() -> impl TypedValueParser<Value = u8> {
    PossibleValuesParser::new(["90", "180", "270"]).map(|degrees| match &*degrees {
        "90" => 1,
        "180" => 2,
        _ => 3,
    })
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

/// What `taxel watch` and `:watch` know about a source.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct WatchFlags {
    #[command(flatten)]
    source: SourceFlags,
    #[command(flatten)]
    pub(crate) frames: FrameFlags,
    #[command(flatten)]
    pub(crate) naming: NamingFlags,
}

#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Source")]
struct SourceFlags {
    #[arg(long, value_name = "FORMAT", help = formats_help())]
    #[arg(value_parser = PossibleValuesParser::new(formats()), hide_possible_values = true)]
    format: Option<String>,
    /// Speed of a serial line; default 115200
    #[arg(long, value_name = "BAUD", value_parser = whole(AcquireOptions::BAUDS))]
    baud: Option<u32>,
    /// Read to the end as fast as possible, then stop
    #[arg(long, conflicts_with_all = ["loop", "speed"])]
    once: bool,
    /// Start a recording again when it ends
    #[arg(id = "loop", long)]
    repeat: bool,
    /// Play a recording at FACTOR times its speed
    #[arg(long, value_name = "FACTOR", value_parser = parse_speed)]
    speed: Option<f64>,
}

fn formats() -> impl Iterator<Item = &'static str> {
    std::iter::once("auto").chain(Format::of_streams().map(|(name, _)| name))
}

fn formats_help() -> String {
    let names: Vec<&str> = formats().collect();
    format!("Format of the stream: {}", names.join(", "))
}

fn parse_speed(text: &str) -> Result<f64, String> {
    let speed = parse_number(text)?;
    let allowed = Playback::allows(speed).then_some(speed);
    allowed.ok_or_else(|| format!("expected {}", Playback::SPEEDS))
}

impl WatchFlags {
    /// The request for a source; `usual` says what the flags leave open, as in the settings.
    pub(crate) fn request(
        self,
        source: impl AsRef<OsStr>,
        usual: &WatchRequest,
    ) -> Result<WatchRequest, Failure> {
        let (own, frames) = (self.source, self.frames);
        let mut options = usual.options.clone();
        if let Some(name) = own.format {
            options.format = Format::of_stream(&name).ok();
            options.stream_format = None;
        }
        options.size = frames.size().or(options.size);
        options.baud = own.baud.or(options.baud);
        options.playback = if own.once {
            Playback::Once
        } else {
            Playback::paced(own.speed.unwrap_or(1.0), own.repeat)
        };
        let (pipeline, terms) = (
            frames.pipeline(&usual.pipeline)?,
            self.naming.terms.terms()?,
        );
        options.time_column = frames.time_column;
        options.label_column = frames.label_column;
        options.channel = frames.channel;
        Ok(WatchRequest {
            source: FrameSource::named(source),
            options,
            baud_named: own.baud.is_some(),
            pipeline,
            write: None,
            model: self.naming.model.map(ModelChoice::from_text),
            terms,
            history_bytes: usual.history_bytes,
        })
    }
}
