//! `taxel frames`: lists a recording, or answers its frames as imprints.
//!
//! A recording is read once to list it, and again for each step that needs all frames first: the tare, and the peak
//! after a tare. So memory does not grow with its length.
//!
//! A listing shows what the recording states about each channel; an answer is an imprint with what was measured:
//! ```text
//! $ taxel frames plain.csv …                             $ taxel frames plain.csv … --peak --at-least 3
//! csv, 1 channel                                             0   2   4
//!                                                         0  · · · · ·
//! frames    1                                             1  · ██████·
//! size      4 rows × 5 columns, 20 cells                  2  · · ████·
//! peak      frame 0                                       3  · · · · ·
//!
//!                                                        plain.csv, frame 0
//!                                                        raw sum 42, raw max 9
//!                                                        force 34, centre of pressure (2.71, 1.85)
//!                                                        active: 3 or more (from a flag)
//! ```
//! A damage does not stop the command at once: everything before it is listed or answered, then it is reported as the
//! error.

use std::io::Write;
use std::ops::{ControlFlow, Range};
use std::slice;

use taxel_core::frame::{
    FlipReport, Frame, Label, Processed, Processing, Rule, RuleOrigin, SetRule,
};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::parameter::number::short;
use taxel_core::sensor::Sensor;
use taxel_files::formats::recording::{ChannelInfo, FrameAnswer, unshaped};
use taxel_files::formats::value::counted;
use taxel_files::formats::{Name, StoredShape, json};
use taxel_files::storage::{self, check_writable};

use crate::cli::arguments::flags::Form;
use crate::cli::arguments::frames::{FrameChoice, FramesArguments};
use crate::cli::commands::export::{Export, Kept, drawing, written};
use crate::cli::commands::recognise::Namer;
use crate::cli::commands::recording_scan::{self, Scan};
use crate::cli::error::{CliError, frame_advice};
use crate::cli::input::recording::{self, RecordingFile};
use crate::cli::input::shapes::Shelf;
use crate::cli::output::charset::Charset;
use crate::cli::output::plot::heat_map;
use crate::cli::output::recording_list::{self, ListedChannel};
use crate::cli::output::report;
use crate::cli::settings::resolved::Pitch;

pub(crate) struct FramesOutput<'a> {
    pub(crate) form: Form,
    pub(crate) kept: Kept,
    pub(crate) shelf: &'a Shelf,
    pub(crate) charset: Charset,
    pub(crate) namer: Option<Namer>,
    pub(crate) answers: &'a mut dyn Write,
    pub(crate) notes: &'a mut dyn FnMut(&str),
}

impl FramesOutput<'_> {
    fn write(&mut self, text: impl AsRef<[u8]>) -> Result<(), CliError> {
        self.answers
            .write_all(text.as_ref())
            .map_err(CliError::Write)
    }
}

pub(crate) fn open(asked: &FramesArguments) -> Result<RecordingFile, CliError> {
    RecordingFile::open(&asked.file, asked.processing.reading())
}

pub(crate) fn frames(
    asked: &FramesArguments,
    mut recording: RecordingFile,
    processing: &Processing,
    mut output: FramesOutput<'_>,
) -> Result<(), CliError> {
    let mut scan = Scan::of(&mut recording, &processing.view);
    for warning in recording
        .complaint()
        .map(str::to_owned)
        .into_iter()
        .chain(scan.warnings(recording.name()))
    {
        (output.notes)(&format!("warning: {warning}"));
    }
    let wanted = asked.processing.channel.as_deref();
    if let Some(unused) = scan.unused_size(asked.processing.size, wanted) {
        (output.notes)(&format!("warning: {}: {unused}", recording.name()));
    }
    let damage = scan.error.take().map(|error| recording.damaged(error));
    if scan.channels.is_empty() {
        return Err(damage.unwrap_or_else(|| recording.refused("no frames")));
    }
    let choice = match &asked.choice {
        None if !asked.csv => {
            list(&scan, &recording, asked, &mut output)?;
            return damage.map_or(Ok(()), Err);
        }
        choice => choice.clone().unwrap_or(FrameChoice::All),
    };
    let every = asked.choice.is_none() && wanted.is_none();
    let channels = if every {
        0..scan.channels.len()
    } else {
        let channel = scan.channel(&recording, wanted)?;
        channel..channel + 1
    };
    let mut answered = false;
    for channel in channels.clone() {
        let listed = &scan.channels[channel];
        let tare = recording::unused_tare(&asked.processing, &listed.info, &processing.view);
        tare.inspect(|unused| (output.notes)(&format!("warning: {}: {unused}", recording.name())));
        let own = (&choice, processing.clone());
        let selected = Selection::new(asked, own, &mut recording, (channel, listed));
        let (selection, mut processing) = match selected {
            Ok(selected) => selected,
            // If frames are missing, the damage is the reason.
            Err(error) => return Err(damage.unwrap_or(error)),
        };
        if let Some(unknown) = recording::unknown_step(&processing) {
            (output.notes)(&format!("warning: {}: {unknown}", recording.name()));
        }
        if asked.csv && channel == channels.start {
            output.write(FrameAnswer::csv_header())?;
        }
        answered |= if choice == FrameChoice::NoiseReport {
            report_noise(&mut recording, channel, &mut processing, &mut output)?
        } else {
            selection.answer(&mut recording, listed, &mut processing, &mut output)?
        };
    }
    match damage {
        Some(damage) => Err(damage),
        None if answered => Ok(()),
        None => Err(recording.refused(&missing(&choice, &scan.channels[channels.start]))),
    }
}

fn list(
    scan: &Scan,
    recording: &RecordingFile,
    asked: &FramesArguments,
    output: &mut FramesOutput<'_>,
) -> Result<(), CliError> {
    if let Some(misfit) = &scan.misfit {
        return Err(recording.refused(misfit));
    }
    let wanted = asked.processing.channel.as_deref();
    let listed = match wanted {
        Some(_) => slice::from_ref(&scan.channels[scan.channel(recording, wanted)?]),
        None => &scan.channels[..],
    };
    output.write(match output.form {
        Form::Json(_) => recording_list::json(scan.format, listed, &scan.plain),
        Form::Table(_) => recording_list::text(scan.format, listed, &scan.plain, output.charset),
    })
}

/// Refuses a file that would replace the recording, or that cannot be written, before the first of several is written.
fn check(export: &Export, recording: &RecordingFile) -> Result<(), CliError> {
    let Some(path) = &export.path else {
        return Ok(());
    };
    recording.refuse_as_target(path)?;
    Ok(check_writable(path, export.existing)?)
}

/// Reports which taxels of a channel flip or are stuck, and writes the mask of the stuck ones if a file is given.
/// Returns false, and reports nothing, if the channel has no frames.
fn report_noise(
    recording: &mut RecordingFile,
    channel: usize,
    processing: &mut Processing,
    output: &mut FramesOutput<'_>,
) -> Result<bool, CliError> {
    let export = output.kept.export.as_ref();
    export.map_or(Ok(()), |export| check(export, recording))?;
    let found = recording_scan::gather(recording, channel, processing)?;
    let found = found.map(|found| write_noise(&found, recording.name(), output));
    Ok(found.transpose()?.is_some())
}

fn write_noise(
    found: &FlipReport,
    name: &str,
    output: &mut FramesOutput<'_>,
) -> Result<(), CliError> {
    let title = format!("{name}: dead and stuck taxels");
    let mut said = None;
    if let Some(export) = &output.kept.export {
        let content = (export.format.write)(&drawing(&found.mask(), None, &title, None));
        let Some(path) = &export.path else {
            return output.write(content);
        };
        storage::write(path, &content, export.existing)?;
        said = Some(written(path));
    }
    if let Form::Json(_) = output.form {
        if let Some(said) = said {
            (output.notes)(&said);
        }
        return output.write(recording_scan::json(found));
    }
    let text = said.map_or(String::new(), |said| said + "\n") + &recording_scan::text(found);
    output.write(output.charset.lines(&text))
}

fn missing(choice: &FrameChoice, listed: &ListedChannel) -> String {
    match choice {
        FrameChoice::Label(label) if listed.frames > 0 => {
            let found = match &listed.labels {
                None => {
                    ": the frames have no labels, only numbers; choose one with --frame".to_owned()
                }
                Some((least, greatest)) if least == greatest => {
                    format!("; the only label is {least}")
                }
                Some((least, greatest)) => format!("; the labels go from {least} to {greatest}"),
            };
            format!("no frame is labelled {label}{found}")
        }
        FrameChoice::Number(number) if listed.frames > 0 => match listed.frames - 1 {
            0 => format!("no frame {number}; the recording has only frame 0"),
            last => format!("no frame {number}, expected 0 to {last}"),
        },
        FrameChoice::Peak if listed.frames > 0 => {
            "no frame has a cell with a value, so none is the peak".to_owned()
        }
        _ => "no frames".to_owned(),
    }
}

struct FoundFrame<'a> {
    name: &'a str,
    listed: &'a ListedChannel,
    frame: &'a Frame,
    processed: Processed<'a>,
}

impl FoundFrame<'_> {
    fn answer(&self) -> FrameAnswer<'_> {
        FrameAnswer {
            frame: self.frame,
            channel: self.listed.info.name.as_deref(),
            processed: self.processed,
        }
    }

    fn line(&self, imprint: &Imprint, output: &mut FramesOutput<'_>) -> Vec<u8> {
        let mut line = json::ascii(&self.answer()).into_bytes();
        match &mut output.namer {
            Some(namer) => namer.extend(&mut line, Some(imprint)),
            None => line.push(b'\n'),
        }
        line
    }
}

struct Selection {
    choice: FrameChoice,
    number: Option<u64>,
    channel: usize,
    csv: bool,
    heat: bool,
}

impl Selection {
    /// Selects the frames of the flags, and completes their processing: with the rule, and with the tare and the
    /// peak, for which the recording is read again.
    fn new(
        asked: &FramesArguments,
        (choice, mut processing): (&FrameChoice, Processing),
        recording: &mut RecordingFile,
        (channel, listed): (usize, &ListedChannel),
    ) -> Result<(Self, Processing), CliError> {
        if listed.info.size.is_none() {
            let given = asked.processing.size;
            return Err(recording.damaged(unshaped(listed.values, given)));
        }
        let rule = recording::rule(recording, &asked.processing, &listed.info);
        // Force and contact exist without a threshold, too.
        processing.apply_rule(if asked.csv { rule.ok() } else { Some(rule?) });
        match asked.processing.tare {
            Some(0) => {}
            Some(wanted) => {
                let asked = &asked.processing;
                recording::tare(recording, (channel, wanted), asked, &mut processing)?;
            }
            None => processing.tare = listed.info.tare_for(&processing.view).cloned(),
        }
        let number = match choice {
            FrameChoice::Peak => recording::peak(recording, channel, listed, &mut processing)?,
            FrameChoice::Number(number) => Some(*number),
            FrameChoice::Label(_) | FrameChoice::All | FrameChoice::NoiseReport => None,
        };
        let selection = Self {
            choice: choice.clone(),
            number,
            channel,
            csv: asked.csv,
            heat: asked.heat,
        };
        Ok((selection, processing))
    }

    fn has(&self, frame: &Frame) -> bool {
        match &self.choice {
            FrameChoice::All | FrameChoice::NoiseReport => true,
            FrameChoice::Label(label) => frame.label.as_ref() == Some(label),
            FrameChoice::Number(_) | FrameChoice::Peak => Some(frame.number) == self.number,
        }
    }

    /// Checks what can be checked of the frames to keep before the first of them is answered: that no file that may
    /// not be replaced has the name of an export.
    fn check_kept(
        &self,
        recording: &mut RecordingFile,
        listed: &ListedChannel,
        kept: &Kept,
    ) -> Result<(), CliError> {
        if !kept.is_asked() {
            return Ok(());
        }
        let numbers = match (&self.choice, self.number) {
            (FrameChoice::Label(label), _) => self.numbers_labelled(recording, label)?,
            (_, Some(number)) => number..number + 1,
            _ => 0..listed.frames,
        };
        let export = kept.export.as_ref();
        export.map_or(Ok(()), |export| {
            numbers
                .map(|number| export.numbered(number))
                .try_for_each(|export| check(&export, recording))
        })
    }

    /// Returns the number of the frame with a label, if there is one. A label that several frames have is refused: it
    /// is not clear which of them is meant.
    fn numbers_labelled(
        &self,
        recording: &mut RecordingFile,
        label: &Label,
    ) -> Result<Range<u64>, CliError> {
        let mut numbers = Vec::new();
        recording.frames_again(self.channel, |frame| {
            numbers.extend(self.has(frame).then_some(frame.number));
            Ok::<_, CliError>(match numbers.len() {
                0 | 1 => ControlFlow::Continue(()),
                _ => ControlFlow::Break(()),
            })
        })??;
        match numbers[..] {
            [first, second] => Err(recording.refused(&format!(
                "frames {first} and {second} are both labelled {label}; choose one with --frame"
            ))),
            [number] => Ok(number..number + 1),
            _ => Ok(0..0),
        }
    }

    /// Answers the selected frames; returns true if there were any. The recording is read from its beginning again,
    /// but not beyond a frame whose number is known.
    fn answer(
        &self,
        recording: &mut RecordingFile,
        listed: &ListedChannel,
        processing: &mut Processing,
        output: &mut FramesOutput<'_>,
    ) -> Result<bool, CliError> {
        self.check_kept(recording, listed, &output.kept)?;
        let mut answered = false;
        let name = recording.name().to_owned();
        recording.frames_again(self.channel, |frame| {
            if !self.has(frame) {
                return Ok::<_, CliError>(ControlFlow::Continue(()));
            }
            let processed = processing.run(frame).map_err(|error| CliError::Frames {
                name: name.clone(),
                message: error.to_string() + frame_advice(&error),
            })?;
            let found = FoundFrame {
                name: &name,
                listed,
                frame,
                processed,
            };
            self.give(&found, answered, output)?;
            answered = true;
            Ok(match self.number {
                Some(_) => ControlFlow::Break(()),
                None => ControlFlow::Continue(()),
            })
        })??;
        Ok(answered)
    }

    /// Answers a frame. Notes about it are lines below the matrix; with JSON they go to standard error. An export to
    /// standard output takes the place of the answer. `again` tells whether other frames came before, so that an
    /// empty line separates them.
    fn give(
        &self,
        found: &FoundFrame<'_>,
        again: bool,
        output: &mut FramesOutput<'_>,
    ) -> Result<(), CliError> {
        if self.csv {
            return output.write(found.answer().csv_line());
        }
        let Some((imprint, rule)) = found.processed.imprint.zip(found.processed.rule) else {
            return Ok(());
        };
        let (Form::Json(pitch) | Form::Table(pitch)) = output.form;
        let (pitch, without_pitch) = cell_size(found.name, pitch, &found.listed.info)?;
        let heat = self.heat.then_some(found.processed.tared);
        let titles = titles(found, rule);
        let mut lines = titles.clone();
        if let Form::Table(_) = output.form {
            lines.extend(without_pitch);
            lines.push(report::size(&imprint, None, pitch));
        }
        let drawn = || {
            let mut drawing = drawing(&imprint, None, &titles[0], pitch);
            drawing.heat = heat.cloned();
            drawing
        };
        let shape = |name| stored(name, &imprint, pitch);
        let kept = output.kept.numbered(found.frame.number);
        let instead = kept.keep(drawn, shape, output.shelf, &mut lines)?;
        let text = match (instead, output.form) {
            (Some(content), _) => content,
            (None, Form::Json(_)) => {
                for note in lines.split_off(titles.len()) {
                    (output.notes)(&note);
                }
                found.line(&imprint, output)
            }
            (None, Form::Table(_)) => {
                let gap = if again { "\n" } else { "" };
                let map = heat.map_or_else(String::new, |values| {
                    let unit = unit(&found.listed.info);
                    heat_map(values, &output.charset.line(&unit), output.charset) + "\n"
                });
                let table = report::table(&imprint, &lines, pitch, output.charset);
                let namer = output.namer.as_mut();
                let mut named = namer.map(|namer| namer.text(&imprint, output.charset));
                if let Some(named) = named.as_mut().filter(|named| !named.is_empty()) {
                    named.insert(0, '\n');
                }
                let named = named.as_deref().unwrap_or("");
                [gap, &map, &table, named].concat().into_bytes()
            }
        };
        output.write(&text)
    }
}

/// Returns lines about the frame: `iscan.csv, frame 65 (label 66), 6.5 s`, then sum and maximum, then
/// force and centre, then the threshold.
fn titles(found: &FoundFrame<'_>, rule: SetRule) -> Vec<String> {
    let &FoundFrame {
        name,
        listed,
        frame,
        processed,
    } = found;
    let file = name.rsplit('/').next().unwrap_or(name);
    let mut title = format!("{file}, frame {}", frame.number);
    if let Some(label) = &frame.label {
        title += &format!(" (label {label})");
    }
    if let Some(time) = frame.time {
        title += &format!(", {} s", short(time));
    }
    if let Some(channel) = &listed.info.name {
        title += &format!(", {channel}");
    }
    let unit = unit(&listed.info);
    let max = processed.max.map_or("–".to_owned(), short);
    let mut values = format!(
        "raw sum {}{unit}, raw max {max}{unit}",
        short(processed.sum)
    );
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

/// Returns the threshold in words, with its origin:
/// `active: 20 kPa or more, in pieces of 3 taxels or more (from a flag)`.
fn rule_text(set: SetRule, unit: &str) -> String {
    let mut text = match set.rule {
        Rule::AtLeast(threshold) => format!("active: {}{unit} or more", short(threshold)),
        Rule::Percent(percent) => {
            format!("active: {} % of the largest value or more", short(percent))
        }
        Rule::Hysteresis { low, high } => format!(
            "active: {}{unit} or more, joined to {}{unit} or more",
            short(low),
            short(high)
        ),
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

fn unit(info: &ChannelInfo) -> String {
    let unit = info.unit.as_ref();
    unit.map_or(String::new(), |unit| format!(" {unit}"))
}

/// Returns the side of a cell in mm, and a line if the recording's cells are not square. `--pitch` overrides the
/// recording. The pitch of the settings is not used: it is that of the simulated sensor.
fn cell_size(
    name: &str,
    pitch: Pitch,
    info: &ChannelInfo,
) -> Result<(Option<f64>, Option<String>), CliError> {
    let Some(reason) = info.why_not_in_mm() else {
        return Ok((pitch.given.or(info.square_pitch_mm()), None));
    };
    if pitch.given.is_some() {
        return Err(CliError::Frames {
            name: name.to_owned(),
            message: format!("--pitch: {reason}"),
        });
    }
    Ok((None, Some(reason)))
}

fn stored(name: Name, imprint: &Imprint, pitch: Option<f64>) -> StoredShape {
    let sensor = Sensor::of_size(imprint.size());
    let with_pitch = pitch.and_then(|pitch| sensor.with(Parameter::Pitch, pitch).ok());
    StoredShape {
        name,
        sensor: with_pitch.unwrap_or(sensor),
        imprint: *imprint,
        source: None,
    }
}
