//! The header of an archive of numpy arrays: what was swept, or what a model was trained with.

use serde::{Deserialize, Serialize};
use taxel_core::pose::{Anchor, Axis, Ranges};
use taxel_core::quote::shortened;
use taxel_core::sensor::Sensor;
use taxel_core::sweep::Shard;

use crate::error::ReadError;
use crate::formats::json;
use crate::formats::numpy::archive::in_header;
use crate::formats::record::{Record, SensorRecord};

/// The value of the key `format` in the archive of an atlas.
pub(crate) const ATLAS_FORMAT: &str = "taxel-atlas/1";

/// The value of the key `format` in the archive of a model.
pub const MODEL_FORMAT: &str = "taxel-model/1";

/// A header: written from sources and a sensor, read as records that are then checked.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct ArchiveHeader<Shape = Record, Size = SensorRecord> {
    format: String,
    /// What was swept, of an atlas.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) source: Option<Shape>,
    /// The shapes of a model, in order; ties go to the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shapes: Option<Vec<ShapeHeader<Shape>>>,
    sensor: Size,
    /// The point that x0 and y0 place: `corner` or `centre`.
    anchor: String,
    /// Each axis is a range, `START:END:STEP`, or a single number.
    x0: String,
    y0: String,
    angle: String,
    zoom_x: String,
    zoom_y: String,
    /// The shard of the grid: `1/1` for the whole grid.
    shard: String,
    /// The number of poses of this shard; of a model, of each shape.
    pub(crate) poses: u64,
    /// Of an atlas.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) partly_off: Option<u64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(crate) struct ShapeHeader<Shape> {
    pub(crate) name: String,
    /// The weight: how often the shape is expected, compared with the others.
    pub(crate) weight: u32,
    /// The number of poses in which the sensor cuts the shape off.
    pub(crate) cut: u64,
    /// The pitch of an outline in mm; each stored outline has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) pitch_mm: Option<f64>,
    pub(crate) source: Shape,
}

/// What an atlas and a model have in common: the sensor, the anchor, the ranges and the shard.
pub(crate) type Grid = (Sensor, Anchor, Ranges, Shard);

impl<'a, Shape> ArchiveHeader<Shape, &'a Sensor> {
    pub(crate) fn new(
        format: &str,
        (sensor, anchor, ranges, shard): (&'a Sensor, Anchor, &Ranges, Shard),
        poses: u64,
    ) -> Self {
        Self {
            format: format.to_owned(),
            source: None,
            shapes: None,
            sensor,
            anchor: anchor.name().to_owned(),
            x0: ranges[Axis::X0].to_string(),
            y0: ranges[Axis::Y0].to_string(),
            angle: ranges[Axis::Angle].to_string(),
            zoom_x: ranges[Axis::ZoomX].to_string(),
            zoom_y: ranges[Axis::ZoomY].to_string(),
            shard: shard.to_string(),
            poses,
            partly_off: None,
        }
    }
}

impl<Shape: Serialize> ArchiveHeader<Shape, &Sensor> {
    pub(crate) fn bytes(&self) -> Vec<u8> {
        json::text(self).into_bytes()
    }
}

impl ArchiveHeader {
    pub(crate) fn grid(&self) -> Result<Grid, ReadError> {
        let sensor = self.sensor.sensor(Sensor::default()).map_err(in_header)?;
        let anchor = self.anchor.parse().map_err(|_| {
            let (found, known) = (shortened(&self.anchor), "corner or centre");
            in_header(format!("anchor {found:?} is unknown, expected {known}"))
        })?;
        let mut ranges = Ranges::default();
        let texts = [&self.x0, &self.y0, &self.angle, &self.zoom_x, &self.zoom_y];
        for (axis, text) in Axis::ALL.into_iter().zip(texts) {
            ranges[axis] = text.parse().map_err(in_header)?;
        }
        let shard = self.shard.parse().map_err(in_header)?;
        Ok((sensor, anchor, ranges, shard))
    }
}
