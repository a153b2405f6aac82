//! What a reader reports while it reads: what is in the file, frame after frame, and what is odd.

use std::fmt;
use std::ops::ControlFlow;

use crate::formats::recording::description::{FrameMark, RecordingMetadata};
use crate::frame::{Frame, Rule, RuleOrigin, SetRule, Tare, View};
use crate::parameter::named;
use crate::parameter::number::counted;
#[cfg(feature = "tui")]
use crate::parameter::number::short;

/// The formats of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RecordingFormat {
    /// Tekscan's ASCII export.
    Tekscan,
    /// XSENSOR's CSV export.
    Xsensor,
    /// novel's emed `.lst` export.
    Emed,
    /// zebris `.apd` pictures.
    Zebris,
    /// Numbers parted by commas, semicolons, tabs or spaces: a frame a line, or a row a line.
    Csv,
    /// An array of numpy.
    Npy,
    /// An archive of such arrays.
    Npz,
    /// A JSON object a line.
    JsonLines,
    /// JSON of the `PoPu` data set.
    Popu,
    /// What `ros2 topic echo` prints.
    Ros2,
    /// An MCAP file.
    Mcap,
    /// Bytes of a `FlexiTac` board.
    Flexitac,
}

impl RecordingFormat {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::Tekscan,
        Self::Xsensor,
        Self::Emed,
        Self::Zebris,
        Self::Csv,
        Self::Npy,
        Self::Npz,
        Self::JsonLines,
        Self::Popu,
        Self::Ros2,
        Self::Mcap,
        Self::Flexitac,
    ];

    /// Its name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tekscan => "tekscan",
            Self::Xsensor => "xsensor",
            Self::Emed => "emed",
            Self::Zebris => "zebris",
            Self::Csv => "csv",
            Self::Npy => "npy",
            Self::Npz => "npz",
            Self::JsonLines => "jsonl",
            Self::Popu => "popu",
            Self::Ros2 => "ros2",
            Self::Mcap => "mcap",
            Self::Flexitac => "flexitac",
        }
    }

    /// Whether frames are written at its end as they are measured, as in a live stream, and can be read from there.
    #[cfg(feature = "acquire")]
    pub(crate) fn is_appended_to(self) -> bool {
        matches!(
            self,
            Self::Csv | Self::JsonLines | Self::Ros2 | Self::Flexitac
        )
    }
}

named!(RecordingFormat, "format", &RecordingFormat::ALL);

/// What is known beforehand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Rows and columns, for files that do not say them.
    pub shape: Option<(u16, u16)>,
}

impl ReadOptions {
    /// With rows and columns, for files that do not say them.
    #[must_use]
    pub fn with_shape(mut self, rows: u16, columns: u16) -> Self {
        self.shape = Some((rows, columns));
        self
    }
}

/// What a channel without a name is called.
pub(crate) const UNNAMED: &str = "unnamed";

/// What a recording says of one of its channels. None where it does not say it.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ChannelInfo {
    /// The channel's name: a sensor, an array, a topic.
    pub name: Option<String>,
    /// Rows and columns of its frames.
    pub shape: Option<(u16, u16)>,
    /// How many values a frame has, where rows and columns are not known.
    pub values: Option<u64>,
    /// The unit of its values.
    pub unit: Option<String>,
    /// When the recording began, as it writes it.
    pub start: Option<String>,
    /// Seconds from a frame to the next.
    pub seconds_per_frame: Option<f64>,
    /// The distance of two cells, in mm, along x and along y.
    pub pitch_mm: Option<[f64; 2]>,
    /// The value from which on the recording's own software shows a cell as touched.
    pub threshold: Option<f64>,
    /// The rule of the imprints while it was recorded.
    pub rule: Option<SetRule>,
    /// What was subtracted from each cell then, after crop, flip and turn; the values are those before that.
    pub tare: Option<Tare>,
    /// Frames that were marked then.
    pub marks: Vec<FrameMark>,
}

impl ChannelInfo {
    /// The name that a channel is listed and chosen by: `unnamed` where the recording gives it none.
    pub fn shown_name(&self) -> &str {
        self.name.as_deref().unwrap_or(UNNAMED)
    }

    /// The channel with what the recording does not say itself, but the description beside it does, if there is one.
    #[must_use]
    pub fn completed(&self, description: Option<&RecordingMetadata>) -> Self {
        let mut info = self.clone();
        if let Some(description) = description {
            info.unit = info.unit.or_else(|| description.unit.clone());
            info.pitch_mm = info.pitch_mm.or(description.pitch_mm);
            info.seconds_per_frame = info.seconds_per_frame.or(description.seconds_per_frame);
            info.rule = info.rule.or(description.rule);
            info.tare = info.tare.or_else(|| description.tare.clone());
            info.marks.clone_from(&description.marks);
        }
        info
    }

    /// The side of a cell in mm; None where it is not known or cells are not square.
    /// A sensor has one pitch only. A file writes that of square cells as the same number twice, so nothing is rounded.
    pub fn square_pitch_mm(&self) -> Option<f64> {
        self.pitch_mm.and_then(|[x, y]| (x == y).then_some(x))
    }

    /// That lengths are not in mm although the distance of cells is known; None where they are or it is not.
    #[cfg(feature = "tui")]
    pub(crate) fn why_not_in_mm(&self) -> Option<String> {
        let [x, y] = self.pitch_mm.filter(|_| self.square_pitch_mm().is_none())?;
        Some(format!(
            "cells of {} × {} mm are not square, so lengths are in taxels only",
            short(x),
            short(y)
        ))
    }

    /// The recording's own tare, if it has the size of what that view shows of its frames.
    pub fn tare_for(&self, view: &View) -> Option<&Tare> {
        let (rows, columns) = self.shape?;
        self.tare.as_ref().filter(|tare| {
            let baseline = tare.baseline();
            (baseline.columns().into(), baseline.rows().into()) == view.size(columns, rows)
        })
    }

    /// The rule of the recording itself: that of its description, else its threshold. Pieces of fewer taxels than `least` are
    /// dropped; 0 leaves that to the description.
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

/// Something odd that does not stop a reader.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RecordingNote {
    /// A sum of a frame that the file states is not that of its values.
    Checksum {
        /// The frame's number, from 0.
        frame: u64,
        /// What its file calls it.
        label: Option<i64>,
        /// What is summed.
        what: &'static str,
        /// What the file says.
        stated: f64,
        /// What the values give.
        found: f64,
    },
    /// Rows and columns follow from the number of values alone.
    Square {
        /// How many rows, and how many columns.
        side: u16,
    },
    /// A two-dimensional array is taken as one frame, though it is larger than 64 × 64.
    Flat {
        /// How many rows.
        rows: u16,
        /// How many columns.
        columns: u16,
    },
    /// Times whose unit follows from their size alone.
    TimeUnit {
        /// The unit: `nanoseconds`.
        unit: &'static str,
    },
    /// Bytes that belong to no frame.
    Garbled {
        /// How many frames were dropped.
        frames: u64,
    },
    /// The file ends before the last of the records that its header counts.
    Cut {
        /// How many whole records it has.
        records: u64,
        /// How many the header counts.
        counted: u64,
    },
    /// A picture is left out: it is the maximum of the others (zebris).
    Maximum,
    /// The description beside the recording is broken or cannot be read, and is left out.
    Description {
        /// What is wrong with it, headed by its path.
        complaint: String,
    },
}

impl fmt::Display for RecordingNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Checksum {
                frame,
                label,
                what,
                stated,
                found,
            } => {
                let label = label.map_or(String::new(), |label| format!(" (label {label})"));
                write!(
                    f,
                    "frame {frame}{label}: {what} should be {stated}, but the values give {found}"
                )
            }
            Self::Square { side } => write!(
                f,
                "the header counts {} values, taken as {side} rows of {side} columns",
                u32::from(*side) * u32::from(*side)
            ),
            Self::Flat { rows, columns } => write!(
                f,
                "an array of {rows} × {columns}, taken as one frame; if each of its {rows} rows is a frame of {columns} values, \
                 give --rows and --columns"
            ),
            Self::TimeUnit { unit } => {
                write!(
                    f,
                    "the times have no unit and are taken as {unit} since 1970"
                )
            }
            Self::Garbled { frames } => {
                let frames = counted(*frames, "frame");
                write!(f, "{frames} dropped (torn, short, long or garbled)")
            }
            Self::Cut { records, counted } => write!(
                f,
                "the file was cut off: it has {records} of the {counted} frames that its header counts"
            ),
            Self::Maximum => f.write_str(
                "the picture [Data] is the maximum of the numbered ones and is left out",
            ),
            Self::Description { complaint } => f.write_str(complaint),
        }
    }
}

/// What a reader reports.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum RecordingEvent<'a> {
    /// A channel, before its first frame. The first one is channel 0, the next one 1.
    Channel(&'a ChannelInfo),
    /// A frame.
    Frame(&'a Frame),
    /// Something odd.
    Note(&'a RecordingNote),
}

/// Takes what a reader reports; `Break` ends the reading without an error.
pub(crate) type Sink<'a> = dyn FnMut(RecordingEvent<'_>) -> ControlFlow<()> + 'a;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::Matrix;

    #[test]
    fn a_description_completes_a_channel_but_for_what_the_recording_says() {
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
        let description = RecordingMetadata {
            rule: Some(rule(40.0)),
            unit: Some("mmHg".to_owned()),
            seconds_per_frame: Some(0.2),
            pitch_mm: Some([2.0, 3.0]),
            ..RecordingMetadata::default()
        };
        assert_eq!(own.completed(None), own);
        let completed = own.completed(Some(&description));
        assert_eq!((completed.unit, completed.rule), (own.unit, own.rule));
        assert_eq!(completed.seconds_per_frame, own.seconds_per_frame);
        assert_eq!(completed.pitch_mm, description.pitch_mm);
    }

    #[test]
    fn a_least_size_that_is_asked_for_goes_before_that_of_the_description() {
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
    fn a_tare_is_for_the_view_that_shows_as_many_cells() {
        let tare = Tare::from_parts(Matrix::filled(3, 2, 1.0), None, None, 1).expect("sizes fit");
        let info = ChannelInfo {
            shape: Some((2, 3)),
            tare: Some(tare.clone()),
            ..ChannelInfo::default()
        };
        let turned = View {
            quarter_turns: 1,
            ..View::default()
        };
        assert_eq!(info.tare_for(&View::default()), Some(&tare));
        assert_eq!(info.tare_for(&turned), None);
        // Without the size of its frames nothing tells whether it fits.
        let unknown = ChannelInfo {
            shape: None,
            ..info
        };
        assert_eq!(unknown.tare_for(&View::default()), None);
    }
}
