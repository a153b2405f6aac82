//! Disk requests, handled one after the other on a separate thread, so that no key waits for a disk or for the lock
//! of another program.
//!
//! ```text
//! request -> thread -> answer within QUICK: handled at once, before the next key
//!                      later: a message wakes the loop, keys go on meanwhile; the screen says what is waited for
//! ```
//! Without a receiver of events, as in a script, a request is carried out at once.

use std::collections::VecDeque;
use std::io::ErrorKind;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::Builder;
use std::time::{Duration, Instant};

use rustix::fs::{Access, access};
use rustix::io::Errno;

use crate::formats::recording::{RecordedView, RecordingMetadata};
use crate::formats::{Name, StoredShape};
use crate::storage::{
    Expected, Library, LibraryError, LoadedShape, Orphan, RememberedFile, UNNAMED,
};
use crate::tui::app::library::{LibraryEvent, LibraryRequest, Purpose};
use crate::tui::app::message::FileEvent;
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::live::message::LiveEvent;
use crate::tui::runtime::disk::files;
use crate::tui::runtime::disk::write_access::WriteAccess;
use crate::tui::runtime::effect::FileRequest;
use crate::tui::runtime::frames::recording::Recording;
use crate::tui::runtime::lock::locked;
use crate::tui::runtime::slow_work::SlowWork;
use crate::tui::runtime::work::models::ModelStore;
use crate::tui::runtime::work::progress::{WorkerEventSink, caught};

/// The time that a key waits for an answer. Nearly all answers come within it, so that the next key finds the work
/// done.
const QUICK: Duration = Duration::from_millis(100);

/// A request to the disk.
#[derive(Debug)]
pub(in crate::tui::runtime) enum DiskRequest {
    /// Read or change the library.
    Library(LibraryRequest),
    /// Move unsaved work of a program that crashed to the trash, and look for more of it.
    ThrowAway(Box<Orphan>),
    /// Read or write a file, or list some.
    File(FileRequest),
    /// Remember lines for the next run, in place of those remembered before.
    Remember(RememberedFile, Vec<String>),
    /// Remember further lines for the next run.
    RememberMore(RememberedFile, Vec<String>),
    /// Create a file and record the frames of the source of that number in it.
    BeginRecording(u64, Box<RecordingMetadata>),
    /// Write threshold, tare and marks into the metadata of a recording of the source of that number.
    WriteMetadata(u64, Arc<Recording>, Box<RecordedView>),
    /// Write out all waiting frames of a recording of the source of that number.
    FlushRecording(u64, Arc<Recording>),
    /// Finish a recording of the source of that number.
    EndRecording(u64, Arc<Recording>),
}

/// The outcome of a request.
#[derive(Debug)]
pub(in crate::tui::runtime) enum DiskAnswer {
    /// The shape that was to be saved; the stamp of its file, or the error; and the stored shape that is in its way,
    /// if any.
    Stored(
        Box<StoredShape>,
        Result<u64, LibraryError>,
        Option<Box<LoadedShape>>,
    ),
    /// The name of the unsaved work in the trash, or the error; and the next work to offer, with the number of
    /// offers.
    ThrownAway(Result<String, LibraryError>, Option<(Box<Orphan>, usize)>),
    /// The answer to a request about a file.
    File(FileEvent),
    /// Any other answer of the library.
    Library(LibraryEvent),
    /// The file name and the recording for the source of that number, or the reason why there is none.
    Recording(u64, Result<(String, Arc<Recording>), String>),
    /// An event for the page of the source of that number.
    Live(u64, LiveEvent),
    /// No answer is wanted.
    Nothing,
}

impl DiskRequest {
    /// Returns a description of the request for a message, in a few words.
    fn words(&self) -> String {
        match self {
            Self::Library(request) => request_words(request),
            Self::ThrowAway(_) => "Moving it to the trash".to_owned(),
            Self::File(FileRequest::Write(name, ..)) => format!("Writing {name}"),
            Self::File(FileRequest::Open(name)) => format!("Opening {name}"),
            Self::File(FileRequest::Source(request)) => format!("Opening {}", request.name()),
            Self::File(FileRequest::Paths(_)) => "Listing files".to_owned(),
            Self::Remember(..) | Self::RememberMore(..) => "Remembering it".to_owned(),
            Self::BeginRecording(..) => "Starting a recording".to_owned(),
            Self::WriteMetadata(_, recording, _) => {
                format!("Saving the metadata of {}", recording.path().display())
            }
            Self::FlushRecording(_, recording) | Self::EndRecording(_, recording) => {
                format!("Saving {}", recording.path().display())
            }
        }
    }

    /// Returns true if the request makes an earlier one needless: of the metadata of a recording, only the
    /// latest stays.
    fn replaces(&self, earlier: &Self) -> bool {
        match (self, earlier) {
            (Self::WriteMetadata(_, own, _), Self::WriteMetadata(_, other, _)) => {
                Arc::ptr_eq(own, other)
            }
            _ => false,
        }
    }

    /// Returns true if the request needs the lock of the library, which another program may hold.
    fn locks(&self) -> bool {
        match self {
            Self::Library(request) => request.is_change(),
            Self::ThrowAway(_) => true,
            _ => false,
        }
    }

    /// Carries out the request.
    fn perform(self, library: &Library, access: &WriteAccess) -> DiskAnswer {
        match self {
            Self::Library(request) => answer(library, request),
            Self::ThrowAway(orphan) => throw_away(library, *orphan),
            Self::File(request) => {
                let models = ModelStore::beside(library);
                DiskAnswer::File(files::perform(request, &models, access))
            }
            Self::Remember(file, lines) => {
                file.write(&lines);
                DiskAnswer::Nothing
            }
            Self::RememberMore(file, lines) => {
                file.add(lines);
                DiskAnswer::Nothing
            }
            Self::BeginRecording(number, metadata) => {
                DiskAnswer::Recording(number, Recording::in_free_file(access, &metadata))
            }
            Self::WriteMetadata(number, of, view) => written(number, of.write_metadata(*view)),
            Self::FlushRecording(number, recording) => written(number, recording.flush().map(drop)),
            Self::EndRecording(number, recording) => {
                let ended = recording.finish();
                ended.map_or(DiskAnswer::Nothing, |event| DiskAnswer::Live(number, event))
            }
        }
    }
}

/// Returns a description of a request to the library for a message, in a few words.
fn request_words(request: &LibraryRequest) -> String {
    match request {
        LibraryRequest::List => "Listing the shapes".to_owned(),
        LibraryRequest::Models => "Listing the models".to_owned(),
        LibraryRequest::Trash => "Listing the deleted shapes".to_owned(),
        LibraryRequest::Read(_) => "Reading the shapes".to_owned(),
        LibraryRequest::Named(Purpose::Load, name) => format!("Loading {name}"),
        LibraryRequest::Named(_, name) => format!("Reading {name}"),
        LibraryRequest::Store(shape, _) => format!("Saving {}", shape.name),
        LibraryRequest::Deletable(name) => format!("Looking for {name}"),
        LibraryRequest::Remove(name) => format!("Deleting {name}"),
        LibraryRequest::Restore(Some(name)) => format!("Restoring {name}"),
        LibraryRequest::Restore(None) => "Restoring a shape".to_owned(),
    }
}

/// Carries out a request to the library.
fn answer(library: &Library, request: LibraryRequest) -> DiskAnswer {
    let sentence = |error| sentence(library, &error);
    DiskAnswer::Library(match request {
        LibraryRequest::List => LibraryEvent::List(library.list().map_err(sentence)),
        LibraryRequest::Models => {
            let names = ModelStore::beside(library).names().into_iter();
            LibraryEvent::Models(names.map(|name| name.to_string()).collect())
        }
        LibraryRequest::Trash => LibraryEvent::Trash(library.in_trash().map_err(sentence)),
        LibraryRequest::Read(names) => {
            let read = names.into_iter().map(|name| {
                let loaded = library.load(&name).map_err(sentence);
                (name, loaded)
            });
            LibraryEvent::Read(read.collect())
        }
        LibraryRequest::Named(purpose, name) => {
            let loaded = library.load(&name).map(Box::new);
            LibraryEvent::Named(purpose, loaded.map_err(sentence))
        }
        LibraryRequest::Store(shape, expected) => return store(library, shape, expected),
        LibraryRequest::Deletable(name) => {
            let found = library.deletable(&name).map_err(sentence);
            LibraryEvent::Deletable(match found {
                Ok(_) if is_read_only(library) => Err(format!("not deleted: {READ_ONLY}")),
                found => found,
            })
        }
        LibraryRequest::Remove(name) => {
            let removed = library.delete(&name);
            let removed = removed.map_err(|error| not_changed(library, "not deleted", &error));
            removed.map_or_else(LibraryEvent::Failed, LibraryEvent::Removed)
        }
        LibraryRequest::Restore(name) => {
            let restored = restore(library, name);
            let restored = restored.map_err(|error| not_changed(library, "not restored", &error));
            restored.map_or_else(LibraryEvent::Failed, LibraryEvent::Restored)
        }
    })
}

/// Why nothing in the library can be changed.
const READ_ONLY: &str = "the library is read-only";

/// Returns true if the system lets nobody, or not this user, write in the library's folder.
fn is_read_only(library: &Library) -> bool {
    let writable = access(library.folder(), Access::WRITE_OK);
    matches!(writable, Err(Errno::ACCESS | Errno::PERM | Errno::ROFS))
}

/// Returns true if an error says that nothing in the library can be changed. A file system that went read-only after an
/// error of the disk may still call its folders writable, so the error itself decides first.
fn says_read_only(library: &Library, error: &LibraryError) -> bool {
    match error {
        LibraryError::System(refused) => {
            refused.error.kind() == ErrorKind::ReadOnlyFilesystem || is_read_only(library)
        }
        _ => false,
    }
}

/// Returns the sentence about a refused change: `what` says what was not done. In a read-only library each file would
/// be refused, so the file's name would only mislead.
fn not_changed(library: &Library, what: &str, error: &LibraryError) -> String {
    if says_read_only(library, error) {
        format!("{what}: {READ_ONLY}")
    } else {
        sentence(library, error)
    }
}

/// Saves a shape, or reads the one that is in its way.
fn store(library: &Library, shape: Box<StoredShape>, expected: Expected) -> DiskAnswer {
    let stored = library.save(&shape, expected);
    let in_the_way = match &stored {
        Err(error) if says_read_only(library, error) => {
            let text = format!("not saved: {READ_ONLY}; :write FILE saves elsewhere");
            return DiskAnswer::Library(LibraryEvent::NotStored(text));
        }
        Err(LibraryError::Exists { .. } | LibraryError::Changed { .. }) => {
            library.load(shape.name.as_str()).ok()
        }
        _ => None,
    };
    DiskAnswer::Stored(shape, stored, in_the_way.map(Box::new))
}

/// Returns the answer after something was written to a recording of the source of that number: a failure ends the
/// recording.
fn written(number: u64, written: Result<(), String>) -> DiskAnswer {
    let failed = |reason| DiskAnswer::Live(number, LiveEvent::NotRecorded(reason));
    written.map_or_else(failed, |()| DiskAnswer::Nothing)
}

/// Returns a line about a recording that could not be finished or continued, if the answer says so.
pub(in crate::tui::runtime) fn not_recorded(answer: &DiskAnswer) -> Option<String> {
    match answer {
        DiskAnswer::Live(_, LiveEvent::NotFinished(reason) | LiveEvent::NotRecorded(reason)) => {
            Some(format!("{reason}\n"))
        }
        _ => None,
    }
}

/// Returns an error of the library in a sentence, with the name that was probably meant.
fn sentence(library: &Library, error: &LibraryError) -> String {
    format!("{error}{}", library.suggestion(error))
}

/// Restores the shape that was deleted last, of that name or of any.
fn restore(library: &Library, name: Option<String>) -> Result<String, LibraryError> {
    name.map_or_else(|| library.restore_last(), |name| library.restore(&name))
}

/// Moves unsaved work to the trash. Other work is looked for only if this one is gone; otherwise the same work would be
/// offered, and moved, again without end.
fn throw_away(library: &Library, orphan: Orphan) -> DiskAnswer {
    let mut shape = orphan.shape.clone();
    if let Ok(name) = Name::new(UNNAMED) {
        shape = shape.renamed(name);
    }
    let thrown = library.throw_away(&shape);
    let is_gone = thrown.is_ok() && orphan.discard();
    let next = is_gone.then(|| newest_orphan(library)).flatten();
    DiskAnswer::ThrownAway(thrown, next)
}

/// Returns the newest unsaved work, and the number of all such works. The others are offered after it, or by other
/// programs.
pub(in crate::tui::runtime) fn newest_orphan(library: &Library) -> Option<(Box<Orphan>, usize)> {
    let mut all = Orphan::all(library);
    let count = all.len();
    all.pop().map(|newest| (Box::new(newest), count))
}

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
    use crate::storage::FileError;

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

    /// The folder of a file system that went read-only after an error is still said to be writable.
    #[test]
    fn the_error_itself_says_that_a_library_is_read_only() {
        let folder = tempfile::tempdir().expect("a folder");
        let library = Library::open(folder.path().to_owned());
        let said = |kind: ErrorKind| {
            let error = FileError::new("write it", folder.path(), kind.into());
            not_changed(&library, "not deleted", &error.into())
        };
        let expected = "not deleted: the library is read-only";
        assert_eq!(said(ErrorKind::ReadOnlyFilesystem), expected);
        assert!(said(ErrorKind::StorageFull).contains("cannot write it"));
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
