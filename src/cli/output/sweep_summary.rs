//! The summary of a sweep or a merge: as text, and as one line of JSON.

use std::iter;
use std::time::Duration;

use serde::Serialize;
use taxel_core::atlas::{STATISTIC_COLUMNS, StatisticColumn};
use taxel_core::pose::{Axis, Ranges};
use taxel_core::sweep::{Shard, SweepResult};
use taxel_files::formats::json;
use taxel_files::formats::value::{counted, grouped};

use crate::cli::output::charset::Charset;
use crate::cli::output::table::{Record, table};

#[derive(Serialize)]
struct SummaryJson<'a> {
    poses: u64,
    ranges: Record<'a, String>,
    shard: String,
    distinct: usize,
    distinct_shifts: usize,
    distinct_symmetry: usize,
    partly_off: u64,
    empty: u64,
    seconds: f64,
    descriptors: Record<'a, Record<'a, Option<f64>>>,
}

/// Returns the summary: for people, or as a line of JSON.
pub(crate) fn of(result: &SweepResult, took: Duration, as_json: bool) -> String {
    if as_json {
        return json(result, took);
    }
    text(result, took)
}

fn json(result: &SweepResult, took: Duration) -> String {
    let SweepResult { grid, atlas, .. } = result;
    let range = |axis: Axis| (axis.name(), grid.ranges()[axis].to_string());
    let classes = atlas.distinct_classes();
    let descriptors = result.statistics.iter().map(|row| {
        let value = |column: &StatisticColumn| (column.key, (column.value)(row));
        let values = STATISTIC_COLUMNS.iter().map(value).collect();
        (&*row.feature.key, Record(values))
    });
    let summary = SummaryJson {
        poses: result.poses,
        ranges: Record(grid.axes().map(range).collect()),
        shard: result.shard.to_string(),
        distinct: atlas.len(),
        distinct_shifts: classes.up_to_shifts,
        distinct_symmetry: classes.up_to_symmetry,
        partly_off: result.partly_off,
        empty: atlas.empty_poses(),
        seconds: took.as_secs_f64(),
        descriptors: Record(descriptors.collect()),
    };
    json::text(&summary) + "\n"
}

fn text(result: &SweepResult, took: Duration) -> String {
    let SweepResult { grid, atlas, .. } = result;
    let part = match result.shard {
        Shard::WHOLE => String::new(),
        shard => format!(", shard {shard}"),
    };
    // A picture is swept at its own size unless zooms are given, so zooms of one value are not shown.
    let ranges = grid.axes();
    let ranges = ranges.filter(|&axis| grid.counts()[axis] > 1 || !axis.is_zoom());
    let classes = atlas.distinct_classes();
    let text = format!(
        "{}{part}: {}\n\
         {}, {} up to shifts, {} up to quarter turns and mirror images too\n\
         {} cut off by the sensor, {} without an imprint; {:.2} s\n\n",
        counted(result.poses, "pose"),
        ranges_in_words(ranges, grid.ranges()),
        counted(atlas.len() as u64, "distinct imprint"),
        grouped(classes.up_to_shifts as u64),
        grouped(classes.up_to_symmetry as u64),
        counted(result.partly_off, "pose"),
        counted(atlas.empty_poses(), "pose"),
        took.as_secs_f64(),
    );
    let mut rows = vec![vec![String::new()]];
    rows[0].extend(
        STATISTIC_COLUMNS
            .iter()
            .map(|column| column.title.to_owned()),
    );
    for row in &result.statistics {
        let values = STATISTIC_COLUMNS.iter().map(|column| (column.value)(row));
        let values = values.map(|own| own.map_or("–".to_owned(), |own| format!("{own:.4}")));
        rows.push(iter::once(row.feature.key.clone()).chain(values).collect());
    }
    Charset::current().lines(&text) + &table(&rows, &[0])
}

pub(crate) fn ranges_in_words(axes: impl Iterator<Item = Axis>, ranges: &Ranges) -> String {
    let words = axes.map(|axis| {
        let unit = axis.parameter().row().unit;
        format!("{} {}", axis.name(), unit.after(&ranges[axis].to_string()))
    });
    words.collect::<Vec<_>>().join(", ")
}
