//! The imprints that a sweep has found, as arrays.

use std::path::PathBuf;

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;
use taxel_core::atlas::{STATISTIC_COLUMNS, features};
use taxel_core::sweep::SweepResult;
use taxel_files::storage::{Existing, atlas_path, write_atlas};

use crate::arrays::{unwritten, write, wrong, zeros};

/// Every imprint that a shape leaves in a grid of poses, in the order of their first poses; made by Sensor.sweep or
/// taxel.load.
#[pyclass(frozen, module = "taxel")]
pub(crate) struct Atlas {
    result: SweepResult,
    imprints: PyOnceLock<Py<PyArrayDyn<bool>>>,
    descriptors: PyOnceLock<Py<PyDict>>,
}

impl Atlas {
    pub(crate) fn new(result: SweepResult) -> Self {
        Self {
            result,
            imprints: PyOnceLock::new(),
            descriptors: PyOnceLock::new(),
        }
    }
}

#[pymethods]
impl Atlas {
    /// The imprints: a bool array, imprints × rows × columns.
    #[getter]
    fn imprints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        let make = || {
            let size = self.result.grid.sensor().size();
            let sides = [size.rows(), size.columns()].map(usize::from);
            let array = zeros(py, vec![self.result.atlas.len(), sides[0], sides[1]])?;
            let mut cells = array.try_readwrite()?;
            let cells = cells.as_slice_mut()?.chunks_mut(size.cells());
            for (cells, entry) in cells.zip(self.result.atlas.entries()) {
                write(&entry.imprint, cells);
            }
            Ok::<_, PyErr>(array.unbind())
        };
        Ok(self.imprints.get_or_try_init(py, make)?.bind(py).clone())
    }

    /// The number of poses that leave each imprint: a uint64 array.
    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        PyArray1::from_iter(py, self.result.atlas.counts())
    }

    /// The descriptors of the main region of each imprint: a dict of float64 arrays by the keys of "na", "cg_x" and so
    /// on, NaN where a descriptor does not exist.
    #[getter]
    fn descriptors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let make = || {
            let all = PyDict::new(py);
            for (index, feature) in features().iter().enumerate() {
                let values = self.result.atlas.values(index).into_iter();
                let values = values.map(|value| value.unwrap_or(f64::NAN));
                all.set_item(&feature.key, PyArray1::from_iter(py, values))?;
            }
            Ok::<_, PyErr>(all.unbind())
        };
        Ok(self.descriptors.get_or_try_init(py, make)?.bind(py).clone())
    }

    /// The number of poses.
    #[getter]
    fn poses(&self) -> u64 {
        self.result.poses
    }

    /// The number of poses that reach beyond the sensor.
    #[getter]
    fn partly_off(&self) -> u64 {
        self.result.partly_off
    }

    /// The statistics of each descriptor over all poses: a dict of dicts with "min", "mean", "max", "sd", "cv" and so on;
    /// None where there is no value.
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for row in &self.result.statistics {
            let values = PyDict::new(py);
            for column in STATISTIC_COLUMNS {
                values.set_item(column.key, (column.value)(row))?;
            }
            all.set_item(&row.feature.key, values)?;
        }
        Ok(all)
    }

    /// Writes the file of `taxel sweep --atlas`: .npz, .csv or .jsonl. An existing file is replaced.
    ///
    /// Raises ValueError for another ending, OSError if the file cannot be written.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let path = atlas_path(path).map_err(wrong)?;
        let write = || write_atlas(&path, &self.result, Existing::Replaced)?.persist();
        py.detach(write).map(drop).map_err(unwritten)
    }

    fn __len__(&self) -> usize {
        self.result.atlas.len()
    }

    fn __repr__(&self) -> String {
        let (imprints, poses) = (self.result.atlas.len(), self.result.poses);
        format!("<taxel.Atlas: {imprints} imprints in {poses} poses>")
    }
}
