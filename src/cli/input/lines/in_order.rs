//! Processes items on several threads and returns their results in the order of the items.
//!
//! ```text
//! source, on a thread of its own -> this thread -> workers -> this thread: sorts -> sink
//! ```
//! A fixed number of items is under way at a time, so memory is bounded. If the sink fails, the thread of the source
//! is not waited for: it may be reading from a terminal.

use std::collections::BTreeMap;
use std::panic::resume_unwind;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use taxel_core::lock::locked;

/// The items under way per worker: one in work, the others so that it need not wait when another worker is slow.
const UNDER_WAY: usize = 4;

enum Event<T, R> {
    Item(T),
    End,
    Done(usize, R),
    Panicked,
}

/// Sends [`Event::Panicked`] if its thread panics; the others would wait for it for ever.
struct PanicReport<T, R>(Sender<Event<T, R>>);

impl<T, R> Drop for PanicReport<T, R> {
    fn drop(&mut self) {
        if thread::panicking() {
            // Without a receiver, nobody waits.
            let _ = self.0.send(Event::Panicked);
        }
    }
}

/// Passes each item of `source` to one of up to `jobs` workers, and the results to `sink`, in the order of the items.
/// Each thread makes its worker with `worker`. With one job, all work is done on this thread.
pub(crate) fn in_order<T, R, E, S, W>(
    jobs: usize,
    source: S,
    worker: impl Fn() -> W + Sync,
    mut sink: impl FnMut(R) -> Result<(), E>,
) -> Result<(), E>
where
    T: Send + 'static,
    R: Send + 'static,
    S: FnMut() -> Option<T> + Send + 'static,
    W: FnMut(T) -> R,
{
    if jobs <= 1 {
        let (mut source, mut worker) = (source, worker());
        while let Some(item) = source() {
            sink(worker(item))?;
        }
        return Ok(());
    }
    let (events, heard) = channel();
    let (work, jobs_given) = channel();
    let jobs_given = Mutex::new(jobs_given);
    thread::scope(|scope| {
        // They are dropped at the end of this block, which ends the workers: after a failure, no queued item is
        // started.
        let (work, heard) = (work, heard);
        for _ in 0..jobs {
            let (jobs_given, worker) = (&jobs_given, &worker);
            let events = PanicReport(events.clone());
            scope.spawn(move || work_off(jobs_given, worker(), &events.0));
        }
        let next = read_ahead(source, jobs, events);
        hand_over(&heard, &work, &next, &mut sink)
    })
}

fn work_off<T, R>(
    given: &Mutex<Receiver<(usize, T)>>,
    mut worker: impl FnMut(T) -> R,
    events: &Sender<Event<T, R>>,
) {
    loop {
        let next = locked(given).recv();
        let Ok((number, item)) = next else {
            return;
        };
        if events.send(Event::Done(number, worker(item))).is_err() {
            return;
        }
    }
}

/// Starts the thread of the source. It reads an item for each message that it receives; the first messages are
/// already sent.
fn read_ahead<T, R, S>(mut source: S, workers: usize, events: Sender<Event<T, R>>) -> Sender<()>
where
    T: Send + 'static,
    R: Send + 'static,
    S: FnMut() -> Option<T> + Send + 'static,
{
    let (next, asked) = channel();
    for () in std::iter::repeat_n((), workers * UNDER_WAY) {
        // Its receiver is in this function.
        let _ = next.send(());
    }
    let events = PanicReport(events);
    thread::spawn(move || {
        for () in asked {
            let item = source();
            let last = item.is_none();
            let event = item.map_or(Event::End, Event::Item);
            if events.0.send(event).is_err() || last {
                return;
            }
        }
    });
    next
}

fn hand_over<T, R, E>(
    events: &Receiver<Event<T, R>>,
    work: &Sender<(usize, T)>,
    next: &Sender<()>,
    sink: &mut impl FnMut(R) -> Result<(), E>,
) -> Result<(), E> {
    let mut early = BTreeMap::new();
    let (mut given, mut delivered, mut ended) = (0, 0, false);
    while !ended || delivered < given {
        match events.recv() {
            Ok(Event::Item(item)) => {
                // Its receiver outlives this function.
                let _ = work.send((given, item));
                given += 1;
            }
            Ok(Event::End) => ended = true,
            Ok(Event::Done(number, result)) => {
                early.insert(number, result);
                while let Some(result) = early.remove(&delivered) {
                    sink(result)?;
                    delivered += 1;
                    // After its last item, the source no longer listens.
                    let _ = next.send(());
                }
            }
            Ok(Event::Panicked) | Err(_) => resume_unwind(Box::new("a worker panicked")),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::time::Duration;

    /// Each worker finishes its current item, but does not start a queued one.
    #[test]
    fn an_error_of_the_sink_stops_the_work() {
        const JOBS: usize = 2;
        let (begun, is_full) = (AtomicUsize::new(0), AtomicBool::new(false));
        // The source never ends.
        let mut items = 0..;
        let done = in_order(
            JOBS,
            move || items.next(),
            || {
                |item: u64| {
                    begun.fetch_add(1, Ordering::SeqCst);
                    while item > 0 && !is_full.load(Ordering::SeqCst) {
                        thread::yield_now();
                    }
                    // Wait until the failure has been handled.
                    thread::sleep(Duration::from_millis(if item > 0 { 50 } else { 0 }));
                }
            },
            |()| {
                is_full.store(true, Ordering::SeqCst);
                Err("full")
            },
        );
        assert_eq!(done, Err("full"));
        let begun = begun.into_inner();
        assert!(begun <= 1 + JOBS, "{begun} items were begun");
    }

    #[test]
    fn a_panic_of_a_worker_does_not_hang() {
        let run = std::panic::catch_unwind(|| {
            in_order(
                2,
                || Some(1),
                || |_: i32| -> i32 { resume_unwind(Box::new("broken")) },
                |_| Ok::<_, ()>(()),
            )
        });
        assert!(run.is_err());
    }
}
