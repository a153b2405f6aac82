//! The sensor: touches, coverages, sweeps and what they find.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use numpy::{Element, PyArray1, PyArrayDyn, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use rayon::prelude::*;
use taxel_core::atlas::{STATISTIC_COLUMNS, features};
use taxel_core::parameter::Parameter;
use taxel_core::pose::{DecimalRange, GivenRanges, PoseGrid, default_ranges, figure_ranges};
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor as CoreSensor};
use taxel_core::source::Source;
use taxel_core::sweep::{Sweep, SweepResult};
use taxel_core::touch::Plane;
use taxel_files::storage::{Existing, atlas_path, write_atlas};

use crate::arrays::{filled, interruptible, within_memory, write};
use crate::failure::{Failure, Result};
use crate::shapes::Shape;

#[pyclass(frozen, eq, subclass, module = "taxel")]
#[derive(PartialEq)]
pub(crate) struct Sensor {
    pub(crate) own: CoreSensor,
    pub(crate) pitch: Option<f64>,
}

/// The touches between two looks at whether to stop.
const CHUNK: usize = 64;

/// The values of a parameter: one for all poses, or one for each.
#[derive(FromPyObject)]
enum Value<'py> {
    One(f64),
    Many(PyReadonlyArray1<'py, f64>),
}

/// The poses of touches: the keys of parameters, their values, and the shape of the array of poses; empty for one.
type Poses<'py> = (Vec<String>, Vec<Value<'py>>, Vec<usize>);

impl Sensor {
    /// What a touch computes, for one pose or for each of many.
    fn touched<'py, T: Element + Send>(
        &self,
        shape: &Bound<'py, Shape>,
        (keys, values, poses): Poses<'py>,
        compute: impl Fn(&mut Plane, &Source, &mut [T]) + Sync,
    ) -> Result<Bound<'py, PyArrayDyn<T>>> {
        let (py, sensor) = (shape.py(), self.own);
        let base = shape.get().0.clone().at_pitch(self.pitch)?;
        let mut given = Vec::new();
        for (key, values) in keys.iter().zip(&values) {
            let parameter = key.parse::<Parameter>()?;
            if !base.parameters().contains(&parameter) {
                base.clone().with(parameter, 0.0, &sensor)?;
            }
            let values = match values {
                Value::One(value) => std::slice::from_ref(value),
                Value::Many(values) => values.as_slice()?,
            };
            given.push((parameter, values));
        }
        let posed = |shape: Source, index: usize| -> Result<Source> {
            let value = |wanted: Parameter| {
                let given = given.iter().find(|(own, _)| *own == wanted);
                given.map_or(base.get(wanted), |(_, values)| Some(values[index]))
            };
            let shape = shape.placed(&sensor, value)?;
            shape.check_size(&sensor)?;
            Ok(shape)
        };
        let size = sensor.size().cells();
        let sides = [sensor.rows(), sensor.columns()].map(usize::from);
        filled(py, &[&poses[..], &sides].concat(), |cells| {
            if poses.is_empty() {
                compute(&mut Plane::new(sensor), &posed(base.clone(), 0)?, cells);
                return Ok(());
            }
            let done = interruptible(py, |stopped| {
                let start = || (Plane::new(sensor), base.clone());
                let chunks = cells.par_chunks_mut(CHUNK * size).enumerate();
                chunks.try_for_each_init(start, |(plane, shape), (chunk, cells)| {
                    for (index, cells) in (chunk * CHUNK..).zip(cells.chunks_mut(size)) {
                        compute(plane, &posed(shape.clone(), index).ok()?, cells);
                    }
                    (!stopped.load(Ordering::Relaxed)).then_some(())
                })
            })?;
            if done.is_none() {
                // The first wrong pose, whichever was found first.
                let wrong = |index| Some((index, posed(base.clone(), index).err()?));
                if let Some((index, failure)) = (0..cells.len() / size).find_map(wrong) {
                    let why = failure.0.value(py);
                    return Err(Failure::new(format!("element {index}: {why}")));
                }
            }
            Ok(())
        })
    }
}

#[pymethods]
impl Sensor {
    #[new]
    #[pyo3(signature = (columns, rows, threshold, pitch))]
    fn new(columns: f64, rows: f64, threshold: f64, pitch: Option<f64>) -> Result<Self> {
        let mut own = CoreSensor::default();
        let values = [Some(columns), Some(rows), Some(threshold), pitch];
        for (parameter, value) in SENSOR_PARAMETERS.iter().zip(values) {
            own = value.map_or(Ok(own), |value| own.with(*parameter, value))?;
        }
        Ok(Self { own, pitch })
    }

    fn touch<'py>(
        &self,
        shape: &Bound<'py, Shape>,
        poses: Poses<'py>,
    ) -> Result<Bound<'py, PyArrayDyn<bool>>> {
        self.touched(shape, poses, |plane, shape, cells| {
            write(plane.touched(shape), cells);
        })
    }

    fn coverage<'py>(
        &self,
        shape: &Bound<'py, Shape>,
        poses: Poses<'py>,
    ) -> Result<Bound<'py, PyArrayDyn<f64>>> {
        self.touched(shape, poses, |plane, shape, cells| {
            plane.touched(shape);
            plane.write_coverages(cells);
        })
    }
}

/// A range such as "5:5.99:0.01".
pub(crate) fn range(text: &str, key: &str) -> Result<DecimalRange> {
    text.parse()
        .map_err(|error| Failure::new(format!("{key}: {error}")))
}

/// The ranges of a grid, by the names of their axes.
pub(crate) fn given_ranges(texts: &HashMap<String, String>) -> Result<GivenRanges> {
    let mut ranges = GivenRanges::default();
    for (axis, text) in texts {
        ranges[axis.parse()?] = Some(range(text, axis)?);
    }
    Ok(ranges)
}

#[pyfunction]
pub(crate) fn sweep(
    sensor: &Bound<'_, Sensor>,
    shape: &Bound<'_, Shape>,
    anchor: &str,
    ranges: HashMap<String, String>,
) -> Result<Swept> {
    let Sensor { own: sensor, pitch } = *sensor.get();
    let (anchor, given) = (anchor.parse()?, given_ranges(&ranges)?);
    let own = match shape.get().0.clone().at_pitch(pitch)? {
        Source::Outline(own) => own.in_the_middle(&sensor).into(),
        own => own,
    };
    own.check_size(&sensor)?;
    // A figure has no place of its own.
    let found = match own {
        Source::Figure(_) => figure_ranges(&own, &sensor, anchor, &given)?,
        _ => default_ranges(&own, &sensor, anchor, &given)?,
    };
    let grid = PoseGrid::new(own, sensor, anchor, found)?;
    let advice = "take coarser steps or shorter ranges";
    within_memory(shape.py(), advice, |progress| {
        Swept(Sweep::new(&grid).with_progress(progress).run())
    })
}

/// What an Atlas holds.
#[pyclass(frozen)]
pub(crate) struct Swept(pub(crate) SweepResult);

#[pymethods]
impl Swept {
    fn imprints<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArrayDyn<bool>>> {
        let size = self.0.grid.sensor().size();
        let [rows, columns] = [size.rows(), size.columns()].map(usize::from);
        filled(py, &[self.0.atlas.len(), rows, columns], |cells| {
            for (cells, entry) in cells.chunks_mut(size.cells()).zip(self.0.atlas.entries()) {
                write(&entry.imprint, cells);
            }
            Ok(())
        })
    }

    fn counts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        PyArray1::from_iter(py, self.0.atlas.counts())
    }

    fn descriptors<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>> {
        let values = |feature| {
            let values = self.0.atlas.values(feature).into_iter();
            PyArray1::from_iter(py, values.map(|value| value.unwrap_or(f64::NAN)))
        };
        let all = features().iter().enumerate();
        let all = all.map(|(index, feature)| (&feature.key, values(index)));
        Ok(all.into_py_dict(py)?)
    }

    fn statistics(&self) -> HashMap<&str, HashMap<&str, Option<f64>>> {
        let rows = self.0.statistics.iter().map(|row| {
            let columns = STATISTIC_COLUMNS.iter();
            let values = columns.map(|column| (column.key, (column.value)(row)));
            (&*row.feature.key, values.collect())
        });
        rows.collect()
    }

    fn save(&self, py: Python<'_>, path: PathBuf) -> Result<()> {
        let path = atlas_path(path).map_err(Failure::new)?;
        py.detach(|| write_atlas(&path, &self.0, Existing::Replaced)?.persist())?;
        Ok(())
    }
}
