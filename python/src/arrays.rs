//! Between numpy arrays and imprints; long work that releases the interpreter and stops on Ctrl-C.

use std::any::Any;
use std::fmt::Display;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::time::Duration;

use numpy::{
    Element, IxDyn, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods,
    PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods, dtype, get_array_module,
};
use pyo3::exceptions::{PyMemoryError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use taxel_core::imprint::Imprint;
use taxel_core::lock::locked;
use taxel_core::progress::{Progress, stop_if};
use taxel_core::sensor::{MAX_SIDE, MatrixSize};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::FileError;
use taxel_files::{ReadError, ReadErrorKind};

/// A `ValueError` with the program's sentence.
pub(crate) fn wrong(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The error about a file: an `OSError` if the system refused, otherwise a `ValueError`.
pub(crate) fn unread(path: &Path, error: &ReadError) -> PyErr {
    let name = path.to_string_lossy();
    let text = error.to_string();
    let text = if text.starts_with(&*name) {
        text
    } else {
        format!("{name}: {text}")
    };
    match error.kind {
        ReadErrorKind::Io(kind) => io::Error::new(kind, text).into(),
        _ => wrong(text),
    }
}

pub(crate) fn unwritten(error: FileError) -> PyErr {
    io::Error::new(error.error.kind(), error.to_string()).into()
}

/// A `UserWarning` where the program writes a note.
pub(crate) fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let warnings = py.import("warnings")?;
    warnings.call_method1("warn", (text, py.get_type::<PyUserWarning>(), 2))?;
    Ok(())
}

/// An array of zeros, by numpy, whose errors say what is too large.
pub(crate) fn zeros<T: Element>(
    py: Python<'_>,
    shape: Vec<usize>,
) -> PyResult<Bound<'_, PyArrayDyn<T>>> {
    let made = get_array_module(py)?.call_method1("zeros", (shape, dtype::<T>(py)))?;
    Ok(made.cast_into()?)
}

/// The values of a vector as an array of this shape, without a copy.
pub(crate) fn shaped<'py, T: Element>(
    py: Python<'py>,
    values: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    PyArray1::from_vec(py, values).reshape(IxDyn(shape))
}

/// Numbers as an array of f64 in one piece: `values` itself, if it is one.
pub(crate) fn numbers<'py>(
    values: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let numpy = get_array_module(values.py())?;
    let array = numpy.call_method1("asarray", (values,))?;
    let array = array.cast_into::<PyUntypedArray>()?;
    if !b"iuf".contains(&array.dtype().kind()) {
        let found = array.dtype();
        return Err(wrong(format!(
            "{what}: found an array of {found}, expected numbers"
        )));
    }
    let floats = numpy.call_method1("ascontiguousarray", (&array, dtype::<f64>(values.py())))?;
    // What numpy makes of a number has one dimension.
    let floats = floats.call_method1("reshape", (array.shape(),))?;
    Ok(floats.cast_into::<PyArrayDyn<f64>>()?.try_readonly()?)
}

/// Imprints from an array of bool: one, or a stack of them.
pub(crate) fn imprints(array: &Bound<'_, PyAny>) -> PyResult<(Vec<Imprint>, bool)> {
    let refused = |found: String| {
        wrong(format!(
            "found {found}, expected an imprint: an array of bool, rows × columns from 1 × 1 to {MAX_SIDE} × {MAX_SIDE}, or a stack of them"
        ))
    };
    let numpy = get_array_module(array.py())?;
    let array = numpy.call_method1("asarray", (array,))?;
    let untyped = array.cast::<PyUntypedArray>()?;
    let shape = untyped.shape();
    let Ok(masks) = array.cast::<PyArrayDyn<bool>>() else {
        return Err(refused(format!("an array of {}", untyped.dtype())));
    };
    let size = match shape {
        [rows, columns] | [_, rows, columns] => MatrixSize::of_sides(*columns, *rows),
        _ => None,
    };
    let size = size.ok_or_else(|| refused(format!("an array shaped {shape:?}")))?;
    let masks = masks.try_readonly()?;
    let view = masks.as_array();
    let (mut all, mut cells) = (Vec::new(), view.iter());
    for _ in 0..view.len() / size.cells() {
        let mut imprint = Imprint::empty(size);
        for row in 0..usize::from(size.rows()) {
            let columns = 0..size.columns();
            let word = columns
                .zip(&mut cells)
                .fold(0, |word, (column, &cell)| word | u64::from(cell) << column);
            imprint.set_word(row, word);
        }
        all.push(imprint);
    }
    Ok((all, shape.len() == 3))
}

/// One imprint from an array of bool.
pub(crate) fn imprint(array: &Bound<'_, PyAny>) -> PyResult<Imprint> {
    match imprints(array)? {
        (own, false) if own.len() == 1 => Ok(own[0]),
        _ => Err(wrong(
            "found a stack of imprints, expected one: an array of bool, rows × columns",
        )),
    }
}

/// The bits of a byte, the lowest first.
static BITS: [[bool; 8]; 256] = {
    let mut bits = [[false; 8]; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut bit = 0;
        while bit < 8 {
            bits[byte][bit] = byte >> bit & 1 == 1;
            bit += 1;
        }
        byte += 1;
    }
    bits
};

/// Writes an imprint to the cells of its matrix, row by row.
pub(crate) fn write(imprint: &Imprint, cells: &mut [bool]) {
    let rows = cells.chunks_mut(usize::from(imprint.columns()));
    for (row, word) in rows.zip(imprint.words()) {
        for (cells, byte) in row.chunks_mut(8).zip(word.to_le_bytes()) {
            cells.copy_from_slice(&BITS[usize::from(byte)][..cells.len()]);
        }
    }
}

/// An imprint as an array of bool.
pub(crate) fn mask<'py>(
    py: Python<'py>,
    imprint: &Imprint,
) -> PyResult<Bound<'py, PyArray2<bool>>> {
    let sides = [imprint.rows(), imprint.columns()].map(usize::from);
    let array = PyArray2::zeros(py, sides, false);
    write(imprint, array.try_readwrite()?.as_slice_mut()?);
    Ok(array)
}

/// The threads for long work of this process. A child made by `fork` has none of its parent's, so it gets its own.
fn threads() -> PyResult<Arc<ThreadPool>> {
    static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    let mut own = locked(&POOL);
    if let Some((process, pool)) = &*own
        && *process == std::process::id()
    {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().build();
    let pool = Arc::new(pool.map_err(|error| io::Error::other(error.to_string()))?);
    // The parent's threads cannot be ended from here.
    std::mem::forget(own.replace((std::process::id(), Arc::clone(&pool))));
    Ok(pool)
}

/// The time after which Ctrl-C is looked for.
pub(crate) const TICK: Duration = Duration::from_millis(50);

/// Does long work on all cores without holding the interpreter. Ctrl-C sets the flag that the work gets, which then
/// ends soon; its result is dropped.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    let pool = threads()?;
    let stopped = AtomicBool::new(false);
    let (result, is_done) = (
        Mutex::new(None::<Result<T, Box<dyn Any + Send>>>),
        Condvar::new(),
    );
    let interrupted = pool.in_place_scope(|scope| {
        scope.spawn(|_| {
            let done = catch_unwind(AssertUnwindSafe(|| work(&stopped)));
            *locked(&result) = Some(done);
            is_done.notify_all();
        });
        let waits = || {
            let own = locked(&result);
            let waited = is_done.wait_timeout_while(own, TICK, |own| own.is_none());
            waited.is_ok_and(|(own, _)| own.is_none())
        };
        while py.detach(waits) {
            if let Err(interrupt) = py.check_signals() {
                stopped.store(true, Ordering::Relaxed);
                py.detach(|| while waits() {});
                return Err(interrupt);
            }
        }
        Ok(())
    });
    interrupted?;
    let done = locked(&result).take();
    match done {
        Some(Ok(done)) => Ok(done),
        Some(Err(panic)) => resume_unwind(panic),
        None => Err(wrong("stopped before the end")),
    }
}

/// [`interruptible`] work that reports its progress, within the memory that is free.
pub(crate) fn within_memory<T: Send>(
    py: Python<'_>,
    advice: &'static str,
    work: impl FnOnce(&dyn Progress) -> T + Send,
) -> PyResult<T> {
    let memory = MemoryGuard::new(advice);
    let done = interruptible(py, |stopped| {
        memory.limit(&|_| stop_if(stopped.load(Ordering::Relaxed)), work)
    })?;
    done.map_err(PyMemoryError::new_err)
}
