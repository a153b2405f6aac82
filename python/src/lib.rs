//! The Python module `taxel`, below what `taxel/__init__.py` says of it: arrays in, arrays out. All that is computed is
//! computed by `taxel-core`, all files are read and written by `taxel-files`; `main` is the program.
//!
//! ```text
//! failure  what Python raises
//! arrays   numpy arrays and imprints; long work that stops on Ctrl-C
//! shapes   Shape: figures, pictures, outlines
//! sensor   Sensor and Atlas
//! model    Model: training and recognition
//! frames   recordings, thresholds, Watch: a live sensor
//! ```

mod arrays;
mod failure;
mod frames;
mod model;
mod sensor;
mod shapes;

use std::ffi::OsString;
use std::io::{self, Write};

use numpy::PyReadonlyArray3;
use pyo3::prelude::*;
use taxel_files::formats::{DescribedImprint, json};

use crate::arrays::answers;
use crate::failure::Result;

#[pymodule]
mod _taxel {
    #[pymodule_export]
    use crate::{
        describe,
        frames::{Watch, read, threshold},
        main,
        model::{Model, load, train},
        sensor::{Atlas, Sensor, sweep},
        shapes::{Shape, read_outline},
    };
}

/// The answers of `taxel batch` to a stack of imprints, as JSON.
#[pyfunction]
fn describe(py: Python<'_>, imprints: PyReadonlyArray3<'_, bool>) -> Result<Vec<String>> {
    answers(py, &imprints, |own| json::text(&DescribedImprint(own)))
}

/// The program, which prints what it has to say; returns its exit status.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let status = py.detach(|| taxel::cli::run(arguments));
    // The answers are written; that they cannot be flushed, the status has told.
    let _ = io::stdout().flush();
    status
}
