//! The list of a recording: its channels, each with what the recording states about it. A line is left out if the recording
//! does not state it.

use std::fmt;

use serde::ser::{Serialize, SerializeMap, Serializer};
use taxel_core::frame::{Frame, FrameSize, Label, Peak, View};
use taxel_core::parameter::number::short;
use taxel_files::formats::json;
use taxel_files::formats::recording::{ChannelInfo, Format};
use taxel_files::formats::value::{counted, decimal};

use crate::cli::output::charset::Charset;

#[derive(Debug, Default)]
pub(crate) struct ListedChannel {
    pub(crate) info: ChannelInfo,
    /// The size of the visible part of its frames, after the crop.
    seen: Option<FrameSize>,
    pub(crate) frames: u64,
    pub(crate) peak: Peak,
    pub(crate) values: u64,
    cells: usize,
    /// The least and the greatest label of its frames; None if they have no labels.
    pub(crate) labels: Option<(Label, Label)>,
    /// The times of its frames; None if they have no times.
    times: Option<FrameTimes>,
    marked: Vec<u64>,
}

/// The times at which frames were taken, in seconds.
#[derive(Clone, Copy, Debug)]
struct FrameTimes {
    first: f64,
    last: f64,
    /// The first frame that is earlier than the one before it: a clock was set back, or the column is not a time.
    backwards: Option<u64>,
}

impl FrameTimes {
    fn with(self, number: u64, time: f64) -> Self {
        Self {
            last: time,
            backwards: self.backwards.or((time < self.last).then_some(number)),
            ..self
        }
    }
}

impl fmt::Display for FrameTimes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, last] = [self.first, self.last].map(|time| decimal(time, 9));
        write!(f, "{first} to {last} s")?;
        match self.backwards {
            Some(number) => write!(f, ", goes back at frame {number}"),
            None => Ok(()),
        }
    }
}

impl ListedChannel {
    pub(crate) fn new(info: &ChannelInfo, view: &View) -> Self {
        Self {
            info: info.clone(),
            seen: info.size.map(|size| view.size(size).unwrap_or(size)),
            ..Self::default()
        }
    }

    pub(crate) fn add(&mut self, frame: &Frame, values: &[f64]) {
        let present = values.iter().filter(|value| !value.is_nan());
        let cells = present.clone().count();
        self.cells = self.cells.max(cells);
        if cells > 0 {
            self.peak.add(frame.number, Some(present.sum()));
        }
        if let Some(time) = frame.time {
            let begun = self.times.unwrap_or(FrameTimes {
                first: time,
                last: time,
                backwards: None,
            });
            self.times = Some(begun.with(frame.number, time));
        }
        if let Some(label) = &frame.label {
            let first = || (label.clone(), label.clone());
            let (least, greatest) = self.labels.get_or_insert_with(first);
            if label < least {
                least.clone_from(label);
            }
            if label > greatest {
                greatest.clone_from(label);
            }
        }
        let number = frame.label.as_ref().and_then(Label::number);
        let number = number.and_then(|number| u64::try_from(number).ok());
        let mut marks = self.info.marks.iter().map(|mark| mark.number);
        if marks.any(|mark| Some(mark) == number) {
            self.marked.push(frame.number);
        }
        self.frames += 1;
        self.values = self.info.values.unwrap_or(frame.values().len() as u64);
    }
}

impl Serialize for ListedChannel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let info = &self.info;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("name", &info.name)?;
        map.serialize_entry("frames", &self.frames)?;
        map.serialize_entry("rows", &self.seen.map(FrameSize::rows))?;
        map.serialize_entry("columns", &self.seen.map(FrameSize::columns))?;
        map.serialize_entry("cells", &self.cells)?;
        map.serialize_entry("unit", &info.unit)?;
        map.serialize_entry("start", &info.start)?;
        map.serialize_entry("seconds_per_frame", &info.seconds_per_frame)?;
        map.serialize_entry("pitch_mm", &info.pitch_mm)?;
        map.serialize_entry("threshold", &info.threshold)?;
        map.serialize_entry("peak", &self.peak.number())?;
        if !self.marked.is_empty() {
            map.serialize_entry("marks", &self.marked)?;
        }
        map.end()
    }
}

/// The recording as a JSON object; `format` is null if a damage comes before the format is certain.
struct ListedRecording<'a>(Option<&'static Format>, &'a [ListedChannel], &'a [String]);

impl Serialize for ListedRecording<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("format", &self.0.map(|format| format.name))?;
        map.serialize_entry("channels", self.1)?;
        if !self.2.is_empty() {
            map.serialize_entry("notes", self.2)?;
        }
        map.end()
    }
}

/// `notes` say how the recording is read.
pub(crate) fn json(
    format: Option<&'static Format>,
    channels: &[ListedChannel],
    notes: &[String],
) -> String {
    json::ascii(&ListedRecording(format, channels, notes)) + "\n"
}

pub(crate) fn text(
    format: Option<&'static Format>,
    channels: &[ListedChannel],
    notes: &[String],
    charset: Charset,
) -> String {
    let format = format.map_or("damaged", |format| format.name);
    let count = counted(channels.len() as u64, "channel");
    let mut lines = vec![format!("{format}, {count}")];
    lines.extend_from_slice(notes);
    for channel in channels {
        lines.push(String::new());
        lines.extend(channel_lines(channel));
    }
    lines
        .iter()
        .map(|line| charset.line(line).into_owned() + "\n")
        .collect()
}

fn size(channel: &ListedChannel) -> String {
    let Some(seen) = channel.seen else {
        let values = counted(channel.values, "value");
        return format!("{values} a frame; give --rows and --columns");
    };
    let whole = channel.info.size.filter(|whole| *whole != seen);
    let whole = whole.map_or(String::new(), |whole| {
        format!(" of {} × {}", whole.rows(), whole.columns())
    });
    let cells = counted(channel.cells as u64, "cell");
    let (rows, columns) = (
        counted(seen.rows(), "row"),
        counted(seen.columns(), "column"),
    );
    format!("{rows} × {columns}{whole}, {cells}")
}

fn channel_lines(channel: &ListedChannel) -> Vec<String> {
    let info = &channel.info;
    let row = |name: &str, value: Option<String>| value.map(|value| format!("{name:<10}{value}"));
    let pitch = info.pitch_mm.map(|[x, y]| match info.square_pitch_mm() {
        Some(side) => format!("{} mm", short(side)),
        None => format!("{} mm across, {} mm down", short(x), short(y)),
    });
    let marks = channel.marked.iter().map(u64::to_string);
    let marks = (!channel.marked.is_empty()).then(|| marks.collect::<Vec<_>>().join(", "));
    let unit = info.unit.clone();
    let in_unit = |value: f64| match &unit {
        Some(unit) => format!("{} {unit}", short(value)),
        None => short(value),
    };
    [
        row("channel", info.name.clone()),
        row("frames", Some(channel.frames.to_string())),
        row("size", Some(size(channel))),
        row("unit", info.unit.clone()),
        row("start", info.start.clone()),
        row("time", channel.times.map(|times| times.to_string())),
        row(
            "step",
            info.seconds_per_frame
                .map(|seconds| format!("{} s", decimal(seconds, 6))),
        ),
        row("pitch", pitch),
        row("threshold", info.threshold.map(in_unit)),
        row("marks", marks),
        row(
            "peak",
            channel
                .peak
                .number()
                .map(|number| format!("frame {number}")),
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}
