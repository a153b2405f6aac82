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
//! between dates and clock times, or between times in seconds. Of a date such as `8/9/2022`, day and month are in the
//! order in which less time has passed since the first frame. Without dates, or with others that cannot be read, a
//! clock that falls by more than half a day has passed midnight. `Threshold` is the least value that XSENSOR's own
//! software counts as touched, so it is the threshold of the recording. Averages and areas are ignored: they follow
//! from the values. Source: an export of XSENSOR's software of 2022.

use crate::formats::recording::error::in_line;
use std::io::BufRead;

use taxel_core::frame::{Frame, FrameSize};
use taxel_core::parameter::number::counted;

use crate::error::ReadError;
use crate::formats::recording::channels::ChannelTable;
use crate::formats::recording::event::{ChannelInfo, RecordingEvent, Sink, Stop};
use crate::formats::recording::size::{LengthUnit, stated};
use crate::formats::recording::text::{self, Field, Separator, TextLines, decimal, text, whole};
use crate::formats::recording::time::{self, Midnights, Moment};
use crate::formats::seconds::since;

/// The most sensors in a file; each has a name of its own.
const MOST_SENSORS: usize = 64;

/// The most bytes of a line with a key.
const LONGEST_KEY: usize = 1 << 12;

#[derive(Default)]
enum XsensorBlock {
    #[default]
    Other,
    Sensor(Option<String>),
    Group(XsensorGroup),
}

/// A list of the cells of a part of a sensor. Its values are only counted: where they stop short, the file was cut.
#[derive(Clone, Copy, Default)]
struct XsensorGroup {
    /// `Cells`: the number of values below `SENSELS`.
    cells: Option<usize>,
    /// The number of values so far; None before `SENSELS`.
    found: Option<usize>,
}

impl XsensorGroup {
    fn is_whole(self) -> bool {
        matches!((self.cells, self.found), (Some(cells), Some(found)) if found >= cells)
    }
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
    sensors: usize,
    groups: usize,
    expected: (usize, usize),
    groups_list_cells: bool,
    /// `Date` of the frame, such as `2022 Aug 16`.
    date: Option<String>,
    /// `Time` of the frame, such as `08:21:17.982`, or `1.25` in seconds.
    clock: Option<String>,
    start: Option<(Option<String>, f64)>,
    midnights: Midnights,
    block: XsensorBlock,
    /// `Rows` of the current sensor.
    rows: Option<u16>,
    /// `Columns` of the current sensor.
    columns: Option<u16>,
    /// `Sensel Width`: the pitch along x.
    width_mm: Option<f64>,
    /// `Sensel Height`: the pitch along y.
    height_mm: Option<f64>,
}

pub(in crate::formats::recording) fn read(
    input: impl BufRead,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let mut lines = TextLines::new(input);
    let mut state = XsensorState::default();
    let mut channels = ChannelTable::new(MOST_SENSORS, "sensors");
    let mut frame = Frame::default();
    let mut more = lines.advance_to_content()?;
    while more {
        let (key, value) = pair(lines.line());
        if key == "SENSELS" && state.begin_cells() {
            let rows = state.matrix(&mut lines, &mut frame)?;
            let end = lines.number();
            // A row too many shows that `Rows` is wrong, so the frame is not reported before the line below it is read.
            let next = lines.advance_to_content();
            if matches!(next, Ok(true)) && is_value(&pair(lines.line()).0) {
                let rows = counted(rows, "row");
                let message = format!("more values, expected {rows} of them as Rows says");
                return Err(in_line(lines.number(), message).into());
            }
            let name = state.end_sensor();
            state.give(name.as_deref(), &mut channels, &mut frame, sink, end)?;
            more = next?;
        } else {
            if is_value(&key) {
                state.count_in_group(lines.line());
            } else {
                state.line(&key, &value, lines.number())?;
            }
            more = lines.advance_to_content()?;
        }
    }
    match state.missing() {
        Some(message) => Err(in_line(lines.number() + 1, message).into()),
        None => Ok(()),
    }
}

fn is_value(field: &str) -> bool {
    matches!(decimal(field.as_bytes()), Field::Value(_))
}

/// Returns the key of a line in capital letters, without the colon after it, and its value.
fn pair(line: &[u8]) -> (String, String) {
    let mut fields = Separator::Byte(b',').split(line);
    let mut next = || fields.next().map_or_else(String::new, text);
    let key = next();
    let key = key.trim_end_matches(':').trim_end().to_uppercase();
    (key, next())
}

/// Returns true if a line begins a frame. The first lines of an export have one, and then [`begins_cells`].
pub(in crate::formats::recording) fn begins_frame(line: &[u8]) -> bool {
    has_key(line, "FRAME")
}

pub(in crate::formats::recording) fn begins_cells(line: &[u8]) -> bool {
    has_key(line, "SENSELS")
}

fn has_key(line: &[u8], key: &str) -> bool {
    line.len() < LONGEST_KEY && pair(line).0 == key
}

/// Returns the unit of length after a key, as in `SENSEL WIDTH (CM)`; None for an unknown unit.
fn length_unit(key: &str) -> Option<LengthUnit> {
    LengthUnit::of_name(key.split_once('(')?.1.trim_end_matches(')'))
}

impl XsensorState {
    /// Reads a line `key,value`.
    fn line(&mut self, key: &str, value: &str, number: u64) -> Result<(), ReadError> {
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
                self.end_group();
                self.expected = (self.sensors.max(1), self.groups);
                (self.sensors, self.groups) = (0, 0);
            }
            "DATE" => self.date = Some(value.to_owned()),
            "TIME" => self.clock = Some(value.to_owned()),
            "SENSOR" => {
                self.end_group();
                self.block = XsensorBlock::Sensor(Some(value.to_owned()));
                (self.rows, self.columns) = (None, None);
                (self.width_mm, self.height_mm) = (None, None);
            }
            "GROUP" => {
                self.end_group();
                self.block = XsensorBlock::Group(XsensorGroup::default());
                self.groups += 1;
            }
            "CELLS" => {
                if let XsensorBlock::Group(group) = &mut self.block {
                    group.cells = value.parse().ok();
                }
            }
            "ROWS" | "COLUMNS" if matches!(self.block, XsensorBlock::Group(_)) => {}
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

    /// Begins the cells below `SENSELS`. Returns true if they are the matrix of a sensor, and false if they are the
    /// list of a group.
    fn begin_cells(&mut self) -> bool {
        if let XsensorBlock::Group(group) = &mut self.block {
            group.found = Some(0);
        }
        matches!(self.block, XsensorBlock::Sensor(_))
    }

    fn end_sensor(&mut self) -> Option<String> {
        match std::mem::take(&mut self.block) {
            XsensorBlock::Sensor(name) => name,
            XsensorBlock::Group(_) | XsensorBlock::Other => None,
        }
    }

    fn count_in_group(&mut self, line: &[u8]) {
        if let XsensorBlock::Group(XsensorGroup {
            found: Some(found), ..
        }) = &mut self.block
        {
            let fields = Separator::Byte(b',').split(line);
            *found += fields.filter(|field| !field.is_empty()).count();
        }
    }

    /// Ends the block that is being read, which may be a group.
    fn end_group(&mut self) {
        if let XsensorBlock::Group(group) = std::mem::take(&mut self.block) {
            self.groups_list_cells |= group.is_whole();
        }
    }

    /// Returns the error if the file ends here, though something must follow; None if this may be its end.
    ///
    /// A group must list all its cells only if another one did, since some versions may not write these lists.
    fn missing(&self) -> Option<String> {
        let (sensors, groups) = self.expected;
        let message = match &self.block {
            // Only the cells end this block, so they are missing.
            XsensorBlock::Sensor(_) => "ends inside a SENSOR block, expected SENSELS",
            XsensorBlock::Group(group) if self.groups_list_cells && !group.is_whole() => {
                return Some(match (group.cells, group.found) {
                    (Some(cells), Some(found)) => {
                        let found = counted(found as u64, "value");
                        format!(
                            "ends inside a GROUP block, found {found}, expected {cells} as Cells says"
                        )
                    }
                    _ => "ends inside a GROUP block, expected Cells and SENSELS".to_owned(),
                });
            }
            _ if self.sensors < sensors => "ends inside a FRAME, expected SENSOR",
            _ if self.groups < groups => "ends inside a FRAME, expected GROUP",
            _ => return None,
        };
        Some(message.to_owned())
    }

    /// Returns the size of this sensor's frames; None before both its lines were read.
    fn size(&self) -> Option<FrameSize> {
        FrameSize::of_sides(self.columns, self.rows)
    }

    /// Reads the rows below `SENSELS`, and returns their number.
    fn matrix(
        &self,
        lines: &mut TextLines<impl BufRead>,
        frame: &mut Frame,
    ) -> Result<u16, ReadError> {
        let Some(size) = self.size() else {
            let message = "SENSELS of a sensor without Rows and Columns";
            return Err(in_line(lines.number(), message));
        };
        frame.reset(size);
        for row in frame.values_mut().chunks_mut(size.columns().into()) {
            if !lines.advance_to_content()? {
                let rows = counted(size.rows(), "row");
                let message = format!("ends inside a frame, expected {rows}");
                return Err(in_line(lines.number() + 1, message));
            }
            let fields = Separator::Byte(b',').split(lines.line());
            text::fill_row(row, fields, lines.number(), decimal)?;
        }
        Ok(size.rows())
    }

    fn give(
        &mut self,
        name: Option<&str>,
        channels: &mut ChannelTable,
        frame: &mut Frame,
        sink: &mut Sink<'_>,
        line: u64,
    ) -> Result<(), Stop> {
        let time = self.time();
        let info = || ChannelInfo {
            size: self.size(),
            unit: self.unit.clone(),
            start: self.beginning(),
            pitch_mm: self.width_mm.zip(self.height_mm).map(|(x, y)| [x, y]),
            threshold: self.threshold,
            ..ChannelInfo::default()
        };
        let channel = channels.index_of(name, info);
        let channel = channel.map_err(|message| in_line(line, message))?;
        for info in channels.take_new() {
            sink.event(RecordingEvent::Channel(info))?;
        }
        channels.number(channel, frame);
        frame.label = self.label.map(Into::into);
        frame.time = time;
        self.sensors += 1;
        sink.event(RecordingEvent::Frame(frame))
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

    /// Returns the time of the frame in seconds since the first one. None if the clock is neither three numbers nor a
    /// number of seconds, or if they are too large.
    fn time(&mut self) -> Option<f64> {
        let (seconds, is_clock) = seconds(self.clock.as_ref()?)?;
        let date = self.date.as_ref().filter(|_| is_clock);
        let (first_date, first) = self.start.get_or_insert_with(|| (date.cloned(), seconds));
        let days = first_date.as_ref().zip(date);
        let days = days.and_then(|(first, own)| days_between(first, own));
        let own = match days {
            Some(days) => f64::from(days) * 86_400.0 + seconds,
            None if is_clock => {
                let is_dated = false;
                self.midnights.seconds(Moment { seconds, is_dated })
            }
            None => seconds,
        };
        Some(since(*first, own))
    }
}

/// Returns the seconds of a clock such as `08:21:17.982` or `8:21:17.982 AM`, and true; of a number of seconds, which
/// count from the start of the recording rather than from midnight, the number and false. None for anything else.
fn seconds(clock: &str) -> Option<(f64, bool)> {
    let (clock, half) = half_day(clock);
    let parts = clock.split(':');
    let parts: Option<Vec<f64>> = parts
        .map(|part| text::read_number(part.trim().as_bytes()))
        .collect();
    let (seconds, is_clock) = match parts?[..] {
        [hours, minutes, seconds] => {
            let hours = match half.zip(whole(hours)) {
                None => hours,
                Some((half, shown)) => half.hours(i32::try_from(shown).ok()?)?.into(),
            };
            (hours * 3600.0 + minutes * 60.0 + seconds, true)
        }
        [seconds] => (seconds, false),
        _ => return None,
    };
    seconds.is_finite().then_some((seconds, is_clock))
}

/// Returns the days from one date to another; None if either cannot be read. If the order of day and month is not
/// certain, it is the one in which less time has passed, since later frames are hardly earlier.
fn days_between(first: &str, date: &str) -> Option<i32> {
    let pairs = days(first).into_iter().zip(days(date));
    let differences = pairs.filter_map(|(first, own)| Some(own? - first?));
    differences.min_by_key(|days| (*days < 0, days.abs()))
}

/// Returns the number of a day such as `2022 Aug 16`, `16 August 2022`, `2022-08-16`, `8/16/2022` or `16.8.2022`: with
/// the month before the day, then with the day before the month. Both are the same if the date shows the order.
fn days(date: &str) -> [Option<i32>; 2] {
    /// The first three letters of each month, so that full names match, too.
    const MONTHS: [&str; 12] = [
        "jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec",
    ];
    let words = date.split(|end: char| !end.is_alphanumeric());
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    let number = |word: &str, most: i32| {
        let number = word.parse().ok()?;
        (1..=most).contains(&number).then_some(number)
    };
    let month = |word: &str| {
        let name = word.to_ascii_lowercase();
        let mut months = (1..).zip(MONTHS);
        let named = months.find(|(_, start)| name.starts_with(start));
        named.map_or_else(|| number(word, 12), |(month, _)| Some(month))
    };
    let of = |year: &str, named: &str, of_month: &str| {
        let year = number(year, 9999).filter(|_| year.len() == 4)?;
        Some(time::day(year, month(named)?, number(of_month, 31)?))
    };
    match words[..] {
        [year, month, day, ..] if year.len() == 4 => [of(year, month, day); 2],
        [one, other, year] => {
            let orders = [of(year, one, other), of(year, other, one)];
            let [month_first, day_first] = orders;
            [month_first.or(day_first), day_first.or(month_first)]
        }
        _ => [None; 2],
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum HalfDay {
    /// Before noon, AM.
    First,
    /// After noon, PM.
    Second,
}

impl HalfDay {
    /// Returns the hours since midnight for an hour on the clock, from 1 to 12.
    fn hours(self, shown: i32) -> Option<i32> {
        let begun = match self {
            Self::First => 0,
            Self::Second => 12,
        };
        (1..=12).contains(&shown).then_some(shown % 12 + begun)
    }
}

/// Splits `AM` or `PM` off the end of a time; returns the time and the half of the day.
fn half_day(clock: &str) -> (&str, Option<HalfDay>) {
    let clock = clock.trim_end();
    let split = clock.len().checked_sub(2);
    let Some((before, mark)) = split.and_then(|split| clock.split_at_checked(split)) else {
        return (clock, None);
    };
    let half = match mark {
        _ if mark.eq_ignore_ascii_case("am") => HalfDay::First,
        _ if mark.eq_ignore_ascii_case("pm") => HalfDay::Second,
        _ => return (clock, None),
    };
    (before.trim_end(), Some(half))
}

#[cfg(test)]
mod tests {
    use super::days_between;

    #[test]
    fn dates_are_read_in_any_order() {
        for (first, second, days) in [
            ("2022 Aug 31", "2022 Sep 1", Some(1)),
            ("2021 Dec 31", "2022 January 1", Some(1)),
            ("31 August 2022", "1 Sep. 2022", Some(1)),
            ("Aug 31, 2022", "Sep 1, 2022", Some(1)),
            ("2022-08-31", "2022/09/01", Some(1)),
            ("8/31/2022", "9/1/2022", Some(1)),
            ("31.8.2022", "1.9.2022", Some(1)),
            // Either order is possible.
            ("8/9/2022", "8/10/2022", Some(1)),
            ("8/9/2022", "9/9/2022", Some(1)),
            ("8/9/2022", "8/9/2022", Some(0)),
            ("2022 Aug 31", "2022 Aug 30", Some(-1)),
            ("August", "2022 Aug 31", None),
            ("8/31/22", "9/1/22", None),
            ("31/31/2022", "9/1/2022", None),
        ] {
            assert_eq!(days_between(first, second), days, "{first}, {second}");
        }
    }
}
