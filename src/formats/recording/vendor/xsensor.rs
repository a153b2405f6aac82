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
//! between clock times, even past midnight, or between times in seconds. `Threshold` is the least value that
//! XSENSOR's own software counts as touched, so it is the threshold of the recording. Averages and areas are ignored:
//! they follow from the values. Source: an export of XSENSOR's software of 2022.

use std::io::BufRead;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ChannelInfo, EarlyEnd, RecordingEvent, Sink};
use crate::formats::recording::length::LengthUnit;
use crate::formats::recording::side::stated;
use crate::formats::recording::text::lines::{TextLines, text};
use crate::formats::recording::text::number;
use crate::formats::recording::text::number::whole;
use crate::formats::recording::text::row::{self, Field};
use crate::formats::recording::text::separator::{Separator, decimal};
use crate::formats::recording::time::moment;
use crate::formats::seconds::since;
use crate::frame::{Frame, FrameSize};
use crate::parameter::number::counted;

/// The most sensors in a file; each has a name of its own.
const MOST_SENSORS: usize = 64;

/// The most bytes of a line with a key.
const LONGEST_KEY: usize = 1 << 12;

/// A sensor and the number of its frames so far.
struct XsensorChannel {
    /// The name from `SENSOR`; None if there is no such line.
    name: Option<String>,
    /// The number of frames so far, which is the number of the next one.
    frames: u64,
}

/// The block of lines that is being read.
#[derive(Default)]
enum XsensorBlock {
    /// The file or a frame.
    #[default]
    Other,
    /// A sensor, with its name.
    Sensor(Option<String>),
    /// A part of a sensor.
    Group,
}

/// The state of the reader: the values of the current frame and sensor.
#[derive(Default)]
struct XsensorState {
    /// `Units`, for all sensors.
    unit: Option<String>,
    /// `Threshold`, in that unit.
    threshold: Option<f64>,
    /// `FRAME`: the frame's label in the recording.
    label: Option<i64>,
    /// The number of sensors read in the current frame.
    sensors: usize,
    /// The number of sensors in the previous frame.
    expected: usize,
    /// `Date` of the frame, such as `2022 Aug 16`.
    date: Option<String>,
    /// `Time` of the frame, such as `08:21:17.982`, or `1.25` in seconds.
    clock: Option<String>,
    /// The time of the first frame: the day, and the seconds of the day.
    start: Option<(i32, f64)>,
    /// The block that is being read.
    block: XsensorBlock,
    /// `Rows` of the current sensor.
    rows: Option<u16>,
    /// `Columns` of the current sensor.
    columns: Option<u16>,
    /// `Sensel Width`: the pitch along x.
    width_mm: Option<f64>,
    /// `Sensel Height`: the pitch along y.
    height_mm: Option<f64>,
    /// The sensors in the order of their first frames.
    channels: Vec<XsensorChannel>,
}

/// Reads a recording.
pub(in crate::formats::recording) fn read(
    input: impl BufRead,
    sink: &mut Sink<'_>,
) -> Result<(), EarlyEnd> {
    let mut lines = TextLines::new(input);
    let mut state = XsensorState::default();
    let mut frame = Frame::default();
    while lines.advance_to_content()? {
        let (key, value) = pair(lines.line());
        match key.as_str() {
            "SENSELS" => {
                let XsensorBlock::Sensor(name) = std::mem::take(&mut state.block) else {
                    continue;
                };
                state.matrix(&mut lines, &mut frame)?;
                state.give(name, &mut frame, sink, lines.number())?;
            }
            _ => state.line(&key, &value, lines.number())?,
        }
    }
    // Only the cells end the block, so if a sensor is still open, its cells are missing.
    let message = match state.block {
        XsensorBlock::Sensor(_) => "ends inside a SENSOR block, expected SENSELS",
        _ if state.sensors < state.expected => "ends inside a FRAME, expected SENSOR",
        _ => return Ok(()),
    };
    Err(RecordingError::in_line(lines.number() + 1, message).into())
}

/// Returns the key of a line in capital letters, without the colon after it, and its value.
fn pair(line: &[u8]) -> (String, String) {
    let mut fields = Separator::Byte(b',').split(line);
    let mut next = || fields.next().map_or_else(String::new, text);
    let key = next();
    let key = key.trim_end_matches(':').trim_end().to_uppercase();
    (key, next())
}

/// Returns true if the first lines of a text are those of an export: they name a frame, and then the cells of a
/// sensor.
pub(in crate::formats::recording) fn is_export(start: &[u8]) -> bool {
    let mut lines = start.split(|&byte| byte == b'\n');
    let mut has = |key: &str| lines.any(|line| line.len() < LONGEST_KEY && pair(line).0 == key);
    has("FRAME") && has("SENSELS")
}

/// Returns the unit of length after a key, as in `SENSEL WIDTH (CM)`; None for an unknown unit.
fn length_unit(key: &str) -> Option<LengthUnit> {
    LengthUnit::of_name(key.split_once('(')?.1.trim_end_matches(')'))
}

impl XsensorState {
    /// Reads a line `key,value`.
    ///
    /// # Errors
    /// Returns an error if a frame cannot have these rows or columns.
    fn line(&mut self, key: &str, value: &str, number: u64) -> Result<(), RecordingError> {
        let number_of = || match decimal(value.as_bytes()) {
            Field::Value(value) => Some(value),
            _ => None,
        };
        let length = || length_unit(key)?.pitch_in_mm(number_of()?);
        let side = || stated(key, ' ', value, number);
        match key {
            "UNITS" => self.unit = Some(value.to_owned()),
            "THRESHOLD" => self.threshold = number_of(),
            "FRAME" => {
                self.label = value.parse().ok();
                (self.expected, self.sensors) = (self.sensors.max(1), 0);
                self.block = XsensorBlock::Other;
            }
            "DATE" => self.date = Some(value.to_owned()),
            "TIME" => self.clock = Some(value.to_owned()),
            "SENSOR" => {
                self.block = XsensorBlock::Sensor(Some(value.to_owned()));
                (self.rows, self.columns) = (None, None);
                (self.width_mm, self.height_mm) = (None, None);
            }
            "GROUP" => self.block = XsensorBlock::Group,
            "ROWS" | "COLUMNS" if matches!(self.block, XsensorBlock::Group) => {}
            "ROWS" | "COLUMNS" => {
                if matches!(self.block, XsensorBlock::Other) {
                    self.block = XsensorBlock::Sensor(None);
                }
                let side = Some(side()?);
                *(if key == "ROWS" {
                    &mut self.rows
                } else {
                    &mut self.columns
                }) = side;
            }
            _ if key.starts_with("SENSEL WIDTH") => self.width_mm = length(),
            _ if key.starts_with("SENSEL HEIGHT") => self.height_mm = length(),
            _ => {}
        }
        Ok(())
    }

    /// Returns the size of this sensor's frames; None before both its lines were read.
    fn size(&self) -> Option<FrameSize> {
        FrameSize::of_sides(self.columns, self.rows)
    }

    /// Reads the rows below `SENSELS`.
    ///
    /// # Errors
    /// Returns an error if rows or columns were not given before, or if the rows end too early or have another
    /// length.
    fn matrix(
        &self,
        lines: &mut TextLines<impl BufRead>,
        frame: &mut Frame,
    ) -> Result<(), RecordingError> {
        let Some(size) = self.size() else {
            let message = "SENSELS of a sensor without Rows and Columns";
            return Err(RecordingError::in_line(lines.number(), message));
        };
        frame.reset(size);
        for row in frame.values_mut().chunks_mut(size.columns().into()) {
            if !lines.advance_to_content()? {
                let rows = counted(size.rows(), "row");
                let message = format!("ends inside a frame, expected {rows}");
                return Err(RecordingError::in_line(lines.number() + 1, message));
            }
            let fields = Separator::Byte(b',').split(lines.line());
            row::fill(row, fields, lines.number(), decimal)?;
        }
        Ok(())
    }

    /// Reports the frame, and before its first one the channel.
    ///
    /// # Errors
    /// Returns an error if there are more sensors than any file has: names that change with every frame would fill
    /// the memory.
    fn give(
        &mut self,
        name: Option<String>,
        frame: &mut Frame,
        sink: &mut Sink<'_>,
        line: u64,
    ) -> Result<(), EarlyEnd> {
        let moment = self.moment();
        let start = self.start.or(moment);
        self.start = start;
        let known = self.channels.iter().position(|own| own.name == name);
        let channel = match known {
            Some(channel) => channel,
            None if self.channels.len() == MOST_SENSORS => {
                let message = format!("more than {MOST_SENSORS} sensors");
                return Err(RecordingError::in_line(line, message).into());
            }
            None => {
                let info = ChannelInfo {
                    name: name.clone(),
                    size: self.size(),
                    values: None,
                    unit: self.unit.clone(),
                    start: self.beginning(),
                    seconds_per_frame: None,
                    pitch_mm: self.width_mm.zip(self.height_mm).map(|(x, y)| [x, y]),
                    threshold: self.threshold,
                    ..ChannelInfo::default()
                };
                self.channels.push(XsensorChannel { name, frames: 0 });
                sink(RecordingEvent::Channel(&info))?;
                self.channels.len() - 1
            }
        };
        frame.channel = channel;
        frame.number = self.channels[channel].frames;
        self.channels[channel].frames += 1;
        frame.label = self.label;
        frame.time = moment
            .zip(start)
            .map(|((day, seconds), (first_day, first_seconds))| {
                let days = f64::from(day - first_day) * 86_400.0;
                since(first_seconds, days + seconds)
            });
        self.sensors += 1;
        sink(RecordingEvent::Frame(frame))
    }

    /// Returns the time of the frame as it is written; only the day, if the time is in seconds.
    fn beginning(&self) -> Option<String> {
        let (date, clock) = self.date.as_ref().zip(self.clock.as_ref())?;
        Some(if clock.contains(':') {
            format!("{date} {clock}")
        } else {
            date.clone()
        })
    }

    /// Returns the time of the frame: the day, and the seconds of the day. None if the clock is neither three numbers
    /// nor a number of seconds, or if they are too large; a date that cannot be read counts as the same day.
    fn moment(&self) -> Option<(i32, f64)> {
        let (clock, half) = moment::half_day(self.clock.as_ref()?);
        let parts = clock.split(':');
        let parts: Option<Vec<f64>> = parts
            .map(|part| number::read(part.trim().as_bytes()))
            .collect();
        let date = self.date.as_ref();
        let day = date.and_then(|date| days(date)).unwrap_or(1);
        let (day, seconds) = match parts?[..] {
            [hours, minutes, seconds] => {
                let hours = match half.zip(whole(hours)) {
                    None => hours,
                    Some((half, shown)) => half.hours(i32::try_from(shown).ok()?)?.into(),
                };
                (day, hours * 3600.0 + minutes * 60.0 + seconds)
            }
            // Seconds count from the start of the recording, not from midnight.
            [seconds] => (1, seconds),
            _ => return None,
        };
        seconds.is_finite().then_some((day, seconds))
    }
}

/// Returns the number of a day such as `2022 Aug 16`.
fn days(date: &str) -> Option<i32> {
    /// The first three letters of each month, so that full names match, too.
    const MONTHS: [&str; 12] = [
        "jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec",
    ];
    let mut words = date.split_whitespace();
    let number = |word: Option<&str>, most: i32| {
        let number = word?.parse().ok()?;
        (1..=most).contains(&number).then_some(number)
    };
    let year = number(words.next(), 9999)?;
    let name = words.next()?.to_ascii_lowercase();
    let mut months = (1..).zip(MONTHS);
    let (month, _) = months.find(|(_, start)| name.starts_with(start))?;
    let day = number(words.next(), 31)?;
    Some(moment::day(year, month, day))
}

#[cfg(test)]
mod tests {
    use super::days;

    #[test]
    fn months_are_words() {
        assert_eq!(days("2022 Aug 31").map(|day| day + 1), days("2022 Sep 1"));
        assert_eq!(
            days("2021 Dec 31").map(|day| day + 1),
            days("2022 January 1")
        );
        assert_eq!(days("16.8.2022"), None);
    }
}
