//! The threads that share long work on the screen.
//!
//! `rayon` builds the pool of a program once. If the system refuses a thread then, every later use of the pool panics.
//! Therefore all its threads are there before it is built. If there are too few, each thread does its own work alone:
//! ```text
//! prepare   on the screen's thread, before there is work: a thread a core, or a pool of that thread alone
//! start     a thread for work
//! run       on a thread that has work: in that pool, or in one of its own
//! ```

use std::io;
use std::sync::OnceLock;
use std::sync::mpsc::{Sender, channel};
use std::thread::{Builder, JoinHandle, available_parallelism};
use std::time::{Duration, Instant};

use rayon::{ThreadBuilder, ThreadPoolBuilder};

use crate::formats::file::system_reason;

/// The longest time that the end of the program waits for the disk.
pub(crate) const PATIENCE: Duration = Duration::from_millis(1500);

/// The pause between two checks of a thread that is about to end.
const PAUSE: Duration = Duration::from_millis(5);

/// Whether there is a pool whose threads share work.
static SHARED: OnceLock<bool> = OnceLock::new();

/// Builds the pool of the program, once.
pub(in crate::tui::runtime) fn prepare() {
    SHARED.get_or_init(|| {
        let Ok(threads) = spare_threads() else {
            let alone = ThreadPoolBuilder::new().num_threads(1).use_current_thread();
            // The command line may have built one before the screen began.
            return alone.build_global().is_err();
        };
        let pool = ThreadPoolBuilder::new().num_threads(threads.len());
        let mut threads = threads.into_iter();
        let pool = pool.spawn_handler(|body| {
            let sent = threads.next().map(|thread| thread.send(body));
            let sent = sent.and_then(Result::ok);
            sent.ok_or_else(|| io::ErrorKind::BrokenPipe.into())
        });
        // If there is one already, these threads end.
        let _ = pool.build_global();
        true
    });
}

/// Starts a thread for each core. Each waits for its task in a pool.
fn spare_threads() -> io::Result<Vec<Sender<ThreadBuilder>>> {
    let cores = available_parallelism().map_or(1, usize::from);
    let spare = (0..cores).map(|_| {
        let (give, given) = channel::<ThreadBuilder>();
        Builder::new().spawn(move || given.recv().map(ThreadBuilder::run))?;
        Ok(give)
    });
    spare.collect()
}

/// Starts a thread.
///
/// # Errors
/// Returns a sentence if the system gives no thread.
pub(in crate::tui::runtime) fn start(
    body: impl FnOnce() + Send + 'static,
) -> Result<JoinHandle<()>, String> {
    let thread = Builder::new().spawn(body);
    thread.map_err(|error| format!("cannot start a thread: {}", system_reason(&error)))
}

/// Waits for a thread to end, but not for longer than `patience`. It is not joined: a disk or a host that does not
/// answer may hold it up.
pub(in crate::tui::runtime) fn wait_until_finished(thread: &JoinHandle<()>, patience: Duration) {
    let begun = Instant::now();
    while !thread.is_finished() && begun.elapsed() < patience {
        std::thread::sleep(PAUSE);
    }
}

/// Does work on a thread that was started for it.
pub(in crate::tui::runtime) fn run(work: impl FnOnce() + Send) {
    if SHARED.get() != Some(&false) {
        return work();
    }
    let alone = ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    match alone.build() {
        Ok(pool) => pool.install(work),
        // The thread has a pool already.
        Err(_) => work(),
    }
}
