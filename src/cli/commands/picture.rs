//! `taxel picture`: moves, zooms and turns a stored shape or an outline, and touches it once.

use std::ffi::OsString;

use crate::cli::Context;
use crate::cli::arguments::flags::name_or_path;
use crate::cli::arguments::parameters::{OwnSensorFlags, PictureFlags};
use crate::cli::commands::export::KeepFlags;
use crate::cli::commands::figure::touch;
use crate::cli::failure::Failure;
use crate::cli::input::outlines::OutlineFlags;

const EXAMPLES: &str = "\
If a stored shape and a file have the same name, taxel uses the shape. A file
holds a stored shape, an imprint or an outline. A stored shape keeps its sensor;
an imprint gets a sensor of 16 x 16, or of its own size if that is larger.
Without flags, the picture stays as it is.

An outline is an SVG, whose filled shapes count, or a CSV of points: x,y a line,
and an empty line between rings. It lies in the middle of the sensor. A shape
stored with its outline is touched as that, not as the squares of its imprint;
with another --pitch, an outline in mm has another size in cells.

Examples:
  taxel picture washer --x0 6 --y0 4.5
  taxel picture key --angle 30 --zoom-x 0.8 --zoom-y 0.8 --json
  taxel picture imprint.txt --x0 2 --save \"moved imprint\"
  taxel picture parts/bracket.svg --pitch 2.5 --angle 30
  taxel picture points.csv --unit mm --y-up --pitch 2.5";

/// Move, zoom and turn a shape or an outline, and describe it
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Picture {
    /// Shape of the library, or file; '-' for standard input
    #[arg(value_name = "NAME|FILE", value_parser = name_or_path())]
    what: OsString,
    #[command(flatten)]
    values: PictureFlags,
    #[command(flatten)]
    sensor: OwnSensorFlags,
    #[command(flatten)]
    outlines: OutlineFlags,
    #[command(flatten)]
    keep: KeepFlags,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
}

impl Picture {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let (what, values) = (&self.what, &self.values);
        let (source, sensor) = self.outlines.placed(what, values, &self.sensor, cx)?;
        let pitch = self.sensor.pitch(&cx.settings)?.of(Some(&sensor));
        touch(&source, sensor, pitch, self.json, &self.keep, cx)
    }
}
