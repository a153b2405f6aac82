//! `taxel figure`: touches a figure once.

use taxel_core::figure::FigureKind;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::touch::Plane;
use taxel_files::formats::StoredShape;

use crate::cli::Context;
use crate::cli::arguments::flags::one_of;
use crate::cli::arguments::parameters::{FigureFlags, SensorFlags};
use crate::cli::commands::export::{KeepFlags, Kept, drawing};
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
        let kept = self.keep.kept(self.json)?;
        touch(&figure, sensor, pitch, self.json, &kept, cx)
    }
}

/// Touches a shape and prints the imprint with its descriptors, or the exported file instead. What the sensor cuts off
/// and what else was done is said in the table, or without one, on standard error.
pub(crate) fn touch(
    source: &Source,
    sensor: Sensor,
    pitch: Option<f64>,
    json: bool,
    kept: &Kept,
    cx: &Context,
) -> Result<(), Failure> {
    let imprint = Plane::new(sensor).touch(source);
    let made = source.to_string();
    let mut notes: Vec<String> = report::beyond(source, &sensor).into_iter().collect();
    let beyond = notes.len();
    let drawn = || drawing(&imprint, Some(source), &made, pitch);
    let shape = |name| StoredShape {
        name,
        sensor,
        imprint,
        source: Some(source.clone()),
    };
    let instead = kept.keep(drawn, shape, &cx.shelf, &mut notes)?;
    if instead.is_none() && !json {
        notes.insert(beyond, report::size(&imprint, Some(&sensor), pitch));
        notes.insert(0, made);
        return cx.print(&report::table(&imprint, &notes, pitch));
    }
    cx.write(&instead.unwrap_or_else(|| report::json(&imprint).into_bytes()))?;
    for note in &notes {
        cx.note(note);
    }
    Ok(())
}
