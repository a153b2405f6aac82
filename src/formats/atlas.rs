//! An atlas as a table: CSV, a line per imprint, or JSON lines.
//!
//! Columns of the CSV: `id`, `count`, `share` of all poses, the first pose (`first_x0` and so on, zooms for pictures
//! only), `pieces`, `holes`, each quantity of [`crate::atlas::feature`] (empty where it does not exist), and
//! `imprint`, its rows of `#` and `.` from the top with `/` between them.

use std::io::{self, Write};

use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::atlas::Entry;
use crate::atlas::feature::{quantities, values};
use crate::formats::described::{RegionRecord, Rows};
use crate::parameter::Parameter;
use crate::pose::grid::{Grid, Pose};
use crate::sweep::survey::Survey;

/// The parameters of a pose of this grid.
pub(crate) fn place(grid: &Grid) -> impl Iterator<Item = Parameter> {
    let own = grid.source().parameters();
    let rows = grid.ranges().by_parameter().map(|(parameter, _)| parameter);
    rows.into_iter()
        .filter(move |parameter| own.contains(parameter))
}

/// One value of a pose.
pub fn value(pose: &Pose, parameter: Parameter) -> f64 {
    match parameter {
        Parameter::X0 => pose.x0,
        Parameter::Y0 => pose.y0,
        Parameter::ZoomX => pose.zoom_x,
        Parameter::ZoomY => pose.zoom_y,
        _ => pose.angle,
    }
}

/// The share of all poses that leave this imprint, above 0, up to 1.
#[expect(clippy::cast_precision_loss, reason = "the nearest f64 is wanted")]
pub fn share(survey: &Survey, entry: &Entry) -> f64 {
    entry.count as f64 / survey.poses as f64
}

/// Writes the table as CSV.
///
/// # Errors
/// Those of the writer.
pub fn write_csv(survey: &Survey, output: impl Write) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(output);
    let mut line = vec!["id".to_owned(), "count".to_owned(), "share".to_owned()];
    line.extend(place(&survey.grid).map(|parameter| format!("first_{}", parameter.row().key)));
    line.extend(["pieces", "holes"].map(str::to_owned));
    line.extend(quantities().iter().map(|quantity| quantity.key.clone()));
    line.push("imprint".to_owned());
    table.write_record(&line)?;
    for entry in survey.atlas.entries() {
        let pose = survey.grid.pose(entry.first_pose);
        line.clear();
        line.extend([entry.id.to_string(), entry.count.to_string()]);
        line.push(share(survey, &entry).to_string());
        line.extend(place(&survey.grid).map(|parameter| value(&pose, parameter).to_string()));
        line.extend([entry.note.pieces, entry.note.holes].map(|count| count.to_string()));
        let first = line.len();
        line.resize(first + quantities().len(), String::new());
        if let Some(description) = &entry.note.description {
            values(description, |index, value| {
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
/// Those of the writer.
pub fn write_jsonl(survey: &Survey, mut output: impl Write) -> io::Result<()> {
    for entry in survey.atlas.entries() {
        serde_json::to_writer(&mut output, &Line(survey, &entry))?;
        output.write_all(b"\n")?;
    }
    output.flush()
}

struct Line<'a>(&'a Survey, &'a Entry);

impl Serialize for Line<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self(survey, entry) = *self;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("id", &entry.id)?;
        map.serialize_entry("count", &entry.count)?;
        map.serialize_entry("share", &share(survey, entry))?;
        map.serialize_entry("first", &First(&survey.grid, entry.first_pose))?;
        map.serialize_entry("pieces", &entry.note.pieces)?;
        map.serialize_entry("holes", &entry.note.holes)?;
        map.serialize_entry("main", &entry.note.description.map(RegionRecord))?;
        map.serialize_entry("imprint", &Rows(&entry.imprint))?;
        map.end()
    }
}

struct First<'a>(&'a Grid, u64);

impl Serialize for First<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let pose = self.0.pose(self.1);
        let mut map = serializer.serialize_map(None)?;
        for parameter in place(self.0) {
            map.serialize_entry(parameter.row().key, &value(&pose, parameter))?;
        }
        map.end()
    }
}
