//! `taxel frames`: lists a recording, or answers its frames as imprints.
//!
//! A recording is read once to list it, and again for each step that needs all frames first: the tare, and the peak
//! after a tare. So memory does not grow with its length. A damage does not stop the command at once: everything before
//! it is listed or answered, then it is reported as the error.

use std::cell::RefCell;
use std::fmt::Display;
use std::io::{self, BufWriter, StdoutLock, Write};
use std::ops::{ControlFlow, Range};
use std::path::PathBuf;

use clap::{Arg, ArgGroup};
use serde::Serialize;
use serde_json::json;
use taxel_core::frame::{
    FlipCounter, FlipReport, Frame, FrameError, FrameSize, Label, Peak, Processed, Rule,
    RuleOrigin, SetRule, View,
};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_core::parameter::number::short;
use taxel_core::progress::stop_if;
use taxel_core::recognition::Trial;
use taxel_files::ReadError;
use taxel_files::formats::json;
use taxel_files::formats::name::folded;
use taxel_files::formats::recording::{
    ChannelInfo, Format, FrameAnswer, RecordingEvent, RecordingNote, no_channel, unshaped,
};
use taxel_files::formats::value::{counted, decimal, grouped};

use crate::cli::arguments::flags::whole;
use crate::cli::arguments::parameters::PitchFlag;
use crate::cli::commands::frame_flags::FrameFlags;
use crate::cli::commands::model::Table;
use crate::cli::commands::model::trial::TrialReport;
use crate::cli::commands::recognise::{FoundNamer, Namer, NamingFlags};
use crate::cli::input::recording::{RecordingFile, damaged, refused};
use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::count;
use crate::cli::output::report;
use crate::cli::output::table::Record;
use crate::cli::{Context, Failure};
use crate::frames::{Pipeline, Taring, unit};

#[expect(clippy::struct_excessive_bools, reason = "one for each flag")]
#[derive(Debug, clap::Args)]
#[command(about = "List a recording of a real sensor, or describe its frames")]
#[command(after_help = EXAMPLES)]
#[command(group = ArgGroup::new("choice").args(CHOICES))]
#[command(group = ArgGroup::new("answered").args(CHOICES).arg("csv").multiple(true))]
#[command(mut_args(of_answers))]
pub(crate) struct Frames {
    /// Recording; '-' for standard input
    file: PathBuf,
    /// Frame N of the channel, from 0
    #[arg(long, value_name = "N", value_parser = whole::<u64>(0..), help_heading = "Frames")]
    frame: Option<u64>,
    /// The frame with the label L in the recording
    #[arg(long, value_name = "L", help_heading = "Frames")]
    #[arg(allow_hyphen_values = true)]
    label: Option<Label>,
    /// The frame with the greatest sum, after tare and gain
    #[arg(long, help_heading = "Frames")]
    peak: bool,
    /// All frames, one after the other
    #[arg(long, help_heading = "Frames")]
    all: bool,
    /// How often taxels flip, and which are dead or stuck
    #[arg(long, help_heading = "Frames")]
    noise_report: bool,
    /// Count the answers of --model against the labels
    #[arg(long, help_heading = "Recognition", requires_all = ["all", "model"], conflicts_with = "heat")]
    expect_labels: bool,
    /// Print JSON, one line per answer
    #[arg(long, conflicts_with_all = ["heat", "csv"])]
    json: bool,
    // A table has a line for each frame and no place for other answers.
    #[arg(long, conflicts_with_all = ["noise_report", "heat"])]
    #[arg(
        help = "Print CSV, one line per frame: force, contact,\ncentre of pressure, descriptors"
    )]
    csv: bool,
    /// Show the values as shades
    #[arg(long, requires = "choice", conflicts_with = "noise_report")]
    heat: bool,
    #[command(flatten)]
    reading: FrameFlags,
    #[command(flatten)]
    naming: NamingFlags,
    #[command(flatten)]
    pitch: PitchFlag,
}

const EXAMPLES: &str = "\
A recording is a file from Tekscan or XSENSOR, or is MCAP, NPY, NPZ, JSON lines,
the output of 'ros2 topic echo' or a table of numbers.
taxel recognises the format from the content. Without a flag under Frames, it
lists the channels. Frames are cropped, flipped, turned, masked, tared and
multiplied by the gain, in this order; then the threshold makes the imprint.
Values are in the recording's own unit.

If a recording is damaged, taxel processes the complete frames before the
damage and reports where the damage is; the exit status is 1.

Examples:
  taxel frames recording.csv
  taxel frames recording.csv --peak --at-least 10
  taxel frames recording.csv --all --percent 25 --tare 2 --json
  taxel frames recording.csv --csv --tare 2 > force.csv
  taxel frames recording.csv --frame 3 --low 5 --high 20 --heat --ascii
  taxel frames recording.csv --peak --at-least 10 --model parts --noise 0.01
  taxel frames labelled.csv --all --at-least 10 --model parts --expect-labels
  taxel frames recording.csv --noise-report --at-least 10
  taxel frames plain.csv --rows 4 --columns 5 --label-column 21 \\
    --time-column 22:ms --crop 1,0,3x3 --json";

const CHOICES: [&str; 5] = ["frame", "label", "peak", "all", "noise_report"];

/// A listing shows values as they are, wherever they lie, and a report on many frames has no place for one.
fn of_answers(arg: Arg) -> Arg {
    match arg.get_id().as_str() {
        "tare" | "gain" | "flip" | "turn" | "at_least" | "percent" | "low" | "high"
        | "deviations" | "least" => arg.requires("answered"),
        "model" | "noise" | "tolerance" | "pitch_mm" => {
            arg.requires("choice").conflicts_with("noise_report")
        }
        _ => arg,
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Choice {
    Number(u64),
    Label(Label),
    Peak,
    All,
}

impl Frames {
    fn choice(&self) -> Option<Choice> {
        match (self.frame, &self.label) {
            (Some(number), _) => Some(Choice::Number(number)),
            (_, Some(label)) => Some(Choice::Label(label.clone())),
            _ if self.peak => Some(Choice::Peak),
            _ if self.all || self.noise_report || self.csv => Some(Choice::All),
            _ => None,
        }
    }

    /// If an error occurs, the answers made before it are still printed.
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        if self.csv && self.naming.model.is_some() && !self.expect_labels {
            return Err(Failure::usage(
                "the argument '--csv' cannot be used with '--model <MODEL>', except with --expect-labels",
            ));
        }
        let pipeline = self
            .reading
            .pipeline(&cx.settings.watch_request().pipeline)?;
        let found = self
            .naming
            .find(pipeline.processing.view.mask.as_ref(), &cx.shelf)?;
        let recording = RecordingFile::open(&self.file, self.reading.reading())?;
        let namer = found.map(FoundNamer::ready).transpose()?;
        let answering = Answering {
            asked: &self,
            cx,
            name: recording.name.clone(),
            pipeline,
            namer,
            pitch: self.pitch.pitch(&cx.settings)?.given,
            output: RefCell::new(BufWriter::new(io::stdout().lock())),
        };
        let done = answering.run(recording);
        let flushed = answering.output.into_inner().flush();
        flushed.map_err(Failure::of_output)?;
        done
    }
}

/// What a first look at a recording finds: its channels, its oddities, and the damage at which it ends.
#[derive(Debug, Default)]
struct Scan {
    /// None if a damage comes before the format is certain.
    format: Option<&'static Format>,
    channels: Vec<Channel>,
    /// How the recording is read: what its times, labels and cells are.
    plain: Vec<String>,
    notes: Vec<RecordingNote>,
    error: Option<ReadError>,
    misfit: Option<FrameError>,
}

/// A channel, as it is listed.
#[derive(Debug, Default)]
struct Channel {
    info: ChannelInfo,
    /// The size of the visible part of its frames.
    seen: Option<FrameSize>,
    frames: u64,
    cells: usize,
    best: Peak,
    marks: Vec<u64>,
    /// The number of values of a frame.
    values: u64,
    /// The frames with the label that is asked for.
    labelled: Vec<u64>,
    /// The first and the last time in seconds.
    times: Option<(f64, f64)>,
    /// The first frame that is earlier than the one before it: a clock was set back, or the column is not a time.
    backwards: Option<u64>,
}

impl Scan {
    fn of(recording: &mut RecordingFile, view: &View, label: Option<&Label>) -> Self {
        let mut scan = Self::default();
        let mut seen = Matrix::default();
        let result = recording.read(&mut |event| {
            match event {
                RecordingEvent::Channel(info) => scan.channels.push(Channel::new(info, view)),
                RecordingEvent::Frame(frame) => {
                    let values = match view.apply_to(frame, &mut seen) {
                        Ok(()) => seen.values(),
                        Err(error) => {
                            if view.crop.is_some() {
                                scan.misfit.get_or_insert(error);
                            }
                            frame.values()
                        }
                    };
                    if let Some(channel) = scan.channels.get_mut(frame.channel) {
                        channel.add(frame, values, label);
                    }
                }
                RecordingEvent::Note(note) if note.is_plain() => scan.plain.push(note.to_string()),
                RecordingEvent::Note(note) => scan.notes.push(note.clone()),
                RecordingEvent::Damage { .. } => {}
            }
            ControlFlow::Continue(())
        });
        match result {
            Ok(format) => scan.format = Some(format),
            Err(error) => {
                scan.format = recording.format();
                scan.error = Some(error);
                recording.is_damaged = true;
            }
        }
        scan
    }
}

/// The list of channels, with its keys in this order.
#[derive(Serialize)]
struct ListJson<'a> {
    /// Null if a damage comes before the format is certain.
    format: Option<&'static str>,
    channels: Vec<Record<'static>>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    notes: &'a [String],
}

impl Channel {
    fn new(info: &ChannelInfo, view: &View) -> Self {
        Self {
            seen: info.size.map(|size| view.size(size).unwrap_or(size)),
            info: info.clone(),
            ..Self::default()
        }
    }

    fn record(&self) -> Record<'static> {
        let info = &self.info;
        let mut record = vec![
            ("name", json!(info.name)),
            ("frames", json!(self.frames)),
            ("rows", json!(self.seen.map(FrameSize::rows))),
            ("columns", json!(self.seen.map(FrameSize::columns))),
            ("cells", json!(self.cells)),
            ("unit", json!(info.unit)),
            ("start", json!(info.start)),
            ("seconds_per_frame", json!(info.seconds_per_frame)),
            ("pitch_mm", json!(info.pitch_mm)),
            ("threshold", json!(info.threshold)),
            ("peak", json!(self.best.number())),
        ];
        if !self.marks.is_empty() {
            record.push(("marks", json!(self.marks)));
        }
        Record(record)
    }

    fn add(&mut self, frame: &Frame, values: &[f64], asked: Option<&Label>) {
        let present = values.iter().filter(|value| !value.is_nan());
        let cells = present.clone().count();
        self.cells = self.cells.max(cells);
        let sum = (cells > 0).then(|| present.sum());
        self.best.add(frame.number, sum);
        if let Some(time) = frame.time {
            let (first, last) = self.times.unwrap_or((time, time));
            if time < last {
                self.backwards.get_or_insert(frame.number);
            }
            self.times = Some((first, time));
        }
        if let Some(label) = &frame.label {
            let is_marked = |own: i64| {
                let mut marks = self.info.marks.iter();
                marks.any(|mark| i64::try_from(mark.number) == Ok(own))
            };
            if label.number().is_some_and(is_marked) {
                self.marks.push(frame.number);
            }
            if asked == Some(label) {
                self.labelled.push(frame.number);
            }
        }
        self.frames += 1;
        self.values = self.info.values.unwrap_or(frame.values().len() as u64);
    }

    fn lines(&self) -> Vec<String> {
        let info = &self.info;
        let pitch = info.pitch_mm.map(|[x, y]| match info.square_pitch_mm() {
            Some(side) => format!("{} mm", short(side)),
            None => format!("{} mm across, {} mm down", short(x), short(y)),
        });
        let time = self.times.map(|(first, last)| {
            let back = (self.backwards).map(|number| format!(", goes back at frame {number}"));
            let [first, last] = [first, last].map(|time| decimal(time, 9));
            format!("{first} to {last} s{}", back.unwrap_or_default())
        });
        let marks: Vec<String> = self.marks.iter().map(u64::to_string).collect();
        let step = info
            .seconds_per_frame
            .map(|step| format!("{} s", decimal(step, 6)));
        let rows = [
            ("channel", info.name.clone()),
            ("frames", Some(self.frames.to_string())),
            ("size", Some(self.size())),
            ("unit", info.unit.clone()),
            ("start", info.start.clone()),
            ("time", time),
            ("step", step),
            ("pitch", pitch),
            (
                "threshold",
                info.threshold.map(|value| short(value) + &unit(info)),
            ),
            ("marks", (!marks.is_empty()).then(|| marks.join(", "))),
            (
                "peak",
                self.best.number().map(|number| format!("frame {number}")),
            ),
        ];
        let lines = rows.map(|(name, value)| Some(format!("{name:<10}{}", value?)));
        lines.into_iter().flatten().collect()
    }

    fn size(&self) -> String {
        let Some(seen) = self.seen else {
            let values = counted(self.values, "value");
            return format!("{values} a frame; give --rows and --columns");
        };
        let whole = self.info.size.filter(|whole| *whole != seen);
        let whole = whole.map(|own| format!(" of {} × {}", own.rows(), own.columns()));
        let [rows, columns] = in_words(seen);
        let cells = counted(self.cells as u64, "cell");
        format!("{rows} × {columns}{}, {cells}", whole.unwrap_or_default())
    }

    /// Why none of its frames is the chosen one.
    fn missing(&self, choice: &Choice) -> String {
        if self.frames == 0 {
            return "no frames".to_owned();
        }
        match choice {
            Choice::Label(label) => format!("no frame is labelled {label}"),
            Choice::Number(number) => match self.frames - 1 {
                0 => format!("no frame {number}; the recording has only frame 0"),
                last => format!("no frame {number}, expected 0 to {last}"),
            },
            Choice::Peak => "no frame has a cell with a value, so none is the peak".to_owned(),
            Choice::All => "no frames".to_owned(),
        }
    }
}

fn in_words(size: FrameSize) -> [String; 2] {
    [
        counted(size.rows(), "row"),
        counted(size.columns(), "column"),
    ]
}

const MOST_WARNINGS: usize = 20;

struct Answering<'a> {
    asked: &'a Frames,
    cx: &'a Context,
    /// The name of the recording.
    name: String,
    pipeline: Pipeline,
    namer: Option<Namer>,
    pitch: Option<f64>,
    output: RefCell<BufWriter<StdoutLock<'static>>>,
}

impl Answering<'_> {
    fn warn(&self, text: impl Display) {
        self.cx.note(&format!("warning: {}: {text}", self.name));
    }

    fn refused(&self, why: impl Display) -> Failure {
        refused(&self.name, why)
    }

    fn write(&self, text: impl AsRef<[u8]>) -> Result<(), Failure> {
        let written = self.output.borrow_mut().write_all(text.as_ref());
        written.map_err(Failure::of_output)
    }

    fn run(&self, mut recording: RecordingFile) -> Result<(), Failure> {
        let view = &self.pipeline.processing.view;
        let mut scan = Scan::of(&mut recording, view, self.asked.label.as_ref());
        let wanted = self.asked.reading.channel.as_deref();
        if let Some(complaint) = &recording.complaint {
            self.cx.note(&format!("warning: {complaint}"));
        }
        self.remark(&scan, wanted);
        let damage = scan.error.take().map(|error| damaged(&self.name, &error));
        if scan.channels.is_empty() {
            return Err(damage.unwrap_or_else(|| self.refused("no frames")));
        }
        let Some(choice) = self.asked.choice() else {
            self.list(&scan, wanted)?;
            return damage.map_or(Ok(()), Err);
        };
        // A table without a choice has all channels.
        let is_table = self.asked.csv && !self.asked.all && choice == Choice::All;
        let channels = if is_table && wanted.is_none() {
            0..scan.channels.len()
        } else {
            let channel = self.channel(&scan, wanted)?;
            channel..channel + 1
        };
        let mut answered = false;
        for index in channels.clone() {
            let channel = &scan.channels[index];
            let prepared = self.prepared(&mut recording, &choice, (index, channel));
            let (mut pipeline, numbers) = match prepared {
                Ok(prepared) => prepared,
                // If frames are missing, the damage is the reason.
                Err(failure) => return Err(damage.unwrap_or(failure)),
            };
            if self.asked.csv && !self.asked.expect_labels && index == channels.start {
                self.write(FrameAnswer::csv_header())?;
            }
            answered |= if self.asked.noise_report {
                self.report_noise(&mut recording, index, &mut pipeline)?
            } else if let Some(namer) = self.namer.as_ref().filter(|_| self.asked.expect_labels) {
                self.compare_labels(&mut recording, index, &mut pipeline, namer)?
            } else {
                self.answer(&mut recording, (index, channel), &numbers, &mut pipeline)?
            };
        }
        match damage {
            Some(damage) => Err(damage),
            None if answered => Ok(()),
            None => Err(self.refused(scan.channels[channels.start].missing(&choice))),
        }
    }

    /// The index of the chosen channel. Without a name there must be only one.
    fn channel(&self, scan: &Scan, asked: Option<&str>) -> Result<usize, Failure> {
        let names = scan.channels.iter();
        let names: Vec<&str> = names.map(|channel| channel.info.shown_name()).collect();
        match asked {
            None if names.len() == 1 => Ok(0),
            None => Err(self.refused(format!(
                "{} channels, choose one with --channel: {}",
                names.len(),
                names.join(", ")
            ))),
            Some(asked) => {
                let found = names.iter().position(|name| *name == asked);
                found.ok_or_else(|| self.refused(no_channel(asked, &names)))
            }
        }
    }

    /// Warns of what is odd in the recording, and of rows and columns that it states otherwise than the flags.
    fn remark(&self, scan: &Scan, wanted: Option<&str>) {
        for note in scan.notes.iter().take(MOST_WARNINGS) {
            self.warn(note);
        }
        if let more @ 1.. = scan.notes.len().saturating_sub(MOST_WARNINGS) {
            self.warn(format!("{more} more of these"));
        }
        let channels = scan.channels.iter().map(|channel| &channel.info);
        let stated = channels
            .filter(|info| wanted.is_none_or(|wanted| wanted == info.shown_name()))
            .find_map(|info| info.size);
        if let (Some(given), Some(stated)) = (self.asked.reading.size(), stated)
            && given != stated
        {
            let [rows, columns] = in_words(stated);
            self.warn(format!(
                "it states {rows} and {columns}; --rows and --columns have no effect"
            ));
        }
    }

    fn list(&self, scan: &Scan, wanted: Option<&str>) -> Result<(), Failure> {
        if let Some(misfit) = &scan.misfit {
            return Err(self.refused(misfit));
        }
        let channels = match wanted {
            Some(_) => std::slice::from_ref(&scan.channels[self.channel(scan, wanted)?]),
            None => &scan.channels[..],
        };
        let format = scan.format.map(|format| format.name);
        if self.asked.json {
            let list = ListJson {
                format,
                channels: channels.iter().map(Channel::record).collect(),
                notes: &scan.plain,
            };
            return self.write(json::ascii(&list) + "\n");
        }
        let count = counted(channels.len() as u64, "channel");
        let mut lines = vec![format!("{}, {count}", format.unwrap_or("damaged"))];
        lines.extend_from_slice(&scan.plain);
        for channel in channels {
            lines.push(String::new());
            lines.extend(channel.lines());
        }
        let lines = lines
            .iter()
            .map(|line| Charset::current().line(line) + "\n");
        self.write(lines.collect::<String>())
    }

    /// Completes the processing of a channel with its threshold and its tare, for which the recording is read again.
    /// Also returns the numbers of the frames to answer.
    fn prepared(
        &self,
        recording: &mut RecordingFile,
        choice: &Choice,
        (index, channel): (usize, &Channel),
    ) -> Result<(Pipeline, Vec<Range<u64>>), Failure> {
        let mut pipeline = self.pipeline.clone();
        if let Some(unused) = pipeline.begin(&channel.info) {
            self.warn(unused);
        }
        if channel.info.size.is_none() {
            let given = self.asked.reading.size();
            return Err(damaged(&self.name, &unshaped(channel.values, given)));
        }
        // Force and contact exist without a threshold, too. There is no default: the meaning of values differs from
        // sensor to sensor.
        if pipeline.rule().is_none() && (!self.asked.csv || self.asked.expect_labels) {
            return Err(self.refused(
                "the recording has no threshold of its own: set one with --at-least, --percent, \
                 --low and --high, or --deviations",
            ));
        }
        if pipeline.progress().is_some() {
            // Damage after the tare's frames does not matter here.
            recording.frames_again(index, |frame| match pipeline.add_to_tare(frame) {
                Ok(Taring::Made) => Ok(ControlFlow::Break(())),
                Ok(Taring::LeftOut(error)) | Err(error) => Err(self.refused(error)),
                Ok(_) => Ok(ControlFlow::Continue(())),
            })?;
        }
        if let Some(lacking) = pipeline.lacking() {
            return Err(self.refused(pipeline.explained(&lacking)));
        }
        if let Some(unknown) = pipeline.unknown_step() {
            self.warn(unknown);
        }
        let processing = &pipeline.processing;
        let one = |number: u64| number..number + 1;
        let numbers = match choice {
            Choice::All => std::iter::once(0..u64::MAX).collect(),
            Choice::Number(number) => vec![one(*number)],
            Choice::Label(_) => channel.labelled.iter().copied().map(one).collect(),
            // Without tare and gain the listing has it already.
            Choice::Peak if processing.tare.is_none() && processing.gain.is_none() => {
                channel.best.number().map(one).into_iter().collect()
            }
            Choice::Peak => {
                let mut peak = Peak::default();
                self.each(recording, index, &mut pipeline, |frame, processed| {
                    peak.add(frame.number, processed.tared_sum);
                    Ok(ControlFlow::Continue(()))
                })?;
                peak.number().map(one).into_iter().collect()
            }
        };
        Ok((pipeline, numbers))
    }

    /// Reads the frames of a channel again from the first one, and processes them.
    fn each(
        &self,
        recording: &mut RecordingFile,
        index: usize,
        pipeline: &mut Pipeline,
        mut take: impl FnMut(&Frame, Processed<'_>) -> Result<ControlFlow<()>, Failure>,
    ) -> Result<(), Failure> {
        recording.frames_again(index, |frame| match pipeline.processing.run(frame) {
            Ok(processed) => take(frame, processed),
            Err(error) => Err(self.refused(self.pipeline.explained(&error))),
        })
    }

    /// Answers frames; returns true if there were any. The recording is not read beyond the last of them.
    fn answer(
        &self,
        recording: &mut RecordingFile,
        (index, channel): (usize, &Channel),
        numbers: &[Range<u64>],
        pipeline: &mut Pipeline,
    ) -> Result<bool, Failure> {
        let end = numbers.last().map_or(0, |last| last.end);
        let mut answered = false;
        recording.frames_again(index, |frame| {
            let next = numbers.partition_point(|own| own.end <= frame.number);
            if numbers
                .get(next)
                .is_some_and(|own| own.contains(&frame.number))
            {
                let processed = pipeline.processing.run(frame);
                let processed =
                    processed.map_err(|error| self.refused(self.pipeline.explained(&error)))?;
                self.give(channel, frame, &processed, answered)?;
                answered = true;
            }
            Ok(stop_if(frame.number + 1 >= end))
        })?;
        Ok(answered)
    }

    /// Answers a frame. An empty line separates it from frames before it.
    fn give(
        &self,
        channel: &Channel,
        frame: &Frame,
        processed: &Processed<'_>,
        again: bool,
    ) -> Result<(), Failure> {
        let info = &channel.info;
        let answer = FrameAnswer {
            frame,
            channel: info.name.as_deref(),
            processed: *processed,
        };
        if self.asked.csv {
            return self.write(answer.csv_line());
        }
        let Some((imprint, rule)) = processed.imprint.zip(processed.rule) else {
            return Ok(());
        };
        let (pitch, without_pitch) = self.cell_size(info)?;
        if self.asked.json {
            let mut line = json::ascii(&answer).into_bytes();
            match &self.namer {
                Some(namer) => namer.extend(&mut line, Some(&imprint)),
                None => line.push(b'\n'),
            }
            return self.write(line);
        }
        let mut lines = self.titles(info, frame, processed, rule);
        lines.extend(without_pitch);
        lines.push(report::size(&imprint, None, pitch));
        let mut text = if again { "\n" } else { "" }.to_owned();
        if self.asked.heat {
            let (values, charset) = (processed.tared, Charset::current());
            text += &(report::heat_map(values, &charset.line(&unit(info)), charset) + "\n");
        }
        text += &report::table(&imprint, &lines, pitch);
        let named = self.namer.as_ref().map(|namer| namer.text(&imprint));
        if let Some(named) = named.filter(|named| !named.is_empty()) {
            text.push('\n');
            text += &named;
        }
        self.write(text)
    }

    /// Lines about a frame: `iscan.csv, frame 65 (label 66), 6.5 s`, then sum and maximum, then force and centre, then
    /// the threshold.
    fn titles(
        &self,
        info: &ChannelInfo,
        frame: &Frame,
        processed: &Processed<'_>,
        rule: SetRule,
    ) -> Vec<String> {
        let file = self.name.rsplit('/').next().unwrap_or(&self.name);
        let mut title = format!("{file}, frame {}", frame.number);
        if let Some(label) = &frame.label {
            title += &format!(" (label {label})");
        }
        if let Some(time) = frame.time {
            title += &format!(", {} s", short(time));
        }
        if let Some(channel) = &info.name {
            title += &format!(", {channel}");
        }
        let unit = unit(info);
        let max = processed.max.map_or("–".to_owned(), short);
        let sum = short(processed.sum);
        let mut values = format!("raw sum {sum}{unit}, raw max {max}{unit}");
        if processed.tare > 0 {
            values += &format!(", tare of {}", counted(processed.tare, "frame"));
        }
        if processed.gain {
            values += ", gain applied";
        }
        let mut contact = format!("force {}{unit}", short(processed.force));
        if let Some([x, y]) = processed.cop {
            contact += &format!(", centre of pressure ({x:.2}, {y:.2})");
        }
        vec![title, values, contact, rule_text(rule, &unit)]
    }

    /// The side of a cell in mm, and a line if the recording's cells are not square. `--pitch` overrides the recording.
    /// The pitch of the settings is not used: it is that of the simulated sensor.
    fn cell_size(&self, info: &ChannelInfo) -> Result<(Option<f64>, Option<String>), Failure> {
        match (info.why_not_in_mm(), self.pitch) {
            (None, pitch) => Ok((pitch.or(info.square_pitch_mm()), None)),
            (Some(why), None) => Ok((None, Some(why))),
            (Some(why), Some(_)) => Err(self.refused(format!("--pitch: {why}"))),
        }
    }

    /// Names the frames of a channel that have a label and an active taxel, and counts the answers against the labels.
    fn compare_labels(
        &self,
        recording: &mut RecordingFile,
        index: usize,
        pipeline: &mut Pipeline,
        namer: &Namer,
    ) -> Result<bool, Failure> {
        let mut trial = Trial::new(&namer.model);
        let (mut unlabelled, mut empty) = (0_u64, 0_u64);
        self.each(recording, index, pipeline, |frame, processed| {
            let imprint = processed.imprint.filter(|imprint| !imprint.is_empty());
            match (&frame.label, imprint) {
                (None, _) => unlabelled += 1,
                (Some(_), None) => empty += 1,
                (Some(label), Some(imprint)) => {
                    let label = label.to_string();
                    let own = folded(&label);
                    let answer = namer.answer(&[imprint]).answer;
                    trial.add(&label, |name| folded(name) == own, &answer);
                }
            }
            Ok(ControlFlow::Continue(()))
        })?;
        let labelled = trial.known.touches() + trial.foreign.touches();
        if labelled == 0 {
            return Err(self.refused("--expect-labels: no frame has a label and an active taxel"));
        }
        let report = TrialReport {
            trial: &trial,
            noun: "frame",
            note: format!(
                "left out: {} without a label, {} without an active taxel",
                counted(unlabelled, "frame"),
                counted(empty, "frame")
            ),
            keys: vec![
                ("frames", count(labelled)),
                ("unlabelled", unlabelled.into()),
                ("empty", empty.into()),
            ],
        };
        let table = self.asked.csv.then(|| report.csv()).flatten();
        let json = || self.asked.json.then(|| report.json());
        self.write(table.or_else(json).unwrap_or_else(|| report.text()))?;
        Ok(true)
    }

    /// Reports which taxels of a channel flip or are stuck. Returns false, and reports nothing, if the channel has no frames.
    fn report_noise(
        &self,
        recording: &mut RecordingFile,
        index: usize,
        pipeline: &mut Pipeline,
    ) -> Result<bool, Failure> {
        let mut counter: Option<FlipCounter> = None;
        self.each(recording, index, pipeline, |_, processed| {
            let counter = counter.get_or_insert_with(|| {
                FlipCounter::new(processed.raw.cells_where(|_, value| !value.is_nan()))
            });
            if let Some(imprint) = &processed.imprint {
                counter.add(imprint);
            }
            Ok(ControlFlow::Continue(()))
        })?;
        let Some(found) = counter.map(|counter| counter.finish()) else {
            return Ok(false);
        };
        self.write(if self.asked.json {
            json::text(&noise_json(&found)) + "\n"
        } else {
            Charset::current().lines(&noise_text(&found))
        })?;
        Ok(true)
    }
}

/// The threshold in words, with its origin: `active: 20 kPa or more, in pieces of 3 taxels or more (from a flag)`.
fn rule_text(set: SetRule, unit: &str) -> String {
    let mut text = match set.rule {
        Rule::AtLeast(threshold) => format!("active: {}{unit} or more", short(threshold)),
        Rule::Percent(percent) => {
            format!("active: {} % of the largest value or more", short(percent))
        }
        Rule::Hysteresis { low, high } => {
            let [low, high] = [low, high].map(short);
            format!("active: {low}{unit} or more, joined to {high}{unit} or more")
        }
        Rule::Noise(deviations) => {
            let deviations = short(deviations);
            format!("active: {deviations} standard deviations above the tare, or more")
        }
    };
    if set.least > 1 {
        text += &format!(", in pieces of {} taxels or more", set.least);
    }
    let article = match set.from {
        RuleOrigin::File | RuleOrigin::Settings => "the",
        _ => "a",
    };
    text + &format!(" (from {article} {})", set.from.name())
}

fn noise_json(found: &FlipReport) -> Record<'static> {
    Record(vec![
        ("frames", json!(found.frames)),
        ("cells", json!(found.cells)),
        ("noise", json!(found.noise)),
        ("standard_error", json!(found.standard_error)),
        ("flips", json!(found.flips)),
        ("repeated", json!(found.repeated)),
        ("stuck_on", json!(taxels(&found.stuck_on))),
        ("stuck_off", json!(taxels(&found.stuck_off))),
        ("mask", json!(found.mask().lines().collect::<Vec<_>>())),
    ])
}

fn taxels(imprint: &Imprint) -> Vec<[u8; 2]> {
    let rows = 0..imprint.rows();
    let all = rows.flat_map(|row| (0..imprint.columns()).map(move |column| [column, row]));
    all.filter(|&[column, row]| imprint.get(column, row))
        .collect()
}

fn noise_text(found: &FlipReport) -> String {
    let frames = counted(found.frames, "frame");
    let cells = counted(found.cells, "taxel");
    let [flips, cases] = [found.flips, found.repeated].map(grouped);
    let of = format!("a taxel changed for a single frame in {flips} of {cases} cases");
    let noise = match (found.noise, found.standard_error) {
        (Some(noise), Some(error)) => format!("noise {noise:.5} ± {error:.5}: {of}"),
        _ if found.repeated == 0 => "too few frames to tell how often taxels flip".to_owned(),
        _ => format!("noise 0.5 or more: {of}"),
    };
    let [on, off] = [&found.stuck_on, &found.stuck_off].map(|stuck| {
        let taxels = taxels(stuck).into_iter();
        let taxels = taxels.map(|[column, row]| format!("{column},{row}"));
        match taxels.collect::<Vec<_>>().join("  ") {
            none if none.is_empty() => "none".to_owned(),
            all => all,
        }
    });
    format!("{frames} of {cells}\n{noise}\nstuck on: {on}\nstuck off or dead: {off}\n")
}
