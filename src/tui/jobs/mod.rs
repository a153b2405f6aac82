//! The one place that knows threads: work with the disk, and long work.
//!
//! ```text
//! disk, read   closures over the library, one after the other on one thread; the journal of unsaved work, too
//! run          a closure on a thread of its own, in the slot of its kind
//! answers      closures over the program, applied between two messages
//! ```
//! In scripts and tests, the same closures run in place, and their answers are applied after the message, in order.
//! A disk may hang: keys go on, the screen says what it waits for, and the end of the program does not wait for ever.

mod disk;

use std::collections::{HashMap, VecDeque};
use std::error::Error;
use std::fmt;
use std::io;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, OnceLock};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use taxel_core::lock::try_locked;
use taxel_core::progress::{Progress, stop_if};
use taxel_files::formats::StoredShape;
use taxel_files::formats::file::system_reason;
use taxel_files::storage::{Expected, Journal, Library, ModelCache, Models, Orphan};
use tempfile::TempDir;

use crate::tui::app::unsaved::UnsavedWork;
use crate::tui::app::{App, refuse};
use crate::tui::files::WriteAccess;
use crate::tui::jobs::disk::{Disk, DiskJob, DiskWork, UnsavedJournal};
use crate::tui::live::source::Sources;

/// What a job leaves to do, on the thread of the screen.
pub type Answer = Box<dyn FnOnce(&mut App) + Send>;

pub fn answer(act: impl FnOnce(&mut App) + Send + 'static) -> Answer {
    Box::new(act)
}

/// A job begun in a slot takes the place of the one before, whose answers are dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Slot {
    Sweep,
    Model,
    Names,
}

/// How long a key waits for the disk. Nearly all answers come within it, so that the next key finds the work done.
const QUICK: Duration = Duration::from_millis(100);
/// The wait from which the screen says what it waits for.
const SLOW: Duration = Duration::from_millis(300);
/// The longest wait for the disk at the end of the program.
const PATIENCE: Duration = Duration::from_millis(1500);
/// The longest wait for long work at the end: half-written files are removed, and models are written as a whole.
const STOPPING: Duration = Duration::from_millis(400);
const REPORTS: Duration = Duration::from_millis(100);

enum Posted {
    Disk(Answer),
    /// From the job of that number; whether it is its last answer.
    Job(Slot, u64, bool, Answer),
    Other(Answer),
}

/// Tells the event loop that there is an answer.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

#[derive(Clone)]
pub(crate) struct Post {
    answers: Sender<Posted>,
    /// None in scripts.
    pub(crate) wake: Option<Wake>,
}

impl Post {
    pub(crate) fn answer(&self, act: impl FnOnce(&mut App) + Send + 'static) {
        self.send(Posted::Other(answer(act)));
    }

    fn send(&self, posted: Posted) {
        // The receiver lives as long as the program.
        if self.answers.send(posted).is_ok()
            && let Some(wake) = &self.wake
        {
            wake();
        }
    }
}

struct Running {
    number: u64,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// A request to the disk without an answer; the first is being carried out.
struct Pending {
    what: String,
    since: Instant,
    of: Asker,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Asker {
    /// It is a change, whoever asked for it.
    Program,
    /// The page that is on top after this message.
    NewPage,
    /// The page that is on top of this many.
    Page(usize),
}

pub struct Jobs {
    library: Library,
    pub(crate) access: Arc<WriteAccess>,
    /// The unsaved work of earlier runs to offer, the last one first.
    pub(crate) orphans: Vec<Orphan>,
    /// Offered work that was taken: it is removed from its place once it is in the journal of this program.
    pub(crate) adopted: Vec<Orphan>,
    pub(crate) models: Models,
    pub(crate) sources: Sources,
    /// The disk's thread, once something was asked of it.
    disk: Option<(Sender<DiskWork>, JoinHandle<()>)>,
    keeps_unsaved: bool,
    pending: VecDeque<Pending>,
    answers: VecDeque<(Asker, Answer)>,
    posted: Receiver<Posted>,
    pub(crate) post: Post,
    slots: HashMap<Slot, Running>,
    begun: u64,
    /// The most that a job in place may count, as a script from a stranger must end.
    pub pose_limit: Option<u64>,
    kept: Vec<UnsavedWork>,
    /// The folder of a temporary library; dropped last.
    scratch: Option<TempDir>,
}

impl fmt::Debug for Jobs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Jobs")
    }
}

impl Jobs {
    /// Keeps unsaved work in the library's journal, and offers what crashed programs left there.
    pub fn new(library: Library) -> Self {
        let orphans = Orphan::all(&library);
        let mut jobs = Self::for_script(library);
        jobs.orphans = orphans;
        jobs.keeps_unsaved = true;
        jobs
    }

    /// Unsaved work is neither offered nor kept, so that a script does the same every time.
    pub fn for_script(library: Library) -> Self {
        let (answers, posted) = channel();
        let post = Post {
            answers,
            wake: None,
        };
        Self {
            access: Arc::default(),
            orphans: Vec::new(),
            adopted: Vec::new(),
            models: Models {
                library: library.clone(),
                cache: None,
            },
            sources: Sources::default(),
            disk: None,
            keeps_unsaved: false,
            library,
            pending: VecDeque::new(),
            answers: VecDeque::new(),
            posted,
            post,
            slots: HashMap::new(),
            begun: 0,
            pose_limit: None,
            kept: Vec::new(),
            scratch: None,
        }
    }

    /// Without a library, for a program that has not been given one: nothing can be saved.
    pub(crate) fn without_library() -> Self {
        Self::for_script(Library::open(PathBuf::from("/dev/null/none")))
    }

    pub fn scratch() -> io::Result<Self> {
        let folder = temporary_folder()?;
        let mut jobs = Self::new(Library::open(folder.path().join("library")));
        jobs.scratch = Some(folder);
        Ok(jobs)
    }

    /// With shapes in a temporary library, and with unsaved work of crashed programs, the newest last.
    pub fn with_contents(
        shapes: &[StoredShape],
        leftovers: &[StoredShape],
    ) -> Result<Self, Box<dyn Error>> {
        let mut jobs = Self::scratch()?;
        for shape in shapes {
            jobs.library.save(shape, Expected::Nothing)?;
        }
        // A dropped journal leaves its work behind, as a crash does.
        Journal::new(&jobs.library).keep(leftovers.to_vec())?;
        jobs.orphans = Orphan::all(&jobs.library);
        Ok(jobs)
    }

    /// Does the work on threads; `wake` is called for each answer.
    #[must_use]
    pub fn with_threads(mut self, wake: Wake) -> Self {
        self.post.wake = Some(wake);
        self
    }

    /// Allows files to be written only below this folder, as is right for a script: no hidden files, and no file is
    /// replaced that was there before.
    #[must_use]
    pub fn confined_to(mut self, folder: PathBuf) -> Self {
        self.access = Arc::new(WriteAccess::below(folder));
        self
    }

    #[must_use]
    pub fn with_model_cache(mut self, cache: Option<ModelCache>) -> Self {
        self.models.cache = cache;
        self
    }

    /// Changes something on the disk; `what` names it, as in "Saving blob". It is never dropped.
    pub(crate) fn disk(
        &mut self,
        what: impl Into<String>,
        job: impl FnOnce(&Library) -> Answer + Send + 'static,
    ) {
        self.ask(what.into(), Asker::Program, Box::new(job));
    }

    /// Reads something from the disk for the page that is on top after this message. The answer waits while another
    /// page lies above that one, and is dropped once it is closed.
    pub(crate) fn read(
        &mut self,
        what: impl Into<String>,
        job: impl FnOnce(&Library) -> Answer + Send + 'static,
    ) {
        self.ask(what.into(), Asker::NewPage, Box::new(job));
    }

    fn ask(&mut self, what: String, of: Asker, job: DiskJob) {
        let since = Instant::now();
        self.pending.push_back(Pending { what, since, of });
        self.send(DiskWork::Job(job));
        // Without threads for the rest, an answer is there before the next key.
        while self.post.wake.is_none()
            && !self.pending.is_empty()
            && let Ok(posted) = self.posted.recv()
        {
            self.receive(posted);
        }
    }

    fn send(&mut self, work: DiskWork) {
        let (send, _) = self.disk.get_or_insert_with(|| {
            let disk = Disk {
                library: self.library.clone(),
                journal: self
                    .keeps_unsaved
                    .then(|| UnsavedJournal::new(&self.library)),
                post: self.post.clone(),
            };
            let (send, receive) = channel();
            (send, std::thread::spawn(move || disk.run(&receive)))
        });
        // The thread ends only after this end of the channel is dropped.
        let _ = send.send(work);
    }

    /// Begins long work in place of what is in the slot.
    pub(crate) fn run(
        &mut self,
        slot: Slot,
        job: impl FnOnce(&JobProgress) -> Answer + Send + 'static,
    ) {
        self.stop(slot);
        self.begun += 1;
        let (number, stop) = (self.begun, Arc::<AtomicBool>::default());
        let has_threads = self.has_threads();
        let progress = JobProgress {
            slot,
            number,
            stop: Arc::clone(&stop),
            limit: self.pose_limit.filter(|_| !has_threads),
            done: AtomicU64::new(0),
            begun: Instant::now(),
            reported: Mutex::new(Instant::now()),
            count: OnceLock::new(),
            post: self.post.clone(),
        };
        let post = self.post.clone();
        let body = move || {
            let last = caught(|| job(&progress)).unwrap_or_else(refusal);
            post.send(Posted::Job(slot, number, true, last));
        };
        let thread = if has_threads {
            Some(std::thread::spawn(body))
        } else {
            body();
            None
        };
        let running = Running {
            number,
            stop,
            thread,
        };
        self.slots.insert(slot, running);
    }

    /// Asks the job in the slot to stop; its last answer still comes.
    pub(crate) fn stop(&self, slot: Slot) {
        if let Some(running) = self.slots.get(&slot) {
            running.stop.store(true, Ordering::Relaxed);
        }
    }

    /// Stops the job in the slot and drops its answers.
    pub(crate) fn forget(&mut self, slot: Slot) {
        self.stop(slot);
        self.slots.remove(&slot);
    }

    /// False in scripts and tests, where nothing may depend on time.
    pub(crate) fn has_threads(&self) -> bool {
        self.post.wake.is_some()
    }

    pub(crate) fn is_running(&self, slot: Slot) -> bool {
        self.slots.contains_key(&slot)
    }

    /// Applies an act as if it were the answer of a job: after the present message.
    pub fn later(&mut self, act: impl FnOnce(&mut App) + Send + 'static) {
        self.post.answer(act);
    }

    /// Waits a moment for the answers to all requests, unless one of them takes long already. `pages` are open.
    pub(crate) fn settle(&mut self, pages: usize) {
        let answers = self.answers.iter_mut().map(|(of, _)| of);
        let askers = self.pending.iter_mut().map(|request| &mut request.of);
        for of in askers.chain(answers).filter(|of| **of == Asker::NewPage) {
            *of = Asker::Page(pages);
        }
        let is_quick = |first: &Pending| first.since.elapsed() < QUICK;
        let end = Instant::now() + QUICK;
        while self.pending.front().is_some_and(is_quick) && self.wait(end) {}
    }

    /// Takes the next answer for the program, or for the page on top of this many.
    pub(crate) fn next_answer(&mut self, pages: usize) -> Option<Answer> {
        while let Ok(posted) = self.posted.try_recv() {
            self.receive(posted);
        }
        let closed = |of: Asker| matches!(of, Asker::Page(own) if own > pages);
        self.answers.retain(|(of, _)| !closed(*of));
        let covered = |of: Asker| matches!(of, Asker::Page(own) if own < pages);
        let next = self.answers.iter().position(|(of, _)| !covered(*of))?;
        self.answers.remove(next).map(|(_, answer)| answer)
    }

    fn receive(&mut self, posted: Posted) {
        match posted {
            Posted::Disk(answer) => {
                let of = self.pending.pop_front().map(|request| request.of);
                self.answers.extend(of.map(|of| (of, answer)));
            }
            Posted::Job(slot, number, is_last, answer) => {
                let own = self.slots.get(&slot);
                if own.is_some_and(|running| running.number == number) {
                    if is_last {
                        self.slots.remove(&slot);
                    }
                    self.answers.push_back((Asker::Program, answer));
                }
            }
            Posted::Other(answer) => self.answers.push_back((Asker::Program, answer)),
        }
    }

    /// Waits for the next answer; false if none comes until `end`.
    fn wait(&mut self, end: Instant) -> bool {
        let time = end.saturating_duration_since(Instant::now());
        let posted = self.posted.recv_timeout(time);
        posted.map(|posted| self.receive(posted)).is_ok()
    }

    /// Stops waiting for what the page on top of this many reads. Returns what that was.
    pub(crate) fn give_up_reading(&mut self, pages: usize) -> Option<String> {
        let own = |request: &&mut Pending| request.of == Asker::Page(pages);
        let mut first = None;
        for request in self.pending.iter_mut().filter(own) {
            request.of = Asker::Page(usize::MAX);
            first.get_or_insert_with(|| request.what.clone());
        }
        first
    }

    /// When the screen is to say what it waits for; None if it says so already, or waits for nothing.
    pub(crate) fn due(&self) -> Option<Instant> {
        let due = self.pending.front()?.since + SLOW;
        (due > Instant::now()).then_some(due)
    }

    /// What the program waits for, in words, if it has waited for long.
    pub(crate) fn waiting(&self) -> Option<String> {
        let first = self.pending.front()?;
        let end = match first.of {
            Asker::Page(_) => "; Esc gives up",
            _ => "",
        };
        let who = if self.library.waits_for_lock() {
            "another taxel to release the library"
        } else {
            "the disk"
        };
        (first.since.elapsed() >= SLOW).then(|| format!("{}: waiting for {who}{end}", first.what))
    }

    /// Keeps this work in the journal, in place of what was kept before.
    pub(crate) fn keep(&mut self, works: Vec<UnsavedWork>) {
        if self.keeps_unsaved && (works != self.kept || !self.adopted.is_empty()) {
            self.kept.clone_from(&works);
            let adopted = std::mem::take(&mut self.adopted);
            self.send(DiskWork::Keep(works, adopted));
        }
    }

    /// Waits until all changes and the journal are on the disk, at most [`PATIENCE`], because the program is about to
    /// be stopped. Returns lines about everything that is not.
    pub(crate) fn finish(app: &mut App) -> Vec<String> {
        let end = Instant::now() + PATIENCE;
        let is_change = |request: &Pending| request.of == Asker::Program;
        let mut lines = Vec::new();
        loop {
            while let Some(answer) = app.jobs.next_answer(app.pages.len()) {
                app.notice = None;
                answer(app);
                app.read();
                if let Some(said) = app.notice.as_ref().filter(|said| said.is_refusal) {
                    lines.push(format!("{}\n", said.text));
                }
            }
            let works = app.unsaved_work();
            app.jobs.keep(works);
            if !app.jobs.pending.iter().any(is_change) || !app.jobs.wait(end) {
                break;
            }
        }
        let jobs = &mut app.jobs;
        let (done, written) = channel();
        jobs.send(DiskWork::Flush(done));
        let time = end.saturating_duration_since(Instant::now());
        let is_kept = written.recv_timeout(time);
        if is_kept.is_err() {
            // It hangs, and ends with the program.
            jobs.disk = None;
        }
        let why = if jobs.library.waits_for_lock() {
            "another program holds the library"
        } else {
            "the disk does not answer"
        };
        let left = jobs.pending.iter().filter(|request| is_change(request));
        let left = left.map(|request| format!("{}: not done yet, because {why}\n", request.what));
        lines.extend(left);
        // A threshold that is changed often writes the metadata as often.
        lines.dedup();
        if is_kept != Ok(true) && !jobs.kept.is_empty() {
            let reason = "the disk refuses it or does not answer";
            lines.push(format!("unsaved work may not be on the disk: {reason}\n"));
        }
        lines
    }
}

impl Drop for Jobs {
    fn drop(&mut self) {
        let end = Instant::now() + STOPPING;
        self.slots.keys().for_each(|&slot| self.stop(slot));
        let threads = self.slots.drain().filter_map(|(_, running)| running.thread);
        threads.for_each(|thread| wait_until_finished(&thread, end));
        if let Some((send, thread)) = self.disk.take() {
            drop(send);
            wait_until_finished(&thread, Instant::now() + PATIENCE);
        }
        drop(self.scratch.take());
    }
}

/// Is told how much was counted, and how long it took.
type Tell = Arc<dyn Fn(&mut App, u64, Duration) + Send + Sync>;

/// What a job reports to, and from which it learns whether to go on.
pub(crate) struct JobProgress {
    slot: Slot,
    number: u64,
    stop: Arc<AtomicBool>,
    limit: Option<u64>,
    done: AtomicU64,
    begun: Instant,
    reported: Mutex<Instant>,
    count: OnceLock<Tell>,
    post: Post,
}

impl JobProgress {
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Tells the screen something while the job goes on.
    pub(crate) fn post(&self, act: impl FnOnce(&mut App) + Send + 'static) {
        let act = answer(act);
        self.post
            .send(Posted::Job(self.slot, self.number, false, act));
    }

    /// Tells the screen from now on what is counted, at most ten times a second; not in scripts.
    pub(crate) fn counts(&self, tell: impl Fn(&mut App, u64, Duration) + Send + Sync + 'static) {
        // It is set once, at the beginning of a job.
        let _ = self.count.set(Arc::new(tell));
    }
}

impl Progress for JobProgress {
    fn add(&self, poses: u64) -> ControlFlow<()> {
        let poses = self.done.fetch_add(poses, Ordering::Relaxed) + poses;
        // A thread that finds the lock taken leaves the report to the other one.
        if let (Some(tell), Some(_)) = (self.count.get(), &self.post.wake)
            && let Some(mut last) = try_locked(&self.reported)
            && last.elapsed() >= REPORTS
        {
            *last = Instant::now();
            let (tell, elapsed) = (Arc::clone(tell), self.begun.elapsed());
            self.post(move |app| tell(app, poses, elapsed));
        }
        stop_if(self.is_stopped() || self.limit.is_some_and(|most| poses > most))
    }
}

/// Turns a panic into a sentence; without it the program would wait for ever.
pub(crate) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    let done = catch_unwind(AssertUnwindSafe(work));
    done.map_err(|_| "the work failed; this is a bug".to_owned())
}

fn refusal(reason: String) -> Answer {
    answer(|app| refuse(app, reason))
}

pub(crate) fn start(body: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>, String> {
    let thread = Builder::new().spawn(body);
    thread.map_err(|error| format!("cannot start a thread: {}", system_reason(&error)))
}

/// Waits for a thread, which is not joined: a disk or a host that does not answer may hold it up.
pub(crate) fn wait_until_finished(thread: &JoinHandle<()>, end: Instant) {
    while !thread.is_finished() && Instant::now() < end {
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// A temporary folder that only its owner can look into.
fn temporary_folder() -> io::Result<TempDir> {
    let folder = tempfile::Builder::new().prefix("taxel-").tempdir();
    // The message names the folder that the user can change, not the temporary one.
    folder.map_err(|error| {
        let reason = system_reason(&error.kind().into());
        let place = std::env::temp_dir();
        let place = place.display();
        let text = format!("{place}: cannot make a folder for temporary files: {reason}");
        io::Error::new(error.kind(), text)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::app::message::Message;
    use crate::tui::app::state::Options;
    use crate::tui::app::update::update;

    fn threaded() -> (App, Receiver<()>) {
        let (wake, woken) = channel();
        let wake = Mutex::new(wake);
        let mut app = App::new(&Options::plain(true));
        let jobs = std::mem::replace(&mut app.jobs, Jobs::without_library());
        app.jobs = jobs.with_threads(Arc::new(move || {
            let _ = wake.lock().expect("no panic").send(());
        }));
        (app, woken)
    }

    #[test]
    fn answers_come_in_order_and_those_of_replaced_jobs_not_at_all() {
        let (mut app, woken) = threaded();
        let (go, gone) = channel::<()>();
        app.jobs.run(Slot::Sweep, move |progress| {
            let _ = gone.recv();
            assert!(progress.is_stopped());
            answer(|app| refuse(app, "the first"))
        });
        app.jobs
            .run(Slot::Sweep, |_| answer(|app| refuse(app, "the second")));
        drop(go);
        for _ in 0..2 {
            woken.recv().expect("an answer");
        }
        update(&mut app, Message::Redraw);
        assert_eq!(app.notice.expect("said").text, "the second");
        assert!(!app.jobs.is_running(Slot::Sweep));
    }

    #[test]
    fn a_disk_that_hangs_lets_keys_go_on_and_a_panic_is_an_answer() {
        let (mut app, woken) = threaded();
        let (go, gone) = channel::<()>();
        app.jobs.disk("Saving blob", move |_| {
            let _ = gone.recv();
            panic!("on purpose");
        });
        std::thread::sleep(SLOW);
        update(&mut app, Message::Toggle);
        assert_eq!(app.reading().imprint.count(), 1);
        let waiting = "Saving blob: waiting for the disk";
        assert_eq!(app.jobs.waiting().as_deref(), Some(waiting));
        let left = Jobs::finish(&mut app);
        assert!(left[0].starts_with("Saving blob: not done yet"), "{left:?}");
        drop(go);
        woken.recv().expect("an answer");
        update(&mut app, Message::Redraw);
        let said = app.notice.expect("said").text;
        assert!(said.contains("this is a bug"), "{said}");
    }
}
