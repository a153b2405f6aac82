//! The metadata beside one of taxel's own recordings: `touch.json` says where the frames of `touch.npy` come from,
//! their unit, and how they were viewed.

use std::fmt::Display;
use std::num::NonZeroU32;

use serde::{Deserialize, Serialize};
use taxel_core::frame::{Rule, RuleOrigin, SetRule, Tare};
use taxel_core::matrix::Matrix;
use taxel_core::quote::shortened_message;

use crate::error::ReadError;
use crate::formats::job::{FrameRows, RuleRecord, matrix};
use crate::formats::json;
use crate::formats::recording::size::pitch_in_mm;
use crate::formats::recording::time::step;

const FORMAT: &str = "taxel-touch/1";

const FAMILY: &str = "taxel-touch/";

/// A frame that was marked while it was recorded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameMark {
    /// The source's number of the frame, which is its label in the recording.
    pub number: u64,
    /// The time of the frame in seconds.
    pub time: Option<f64>,
}

/// The content of `touch.json`, the metadata beside the recording `touch.npy`: where its frames come from, their
/// unit, and how they were viewed.
///
/// ```text
/// {"format":"taxel-touch/1","source":"/dev/ttyUSB0","unit":"kPa","pitch_mm":[2.0,2.0],"seconds_per_frame":0.01,
///  "rule":{"at_least":10,"from":"flag"},"tare_frames":30,"tare":[[0.5,null],…],"marks":[{"number":65,"time":6.5}],
///  "ended":true}
/// ```
/// `ended` is false while frames are recorded, and stays false if the program is killed. `ended_by` gives the reason
/// if an error ended the recording, such as a full disk.
///
/// Every key except `format` may be missing. Without `tare_frames`, a tare counts as one of a single frame, so its
/// noise is unknown. The array holds the values as the sensor sent them, in f64; the rule and the tare are applied
/// again when the values are read, unless flags say otherwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordingMetadata {
    /// The name of the source.
    pub source: String,
    /// The unit of the values.
    pub unit: Option<String>,
    /// The distance between neighbouring cells in mm, along x and along y: 1e-9 to 1000. Other values are left out of
    /// the text.
    pub pitch_mm: Option<[f64; 2]>,
    /// The time from one frame to the next, in seconds: 1e-9 to 1e9. Another value is left out of the text.
    pub seconds_per_frame: Option<f64>,
    /// The rule of the imprints on view at the end.
    pub rule: Option<SetRule>,
    /// The tare that was subtracted from each cell at the end. The recorded values are those before that.
    pub tare: Option<Tare>,
    /// The frames that were marked.
    pub marks: Vec<FrameMark>,
    /// Whether the recording was ended properly: false while frames are recorded, and after the program was killed;
    /// None if the metadata does not say.
    pub ended: Option<bool>,
    /// The error that ended the recording early.
    pub ended_by: Option<String>,
}

/// The text of the file, key by key.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
struct Described<Rule> {
    format: String,
    #[serde(default)]
    source: String,
    unit: Option<String>,
    pitch_mm: Option<[f64; 2]>,
    seconds_per_frame: Option<f64>,
    rule: Option<Rule>,
    tare_frames: Option<u64>,
    tare: Option<FrameRows>,
    tare_spread: Option<FrameRows>,
    tare_step: Option<f64>,
    #[serde(default)]
    marks: Vec<FrameMark>,
    ended: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ended_by: Option<String>,
}

/// A rule as it is read. It is written with its origin, but then its origin is the file.
#[derive(Deserialize)]
struct DescribedRule {
    noise: Option<f64>,
    #[serde(flatten)]
    other: RuleRecord,
}

impl DescribedRule {
    fn set(self) -> Result<SetRule, ReadError> {
        let rule = match self.noise {
            Some(noise) => Rule::noise(noise).map_err(|error| wrong(&error))?,
            None => self.other.rule()?,
        };
        Ok(SetRule {
            rule,
            least: self.other.least.map_or(0, NonZeroU32::get),
            from: RuleOrigin::File,
        })
    }
}

fn wrong(error: &dyn Display) -> ReadError {
    ReadError::new(error.to_string())
}

impl RecordingMetadata {
    /// Reads metadata. Returns None if the bytes are something else, as any file beside an array may be. If it is
    /// torn, it is recognised by the name of its format.
    ///
    /// # Errors
    /// Returns an error if the metadata is damaged, or of another version; it names the line and column, or the key.
    pub fn read(bytes: &[u8]) -> Option<Result<Self, ReadError>> {
        #[derive(Deserialize)]
        struct Format {
            format: String,
        }
        let mut words = bytes.windows(FAMILY.len());
        if !words.any(|word| word == FAMILY.as_bytes()) {
            return None;
        }
        Some(match json::object::<Format>(bytes) {
            Ok(Format { format }) if !format.starts_with(FAMILY) => return None,
            Ok(Format { format }) if format != FORMAT => {
                let found = shortened_message(&format);
                let message =
                    format!("{found:?} is unknown to this version, which reads {FORMAT:?}");
                Err(ReadError::new(message).of_key("format"))
            }
            _ => json::object(bytes)
                .map_err(ReadError::from)
                .and_then(Self::of),
        })
    }

    fn of(described: Described<DescribedRule>) -> Result<Self, ReadError> {
        let in_key = |key| move |error: String| wrong(&error).of_key(key);
        let rule = described.rule.map(DescribedRule::set).transpose();
        let tare = described.tare.map(|rows| {
            let spread = described.tare_spread.map(|rows| matrix(&rows)).transpose();
            let spread = spread.map_err(in_key("tare_spread"))?;
            let baseline = matrix(&rows).map_err(in_key("tare"))?;
            let frames = described.tare_frames.filter(|&frames| frames > 0);
            let tare = Tare::from_parts(baseline, spread, described.tare_step, frames.unwrap_or(1));
            tare.map_err(|error| wrong(&error).of_key("tare"))
        });
        Ok(Self {
            source: shortened_message(&described.source),
            unit: described.unit.as_deref().map(shortened_message),
            pitch_mm: pitch(described.pitch_mm),
            seconds_per_frame: described.seconds_per_frame.and_then(step),
            rule: rule.map_err(|error| error.of_key("rule"))?,
            tare: tare.transpose()?,
            marks: described.marks,
            ended: described.ended,
            ended_by: described.ended_by.as_deref().map(shortened_message),
        })
    }

    /// Returns the metadata as the text of a file.
    pub fn text(&self) -> Vec<u8> {
        let tare = self.tare.as_ref();
        json::pretty(&Described {
            format: FORMAT.to_owned(),
            source: self.source.clone(),
            unit: self.unit.clone(),
            pitch_mm: pitch(self.pitch_mm),
            seconds_per_frame: self.seconds_per_frame.and_then(step),
            rule: self.rule,
            tare_frames: tare.map(|tare| tare.frames),
            tare: tare.map(|tare| rows(&tare.baseline)),
            tare_spread: tare.map(|tare| rows(&tare.deviation)),
            tare_step: tare.and_then(|tare| tare.step),
            marks: self.marks.clone(),
            ended: self.ended,
            ended_by: self.ended_by.clone(),
        })
        .into_bytes()
    }
}

/// Returns the pitch unless a side is out of range. JSON has no number for NaN, so it could not be read again.
fn pitch(pitch_mm: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let [x, y] = pitch_mm?.map(|side| pitch_in_mm(side, "mm"));
    Some([x?, y?])
}

fn rows(matrix: &Matrix<f64>) -> FrameRows {
    let cell = |&value: &f64| (!value.is_nan()).then_some(value);
    let row = |row| matrix.row(row).iter().map(cell).collect();
    (0..matrix.rows()).map(row).collect()
}

#[cfg(test)]
mod tests {
    use taxel_core::frame::{Frame, TareFrames, View};
    use taxel_core::sensor::MatrixSize;

    use super::*;

    #[test]
    fn metadata_is_read_as_it_was_written() {
        let mut values = Matrix::filled(MatrixSize::new(2, 1).expect("an allowed size"), 0.5);
        values.set(1, 0, f64::NAN);
        let mut tare = TareFrames::new(2);
        let frame = Frame::from_values(values.size().into(), values.values()).expect("as many");
        for _ in 0..2 {
            tare.add(&frame, &View::default()).expect("it fits");
        }
        for rule in [
            Rule::AtLeast(10.0),
            Rule::Percent(12.5),
            Rule::Hysteresis {
                low: 1.0,
                high: 2.0,
            },
            Rule::Noise(4.0),
        ] {
            let metadata = RecordingMetadata {
                source: "/dev/ttyUSB0".to_owned(),
                unit: Some("kPa".to_owned()),
                pitch_mm: Some([2.0, 3.0]),
                seconds_per_frame: Some(0.01),
                rule: Some(SetRule {
                    rule,
                    least: 3,
                    from: RuleOrigin::File,
                }),
                tare: Some(tare.clone().finish().expect("two frames")),
                marks: vec![FrameMark {
                    number: 65,
                    time: None,
                }],
                ended: Some(true),
                ended_by: Some("no room".to_owned()),
            };
            let text = metadata.text();
            let read = RecordingMetadata::read(&text).expect("metadata");
            let read = read.expect("a right one");
            // NaN is not equal to itself.
            assert_eq!(
                read.tare.map(|tare| rows(&tare.baseline)),
                Some(vec![vec![Some(0.5), None]])
            );
            assert_eq!(
                (read.rule, read.marks, read.unit, read.seconds_per_frame),
                (metadata.rule, metadata.marks, metadata.unit, Some(0.01))
            );
            assert_eq!(
                (read.ended, read.ended_by.as_deref()),
                (Some(true), Some("no room"))
            );
        }
    }

    #[test]
    fn metadata_with_any_numbers_can_be_read_again() {
        for number in [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e-13, 2e9, 1e301] {
            let metadata = RecordingMetadata {
                pitch_mm: Some([number, 2.0]),
                seconds_per_frame: Some(number),
                unit: Some("kPa".to_owned()),
                marks: vec![FrameMark {
                    number: 65,
                    time: Some(number).filter(|time| time.is_finite()),
                }],
                ..RecordingMetadata::default()
            };
            let text = metadata.text();
            let read = RecordingMetadata::read(&text).expect("metadata");
            let expected = RecordingMetadata {
                pitch_mm: None,
                seconds_per_frame: None,
                ..metadata
            };
            assert_eq!(read, Ok(expected), "{number}");
        }
    }

    #[test]
    fn a_tare_without_a_number_of_frames_is_of_one_frame() {
        for key in ["", "\"tare_frames\":0,"] {
            let text = format!("{{\"format\":\"{FORMAT}\",{key}\"tare\":[[0.5,2]]}}");
            let read = RecordingMetadata::read(text.as_bytes()).expect("metadata");
            let tare = read.expect("a right one").tare.expect("a tare");
            assert_eq!((tare.frames, tare.baseline.values()), (1, &[0.5, 2.0][..]));
        }
    }

    #[test]
    fn other_files_are_ignored_and_wrong_metadata_is_refused() {
        for other in ["", "[1]", "{\"format\":\"taxel-shape/1\"", "{}"] {
            assert_eq!(RecordingMetadata::read(other.as_bytes()), None, "{other}");
        }
        let wrong = |rest: &str| {
            let text = format!("{{\"format\":\"{FORMAT}\",{rest}}}");
            let read = RecordingMetadata::read(text.as_bytes()).expect("metadata");
            read.err()
                .map_or(String::from("right"), |error| error.to_string())
        };
        assert_eq!(wrong("\"marks\":[]"), "right");
        assert!(wrong("\"rule\":{\"percent\":0}").contains("above 0"));
        assert_eq!(wrong("\"rule\":{\"noise\":4,\"least\":4096}"), "right");
        for rule in ["noise", "percent"] {
            let rule = format!("\"rule\":{{\"{rule}\":4,\"least\":0}}");
            assert_ne!(wrong(&rule), "right", "{rule}");
        }
        assert!(
            wrong("\"tare_frames\":1,\"tare\":[[1],[2,3]]").contains("tare: row 2 has 2 values")
        );
        let newer = RecordingMetadata::read(b"{\"format\":\"taxel-touch/2\",\"tare\":7}");
        let error = newer.expect("metadata").expect_err("another version");
        assert_eq!(
            error.to_string(),
            "format: \"taxel-touch/2\" is unknown to this version, which reads \"taxel-touch/1\""
        );
        let unit = wrong("\"unit\":3");
        let expected = "line 1, column 34: invalid type: integer `3`, expected a string";
        assert_eq!(unit, expected);
        let list = format!("[\"{FORMAT}\",\"a source\"]");
        let read = RecordingMetadata::read(list.as_bytes()).expect("it names the format");
        let error = read.expect_err("a list").to_string();
        assert_eq!(error, "not a JSON object");
    }
}
