//! Writes unsaved work to the journal on a separate thread, so that no key waits for a disk.
//!
//! ```text
//!            Keep                   400 ms, or Flush
//! no work -----------> work, due ---------------------> written: work, nothing due
//!    ^                     ^                            error:   due again in 5 s, reported once
//!    |  Keep nothing       |  Keep                         |
//!    +---- any             +-------------------------------+
//! ```
//! Of the changes within the interval only the last one is written. The thread sleeps while nothing is due. A flush
//! also writes work that was written before, if someone has removed it from the disk.

use std::cell::Cell;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use taxel_files::storage::{FileError, Journal, Library, Orphan};

use crate::tui::app::message::WorkerEvent;
use crate::tui::app::state::App;
use crate::tui::app::unsaved::UnsavedWork;
use crate::tui::runtime::work::execution::{PATIENCE, WorkerEventSink, start};

/// Changes are gathered for this time before they are written, so a crash loses less than a second of work.
const GATHER: Duration = Duration::from_millis(400);

/// The time after which work that could not be written is tried again: a full disk may have room by then.
const RETRY: Duration = Duration::from_secs(5);

#[derive(Debug)]
pub(in crate::tui) struct JournalWriter {
    /// The channel of requests. None for a writer that writes nothing, and while it is dropped.
    notes: Option<Sender<JournalRequest>>,
    thread: Option<JoinHandle<()>>,
    last: Vec<UnsavedWork>,
    refused: Option<String>,
    /// Whether the disk has not answered in time: then the program ends without waiting for it.
    hangs: Cell<bool>,
}

enum JournalRequest {
    Keep(Vec<UnsavedWork>),
    /// Keep this work of a program that crashed as well, and then remove it from that program's journal.
    Adopt(Box<Orphan>),
    /// Write now; the answer is whether everything is written.
    Flush(Sender<bool>),
    ReportTo(WorkerEventSink),
}

impl JournalWriter {
    pub(in crate::tui) fn new(library: &Library) -> Self {
        let (notes, inbox) = channel();
        let writer = JournalThread::new(library);
        match start(move || writer.run(&inbox)) {
            Ok(thread) => Self {
                notes: Some(notes),
                thread: Some(thread),
                last: Vec::new(),
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

    pub(in crate::tui) fn idle() -> Self {
        Self {
            notes: None,
            thread: None,
            last: Vec::new(),
            refused: None,
            hangs: Cell::new(false),
        }
    }

    pub(in crate::tui) fn report_to(&self, post: WorkerEventSink) {
        if let Some(reason) = &self.refused {
            let message = format!("unsaved work cannot be kept: {reason}");
            post(WorkerEvent::Refused(message));
        }
        self.send(JournalRequest::ReportTo(post));
    }

    /// Notes the unsaved work if it has changed. Called after every message, so documents are compared, not imprints.
    pub(in crate::tui) fn note(&mut self, app: &App) {
        let works = app.unsaved_work();
        if works != self.last {
            self.last.clone_from(&works);
            self.send(JournalRequest::Keep(works));
        }
    }

    /// Keeps the work of a program that crashed, in place of that program's journal.
    pub(in crate::tui) fn adopt(&mut self, orphan: Orphan) {
        self.last.push(UnsavedWork::from(&orphan.shape));
        self.send(JournalRequest::Adopt(Box::new(orphan)));
    }

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
    journal: Journal,
    /// The work in the journal.
    written: Vec<UnsavedWork>,
    works: Vec<UnsavedWork>,
    /// The time to write it; None if it is written.
    due: Option<Instant>,
    /// Work of programs that crashed, which stays in their journals until it is written here.
    adopted: Vec<Orphan>,
    post: Option<WorkerEventSink>,
    /// Whether the present error has been reported: once is enough.
    reported: bool,
}

impl JournalThread {
    fn new(library: &Library) -> Self {
        Self {
            journal: Journal::new(library),
            written: Vec::new(),
            works: Vec::new(),
            due: None,
            adopted: Vec::new(),
            post: None,
            reported: false,
        }
    }

    fn run(mut self, inbox: &Receiver<JournalRequest>) {
        loop {
            let note = match self.due {
                Some(due) => inbox.recv_timeout(due.saturating_duration_since(Instant::now())),
                None => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match note {
                Ok(JournalRequest::Keep(works)) => self.note(works),
                Ok(JournalRequest::Adopt(orphan)) => {
                    self.works.push(UnsavedWork::from(&orphan.shape));
                    self.adopted.push(*orphan);
                    self.write();
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

    /// Takes work to be written after a moment, together with later changes. If there is none, nothing can be lost, so
    /// the journal is cleared at once.
    fn note(&mut self, works: Vec<UnsavedWork>) {
        let soon = Instant::now() + GATHER;
        self.works = works;
        self.due = Some(self.due.map_or(soon, |due| due.min(soon)));
        if self.works.is_empty() {
            self.write();
        }
    }

    /// Writes the work unless the disk has it already. Returns true if the disk has it.
    fn write(&mut self) -> bool {
        match self.keep() {
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

    /// Brings the journal up to date, if it does not hold the work already.
    fn keep(&mut self) -> Result<(), FileError> {
        if self.written == self.works && self.journal.is_intact() {
            return Ok(());
        }
        let shapes = self.works.iter().map(UnsavedWork::to_shape).collect();
        self.journal.keep(shapes)?;
        self.written.clone_from(&self.works);
        Ok(())
    }
}
