//! Writes unsaved work to the journal on a separate thread, so that no key waits for a disk.
//!
//! ```text
//!            Persist                400 ms, or Flush
//! no work -----------> work, due ---------------------> written: work, nothing due
//!    ^                     ^                            error:   due again in 5 s, reported once
//!    |  Clear              |  Persist                      |
//!    +---- any             +-------------------------------+
//! ```
//! Of the changes within the interval only the last one is written. The thread sleeps while nothing is due. A flush
//! also writes work that was written before, if someone has removed it from the disk.

use std::cell::Cell;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::formats::StoredShape;
use crate::storage::{Journal, Orphan};
use crate::tui::app::state::App;
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::runtime::work::progress::WorkerEventSink;
use crate::tui::runtime::work::threads::{self, PATIENCE};

/// Changes are gathered for this time before they are written, so a crash loses less than a second of work.
const GATHER: Duration = Duration::from_millis(400);

/// The time after which work that could not be written is tried again: a full disk may have room by then.
const RETRY: Duration = Duration::from_secs(5);

/// The program's end of the channel to the thread.
#[derive(Debug)]
pub(in crate::tui) struct JournalWriter {
    /// The channel of requests. None for a writer that writes nothing, and while it is dropped.
    notes: Option<Sender<JournalRequest>>,
    /// The thread, until it is joined.
    thread: Option<JoinHandle<()>>,
    /// The work that was noted last.
    last: Option<StoredShape>,
    /// The reason why there is no thread, if the system gives none.
    refused: Option<String>,
    /// Whether the disk has not answered in time: then the program ends without waiting for it.
    hangs: Cell<bool>,
}

/// A request to the thread.
enum JournalRequest {
    /// Keep this unsaved work.
    Persist(Box<StoredShape>),
    /// Keep this work of a program that crashed, and then remove it from that program's journal.
    Adopt(Box<Orphan>),
    /// There is no unsaved work any more.
    Clear,
    /// Write now; the answer is whether everything is written.
    Flush(Sender<bool>),
    /// Report errors to this sink.
    ReportTo(WorkerEventSink),
}

impl JournalWriter {
    /// Starts a thread that writes to a journal.
    pub(in crate::tui) fn new(journal: Journal) -> Self {
        let (notes, inbox) = channel();
        let writer = JournalThread {
            journal,
            work: None,
            due: None,
            adopted: Vec::new(),
            post: None,
            reported: false,
        };
        match threads::start(move || writer.run(&inbox)) {
            Ok(thread) => Self {
                notes: Some(notes),
                thread: Some(thread),
                last: None,
                refused: None,
                hangs: Cell::new(false),
            },
            Err(reason) => {
                let mut idle = Self::idle();
                idle.refused = Some(reason);
                idle
            }
        }
    }

    /// Returns a writer that writes nothing, for scripts.
    pub(in crate::tui) fn idle() -> Self {
        Self {
            notes: None,
            thread: None,
            last: None,
            refused: None,
            hangs: Cell::new(false),
        }
    }

    /// Reports errors to `post` from now on.
    pub(in crate::tui) fn report_to(&self, post: WorkerEventSink) {
        if let Some(reason) = &self.refused {
            let message = format!("unsaved work cannot be kept: {reason}");
            post(WorkerEvent::Refused(message));
        }
        self.send(JournalRequest::ReportTo(post));
    }

    /// Notes the unsaved work if it has changed. Called after every message; the comparison is one shape with another.
    pub(in crate::tui) fn note(&mut self, app: &App) {
        let work = app.unsaved_work();
        if work == self.last {
            return;
        }
        if let Some(shape) = work {
            self.persist(shape);
        } else {
            self.last = None;
            self.send(JournalRequest::Clear);
        }
    }

    /// Keeps unsaved work, even if it was noted before.
    pub(in crate::tui) fn persist(&mut self, shape: StoredShape) {
        self.last = Some(shape.clone());
        self.send(JournalRequest::Persist(Box::new(shape)));
    }

    /// Keeps the work of a program that crashed, in place of that program's journal.
    pub(in crate::tui) fn adopt(&mut self, orphan: Orphan) {
        self.last = Some(orphan.shape.clone());
        self.send(JournalRequest::Adopt(Box::new(orphan)));
    }

    /// Sends a request to the thread, if there is one.
    fn send(&self, note: JournalRequest) {
        if let Some(notes) = &self.notes {
            // The thread ends only after this end of the channel is dropped.
            let _ = notes.send(note);
        }
    }

    /// Writes everything, waiting for at most `patience`: a disk may hang. Returns false if it is not written by then.
    pub(in crate::tui) fn written(&self, patience: Duration) -> bool {
        let (done, written) = channel();
        self.send(JournalRequest::Flush(done));
        let answer = written.recv_timeout(patience);
        self.hangs.set(answer == Err(RecvTimeoutError::Timeout));
        answer.unwrap_or(false)
    }
}

impl Drop for JournalWriter {
    fn drop(&mut self) {
        if self.thread.is_some() && !self.hangs.get() {
            self.written(PATIENCE);
        }
        self.notes = None;
        // A thread that hangs ends with the program.
        if let Some(thread) = self.thread.take().filter(|_| !self.hangs.get()) {
            // A panic of the thread has been reported.
            let _ = thread.join();
        }
    }
}

/// The thread's end: gathers changes for a moment, then writes the latest.
struct JournalThread {
    /// The journal that it writes to.
    journal: Journal,
    /// The unsaved work, if there is any.
    work: Option<Box<StoredShape>>,
    /// The time to write it; None if it is written.
    due: Option<Instant>,
    /// Work of programs that crashed, which stays in their journals until it is written here.
    adopted: Vec<Orphan>,
    /// The receiver of errors.
    post: Option<WorkerEventSink>,
    /// Whether the present error has been reported: once is enough.
    reported: bool,
}

impl JournalThread {
    /// Serves requests until the program drops its end of the channel.
    fn run(mut self, inbox: &Receiver<JournalRequest>) {
        loop {
            let note = match self.due {
                Some(due) => inbox.recv_timeout(due.saturating_duration_since(Instant::now())),
                None => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match note {
                Ok(JournalRequest::Persist(shape)) => self.note(shape),
                Ok(JournalRequest::Adopt(orphan)) => {
                    self.note(Box::new(orphan.shape.clone()));
                    self.adopted.push(*orphan);
                    self.write();
                }
                Ok(JournalRequest::Clear) => {
                    (self.work, self.due) = (None, None);
                    self.journal.clear();
                }
                Ok(JournalRequest::Flush(done)) => {
                    // The program may have stopped waiting.
                    let _ = done.send(self.write());
                }
                Ok(JournalRequest::ReportTo(post)) => self.post = Some(post),
                Err(RecvTimeoutError::Timeout) => {
                    self.write();
                }
                Err(RecvTimeoutError::Disconnected) => {
                    self.write();
                    return;
                }
            }
        }
    }

    /// Takes work to be written after a moment, together with later changes.
    fn note(&mut self, work: Box<StoredShape>) {
        let soon = Instant::now() + GATHER;
        self.work = Some(work);
        self.due = Some(self.due.map_or(soon, |due| due.min(soon)));
    }

    /// Writes the work unless the disk has it already. Returns true if the disk has it.
    fn write(&mut self) -> bool {
        let Some(work) = &self.work else {
            return true;
        };
        if self.due.is_none() && self.journal.is_intact() {
            return true;
        }
        match self.journal.keep(work) {
            Ok(()) => {
                self.due = None;
                self.reported = false;
                // What cannot be removed is offered again: better twice than never.
                self.adopted.drain(..).for_each(|orphan| {
                    orphan.discard();
                });
            }
            Err(error) => {
                self.due = Some(Instant::now() + RETRY);
                if let Some(post) = self.post.as_ref().filter(|_| !self.reported) {
                    post(WorkerEvent::Refused(format!(
                        "unsaved work cannot be kept: {error}"
                    )));
                    self.reported = true;
                }
            }
        }
        self.due.is_none()
    }
}
