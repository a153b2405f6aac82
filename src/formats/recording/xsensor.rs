//! XSENSOR's CSV export: frames of one or several sensors, each a block of its own; groups of cells are passed over.
//!
//! Lines are padded with commas, and every second one has nothing else. A sensor's name is its channel. `GROUP` blocks
//! list the cells of a part of a sensor, which are in the sensor's matrix already.
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
//! Time is the difference of the clocks in seconds, also past midnight. `Threshold` is the value from which on
//! XSENSOR's own software counts a cell as touched, so it is that of the recording. Averages and areas are passed over:
//! they follow from the values. Source: an export of XSENSOR's software of 2022.

use std::io::BufRead;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ChannelInfo, RecordingEvent, Sink};
use crate::formats::recording::lines::{TextLines, text, unpadded};
use crate::formats::recording::number;
use crate::formats::recording::separator::Separator;
use crate::formats::recording::side::stated;
use crate::formats::recording::text_row;
use crate::frame::Frame;
use crate::parameter::number::{counted, to_decimals};

/// No file has more sensors: each has a name of its own.
const MOST_CHANNELS: usize = 64;

/// A sensor's frames so far.
struct XsensorChannel {
    /// What `SENSOR` names.
    name: String,
    /// How many there are; the number of the next one.
    frames: u64,
}

/// What is known of the frame and of the sensor that are being read.
#[derive(Default)]
struct XsensorState {
    /// `Units`, of all sensors.
    unit: Option<String>,
    /// `Threshold`, in that unit.
    threshold: Option<f64>,
    /// `FRAME`: what the recording calls the frame.
    label: Option<i64>,
    /// `Date` of the frame, such as `2022 Aug 16`.
    date: Option<String>,
    /// `Time` of the frame, such as `08:21:17.982`.
    clock: Option<String>,
    /// The first moment: day, and seconds of the day.
    start: Option<(i32, f64)>,
    /// The sensor whose block this is; none outside of one.
    sensor: Option<String>,
    /// `Rows` of this sensor.
    rows: Option<u16>,
    /// `Columns` of this sensor.
    columns: Option<u16>,
    /// `Sensel Width`: the pitch along x.
    width_cm: Option<f64>,
    /// `Sensel Height`: the pitch along y.
    height_cm: Option<f64>,
    /// The sensors in the order in which they first came.
    channels: Vec<XsensorChannel>,
}

/// Reads a recording.
pub(super) fn read(input: impl BufRead, sink: &mut Sink<'_>) -> Result<(), RecordingError> {
    let mut lines = TextLines::new(input);
    let mut state = XsensorState::default();
    let mut frame = Frame::new(1, 1);
    while lines.advance_to_content()? {
        let (key, value) = pair(lines.line());
        match key.as_str() {
            "SENSELS" if state.sensor.is_some() => {
                state.matrix(&mut lines, &mut frame)?;
                let name = state.sensor.take().unwrap_or(key);
                if state.give(name, &mut frame, sink, lines.number())? {
                    return Ok(());
                }
            }
            _ => state.line(&key, &value, lines.number())?,
        }
    }
    // Only the cells end the block, so a sensor that is still open has lost them.
    if state.sensor.is_some() {
        let message = "ends inside a SENSOR block, expected SENSELS";
        return Err(RecordingError::in_line(lines.number() + 1, message));
    }
    Ok(())
}

/// The two first fields of a line; a field in quotes may have commas.
fn pair(line: &[u8]) -> (String, String) {
    let line = text(unpadded(line));
    let (key, value) = line.split_once(',').unwrap_or((&line, ""));
    let value = value.trim();
    let value = match value.strip_prefix('"') {
        Some(quoted) => quoted.split('"').next().unwrap_or(quoted),
        None => value.split(',').next().unwrap_or(value),
    };
    (key.trim().to_owned(), value.trim().to_owned())
}

impl XsensorState {
    /// Takes what a line `key,value` says.
    ///
    /// # Errors
    /// If rows or columns are none that a frame can have.
    fn line(&mut self, key: &str, value: &str, number: u64) -> Result<(), RecordingError> {
        let positive = || number::read(value.as_bytes()).filter(|&value| value > 0.0);
        let side = || stated(key, ' ', value, number);
        match key {
            "Units:" | "Units" => self.unit = Some(value.to_owned()),
            "Threshold:" | "Threshold" => self.threshold = number::read(value.as_bytes()),
            "FRAME" => {
                self.label = value.parse().ok();
                self.sensor = None;
            }
            "Date" => self.date = Some(value.to_owned()),
            "Time" => self.clock = Some(value.to_owned()),
            "SENSOR" => {
                self.sensor = Some(value.to_owned());
                (self.rows, self.columns) = (None, None);
                (self.width_cm, self.height_cm) = (None, None);
            }
            "GROUP" => self.sensor = None,
            "Rows" if self.sensor.is_some() => self.rows = Some(side()?),
            "Columns" if self.sensor.is_some() => self.columns = Some(side()?),
            "Sensel Width (cm)" => self.width_cm = positive(),
            "Sensel Height (cm)" => self.height_cm = positive(),
            _ => {}
        }
        Ok(())
    }

    /// Reads the rows below `SENSELS`.
    ///
    /// # Errors
    /// If rows or columns were not named before, or the rows end too early or have another length.
    fn matrix(
        &self,
        lines: &mut TextLines<impl BufRead>,
        frame: &mut Frame,
    ) -> Result<(), RecordingError> {
        let (Some(rows), Some(columns)) = (self.rows, self.columns) else {
            let message = "SENSELS of a sensor without Rows and Columns";
            return Err(RecordingError::in_line(lines.number(), message));
        };
        frame.reset(columns, rows);
        for row in frame.values_mut().chunks_mut(columns.into()) {
            if !lines.advance_to_content()? {
                let message = format!("ends inside a frame, expected {}", counted(rows, "row"));
                return Err(RecordingError::in_line(lines.number() + 1, message));
            }
            let (line, number) = (lines.line(), lines.number());
            let fields = Separator::Byte(b',').split(line);
            text_row::fill(row, fields, number, text_row::value)?;
        }
        Ok(())
    }

    /// Gives the frame, and its channel before the first one; true if no more is wanted.
    ///
    /// # Errors
    /// If there are more sensors than any file has: names that change from frame to frame would fill the memory.
    fn give(
        &mut self,
        name: String,
        frame: &mut Frame,
        sink: &mut Sink<'_>,
        line: u64,
    ) -> Result<bool, RecordingError> {
        let moment = self.moment();
        let start = self.start.or(moment);
        self.start = start;
        let known = self.channels.iter().position(|own| own.name == name);
        let channel = match known {
            Some(channel) => channel,
            None if self.channels.len() == MOST_CHANNELS => {
                let message = format!("more than {MOST_CHANNELS} sensors");
                return Err(RecordingError::in_line(line, message));
            }
            None => {
                let info = ChannelInfo {
                    name: Some(name.clone()),
                    shape: self.rows.zip(self.columns),
                    values: None,
                    unit: self.unit.clone(),
                    start: self
                        .date
                        .clone()
                        .zip(self.clock.clone())
                        .map(|(date, clock)| format!("{date} {clock}")),
                    seconds_per_frame: None,
                    pitch_mm: self
                        .width_cm
                        .zip(self.height_cm)
                        .map(|(x, y)| [x * 10.0, y * 10.0]),
                    threshold: self.threshold,
                    ..ChannelInfo::default()
                };
                self.channels.push(XsensorChannel { name, frames: 0 });
                if sink(RecordingEvent::Channel(&info)).is_break() {
                    return Ok(true);
                }
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
                // Both clocks tell thousandths.
                to_decimals(
                    f64::from(day - first_day) * 86_400.0 + seconds - first_seconds,
                    3,
                )
            });
        Ok(sink(RecordingEvent::Frame(frame)).is_break())
    }

    /// The moment of the frame: day, and seconds of the day.
    /// None if the clock is not three numbers; a date that cannot be read counts as the same day.
    fn moment(&self) -> Option<(i32, f64)> {
        let mut parts = self.clock.as_ref()?.split(':');
        let mut part = || number::read(parts.next()?.trim().as_bytes());
        let (hours, minutes, seconds) = (part()?, part()?, part()?);
        let date = self.date.as_ref();
        let day = date.and_then(|date| days(date)).unwrap_or(1);
        Some((day, hours * 3600.0 + minutes * 60.0 + seconds))
    }
}

/// The number of a day such as `2022 Aug 16`, from an arbitrary one on.
fn days(date: &str) -> Option<i32> {
    /// The first three letters, so that full names do, too.
    const MONTHS: [&str; 12] = [
        "jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec",
    ];
    let mut words = date.split_whitespace();
    let year: i32 = words
        .next()?
        .parse()
        .ok()
        .filter(|year| (1..=9999).contains(year))?;
    let month = words.next()?.to_ascii_lowercase();
    let month = (0..)
        .zip(MONTHS)
        .find(|(_, name)| month.starts_with(name))?
        .0;
    let day: i32 = words
        .next()?
        .parse()
        .ok()
        .filter(|day| (1..=31).contains(day))?;
    // Years that begin in March have the leap day at their end.
    let (year, month) = if month < 2 {
        (year - 1, month + 10)
    } else {
        (year, month - 2)
    };
    Some(year * 365 + year / 4 - year / 100 + year / 400 + (month * 153 + 2) / 5 + day)
}

#[cfg(test)]
mod tests {
    use super::days;

    #[test]
    fn days_follow_each_other() {
        let pairs = [
            ("2022 Aug 31", "2022 Sep 1"),
            ("2021 Dec 31", "2022 January 1"),
            ("2024 Feb 28", "2024 Feb 29"),
            ("2023 Feb 28", "2023 Mar 1"),
        ];
        for (day, next) in pairs {
            assert_eq!(days(day).map(|day| day + 1), days(next), "{day}");
        }
        assert_eq!(days("16.8.2022"), None);
    }
}
