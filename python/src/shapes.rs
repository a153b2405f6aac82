//! The shapes: figures, pictures, outlines.

use std::path::PathBuf;

use numpy::PyArray2;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use pythonize::{depythonize, pythonize};
use taxel_core::figure::{Figure as CoreFigure, FigureKind};
use taxel_core::outline::{Outline as CoreOutline, Ring};
use taxel_core::parameter::number::short;
use taxel_core::parameter::{PARAMETERS, Parameter};
use taxel_core::picture::Picture as CorePicture;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_files::formats::{FLATNESS, OutlineOptions, OutlineUnit, read_outline};

use crate::arrays::{imprint, mask, unread, warn, wrong};

/// The parameter with a key, such as `"radius_x"`.
pub(crate) fn parameter(key: &str) -> PyResult<Parameter> {
    let row = PARAMETERS.iter().find(|row| row.key == key);
    let unknown = || PyTypeError::new_err(format!("unexpected keyword argument '{key}'"));
    row.map(|row| row.parameter).ok_or_else(unknown)
}

/// The shape that an argument is, in its own place.
pub(crate) fn source(shape: &Bound<'_, PyAny>) -> PyResult<Source> {
    if let Ok(figure) = shape.cast::<Figure>() {
        return Ok(figure.get().0.into());
    }
    if let Ok(picture) = shape.cast::<Picture>() {
        return Ok(picture.get().0.clone().into());
    }
    if let Ok(outline) = shape.cast::<Outline>() {
        return Ok(outline.get().0.clone().into());
    }
    let found = shape.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "expected a Figure, a Picture or an Outline, not {found}"
    )))
}

/// One of seven figures: Figure(kind, **sizes).
///
/// kind is "ellipse" (radius_x, radius_y), "rectangle" (length, width), or "triangle", "pentagon", "hexagon",
/// "heptagon" or "octagon" (side). With thickness it has one concentric hole. Lengths are in cells, above 0, up to 64.
/// A figure turns clockwise; x0 and y0 are the top left corner of its bounding rectangle before that.
///
/// Raises ValueError for another kind, or for a size that is missing, foreign or out of range.
#[pyclass(frozen, eq, module = "taxel")]
#[derive(Debug, PartialEq)]
pub(crate) struct Figure(CoreFigure);

#[pymethods]
impl Figure {
    #[new]
    #[pyo3(signature = (kind, **sizes))]
    fn new(kind: &str, sizes: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let kind: FigureKind = kind.parse().map_err(wrong)?;
        let mut given = Vec::new();
        for (key, size) in sizes.into_iter().flatten() {
            given.push((
                parameter(&key.extract::<String>()?)?,
                size.extract::<f64>()?,
            ));
        }
        let place = [Parameter::X0, Parameter::Y0, Parameter::Angle];
        let value = |own: Parameter| {
            let size = given.iter().find(|(given, _)| *given == own);
            size.map(|(_, size)| *size)
                .or_else(|| place.contains(&own).then_some(0.0))
        };
        let mut figure = CoreFigure::new(kind, &Sensor::LARGEST, value).map_err(wrong)?;
        // A parameter that it does not have is an error, too.
        for &(parameter, size) in &given {
            if place.contains(&parameter) {
                let key = parameter.row().key;
                return Err(PyTypeError::new_err(format!(
                    "a figure has no {key} of its own; give it where it touches"
                )));
            }
            figure = figure
                .with(parameter, size, &Sensor::LARGEST)
                .map_err(wrong)?;
        }
        Ok(Self(figure))
    }

    /// "ellipse", "rectangle", "triangle", "pentagon", "hexagon", "heptagon" or "octagon".
    #[getter]
    fn kind(&self) -> &'static str {
        self.0.kind().name()
    }

    /// The sizes and the thickness by their names: a dict of float, in cells.
    #[getter]
    fn sizes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let sizes = PyDict::new(py);
        for (key, size) in self.each() {
            sizes.set_item(key, size)?;
        }
        Ok(sizes)
    }

    fn __repr__(&self) -> String {
        let sizes = self
            .each()
            .map(|(key, size)| format!(", {key}={}", short(size)));
        format!("Figure({:?}{})", self.kind(), sizes.collect::<String>())
    }

    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<((&'static str,), Bound<'py, PyDict>)> {
        Ok(((self.kind(),), self.sizes(py)?))
    }
}

impl Figure {
    fn each(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let kind = self.0.kind();
        let all = kind.sizes().iter().chain(&[Parameter::Thickness]);
        all.filter_map(|own| Some((own.row().key, self.0.get(*own)?)))
    }
}

/// A stored imprint as a shape: Picture(mask).
///
/// mask is an array of bool, rows × columns, 1 × 1 to 64 × 64; each active taxel is a square of one cell. A picture is
/// scaled by zoom_x and zoom_y about the origin, its place included, and turns counter-clockwise. Without a place it
/// leaves its own imprint.
#[pyclass(frozen, eq, module = "taxel")]
#[derive(Debug, PartialEq)]
pub(crate) struct Picture(CorePicture);

#[pymethods]
impl Picture {
    #[new]
    fn new(mask: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(CorePicture::at_home(imprint(mask)?)))
    }

    /// The imprint: a new array of bool, rows × columns.
    #[getter]
    fn mask<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        mask(py, self.0.imprint())
    }

    fn __repr__(&self) -> String {
        let imprint = self.0.imprint();
        format!(
            "<taxel.Picture: {} taxels of {}>",
            imprint.count(),
            imprint.size()
        )
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray2<bool>>,)> {
        Ok((self.mask(py)?,))
    }
}

/// A shape of closed rings: Outline(rings, pitch=None).
///
/// A ring is a polygon, as points (x, y) in a list or an array n × 2, or an ellipse, as a dict with cx, cy, rx, ry and
/// perhaps angle. Rings may be nested, but not cross; material lies inside an odd number of them. y runs down. Lengths
/// are in cells; with pitch, in mm, and that is the side of a cell in mm. It is placed like a Picture, its own place
/// being the origin.
///
/// Raises ValueError for what is no outline.
#[pyclass(frozen, eq, module = "taxel")]
#[derive(Debug, PartialEq)]
pub(crate) struct Outline(CoreOutline);

#[pymethods]
impl Outline {
    #[new]
    #[pyo3(signature = (rings, pitch=None))]
    fn new(rings: &Bound<'_, PyAny>, pitch: Option<f64>) -> PyResult<Self> {
        let mut read: Vec<Ring> = Vec::new();
        for (number, ring) in (1..).zip(rings.try_iter()?) {
            let ring = ring?;
            // A row of an array is no list, but can be one.
            let ring = ring.call_method0("tolist").unwrap_or(ring);
            read.push(
                depythonize(&ring).map_err(|error| wrong(format!("ring {number}: {error}")))?,
            );
        }
        if let Some(pitch) = pitch {
            Sensor::LARGEST
                .check(Parameter::Pitch, pitch)
                .map_err(wrong)?;
        }
        CoreOutline::new(read, pitch).map(Self).map_err(wrong)
    }

    /// Reads an SVG, or points as CSV.
    ///
    /// What is in mm is divided by pitch, the side of a cell in mm. mm_per_unit is the size of a unit in mm where the
    /// file does not say it (default: a unit is a cell); y_up is for points from CAD; curves become chords at most
    /// flatness cells away (default 0.001). Warns of what is no filled shape.
    ///
    /// Raises OSError if the file cannot be read, ValueError if it is no outline, or in mm without a pitch.
    #[staticmethod]
    #[pyo3(signature = (path, *, pitch=None, mm_per_unit=None, y_up=false, flatness=FLATNESS))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        pitch: Option<f64>,
        mm_per_unit: Option<f64>,
        y_up: bool,
        flatness: f64,
    ) -> PyResult<Self> {
        let name = path.display();
        let bytes = std::fs::read(&path).map_err(|error| unread(&path, &error.into()))?;
        let options = OutlineOptions {
            flatness,
            pitch_mm: pitch.unwrap_or(1.0),
            mm_per_unit,
            y_up,
        };
        let read = read_outline(&bytes, &options).map_err(|error| unread(&path, &error))?;
        if !read.left_out.is_empty() {
            warn(
                py,
                &format!("{name}: left out: {}", read.left_out.join(", ")),
            )?;
        }
        let pitch = match (read.unit, pitch) {
            (OutlineUnit::Cells, _) => None,
            (OutlineUnit::Mm, Some(pitch)) => Some(pitch),
            (OutlineUnit::Mm, None) => {
                return Err(wrong(format!(
                    "{name}: in mm, which needs the pitch of the sensor; give it with pitch="
                )));
            }
        };
        let outline = CoreOutline::new(read.rings, pitch)
            .map_err(|error| wrong(format!("{name}: {error}")))?;
        let stem = path.file_stem().map(|stem| stem.to_string_lossy());
        Ok(Self(outline.named(&stem.unwrap_or_default())))
    }

    /// The rings, as Outline takes them.
    #[getter]
    fn rings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(pythonize(py, self.0.rings())?)
    }

    /// The side of a cell in mm if the rings are in mm, otherwise None.
    #[getter]
    fn pitch(&self) -> Option<f64> {
        self.0.pitch_mm()
    }

    /// Width and height in cells.
    #[getter]
    fn size(&self) -> (f64, f64) {
        self.0.size().into()
    }

    fn __repr__(&self) -> String {
        let [width, height] = self.0.size().map(short);
        format!(
            "<taxel.Outline: {} rings, {width} × {height} cells>",
            self.0.rings().len()
        )
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        (self.rings(py)?, self.pitch()).into_pyobject(py)
    }
}
