//! The only place of the screen that touches the world: the library, the journal of unsaved work, and workers.

mod workers;

pub use workers::Post;

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use tempfile::TempDir;
use workers::Workers;

use super::app::App;
use super::message::{Answer, Message};
use super::request::{Effect, Request};
use super::update::update;
use crate::formats::name::Name;
use crate::formats::shape::Shape;
use crate::library::error::LibraryError;
use crate::library::journal::{Journal, Orphan, UNNAMED};
use crate::library::store::{Expected, Library};

/// The world: a library, the work that died programs left in it, and the journal of this one.
#[derive(Debug)]
pub struct World {
    library: Library,
    orphan: Option<Orphan>,
    keeper: Keeper,
    workers: Workers,
    /// The library's folder where that is one for the time being. The last field: it goes after the keeper has written.
    _scratch: Option<TempDir>,
}

impl World {
    /// The world around a library.
    pub fn new(library: Library) -> Self {
        let keeper = Keeper::new(Journal::new(&library));
        let mut world = Self {
            library,
            orphan: None,
            keeper,
            workers: Workers::default(),
            _scratch: None,
        };
        world.orphan = world.newest_orphan();
        world
    }

    /// A library for a script: what is in it is used, but no unsaved work is offered or kept there, so that the same
    /// script does the same every time.
    pub fn quiet(library: Library) -> Self {
        Self {
            library,
            orphan: None,
            keeper: Keeper::idle(),
            workers: Workers::default(),
            _scratch: None,
        }
    }

    /// One only: the others are for other programs, or for later.
    fn newest_orphan(&self) -> Option<Orphan> {
        Orphan::all(&self.library).pop()
    }

    /// A world of its own: an empty library in a folder that goes with it.
    ///
    /// # Errors
    /// Where the system gives no folder for the time being.
    pub fn scratch() -> io::Result<Self> {
        let folder = tempfile::tempdir()?;
        let world = Self::new(Library::open(folder.path().join("library")));
        Ok(Self {
            _scratch: Some(folder),
            ..world
        })
    }

    /// The same with shapes in it, and with unsaved work that programs left when they died, the last one last.
    ///
    /// # Errors
    /// What the system or the library refuses, in a sentence.
    pub fn furnished(shapes: &[Shape], leftovers: &[Shape]) -> Result<Self, String> {
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let library = Library::open(folder.path().join("library"));
        let told = |error: LibraryError| error.to_string();
        for shape in shapes {
            library.save(shape, Expected::Nothing).map_err(told)?;
        }
        for leftover in leftovers {
            // What is kept stays when a journal is dropped, as when its program dies.
            Journal::new(&library).keep(leftover).map_err(told)?;
        }
        Ok(Self {
            _scratch: Some(folder),
            ..Self::new(library)
        })
    }

    /// Has long work done beside the program, and what it tells sent by `post`. Without this, such work is done at once
    /// and nothing is told of how far it is or how long it takes: scripts show the same every time.
    #[must_use]
    pub fn with_workers(mut self, post: Post) -> Self {
        self.workers = Workers::beside(post);
        self
    }

    /// What there is to say at the start: that a program left work when it died.
    pub fn greeting(&self) -> Option<Message> {
        let shape = &self.orphan.as_ref()?.shape;
        let taxels = shape.imprint.count();
        let what = match shape.name.as_str() {
            UNNAMED => format!("{taxels} taxels"),
            name => format!("{taxels} taxels of {name}"),
        };
        Some(Message::Answer(Answer::Found(what)))
    }

    /// Does what a message says, with all that follows from it. What is left is for the terminal.
    pub fn handle(&mut self, app: &mut App, message: Message) -> Option<Effect> {
        let mut next = message;
        loop {
            match update(app, next) {
                Some(Effect::Library(request)) => next = self.perform(request),
                Some(Effect::Work(work)) => {
                    let Some(told) = self.workers.perform(work) else {
                        self.keeper.note(app);
                        return None;
                    };
                    next = Message::Told(told);
                }
                other => {
                    self.keeper.note(app);
                    return other;
                }
            }
        }
    }

    /// Puts unsaved work in safety at once: the program is about to end.
    pub fn secure(&mut self) {
        self.keeper.flush();
    }

    fn perform(&mut self, request: Request) -> Message {
        let answer = match request {
            Request::List => Answer::List(self.library.list().map_err(|error| error.to_string())),
            Request::Trash => {
                Answer::Trash(self.library.in_trash().map_err(|error| error.to_string()))
            }
            Request::Read(names) => {
                let read = |name: &str| self.library.load(name).map_err(|error| error.to_string());
                Answer::Read(
                    names
                        .iter()
                        .map(|(index, name)| (*index, read(name)))
                        .collect(),
                )
            }
            Request::Named(purpose, name) => {
                let loaded = self.library.load(&name).map(Box::new);
                Answer::Named(purpose, loaded.map_err(|error| error.to_string()))
            }
            Request::Store(shape, expected) => match self.library.save(&shape, expected) {
                Ok(stamp) => Answer::Stored(shape.name.to_string(), stamp),
                Err(error) => match error {
                    LibraryError::Exists { stamp, .. } | LibraryError::Changed { stamp, .. } => {
                        Answer::Differs(shape, stamp, error.to_string())
                    }
                    _ => Answer::Failed(error.to_string()),
                },
            },
            Request::Remove(name) => done(self.library.delete(&name), Answer::Removed),
            Request::Restore(name) => done(self.library.restore(&name), Answer::Restored),
            Request::Recover => match self.orphan.take() {
                Some(orphan) => {
                    let shape = orphan.shape.clone();
                    // It is in this program's journal before it is taken out of that of the dead one.
                    self.keeper.keep(shape.clone());
                    if self.keeper.flush() {
                        orphan.discard();
                    }
                    Answer::Recovered(Box::new(shape))
                }
                None => Answer::Failed("no unsaved work is left".to_owned()),
            },
            Request::GiveUp => {
                let kept = self
                    .orphan
                    .take()
                    .and_then(|orphan| self.discard_into_trash(orphan));
                self.orphan = self.newest_orphan();
                return self
                    .greeting()
                    .unwrap_or(Message::Answer(Answer::GivenUp(kept)));
            }
        };
        Message::Answer(answer)
    }
}

impl World {
    /// Unsaved work that is not wanted goes the way of a deleted shape; answers the name that brings it back.
    fn discard_into_trash(&self, orphan: Orphan) -> Option<String> {
        let names = (1..100).map(|number| format!("{UNNAMED} {number}"));
        let name = names
            .filter_map(|name| Name::new(&name).ok())
            .find(|name| self.library.load(name.as_str()).is_err())?;
        let shape = Shape {
            name,
            ..orphan.shape.clone()
        };
        self.library.save(&shape, Expected::Nothing).ok()?;
        let name = self.library.delete(shape.name.as_str()).ok()?;
        orphan.discard();
        Some(name)
    }
}

fn done(result: Result<String, LibraryError>, answer: fn(String) -> Answer) -> Answer {
    result.map_or_else(|error| Answer::Failed(error.to_string()), answer)
}

/// How long changes are gathered before they are written: a second at most is lost.
const GATHER: Duration = Duration::from_millis(400);

/// Writes the journal beside the program, so that no key waits for a disk. It sleeps while there is nothing to write.
#[derive(Debug)]
struct Keeper {
    notes: Option<Sender<Note>>,
    thread: Option<JoinHandle<()>>,
    last: Option<Shape>,
}

#[derive(Debug)]
enum Note {
    Keep(Box<Shape>),
    Clear,
    /// Answers whether everything is written.
    Flush(Sender<bool>),
}

impl Keeper {
    fn new(journal: Journal) -> Self {
        let (notes, inbox) = channel();
        let thread = std::thread::spawn(move || keep_journal(journal, &inbox));
        Self {
            notes: Some(notes),
            thread: Some(thread),
            last: None,
        }
    }

    /// One that keeps nothing.
    fn idle() -> Self {
        Self {
            notes: None,
            thread: None,
            last: None,
        }
    }

    /// Notes the work that would be lost, if it is other work than before.
    fn note(&mut self, app: &App) {
        let work = app.unsaved_work();
        if work == self.last {
            return;
        }
        if let Some(shape) = work {
            self.keep(shape);
        } else {
            self.last = None;
            self.send(Note::Clear);
        }
    }

    fn keep(&mut self, shape: Shape) {
        self.last = Some(shape.clone());
        self.send(Note::Keep(Box::new(shape)));
    }

    fn send(&self, note: Note) {
        if let Some(notes) = &self.notes {
            // The thread ends only after this end of the channel.
            let _ = notes.send(note);
        }
    }

    /// Waits until everything is written; false where it could not be.
    fn flush(&self) -> bool {
        let (done, written) = channel();
        self.send(Note::Flush(done));
        written
            .recv_timeout(Duration::from_secs(5))
            .unwrap_or(false)
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.notes = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has said so.
            let _ = thread.join();
        }
    }
}

/// The thread: gathers changes for a moment, then writes the last one.
fn keep_journal(mut journal: Journal, inbox: &Receiver<Note>) {
    let mut pending: Option<(Box<Shape>, Instant)> = None;
    // What could not be written waits for the next note, not for the clock.
    let mut failed = false;
    loop {
        let note = match &pending {
            _ if failed => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            None => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Some((_, since)) => inbox.recv_timeout(GATHER.saturating_sub(since.elapsed())),
        };
        match note {
            Ok(Note::Keep(shape)) => {
                let since = pending
                    .filter(|_| !failed)
                    .map_or_else(Instant::now, |(_, since)| since);
                failed = false;
                pending = Some((shape, since));
            }
            Ok(Note::Clear) => {
                (pending, failed) = (None, false);
                journal.clear();
            }
            Ok(Note::Flush(done)) => {
                let written = pending
                    .take()
                    .is_none_or(|(shape, _)| journal.keep(&shape).is_ok());
                // Whoever asked may have stopped waiting.
                let _ = done.send(written);
            }
            Err(RecvTimeoutError::Timeout) => {
                // A disk that is full now may have room at the next change, or when all of it has to be written.
                if pending
                    .as_ref()
                    .is_some_and(|(shape, _)| journal.keep(shape).is_ok())
                {
                    pending = None;
                    failed = false;
                } else {
                    failed = true;
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                if let Some((shape, _)) = pending.take() {
                    let _ = journal.keep(&shape);
                }
                return;
            }
        }
    }
}
