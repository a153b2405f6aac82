//! Between numpy arrays and imprints; long work that releases the interpreter and stops on Ctrl-C.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::time::Duration;

use numpy::ndarray::ArrayView2;
use numpy::prelude::*;
use numpy::{Element, IxDyn, PyArray1, PyArrayDyn, PyReadonlyArray3, dtype};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use taxel_core::imprint::Imprint;
use taxel_core::lock::locked;
use taxel_core::progress::{Progress, stop_if};
use taxel_core::sensor::MatrixSize;
use taxel_files::memory::MemoryGuard;

use crate::failure::Result;

/// An array that a function fills. It is made by numpy, whose errors say what is too large.
pub(crate) fn filled<'py, T: Element>(
    py: Python<'py>,
    shape: &[usize],
    fill: impl FnOnce(&mut [T]) -> Result<()>,
) -> Result<Bound<'py, PyArrayDyn<T>>> {
    let zeros = py
        .import("numpy")?
        .call_method1("zeros", (shape, dtype::<T>(py)))?;
    let array = zeros.cast_into().map_err(PyErr::from)?;
    fill(PyArrayMethods::try_readwrite(&array)?.as_slice_mut()?)?;
    Ok(array)
}

/// The values of a vector as an array of this shape, without a copy.
pub(crate) fn shaped<'py, T: Element>(
    py: Python<'py>,
    values: Vec<T>,
    shape: &[usize],
) -> Result<Bound<'py, PyArrayDyn<T>>> {
    Ok(PyArray1::from_vec(py, values).reshape(IxDyn(shape))?)
}

/// The imprints in a stack of them.
pub(crate) fn imprints(stack: &PyReadonlyArray3<'_, bool>) -> Result<Vec<Imprint>> {
    let size = MatrixSize::new(
        u8::try_from(stack.shape()[2])?,
        u8::try_from(stack.shape()[1])?,
    )?;
    let imprint = |rows: ArrayView2<'_, bool>| {
        let mut imprint = Imprint::empty(size);
        for (row, cells) in rows.outer_iter().enumerate() {
            let cells = (0..size.columns()).zip(cells);
            let word = cells.fold(0, |word, (column, &cell)| word | u64::from(cell) << column);
            imprint.set_word(row, word);
        }
        imprint
    };
    Ok(stack.as_array().outer_iter().map(imprint).collect())
}

/// The bits of a byte, the lowest first.
static BITS: [[bool; 8]; 256] = {
    let mut bits = [[false; 8]; 256];
    let mut bit = 0;
    while bit < 8 * 256 {
        bits[bit / 8][bit % 8] = (bit / 8) >> (bit % 8) & 1 == 1;
        bit += 1;
    }
    bits
};

/// Writes an imprint to the cells of its matrix, row by row.
pub(crate) fn write(imprint: &Imprint, cells: &mut [bool]) {
    let rows = cells.chunks_mut(usize::from(imprint.columns()));
    for (row, word) in rows.zip(imprint.words()) {
        let (eights, rest) = row.as_chunks_mut();
        let mut bytes = word.to_le_bytes().into_iter();
        for (cells, byte) in eights.iter_mut().zip(&mut bytes) {
            *cells = BITS[usize::from(byte)];
        }
        let last = BITS[usize::from(bytes.next().unwrap_or_default())];
        rest.copy_from_slice(&last[..rest.len()]);
    }
}

/// The threads for long work of this process. A child made by `fork` has none of its parent's, so it gets its own.
fn threads() -> Result<Arc<ThreadPool>> {
    static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    let (mut own, process) = (locked(&POOL), std::process::id());
    if let Some((_, pool)) = own.as_ref().filter(|(owner, _)| *owner == process) {
        return Ok(Arc::clone(pool));
    }
    let pool = Arc::new(ThreadPoolBuilder::new().build()?);
    // The parent's threads cannot be ended from here.
    std::mem::forget(own.replace((process, Arc::clone(&pool))));
    Ok(pool)
}

/// The time after which Ctrl-C is looked for.
pub(crate) const TICK: Duration = Duration::from_millis(50);

/// Does long work on all cores without holding the interpreter. Ctrl-C sets the flag that the work gets, which then
/// ends soon; its result is dropped.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> Result<T> {
    let (stopped, result, is_done) = (AtomicBool::new(false), Mutex::new(None), Condvar::new());
    let waits = || {
        let waited = is_done.wait_timeout_while(locked(&result), TICK, |own| own.is_none());
        waited.is_ok_and(|(own, _)| own.is_none())
    };
    threads()?.in_place_scope(|scope| {
        scope.spawn(|_| {
            let done = catch_unwind(AssertUnwindSafe(|| work(&stopped)));
            *locked(&result) = Some(done);
            is_done.notify_all();
        });
        let mut interrupted = Ok(());
        while py.detach(waits) {
            if interrupted.is_ok() {
                interrupted = py.check_signals();
                stopped.store(interrupted.is_err(), Ordering::Relaxed);
            }
        }
        interrupted
    })?;
    let done = locked(&result).take();
    let done = done.ok_or_else(|| io::Error::other("the work has no result"))?;
    Ok(done.unwrap_or_else(|panic| resume_unwind(panic)))
}

/// [`interruptible`] work that reports its progress, within the memory that is free.
pub(crate) fn within_memory<T: Send>(
    py: Python<'_>,
    advice: &'static str,
    work: impl FnOnce(&dyn Progress) -> T + Send,
) -> Result<T> {
    let memory = MemoryGuard::new(advice);
    let done = interruptible(py, |stopped| {
        memory.limit(&|_| stop_if(stopped.load(Ordering::Relaxed)), work)
    })?;
    Ok(done.map_err(PyMemoryError::new_err)?)
}
