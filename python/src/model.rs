//! Training and recognition.

use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::Ordering;

use numpy::PyArrayDyn;
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyList};
use rayon::prelude::*;
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::pose::{Anchor, Axis, DecimalRange, Reach, SensorSides, check_given};
use taxel_core::recognition::{
    Answer as CoreAnswer, CellPositions, Evaluation, Evidence, LEAST_SIDE, Model as CoreModel,
    NamedShape, Noise, Separation, SeparationPoint, SizeAxis, Training, TrainingError,
};
use taxel_core::sensor::Sensor as CoreSensor;
use taxel_core::source::Source;
use taxel_files::formats::{MODEL_FORMAT, archive_kind};
use taxel_files::storage::{Existing, load_atlas, load_whole_model, save_model};

use crate::arrays::{
    imprint, imprints, interruptible, mask, shaped, unread, unwritten, within_memory, wrong,
};
use crate::atlas::Atlas;
use crate::sensor::{Sensor, range, ranges};
use crate::shapes::source;

/// Learns every imprint of a set of shapes: a Model, as `taxel model train` makes it.
///
/// shapes is a dict of shapes by their names, or a list, whose shapes are named by their kind or their file. sensor is a
/// Sensor; without it, the smallest that holds all shapes, at least 16 × 16. Ranges are those of Sensor.sweep; without x0
/// and y0, the centre of each shape is touched at positions × positions places in one cell. weights is a dict of how
/// often shapes are expected, 1 unless given. Uses all cores, releases the interpreter and stops on Ctrl-C.
///
/// Raises ValueError for a wrong set or range, and for poses that the sensor cuts off, unless allow_cut is set.
#[pyfunction]
#[pyo3(signature = (shapes, sensor=None, *, x0=None, y0=None, angle=None, zoom_x=None, zoom_y=None, anchor=None, positions=100, weights=None, allow_cut=false))]
pub(crate) fn train(
    shapes: &Bound<'_, PyAny>,
    sensor: Option<&Bound<'_, Sensor>>,
    x0: Option<&Bound<'_, PyAny>>,
    y0: Option<&Bound<'_, PyAny>>,
    angle: Option<&Bound<'_, PyAny>>,
    zoom_x: Option<&Bound<'_, PyAny>>,
    zoom_y: Option<&Bound<'_, PyAny>>,
    anchor: Option<&str>,
    positions: u8,
    weights: Option<&Bound<'_, PyDict>>,
    allow_cut: bool,
) -> PyResult<Model> {
    let py = shapes.py();
    let sensor = sensor.map(Bound::get);
    let shapes = set(shapes, sensor.and_then(|own| own.pitch), weights)?;
    let given = ranges([x0, y0, angle, zoom_x, zoom_y])?;
    let positions = CellPositions::new(positions);
    let positions =
        positions.ok_or_else(|| wrong("positions: expected 1, 2, 4, 5, 10, 20, 25, 50 or 100"))?;
    let usual = match x0.or(y0) {
        Some(_) => Anchor::Corner,
        None => Anchor::Centre,
    };
    let anchor = anchor.map_or(Ok(usual), str::parse).map_err(wrong)?;
    let sides = SensorSides {
        columns: sensor.map(|own| own.own.columns()),
        rows: sensor.map(|own| own.own.rows()),
        ..SensorSides::at_least(LEAST_SIDE)
    };
    check_given(&given, &sides.largest()).map_err(wrong)?;
    let sources: Vec<&Source> = shapes.iter().map(|shape| &shape.source).collect();
    let reach = Reach::of_all(sources.iter().copied(), anchor, &given).map_err(wrong)?;
    let (fitting, ranges) = reach.best_sensor(&sources, &given, sides, positions.step());
    let sensor = sensor.map_or(fitting, |own| own.own);
    let training = Training::new(shapes, sensor, anchor, ranges)
        .map_err(wrong)?
        .allow_cut(allow_cut);
    let advice = "take fewer shapes or coarser steps";
    let trained = within_memory(py, advice, |progress| {
        training.with_progress(progress).run()
    })?;
    trained.map(Model::new).map_err(wrong)
}

/// The shapes of a set, each at the origin.
fn set(
    shapes: &Bound<'_, PyAny>,
    pitch: Option<f64>,
    weights: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<NamedShape>> {
    let mut all = Vec::new();
    if let Ok(shapes) = shapes.cast::<PyDict>() {
        for (name, shape) in shapes {
            all.push((name.extract()?, source(&shape)?));
        }
    } else {
        for shape in shapes.try_iter()? {
            let shape = source(&shape?)?;
            all.push((
                shape.stored_name().unwrap_or(shape.kind_name()).to_owned(),
                shape,
            ));
        }
    }
    let named = all.into_iter().map(|(name, shape)| {
        let refused = |error: String| wrong(format!("{name}: {error}"));
        let value = |own: Parameter| match own {
            Parameter::X0 | Parameter::Y0 => Some(0.0),
            own => shape.get(own),
        };
        let shape = shape
            .clone()
            .placed(&CoreSensor::LARGEST, value)
            .map_err(|error| refused(error.to_string()))?;
        let shape = shape
            .at_pitch(pitch)
            .map_err(|error| refused(error.to_string()))?;
        shape
            .check_size(&CoreSensor::LARGEST)
            .map_err(|error| refused(error.to_string()))?;
        let weight = weights
            .map(|own| own.get_item(&name))
            .transpose()?
            .flatten();
        let weight = weight.map_or(Ok(1), |own| own.extract())?;
        Ok(NamedShape::new(name, shape).weighted(weight))
    });
    named.collect()
}

/// Reads a Model, or the Atlas of a sweep, from a file that this module or the program has written.
///
/// Raises OSError if the file cannot be read, ValueError if it is of another kind.
#[pyfunction]
pub(crate) fn load(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    let refused = |error| unread(&path, &error);
    let file = std::fs::File::open(&path).map_err(|error| refused(error.into()))?;
    let is_atlas = archive_kind(&file).is_ok_and(|(format, _)| format != MODEL_FORMAT);
    if is_atlas {
        let atlas = py.detach(|| load_atlas(&path)).map_err(refused)?;
        return Ok(Atlas::new(atlas).into_pyobject(py)?.into_any());
    }
    let model = py.detach(|| load_whole_model(&path)).map_err(refused)?;
    Ok(Model::new(model).into_pyobject(py)?.into_any())
}

/// Every imprint of a set of shapes, and how often each shape leaves it; made by taxel.train or taxel.load.
#[pyclass(frozen, module = "taxel")]
#[derive(Debug)]
pub(crate) struct Model {
    own: CoreModel,
    limit: OnceLock<Evaluation>,
}

impl Model {
    fn new(own: CoreModel) -> Self {
        let limit = OnceLock::new();
        Self { own, limit }
    }

    fn evaluation(&self, py: Python<'_>) -> &Evaluation {
        py.detach(|| self.limit.get_or_init(|| Evaluation::of(&self.own)))
    }
}

#[pymethods]
impl Model {
    /// The names of the shapes, in the order of the set: a list of str.
    #[getter]
    fn labels(&self) -> Vec<&str> {
        self.own.shapes().iter().map(|shape| &*shape.name).collect()
    }

    /// The Sensor.
    #[getter]
    fn sensor(&self) -> Sensor {
        Sensor::of(*self.own.sensor(), None)
    }

    /// The number of poses of each shape.
    #[getter]
    fn poses(&self) -> u64 {
        self.own.poses()
    }

    /// The share of touches that even the best classifier of one touch names wrong (the Bayes error), from 0 to 1.
    #[getter]
    fn error(&self, py: Python<'_>) -> f64 {
        self.evaluation(py).error()
    }

    /// The best classifier's confusion: a uint64 array, true shapes × named shapes, in the order of labels.
    fn confusion<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<u64>>> {
        let limit = self.evaluation(py);
        let cells = limit.confusion.rows().flatten().map(u64::try_from);
        let cells = cells.collect::<Result<_, _>>().map_err(wrong)?;
        shaped(py, cells, &[limit.labels.len(); 2])
    }

    /// Names the shape that left an imprint: an Answer; a list of them for a stack, imprints × rows × columns.
    ///
    /// noise is the probability that a taxel flips, below 0.5; 0 allows imprints of trained poses only. The active taxels
    /// of dead, an array of bool, are left out. A shape fits if at most tolerance taxels differ. Answers less probable
    /// than reject are rejected. Uses all cores, releases the interpreter and stops on Ctrl-C.
    ///
    /// Raises ValueError for another array and for a number out of range.
    #[pyo3(signature = (imprint, *, noise=None, dead=None, tolerance=None, reject=None))]
    fn recognise<'py>(
        &self,
        imprint: &Bound<'py, PyAny>,
        noise: Option<f64>,
        dead: Option<&Bound<'py, PyAny>>,
        tolerance: Option<u32>,
        reject: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = imprint.py();
        let (touches, is_stack) = imprints(imprint)?;
        let dead = dead.map(self::imprint).transpose()?;
        let noise = noise.map(Noise::new).transpose().map_err(wrong)?;
        if tolerance.is_some() && noise.is_some_and(|noise| noise.flip() == 0.0) {
            return Err(wrong(
                "tolerance cannot be used with noise=0, which fits no shape",
            ));
        }
        if let Some(reject) = reject.filter(|own| !(0.0..=1.0).contains(own)) {
            return Err(wrong(format!(
                "reject {reject}: expected a probability from 0 to 1"
            )));
        }
        if let (Some(dead), Some(touch)) = (&dead, touches.first())
            && dead.size() != touch.size()
        {
            return Err(wrong(format!(
                "dead has {} taxels, the imprint {}",
                dead.size(),
                touch.size()
            )));
        }
        let answers = interruptible(py, |stopped| {
            let answer = |touch: &Imprint| {
                let touch = std::slice::from_ref(touch);
                let mut evidence = Evidence::of(touch).under(&noise).without(&dead);
                (evidence.tolerance, evidence.reject_below) = (tolerance, reject);
                (!stopped.load(Ordering::Relaxed)).then(|| self.own.recognise(evidence))
            };
            touches.par_iter().map(answer).collect::<Option<Vec<_>>>()
        })?;
        let answers = answers
            .into_iter()
            .flatten()
            .map(|own| Answer::new(py, own, &self.own));
        let mut answers = answers.collect::<PyResult<Vec<_>>>()?;
        if is_stack {
            return answers.into_pyobject(py);
        }
        Ok(answers.remove(0).into_pyobject(py)?.into_any())
    }

    /// How the error of the set depends on the size of its shapes and on the threshold, as `taxel model separate` says:
    /// a dict with "axis", "points" (a list of dicts) and, with want, "want".
    ///
    /// scale, or pitch in mm, and threshold are ranges as of Sensor.sweep. want is an error, from 0 to 1: the smallest
    /// size with at most that error is searched. Uses all cores, releases the interpreter and stops on Ctrl-C.
    #[pyo3(signature = (*, scale=None, pitch=None, threshold=None, want=None))]
    fn separate<'py>(
        &self,
        py: Python<'py>,
        scale: Option<&Bound<'_, PyAny>>,
        pitch: Option<&Bound<'_, PyAny>>,
        threshold: Option<&Bound<'_, PyAny>>,
        want: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (axis, sizes) = match (scale, pitch) {
            (Some(_), Some(_)) => {
                return Err(PyTypeError::new_err("expected scale or pitch, not both"));
            }
            (_, Some(pitch)) => (SizeAxis::Pitch, range(pitch, "pitch")?),
            (Some(scale), _) => (SizeAxis::Scale, range(scale, "scale")?),
            (None, None) => (SizeAxis::Scale, DecimalRange::whole(1)),
        };
        let threshold = threshold.map(|own| range(own, "threshold")).transpose()?;
        let thresholds = threshold.map_or(vec![self.own.sensor().threshold()], |own| {
            own.values().collect()
        });
        let mut separation = Separation::new(self.own.shapes().to_vec()).map_err(wrong)?;
        let own = self.own.ranges();
        separation.steps.angles = own[Axis::Angle];
        separation.steps.positions = CellPositions::of(own).unwrap_or(CellPositions::FINE);
        let advice = "take fewer shapes, smaller sizes or coarser steps";
        let curves = within_memory(py, advice, |progress| {
            let curve = |&threshold: &f64| {
                let sizes = axis.smallest_first(&sizes).into_iter();
                let at = |size| separation.at(axis, size, threshold, progress);
                // Sizes at which the shapes fit on no sensor are left out.
                let fits = |tried: &Result<_, _>| !matches!(tried, Err(TrainingError::Large));
                let points = sizes.map(at).filter(fits).collect::<Result<Vec<_>, _>>()?;
                let search = |error| {
                    separation
                        .smallest(axis, &points, error, progress)
                        .transpose()
                };
                let found = want.and_then(search).transpose()?;
                Ok((threshold, points, found))
            };
            thresholds
                .iter()
                .map(curve)
                .collect::<Result<Vec<_>, TrainingError>>()
        })?;
        let (points, wanted) = (PyList::empty(py), PyList::empty(py));
        for (threshold, curve, found) in curves.map_err(wrong)? {
            for own in &curve {
                points.append(point(py, axis, own)?)?;
            }
            let smallest = found
                .as_ref()
                .map(|own| point(py, axis, &own.point))
                .transpose()?;
            let found = found.map(|own| (own.step, own.missed_again)).unzip();
            let row = [
                ("threshold", threshold.into_bound_py_any(py)?),
                ("error", want.into_bound_py_any(py)?),
                ("smallest", smallest.into_bound_py_any(py)?),
                ("step", found.0.into_bound_py_any(py)?),
                ("missed_again", found.1.into_bound_py_any(py)?),
            ];
            wanted.append(row.into_py_dict(py)?)?;
        }
        let all = [
            ("axis", axis.name().into_bound_py_any(py)?),
            ("points", points.into_any()),
        ]
        .into_py_dict(py)?;
        if want.is_some() {
            all.set_item("want", wanted)?;
        }
        Ok(all)
    }

    /// Writes the file of `taxel model train`, .npz. An existing file is replaced.
    ///
    /// Raises OSError if the file cannot be written.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| save_model(&self.own, &path, Existing::Replaced))
            .map_err(unwritten)
    }

    fn __repr__(&self) -> String {
        format!(
            "<taxel.Model: {} of {} poses each>",
            self.labels().join(", "),
            self.poses()
        )
    }
}

/// A point of `taxel model separate`, by its keys.
fn point<'py>(
    py: Python<'py>,
    axis: SizeAxis,
    own: &SeparationPoint,
) -> PyResult<Bound<'py, PyDict>> {
    let limit = &own.limit;
    let all = PyDict::new(py);
    all.set_item(axis.name(), own.value)?;
    all.set_item("scale", own.scale)?;
    all.set_item("threshold", own.threshold)?;
    all.set_item("error", limit.error())?;
    all.set_item("touches", limit.touches)?;
    all.set_item("right", limit.right)?;
    all.set_item("certain", limit.certainty.unwrap_or_default().touches)?;
    all.set_item("keys", limit.keys)?;
    all.set_item("side", own.side)?;
    Ok(all)
}

/// The answer of Model.recognise.
#[pyclass(frozen, get_all, module = "taxel")]
#[derive(Debug)]
pub(crate) struct Answer {
    /// The name of the shape; None if rejected or unknown.
    name: Option<String>,
    /// "certain", "likely", "tied", "rejected" or "unknown".
    state: &'static str,
    /// The names of the shapes that nothing tells apart, if the state is "tied".
    tied: Vec<String>,
    /// The shapes of positive probability, the likeliest first: a list of (name, probability).
    ranking: Vec<(String, f64)>,
    /// The taxels in which the touch of the fitted shape differs; None if none was fitted.
    differs: Option<u32>,
    /// The pose of the fitted shape: a dict with x0 and y0 in cells, angle in degrees, and zooms other than 1; or None.
    pose: Option<Py<PyDict>>,
    /// The fitted shape: a dict with name, differs and the keys of pose; or None.
    fit: Option<Py<PyDict>>,
    /// The nearest imprint of the model: a dict with name, distance in taxels, and imprint; or None.
    nearest: Option<Py<PyDict>>,
    /// Whether the imprint reaches the rim of the sensor, so that it may be cut off.
    at_rim: bool,
    /// The imprints that were compared: "exact", "one-flip" or "scan".
    method: &'static str,
}

impl Answer {
    fn new(py: Python<'_>, own: CoreAnswer, model: &CoreModel) -> PyResult<Self> {
        let name = |shape: usize| model.shapes()[shape].name.clone();
        let (mut pose, mut fit, mut nearest) = (None, None, None);
        if let Some(own) = &own.fit {
            let (place, all) = (PyDict::new(py), PyDict::new(py));
            for axis in Axis::ALL {
                let value = own.source.get(axis.parameter());
                if let Some(value) = value.filter(|value| !axis.is_zoom() || *value != 1.0) {
                    place.set_item(axis.name(), value)?;
                }
            }
            all.set_item("name", name(own.shape))?;
            all.set_item("differs", own.differs)?;
            all.update(place.as_mapping())?;
            (pose, fit) = (Some(place.unbind()), Some(all.unbind()));
        }
        if let Some(own) = &own.nearest {
            let all = PyDict::new(py);
            all.set_item("name", name(own.shape))?;
            all.set_item("distance", own.distance)?;
            all.set_item("imprint", mask(py, &own.imprint)?)?;
            nearest = Some(all.unbind());
        }
        Ok(Self {
            name: own.shape.map(name),
            state: own.state.name(),
            tied: own.tied.into_iter().map(name).collect(),
            ranking: own
                .ranking
                .into_iter()
                .map(|(shape, share)| (name(shape), share))
                .collect(),
            differs: own.fit.as_ref().map(|own| own.differs),
            pose,
            fit,
            nearest,
            at_rim: own.at_rim,
            method: own.method.name(),
        })
    }
}

#[pymethods]
impl Answer {
    fn __repr__(&self) -> String {
        let name = self.name.as_deref().unwrap_or("None");
        format!("<taxel.Answer: {name}, {}>", self.state)
    }
}
