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
//! also writes work that was written before, if someone has removed it from the disk. A journal holds one shape, so
//! each piece of work has a journal of its own.

use std::cell::Cell;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use taxel_files::storage::{Journal, Library, LibraryError, Orphan};

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
    pub(in crate::tui) fn new(library: Library) -> Self {
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
    library: Library,
    journals: Vec<(Journal, UnsavedWork)>,
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
    fn new(library: Library) -> Self {
        Self {
            library,
            journals: Vec::new(),
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
    /// the journals are cleared at once.
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

    /// Brings the journals up to date: writes work that no journal holds, then clears the journals of other work. A
    /// journal of other work may be written over only once everything else is on the disk, so a crash loses nothing:
    /// the former state of a drawing stays until the new one is there. All work is tried, whatever fails; returns the
    /// first error.
    fn keep(&mut self) -> Result<(), LibraryError> {
        let mut old = std::mem::take(&mut self.journals);
        let mut unwritten = Vec::new();
        for work in &self.works {
            let holds = |(journal, written): &mut (Journal, UnsavedWork)| {
                written == work && journal.is_intact()
            };
            match old.extract_if(.., holds).next() {
                Some(holder) => self.journals.push(holder),
                None => unwritten.push(work),
            }
        }
        let mut kept = Ok(());
        for (index, work) in unwritten.iter().enumerate() {
            let is_last = index + 1 == unwritten.len();
            let reused = (is_last && kept.is_ok()).then(|| old.pop()).flatten();
            let (journal, before) = reused.unzip();
            let mut journal = journal.unwrap_or_else(|| Journal::new(&self.library));
            let written = journal.keep(&work.to_shape());
            match (&written, before) {
                (Ok(()), _) => self.journals.push((journal, (*work).clone())),
                (Err(_), Some(before)) => old.push((journal, before)),
                (Err(_), None) => journal.clear(),
            }
            kept = kept.and(written);
        }
        if kept.is_ok() {
            old.drain(..).for_each(|(mut journal, _)| journal.clear());
        }
        self.journals.extend(old);
        kept
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use taxel_core::imprint::Imprint;
    use taxel_core::sensor::Sensor;
    use taxel_files::formats::{Name, StoredShape};

    use super::*;

    fn drawing(taxels: u8) -> UnsavedWork {
        let sensor = Sensor::default();
        let mut imprint = Imprint::empty(sensor.size());
        (0..taxels).for_each(|row| imprint.toggle(3, row));
        UnsavedWork::from(&StoredShape {
            name: Name::new("drawn").expect("a name"),
            sensor,
            imprint,
            source: None,
        })
    }

    struct Journals {
        folder: tempfile::TempDir,
        thread: JournalThread,
    }

    impl Journals {
        fn new() -> Self {
            let folder = tempfile::tempdir().expect("a folder");
            let thread = JournalThread::new(Library::open(folder.path().to_owned()));
            Self { folder, thread }
        }

        /// Keeps drawings with these numbers of taxels; returns whether all could be kept, and the numbers of taxels
        /// that are on the disk afterwards.
        fn keep(&mut self, taxels: &[u8]) -> (bool, Vec<u32>) {
            self.thread.works = taxels.iter().copied().map(drawing).collect();
            let kept = self.thread.keep().is_ok();
            let files = fs::read_dir(self.folder.path().join(".journal")).expect("a folder");
            let paths = files.map(|file| file.expect("a file").path());
            let journals = paths.filter(|path| {
                path.extension().is_some_and(|ending| ending == "json") && path.is_file()
            });
            let mut found: Vec<u32> = journals
                .map(|path| StoredShape::read(&fs::read(path).expect("a journal")))
                .map(|shape| shape.expect("whole").imprint.count())
                .collect();
            found.sort_unstable();
            (kept, found)
        }

        /// Puts a folder in the place of the journal of this number, so that it can be neither read nor written.
        fn block(&self, number: usize) {
            let name = format!(".journal/{}-{number}.json", std::process::id());
            let path = self.folder.path().join(name);
            fs::remove_file(&path).expect("a journal");
            fs::create_dir(&path).expect("a folder");
        }
    }

    #[test]
    fn the_journals_hold_the_present_work() {
        let mut journals = Journals::new();
        for works in [
            &[1][..],
            &[1, 2],
            &[3, 1],
            &[2, 3, 4],
            &[5, 6],
            &[6, 5],
            &[],
        ] {
            let mut sorted: Vec<u32> = works.iter().copied().map(u32::from).collect();
            sorted.sort_unstable();
            assert_eq!(journals.keep(works), (true, sorted));
        }
    }

    #[test]
    fn a_journal_is_not_written_over_while_its_work_is_kept() {
        let mut journals = Journals::new();
        assert_eq!(journals.keep(&[1, 2]), (true, vec![1, 2]));
        // The new work cannot be written. What was in the first place stays, though it has moved to the second.
        journals.block(1);
        assert_eq!(journals.keep(&[3, 1]), (false, vec![1]));
    }
}
