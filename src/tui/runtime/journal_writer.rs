//! Keeps unsaved work in the journal, beside the program: no key waits for a disk. It sleeps while there is nothing to
//! write.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::formats::StoredShape;
use crate::storage::Journal;
use crate::tui::app::state::App;
use crate::tui::explore::message::WorkerEvent;
use crate::tui::runtime::workers::EventSink;

/// How long changes are gathered before they are written: a second at most is lost.
const GATHER: Duration = Duration::from_millis(400);

/// The program's end.
#[derive(Debug)]
pub(in crate::tui) struct JournalWriter {
    notes: Option<Sender<JournalRequest>>,
    thread: Option<JoinHandle<()>>,
    last: Option<StoredShape>,
}

enum JournalRequest {
    Keep(Box<StoredShape>),
    Clear,
    /// Answers whether everything is written.
    Flush(Sender<bool>),
    /// Who is to be told where something cannot be written.
    Tell(EventSink),
}

impl JournalWriter {
    pub(in crate::tui) fn new(journal: Journal) -> Self {
        let (notes, inbox) = channel();
        let writer = JournalThread {
            journal,
            pending: Pending::Nothing,
            post: None,
            told: false,
        };
        let thread = std::thread::spawn(move || writer.run(&inbox));
        Self {
            notes: Some(notes),
            thread: Some(thread),
            last: None,
        }
    }

    /// One that keeps nothing.
    pub(in crate::tui) fn idle() -> Self {
        Self {
            notes: None,
            thread: None,
            last: None,
        }
    }

    /// Says from now on where work cannot be kept.
    pub(in crate::tui) fn tell(&self, post: EventSink) {
        self.send(JournalRequest::Tell(post));
    }

    /// Notes the work that would be lost, if it is other work than before.
    pub(in crate::tui) fn note(&mut self, app: &App) {
        let work = app.unsaved_work();
        if work == self.last {
            return;
        }
        if let Some(shape) = work {
            self.keep(shape);
        } else {
            self.last = None;
            self.send(JournalRequest::Clear);
        }
    }

    pub(in crate::tui) fn keep(&mut self, shape: StoredShape) {
        self.last = Some(shape.clone());
        self.send(JournalRequest::Keep(Box::new(shape)));
    }

    fn send(&self, note: JournalRequest) {
        if let Some(notes) = &self.notes {
            // The thread ends only after this end of the channel.
            let _ = notes.send(note);
        }
    }

    /// Waits until everything is written; false where it could not be.
    pub(in crate::tui) fn flush(&self) -> bool {
        let (done, written) = channel();
        self.send(JournalRequest::Flush(done));
        written
            .recv_timeout(Duration::from_secs(5))
            .unwrap_or(false)
    }
}

impl Drop for JournalWriter {
    fn drop(&mut self) {
        self.notes = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has said so.
            let _ = thread.join();
        }
    }
}

/// What is not in the journal yet.
enum Pending {
    Nothing,
    /// A shape that waits for others, since then.
    Since(Box<StoredShape>, Instant),
    /// One that could not be written: it waits for the next note, not for the clock. A disk that is full now may have
    /// room at the next change, or when all of it has to be written.
    Failed(Box<StoredShape>),
}

/// The thread's end: gathers changes for a moment, then writes the last one.
struct JournalThread {
    journal: Journal,
    pending: Pending,
    post: Option<EventSink>,
    /// Whether it was said that nothing can be kept, which is said once.
    told: bool,
}

impl JournalThread {
    fn run(mut self, inbox: &Receiver<JournalRequest>) {
        loop {
            let note = match &self.pending {
                Pending::Since(_, since) => {
                    inbox.recv_timeout(GATHER.saturating_sub(since.elapsed()))
                }
                _ => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match note {
                Ok(JournalRequest::Keep(shape)) => {
                    let since = match self.pending {
                        Pending::Since(_, since) => since,
                        _ => Instant::now(),
                    };
                    self.pending = Pending::Since(shape, since);
                }
                Ok(JournalRequest::Clear) => {
                    self.pending = Pending::Nothing;
                    self.journal.clear();
                }
                Ok(JournalRequest::Flush(done)) => {
                    // Whoever asked may have stopped waiting.
                    let _ = done.send(self.write());
                }
                Ok(JournalRequest::Tell(post)) => self.post = Some(post),
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

    /// Writes what is pending; what could not be written stays so. Answers whether everything is written.
    fn write(&mut self) -> bool {
        let pending = std::mem::replace(&mut self.pending, Pending::Nothing);
        let (Pending::Since(shape, _) | Pending::Failed(shape)) = pending else {
            return true;
        };
        match self.journal.keep(&shape) {
            Ok(()) => self.told = false,
            Err(error) => {
                self.pending = Pending::Failed(shape);
                if let Some(post) = self.post.as_ref().filter(|_| !self.told) {
                    post(WorkerEvent::Refused(format!(
                        "unsaved work cannot be kept: {error}"
                    )));
                    self.told = true;
                }
            }
        }
        matches!(self.pending, Pending::Nothing)
    }
}
