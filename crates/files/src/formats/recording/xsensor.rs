//! XSENSOR's CSV export: frames of one or several sensors, each in a block of its own; groups of cells are skipped.
//!
//! Lines may be padded with commas, and every second line may consist of nothing else. The name of a sensor is that
//! of its channel. `GROUP` blocks list the cells of a part of a sensor, which are also in the sensor's matrix.
//! ```text
//! Units:,mmHg,,,,
//! ,,,,,
//! Threshold:,51.72,,,,
//! FRAME,1464,,,,
//! Date, 2022 Aug 16,,,,
//! Time, 08:21:17.982,,,,
//! SENSOR,HX210.11.31.M11-DFM-LF S0073,,,,
//! Rows,31,,,,
//! Columns,11,,,,
//! Sensel Width (cm),0.86,,,,
//! Sensel Height (cm),0.86,,,,
//! SENSELS,,,,,
//! 0,0,57.9,…
//! ```
//! Versions of the software differ in how they write a key (`FRAME`, `Frame:`), in quotes around fields, and in units
//! (`Sensel Width (mm)`); a comma within a field may be the decimal sign. The time of a frame is the difference
//! between clock times, or between times in seconds; a clock that falls by more than half a day has passed midnight.
//! `Threshold` is the least value that XSENSOR's own software counts as touched, so it is the threshold of the
//! recording. Averages and areas are ignored: they follow from the values.
//! Source: an export of XSENSOR's software of 2022.

use std::io::BufRead;

use taxel_core::frame::{Frame, FrameSize, Label};
use taxel_core::parameter::number::counted;

use crate::error::ReadError;
use crate::formats::recording::error::in_line;
use crate::formats::recording::event::{ChannelInfo, Sink, Stop};
use crate::formats::recording::size::{pitch_in_mm, stated};
use crate::formats::recording::text::{self, Separator, TextLines, decimal, read_number, text};
use crate::formats::recording::time::{FrameClock, Time, read_moment};

#[derive(Default, PartialEq)]
enum Block {
    #[default]
    Other,
    Sensor(Option<String>),
    /// A list of the cells of a part of a sensor.
    Group,
}

/// The state of the reader: the keys of the current frame and sensor.
#[derive(Default)]
struct XsensorState {
    /// What a channel is described by; the size is that of the current sensor.
    info: ChannelInfo,
    label: Option<Label>,
    /// The number of sensors in this frame and in the one before.
    sensors: [usize; 2],
    /// `Date` of the frame, such as `2022 Aug 16`.
    date: Option<String>,
    /// `Time` of the frame, such as `08:21:17.982`, or `1.25` in seconds.
    clock: Option<String>,
    time: Option<f64>,
    times: FrameClock,
    block: Block,
    /// `Columns` and `Rows`.
    sides: [Option<u16>; 2],
    /// `Sensel Width` and `Sensel Height` in mm.
    pitches: [Option<f64>; 2],
}

pub(crate) fn read(input: &mut dyn BufRead, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let mut lines = TextLines::new(input);
    let mut state = XsensorState::default();
    let mut frame = Frame::default();
    let mut more = lines.advance_to_content()?;
    while more {
        let (key, value) = pair(lines.line());
        match state.block {
            Block::Sensor(_) if key == "SENSELS" => {
                state.matrix(&mut lines, &mut frame)?;
                // A row too many shows that `Rows` is wrong, so the frame is not reported before the line below it is
                // read.
                let next = lines.advance_to_content();
                if matches!(next, Ok(true)) && is_value(&pair(lines.line()).0) {
                    let rows = counted(frame.rows(), "row");
                    let message = format!("more values, expected {rows} of them as Rows says");
                    return Err(in_line(lines.number, message).into());
                }
                state.give(&mut frame, sink)?;
                more = next?;
                continue;
            }
            _ => state.line(&key, &value, lines.number)?,
        }
        more = lines.advance_to_content()?;
    }
    let [sensors, before] = state.sensors;
    let message = match state.block {
        // Only the cells end this block, so they are missing.
        Block::Sensor(_) => "ends inside a SENSOR block, expected SENSELS",
        _ if sensors < before => "ends inside a FRAME, expected SENSOR",
        _ => return Ok(()),
    };
    Err(in_line(lines.number + 1, message).into())
}

fn is_value(field: &str) -> bool {
    decimal(field.as_bytes()).is_some()
}

/// Returns the key of a line in capital letters, without the colon after it, and its value.
fn pair(line: &[u8]) -> (String, String) {
    let mut fields = Separator::Byte(b',').split(line);
    let mut next = || fields.next().map_or_else(String::new, text);
    let key = next();
    let key = key.trim_end_matches(':').trim_end().to_uppercase();
    (key, next())
}

/// Whether a line has one of the keys that the first lines of an export have: `FRAME`, and then `SENSELS`.
pub(crate) fn has_key(line: &[u8], key: &str) -> bool {
    line.len() < 1 << 12 && pair(line).0 == key
}

impl XsensorState {
    /// Reads a line `key,value`.
    fn line(&mut self, key: &str, value: &str, number: u64) -> Result<(), ReadError> {
        let number_of = || decimal(value.as_bytes());
        // The unit is part of the key: `SENSEL WIDTH (CM)`.
        let length = || {
            let unit = key.split_once('(')?.1.trim_end_matches(')');
            pitch_in_mm(number_of()?, unit)
        };
        match key {
            "UNITS" => self.info.unit = Some(value.to_owned()),
            "THRESHOLD" => self.info.threshold = number_of(),
            "FRAME" => {
                self.label = value.parse().ok().map(Label::Number);
                self.sensors = [0, self.sensors[0].max(1)];
                self.block = Block::Other;
            }
            "DATE" => self.date = Some(value.to_owned()),
            "TIME" => self.clock = Some(value.to_owned()),
            "SENSOR" => {
                self.block = Block::Sensor(Some(value.to_owned()));
                (self.sides, self.pitches) = ([None; 2], [None; 2]);
            }
            "GROUP" => self.block = Block::Group,
            "ROWS" | "COLUMNS" if self.block != Block::Group => {
                // A single sensor may have no name.
                if self.block == Block::Other {
                    self.block = Block::Sensor(None);
                }
                self.sides[usize::from(key == "ROWS")] = Some(stated(key, ' ', value, number)?);
            }
            _ if key.starts_with("SENSEL WIDTH") => self.pitches[0] = length(),
            _ if key.starts_with("SENSEL HEIGHT") => self.pitches[1] = length(),
            _ => {}
        }
        Ok(())
    }

    /// Reads the rows below `SENSELS`.
    fn matrix<R: BufRead>(
        &mut self,
        lines: &mut TextLines<R>,
        frame: &mut Frame,
    ) -> Result<(), ReadError> {
        let Some(size) = FrameSize::of_sides(self.sides[0], self.sides[1]) else {
            let message = "SENSELS of a sensor without Rows and Columns";
            return Err(in_line(lines.number, message));
        };
        self.info.size = Some(size);
        frame.reset(size);
        for row in frame.values_mut().chunks_mut(size.columns().into()) {
            if !lines.advance_to_content()? {
                let rows = counted(size.rows(), "row");
                let message = format!("ends inside a frame, expected {rows}");
                return Err(in_line(lines.number + 1, message));
            }
            let fields = Separator::Byte(b',').split(lines.line());
            text::fill_row(row, fields, lines.number, decimal)?;
        }
        Ok(())
    }

    /// Reports the frame of a sensor.
    fn give(&mut self, frame: &mut Frame, sink: &mut Sink<'_>) -> Result<(), Stop> {
        let name = match std::mem::take(&mut self.block) {
            Block::Sensor(name) => name,
            _ => None,
        };
        if self.sensors[0] == 0 {
            self.time = self.seconds();
        }
        let [x, y] = self.pitches;
        self.info.pitch_mm = x.zip(y).map(|(x, y)| [x, y]);
        let clock = self.clock.as_ref().zip(self.date.as_ref());
        self.info.start = clock.map(|(clock, date)| {
            let clock = Some(clock).filter(|clock| clock.contains(':'));
            clock.map_or(date.clone(), |clock| format!("{date} {clock}"))
        });
        let channel = sink.channel(name.as_deref(), || self.info.clone())?;
        (frame.label, frame.time) = (self.label.clone(), self.time);
        self.sensors[0] += 1;
        sink.frame(channel, frame)
    }

    /// The time of the frame in seconds since the first one; None if the clock is neither a time of day nor a number
    /// of seconds.
    fn seconds(&mut self) -> Option<f64> {
        let clock = self.clock.as_ref()?;
        if let Some(seconds) = read_number(clock.as_bytes()) {
            return Some(self.times.since_first(Time::Seconds(seconds)));
        }
        let time = self.times.moment(read_moment(clock.as_bytes())?);
        Some(self.times.since_first(time))
    }
}
