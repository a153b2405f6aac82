//! The thread of the disk: jobs one after the other, and the journal of unsaved work.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use taxel_files::storage::{Journal, Library, Orphan};

use crate::tui::app::refuse;
use crate::tui::app::unsaved::UnsavedWork;
use crate::tui::jobs::{Answer, Post, Posted, caught, refusal};

/// Changes of unsaved work are gathered for this time, so a crash loses less than a second of work.
const GATHER: Duration = Duration::from_millis(400);
/// When work that could not be written is tried again: a full disk may have room by then.
const RETRY: Duration = Duration::from_secs(5);

pub(super) type DiskJob = Box<dyn FnOnce(&Library) -> Answer + Send>;

pub(super) enum DiskWork {
    Job(DiskJob),
    /// Keep this work, and then remove what was taken over from other journals.
    Keep(Vec<UnsavedWork>, Vec<Orphan>),
    /// Write the journal now; the answer is whether everything is written.
    Flush(Sender<bool>),
}

pub(super) struct Disk {
    pub(super) library: Library,
    /// None if no unsaved work is kept.
    pub(super) journal: Option<UnsavedJournal>,
    pub(super) post: Post,
}

impl Disk {
    pub(super) fn run(mut self, inbox: &Receiver<DiskWork>) {
        loop {
            let due = self.journal.as_ref().and_then(|journal| journal.due);
            let work = match due {
                Some(due) => inbox.recv_timeout(due.saturating_duration_since(Instant::now())),
                None => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match work {
                Ok(work) => self.take(work),
                Err(RecvTimeoutError::Timeout) => {
                    self.write_journal();
                }
                Err(RecvTimeoutError::Disconnected) => {
                    self.write_journal();
                    return;
                }
            }
        }
    }

    fn take(&mut self, work: DiskWork) {
        match work {
            DiskWork::Job(job) => {
                // It may take long, and the program may die meanwhile.
                self.write_journal();
                let answer = caught(|| job(&self.library)).unwrap_or_else(refusal);
                self.post.send(Posted::Disk(answer));
            }
            DiskWork::Keep(works, adopted) => {
                // Nothing can be lost any more, or work must not be offered twice.
                let at_once = works.is_empty() || !adopted.is_empty();
                if let Some(journal) = &mut self.journal {
                    journal.note(works, adopted);
                }
                if at_once {
                    self.write_journal();
                }
            }
            DiskWork::Flush(done) => {
                let is_written = self.write_journal();
                // The program may have stopped waiting.
                let _ = done.send(is_written);
            }
        }
    }

    /// Returns true if the unsaved work is on the disk.
    fn write_journal(&mut self) -> bool {
        let journal = self.journal.as_mut();
        journal.is_none_or(|journal| journal.write(&self.post))
    }
}

/// The unsaved work in the journal. Of the changes within a moment only the last one is written.
pub(super) struct UnsavedJournal {
    journal: Journal,
    works: Vec<UnsavedWork>,
    /// The work on the disk.
    written: Vec<UnsavedWork>,
    /// When to write it; None if it is written.
    due: Option<Instant>,
    adopted: Vec<Orphan>,
    has_failed: bool,
}

impl UnsavedJournal {
    pub(super) fn new(library: &Library) -> Self {
        Self {
            journal: Journal::new(library),
            works: Vec::new(),
            written: Vec::new(),
            due: None,
            adopted: Vec::new(),
            has_failed: false,
        }
    }

    fn note(&mut self, works: Vec<UnsavedWork>, adopted: Vec<Orphan>) {
        let soon = Instant::now() + GATHER;
        self.due = Some(self.due.map_or(soon, |due| due.min(soon)));
        self.works = works;
        self.adopted.extend(adopted);
    }

    /// Brings the journal up to date, also if someone has removed it. Returns true if it is; an error is reported once.
    fn write(&mut self, post: &Post) -> bool {
        if self.written != self.works || !self.journal.is_intact() {
            // This touches the matrix, so it is not done for every key.
            let works = self.works.iter();
            let shapes = works.map(|(name, document)| document.to_shape(name.clone()));
            if let Err(error) = self.journal.keep(shapes.collect()) {
                self.due = Some(Instant::now() + RETRY);
                if !std::mem::replace(&mut self.has_failed, true) {
                    let reason = format!("unsaved work cannot be kept: {error}");
                    post.answer(|app| refuse(app, reason));
                }
                return false;
            }
            self.written.clone_from(&self.works);
        }
        (self.due, self.has_failed) = (None, false);
        for orphan in self.adopted.drain(..) {
            // What cannot be removed is offered again: better twice than never.
            orphan.discard();
        }
        true
    }
}
