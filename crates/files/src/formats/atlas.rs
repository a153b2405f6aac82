//! An atlas as a table (CSV, a line per imprint), as JSON lines, and as an archive of numpy arrays (`numpy.load`), which
//! can be read back and merged.
//!
//! Columns of the CSV: `id`, `count`, `share` of all poses, the first pose (`first_x0` and so on, zooms for pictures
//! only), `pieces`, `holes`, each feature of [`taxel_core::atlas::features`] (empty where it does not exist), and
//! `imprint`, its rows of `#` and `.` from the top with `/` between them.
//!
//! In the archive, per imprint, in order: `rows` (a word per row of the sensor, bit `i` for column `i`; shaped imprints
//! × rows), `count`, `first_pose` (its number in the grid), `first` (its values; imprints × parameters), `pieces`,
//! `holes` and an array for each feature, with NaN where the feature does not exist, since arrays have no other way to
//! say this. Before them comes `header`, JSON as bytes: format, source, sensor, anchor, ranges, shard and the number of
//! poses; and at the end `spread`, the sums by which shards are merged. The archive is a zip without compression and
//! without dates, so equal atlases are equal files.

use std::io::{self, Read, Seek, Write};

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use taxel_core::atlas::{Atlas, AtlasEntry, ImprintSummary, feature_values, features};
use taxel_core::parameter::number::share;
use taxel_core::pose::PoseGrid;
use taxel_core::sweep::{Parts, SweepResult};

use crate::error::ReadError;
use crate::formats::header::{ATLAS_FORMAT, ArchiveHeader};
use crate::formats::json::RegionRecord;
use crate::formats::numpy::Number;
use crate::formats::numpy::archive::{ArrayReader, ArrayWriter, in_header, little_endian};
use crate::formats::record::no_names;
use crate::formats::value::csv_line;

/// Returns the share of all poses that leave this imprint: above 0, up to 1.
pub fn pose_share(result: &SweepResult, entry: &AtlasEntry) -> f64 {
    share(entry.count.into(), result.poses.into())
}

/// Writes the table as CSV.
///
/// # Errors
/// Returns the errors of the writer.
pub fn write_csv(result: &SweepResult, mut output: impl Write) -> io::Result<()> {
    let mut line = vec!["id".to_owned(), "count".to_owned(), "share".to_owned()];
    line.extend(
        result
            .grid
            .axes()
            .map(|axis| format!("first_{}", axis.name())),
    );
    line.extend(["pieces", "holes"].map(str::to_owned));
    line.extend(features().iter().map(|feature| feature.key.clone()));
    line.push("imprint".to_owned());
    output.write_all(csv_line(&line).as_bytes())?;
    for entry in result.atlas.entries() {
        let pose = result.grid.pose(entry.first_pose);
        line.clear();
        line.extend([entry.id.to_string(), entry.count.to_string()]);
        line.push(pose_share(result, &entry).to_string());
        line.extend(result.grid.axes().map(|axis| pose[axis].to_string()));
        line.extend([entry.summary.pieces, entry.summary.holes].map(|count| count.to_string()));
        let first = line.len();
        line.resize(first + features().len(), String::new());
        if let Some(description) = &entry.summary.description {
            feature_values(description, |index, value| {
                line[first + index] = value.to_string();
            });
        }
        line.push(entry.imprint.lines().collect::<Vec<_>>().join("/"));
        output.write_all(csv_line(&line).as_bytes())?;
    }
    output.flush()
}

/// Writes a line of JSON per imprint:
/// `{"id":0,"count":7,"share":…,"first":{"x0":…},"pieces":1,"holes":0,"main":{…},"imprint":[…]}`, with the main region
/// as in the answers of `taxel batch`, `null` for an empty imprint.
///
/// # Errors
/// Returns the errors of the writer.
pub fn write_jsonl(result: &SweepResult, mut output: impl Write) -> io::Result<()> {
    for entry in result.atlas.entries() {
        serde_json::to_writer(&mut output, &AtlasLine(result, &entry))?;
        output.write_all(b"\n")?;
    }
    output.flush()
}

struct AtlasLine<'a>(&'a SweepResult, &'a AtlasEntry);

impl Serialize for AtlasLine<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self(result, entry) = *self;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("id", &entry.id)?;
        map.serialize_entry("count", &entry.count)?;
        map.serialize_entry("share", &pose_share(result, entry))?;
        map.serialize_entry("first", &First(&result.grid, entry.first_pose))?;
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

/// Writes the archive.
///
/// # Errors
/// Returns the errors of the writer.
pub fn write(result: &SweepResult, mut output: impl Write + Seek) -> io::Result<()> {
    let (grid, parts) = (&result.grid, result.parts());
    let mut archive = ArrayWriter::new(&mut output, &header(result, &parts))?;
    let count = parts.counts.len() as u64;
    let shape = [count, grid.sensor().rows().into()];
    archive.add("rows", Number::U64, &shape, &little_endian(&parts.rows))?;
    archive.add_words("count", &parts.counts)?;
    archive.add_words("first_pose", &parts.first_poses)?;
    let axes: Vec<_> = grid.axes().collect();
    let mut first = Vec::new();
    for &number in &parts.first_poses {
        let pose = grid.pose(number);
        let values = axes.iter().map(|&axis| pose[axis]);
        first.extend(values.flat_map(f64::to_le_bytes));
    }
    archive.add("first", Number::F64, &[count, axes.len() as u64], &first)?;
    let pieces = regions_of_each(&result.atlas, |summary| summary.pieces);
    archive.add("pieces", Number::U16, &[count], &pieces)?;
    let holes = regions_of_each(&result.atlas, |summary| summary.holes);
    archive.add("holes", Number::U16, &[count], &holes)?;
    for (feature, column) in features().iter().zip(feature_columns(&result.atlas)) {
        archive.add(&feature.key, Number::F64, &[count], &column)?;
    }
    archive.add_words("spread", &parts.variance_words)?;
    archive.finish()
}

fn header(result: &SweepResult, parts: &Parts) -> Vec<u8> {
    let grid = &result.grid;
    let own = (grid.sensor(), grid.anchor(), grid.ranges(), result.shard);
    let mut header = ArchiveHeader::new(ATLAS_FORMAT, own, parts.poses);
    header.source = Some(grid.source());
    header.partly_off = Some(parts.partly_off);
    header.bytes()
}

fn regions_of_each(atlas: &Atlas, number: fn(&ImprintSummary) -> u16) -> Vec<u8> {
    let summaries = atlas.entries().map(|entry| entry.summary);
    summaries
        .flat_map(|summary| number(&summary).to_le_bytes())
        .collect()
}

/// Returns an array for each feature, as bytes: its value for each imprint, NaN where it does not exist.
fn feature_columns(atlas: &Atlas) -> Vec<Vec<u8>> {
    let mut columns = vec![Vec::with_capacity(atlas.len() * 8); features().len()];
    for entry in atlas.entries() {
        let mut row = vec![f64::NAN; columns.len()];
        if let Some(description) = &entry.summary.description {
            feature_values(description, |index, value| row[index] = value);
        }
        for (column, value) in columns.iter_mut().zip(row) {
            column.extend(value.to_le_bytes());
        }
    }
    columns
}

/// Reads an archive.
///
/// # Errors
/// Returns an error if it is not an atlas; the input may be any bytes.
pub fn read(input: impl Read + Seek) -> Result<SweepResult, ReadError> {
    let mut archive = ArrayReader::new(input)?;
    let header = archive.header(ATLAS_FORMAT)?;
    let (sensor, anchor, ranges, shard) = header.grid()?;
    let (Some(source), Some(partly_off), None) = (header.source, header.partly_off, header.shapes)
    else {
        return Err(in_header("expected source and partly_off, and no shapes"));
    };
    let source = source.source(&sensor, Some(sensor.pitch_mm()), &no_names);
    let source = source.map_err(in_header)?;
    let grid = PoseGrid::new(source, sensor, anchor, ranges).map_err(in_header)?;
    let parts = Parts {
        poses: header.poses,
        partly_off,
        rows: archive.words("rows")?,
        counts: archive.words("count")?,
        first_poses: archive.words("first_pose")?,
        variance_words: archive.words("spread")?,
    };
    archive.finish()?;
    SweepResult::from_parts(grid, shard, &parts).map_err(|error| ReadError::new(error.to_string()))
}
