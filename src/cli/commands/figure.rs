//! `taxel figure`: touches a figure once.

use taxel_core::figure::FigureKind;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::touch::Plane;
use taxel_files::formats::StoredShape;

use crate::cli::Context;
use crate::cli::arguments::flags::one_of;
use crate::cli::arguments::parameters::{FigureFlags, SensorFlags};
use crate::cli::commands::export::{KeepFlags, drawing};
use crate::cli::failure::Failure;
use crate::cli::output::report;

const EXAMPLES: &str = "\
The ranges are for a sensor of 16 x 16; for another sensor, replace 16 with its
larger side. A flag that you leave out has its default.

Examples:
  taxel figure ellipse --x0 1.99 --y0 1.47 --thickness 2
  taxel figure rectangle --length 6 --width 3 --angle 30 --pitch 2.5
  taxel figure triangle --side 5 --x0 -0.8 --columns 32 --rows 8 --json
  taxel figure hexagon --side 6 --thickness 2.5 --save \"my nut\"
  taxel figure ellipse --angle 30 --radius-x 6 --export oval.svg";

/// Touch a figure and describe its imprint
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Figure {
    /// Kind of figure
    #[arg(value_name = "KIND", value_parser = one_of::<FigureKind, _>(FigureKind::names()))]
    kind: FigureKind,
    #[command(flatten)]
    values: FigureFlags,
    #[command(flatten)]
    sensor: SensorFlags,
    #[command(flatten)]
    keep: KeepFlags,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
}

impl Figure {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let sensor = self.sensor.sensor(cx.settings.sensor.sensor)?;
        let figure = Source::Figure(self.values.figure(self.kind, &sensor)?);
        let pitch = self.sensor.pitch(&cx.settings)?.of(Some(&sensor));
        touch(&figure, sensor, pitch, self.json, &self.keep, cx)
    }
}

/// Touches a shape and prints the imprint with its descriptors. What the sensor cuts off and what else was done is said
/// in the table, or with JSON, on standard error.
pub(crate) fn touch(
    source: &Source,
    sensor: Sensor,
    pitch: Option<f64>,
    json: bool,
    keep: &KeepFlags,
    cx: &Context,
) -> Result<(), Failure> {
    let imprint = Plane::new(sensor).touch(source);
    let made = source.to_string();
    let drawn = || drawing(&imprint, Some(source), &made, pitch);
    let shape = |name| StoredShape {
        name,
        sensor,
        imprint,
        source: Some(source.clone()),
    };
    let kept = keep.keep(drawn, shape, &cx.shelf)?;
    let beyond = report::beyond(source, &sensor);
    if json {
        cx.print(&report::json(&imprint))?;
        beyond.iter().chain(&kept).for_each(|note| cx.note(note));
        return Ok(());
    }
    let mut lines = vec![made];
    lines.extend(beyond);
    lines.push(report::size(&imprint, Some(&sensor), pitch));
    lines.extend(kept);
    cx.print(&report::table(&imprint, &lines, pitch))
}
