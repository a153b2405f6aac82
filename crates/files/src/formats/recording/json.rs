//! Recordings and streams of one JSON object per line: `{"t": 0.1, "frame": [[0, 12], [null, 3]]}`, null or Python's
//! `NaN` for a missing cell.
//! ```text
//! {"t": 0.00, "frame": [[0, 12], [null, 3]]}
//! {"t": 0.05, "frame": [[0, 13], [null, 4]], "label": 7}
//! {"t": 0.05, "frame": [[5, 6], [7, 8]], "channel": "left"}
//! ```
//! A frame is a list of rows. `t` or `time` is in seconds and counts from the first one. `label` is a whole number or a text, `channel` the name or the number of one of
//! several sensors; other keys are ignored. All frames of a channel have the same size.

use std::collections::BTreeMap;
use std::io::BufRead;

use serde::Deserialize;
use taxel_core::frame::{Frame, FrameSize, LARGEST_VALUE, Label};
use taxel_core::parameter::number::counted;

use crate::error::ReadError;
use crate::formats::job::{FrameRows, too_large};
use crate::formats::json::of_line_with_nan;
use crate::formats::recording::error::foreign;
use crate::formats::recording::event::{ChannelInfo, LONGEST_NAME, ReadOptions, Sink, Stop};
use crate::formats::recording::size::{changed, frame_size, other_than};
use crate::formats::recording::text::TextLines;
use crate::formats::recording::time::Time;

#[derive(Deserialize)]
#[serde(expecting = "an object with a key \"frame\"")]
struct FrameLine {
    frame: FrameRows,
    #[serde(alias = "time")]
    t: Option<f64>,
    label: Option<Name>,
    channel: Option<Name>,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "\"label\" and \"channel\" are whole numbers or texts"
)]
enum Name {
    Number(i64),
    Text(String),
}

impl Name {
    fn text(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Text(text) => text.clone(),
        }
    }
}

pub(super) fn read(input: &mut dyn BufRead, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let mut lines = TextLines::new(input);
    let mut sizes = BTreeMap::new();
    let mut frame = Frame::default();
    let mut is_first = true;
    loop {
        let read = match lines.advance_to_content() {
            Ok(false) => return Ok(()),
            Ok(true) => FrameLine::read(lines.line(), sink.options, &mut frame),
            // A line that is too long.
            Err(error) => Err(error),
        };
        let is_rest = sink.options.is_joined && lines.number == 1;
        let error = match read {
            Ok(line) => {
                let size = frame.size();
                let name = line.channel.as_ref().map(Name::text);
                let channel = sink.channel(name.as_deref(), || ChannelInfo::of_size(size))?;
                let before = *sizes.entry(channel).or_insert(size);
                if before == size {
                    let time = line.t.filter(|seconds| seconds.abs() <= LARGEST_VALUE);
                    let clock = &mut sink.state.clock;
                    frame.time = time.map(|time| clock.since_first(Time::Seconds(time)));
                    sink.frame(channel, &mut frame)?;
                    is_first = false;
                    continue;
                }
                ReadError::new(changed(size, before))
            }
            Err(error) => error,
        };
        if is_first && !sink.options.leaves_out && !is_meant(lines.line()) {
            let kind = "JSON, but not of an object with a key \"frame\" in each line";
            return Err(foreign(kind).into());
        }
        if !is_rest {
            sink.damage(error.in_line(lines.number), lines.line())?;
        }
    }
}

/// Whether a line is meant as a frame, perhaps with a mistake.
fn is_meant(line: &[u8]) -> bool {
    let is_object = line.trim_ascii_start().starts_with(b"{");
    is_object && line.windows(7).any(|word| word == b"\"frame\"")
}

impl FrameLine {
    /// Reads a line; its size, its values and its label are those of `frame` then.
    fn read(line: &[u8], options: &ReadOptions, frame: &mut Frame) -> Result<Self, ReadError> {
        let line: Self = of_line_with_nan(line)?;
        if let Some(Name::Text(name)) = &line.channel
            && !(1..=LONGEST_NAME).contains(&name.len())
        {
            let found = counted(name.len() as u64, "byte");
            let message = format!("\"channel\" is a name of {found}, expected 1 to {LONGEST_NAME}");
            return Err(ReadError::new(message));
        }
        frame.reset(line.size(options.size)?);
        let cells = line.frame.iter().flatten();
        for (slot, cell) in frame.values_mut().iter_mut().zip(cells) {
            *slot = cell.unwrap_or(f64::NAN);
            if slot.abs() > LARGEST_VALUE {
                return Err(ReadError::new(too_large(*slot)));
            }
        }
        frame.label = line.label.as_ref().map(|label| match label {
            Name::Number(number) => Label::Number(*number),
            Name::Text(text) => Label::from(&**text),
        });
        Ok(line)
    }

    /// The rows and columns; `asked` are those that were given.
    fn size(&self, asked: Option<FrameSize>) -> Result<FrameSize, ReadError> {
        let (rows, first) = (self.frame.len(), self.frame.first().map_or(0, Vec::len));
        let other = self.frame.iter().position(|row| row.len() != first);
        let message = match (other, frame_size(first, rows), asked) {
            _ if rows == 0 => "\"frame\" is empty, expected rows of values".to_owned(),
            (Some(row), ..) => {
                let found = counted(self.frame[row].len() as u64, "value");
                format!("row {} has {found}, expected {first}", row + 1)
            }
            (_, Some(size), Some(asked)) if size != asked => other_than(size, asked),
            (_, Some(size), _) => return Ok(size),
            (_, None, _) => {
                let rows = counted(rows as u64, "row");
                format!("{rows} of {first}, expected 1 to 512 of each")
            }
        };
        Err(ReadError::new(message))
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::ops::ControlFlow;

    use super::*;
    use crate::formats::recording::{RecordingEvent, read};

    /// The values and the time of a frame.
    type Found = (Vec<f64>, Option<f64>);

    /// The frames; or the error.
    fn found(text: &str) -> Result<Vec<Found>, String> {
        let mut frames = Vec::new();
        let read = read(Cursor::new(text), &ReadOptions::default(), &mut |event| {
            if let RecordingEvent::Frame(frame) = event {
                frames.push((frame.values().to_vec(), frame.time));
            }
            ControlFlow::Continue(())
        });
        read.map(|_| frames).map_err(|error| error.to_string())
    }

    #[test]
    fn a_frame_is_a_list_of_equal_rows() {
        let frames = found("{\"frame\":[[1,2.5],[-3,4]]}\n").expect("rows");
        assert_eq!(frames[0].0, [1.0, 2.5, -3.0, 4.0]);
        assert!(found("{\"frame\":[[null]]}").expect("a cell")[0].0[0].is_nan());
        for (frame, expected) in [
            ("[[1,2],[3]]", "line 1: row 2 has 1 value, expected 2"),
            (
                "[1,2]",
                "line 1, column 11: invalid type: integer `1`, expected a sequence",
            ),
            (
                "[[\"1\"]]",
                "line 1, column 14: invalid type: string \"1\", expected f64",
            ),
            ("[]", "line 1: \"frame\" is empty, expected rows of values"),
            (
                "[[1e301]]",
                "line 1: 1e301 is too large, expected at most 1e300",
            ),
        ] {
            let error = found(&format!("{{\"frame\":{frame}}}"));
            assert_eq!(error, Err(expected.to_owned()), "{frame}");
        }
    }

    #[test]
    fn other_json_is_told_which_forms_there_are() {
        for text in [
            "{\n\"frame\":[[1]]\n}",
            "{\"snapshots\":{}}",
            "[{\"frame\":[[1]]}]",
        ] {
            let error = found(text).expect_err(text);
            assert!(
                error.contains("Tekscan ASCII") && error.contains("CSV"),
                "{error}"
            );
        }
    }
}
