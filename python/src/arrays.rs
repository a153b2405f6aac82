//! Between numpy arrays and imprints; long work that releases the interpreter and stops on Ctrl-C.

use std::array::from_fn;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, LazyLock, Mutex};
use std::time::Duration;

use numpy::ndarray::ArrayView2;
use numpy::prelude::*;
use numpy::{Element, IxDyn, PyArray1, PyArrayDyn, PyReadonlyArray3};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use taxel_core::imprint::Imprint;
use taxel_core::lock::locked;
use taxel_core::progress::{Progress, stop_if};
use taxel_core::sensor::MatrixSize;
use taxel_files::memory::MemoryGuard;

use crate::failure::Result;

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
    let [rows, columns] = [1, 2].map(|axis| u8::try_from(stack.shape()[axis]));
    let size = MatrixSize::new(columns?, rows?)?;
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
static BITS: LazyLock<[[bool; 8]; 256]> =
    LazyLock::new(|| from_fn(|byte| from_fn(|bit| byte >> bit & 1 == 1)));

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
    static POOLS: Mutex<BTreeMap<u32, Arc<ThreadPool>>> = Mutex::new(BTreeMap::new());
    let (mut pools, process) = (locked(&POOLS), std::process::id());
    if let Entry::Vacant(own) = pools.entry(process) {
        own.insert(Arc::new(ThreadPoolBuilder::new().build()?));
    }
    Ok(Arc::clone(&pools[&process]))
}

/// The time after which Ctrl-C is looked for.
pub(crate) const TICK: Duration = Duration::from_millis(50);

/// Does long work on all cores without holding the interpreter. Ctrl-C sets the flag that the work gets, which then
/// ends soon; its result is dropped.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> Result<T> {
    let (stopped, threads) = (AtomicBool::new(false), threads()?);
    let wait = || {
        let (sender, done) = sync_channel(1);
        let (stopped, work) = (&stopped, || work(&stopped));
        threads.in_place_scope(|scope| {
            // A panic drops the sender, and goes on when the scope ends.
            scope.spawn(move |_| drop(sender.send(work())));
            loop {
                match done.recv_timeout(TICK) {
                    Err(RecvTimeoutError::Timeout) => Python::attach(|py| {
                        let signals = py.check_signals();
                        stopped.store(signals.is_err(), Ordering::Relaxed);
                        signals
                    })?,
                    done => return Ok(done?),
                }
            }
        })
    };
    py.detach(wait)
}

/// What `answer` says of each imprint in a stack, on all cores.
pub(crate) fn answers<T: Send>(
    py: Python<'_>,
    stack: &PyReadonlyArray3<'_, bool>,
    answer: impl Fn(&Imprint) -> T + Sync + Send,
) -> Result<Vec<T>> {
    let imprints = imprints(stack)?;
    interruptible(py, |stopped| {
        let goes_on = |_: &&Imprint| !stopped.load(Ordering::Relaxed);
        imprints.par_iter().filter(goes_on).map(answer).collect()
    })
}

/// Fills the parts of an array, `size` elements each, on all cores; fails as the first part that cannot be filled.
pub(crate) fn fill_each<T: Send, S>(
    py: Python<'_>,
    (elements, size): (&mut [T], usize),
    start: impl Fn() -> S + Sync + Send,
    fill: impl Fn(&mut S, usize, &mut [T]) -> Result<()> + Sync + Send,
) -> Result<()> {
    let failure = interruptible(py, |stopped| {
        let parts = elements.par_chunks_mut(size).enumerate().with_min_len(64);
        let filled = parts.map_init(start, |state, (index, part)| {
            if stopped.load(Ordering::Relaxed) {
                return Err("stopped".into());
            }
            fill(state, index, part)
        });
        filled.find_map_first(Result::err)
    })?;
    failure.map_or(Ok(()), Err)
}

/// [`interruptible`] work that reports its progress, within the memory that is free.
pub(crate) fn within_memory<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&dyn Progress) -> T + Send,
) -> Result<T> {
    let memory = MemoryGuard::new("take coarser steps, shorter ranges or fewer shapes");
    let done = interruptible(py, |stopped| {
        memory.limit(&|_| stop_if(stopped.load(Ordering::Relaxed)), work)
    })?;
    Ok(done.map_err(PyMemoryError::new_err)?)
}
