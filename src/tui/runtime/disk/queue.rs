//! Requests to the disk, carried out one after the other on a thread of their own, so that no key waits for a disk or
//! for the lock of another program.
//!
//! ```text
//! request -> thread -> answer within QUICK: handled at once, before the next key
//!                      later: a message wakes the loop, keys go on meanwhile; the screen says what is waited for
//! ```
//! Without a receiver of events, as in a script, a request is carried out at once. An answer to a reading waits until
//! no other page stands above the one that asked for it; Esc on that page drops it.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use taxel_files::storage::Library;

use crate::tui::app::message::{LibraryEvent, LibraryRequest, WorkerEvent};
use crate::tui::runtime::disk::files::WriteAccess;
use crate::tui::runtime::disk::request::{DiskAnswer, DiskRequest};
use crate::tui::runtime::work::execution::{WorkerEventSink, caught, start};

/// The time that a key waits for an answer. Nearly all answers come within it, so that the next key finds the work
/// done.
const QUICK: Duration = Duration::from_millis(100);

const SLOW: Duration = Duration::from_millis(300);

#[derive(Debug)]
pub(in crate::tui::runtime) struct DiskQueue {
    library: Library,
    pub(in crate::tui::runtime) access: Arc<WriteAccess>,
    thread: Option<DiskThread>,
    /// The requests without an answer; the first is being carried out.
    pending: VecDeque<PendingRequest>,
    answers: VecDeque<(usize, DiskAnswer)>,
    /// The receiver of the event that there is an answer; None to work without a thread.
    post: Option<Post>,
}

#[derive(Debug)]
struct PendingRequest {
    words: String,
    since: Instant,
    locks: bool,
    reader: Reader,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reader {
    /// The whole program: it is a change.
    Program,
    Page(usize),
    /// Nobody any more.
    Nobody,
}

struct Post(WorkerEventSink);

impl std::fmt::Debug for Post {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Post")
    }
}

#[derive(Debug)]
struct DiskThread {
    requests: Sender<DiskRequest>,
    answers: Receiver<DiskAnswer>,
}

impl DiskQueue {
    pub(in crate::tui::runtime) fn new(library: Library) -> Self {
        Self {
            library,
            access: Arc::default(),
            thread: None,
            pending: VecDeque::new(),
            answers: VecDeque::new(),
            post: None,
        }
    }

    pub(in crate::tui::runtime) fn post_to(&mut self, post: WorkerEventSink) {
        self.post = Some(Post(post));
    }

    /// Makes a change, and waits a moment for the answer.
    pub(in crate::tui::runtime) fn change(&mut self, request: DiskRequest) {
        self.begin(request);
        self.wait_a_moment();
    }

    pub(in crate::tui::runtime) fn read(&mut self, request: DiskRequest, pages: usize) {
        self.ask(request, Reader::Page(pages));
        self.wait_a_moment();
    }

    /// Makes a change whose answer nobody waits for.
    pub(in crate::tui::runtime) fn begin(&mut self, request: DiskRequest) {
        self.ask(request, Reader::Program);
    }

    fn ask(&mut self, request: DiskRequest, reader: Reader) {
        self.start_thread();
        self.pending.push_back(PendingRequest {
            words: request.words(),
            since: Instant::now(),
            locks: request.locks(),
            reader,
        });
        if let Some(thread) = &self.thread {
            // The thread ends only after this end of the channel is dropped.
            drop(thread.requests.send(request));
        } else {
            let answer = request.perform(&self.library, &self.access);
            self.take_over(answer);
        }
    }

    /// Starts the thread if one is wanted and none runs. If the system gives none, requests are carried out at once.
    fn start_thread(&mut self) {
        let Some(Post(post)) = self.post.as_ref().filter(|_| self.thread.is_none()) else {
            return;
        };
        let (requests, asked) = channel();
        let (answer, answers) = channel();
        let (library, access) = (self.library.clone(), Arc::clone(&self.access));
        let post = Arc::clone(post);
        let body = move || {
            for request in asked {
                if answer.send(performed(request, &library, &access)).is_err() {
                    return;
                }
                post(WorkerEvent::Answered);
            }
        };
        self.thread = (start(body).ok()).map(|_| DiskThread { requests, answers });
    }

    /// Waits for the answers to all requests, unless one of them takes long already.
    fn wait_a_moment(&mut self) {
        let is_quick = |first: &PendingRequest| first.since.elapsed() < QUICK;
        let end = Instant::now() + QUICK;
        while self.pending.front().is_some_and(is_quick) && self.wait(end) {}
    }

    pub(in crate::tui::runtime) fn wait(&mut self, end: Instant) -> bool {
        let time = end.saturating_duration_since(Instant::now());
        let answer = self.thread.as_ref();
        let answer = answer.and_then(|thread| thread.answers.recv_timeout(time).ok());
        let is_there = answer.is_some();
        if let Some(answer) = answer {
            self.take_over(answer);
        }
        is_there
    }

    fn take_over(&mut self, answer: DiskAnswer) {
        match self.pending.pop_front().map(|request| request.reader) {
            Some(Reader::Program) => self.answers.push_back((usize::MAX, answer)),
            Some(Reader::Page(pages)) => self.answers.push_back((pages, answer)),
            Some(Reader::Nobody) | None => {}
        }
    }

    /// Takes the next answer to a change, or to the top page of this many.
    pub(in crate::tui::runtime) fn take(&mut self, pages: usize) -> Option<DiskAnswer> {
        while self.wait(Instant::now()) {}
        let mut waiting = self.answers.iter();
        let next = waiting.position(|(asked, _)| *asked >= pages)?;
        self.answers.remove(next).map(|(_, answer)| answer)
    }

    /// Drops the answers that the top page of this many waits for. Returns the description of the first; None if it
    /// waits for nothing.
    pub(in crate::tui::runtime) fn drop_readings(&mut self, pages: usize) -> Option<String> {
        let is_of_page = |request: &&mut PendingRequest| matches!(request.reader, Reader::Page(asked) if asked >= pages);
        let mut first = None;
        for request in self.pending.iter_mut().filter(is_of_page) {
            request.reader = Reader::Nobody;
            first.get_or_insert_with(|| request.words.clone());
        }
        first
    }

    /// Returns true if no change is without its answer.
    pub(in crate::tui::runtime) fn is_idle(&self) -> bool {
        !(self.pending.iter()).any(|request| request.reader == Reader::Program)
    }

    /// Returns when the screen is to say what it waits for; None if it says so already, or waits for nothing.
    pub(in crate::tui::runtime) fn due(&self) -> Option<Instant> {
        let due = self.pending.front()?.since + SLOW;
        (due > Instant::now()).then_some(due)
    }

    pub(in crate::tui::runtime) fn status(&self) -> Option<String> {
        let first = self.pending.front()?;
        let what = if self.waits_for_lock() {
            "another taxel to release the library"
        } else {
            "the disk"
        };
        let end = match first.reader {
            Reader::Page(_) => "; Esc gives up",
            Reader::Program | Reader::Nobody => "",
        };
        (first.since.elapsed() >= SLOW).then(|| format!("{}: waiting for {what}{end}", first.words))
    }

    fn waits_for_lock(&self) -> bool {
        let locks = self.pending.front().is_some_and(|first| first.locks);
        locks && self.library.waits_for_lock()
    }

    /// Returns a line for each change that may not be done if the program ends now.
    pub(in crate::tui::runtime) fn left(&self) -> Vec<String> {
        let why = if self.waits_for_lock() {
            "another program holds the library"
        } else {
            "the disk does not answer"
        };
        let changes = (self.pending.iter()).filter(|request| request.reader == Reader::Program);
        let lines =
            changes.map(|request| format!("{}: not done yet, because {why}\n", request.words));
        let mut lines: Vec<String> = lines.collect();
        // A threshold that is changed often writes the metadata as often.
        lines.dedup();
        lines
    }
}

/// Carries out a request on the thread; a panic is an answer, too.
fn performed(request: DiskRequest, library: &Library, access: &WriteAccess) -> DiskAnswer {
    let failed = match &request {
        DiskRequest::Library(LibraryRequest::Store(..)) => LibraryEvent::NotStored,
        _ => LibraryEvent::Failed,
    };
    let made = caught(|| request.perform(library, access));
    made.unwrap_or_else(|reason| DiskAnswer::Library(failed(reason)))
}
