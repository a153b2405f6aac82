//! The shapes, and what is read of them.

use std::path::PathBuf;

use pyo3::prelude::*;
use pythonize::pythonize;
use taxel_core::parameter::Parameter;
use taxel_core::recognition::NamedShape;
use taxel_core::sensor::Sensor;
use taxel_files::formats::{OutlineOptions, OutlineUnit, named_shape, read_outline as read};

use crate::failure::{Failure, Result};

/// A shape that can touch a sensor: a Figure, a Picture or an Outline, with the name that it has in a list.
#[pyclass(frozen, eq, subclass, module = "taxel._taxel")]
#[derive(PartialEq)]
pub(crate) struct Shape(pub(crate) NamedShape);

#[pymethods]
impl Shape {
    /// Reads a shape from its keys in a set of shapes, as JSON.
    #[new]
    fn new(keys: &str, pitch: Option<f64>) -> Result<Self> {
        let pitch = pitch.map(|own| Sensor::LARGEST.check(Parameter::Pitch, own));
        let unknown = |name: &str| Err(format!("no shape named {name:?}"));
        let read = named_shape(keys.as_bytes(), pitch.transpose()?, &unknown);
        // Nobody sees the line of JSON, so its columns say nothing.
        Ok(Self(read.map_err(|error| error.message)?))
    }
}

/// Returns the rings of a drawing, the pitch if they are in mm, and what is no filled shape in it.
#[pyfunction]
pub(crate) fn read_outline(
    py: Python<'_>,
    path: PathBuf,
    pitch: Option<f64>,
    mm_per_unit: Option<f64>,
    y_up: bool,
    flatness: f64,
) -> Result<(Bound<'_, PyAny>, Option<f64>, Vec<String>)> {
    let options = OutlineOptions {
        flatness,
        pitch_mm: Sensor::LARGEST.check(Parameter::Pitch, pitch.unwrap_or(1.0))?,
        mm_per_unit,
        y_up,
    };
    let bytes = std::fs::read(&path).map_err(|error| Failure::of(&path, error))?;
    let drawing = read(&bytes, &options).map_err(|error| Failure::of(&path, error))?;
    let is_in_mm = drawing.unit == OutlineUnit::Mm;
    if is_in_mm && pitch.is_none() {
        let why = "in mm, which needs the pitch of the sensor; give it with pitch=";
        return Err(format!("{}: {why}", path.display()).into());
    }
    let rings = pythonize(py, &drawing.rings)?;
    Ok((rings, pitch.filter(|_| is_in_mm), drawing.left_out))
}
