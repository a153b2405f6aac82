//! The summary of a sweep: as text, and as one line of JSON. `–` marks a value that does not exist.

use std::fmt::Write;
use std::time::Duration;

use serde::ser::{Serialize, SerializeMap, Serializer};
use taxel_core::atlas::{DistinctClasses, STATISTIC_COLUMNS, Statistic, StatisticColumn};
use taxel_core::pose::{Axis, PoseGrid, Ranges};
use taxel_core::sweep::SweepResult;
use taxel_files::formats::json;
use taxel_files::formats::value::{counted, grouped};

use crate::cli::output::charset::Charset;

pub(crate) struct SweepSummary<'a> {
    result: &'a SweepResult,
    classes: DistinctClasses,
    took: Duration,
}

impl<'a> SweepSummary<'a> {
    pub(crate) fn new(result: &'a SweepResult, took: Duration) -> Self {
        Self {
            result,
            classes: result.atlas.distinct_classes(),
            took,
        }
    }

    pub(crate) fn json(&self) -> String {
        let mut line = json::text(self);
        line.push('\n');
        line
    }

    pub(crate) fn text(&self, charset: Charset) -> String {
        let SweepResult {
            grid,
            poses,
            partly_off,
            atlas,
            statistics,
            shard,
            ..
        } = self.result;
        let mut text = String::new();
        let mut line = |line: &str| {
            text.push_str(charset.line(line).trim_end());
            text.push('\n');
        };
        let part = match shard.of() {
            1 => String::new(),
            _ => format!(", shard {shard}"),
        };
        // A picture is swept at its own size unless zooms are given, so zooms of one value are not shown.
        let ranges = grid.axes();
        let ranges = ranges.filter(|&axis| grid.counts()[axis] > 1 || !axis.is_zoom());
        line(&format!(
            "{}{part}: {}",
            counted(*poses, "pose"),
            ranges_in_words(ranges, grid.ranges())
        ));
        let number = |count: usize| grouped(count as u64);
        line(&format!(
            "{}, {} up to shifts, {} up to quarter turns and mirror images too",
            counted(atlas.len() as u64, "distinct imprint"),
            number(self.classes.up_to_shifts),
            number(self.classes.up_to_symmetry)
        ));
        line(&format!(
            "{} cut off by the sensor, {} without an imprint; {:.2} s",
            counted(*partly_off, "pose"),
            counted(atlas.empty_poses(), "pose"),
            self.took.as_secs_f64()
        ));
        line("");
        let mut row = format!("{:<16}", "");
        for column in STATISTIC_COLUMNS {
            // Cannot fail: the text is kept in memory.
            let _ = write!(row, "{:>11}", column.title);
        }
        line(&row);
        for statistic in statistics {
            let mut row = format!("{:<16}", statistic.feature.key);
            for column in STATISTIC_COLUMNS {
                let value = (column.value)(statistic)
                    .map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
                let value = charset.line(&value).into_owned();
                let _ = write!(row, "{value:>11}");
            }
            line(&row);
        }
        text
    }
}

impl Serialize for SweepSummary<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let result = self.result;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("poses", &result.poses)?;
        map.serialize_entry("ranges", &GridRanges(&result.grid))?;
        map.serialize_entry("shard", &result.shard.to_string())?;
        map.serialize_entry("distinct", &result.atlas.len())?;
        map.serialize_entry("distinct_shifts", &self.classes.up_to_shifts)?;
        map.serialize_entry("distinct_symmetry", &self.classes.up_to_symmetry)?;
        map.serialize_entry("partly_off", &result.partly_off)?;
        map.serialize_entry("empty", &result.atlas.empty_poses())?;
        map.serialize_entry("seconds", &self.took.as_secs_f64())?;
        map.serialize_entry("descriptors", &Descriptors(&result.statistics))?;
        map.end()
    }
}

struct GridRanges<'a>(&'a PoseGrid);

impl Serialize for GridRanges<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let range = |axis: Axis| (axis.name(), self.0.ranges()[axis].to_string());
        serializer.collect_map(self.0.axes().map(range))
    }
}

struct Descriptors<'a>(&'a [Statistic]);

impl Serialize for Descriptors<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rows = self.0.iter();
        serializer.collect_map(rows.map(|row| (&row.feature.key, FeatureStatistics(row))))
    }
}

struct FeatureStatistics<'a>(&'a Statistic);

impl Serialize for FeatureStatistics<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let value = |column: &StatisticColumn| (column.key, (column.value)(self.0));
        serializer.collect_map(STATISTIC_COLUMNS.iter().map(value))
    }
}

pub(crate) fn ranges_in_words(axes: impl Iterator<Item = Axis>, ranges: &Ranges) -> String {
    let words = axes.map(|axis| {
        let unit = axis.parameter().row().unit;
        format!("{} {}", axis.name(), unit.after(&ranges[axis].to_string()))
    });
    words.collect::<Vec<_>>().join(", ")
}
