//! The sensor: touches, coverages, sweeps and what they find.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use numpy::{Element, PyArray1, PyArrayDyn, PyReadonlyArray2, PyReadwriteArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use taxel_core::atlas::{STATISTIC_COLUMNS, features};
use taxel_core::parameter::Parameter;
use taxel_core::pose::{GivenRanges, PoseGrid, default_ranges, figure_ranges};
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor as CoreSensor};
use taxel_core::source::Source;
use taxel_core::sweep::{Sweep, SweepResult};
use taxel_core::touch::Plane;
use taxel_files::storage::{Existing, atlas_path, write_atlas};

use crate::arrays::{fill_each, shaped, within_memory, write};
use crate::failure::Result;
use crate::shapes::Shape;

#[pyclass(frozen, eq, subclass, module = "taxel._taxel")]
#[derive(PartialEq)]
pub(crate) struct Sensor {
    pub(crate) own: CoreSensor,
    pub(crate) pitch: Option<f64>,
}

impl Sensor {
    /// What touches compute: for each row of `poses`, which has a value for each key, a part of `cells`.
    fn touched<T: Element + Send>(
        &self,
        shape: &Bound<'_, Shape>,
        keys: Vec<String>,
        poses: PyReadonlyArray2<'_, f64>,
        mut cells: PyReadwriteArrayDyn<'_, T>,
        compute: impl Fn(&mut Plane, &Source, &mut [T]) + Sync + Send,
    ) -> Result<()> {
        let (sensor, base) = (self.own, &shape.get().0.source);
        let base = base.clone().at_pitch(self.pitch)?;
        let mut given = Vec::new();
        for key in keys {
            let parameter = key.parse::<Parameter>()?;
            if !base.parameters().contains(&parameter) {
                base.clone().with(parameter, 0.0, &sensor)?;
            }
            given.push(parameter);
        }
        let (poses, cells) = (poses.as_slice()?, cells.as_slice_mut()?);
        let start = || (Plane::new(sensor), base.clone());
        let fill = |(plane, base): &mut (Plane, Source), index, cells: &mut [T]| -> Result<()> {
            let value = |wanted: Parameter| match given.iter().position(|own| *own == wanted) {
                Some(key) => Some(poses[index * given.len() + key]),
                None => base.get(wanted),
            };
            let shape = base.clone().placed(&sensor, value)?;
            shape.check_size(&sensor)?;
            compute(plane, &shape, cells);
            Ok(())
        };
        let size = sensor.size().cells();
        if cells.len() == size {
            return fill(&mut start(), 0, cells);
        }
        fill_each(shape.py(), (cells, size), start, |state, index, cells| {
            let filled = fill(state, index, cells);
            filled.map_err(|failure| format!("element {index}: {}", failure.0).into())
        })
    }
}

#[pymethods]
impl Sensor {
    #[new]
    #[pyo3(signature = (columns=16.0, rows=16.0, threshold=0.5, pitch=None))]
    fn new(columns: f64, rows: f64, threshold: f64, pitch: Option<f64>) -> Result<Self> {
        let mut own = CoreSensor::default();
        let values = [Some(columns), Some(rows), Some(threshold), pitch];
        for (parameter, value) in SENSOR_PARAMETERS.iter().zip(values) {
            own = value.map_or(Ok(own), |value| own.with(*parameter, value))?;
        }
        Ok(Self { own, pitch })
    }

    fn touch(
        &self,
        shape: &Bound<'_, Shape>,
        keys: Vec<String>,
        poses: PyReadonlyArray2<'_, f64>,
        imprints: PyReadwriteArrayDyn<'_, bool>,
    ) -> Result<()> {
        self.touched(shape, keys, poses, imprints, |plane, shape, cells| {
            write(plane.touched(shape), cells);
        })
    }

    fn coverage(
        &self,
        shape: &Bound<'_, Shape>,
        keys: Vec<String>,
        poses: PyReadonlyArray2<'_, f64>,
        coverages: PyReadwriteArrayDyn<'_, f64>,
    ) -> Result<()> {
        self.touched(shape, keys, poses, coverages, |plane, shape, cells| {
            plane.touched(shape);
            plane.write_coverages(cells);
        })
    }
}

/// The ranges of a grid, such as "5:5.99:0.01", by the names of their axes.
pub(crate) fn given_ranges(texts: &HashMap<String, String>) -> Result<GivenRanges> {
    let mut ranges = GivenRanges::default();
    for (axis, text) in texts {
        let range = text.parse().map_err(|error| format!("{axis}: {error}"))?;
        ranges[axis.parse()?] = Some(range);
    }
    Ok(ranges)
}

#[pyfunction]
pub(crate) fn sweep(
    sensor: &Bound<'_, Sensor>,
    shape: &Bound<'_, Shape>,
    anchor: &str,
    ranges: HashMap<String, String>,
) -> Result<Atlas> {
    let Sensor { own: sensor, pitch } = *sensor.get();
    let (anchor, given) = (anchor.parse()?, given_ranges(&ranges)?);
    let own = match shape.get().0.source.clone().at_pitch(pitch)? {
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
    within_memory(shape.py(), |progress| {
        Atlas(Arc::new(Sweep::new(&grid).with_progress(progress).run()))
    })
}

/// What a sweep has found; the class Atlas is made of it.
#[pyclass(frozen, subclass, module = "taxel._taxel")]
#[derive(Clone)]
pub(crate) struct Atlas(pub(crate) Arc<SweepResult>);

#[pymethods]
impl Atlas {
    #[new]
    fn new(own: &Bound<'_, Self>) -> Self {
        own.get().clone()
    }

    /// The imprints: a bool array, imprints × rows × columns.
    fn imprints<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArrayDyn<bool>>> {
        let size = self.0.grid.sensor().size();
        let [rows, columns] = [size.rows(), size.columns()].map(usize::from);
        let entries = self.0.atlas.entries();
        let mut cells = vec![false; self.0.atlas.len() * size.cells()];
        for (cells, entry) in cells.chunks_mut(size.cells()).zip(entries) {
            write(&entry.imprint, cells);
        }
        shaped(py, cells, &[self.0.atlas.len(), rows, columns])
    }

    /// The number of poses that leave each imprint: a uint64 array.
    fn counts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        PyArray1::from_iter(py, self.0.atlas.counts())
    }

    /// The descriptors of the main region of each imprint: a dict of float64 arrays by "na", "`cg_x`" and so on, NaN
    /// where a descriptor does not exist.
    fn descriptors<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyDict>> {
        let values = |feature| {
            let values = self.0.atlas.values(feature).into_iter();
            PyArray1::from_iter(py, values.map(|value| value.unwrap_or(f64::NAN)))
        };
        let all = features().iter().enumerate();
        let all = all.map(|(index, feature)| (&feature.key, values(index)));
        Ok(all.into_py_dict(py)?)
    }

    /// The statistics of each descriptor over all poses: a dict of dicts with "min", "mean", "max", "sd", "cv" and so
    /// on; None where there is no value.
    fn statistics(&self) -> HashMap<&str, HashMap<&str, Option<f64>>> {
        let rows = self.0.statistics.iter().map(|row| {
            let columns = STATISTIC_COLUMNS.iter();
            let values = columns.map(|column| (column.key, (column.value)(row)));
            (&*row.feature.key, values.collect())
        });
        rows.collect()
    }

    /// Writes the file of `taxel sweep --atlas`: .npz, .csv or .jsonl. An existing file is replaced.
    ///
    /// Raises `ValueError` for another ending, `OSError` if the file cannot be written.
    fn save(&self, py: Python<'_>, path: PathBuf) -> Result<()> {
        let path = atlas_path(path)?;
        py.detach(|| write_atlas(&path, &self.0, Existing::Replaced)?.persist())?;
        Ok(())
    }
}
