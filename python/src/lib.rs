//! The Python module `taxel`: arrays in, arrays out. All that is computed is computed by `taxel-core`, all files are
//! read and written by `taxel-files`; `_main` is the program.
//!
//! ```text
//! arrays   numpy arrays and imprints; long work that stops on Ctrl-C; errors
//! shapes   Figure, Picture, Outline
//! sensor   Sensor: touch, coverage, sweep
//! atlas    Atlas
//! model    train, load, Model, Answer
//! frames   read, threshold, watch, Recording, Frame
//! ```

mod arrays;
mod atlas;
mod frames;
mod model;
mod sensor;
mod shapes;

use std::ffi::OsString;
use std::io::{self, Write};
use std::panic::catch_unwind;

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use pythonize::pythonize;
use taxel_core::description::{DESCRIPTORS, Description, Value, regions};
use taxel_core::imprint::Imprint;

/// Exact tactile imprints of flat shapes, their descriptors, and what one touch can tell.
///
/// Arrays are numpy's: an imprint is bool, rows × columns; frames are float64, frames × rows × columns, NaN where there
/// is no cell. Lengths are in cells, x to the right, y down; angles in degrees. What is wrong with a value is a
/// ValueError, with a file an OSError, in the program's words.
#[pymodule]
mod taxel {
    #[pymodule_export]
    use crate::atlas::Atlas;
    #[pymodule_export]
    use crate::frames::{Frame, Recording, Watch, read, threshold, watch};
    #[pymodule_export]
    use crate::model::{Answer, Model, load, train};
    #[pymodule_export]
    use crate::sensor::Sensor;
    #[pymodule_export]
    use crate::shapes::{Figure, Outline, Picture};
    #[pymodule_export]
    use crate::{_main, describe};
}

/// The regions of an imprint with their descriptors: a list of dicts, or for a stack, imprints × rows × columns, a list
/// of such lists.
///
/// The keys are those of `taxel describe --json`: "kind" ("exterior" or "hole"), "na", "nae", "ce" and so on; None where
/// a descriptor does not exist.
///
/// Raises ValueError for another array.
#[pyfunction]
fn describe<'py>(imprint: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = imprint.py();
    let (imprints, is_stack) = arrays::imprints(imprint)?;
    let described = |imprint: &Imprint| {
        let own = PyList::empty(py);
        for region in regions(imprint) {
            own.append(record(py, &Description::of(&region))?)?;
        }
        Ok::<_, PyErr>(own)
    };
    if !is_stack {
        return Ok(described(&imprints[0])?.into_any());
    }
    let all = PyList::empty(py);
    for imprint in &imprints {
        py.check_signals()?;
        all.append(described(imprint)?)?;
    }
    Ok(all.into_any())
}

/// A region as in the answers of `taxel batch`.
fn record<'py>(py: Python<'py>, region: &Description) -> PyResult<Bound<'py, PyDict>> {
    let record = PyDict::new(py);
    record.set_item("kind", region.kind.name())?;
    for descriptor in DESCRIPTORS.iter().filter(|descriptor| descriptor.in_answer) {
        let value = match (descriptor.measure)(region) {
            Value::None => py.None().into_bound(py),
            Value::Count(count) => count.into_bound_py_any(py)?,
            Value::Number(number) => number.into_bound_py_any(py)?,
            Value::Point(point) => PyList::new(py, point.to_array())?.into_any(),
            Value::Pair(pair) => PyList::new(py, pair)?.into_any(),
            Value::Rect(rect) => pythonize(py, &rect)?,
        };
        record.set_item(descriptor.key, value)?;
    }
    Ok(record)
}

/// The command `taxel`: returns the exit status of the program.
#[pyfunction]
fn _main(py: Python<'_>) -> PyResult<u8> {
    let arguments: Vec<OsString> = py.import("sys")?.getattr("argv")?.extract()?;
    // The program catches signals itself. Python only notes them, and would act after the program.
    let signal = py.import("signal")?;
    let interrupt = signal.getattr("SIGINT")?;
    if signal
        .call_method1("getsignal", (&interrupt,))?
        .is(signal.getattr("default_int_handler")?)
    {
        signal.call_method1("signal", (interrupt, signal.getattr("SIG_DFL")?))?;
    }
    // A panic has said what it is, and ends the program as it does without Python.
    let status = py.detach(|| catch_unwind(|| ::taxel::cli::run(arguments)).unwrap_or(101));
    // The answers are written; that they cannot be flushed, the status has told.
    let _ = io::stdout().flush();
    Ok(status)
}
