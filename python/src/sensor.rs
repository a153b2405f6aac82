//! The sensor: touches, coverages, sweeps.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use numpy::{
    Element, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
    get_array_module,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyString, PyTuple};
use rayon::prelude::*;
use taxel_core::lock::try_locked;
use taxel_core::parameter::Parameter;
use taxel_core::parameter::number::short;
use taxel_core::pose::{Axis, DecimalRange, GivenRanges, PoseGrid, default_ranges, figure_ranges};
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor as CoreSensor};
use taxel_core::source::Source;
use taxel_core::sweep::Sweep;
use taxel_core::touch::Plane;

use crate::arrays::{interruptible, numbers, within_memory, write, wrong, zeros};
use crate::atlas::Atlas;
use crate::shapes::{parameter, source};

/// A sensor: Sensor(columns=16, rows=16, threshold=0.5, pitch=None).
///
/// columns and rows are from 1 to 64; threshold, above 0 and up to 1, is the share of a cell that must be covered for
/// its taxel to be active; pitch is the side of a cell in mm, which only outlines in mm need.
///
/// Raises ValueError for a value out of range.
#[pyclass(frozen, eq, module = "taxel")]
#[derive(Debug)]
pub(crate) struct Sensor {
    pub(crate) own: CoreSensor,
    /// The side of a cell in mm, or None.
    #[pyo3(get)]
    pub(crate) pitch: Option<f64>,
    /// For touches one by one.
    plane: Mutex<Plane>,
}

impl PartialEq for Sensor {
    fn eq(&self, other: &Self) -> bool {
        (self.own, self.pitch) == (other.own, other.pitch)
    }
}

impl Sensor {
    pub(crate) fn of(own: CoreSensor, pitch: Option<f64>) -> Self {
        let plane = Mutex::new(Plane::new(own));
        Self { own, pitch, plane }
    }

    /// What a touch computes, for one pose or for each of many.
    fn touched<'py, T: Element + Send>(
        &self,
        shape: &Bound<'py, PyAny>,
        given: Option<&Bound<'py, PyDict>>,
        compute: impl Fn(&mut Plane, &Source, &mut [T]) + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
        let (py, sensor) = (shape.py(), self.own);
        let shape = source(shape)?.at_pitch(self.pitch).map_err(wrong)?;
        let (given, broadcast) = values(py, given)?;
        for (parameter, value) in &given {
            if !shape.parameters().contains(parameter) {
                let value = value.as_slice()?.first().copied().unwrap_or_default();
                shape
                    .clone()
                    .with(*parameter, value, &sensor)
                    .map_err(wrong)?;
            }
        }
        let own: Vec<_> = shape
            .parameters()
            .iter()
            .map(|own| (*own, shape.get(*own)))
            .collect();
        let mut poses = Vec::new();
        for (parameter, value) in &own {
            let given = given.iter().find(|(given, _)| given == parameter);
            match given {
                Some((_, given)) => poses.push((*parameter, given.as_slice()?)),
                None => poses.push((*parameter, value.as_slice())),
            }
        }
        let sides = [sensor.rows(), sensor.columns()].map(usize::from);
        let Some(mut dimensions) = broadcast else {
            let array = PyArrayDyn::zeros(py, &sides[..], false);
            let shape = placed(shape, &sensor, &poses, 0).map_err(wrong)?;
            let mut plane = try_locked(&self.plane);
            let plane = plane.as_deref_mut();
            compute(
                plane.unwrap_or(&mut Plane::new(sensor)),
                &shape,
                array.try_readwrite()?.as_slice_mut()?,
            );
            return Ok(array);
        };
        dimensions.extend(sides);
        let array = zeros::<T>(py, dimensions)?;
        let mut cells = array.try_readwrite()?;
        let (cells, size) = (cells.as_slice_mut()?, sensor.size().cells());
        let count = cells.len() / size;
        let all = |stopped: &AtomicBool| {
            let start = || (Plane::new(sensor), Some(shape.clone()));
            let chunks = cells.par_chunks_mut(CHUNK * size).enumerate();
            chunks.try_for_each_init(start, |(plane, shape), (chunk, cells)| {
                for (index, cells) in (chunk * CHUNK..).zip(cells.chunks_mut(size)) {
                    let posed = shape
                        .take()
                        .and_then(|own| placed(own, &sensor, &poses, index).ok());
                    compute(plane, shape.insert(posed?), cells);
                }
                (!stopped.load(Ordering::Relaxed)).then_some(())
            })
        };
        if interruptible(py, all)?.is_none() {
            let error = |index| Some((index, placed(shape.clone(), &sensor, &poses, index).err()?));
            let (index, error) = (0..count).find_map(error).unwrap_or_default();
            return Err(wrong(format!("element {index}: {error}")));
        }
        Ok(array)
    }
}

/// The touches between two looks at whether to stop.
const CHUNK: usize = 64;

/// The shape in the pose with this index, and what is wrong with that pose otherwise. Of the values of a parameter, one
/// is for all poses.
fn placed(
    shape: Source,
    sensor: &CoreSensor,
    poses: &[(Parameter, &[f64])],
    index: usize,
) -> Result<Source, String> {
    let value = |wanted: Parameter| {
        let (_, values) = poses.iter().find(|(own, _)| *own == wanted)?;
        values.get(index).or(values.first()).copied()
    };
    let shape = shape
        .placed(sensor, value)
        .map_err(|error| error.to_string())?;
    shape
        .check_size(sensor)
        .map_err(|error| error.to_string())?;
    Ok(shape)
}

/// The values of a parameter: a number, or an array of them.
enum Value<'py> {
    One(f64),
    Many(PyReadonlyArrayDyn<'py, f64>),
}

impl Value<'_> {
    fn as_slice(&self) -> PyResult<&[f64]> {
        Ok(match self {
            Self::One(value) => std::slice::from_ref(value),
            Self::Many(values) => values.as_slice()?,
        })
    }
}

/// The values of a pose by their keys, and the shape to which arrays among them are broadcast, as numpy does it.
type Values<'py> = (Vec<(Parameter, Value<'py>)>, Option<Vec<usize>>);

fn values<'py>(py: Python<'py>, given: Option<&Bound<'py, PyDict>>) -> PyResult<Values<'py>> {
    let (mut all, mut arrays) = (Vec::new(), false);
    for (key, value) in given.into_iter().flatten() {
        let parameter = parameter(&key.cast::<PyString>()?.to_cow()?)?;
        if value.is_none() {
            continue;
        }
        let value = if value.is_instance_of::<PyFloat>() || value.is_instance_of::<PyInt>() {
            Value::One(value.extract()?)
        } else {
            let values = numbers(&value, parameter.row().key)?;
            match values.shape() {
                [] => Value::One(values.as_slice()?[0]),
                _ => Value::Many(values),
            }
        };
        arrays |= matches!(value, Value::Many(_));
        all.push((parameter, value));
    }
    if !arrays {
        return Ok((all, None));
    }
    let numpy = get_array_module(py)?;
    let shapes = all.iter().filter_map(|(_, value)| match value {
        Value::One(_) => None,
        Value::Many(values) => Some(PyTuple::new(py, values.shape())),
    });
    let shapes = PyTuple::new(py, shapes.collect::<PyResult<Vec<_>>>()?)?;
    let shape: Vec<usize> = numpy.call_method1("broadcast_shapes", shapes)?.extract()?;
    for (parameter, value) in &mut all {
        if let Value::Many(values) = value {
            let broadcast = numpy.call_method1("broadcast_to", (&**values, shape.clone()))?;
            *values = numbers(&broadcast, parameter.row().key)?;
        }
    }
    Ok((all, Some(shape)))
}

/// A range from a text such as "5:5.99:0.01", or from one number.
pub(crate) fn range(given: &Bound<'_, PyAny>, key: &str) -> PyResult<DecimalRange> {
    let text = given.str()?;
    let range = text.to_cow()?.parse::<DecimalRange>();
    range.map_err(|error| wrong(format!("{key}: {error}")))
}

/// The ranges of a grid, of its keywords.
pub(crate) fn ranges(given: [Option<&Bound<'_, PyAny>>; 5]) -> PyResult<GivenRanges> {
    let mut ranges = GivenRanges::default();
    for (axis, given) in Axis::ALL.into_iter().zip(given) {
        ranges[axis] = given.map(|given| range(given, axis.name())).transpose()?;
    }
    Ok(ranges)
}

#[pymethods]
impl Sensor {
    #[new]
    #[pyo3(signature = (columns=16.0, rows=16.0, threshold=0.5, pitch=None))]
    fn new(columns: f64, rows: f64, threshold: f64, pitch: Option<f64>) -> PyResult<Self> {
        let mut own = CoreSensor::default();
        let values = [Some(columns), Some(rows), Some(threshold), pitch];
        for (parameter, value) in SENSOR_PARAMETERS.iter().zip(values) {
            if let Some(value) = value {
                own = own.with(*parameter, value).map_err(wrong)?;
            }
        }
        Ok(Self::of(own, pitch))
    }

    /// The number of columns.
    #[getter]
    fn columns(&self) -> u8 {
        self.own.columns()
    }

    /// The number of rows.
    #[getter]
    fn rows(&self) -> u8 {
        self.own.rows()
    }

    /// The share of a cell that must be covered for its taxel to be active.
    #[getter]
    fn threshold(&self) -> f64 {
        self.own.threshold()
    }

    /// Touches a shape: touch(shape, *, x0, y0, angle, ...) -> bool array, rows × columns.
    ///
    /// x0 and y0 are in cells, angle in degrees from 0 to below 360; a Picture or an Outline also takes zoom_x and
    /// zoom_y, a Figure other sizes. What is not given is the shape's own: the origin, angle 0, zoom 1. Each may be an
    /// array: they are broadcast as numpy does, and their shape comes before rows × columns. Many touches use all
    /// cores, release the interpreter and stop on Ctrl-C.
    ///
    /// Raises ValueError for a value out of range, TypeError for an unknown keyword.
    #[pyo3(signature = (shape, **values), text_signature = "($self, shape, *, x0=None, y0=None, angle=None, **values)")]
    fn touch<'py>(
        &self,
        shape: &Bound<'py, PyAny>,
        values: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        self.touched(shape, values, |plane, shape, cells| {
            write(plane.touched(shape), cells)
        })
    }

    /// The share of each cell that a shape covers, from 0 to 1: a float64 array. Takes what touch takes.
    #[pyo3(signature = (shape, **values), text_signature = "($self, shape, *, x0=None, y0=None, angle=None, **values)")]
    fn coverage<'py>(
        &self,
        shape: &Bound<'py, PyAny>,
        values: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.touched(shape, values, |plane, shape, cells| {
            plane.touched(shape);
            plane.write_coverages(cells);
        })
    }

    /// Finds every imprint that a shape can leave in a grid of poses: an Atlas.
    ///
    /// A range is a text "start:end:step" with the end included, or a number; decimals are exact. Without x0 and y0, one
    /// cell in steps of 0.01 is swept, without angle every whole degree. anchor is the point that x0 and y0 place:
    /// "corner" or "centre". Uses all cores, releases the interpreter and stops on Ctrl-C.
    ///
    /// Raises ValueError for a range that is none or out of range, MemoryError if memory runs short.
    #[pyo3(signature = (shape, *, x0=None, y0=None, angle=None, zoom_x=None, zoom_y=None, anchor="corner"))]
    fn sweep(
        &self,
        shape: &Bound<'_, PyAny>,
        x0: Option<&Bound<'_, PyAny>>,
        y0: Option<&Bound<'_, PyAny>>,
        angle: Option<&Bound<'_, PyAny>>,
        zoom_x: Option<&Bound<'_, PyAny>>,
        zoom_y: Option<&Bound<'_, PyAny>>,
        anchor: &str,
    ) -> PyResult<Atlas> {
        let (py, sensor) = (shape.py(), self.own);
        let given = ranges([x0, y0, angle, zoom_x, zoom_y])?;
        let anchor = anchor.parse().map_err(wrong)?;
        let shape = source(shape)?.at_pitch(self.pitch).map_err(wrong)?;
        shape.check_size(&sensor).map_err(wrong)?;
        let (shape, found) = match shape {
            // As on the command line: a figure has no place of its own, an outline lies in the middle.
            Source::Figure(_) => {
                let found = figure_ranges(&shape, &sensor, anchor, &given);
                (shape, found)
            }
            Source::Outline(outline) => {
                let shape = outline.in_the_middle(&sensor).into();
                let found = default_ranges(&shape, &sensor, anchor, &given);
                (shape, found)
            }
            Source::Picture(_) => {
                let found = default_ranges(&shape, &sensor, anchor, &given);
                (shape, found)
            }
        };
        let grid = PoseGrid::new(shape, sensor, anchor, found.map_err(wrong)?).map_err(wrong)?;
        let advice = "take coarser steps or shorter ranges";
        let swept = within_memory(py, advice, |progress| {
            Sweep::new(&grid).with_progress(progress).run()
        })?;
        Ok(Atlas::new(swept))
    }

    fn __repr__(&self) -> String {
        let [columns, rows, threshold] =
            [Parameter::Columns, Parameter::Rows, Parameter::Threshold]
                .map(|own| short(self.own.get(own).unwrap_or_default()));
        let pitch = self.pitch.map(|pitch| format!(", pitch={}", short(pitch)));
        let pitch = pitch.unwrap_or_default();
        format!("Sensor(columns={columns}, rows={rows}, threshold={threshold}{pitch})")
    }

    fn __getnewargs__(&self) -> (u8, u8, f64, Option<f64>) {
        (self.columns(), self.rows(), self.threshold(), self.pitch)
    }
}
