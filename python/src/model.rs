//! Training and recognition.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArrayDyn, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyTuple};
use taxel_core::pose::{Axis, Reach, SensorSides, check_given};
use taxel_core::recognition::{
    Answer, CellPositions, Evaluation, Evidence, LEAST_SIDE, Model as Trained, Noise, Training,
};
use taxel_core::sensor::Sensor as CoreSensor;
use taxel_core::source::Source;
use taxel_files::formats::{MODEL_FORMAT, archive_kind};
use taxel_files::storage::{Existing, load_atlas, load_whole_model, save_model};

use crate::arrays::{answers, imprints, shaped, within_memory};
use crate::failure::{Failure, Result};
use crate::sensor::{Atlas, Sensor, given_ranges};
use crate::shapes::Shape;

/// The shapes are given with their names and weights; the ranges by the names of their axes.
#[pyfunction]
pub(crate) fn train(
    py: Python<'_>,
    shapes: Vec<(Option<String>, Bound<'_, Shape>, u32)>,
    sensor: Option<Bound<'_, Sensor>>,
    ranges: HashMap<String, String>,
    anchor: &str,
    positions: u8,
    allow_cut: bool,
) -> Result<Model> {
    let (sensor, given) = (sensor.as_ref().map(Bound::get), given_ranges(&ranges)?);
    let shapes = shapes.into_iter().map(|(name, shape, weight)| {
        let mut own = shape.get().0.clone().weighted(weight);
        own.name = name.unwrap_or(own.name);
        own.source = own.source.at_pitch(sensor.and_then(|own| own.pitch))?;
        own.source.check_size(&CoreSensor::LARGEST)?;
        Ok(own)
    });
    let shapes = shapes.collect::<Result<Vec<_>>>()?;
    let expected = "positions: expected 1, 2, 4, 5, 10, 20, 25, 50 or 100";
    let positions = CellPositions::new(positions).ok_or(expected)?;
    let anchor = anchor.parse()?;
    let sides = SensorSides {
        columns: sensor.map(|own| own.own.columns()),
        rows: sensor.map(|own| own.own.rows()),
        ..SensorSides::at_least(LEAST_SIDE)
    };
    check_given(&given, &sides.largest())?;
    let sources: Vec<&Source> = shapes.iter().map(|shape| &shape.source).collect();
    let reach = Reach::of_all(sources.iter().copied(), anchor, &given)?;
    let (fitting, ranges) = reach.best_sensor(&sources, &given, sides, positions.step());
    let sensor = sensor.map_or(fitting, |own| own.own);
    let training = Training::new(shapes, sensor, anchor, ranges)?.allow_cut(allow_cut);
    let trained = within_memory(py, |progress| {
        training.with_progress(progress).run().map(Model::of)
    })?;
    Ok(trained?)
}

/// Loads what the class Model or Atlas is made of.
#[pyfunction]
pub(crate) fn load(py: Python<'_>, path: PathBuf) -> Result<Bound<'_, PyAny>> {
    let refused = |error| Failure::of(&path, error);
    let file = std::fs::File::open(&path).map_err(|error| refused(error.into()))?;
    if archive_kind(&file).is_ok_and(|(format, _)| format != MODEL_FORMAT) {
        let atlas = py.detach(|| load_atlas(&path)).map_err(refused)?;
        return Ok(Atlas(Arc::new(atlas)).into_pyobject(py)?.into_any());
    }
    let model = py.detach(|| load_whole_model(&path).map(Model::of));
    Ok(model.map_err(refused)?.into_pyobject(py)?.into_any())
}

/// A model and its limit; the class Model is made of it.
#[pyclass(frozen, subclass, module = "taxel._taxel")]
#[derive(Clone)]
pub(crate) struct Model(Arc<(Trained, Evaluation)>);

impl Model {
    fn of(model: Trained) -> Self {
        let limit = Evaluation::of(&model);
        Self(Arc::new((model, limit)))
    }
}

/// The parts of an Answer.
fn answered<'py>(py: Python<'py>, own: Answer, model: &Trained) -> Result<Bound<'py, PyTuple>> {
    let name = |shape: usize| &*model.shapes()[shape].name;
    let rank = |(shape, share)| (name(shape), share);
    let pose = own.fit.as_ref().map(|fit| {
        let value = |axis: Axis| Some((axis, fit.source.get(axis.parameter())?));
        let values = Axis::ALL.into_iter().filter_map(value);
        let values = values.filter(|(axis, value)| !axis.is_zoom() || *value != 1.0);
        let values = values.map(|(axis, value)| (axis.name(), value));
        values.into_py_dict(py)
    });
    let parts = (
        own.shape.map(name),
        own.state.name(),
        own.ranking.into_iter().map(rank).collect::<Vec<_>>(),
        own.fit.as_ref().map(|fit| name(fit.shape)),
        own.fit.as_ref().map(|fit| fit.differs),
        pose.transpose()?,
        own.tied.into_iter().map(name).collect::<Vec<_>>(),
        own.at_rim,
    );
    Ok(parts.into_pyobject(py)?)
}

#[pymethods]
impl Model {
    #[new]
    fn new(own: &Bound<'_, Self>) -> Self {
        own.get().clone()
    }

    /// What makes the Sensor.
    fn sides(&self) -> (u8, u8, f64) {
        let sensor = self.0.0.sensor();
        (sensor.columns(), sensor.rows(), sensor.threshold())
    }

    /// The names of the shapes, in the order of the set.
    #[getter]
    fn labels(&self) -> Vec<String> {
        self.0.1.labels.clone()
    }

    /// The share of touches that even the best classifier of one touch names wrong (the Bayes error), from 0 to 1.
    #[getter]
    fn error(&self) -> f64 {
        self.0.1.error()
    }

    /// The best classifier's confusion: a uint64 array, true shapes × named shapes, in the order of labels.
    fn confusion<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArrayDyn<u64>>> {
        let cells = self.0.1.confusion.rows().flatten().map(u64::try_from);
        let cells = cells.collect::<std::result::Result<_, _>>()?;
        shaped(py, cells, &[self.0.1.labels.len(); 2])
    }

    fn recognise<'py>(
        &self,
        py: Python<'py>,
        touches: PyReadonlyArray3<'py, bool>,
        noise: Option<f64>,
        dead: Option<PyReadonlyArray3<'py, bool>>,
        tolerance: Option<u32>,
        reject: Option<f64>,
    ) -> Result<Vec<Bound<'py, PyTuple>>> {
        let dead = dead.as_ref().map(imprints).transpose()?;
        let dead = dead.as_ref().and_then(|own| own.first());
        let noise = noise.map(Noise::new).transpose()?;
        let answers = answers(py, &touches, |touch| {
            let evidence = Evidence::of(std::slice::from_ref(touch));
            let mut evidence = evidence.under(&noise).without(dead);
            (evidence.tolerance, evidence.reject_below) = (tolerance, reject);
            self.0.0.recognise(evidence)
        })?;
        let answered = |own| answered(py, own, &self.0.0);
        answers.into_iter().map(answered).collect()
    }

    /// Writes the file of `taxel model train`, .npz. An existing file is replaced.
    ///
    /// Raises `OSError` if the file cannot be written.
    fn save(&self, py: Python<'_>, path: PathBuf) -> Result<()> {
        Ok(py.detach(|| save_model(&self.0.0, &path, Existing::Replaced))?)
    }
}
