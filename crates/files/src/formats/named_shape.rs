//! The shapes of a set: one JSON object each.

use std::num::NonZeroU32;

use taxel_core::picture::Picture;
use taxel_core::pose::Axis;
use taxel_core::recognition::NamedShape;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;

use crate::error::ReadError;
use crate::formats::json;
use crate::formats::record::{ONE_KEY, Record};

/// A function that finds a stored shape: its outline, or the picture of its imprint.
pub type ShapeLookup<'a> = dyn Fn(&str) -> Result<Source, String> + 'a;

/// Reads a shape of a set from a JSON object. It has neither a pose nor a sensor: the shapes of a set are touched in
/// the poses of a grid, on one sensor.
///
/// ```text
/// {"name":"disc","figure":"ellipse","radius_x":3.09,"radius_y":3.09}
/// {"name":"washer","picture":"washer","weight":2}
/// {"name":"corner","picture":["##","#."]}
/// {"name":"plate","outline":[[[0,0],[15,0],[15,10],[0,10]]],"unit":"mm"}
/// ```
/// The sizes of a figure have no defaults ([`PARAMETERS`](taxel_core::parameter::PARAMETERS) lists keys, units and ranges); without `thickness` it is
/// solid. A picture is given by its rows, or by the name of a stored shape, which `lookup` finds. Lengths in mm are
/// divided by `pitch_mm`. The weight, from 1, says how often the shape is expected compared with the others; by default 1.
///
/// # Errors
/// Returns an error that says in one sentence what is wrong. It names the column, if there is one, but no line.
///
/// ```
/// use taxel_files::formats::named_shape;
/// let line = br#"{"name":"disc","figure":"ellipse","radius_x":3.09,"radius_y":3.09}"#;
/// let disc = named_shape(line, None, &|name| Err(format!("no shape {name}"))).unwrap();
/// assert_eq!((disc.name.as_str(), disc.weight), ("disc", 1));
/// ```
pub fn named_shape(
    line: &[u8],
    pitch_mm: Option<f64>,
    lookup: &ShapeLookup<'_>,
) -> Result<NamedShape, ReadError> {
    let mut record: Record = json::of_line(line)?;
    let name = record
        .name
        .take()
        .ok_or_else(|| ReadError::new("name: missing; every shape of a set needs one"))?;
    let weight = record.weight.take().map_or(1, NonZeroU32::get);
    let posed = Axis::ALL.map(Axis::parameter);
    if let Some(parameter) = posed.into_iter().find(|&own| record.get(own).is_some()) {
        return Err(ReadError::new(format!(
            "{}: a shape of a set has no pose of its own; it is touched in all poses of the grid",
            parameter.row().key
        )));
    }
    let touches = record.figure.is_some() || record.picture.is_some() || record.outline.is_some();
    let source = match (touches, record.imprint.take()) {
        (false, Some(imprint)) => {
            record.only("imprint", &[])?;
            Picture::at_home(*imprint).into()
        }
        (_, None) => {
            (record.x0, record.y0, record.angle) = (Some(0.0), Some(0.0), Some(0.0));
            record.source(&Sensor::LARGEST, pitch_mm, lookup)?
        }
        _ => return Err(ReadError::new(ONE_KEY)),
    };
    Ok(NamedShape::new(name, source).weighted(weight))
}
