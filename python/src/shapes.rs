//! The shapes, and what is read of them.

use std::path::PathBuf;

use numpy::PyReadonlyArray3;
use pyo3::prelude::*;
use pythonize::pythonize;
use taxel_core::parameter::Parameter;
use taxel_core::picture::Picture;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_files::formats::{OutlineOptions, OutlineUnit, named_shape, read_outline as read};

use crate::arrays::imprints;
use crate::failure::{Failure, Result};

/// A shape that can touch a sensor: a Figure, a Picture or an Outline.
#[pyclass(frozen, eq, subclass, module = "taxel")]
#[derive(PartialEq)]
pub(crate) struct Shape(pub(crate) Source);

#[pymethods]
impl Shape {
    /// Reads a figure or an outline from its keys in a set of shapes, as JSON; otherwise the shape is a mask.
    #[new]
    #[pyo3(signature = (keys="", *, mask=None, pitch=None, name=None))]
    fn new(
        keys: &str,
        mask: Option<PyReadonlyArray3<'_, bool>>,
        pitch: Option<f64>,
        name: Option<&str>,
    ) -> Result<Self> {
        if let Some(mask) = mask {
            return Ok(Self(Picture::at_home(imprints(&mask)?[0]).into()));
        }
        if let Some(pitch) = pitch {
            Sensor::LARGEST.check(Parameter::Pitch, pitch)?;
        }
        let line = keys.replacen('{', "{\"name\": \"shape\", ", 1);
        let named = named_shape(line.as_bytes(), pitch, &|name| {
            Err(format!("no shape named {name:?}"))
        })?;
        Ok(Self(named.source.named(name.unwrap_or_default())))
    }
}

/// The rings of a drawing, the pitch if they are in mm, and what is no filled shape in it.
type Drawing<'py> = (Bound<'py, PyAny>, Option<f64>, Vec<String>);

#[pyfunction]
pub(crate) fn read_outline(
    py: Python<'_>,
    path: PathBuf,
    pitch: Option<f64>,
    mm_per_unit: Option<f64>,
    y_up: bool,
    flatness: f64,
) -> Result<Drawing<'_>> {
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
        return Err(Failure::new(format!("{}: {why}", path.display())));
    }
    let rings = pythonize(py, &drawing.rings)?;
    Ok((rings, pitch.filter(|_| is_in_mm), drawing.left_out))
}
