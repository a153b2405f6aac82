//! The events that a reader reports: the channels of a file, its frames one by one, and notes about oddities.

use std::fmt;
use std::io::BufRead;
use std::ops::ControlFlow;
use std::str::FromStr;

use taxel_core::frame::{Frame, FrameSize, Rule, RuleOrigin, SetRule, Tare, View};
use taxel_core::parameter::number::short;

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::recording::format::Format;
use crate::formats::recording::metadata::{FrameMark, RecordingMetadata};
use crate::formats::recording::table::TableLayout;
use crate::formats::recording::text::TextLines;
use crate::formats::recording::time::{FrameClock, TimeUnit};

/// Options for reading a recording or a stream.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// The size of a frame, for what does not state it.
    pub size: Option<FrameSize>,
    /// The format; None to look at the content.
    pub format: Option<&'static Format>,
    /// The column of a table with the time.
    pub time_column: Option<TimeColumn>,
    /// The column of a table with the label.
    pub label_column: Option<Column>,
    /// Whether a wrong frame is reported as [`RecordingEvent::Damage`] and left out, as in a stream or in a file that is
    /// still being written; otherwise the first one ends the reading with its error.
    pub leaves_out: bool,
    /// Whether the first byte may lie inside a frame, as in a stream that was joined anywhere. What precedes its first
    /// boundary between frames is dropped.
    pub is_joined: bool,
}

/// A column of a table: its name, or its number from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Column {
    /// The number of the column, from 1.
    Number(usize),
    /// Its name in the header.
    Name(String),
}

/// The column with the time, and the unit of its numbers; None to take that of its name, else seconds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimeColumn {
    /// The column.
    pub column: Column,
    /// The unit of its numbers.
    pub unit: Option<TimeUnit>,
}

impl FromStr for Column {
    type Err = String;

    /// Reads a name, or a number from 1.
    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse() {
            Ok(0) => Err("columns count from 1".to_owned()),
            Ok(number) => Ok(Self::Number(number)),
            Err(_) if text.trim().is_empty() => {
                Err("expected the name of a column, or its number from 1".to_owned())
            }
            Err(_) => Ok(Self::Name(text.to_owned())),
        }
    }
}

impl FromStr for TimeColumn {
    type Err = String;

    /// Reads `X` or `X:UNIT`, with the unit s, ms, us or ns.
    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.rsplit_once(':');
        let unit = parts.and_then(|(_, unit)| TimeUnit::named(unit));
        let column = match (parts, unit) {
            (Some((column, _)), Some(_)) => column,
            (Some((column, unit)), None) if column.parse::<usize>().is_ok() => {
                return Err(format!("unit {unit:?}: expected s, ms, us or ns"));
            }
            _ => text,
        };
        let column = column.parse()?;
        Ok(Self { column, unit })
    }
}

/// The name of a channel without a name.
pub(crate) const UNNAMED_CHANNEL: &str = "unnamed";

/// The most channels of a recording or a stream.
pub(super) const MOST_CHANNELS: usize = 256;

/// The most bytes of a channel's name.
pub(super) const LONGEST_NAME: usize = 1024;

/// A description of a channel, as far as the recording gives it: a field is None if it does not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChannelInfo {
    /// The name of the channel: a sensor, an array, a topic.
    pub name: Option<String>,
    /// The size of its frames.
    pub size: Option<FrameSize>,
    /// The number of values of a frame, if its size is not known.
    pub values: Option<u64>,
    /// The unit of the values.
    pub unit: Option<String>,
    /// The start of the recording, as it is written there.
    pub start: Option<String>,
    /// The time from one frame to the next, in seconds.
    pub seconds_per_frame: Option<f64>,
    /// The distance between neighbouring cells in mm, along x and along y.
    pub pitch_mm: Option<[f64; 2]>,
    /// The least value at which the recording's own software shows a cell as touched.
    pub threshold: Option<f64>,
    /// The rule of the imprints while the recording was made.
    pub rule: Option<SetRule>,
    /// The tare while the recording was made, subtracted after crop, flip and turn; the recorded values are those
    /// before that.
    pub tare: Option<Tare>,
    /// The frames that were marked while the recording was made.
    pub marks: Vec<FrameMark>,
}

impl ChannelInfo {
    /// A channel of which only the size is known.
    pub(super) fn of_size(size: FrameSize) -> Self {
        Self {
            size: Some(size),
            ..Self::default()
        }
    }

    /// Returns the name by which a channel is listed and chosen: `unnamed` if the recording gives it none.
    pub fn shown_name(&self) -> &str {
        self.name.as_deref().unwrap_or(UNNAMED_CHANNEL)
    }

    /// Returns the channel, with missing fields taken from the metadata beside the recording, if there is one.
    #[must_use]
    pub fn completed(&self, metadata: Option<&RecordingMetadata>) -> Self {
        let mut info = self.clone();
        if let Some(metadata) = metadata {
            info.unit = info.unit.or_else(|| metadata.unit.clone());
            info.pitch_mm = info.pitch_mm.or(metadata.pitch_mm);
            info.seconds_per_frame = info.seconds_per_frame.or(metadata.seconds_per_frame);
            info.rule = info.rule.or(metadata.rule);
            if let Some(Rule::AtLeast(threshold)) = info.rule.map(|set| set.rule) {
                info.threshold.get_or_insert(threshold);
            }
            info.tare = info.tare.or_else(|| metadata.tare.clone());
            info.marks.clone_from(&metadata.marks);
        }
        info
    }

    /// Returns the side of a cell in mm; None if it is unknown or cells are not square: a sensor has only one pitch.
    /// Files write the pitch of square cells as the same number twice, so nothing is rounded.
    pub fn square_pitch_mm(&self) -> Option<f64> {
        self.pitch_mm.and_then(|[x, y]| (x == y).then_some(x))
    }

    /// Returns the reason why lengths are not in mm although the cell distances are known; None if they are in mm, or
    /// if the distances are unknown.
    pub fn why_not_in_mm(&self) -> Option<String> {
        let [x, y] = self.pitch_mm.filter(|_| self.square_pitch_mm().is_none())?;
        Some(format!(
            "cells of {} × {} mm are not square, so lengths are in cells only",
            short(x),
            short(y)
        ))
    }

    /// Returns the recording's own tare, if it has the size of the frames in that view.
    pub fn tare_for(&self, view: &View) -> Option<&Tare> {
        let seen = view.size(self.size?).ok()?;
        let fits = |tare: &&Tare| FrameSize::from(tare.baseline.size()) == seen;
        self.tare.as_ref().filter(fits)
    }

    /// Returns the rule of the recording itself: that of its metadata, otherwise its threshold. Pieces of fewer
    /// taxels than `least` are dropped; 0 keeps the metadata's limit.
    pub fn own_rule(&self, least: u32) -> Option<SetRule> {
        let threshold = || {
            let rule = self.threshold.and_then(|own| Rule::at_least(own).ok());
            let from = RuleOrigin::File;
            rule.map(|rule| SetRule { rule, least, from })
        };
        let mut own = self.rule.or_else(threshold)?;
        if least > 0 {
            own.least = least;
        }
        Some(own)
    }
}

/// What is to be said of a recording beside its frames, as a sentence without an end.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordingNote {
    /// How it is read, which is no reason to doubt it.
    Reading(String),
    /// An oddity that does not stop a reader.
    Oddity(String),
}

impl RecordingNote {
    pub(super) fn square(side: u16) -> Self {
        let cells = u32::from(side) * u32::from(side);
        Self::Oddity(format!(
            "{cells} numbers a frame, taken as {side} rows of {side} columns"
        ))
    }

    /// Whether it only says how the recording is read.
    pub fn is_plain(&self) -> bool {
        matches!(self, Self::Reading(_))
    }
}

impl fmt::Display for RecordingNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Reading(text) | Self::Oddity(text)) = self;
        f.write_str(text)
    }
}

/// An event that a reader reports.
#[derive(Clone, Copy, Debug)]
pub enum RecordingEvent<'a> {
    /// A channel, before its first frame. Channels are numbered from 0.
    Channel(&'a ChannelInfo),
    /// A frame; in a stream of bytes, confirmed by the bytes after it.
    Frame(&'a Frame),
    /// An oddity.
    Note(&'a RecordingNote),
    /// A wrong frame, if [`ReadOptions::leaves_out`] is set: `Break` ends the reading with this error.
    Damage {
        /// The error, with its place.
        error: &'a ReadError,
        /// Some bytes of the frame.
        bytes: &'a [u8],
    },
}

/// A function that takes the events of a recording; `Break` ends the reading without an error.
pub type RecordingSink<'a> = dyn FnMut(RecordingEvent<'_>) -> ControlFlow<()> + 'a;

/// The reason why a reader ends before the end of its input.
#[derive(Debug)]
pub(crate) enum Stop {
    /// No more is wanted.
    Enough,
    Failed(ReadError),
}

impl Stop {
    /// The result of a reading for its caller, who knows whether more was wanted.
    pub(super) fn settled(read: Result<(), Self>) -> Result<(), ReadError> {
        match read {
            Ok(()) | Err(Self::Enough) => Ok(()),
            Err(Self::Failed(error)) => Err(error),
        }
    }
}

impl<E: Into<ReadError>> From<E> for Stop {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

/// What goes on when a stream is read again after an interruption: its channels, the number of the next frame of each,
/// and its clock.
#[derive(Debug, Default)]
pub(crate) struct ReadState {
    pub(super) channels: Vec<(ChannelInfo, u64)>,
    /// The number of channels that were not reported: the one without a name of a stream that names none.
    unreported: usize,
    /// Whether a channel without a name is reported only beside others.
    pub(super) hides_unnamed: bool,
    /// The layout of the table, whose header is not repeated.
    pub(super) layout: Option<TableLayout>,
    lacks_time: bool,
    pub(super) clock: FrameClock,
}

/// Where a reader puts what it finds.
pub(crate) struct Sink<'a> {
    pub(super) consumer: &'a mut RecordingSink<'a>,
    pub(super) state: &'a mut ReadState,
    pub(super) options: &'a ReadOptions,
}

impl Sink<'_> {
    /// Reports an event as it is.
    pub(crate) fn event(&mut self, event: RecordingEvent<'_>) -> Result<(), Stop> {
        match (self.consumer)(event) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Stop::Enough),
        }
    }

    /// Returns the index of the channel with that name; reports it if it is new. A limit keeps names that change with
    /// every frame from filling the memory.
    pub(crate) fn channel(
        &mut self,
        name: Option<&str>,
        info: impl FnOnce() -> ChannelInfo,
    ) -> Result<usize, Stop> {
        let known = self
            .state
            .channels
            .iter()
            .position(|(known, _)| known.name.as_deref() == name);
        if let Some(known) = known {
            return Ok(known);
        }
        if self.state.channels.len() == MOST_CHANNELS {
            return Err(ReadError::new(format!("more than {MOST_CHANNELS} channels")).into());
        }
        let info = ChannelInfo {
            name: name.map(str::to_owned),
            ..info()
        };
        if name.is_none() && self.state.channels.is_empty() && self.state.hides_unnamed {
            self.state.unreported = 1;
        } else {
            let hidden = std::mem::take(&mut self.state.unreported);
            let hidden = self.state.channels[..hidden].to_vec();
            for info in hidden.iter().map(|(info, _)| info).chain([&info]) {
                self.event(RecordingEvent::Channel(info))?;
            }
        }
        self.state.channels.push((info, 0));
        Ok(self.state.channels.len() - 1)
    }

    /// Reports a frame of this channel, with its number.
    pub(crate) fn frame(&mut self, channel: usize, frame: &mut Frame) -> Result<(), Stop> {
        frame.channel = channel;
        frame.number = self.state.channels[channel].1;
        self.state.channels[channel].1 += 1;
        self.event(RecordingEvent::Frame(frame))
    }

    /// Notes the first time of a channel that cannot be read: the text in its place.
    pub(crate) fn unread_time(&mut self, channel: usize, text: &str) -> Result<(), Stop> {
        if std::mem::replace(&mut self.state.lacks_time, true) {
            return Ok(());
        }
        let frame = self.state.channels[channel].1;
        self.note(&RecordingNote::Oddity(format!(
            "frame {frame}: {text:?} cannot be read as a time; such frames have none"
        )))
    }

    pub(crate) fn note(&mut self, note: &RecordingNote) -> Result<(), Stop> {
        self.event(RecordingEvent::Note(note))
    }

    /// Reads the next line; one that is too long is a wrong frame.
    pub(super) fn advance(&mut self, lines: &mut TextLines<impl BufRead>) -> Result<bool, Stop> {
        loop {
            match lines.advance() {
                Err(error) if error.kind == ReadErrorKind::Invalid => {
                    self.damage(error, b"")?;
                }
                read => return Ok(read?),
            }
        }
    }

    /// Reports a wrong frame that is left out, if it may be; otherwise it ends the reading.
    pub(crate) fn damage(&mut self, error: ReadError, bytes: &[u8]) -> Result<(), Stop> {
        let damage = RecordingEvent::Damage {
            error: &error,
            bytes,
        };
        if self.options.leaves_out && self.event(damage).is_ok() {
            Ok(())
        } else {
            Err(error.into())
        }
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::matrix::Matrix;
    use taxel_core::sensor::MatrixSize;

    use super::*;

    #[test]
    fn metadata_fills_only_the_missing_fields_of_a_channel() {
        let rule = |percent| SetRule {
            rule: Rule::Percent(percent),
            least: 0,
            from: RuleOrigin::File,
        };
        let own = ChannelInfo {
            rule: Some(rule(30.0)),
            unit: Some("kPa".to_owned()),
            seconds_per_frame: Some(0.1),
            ..ChannelInfo::default()
        };
        let metadata = RecordingMetadata {
            rule: Some(rule(40.0)),
            unit: Some("mmHg".to_owned()),
            seconds_per_frame: Some(0.2),
            pitch_mm: Some([2.0, 3.0]),
            ..RecordingMetadata::default()
        };
        assert_eq!(own.completed(None), own);
        let completed = own.completed(Some(&metadata));
        assert_eq!((completed.unit, completed.rule), (own.unit, own.rule));
        assert_eq!(completed.seconds_per_frame, own.seconds_per_frame);
        assert_eq!(completed.pitch_mm, metadata.pitch_mm);
    }

    #[test]
    fn a_threshold_of_the_metadata_is_that_of_the_recording() {
        let threshold = |rule| {
            let (least, from) = (0, RuleOrigin::File);
            let rule = Some(SetRule { rule, least, from });
            let metadata = RecordingMetadata {
                rule,
                ..RecordingMetadata::default()
            };
            let own = ChannelInfo::default();
            own.completed(Some(&metadata)).threshold
        };
        assert_eq!(threshold(Rule::AtLeast(10.0)), Some(10.0));
        assert_eq!(threshold(Rule::Percent(10.0)), None);
    }

    #[test]
    fn a_given_least_size_takes_precedence_over_the_metadata() {
        let described = ChannelInfo {
            rule: Some(SetRule {
                rule: Rule::Percent(30.0),
                least: 3,
                from: RuleOrigin::File,
            }),
            ..ChannelInfo::default()
        };
        let threshold = ChannelInfo {
            threshold: Some(2.0),
            ..ChannelInfo::default()
        };
        let least = |info: &ChannelInfo, asked| info.own_rule(asked).map(|set| set.least);
        assert_eq!(
            [0, 1, 5].map(|asked| least(&described, asked)),
            [3, 1, 5].map(Some)
        );
        assert_eq!(
            [0, 5].map(|asked| least(&threshold, asked)),
            [0, 5].map(Some)
        );
        assert_eq!(least(&ChannelInfo::default(), 5), None);
    }

    #[test]
    fn a_tare_fits_only_views_of_its_size() {
        let tare = Tare::from_parts(
            Matrix::filled(MatrixSize::new(3, 2).expect("an allowed size"), 1.0),
            None,
            None,
            1,
        )
        .expect("sizes fit");
        let info = ChannelInfo {
            size: Some(FrameSize::new(3, 2).expect("an allowed size")),
            tare: Some(tare.clone()),
            ..ChannelInfo::default()
        };
        let turned = View {
            quarter_turns: 1,
            ..View::default()
        };
        assert_eq!(info.tare_for(&View::default()), Some(&tare));
        assert_eq!(info.tare_for(&turned), None);
        // If the size of the frames is unknown, nothing shows whether the tare fits.
        let unknown = ChannelInfo { size: None, ..info };
        assert_eq!(unknown.tare_for(&View::default()), None);
    }
}
