//! `taxel picture`: moves, zooms and turns a stored shape, and touches it once.

use std::ffi::{OsStr, OsString};

use taxel_core::picture::Picture as Moved;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_files::formats::Content;

use crate::cli::Context;
use crate::cli::arguments::flags::name_or_path;
use crate::cli::arguments::parameters::{Given, OwnSensorFlags, PictureFlags};
use crate::cli::commands::export::KeepFlags;
use crate::cli::commands::figure::touch;
use crate::cli::failure::Failure;
use crate::cli::input::shapes::Shelf;

const EXAMPLES: &str = "\
If a stored shape and a file have the same name, taxel uses the shape. A file
holds a stored shape or an imprint. A stored shape keeps its sensor; an imprint
gets a sensor of 16 x 16, or of its own size if that is larger. Without flags,
the picture stays as it is.

Examples:
  taxel picture washer --x0 6 --y0 4.5
  taxel picture key --angle 30 --zoom-x 0.8 --zoom-y 0.8 --json
  taxel picture imprint.txt --x0 2 --save \"moved imprint\"";

/// Move, zoom and turn a stored shape and describe its imprint
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
    keep: KeepFlags,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
}

impl Picture {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let kept = self.keep.kept(self.json)?;
        let (picture, sensor) = moved(&self.what, &self.values, &self.sensor, &cx.shelf)?;
        let pitch = self.sensor.pitch(&cx.settings)?.of(Some(&sensor));
        touch(&picture, sensor, pitch, self.json, &kept, cx)
    }
}

/// Looks up a shape and returns it as a picture with the given values, with its sensor: that of the stored shape. An
/// imprint alone gets the default sensor, or a larger one if it needs that.
pub(crate) fn moved(
    what: &OsStr,
    picture: &Given,
    sensor: &Given,
    shelf: &Shelf,
) -> Result<(Source, Sensor), Failure> {
    let (home, own) = match shelf.find(what)? {
        Content::Shape(shape) => {
            let home = Moved::at_home(shape.imprint);
            (home.named(shape.name.as_str()), shape.sensor)
        }
        Content::Imprint(imprint) => {
            let size = imprint.size().union(Sensor::default().size());
            (Moved::at_home(imprint), Sensor::of_size(size))
        }
    };
    let sensor = sensor.sensor(own)?;
    Ok((Source::Picture(picture.picture(home, &sensor)?), sensor))
}
