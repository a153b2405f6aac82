//! Disk requests, handled one after the other on a separate thread, so that no key waits for a disk or for the lock
//! of another program.
//!
//! ```text
//! request -> thread -> answer within QUICK: handled at once, before the next key
//!                      later: a message wakes the loop, keys go on meanwhile; the screen says what is waited for
//! ```
//! Without a receiver of events, as in a script, a request is carried out at once.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::Builder;
use std::time::{Duration, Instant};

use crate::lock::locked;
use crate::storage::Library;
use crate::tui::app::library::{LibraryEvent, LibraryRequest};
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::runtime::disk::request::{DiskAnswer, DiskRequest};
use crate::tui::runtime::disk::write_access::WriteAccess;
use crate::tui::runtime::slow_work::SlowWork;
use crate::tui::runtime::work::progress::{WorkerEventSink, caught};

/// The time that a key waits for an answer. Nearly all answers come within it, so that the next key finds the work
/// done.
const QUICK: Duration = Duration::from_millis(100);

/// The queue of requests to the disk.
#[derive(Debug)]
pub(in crate::tui::runtime) struct DiskQueue {
    /// The library that is read or changed.
    library: Library,
    /// The rule for where files may be written.
    pub(in crate::tui::runtime) access: Arc<WriteAccess>,
    /// The screen's end of the thread, once there is one.
    thread: Option<DiskThread>,
    /// The requests without an answer; the first is being carried out.
    pending: VecDeque<PendingRequest>,
    /// The receiver of the event that there is an answer; None to work without a thread.
    post: Option<Post>,
}

/// A request without an answer.
#[derive(Debug)]
struct PendingRequest {
    /// The work, and the time when it was asked for.
    work: SlowWork,
    /// Whether it needs the lock of the library.
    locks: bool,
}

/// A sink of events that implements `Debug`.
struct Post(WorkerEventSink);

impl std::fmt::Debug for Post {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Post")
    }
}

/// The screen's end of the thread that carries out requests.
#[derive(Debug)]
struct DiskThread {
    shared: Arc<SharedQueue>,
    /// The answers, in the order of the requests.
    answers: Receiver<DiskAnswer>,
}

/// The state that both ends share: the requests that wait for the thread.
#[derive(Debug)]
struct SharedQueue {
    waiting: Mutex<WaitingRequests>,
    /// Notified when `waiting` changes.
    changed: Condvar,
    /// The channel of the answers. It is used under the lock of `waiting`, and only by the thread of the present
    /// generation.
    answer: Sender<DiskAnswer>,
}

/// The requests that no thread has begun.
#[derive(Debug, Default)]
struct WaitingRequests {
    requests: VecDeque<DiskRequest>,
    /// The number of the present thread. Only this thread takes requests and gives answers: the threads before it
    /// hang.
    generation: u64,
    /// Whether no more requests come.
    is_closed: bool,
}

impl SharedQueue {
    /// Carries out requests, as the thread of this generation, until another thread takes over or no more come.
    fn work(
        &self,
        generation: u64,
        library: &Library,
        access: &WriteAccess,
        post: &WorkerEventSink,
    ) {
        while let Some(request) = self.next(generation) {
            let failed = match &request {
                DiskRequest::Library(LibraryRequest::Store(..)) => LibraryEvent::NotStored,
                _ => LibraryEvent::Failed,
            };
            let made = caught(|| request.perform(library, access));
            let made = made.unwrap_or_else(|reason| DiskAnswer::Library(failed(reason)));
            let waiting = locked(&self.waiting);
            if waiting.generation != generation || self.answer.send(made).is_err() {
                return;
            }
            drop(waiting);
            post(WorkerEvent::Answered);
        }
    }

    /// Waits for the next request; None when no more come, or another generation takes them.
    fn next(&self, generation: u64) -> Option<DiskRequest> {
        let mut waiting = locked(&self.waiting);
        while waiting.generation == generation {
            if let Some(request) = waiting.requests.pop_front() {
                return Some(request);
            }
            if waiting.is_closed {
                break;
            }
            let woken = self.changed.wait(waiting);
            waiting = woken.unwrap_or_else(PoisonError::into_inner);
        }
        None
    }
}

impl DiskQueue {
    /// Returns a queue for a library, whose requests are carried out at once.
    pub(in crate::tui::runtime) fn new(library: Library) -> Self {
        Self {
            library,
            access: Arc::default(),
            thread: None,
            pending: VecDeque::new(),
            post: None,
        }
    }

    /// Carries out requests on a thread from now on.
    pub(in crate::tui::runtime) fn post_to(&mut self, post: WorkerEventSink) {
        self.post = Some(Post(post));
    }

    /// Carries out a request, at once or on the thread. Returns the answer if it comes within a moment.
    pub(in crate::tui::runtime) fn ask(&mut self, request: DiskRequest) -> Option<DiskAnswer> {
        if let Some(answer) = self.begin(request) {
            return Some(answer);
        }
        // Behind another request it takes long.
        let is_first = self.pending.len() == 1;
        is_first.then(|| self.wait(QUICK)).flatten()
    }

    /// Gives a request to the thread. Without one, carries it out and returns the answer.
    pub(in crate::tui::runtime) fn begin(&mut self, request: DiskRequest) -> Option<DiskAnswer> {
        self.start();
        let Some(thread) = &self.thread else {
            return Some(request.perform(&self.library, &self.access));
        };
        // Keys that repeat change a threshold more often than a disk can write.
        if let Some(last) = locked(&thread.shared.waiting).requests.back_mut()
            && request.replaces(last)
        {
            *last = request;
            return None;
        }
        self.pending.push_back(PendingRequest {
            work: SlowWork::new(request.words()),
            locks: request.locks(),
        });
        locked(&thread.shared.waiting).requests.push_back(request);
        thread.shared.changed.notify_all();
        None
    }

    /// Starts the thread if one is wanted and none runs. Without a thread, requests are carried out at once.
    fn start(&mut self) {
        if self.thread.is_some() || self.post.is_none() {
            return;
        }
        let (answer, answers) = channel();
        let shared = Arc::new(SharedQueue {
            waiting: Mutex::default(),
            changed: Condvar::new(),
            answer,
        });
        if self.spawn(&shared, 0) {
            self.thread = Some(DiskThread { shared, answers });
        }
    }

    /// Starts the thread of a generation. Returns whether the system gave one.
    fn spawn(&self, shared: &Arc<SharedQueue>, generation: u64) -> bool {
        let Some(Post(post)) = &self.post else {
            return false;
        };
        let (shared, library) = (Arc::clone(shared), self.library.clone());
        let (access, post) = (Arc::clone(&self.access), Arc::clone(post));
        let body = move || shared.work(generation, &library, &access, &post);
        Builder::new().spawn(body).is_ok()
    }

    /// Returns the next answer, if there is one within `time`.
    pub(in crate::tui::runtime) fn wait(&mut self, time: Duration) -> Option<DiskAnswer> {
        let answer = self.thread.as_ref()?.answers.recv_timeout(time).ok()?;
        self.pending.pop_front();
        Some(answer)
    }

    /// Returns true if every request has its answer.
    pub(in crate::tui::runtime) fn is_idle(&self) -> bool {
        self.pending.is_empty()
    }

    /// Returns the number of requests without an answer.
    pub(in crate::tui::runtime) fn len(&self) -> usize {
        self.pending.len()
    }

    /// Stops waiting for the first request. Its thread ends when the disk lets it, and another one carries out the
    /// other requests. Returns the description of the first request.
    pub(in crate::tui::runtime) fn abandon_first(&mut self) -> Option<String> {
        let first = self.pending.pop_front()?;
        if let Some(thread) = &self.thread {
            let mut waiting = locked(&thread.shared.waiting);
            if waiting.requests.len() > self.pending.len() {
                // The thread has not begun it.
                waiting.requests.pop_front();
            } else if thread.answers.try_recv().is_err() {
                // It has not been answered just now, so its thread hangs.
                waiting.generation += 1;
                let generation = waiting.generation;
                drop(waiting);
                if !self.spawn(&thread.shared, generation) {
                    // Requests are carried out at once from now on; the waiting ones are lost.
                    (self.thread, self.pending) = (None, VecDeque::new());
                }
            }
        }
        Some(first.work.words)
    }

    /// Returns when to check again on the first request; None if there is none.
    pub(in crate::tui::runtime) fn next_check(&self) -> Option<Instant> {
        Some(self.pending.front()?.work.next_check())
    }

    /// Returns the description of the first request and of what it waits for, if it takes long.
    pub(in crate::tui::runtime) fn status(&self) -> Option<String> {
        let first = self.pending.front()?;
        let what = if self.waits_for_lock() {
            "another taxel to release the library"
        } else {
            "the disk"
        };
        first.work.status(what)
    }

    /// Returns true if the first request waits for another program rather than for the disk.
    fn waits_for_lock(&self) -> bool {
        let locks = self.pending.front().is_some_and(|first| first.locks);
        locks && self.library.waits_for_lock()
    }

    /// Returns a line for each request that may not be done if the program ends now.
    pub(in crate::tui::runtime) fn left(&self) -> Vec<String> {
        let why = if self.waits_for_lock() {
            "another program holds the library"
        } else {
            "the disk does not answer"
        };
        let lines = self.pending.iter().map(|request| &request.work.words);
        lines
            .map(|words| format!("{words}: not done yet, because {why}\n"))
            .collect()
    }
}

impl Drop for DiskQueue {
    /// Closes the queue: the thread ends when it has carried out the requests.
    fn drop(&mut self) {
        if let Some(thread) = &self.thread {
            locked(&thread.shared.waiting).is_closed = true;
            thread.shared.changed.notify_all();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a queue whose thread does not run yet, as if the system had not started it.
    fn without_thread() -> DiskQueue {
        let (answer, answers) = channel();
        let shared = Arc::new(SharedQueue {
            waiting: Mutex::default(),
            changed: Condvar::new(),
            answer,
        });
        let mut queue = DiskQueue::new(Library::open("/nowhere".into()));
        queue.post_to(Arc::new(|_| {}));
        queue.thread = Some(DiskThread { shared, answers });
        queue
    }

    #[test]
    fn a_request_that_is_given_up_is_not_carried_out() {
        let mut queue = without_thread();
        for request in [LibraryRequest::List, LibraryRequest::Trash] {
            assert!(queue.begin(DiskRequest::Library(request)).is_none());
        }
        assert!(queue.abandon_first().is_some());
        let shared = &queue.thread.as_ref().expect("a thread").shared;
        assert!(queue.spawn(shared, 0));
        let answer = queue.wait(Duration::from_secs(5));
        let is_second = matches!(answer, Some(DiskAnswer::Library(LibraryEvent::Trash(_))));
        assert!(is_second, "{answer:?}");
        assert!(queue.is_idle());
    }
}
