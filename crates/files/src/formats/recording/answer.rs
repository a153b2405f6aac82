//! A frame with its imprint and descriptors as a line: JSON of `taxel frames --json` and of `taxel watch`, or CSV.

use serde::ser::{Serialize, SerializeMap, Serializer};
use taxel_core::atlas::{feature_values, features};
use taxel_core::description::{Description, main_region, regions};
use taxel_core::frame::{Frame, Processed};
use taxel_core::imprint::Imprint;
use taxel_core::serialize::Shortest;

use crate::formats::json::RegionRecord;
use crate::formats::value::csv_line;

/// An answer that serialises as an object:
/// ```text
/// {"frame":65,"label":66,"time":6.5,"channel":null,"sum":42,"max":9,"force":31,"contact":5,"cop":[2.5,1.5],
///  "rule":{"at_least":10,"from":"flag"},"imprint":[".###.",…],"na":5,"regions":[{"kind":"exterior",…}]}
/// ```
/// `sum` and `max` are those of the recorded values, in the recording's unit, before tare and gain; the imprint is
/// made after both, and so are `force`, `contact` and `cop` ([`Processed`]). Without a rule, `rule`, `imprint` and `na`
/// are null. With a tare, `tare` is the number of frames of which it was made; with a gain, `gain` is true.
#[derive(Clone, Copy, Debug)]
pub struct FrameAnswer<'a> {
    /// The frame, for its number, label and time.
    pub frame: &'a Frame,
    /// The name of the frame's channel.
    pub channel: Option<&'a str>,
    /// The frame after processing.
    pub processed: Processed<'a>,
}

/// There is no `Deserialize`: an answer is only written.
impl Serialize for FrameAnswer<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (frame, processed) = (self.frame, &self.processed);
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("frame", &frame.number)?;
        map.serialize_entry("label", &frame.label)?;
        map.serialize_entry("time", &frame.time.map(Shortest))?;
        map.serialize_entry("channel", &self.channel)?;
        map.serialize_entry("sum", &Shortest(processed.sum))?;
        map.serialize_entry("max", &processed.max.map(Shortest))?;
        map.serialize_entry("force", &Shortest(processed.force))?;
        map.serialize_entry("contact", &processed.contact)?;
        map.serialize_entry("cop", &processed.cop)?;
        if processed.tare > 0 {
            map.serialize_entry("tare", &processed.tare)?;
        }
        if processed.gain {
            map.serialize_entry("gain", &true)?;
        }
        map.serialize_entry("rule", &processed.rule)?;
        let imprint = processed.imprint.as_ref();
        map.serialize_entry("imprint", &imprint)?;
        map.serialize_entry("na", &imprint.map(Imprint::count))?;
        let regions = imprint.map_or_else(Vec::new, regions);
        let records = regions
            .iter()
            .map(|region| RegionRecord(Description::of(region)));
        map.serialize_entry("regions", &records.collect::<Vec<_>>())?;
        map.end()
    }
}

/// The columns before those of the descriptors.
const COLUMNS: [&str; 10] = [
    "frame", "label", "time", "channel", "sum", "max", "force", "contact", "cop_x", "cop_y",
];

impl FrameAnswer<'_> {
    /// Returns the names of the columns of [`Self::csv_line`] as a line of CSV.
    pub fn csv_header() -> String {
        let descriptors = features().iter().map(|feature| feature.key.clone());
        csv_line(COLUMNS.map(str::to_owned).into_iter().chain(descriptors))
    }

    /// Returns the frame as a line of CSV: the numbers of the JSON form, and the descriptors of the main region. A field
    /// is empty if the value does not exist; so are all descriptors without an active taxel.
    pub fn csv_line(&self) -> String {
        let (frame, processed) = (self.frame, &self.processed);
        let optional = |value: Option<f64>| value.map_or_else(String::new, |own| own.to_string());
        let label = frame.label.as_ref().map(ToString::to_string);
        let mut fields = vec![
            frame.number.to_string(),
            label.unwrap_or_default(),
            optional(frame.time),
            self.channel.unwrap_or_default().to_owned(),
            processed.sum.to_string(),
            optional(processed.max),
            processed.force.to_string(),
            processed.contact.to_string(),
            optional(processed.cop.map(|[x, _]| x)),
            optional(processed.cop.map(|[_, y]| y)),
        ];
        fields.resize(COLUMNS.len() + features().len(), String::new());
        let regions = processed.imprint.as_ref().map_or_else(Vec::new, regions);
        if let Some(main) = main_region(&regions) {
            feature_values(&Description::of(&regions[main]), |index, value| {
                fields[COLUMNS.len() + index] = value.to_string();
            });
        }
        csv_line(fields)
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::frame::{FrameSize, Processing, Rule, RuleOrigin, SetRule};

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
        };
        assert_eq!(
            json::text(&answer),
            r#"{"frame":0,"label":null,"time":null,"channel":null,"sum":3.5,"max":2.5,"force":3.5,"contact":2,"cop":[1.2142857142857142,0.5],"rule":null,"imprint":null,"na":null,"regions":[]}"#
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
