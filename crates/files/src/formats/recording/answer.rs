//! A frame with its imprint and descriptors as JSON: a line of `taxel frames --json` and of `taxel watch`.

use serde::ser::{Serialize, SerializeMap, Serializer};
use taxel_core::description::{Description, regions};
use taxel_core::frame::{Frame, Processed, SetRule};
use taxel_core::serialize::Shortest;

use crate::formats::json::RegionRecord;

/// An answer that serialises as an object:
/// ```text
/// {"frame":65,"label":66,"time":6.5,"channel":null,"sum":42,"max":9,
///  "rule":{"at_least":10,"from":"flag"},"imprint":[".###.",…],"na":5,"regions":[{"kind":"exterior",…}]}
/// ```
/// `sum` and `max` are those of the recorded values, in the recording's unit, before tare and gain; the imprint is
/// made after both. Without a rule, `rule`, `imprint` and `na` are null. With a tare, `tare` is the number of frames
/// of which it was made; with a gain, `gain` is true.
#[derive(Clone, Copy, Debug)]
pub struct FrameAnswer<'a> {
    /// The frame, for its number, label and time.
    pub frame: &'a Frame,
    /// The name of the frame's channel.
    pub channel: Option<&'a str>,
    /// The frame after processing.
    pub processed: Processed<'a>,
    /// The rule of the imprint.
    pub rule: Option<SetRule>,
    /// The number of frames of which the tare was made; 0 without a tare.
    pub tare: u64,
    /// Whether the tared values were multiplied by a gain.
    pub gain: bool,
}

impl<'a> FrameAnswer<'a> {
    /// Makes the answer for a frame and its processed form, without a channel, a rule, a tare or a
    /// gain.
    pub fn new(frame: &'a Frame, processed: Processed<'a>) -> Self {
        Self {
            frame,
            channel: None,
            processed,
            rule: None,
            tare: 0,
            gain: false,
        }
    }
}

/// There is no `Deserialize`: an answer is only written.
impl Serialize for FrameAnswer<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("frame", &self.frame.number)?;
        map.serialize_entry("label", &self.frame.label)?;
        map.serialize_entry("time", &self.frame.time.map(Shortest))?;
        map.serialize_entry("channel", &self.channel)?;
        map.serialize_entry("sum", &Shortest(self.processed.sum))?;
        map.serialize_entry("max", &self.processed.max.map(Shortest))?;
        if self.tare > 0 {
            map.serialize_entry("tare", &self.tare)?;
        }
        if self.gain {
            map.serialize_entry("gain", &true)?;
        }
        map.serialize_entry("rule", &self.rule)?;
        let imprint = self.processed.imprint.as_ref();
        map.serialize_entry("imprint", &imprint)?;
        map.serialize_entry("na", &imprint.map(taxel_core::imprint::Imprint::count))?;
        let regions = imprint.map_or_else(Vec::new, regions);
        let records = regions
            .iter()
            .map(|region| RegionRecord(Description::of(region)));
        map.serialize_entry("regions", &records.collect::<Vec<_>>())?;
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::frame::{FrameSize, Processing, Rule, RuleOrigin};

    use super::*;
    use crate::formats::json;

    #[test]
    fn without_a_rule_there_is_no_imprint() {
        let mut frame = Frame::new(FrameSize::new(2, 1).expect("an allowed size"));
        frame.values_mut().copy_from_slice(&[1.0, 2.5]);
        let mut processing = Processing::default();
        let answer = FrameAnswer {
            frame: &frame,
            channel: None,
            processed: processing.run(&frame).expect("it fits"),
            rule: None,
            tare: 0,
            gain: false,
        };
        assert_eq!(
            json::text(&answer),
            r#"{"frame":0,"label":null,"time":null,"channel":null,"sum":3.5,"max":2.5,"rule":null,"imprint":null,"na":null,"regions":[]}"#
        );
    }

    #[test]
    fn a_rule_is_written_with_its_threshold_and_origin() {
        let rule = |rule, least| {
            json::text(&SetRule {
                rule,
                least,
                from: RuleOrigin::Flag,
            })
        };
        assert_eq!(
            rule(
                Rule::Hysteresis {
                    low: 5.0,
                    high: 20.5
                },
                3
            ),
            r#"{"low":5,"high":20.5,"least":3,"from":"flag"}"#
        );
        assert_eq!(
            rule(Rule::Percent(25.0), 0),
            r#"{"percent":25,"from":"flag"}"#
        );
    }
}
