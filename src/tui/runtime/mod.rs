//! The runtime: performs the effects that `update` returns, and feeds the answers back as messages.
//!
//! Apart from the terminal, only this module touches files and threads.
//! ```text
//! effect      what update may ask for: the library, a worker, the terminal
//! disk        reads and writes, in order, on a disk that may answer late
//! work        sweeps, models and exports, each on a thread of its own
//! frames      a source of frames: watched, recorded
//! mailbox     messages from other threads, which wake the event loop
//! ```

pub mod effect;

pub mod disk;

pub mod work;

mod frames;

pub mod mailbox;

pub use crate::tui::runtime::frames::source::check as check_source;
pub use crate::tui::runtime::work::execution::WorkerEventSink;

use std::collections::VecDeque;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use taxel_files::formats::StoredShape;
use taxel_files::formats::file::system_reason;
use taxel_files::storage::{Expected, Journal, Library, LibraryError, ModelCache, Orphan};
use tempfile::TempDir;

use crate::tui::app::message::{Leftover, LibraryEvent, Message, WorkerEvent};
use crate::tui::app::state::App;
use crate::tui::app::update::{next_work, update};
use crate::tui::keys::key::Key;
use crate::tui::live::message::LiveEvent;
use crate::tui::runtime::disk::files::WriteAccess;
use crate::tui::runtime::disk::journal_writer::JournalWriter;
use crate::tui::runtime::disk::queue::DiskQueue;
use crate::tui::runtime::disk::request::{DiskAnswer, DiskRequest, Reminders, not_recorded};
use crate::tui::runtime::effect::{Effect, FileRequest, FrameWork, TerminalEffect};
use crate::tui::runtime::frames::recording::Recording;
use crate::tui::runtime::work::execution::PATIENCE;
use crate::tui::runtime::work::models::ModelStore;
use crate::tui::runtime::work::workers::Workers;

/// A temporary folder that only its owner can look into.
fn temporary_folder() -> io::Result<TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix("taxel-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
    // The message names the folder that the user can change, not the temporary one.
    builder.tempdir().map_err(|error| {
        let place = std::env::temp_dir();
        let reason = system_reason(&error.kind().into());
        let text = format!(
            "{}: cannot make a folder for temporary files: {reason}",
            place.display()
        );
        io::Error::new(error.kind(), text)
    })
}

/// The outside world: a library, unsaved work that crashed programs left in it, this program's journal, and workers.
#[derive(Debug)]
pub struct World {
    /// The unsaved work to offer, one after the other, the last one first.
    orphans: Vec<Orphan>,
    journal: JournalWriter,
    /// The reminders from run to run; None if nothing is remembered.
    reminders: Option<Reminders>,
    disk: DiskQueue,
    later: VecDeque<Message>,
    workers: Workers,
    /// The folder of a temporary library. The last field: it is dropped after the journal has been written.
    _scratch: Option<TempDir>,
}

impl World {
    pub fn new(library: Library) -> Self {
        Self {
            journal: JournalWriter::new(&library),
            orphans: Orphan::all(&library),
            reminders: Some(Reminders::of(&library)),
            ..Self::for_script(library)
        }
    }

    /// Returns the world for a script: unsaved work is neither offered nor kept, so that a script does the same every
    /// time.
    pub fn for_script(library: Library) -> Self {
        let workers = Workers::with(ModelStore::beside(&library));
        Self {
            disk: DiskQueue::new(library),
            later: VecDeque::new(),
            orphans: Vec::new(),
            reminders: None,
            journal: JournalWriter::idle(),
            workers,
            _scratch: None,
        }
    }

    pub fn scratch() -> io::Result<Self> {
        let folder = temporary_folder()?;
        let world = Self::new(Library::open(folder.path().join("library")));
        Ok(Self {
            _scratch: Some(folder),
            ..world
        })
    }

    /// Returns a world with shapes in a temporary library, and with unsaved work of crashed programs, the newest
    /// last.
    pub fn with_contents(
        shapes: &[&StoredShape],
        leftovers: &[&StoredShape],
    ) -> Result<Self, String> {
        let folder = temporary_folder().map_err(|error| error.to_string())?;
        let library = Library::open(folder.path().join("library"));
        let sentence = |error: LibraryError| error.to_string();
        for shape in shapes {
            library.save(shape, Expected::Nothing).map_err(sentence)?;
        }
        let leftovers: Vec<StoredShape> = leftovers.iter().copied().cloned().collect();
        // A dropped journal leaves its work behind, as a crash does.
        (Journal::new(&library).keep(leftovers)).map_err(|error| error.to_string())?;
        Ok(Self {
            _scratch: Some(folder),
            ..Self::new(library)
        })
    }

    /// Runs long work on threads of its own and sends their events to `post`. Without this, work is done before the
    /// next message, without progress or estimates, so that a script shows the same every time.
    #[must_use]
    pub fn with_workers(mut self, post: WorkerEventSink) -> Self {
        self.journal.report_to(Arc::clone(&post));
        self.disk.post_to(Arc::clone(&post));
        self.workers.post_to(post);
        self
    }

    /// Allows files to be written only below this folder, as is right for a script: no hidden files, and no file is
    /// replaced that was there before.
    #[must_use]
    pub fn confined_to(mut self, folder: PathBuf) -> Self {
        self.workers.access = Arc::new(WriteAccess::below(folder));
        self.disk.access = Arc::clone(&self.workers.access);
        self
    }

    #[must_use]
    pub fn with_pose_limit(mut self, poses: u64) -> Self {
        self.workers.stop_after(poses);
        self
    }

    #[must_use]
    pub fn with_model_cache(mut self, cache: Option<ModelCache>) -> Self {
        if let Some(cache) = cache {
            self.workers.models.store.cache = Some(cache);
        }
        self
    }

    /// Remembers nothing from earlier runs or for later ones, so that a run recorded as a script does the same again.
    #[must_use]
    pub fn without_reminders(mut self) -> Self {
        self.reminders = None;
        self
    }

    /// Gives the program what earlier runs remembered: commands, and the set of shapes.
    pub fn remind(&mut self, app: &mut App) {
        if let Some(reminders) = &mut self.reminders {
            reminders.remind(app);
        }
    }

    /// Returns the first message: the offer of the unsaved work of a crashed program.
    pub fn greeting(&self) -> Option<Message> {
        let found = self.left().map(LibraryEvent::Found);
        found.map(Message::Library)
    }

    /// Returns the offer of unsaved work, None if there is none.
    fn left(&self) -> Option<Leftover> {
        let orphan = self.orphans.last()?;
        Some(Leftover {
            what: disk::request::described(orphan),
            waiting: self.orphans.len(),
        })
    }

    /// Updates the state by a message and performs its effects: answers are further messages, and the work that the
    /// open pages then need is begun. Returns the effect for the terminal, if there is one.
    pub fn handle(&mut self, app: &mut App, message: Message) -> Option<TerminalEffect> {
        let mut terminal = None;
        self.receive(app, message);
        while let Some(next) = self.next_message(app) {
            let mut next = Some(next);
            while let Some(effect) = (next.take())
                .and_then(|message| update(app, message))
                .or_else(|| next_work(app))
            {
                next = match effect {
                    Effect::Terminal(effect) => {
                        terminal = Some(effect);
                        None
                    }
                    Effect::Library(request) if request.is_change() => {
                        self.change(app, DiskRequest::Library(request))
                    }
                    Effect::Library(request) => self.read(app, DiskRequest::Library(request)),
                    Effect::Recover => Some(self.recover()),
                    Effect::GiveUp => self.give_up(app),
                    Effect::File(request @ FileRequest::Write(..)) => {
                        self.change(app, DiskRequest::File(request))
                    }
                    Effect::File(request) => self.read(app, DiskRequest::File(request)),
                    Effect::Work(work) => self.workers.perform(work).map(Message::Worker),
                    Effect::Frames(work) => self.frames(app, work),
                };
            }
        }
        self.journal.note(app);
        if let Some(reminders) = &mut self.reminders {
            reminders.note(app, &mut self.disk);
        }
        terminal
    }

    fn next_message(&mut self, app: &App) -> Option<Message> {
        self.later.pop_front().or_else(|| self.answered(app))
    }

    fn answered(&mut self, app: &App) -> Option<Message> {
        loop {
            let answer = self.disk.take(app.dialogs.len())?;
            let message = self.answer(answer);
            if message.is_some() {
                return message;
            }
        }
    }

    fn receive(&mut self, app: &App, message: Message) {
        let esc = Message::Unknown(Key::Esc);
        let leaves = matches!(message, Message::Cancel | Message::Quit) || message == esc;
        let dropped = leaves.then(|| self.disk.drop_readings(app.dialogs.len()));
        let dropped = dropped.flatten();
        // On the matrix, Esc means nothing else.
        let is_done = dropped.is_some() && message == esc;
        self.later.extend((!is_done).then_some(message));
        let dropped = dropped.map(WorkerEvent::GivenUp);
        self.later.extend(dropped.map(Message::Worker));
    }

    fn frames(&mut self, app: &App, work: FrameWork) -> Option<Message> {
        let event = match work {
            FrameWork::Watch {
                number,
                request,
                write,
                naming,
            } => {
                self.stop_watching();
                self.workers.watch(number, request, write, naming)
            }
            FrameWork::StopWatching => {
                self.stop_watching();
                self.workers.namer.end();
                None
            }
            FrameWork::Record(metadata) => match self.workers.frames.start_recording() {
                Ok(number) => {
                    return self.change(app, DiskRequest::BeginRecording(number, metadata));
                }
                Err(refused) => Some(WorkerEvent::Refused(refused.to_owned())),
            },
            FrameWork::StopRecording => {
                let (number, recording) = self.workers.frames.end_recording()?;
                return self.change(app, DiskRequest::EndRecording(number, recording));
            }
            FrameWork::WriteMetadata(view) => {
                let (number, recording) = self.workers.frames.recording()?;
                return self.change(app, DiskRequest::WriteMetadata(number, recording, view));
            }
            FrameWork::NameBy(number, naming) => {
                self.workers.name_by(number, naming);
                None
            }
            FrameWork::Name(imprint) => self.workers.namer.name(&imprint),
        };
        event.map(Message::Worker)
    }

    fn stop_watching(&mut self) {
        if let Some((number, recording)) = self.workers.frames.stop() {
            self.disk
                .change(DiskRequest::EndRecording(number, recording));
        }
    }

    pub(in crate::tui) fn has_frames(&self) -> bool {
        self.workers.frames.has_new()
    }

    /// Takes the frames that have come; None if there are none.
    pub(in crate::tui) fn take_frames(&self) -> Option<Message> {
        self.workers.frames.take().map(Message::Worker)
    }

    pub(in crate::tui) fn next_frames(&mut self, count: usize) -> Vec<Message> {
        let access = Arc::clone(&self.workers.access);
        let events = self.workers.frames.next(count, &access).into_iter();
        events.map(Message::Worker).collect()
    }

    /// Returns when to look again what the disk is waited for; None if that does not change.
    pub(in crate::tui) fn disk_due(&self) -> Option<Instant> {
        self.disk.due()
    }

    pub(in crate::tui) fn waiting(&self) -> Option<String> {
        self.disk.status()
    }

    /// Finishes changes and recordings and writes unsaved work at once, because the program is about to end. Waits
    /// for at most 1.5 s. Returns lines about everything that is not on the disk, because of an error or because the
    /// disk does not answer.
    pub fn end(&mut self, app: &mut App) -> Vec<String> {
        if let Some((number, recording)) = self.workers.frames.stop() {
            self.disk
                .begin(DiskRequest::EndRecording(number, recording));
        }
        let (mut lines, is_kept) = self.write_all(app, |_, app, answer| {
            // No more effects are performed.
            let _ = update(app, answer);
        });
        let refused = app.refused_at_end.iter();
        lines.extend(refused.map(|(_, reason)| format!("not saved: {reason}\n")));
        if is_kept && !lines.is_empty() && !app.unsaved_work().is_empty() {
            lines.push("the next start offers it as unsaved work\n".to_owned());
        }
        lines
    }

    /// Finishes changes and writes out unsaved work and the recording, because the program is about to be stopped,
    /// perhaps for ever. Waits for at most 1.5 s. Everything goes on when the program is continued. Returns lines
    /// about everything that is not on the disk.
    pub fn flush(&mut self, app: &mut App) -> Vec<String> {
        if let Some((number, recording)) = self.workers.frames.recording() {
            self.disk
                .begin(DiskRequest::FlushRecording(number, recording));
        }
        let (lines, _) = self.write_all(app, |world, app, answer| {
            // The terminal is about to be given back, so its effects are dropped.
            let _ = world.handle(app, answer);
        });
        lines
    }

    /// Waits for changes and the journal, at most [`PATIENCE`], and passes the answers to `take`. Returns lines about
    /// everything that is not on the disk, and whether unsaved work is on it.
    fn write_all(
        &mut self,
        app: &mut App,
        take: fn(&mut Self, &mut App, Message),
    ) -> (Vec<String>, bool) {
        let end = Instant::now() + PATIENCE;
        // Changes get half of the time: the journal keeps what could not be saved.
        let mut lines = self.finish_changes(app, Instant::now() + PATIENCE / 2, take);
        self.journal.note(app);
        let is_kept = (self.journal).written(end.saturating_duration_since(Instant::now()));
        // Changes get the time that the journal has left.
        lines.extend(self.finish_changes(app, end, take));
        self.journal.note(app);
        lines.extend(self.disk.left());
        if !is_kept && !app.unsaved_work().is_empty() {
            let line =
                "unsaved work may not be on the disk: the disk refuses it or does not answer\n";
            lines.push(line.to_owned());
        }
        (lines, is_kept)
    }

    /// Waits for changes and recordings until `end`, and passes the answers to `take`. Returns lines about recordings
    /// that could not be finished or continued.
    fn finish_changes(
        &mut self,
        app: &mut App,
        end: Instant,
        take: fn(&mut Self, &mut App, Message),
    ) -> Vec<String> {
        let mut lines = Vec::new();
        loop {
            while let Some(answer) = self.disk.take(app.dialogs.len()) {
                lines.extend(not_recorded(&answer));
                if let Some(answer) = self.answer(answer) {
                    take(self, app, answer);
                }
            }
            if self.disk.is_idle() || !self.disk.wait(end) {
                return lines;
            }
        }
    }

    /// Makes a change. Returns the answer if it comes within a moment.
    fn change(&mut self, app: &App, change: DiskRequest) -> Option<Message> {
        self.disk.change(change);
        self.answered(app)
    }

    fn read(&mut self, app: &App, request: DiskRequest) -> Option<Message> {
        self.disk.read(request, app.dialogs.len());
        self.answered(app)
    }

    /// Returns the message that tells the program the outcome of a request; None if there is nothing to tell.
    fn answer(&mut self, changed: DiskAnswer) -> Option<Message> {
        let answer = match changed {
            DiskAnswer::Stored(shape, Ok(stamp)) => {
                LibraryEvent::Stored(shape.name.to_string(), stamp)
            }
            DiskAnswer::Stored(shape, Err(error)) => match error {
                LibraryError::Exists { stamp, .. } | LibraryError::Changed { stamp, .. } => {
                    LibraryEvent::Differs(shape, stamp, error.to_string())
                }
                LibraryError::Shipped(name) => {
                    let text = "is the name of a shipped shape; choose another";
                    LibraryEvent::NotStored(format!("{name} {text}"))
                }
                _ => LibraryEvent::NotStored(error.to_string()),
            },
            DiskAnswer::ThrownAway(Ok(name)) => LibraryEvent::GivenUp(name, self.left()),
            DiskAnswer::ThrownAway(Err(error)) => {
                // The rest is offered again at the next start, too.
                self.orphans.clear();
                LibraryEvent::NotGivenUp(error.to_string())
            }
            DiskAnswer::File(event) => return Some(Message::File(event)),
            DiskAnswer::Library(event) => event,
            DiskAnswer::Recording(number, begun) => return Some(self.recording(number, begun)),
            DiskAnswer::Live(number, event) => {
                return Some(Message::Worker(WorkerEvent::Live(number, event)));
            }
            DiskAnswer::Nothing => return None,
        };
        Some(Message::Library(answer))
    }

    fn recording(
        &mut self,
        number: u64,
        begun: Result<(String, Arc<Recording>), String>,
    ) -> Message {
        let (event, recording) = match begun {
            Ok((name, recording)) => (LiveEvent::Recording(name), Some(recording)),
            Err(refused) => (LiveEvent::NotRecorded(refused), None),
        };
        // The recording to end: the new one if its source was left meanwhile, or another one that was still open.
        let over = self.workers.frames.recording_started(number, recording);
        if let Some(over) = over {
            self.disk.change(DiskRequest::EndRecording(number, over));
        }
        Message::Worker(WorkerEvent::Live(number, event))
    }

    fn recover(&mut self) -> Message {
        let Some(orphan) = self.orphans.pop() else {
            return no_work_left();
        };
        let shape = orphan.shape.clone();
        // The work is put into this program's journal before it is taken out of the other one.
        self.journal.adopt(orphan);
        if let Some(next) = self.greeting() {
            self.later.push_back(next);
        }
        Message::Library(LibraryEvent::Recovered(Box::new(shape)))
    }

    fn give_up(&mut self, app: &App) -> Option<Message> {
        match self.orphans.pop() {
            Some(orphan) => self.change(app, DiskRequest::ThrowAway(Box::new(orphan))),
            None => Some(no_work_left()),
        }
    }
}

fn no_work_left() -> Message {
    Message::Library(LibraryEvent::Failed("no unsaved work is left".to_owned()))
}
