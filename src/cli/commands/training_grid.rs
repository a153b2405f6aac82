//! The sensor and the poses of a training. Those that are not given are chosen so that no shape is cut off.
//!
//! ```text
//! --columns, --rows   given: that side; otherwise the smallest beyond which nothing is gained, at least 16
//! --x0, --y0          given: these positions; otherwise one cell around the middle, in steps of --positions
//! ```

use crate::cli::arguments::model::train::TrainArguments;
use crate::cli::error::CliError;
use crate::pose::{Anchor, Axis, GivenRanges, Ranges, Reach, SensorSides, check_given};
use crate::recognition::{CellPositions, LEAST_SIDE, NamedShape};
use crate::sensor::Sensor;
use crate::source::Source;

pub(super) struct TrainingGrid {
    pub(super) sensor: Sensor,
    pub(super) anchor: Anchor,
    pub(super) ranges: Ranges,
    pub(super) remedy: &'static str,
}

impl TrainingGrid {
    /// Returns the grid for some shapes. If neither x0 nor y0 is given, the anchor is the centre, since a shape's
    /// centre stays in place when it turns: one cell is then enough for all positions.
    pub(super) fn of(asked: &TrainArguments, shapes: &[NamedShape]) -> Result<Self, CliError> {
        let given = &asked.ranges;
        let placed = given[Axis::X0].is_some() || given[Axis::Y0].is_some();
        let usual = if placed {
            Anchor::Corner
        } else {
            Anchor::Centre
        };
        let anchor = asked.anchor.unwrap_or(usual);
        check_given(given, &asked.sides.largest())?;
        let sources: Vec<&Source> = shapes.iter().map(|shape| &shape.source).collect();
        let reach = Reach::of_all(sources.iter().copied(), anchor, given)?;
        let step = asked.positions.unwrap_or(CellPositions::FINE).step();
        let (sensor, ranges) = reach.best_sensor(&sources, given, asked.sides, step);
        let holds = |sides: SensorSides, given: &GivenRanges| {
            let sensor = reach.smallest_sensor(&sources, given, sides, step);
            sensor.is_some()
        };
        Ok(Self {
            sensor: asked.given.sensor(sensor)?,
            anchor,
            ranges,
            remedy: remedy(asked, holds),
        })
    }
}

/// Returns advice in case the sensor cuts off poses. `holds` tells whether some sensor with these sides holds the
/// shapes at these positions.
fn remedy(
    asked: &TrainArguments,
    holds: impl Fn(SensorSides, &GivenRanges) -> bool,
) -> &'static str {
    let any = SensorSides::at_least(LEAST_SIDE);
    let elsewhere = asked.ranges.with(Axis::X0, None).with(Axis::Y0, None);
    match (holds(any, &asked.ranges), holds(asked.sides, &elsewhere)) {
        (true, true) => "use a larger sensor or other positions",
        (true, false) => "use a larger sensor",
        (false, true) => "use other positions",
        (false, false) if holds(any, &elsewhere) => "use a larger sensor and other positions",
        (false, false) => "use smaller shapes",
    }
}
