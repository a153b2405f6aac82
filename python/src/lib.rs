//! The Python module `taxel`, below what `taxel/__init__.py` says of it: arrays in, arrays out. All that is computed is
//! computed by `taxel-core`, all files are read and written by `taxel-files`; `main` is the program.
//!
//! ```text
//! failure  what Python raises
//! arrays   numpy arrays and imprints; long work that stops on Ctrl-C
//! shapes   Shape: figures, pictures, outlines
//! sensor   Sensor, and the Swept of an Atlas
//! model    Trained, of a Model
//! frames   recordings, thresholds, and the Watch of a live sensor
//! ```

mod arrays;
mod failure;
mod frames;
mod model;
mod sensor;
mod shapes;

use std::ffi::OsString;
use std::io::{self, Write};
use std::panic::catch_unwind;
use std::sync::atomic::Ordering;

use numpy::PyReadonlyArray3;
use pyo3::prelude::*;
use rayon::prelude::*;
use taxel_core::imprint::Imprint;
use taxel_files::formats::{DescribedImprint, json};

use crate::failure::Result;

#[pymodule]
mod _taxel {
    #[pymodule_export]
    use crate::frames::{Watch, read, threshold};
    #[pymodule_export]
    use crate::model::{Trained, load, train};
    #[pymodule_export]
    use crate::sensor::{Sensor, Swept, sweep};
    #[pymodule_export]
    use crate::shapes::{Shape, read_outline};
    #[pymodule_export]
    use crate::{describe, main};
}

/// The answers of `taxel batch` to a stack of imprints, as JSON.
#[pyfunction]
fn describe(py: Python<'_>, imprints: PyReadonlyArray3<'_, bool>) -> Result<String> {
    let imprints = arrays::imprints(&imprints)?;
    let answers = arrays::interruptible(py, |stopped| {
        let goes_on = |_: &&Imprint| !stopped.load(Ordering::Relaxed);
        let imprints = imprints.par_iter().filter(goes_on);
        let answers = imprints.map(|own| json::text(&DescribedImprint(own)));
        answers.collect::<Vec<_>>().join(",")
    })?;
    Ok(format!("[{answers}]"))
}

/// The program, which prints what it has to say; returns its exit status.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    // A panic has said what it is, and ends the program as it does without Python.
    let status = py.detach(|| catch_unwind(|| taxel::cli::run(arguments)).unwrap_or(101));
    // The answers are written; that they cannot be flushed, the status has told.
    let _ = io::stdout().flush();
    status
}
