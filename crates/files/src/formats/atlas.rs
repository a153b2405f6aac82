//! An atlas as a table: CSV, a line per imprint, or JSON lines.
//!
//! Columns of the CSV: `id`, `count`, `share` of all poses, the first pose (`first_x0` and so on, zooms for pictures
//! only), `pieces`, `holes`, each feature of [`crate::atlas::features`] (empty where it does not exist), and
//! `imprint`, its rows of `#` and `.` from the top with `/` between them.

use std::io::{self, Write};

use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::atlas::{AtlasEntry, feature_values, features};
use crate::formats::described::RegionRecord;
use crate::parameter::number::share;
use crate::pose::PoseGrid;
use crate::sweep::SweepResult;

/// Returns the share of all poses that leave this imprint: above 0, up to 1.
pub fn pose_share(result: &SweepResult, entry: &AtlasEntry) -> f64 {
    share(entry.count.into(), result.poses().into())
}

/// Writes the table as CSV.
///
/// # Errors
/// Returns the errors of the writer.
pub fn write_csv(result: &SweepResult, output: impl Write) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(output);
    let mut line = vec!["id".to_owned(), "count".to_owned(), "share".to_owned()];
    line.extend(
        result
            .grid()
            .axes()
            .map(|axis| format!("first_{}", axis.name())),
    );
    line.extend(["pieces", "holes"].map(str::to_owned));
    line.extend(features().iter().map(|feature| feature.key.clone()));
    line.push("imprint".to_owned());
    table.write_record(&line)?;
    for entry in result.atlas().entries() {
        let pose = result.grid().pose(entry.first_pose);
        line.clear();
        line.extend([entry.id.to_string(), entry.count.to_string()]);
        line.push(pose_share(result, &entry).to_string());
        line.extend(result.grid().axes().map(|axis| pose[axis].to_string()));
        line.extend([entry.summary.pieces, entry.summary.holes].map(|count| count.to_string()));
        let first = line.len();
        line.resize(first + features().len(), String::new());
        if let Some(description) = &entry.summary.description {
            feature_values(description, |index, value| {
                line[first + index] = value.to_string();
            });
        }
        line.push(entry.imprint.lines().collect::<Vec<_>>().join("/"));
        table.write_record(&line)?;
    }
    table.flush()
}

/// Writes a line of JSON per imprint:
/// `{"id":0,"count":7,"share":…,"first":{"x0":…},"pieces":1,"holes":0,"main":{…},"imprint":[…]}`, with the main region
/// as in the answers of `taxel batch`, `null` for an empty imprint.
///
/// # Errors
/// Returns the errors of the writer.
pub fn write_jsonl(result: &SweepResult, mut output: impl Write) -> io::Result<()> {
    for entry in result.atlas().entries() {
        serde_json::to_writer(&mut output, &AtlasLine(result, &entry))?;
        output.write_all(b"\n")?;
    }
    output.flush()
}

/// An imprint of an atlas as a line of JSON.
struct AtlasLine<'a>(&'a SweepResult, &'a AtlasEntry);

impl Serialize for AtlasLine<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self(result, entry) = *self;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("id", &entry.id)?;
        map.serialize_entry("count", &entry.count)?;
        map.serialize_entry("share", &pose_share(result, entry))?;
        map.serialize_entry("first", &First(result.grid(), entry.first_pose))?;
        map.serialize_entry("pieces", &entry.summary.pieces)?;
        map.serialize_entry("holes", &entry.summary.holes)?;
        map.serialize_entry("main", &entry.summary.description.map(RegionRecord))?;
        map.serialize_entry("imprint", &entry.imprint)?;
        map.end()
    }
}

/// The first pose that leaves an imprint: a value for each axis that the shape has.
struct First<'a>(&'a PoseGrid, u64);

impl Serialize for First<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let pose = self.0.pose(self.1);
        let mut map = serializer.serialize_map(None)?;
        for axis in self.0.axes() {
            map.serialize_entry(axis.name(), &pose[axis])?;
        }
        map.end()
    }
}
