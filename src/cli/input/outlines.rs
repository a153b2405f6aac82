//! Outlines from drawings: the flags that say how a drawing is read, and shapes that may come from one.

use std::ffi::OsStr;
use std::path::Path;

use taxel_core::outline::Outline;
use taxel_core::parameter::Parameter;
use taxel_core::picture::Picture;
use taxel_core::quote::joined;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_files::formats::file::has_ending;
use taxel_files::formats::{
    Content, FLATNESS, MAX_DRAWING_BYTES, OutlineOptions, OutlineUnit, is_svg, read_imprint,
    read_outline,
};

use crate::cli::arguments::flags::parse_positive;
use crate::cli::arguments::parameters::Given;
use crate::cli::failure::{Failure, Named};
use crate::cli::input::content::content;
use crate::cli::input::shapes::Located;
use crate::cli::{Context, note};

/// How files of outlines are read.
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
pub(crate) struct OutlineFlags {
    /// Unit of the points of a CSV: cells (default) or mm
    #[arg(long, value_name = "UNIT", value_parser = ["cells", "mm"], help_heading = "Outline")]
    #[arg(hide_possible_values = true, conflicts_with = "mm_per_unit")]
    unit: Option<String>,
    /// Size of a user unit of an SVG, in mm; default a cell, unless the SVG has a width in mm, cm, in or pt
    #[arg(long, value_name = "MM", value_parser = parse_positive, help_heading = "Outline")]
    mm_per_unit: Option<f64>,
    /// y of a CSV runs up, as in CAD
    #[arg(long, help_heading = "Outline")]
    y_up: bool,
    /// Largest distance of a curve from its chords, in cells; default 0.001
    #[arg(long, value_name = "CELLS", value_parser = parse_positive, help_heading = "Outline")]
    flatness: Option<f64>,
}

/// The name of a shape from a file: `bracket` for `parts/bracket.svg`.
pub(crate) fn stem(name: &str) -> &str {
    let stem = Path::new(name).file_stem().and_then(OsStr::to_str);
    stem.unwrap_or(name)
}

/// Whether a file is an outline, if it is not an imprint.
pub(crate) fn may_be_outline(name: &str, bytes: &[u8]) -> bool {
    is_svg(bytes) || has_ending(name, "csv")
}

impl OutlineFlags {
    /// Refuses these flags where no outline is read: lengths elsewhere have a unit of their own.
    pub(crate) fn refuse(&self) -> Result<(), Failure> {
        let flags = [
            ("unit", self.unit.is_some()),
            ("mm-per-unit", self.mm_per_unit.is_some()),
            ("y-up", self.y_up),
            ("flatness", self.flatness.is_some()),
        ];
        match flags.iter().find(|(_, given)| *given) {
            None => Ok(()),
            Some((flag, _)) => Err(Failure::usage(format!(
                "'--{flag}' has no effect without a file of an outline (.svg, .csv)"
            ))),
        }
    }

    /// Whether a file is an outline, and not an imprint.
    pub(crate) fn is_outline(&self, name: &str, bytes: &[u8]) -> bool {
        let of_points = self.unit.is_some() || self.y_up;
        may_be_outline(name, bytes) && (of_points || read_imprint(bytes).is_err())
    }

    /// Reads an outline. What it has beside filled shapes is named in a note.
    pub(crate) fn read(
        &self,
        bytes: &[u8],
        name: &str,
        pitch: Option<f64>,
    ) -> Result<Outline, Failure> {
        let (outline, left_out) = self.outline(bytes, name, pitch).named(name)?;
        if let Some(left_out) = left_out {
            note(&format!("{name}: {left_out}"));
        }
        Ok(outline)
    }

    /// Reads an outline, which gets the name of the file. Also returns, in words, what it has beside filled shapes.
    pub(crate) fn outline(
        &self,
        bytes: &[u8],
        name: &str,
        pitch: Option<f64>,
    ) -> Result<(Outline, Option<String>), Failure> {
        let mut options = OutlineOptions {
            flatness: self.flatness.unwrap_or(FLATNESS),
            pitch_mm: pitch.unwrap_or(1.0),
            mm_per_unit: self.mm_per_unit,
            y_up: self.y_up,
        };
        let mut read = read_outline(bytes, &options)?;
        if read.unit == OutlineUnit::Cells && self.unit.as_deref() == Some("mm") {
            // An SVG that says its size keeps it.
            options.mm_per_unit = Some(1.0);
            read = read_outline(bytes, &options)?;
        }
        let left_out = joined(read.left_out.iter().map(String::as_str), "and");
        let left_out = (!left_out.is_empty()).then(|| format!("left out: {left_out}"));
        let pitch = match (read.unit, pitch) {
            (OutlineUnit::Cells, _) => None,
            (OutlineUnit::Mm, Some(pitch)) => Some(pitch),
            (OutlineUnit::Mm, None) => {
                let text = "in mm, which needs the pitch of the sensor; give it with --pitch";
                return Err(Failure::new(text));
            }
        };
        let outline = Outline::new(read.rings, pitch)?;
        Ok((outline.named(stem(name)), left_out))
    }

    /// Looks up a shape, or reads an outline, and places it with the given values on its sensor: that of the stored
    /// shape, or of the settings for an outline, or one that an imprint fits on; changed by `sensor`.
    pub(crate) fn placed(
        &self,
        what: &OsStr,
        values: &Given,
        sensor: &Given,
        cx: &Context,
    ) -> Result<(Source, Sensor), Failure> {
        let pitch = sensor.pitch(&cx.settings)?.of(None);
        let (content, place) = match cx.shelf.locate(what)? {
            Located::Shape(shape) => {
                let name = shape.name.to_string();
                (Content::Shape(shape), name)
            }
            Located::Input(input) => {
                let name = input.name.clone();
                let bytes = input.bytes(MAX_DRAWING_BYTES)?;
                if self.is_outline(&name, &bytes) {
                    let outline = self.read(&bytes, &name, pitch)?;
                    let mut own = sensor.sensor(cx.settings.sensor.sensor)?;
                    if let Some(pitch) = pitch {
                        own = own.with(Parameter::Pitch, pitch)?;
                    }
                    let source = outline.in_the_middle(&own).into();
                    return fitting(values.picture(source, &own)?, own, &name);
                }
                (content(&bytes, &name)?, name)
            }
        };
        self.refuse()?;
        let (source, own) = match content {
            Content::Shape(shape) => (shape.touched_again(), shape.sensor),
            Content::Imprint(imprint) => {
                let size = imprint.size().union(Sensor::default().size());
                (Picture::at_home(imprint).into(), Sensor::of_size(size))
            }
        };
        let own = sensor.sensor(own)?;
        let source = source.at_pitch(Some(own.pitch_mm())).named(&place)?;
        fitting(values.picture(source, &own)?, own, &place)
    }
}

fn fitting(source: Source, sensor: Sensor, place: &str) -> Result<(Source, Sensor), Failure> {
    let fits = source.check_size(&sensor).named(place);
    fits.map_err(|failure| failure.with_hint("; for a larger sensor: --columns, --rows"))?;
    Ok((source, sensor))
}
