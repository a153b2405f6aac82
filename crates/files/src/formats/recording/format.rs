//! The formats of recordings, with their names.

use crate::parameter::named;

/// A format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RecordingFormat {
    /// Tekscan's ASCII export.
    Tekscan,
    /// XSENSOR's CSV export.
    Xsensor,
    /// Numbers separated by commas, semicolons, tabs or spaces: one frame per line, or one row per line.
    Csv,
    /// A numpy array.
    Npy,
    /// An archive of numpy arrays.
    Npz,
    /// JSON lines: one object per line.
    JsonLines,
    /// The output of `ros2 topic echo`.
    Ros2,
    /// An MCAP file.
    Mcap,
    /// The bytes of a `FlexiTac` board.
    Flexitac,
}

impl RecordingFormat {
    /// All formats.
    pub const ALL: &'static [Self] = &[
        Self::Tekscan,
        Self::Xsensor,
        Self::Csv,
        Self::Npy,
        Self::Npz,
        Self::JsonLines,
        Self::Ros2,
        Self::Mcap,
        Self::Flexitac,
    ];

    /// Returns the name of the format, as it is in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tekscan => "tekscan",
            Self::Xsensor => "xsensor",
            Self::Csv => "csv",
            Self::Npy => "npy",
            Self::Npz => "npz",
            Self::JsonLines => "jsonl",
            Self::Ros2 => "ros2",
            Self::Mcap => "mcap",
            Self::Flexitac => "flexitac",
        }
    }

    /// Returns the name of the format in messages that list the formats.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Tekscan => "Tekscan ASCII",
            Self::Xsensor => "XSENSOR CSV",
            Self::Csv => "CSV",
            Self::Npy => "NPY",
            Self::Npz => "NPZ",
            Self::JsonLines => "JSON lines",
            Self::Ros2 => "ros2 topic echo",
            Self::Mcap => "MCAP",
            Self::Flexitac => "FlexiTac",
        }
    }

    /// Returns true if frames in this format can be a stream, too: they are written one after the other as they are
    /// measured, and can be read as they arrive. A file that they are appended to can be followed.
    pub(crate) fn can_be_streamed(self) -> bool {
        match self {
            Self::Csv | Self::JsonLines | Self::Ros2 | Self::Flexitac => true,
            Self::Tekscan | Self::Xsensor | Self::Npy | Self::Npz | Self::Mcap => false,
        }
    }

    /// Returns true if a stream in this format consists of lines of text.
    pub(crate) fn is_text_stream(self) -> bool {
        self.can_be_streamed() && self != Self::Flexitac
    }
}

named!(RecordingFormat, "format", RecordingFormat::ALL);
