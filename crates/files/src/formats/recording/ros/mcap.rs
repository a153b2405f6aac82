//! MCAP files of ROS 2: arrays, images and tactile states in CDR. A topic is a channel; of a tactile state, each
//! sensor is a channel.
//!
//! The file is read from front to back in the same memory, and a file that was never closed still gives all its whole
//! messages. Its records are read by [`records`](super::records).
//!
//! The messages that have frames are listed in [`message`](super::message); other messages are skipped. A
//! sensor of a tactile state is the channel `TOPIC#SENSOR`. The time is that of the log, from the first message with
//! a frame on; if it counts from 1970, it gives the start of the recording.

use std::collections::HashMap;
use std::io::Read;
use std::rc::Rc;

use crate::formats::job::too_large;
use crate::formats::npy::Dtype;
use crate::formats::recording::channel_table::ChannelTable;
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{
    ChannelInfo, EarlyEnd, LONGEST_NAME, MOST_CHANNELS, ReadOptions, RecordingEvent, Sink,
};
use crate::formats::recording::ros::cdr::CdrReader;
use crate::formats::recording::ros::message::{
    ImageFrame, MessageKind, header, image, multi_array,
};
use crate::formats::recording::ros::records::{McapRecord, each_record};
use crate::formats::recording::side::{arranged, changed, matrix_size};
use crate::formats::recording::time::moment;
use crate::frame::{Frame, FrameSize, LARGEST_VALUE};
use crate::parameter::number::counted;

/// The most topics whose messages could have frames.
const MOST_TOPICS: usize = 4096;

/// The state of the reader: the names in the records so far, and the frame that is being filled.
struct McapState<'a, 'b> {
    /// The given rows and columns, for messages that do not have them.
    options: ReadOptions,
    /// The schemas so far, by number; None for a schema whose messages have no frames.
    schemas: HashMap<u16, Option<MessageKind>>,
    /// The topics whose messages have frames, by number: the name, and the kind of message.
    topics: HashMap<u16, (Rc<str>, MessageKind)>,
    /// The channels so far.
    channels: ChannelTable,
    /// The time of the first message with a frame, in nanoseconds.
    start: Option<u64>,
    /// The time of the current message, in nanoseconds.
    time: u64,
    /// The cells of the current message.
    values: Vec<f64>,
    /// The frame made of these cells.
    frame: Frame,
    /// The receiver of channels and frames.
    sink: &'a mut Sink<'b>,
}

/// Reads a recording.
///
/// # Errors
/// Returns an error if the file was not closed, after all whole messages; if a record or a message is broken; or if
/// no message has frames.
pub(in crate::formats::recording) fn read(
    input: &mut impl Read,
    options: ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), EarlyEnd> {
    let mut state = McapState {
        options,
        schemas: HashMap::new(),
        topics: HashMap::new(),
        channels: ChannelTable::new(MOST_CHANNELS, "channels"),
        start: None,
        time: 0,
        values: Vec::new(),
        frame: Frame::default(),
        sink,
    };
    each_record(input, &mut |record| state.record(&record))?;
    if state.start.is_none() {
        let message = "no messages with frames, expected std_msgs/*MultiArray, sensor_msgs/Image or \
                       tactile_msgs/TactileState";
        return Err(RecordingError::damaged(message).into());
    }
    Ok(())
}

/// Refuses a name that is too long: compressed, thousands of names of many megabytes each take little space in a
/// file.
fn check_name(name: &str) -> Result<(), RecordingError> {
    if name.len() > LONGEST_NAME {
        let message = format!(
            "a name of {} bytes, expected {LONGEST_NAME} at most",
            name.len()
        );
        return Err(RecordingError::damaged(message));
    }
    Ok(())
}

impl McapState<'_, '_> {
    /// Takes a record. A number that was named before keeps its meaning: the summary at the end repeats schemas and
    /// channels.
    ///
    /// # Errors
    /// Returns an error if there are too many topics, and the errors of [`Self::message`].
    fn record(&mut self, record: &McapRecord<'_>) -> Result<(), EarlyEnd> {
        match *record {
            McapRecord::Schema { id, name } => {
                let kind = || MessageKind::of(name);
                self.schemas.entry(id).or_insert_with(kind);
            }
            McapRecord::Channel {
                id,
                schema,
                topic,
                encoding,
            } => {
                let found = self.schemas.get(&schema).copied().flatten();
                let known = self.topics.contains_key(&id);
                if let Some(kind) = found.filter(|_| encoding == "cdr" && !known) {
                    check_name(topic)?;
                    if self.topics.len() == MOST_TOPICS {
                        let message = format!("more than {MOST_TOPICS} topics");
                        return Err(RecordingError::damaged(message).into());
                    }
                    self.topics.insert(id, (topic.into(), kind));
                }
            }
            McapRecord::Message {
                channel,
                time,
                data,
            } => {
                if let Some((topic, kind)) = self.topics.get(&channel).cloned() {
                    self.time = time;
                    self.message(&topic, kind, data)?;
                }
            }
            McapRecord::LargeMessage { channel } => match self.topics.get(&channel) {
                // An image of that size is not a frame.
                None | Some((_, MessageKind::Image)) => {}
                Some((topic, _)) => {
                    let message = format!("{topic}: a message of more than 16 MiB");
                    return Err(RecordingError::damaged(message).into());
                }
            },
        }
        Ok(())
    }

    /// Reads a message.
    ///
    /// # Errors
    /// Returns an error if the message is broken, and the errors of [`Self::give`].
    fn message(&mut self, topic: &str, kind: MessageKind, data: &[u8]) -> Result<(), EarlyEnd> {
        let broken = || RecordingError::damaged(format!("{topic}: a message is broken"));
        let mut cdr = CdrReader::new(data).ok_or_else(broken)?;
        match kind {
            MessageKind::Array(dtype) => {
                let sizes = multi_array(&mut cdr, dtype, &mut self.values);
                let stated = matrix_size(&sizes.ok_or_else(broken)?);
                let size = arranged(self.values.len(), stated, self.options.size);
                self.give(topic, size)
            }
            MessageKind::Image => match image(&mut cdr, &mut self.values).ok_or_else(broken)? {
                ImageFrame::Values(size) => self.give(topic, Some(size)),
                ImageFrame::OfCamera => Ok(()),
            },
            MessageKind::TactileState => {
                header(&mut cdr).ok_or_else(broken)?;
                for _ in 0..cdr.count(8).ok_or_else(broken)? {
                    let name = format!("{topic}#{}", cdr.text().ok_or_else(broken)?);
                    self.values.clear();
                    let numbers = cdr.numbers(Dtype::F32, &mut self.values);
                    numbers.ok_or_else(broken)?;
                    self.give(&name, None)?;
                }
                Ok(())
            }
        }
    }

    /// Reports the values as a frame of a channel.
    ///
    /// # Errors
    /// Returns an error if there are too many channels, if a message has another number of values than its layout or
    /// another size than earlier ones of its channel, or if a value is infinite.
    fn give(&mut self, name: &str, size: Option<FrameSize>) -> Result<(), EarlyEnd> {
        let found = self.values.len();
        // Rows and columns that are given for one channel need not fit the others.
        let named = self.options.size.filter(|asked| asked.cells() == found);
        let size = size.or(named);
        check_name(name)?;
        let start = *self.start.get_or_insert(self.time);
        let info = || ChannelInfo {
            size,
            values: Some(found as u64),
            start: date_time(start),
            ..ChannelInfo::default()
        };
        let channel = self.channels.index_of(Some(name), info);
        let channel = channel.map_err(RecordingError::damaged)?;
        for info in self.channels.take_new() {
            (self.sink)(RecordingEvent::Channel(info))?;
        }
        #[expect(clippy::cast_precision_loss, reason = "a difference in nanoseconds")]
        let seconds = (i128::from(self.time) - i128::from(start)) as f64 / 1e9;
        self.frame.time = Some(seconds);
        self.channels.number(channel, &mut self.frame);
        self.fill(name, size, self.channels.info(channel).size)?;
        let mut values = self.values.iter();
        if let Some(value) = values.find(|value| value.abs() > LARGEST_VALUE) {
            let message = format!("{name}: a value is {}", too_large(*value));
            return Err(RecordingError::damaged(message).into());
        }
        (self.sink)(RecordingEvent::Frame(&self.frame))
    }

    /// Fills the frame with the values; `before` is the size of the channel's first frame.
    ///
    /// # Errors
    /// Returns an error if the number of values differs from the layout, or the size from `before`.
    fn fill(
        &mut self,
        name: &str,
        size: Option<FrameSize>,
        before: Option<FrameSize>,
    ) -> Result<(), RecordingError> {
        let found = self.values.len();
        match size {
            Some(size) if size.cells() == found => {
                if let Some(before) = before.filter(|&before| before != size) {
                    let message = format!("{name}: {}", changed(size, before));
                    return Err(RecordingError::damaged(message));
                }
                self.frame.reset(size);
                self.frame.values_mut().copy_from_slice(&self.values);
            }
            Some(size) => {
                let message = format!(
                    "{name}: found {}, expected {}",
                    counted(found as u64, "value"),
                    size.cells()
                );
                return Err(RecordingError::damaged(message));
            }
            // The values can only be counted: rows and columns must be given.
            None => self.frame.reset(FrameSize::SMALLEST),
        }
        Ok(())
    }
}

/// Returns the date and time in UTC, `2024-05-01T12:00:00.125Z`, of a time in nanoseconds since 1970; None up to 2001,
/// since such numbers are hardly dates: they may count from the start of a machine.
fn date_time(nanoseconds: u64) -> Option<String> {
    const LEAST: u64 = 1_000_000_000_000_000_000;
    if nanoseconds < LEAST {
        return None;
    }
    let (seconds, fraction) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
    let (days, clock) = (seconds / 86_400, seconds % 86_400);
    let days = i32::try_from(days).ok()?;
    // A year has 365 or 366 days.
    let mut years = 1970 + days / 366..=1970 + days / 365;
    let year = years.find(|year| moment::day(year + 1, 1, 1) > days)?;
    let month = (1..=12).rfind(|&month| moment::day(year, month, 1) <= days)?;
    let of_month = days - moment::day(year, month, 1) + 1;
    let (hours, minutes, seconds) = (clock / 3600, clock / 60 % 60, clock % 60);
    let fraction = format!(".{fraction:09}");
    let fraction = fraction.trim_end_matches('0').trim_end_matches('.');
    Some(format!(
        "{year}-{month:02}-{of_month:02}T{hours:02}:{minutes:02}:{seconds:02}{fraction}Z"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nanoseconds_since_1970_are_dates() {
        for text in [
            "2001-09-09T01:46:40Z",
            "2023-11-14T22:13:20.000000001Z",
            "2024-02-29T23:59:59.5Z",
            "2024-12-31T00:00:00Z",
            "2025-01-01T12:30:00.125Z",
        ] {
            let (whole, rest) = text.split_at(19);
            let fraction = rest.trim_matches(['.', 'Z']);
            let fraction: u64 = format!("{fraction:0<9}").parse().expect("a number");
            let seconds = moment::read(whole.as_bytes()).expect("a moment").seconds;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "whole and after 1970"
            )]
            let nanoseconds = seconds as u64 * 1_000_000_000 + fraction;
            assert_eq!(date_time(nanoseconds).as_deref(), Some(text));
        }
        assert_eq!(date_time(999_999_999_999_999_999), None);
        assert!(date_time(u64::MAX).is_some_and(|text| text.starts_with("2554-07-21T")));
    }
}
