//! The only place of the screen that touches the world: the library, the journal of unsaved work, and workers.

pub use crate::tui::runtime::workers::EventSink;

use std::io;
use std::sync::Arc;

use crate::tui::runtime::journal_writer::JournalWriter;
use crate::tui::runtime::workers::Workers;
use tempfile::TempDir;

use crate::formats::value::counted;
use crate::formats::{Name, StoredShape};
use crate::storage::{Expected, Journal, Library, LibraryError, Orphan, UNNAMED};
use crate::tui::app::message::{Leftover, LibraryEvent, Message};
use crate::tui::app::state::App;
use crate::tui::app::update::update;
use crate::tui::runtime::effect::{Effect, LibraryRequest, TerminalEffect};

/// The world: a library, the work that died programs left in it, and the journal of this one.
#[derive(Debug)]
pub struct World {
    library: Library,
    /// The work that is offered, and how many there are with it that wait.
    orphan: Option<(Orphan, usize)>,
    journal: JournalWriter,
    workers: Workers,
    /// The library's folder where that is one for the time being. The last field: it goes after the journal has written.
    _scratch: Option<TempDir>,
}

impl World {
    /// The world around a library.
    pub fn new(library: Library) -> Self {
        let journal = JournalWriter::new(Journal::new(&library));
        let mut world = Self {
            library,
            orphan: None,
            journal,
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
            journal: JournalWriter::idle(),
            workers: Workers::default(),
            _scratch: None,
        }
    }

    /// One only: the others are for other programs, or for later.
    fn newest_orphan(&self) -> Option<(Orphan, usize)> {
        let mut all = Orphan::all(&self.library);
        let count = all.len();
        all.pop().map(|newest| (newest, count))
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
    pub fn furnished(shapes: &[StoredShape], leftovers: &[StoredShape]) -> Result<Self, String> {
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
    pub fn with_workers(mut self, post: EventSink) -> Self {
        self.journal.tell(Arc::clone(&post));
        self.workers = Workers::beside(post);
        self
    }

    /// What there is to say at the start: that a program left work when it died.
    pub fn greeting(&self) -> Option<Message> {
        Some(Message::Library(LibraryEvent::Found(self.left()?)))
    }

    fn left(&self) -> Option<Leftover> {
        let (orphan, waiting) = self.orphan.as_ref()?;
        let taxels = counted(orphan.shape.imprint.count().into(), "taxel");
        let what = match orphan.shape.name.as_str() {
            UNNAMED => taxels,
            name => format!("{taxels} of {name}"),
        };
        let waiting = *waiting;
        Some(Leftover { what, waiting })
    }

    /// Does what a message says, with all that follows from it. What is left is for the terminal.
    pub fn handle(&mut self, app: &mut App, message: Message) -> Option<TerminalEffect> {
        let mut next = message;
        let left = loop {
            match update(app, next) {
                Some(Effect::Library(request)) => next = self.perform(request),
                Some(Effect::Work(work)) => match self.workers.perform(work) {
                    Some(told) => next = Message::Worker(told),
                    None => break None,
                },
                Some(Effect::Terminal(effect)) => break Some(effect),
                None => break None,
            }
        };
        self.journal.note(app);
        left
    }

    /// Puts unsaved work in safety at once: the program is about to end.
    pub fn secure(&mut self) {
        self.journal.flush();
    }

    fn perform(&mut self, request: LibraryRequest) -> Message {
        let answer = match request {
            LibraryRequest::List => {
                LibraryEvent::List(self.library.list().map_err(|error| error.to_string()))
            }
            LibraryRequest::Trash => {
                LibraryEvent::Trash(self.library.in_trash().map_err(|error| error.to_string()))
            }
            LibraryRequest::Read(names) => {
                let read = |name: &str| self.library.load(name).map_err(|error| error.to_string());
                LibraryEvent::Read(
                    names
                        .iter()
                        .map(|(index, name)| (*index, read(name)))
                        .collect(),
                )
            }
            LibraryRequest::Named(purpose, name) => {
                let loaded = self.library.load(&name).map(Box::new);
                LibraryEvent::Named(purpose, loaded.map_err(|error| error.to_string()))
            }
            LibraryRequest::Store(shape, expected) => match self.library.save(&shape, expected) {
                Ok(stamp) => LibraryEvent::Stored(shape.name.to_string(), stamp),
                Err(error) => match error {
                    LibraryError::Exists { stamp, .. } | LibraryError::Changed { stamp, .. } => {
                        LibraryEvent::Differs(shape, stamp, error.to_string())
                    }
                    _ => LibraryEvent::Failed(error.to_string()),
                },
            },
            LibraryRequest::Remove(name) => done(self.library.delete(&name), LibraryEvent::Removed),
            LibraryRequest::Restore(name) => {
                done(self.library.restore(&name), LibraryEvent::Restored)
            }
            LibraryRequest::Recover => match self.orphan.take() {
                Some((orphan, _)) => {
                    let shape = orphan.shape.clone();
                    // It is in this program's journal before it is taken out of that of the dead one.
                    self.journal.keep(shape.clone());
                    if self.journal.flush() {
                        orphan.discard();
                    }
                    LibraryEvent::Recovered(Box::new(shape))
                }
                None => LibraryEvent::Failed("no unsaved work is left".to_owned()),
            },
            LibraryRequest::GiveUp => self.give_up(),
        };
        Message::Library(answer)
    }

    /// Unsaved work that is not wanted goes the way of a deleted shape. Only where it is gone is there other work to
    /// offer: this one again would be asked about without end.
    fn give_up(&mut self) -> LibraryEvent {
        let Some((orphan, _)) = self.orphan.take() else {
            return LibraryEvent::Failed("no unsaved work is left".to_owned());
        };
        let mut shape = orphan.shape.clone();
        if let Ok(name) = Name::new(UNNAMED) {
            shape = shape.renamed(name);
        }
        match self.library.throw_away(&shape) {
            Ok(name) => {
                orphan.discard();
                self.orphan = self.newest_orphan();
                LibraryEvent::GivenUp(name, self.left())
            }
            Err(error) => LibraryEvent::NotGivenUp(error.to_string()),
        }
    }
}

fn done(result: Result<String, LibraryError>, answer: fn(String) -> LibraryEvent) -> LibraryEvent {
    result.map_or_else(|error| LibraryEvent::Failed(error.to_string()), answer)
}
