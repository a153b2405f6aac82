//! Training and recognition.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::Ordering;

use numpy::{PyArrayDyn, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rayon::prelude::*;
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::pose::{Anchor, Axis, Reach, SensorSides, check_given};
use taxel_core::recognition::{
    Answer, CellPositions, Evaluation, Evidence, LEAST_SIDE, Model, NamedShape, Noise, Separation,
    SeparationPoint, SizeAxis, Training, TrainingError,
};
use taxel_core::sensor::Sensor as CoreSensor;
use taxel_core::source::Source;
use taxel_files::formats::{MODEL_FORMAT, archive_kind};
use taxel_files::storage::{Existing, load_atlas, load_whole_model, save_model};

use crate::arrays::{imprints, interruptible, shaped, within_memory};
use crate::failure::{Failure, Result};
use crate::sensor::{Sensor, Swept, given_ranges, range};
use crate::shapes::Shape;

/// The shapes are given with their names and weights; the ranges by the names of their axes.
#[pyfunction]
pub(crate) fn train(
    py: Python<'_>,
    shapes: Vec<(Option<String>, Bound<'_, Shape>, u32)>,
    sensor: Option<Bound<'_, Sensor>>,
    ranges: HashMap<String, String>,
    anchor: Option<&str>,
    positions: u8,
    allow_cut: bool,
) -> Result<Trained> {
    let (sensor, given) = (sensor.as_ref().map(Bound::get), given_ranges(&ranges)?);
    let pitch = sensor.and_then(|own| own.pitch);
    let shapes = shapes.into_iter().map(|(name, shape, weight)| {
        let own = &shape.get().0;
        let at_origin = |parameter| match parameter {
            Parameter::X0 | Parameter::Y0 => Some(0.0),
            parameter => own.get(parameter),
        };
        let placed = own.clone().placed(&CoreSensor::LARGEST, at_origin)?;
        let placed = placed.at_pitch(pitch)?;
        placed.check_size(&CoreSensor::LARGEST)?;
        let stored = own.stored_name().filter(|name| !name.is_empty());
        let name = name.unwrap_or_else(|| stored.unwrap_or(own.kind_name()).to_owned());
        Ok(NamedShape::new(name, placed).weighted(weight))
    });
    let shapes = shapes.collect::<Result<Vec<_>>>()?;
    let positions = CellPositions::new(positions);
    let expected = "positions: expected 1, 2, 4, 5, 10, 20, 25, 50 or 100";
    let positions = positions.ok_or_else(|| Failure::new(expected))?;
    let is_placed = given[Axis::X0].or(given[Axis::Y0]).is_some();
    let usual = if is_placed {
        Anchor::Corner
    } else {
        Anchor::Centre
    };
    let anchor = anchor.map_or(Ok(usual), str::parse)?;
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
    let trained = within_memory(py, "take fewer shapes or coarser steps", |progress| {
        training.with_progress(progress).run()
    })?;
    Ok(trained?.into())
}

/// Loads what a Model or an Atlas holds.
#[pyfunction]
pub(crate) fn load(py: Python<'_>, path: PathBuf) -> Result<Bound<'_, PyAny>> {
    let refused = |error| Failure::of(&path, error);
    let file = std::fs::File::open(&path).map_err(|error| refused(error.into()))?;
    if archive_kind(&file).is_ok_and(|(format, _)| format != MODEL_FORMAT) {
        let atlas = py.detach(|| load_atlas(&path)).map_err(refused)?;
        return Ok(Swept(atlas).into_pyobject(py)?.into_any());
    }
    let model = py.detach(|| load_whole_model(&path)).map_err(refused)?;
    Ok(Trained::from(model).into_pyobject(py)?.into_any())
}

/// What a Model holds.
#[pyclass(frozen)]
pub(crate) struct Trained {
    own: Model,
    limit: OnceLock<Evaluation>,
}

impl From<Model> for Trained {
    fn from(own: Model) -> Self {
        let limit = OnceLock::new();
        Self { own, limit }
    }
}

impl Trained {
    fn limit(&self, py: Python<'_>) -> &Evaluation {
        py.detach(|| self.limit.get_or_init(|| Evaluation::of(&self.own)))
    }
}

/// The parts of an Answer.
fn answered<'py>(py: Python<'py>, own: Answer, model: &Model) -> Result<Bound<'py, PyTuple>> {
    let name = |shape: usize| &*model.shapes()[shape].name;
    let ranking = own.ranking.into_iter();
    let ranking = ranking.map(|(shape, share)| (name(shape), share));
    let mut pose = None;
    if let Some(fit) = &own.fit {
        let place = pose.insert(PyDict::new(py));
        for axis in Axis::ALL {
            let value = fit.source.get(axis.parameter());
            if let Some(value) = value.filter(|value| !axis.is_zoom() || *value != 1.0) {
                place.set_item(axis.name(), value)?;
            }
        }
    }
    let parts = (
        own.shape.map(name),
        own.state.name(),
        ranking.collect::<Vec<_>>(),
        own.fit.as_ref().map(|fit| name(fit.shape)),
        own.fit.as_ref().map(|fit| fit.differs),
        pose,
        own.tied.into_iter().map(name).collect::<Vec<_>>(),
        own.at_rim,
    );
    Ok(parts.into_pyobject(py)?)
}

#[pymethods]
impl Trained {
    /// The names of the shapes, and what makes the Sensor.
    fn head(&self) -> (Vec<&str>, (u8, u8, f64)) {
        let sensor = self.own.sensor();
        let names = self.own.shapes().iter().map(|shape| &*shape.name);
        let sensor = (sensor.columns(), sensor.rows(), sensor.threshold());
        (names.collect(), sensor)
    }

    fn error(&self, py: Python<'_>) -> f64 {
        self.limit(py).error()
    }

    fn confusion<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArrayDyn<u64>>> {
        let limit = self.limit(py);
        let cells = limit.confusion.rows().flatten();
        let cells = cells.map(|cell| Ok(u64::try_from(cell)?));
        shaped(py, cells.collect::<Result<_>>()?, &[limit.labels.len(); 2])
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
        let touches = imprints(&touches)?;
        let dead = dead.as_ref().map(imprints).transpose()?;
        let dead = dead.as_ref().and_then(|own| own.first());
        let noise = noise.map(Noise::new).transpose()?;
        let answers = interruptible(py, |stopped| {
            let answer = |touch: &Imprint| {
                let evidence = Evidence::of(std::slice::from_ref(touch));
                let mut evidence = evidence.under(&noise).without(dead);
                (evidence.tolerance, evidence.reject_below) = (tolerance, reject);
                (!stopped.load(Ordering::Relaxed)).then(|| self.own.recognise(evidence))
            };
            touches.par_iter().map(answer).collect::<Option<Vec<_>>>()
        })?;
        let answers = answers.into_iter().flatten();
        let answers = answers.map(|own| answered(py, own, &self.own));
        answers.collect()
    }

    fn separate<'py>(
        &self,
        py: Python<'py>,
        scale: Option<&str>,
        pitch: Option<&str>,
        threshold: Option<f64>,
    ) -> Result<Vec<Bound<'py, PyDict>>> {
        let (axis, sizes) = match (scale, pitch) {
            (Some(scale), None) => (SizeAxis::Scale, range(scale, "scale")?),
            (None, Some(pitch)) => (SizeAxis::Pitch, range(pitch, "pitch")?),
            _ => return Err(Failure::new("expected a range as scale, or as pitch")),
        };
        let threshold = threshold.unwrap_or(self.own.sensor().threshold());
        let mut separation = Separation::new(self.own.shapes().to_vec())?;
        let (steps, own) = (&mut separation.steps, self.own.ranges());
        steps.angles = own[Axis::Angle];
        steps.positions = CellPositions::of(own).unwrap_or(CellPositions::FINE);
        let advice = "take fewer shapes, smaller sizes or coarser steps";
        let points = within_memory(py, advice, |progress| {
            let sizes = axis.smallest_first(&sizes).into_iter();
            let points = sizes.map(|size| separation.at(axis, size, threshold, progress));
            let fits = |point: &std::result::Result<_, _>| point != &Err(TrainingError::Large);
            points
                .filter(fits)
                .collect::<std::result::Result<Vec<_>, _>>()
        })?;
        let point = |own: SeparationPoint| {
            let (limit, point) = (&own.limit, PyDict::new(py));
            point.set_item("scale", own.scale)?;
            point.set_item(axis.name(), own.value)?;
            point.set_item("threshold", own.threshold)?;
            point.set_item("error", limit.error())?;
            point.set_item("touches", limit.touches)?;
            point.set_item("right", limit.right)?;
            point.set_item("certain", limit.certainty.unwrap_or_default().touches)?;
            point.set_item("keys", limit.keys)?;
            point.set_item("side", own.side)?;
            Ok(point)
        };
        points?.into_iter().map(point).collect()
    }

    fn save(&self, py: Python<'_>, path: PathBuf) -> Result<()> {
        Ok(py.detach(|| save_model(&self.own, &path, Existing::Replaced))?)
    }
}
