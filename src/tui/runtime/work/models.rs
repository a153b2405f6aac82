//! Models for recognition: trained or read.
//!
//! ```text
//! Prepare(number, set)  -> Begun, Progress …, then Prepared: the model, or why there is none
//! ```
//! Reading from a disk that hangs cannot be stopped. The thread is left to itself, and `GivenUp` says so.
//!
//! A built-in set is trained once; the cache keeps its model, if the world has one. A stored model is read from the
//! folder beside the library, any other from its file. Training goes on while a sweep begins, and stops only on
//! request.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Instant;

use crate::formats::Name;
use crate::lock::locked;
use crate::memory::MemoryGuard;
use crate::quote::shortened;
use crate::recognition::{Model, TrainingError};
use crate::storage::{
    FileVersion, Library, ModelCache, ModelFolder, cached_or_trained, load_whole_model, location,
};
use crate::storage::{ModelChoice, unknown_set};
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::recognise::message::{Prepared, RecognitionEvent};
use crate::tui::recognise::trained::TrainedModel;
use crate::tui::runtime::slow_work::SlowWork;
use crate::tui::runtime::work::execution::{Execution, StopFlag};
use crate::tui::runtime::work::progress::{ProgressReporter, WorkProgress, guarded, on_a_thread};

/// The places where models are stored.
#[derive(Clone, Debug, Default)]
pub(in crate::tui::runtime) struct ModelStore {
    /// The folder of the user's own models.
    folder: Option<ModelFolder>,
    /// The cache of models that can be trained again.
    cache: Option<ModelCache>,
}

impl ModelStore {
    /// Returns the store of the models beside a library, without a cache.
    pub(in crate::tui::runtime) fn beside(library: &Library) -> Self {
        Self {
            folder: Some(ModelFolder::beside(library.folder())),
            cache: None,
        }
    }

    /// Keeps trained models in a cache.
    pub(in crate::tui::runtime) fn keep_in(&mut self, cache: ModelCache) {
        self.cache = Some(cache);
    }

    /// Returns the names of the user's models; none if the folder cannot be read.
    pub(in crate::tui::runtime) fn names(&self) -> Vec<Name> {
        let names = |folder: &ModelFolder| folder.names().into_iter().flatten();
        self.folder.iter().flat_map(names).collect()
    }

    /// Reads or trains the model of a set. `begins` is called with the number of poses before a training, which
    /// reports to `progress`.
    pub(in crate::tui::runtime) fn model(
        &self,
        choice: &ModelChoice,
        begins: &dyn Fn(u64),
        progress: &WorkProgress<'_>,
    ) -> Result<Model, String> {
        let Some(training) = choice.training() else {
            return load_whole_model(&self.file(choice)?).map_err(|error| error.to_string());
        };
        let training = training.map_err(|error| error.to_string())?;
        cached_or_trained(self.cache.as_ref(), training, |training| {
            begins(training.poses());
            let memory = MemoryGuard::new(
                None,
                "take fewer shapes or coarser steps, or train it in shards on the command line (taxel model train --shard)",
            );
            progress
                .within(&memory, |progress| training.with_progress(progress).run())?
                .map_err(|error| match error {
                    TrainingError::Stopped => "training was stopped".to_owned(),
                    error => error.to_string(),
                })
        })
    }

    /// Returns the file of a stored model or of a model in a file, whose path may begin with `~`; None for any other.
    fn path(&self, choice: &ModelChoice) -> Option<PathBuf> {
        match choice {
            ModelChoice::Stored(name) => Some(self.folder.as_ref()?.file(name)),
            ModelChoice::File(path) => {
                let below_home = path.to_str().and_then(location::below_home);
                Some(below_home.unwrap_or_else(|| path.clone()))
            }
            _ => None,
        }
    }

    /// Returns the file that a model is read from.
    ///
    /// # Errors
    /// Returns a sentence if there is no such file, or if it is not a regular one.
    pub(in crate::tui::runtime) fn file(&self, choice: &ModelChoice) -> Result<PathBuf, String> {
        let name = match choice {
            ModelChoice::File(path) => path.to_string_lossy().into_owned(),
            choice => choice.name().to_owned(),
        };
        let path = self.path(choice);
        let path = path.ok_or_else(|| format!("no model named {name:?}"))?;
        match path.metadata() {
            // Opening a pipe waits, and opening a serial line may reset its device.
            Ok(kind) if !kind.is_file() => Err(format!("{}: not a regular file", shortened(&name))),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                Err(unknown_set(&name, &self.names()))
            }
            // Reading it reports any other error.
            _ => Ok(path),
        }
    }

    /// Resolves a choice: as on the command line, a name that no model has may be the name of a file in the working
    /// folder.
    pub(in crate::tui::runtime) fn located(&self, choice: ModelChoice) -> ModelChoice {
        let ModelChoice::Stored(name) = &choice else {
            return choice;
        };
        let folder = self.folder.as_ref();
        let is_stored = folder.is_some_and(|folder| folder.file(name).exists());
        let path = Path::new(name.as_str());
        if is_stored || !path.exists() {
            return choice;
        }
        ModelChoice::File(path.to_owned())
    }
}

/// The work of a thread that reads from the disk at the moment. The screen's thread looks at it.
#[derive(Clone, Debug, Default)]
struct ModelReading(Arc<Mutex<Option<SlowWork>>>);

impl ModelReading {
    /// Notes that something is read from now on.
    fn begin(&self, words: &str) {
        *locked(&self.0) = Some(SlowWork::new(words.to_owned()));
    }

    /// Notes that nothing is read any more. Returns the work that has ended.
    fn end(&self) -> Option<SlowWork> {
        locked(&self.0).take()
    }
}

/// The thread that prepares a model.
#[derive(Debug, Default)]
pub(in crate::tui::runtime) struct ModelWorker {
    /// The store of models.
    pub(in crate::tui::runtime) store: ModelStore,
    /// The number of the piece of work.
    number: u64,
    /// The reading from the disk in progress.
    reading: ModelReading,
    /// Stops the training in progress.
    stop: StopFlag,
    /// The training in progress.
    thread: Option<JoinHandle<()>>,
}

impl ModelWorker {
    /// Prepares a model on a thread of its own. If work is done at once, returns the event instead. `known` is the
    /// model of the set so far, which stays if its file was not written again.
    pub(in crate::tui::runtime) fn prepare(
        &mut self,
        number: u64,
        choice: ModelChoice,
        known: Option<Arc<TrainedModel>>,
        execution: &Execution,
    ) -> Option<WorkerEvent> {
        let stop = self.stop.renew();
        self.reading = ModelReading::default();
        self.number = number;
        let (store, reading) = (self.store.clone(), self.reading.clone());
        let post = match execution {
            Execution::AtOnce(limit) => {
                let progress = WorkProgress::up_to(*limit);
                let calls: Calls<'_> = (&|_| {}, &progress);
                let event = prepare(&store, number, choice, known, &reading, calls);
                return Some(WorkerEvent::Recognition(event));
            }
            Execution::OnThreads(post) => post,
        };
        reading.begin(&format!("Reading {choice}"));
        let thread = on_a_thread(number, post, move |post| {
            let clock = ProgressReporter::new(number, post);
            let begins = |poses| {
                reading.end();
                post(WorkerEvent::Recognition(RecognitionEvent::Begun(
                    number, poses,
                )));
            };
            let progress = WorkProgress::until(&stop, Some(&clock));
            let event = guarded(number, || {
                let calls: Calls<'_> = (&begins, &progress);
                let event = prepare(&store, number, choice, known, &reading, calls);
                WorkerEvent::Recognition(event)
            });
            reading.end();
            post(event);
        });
        match thread {
            Ok(thread) => self.thread = Some(thread),
            Err(refused) => {
                self.reading.end();
                return Some(refused);
            }
        }
        None
    }

    /// Stops the training in progress. Stops waiting for a model that is being read, and returns the event that says
    /// so.
    pub(in crate::tui::runtime) fn give_up(&mut self) -> Option<WorkerEvent> {
        self.stop.stop();
        let read = std::mem::take(&mut self.reading).end()?;
        self.thread = None;
        let event = RecognitionEvent::GivenUp(self.number, read.words);
        Some(WorkerEvent::Recognition(event))
    }

    /// Returns a text about the model that is being read, if that takes long.
    pub(in crate::tui::runtime) fn status(&self) -> Option<String> {
        // Not only the disk takes time: a model is unpacked and evaluated, too.
        let reading = locked(&self.reading.0);
        let words = reading.as_ref()?.slow_words()?;
        Some(format!("{words}; Esc gives up"))
    }

    /// Returns when to check again on the reading; None if nothing is read.
    pub(in crate::tui::runtime) fn next_check(&self) -> Option<Instant> {
        locked(&self.reading.0).as_ref().map(SlowWork::next_check)
    }

    /// Stops for good. Returns the thread, which ends by itself.
    pub(in crate::tui::runtime) fn end(&mut self) -> Option<JoinHandle<()>> {
        self.stop.stop();
        self.thread.take()
    }
}

/// A function that is called with the number of poses before a training, and the progress of the training.
type Calls<'a> = (&'a dyn Fn(u64), &'a WorkProgress<'a>);

/// Reads a model from the cache or trains it, and evaluates it. The event also has the names of stored models, which
/// may have changed.
fn prepare(
    store: &ModelStore,
    number: u64,
    choice: ModelChoice,
    known: Option<Arc<TrainedModel>>,
    reading: &ModelReading,
    (begins, progress): Calls<'_>,
) -> RecognitionEvent {
    let choice = store.located(choice);
    // Before it is read: if it is written meanwhile, it is read again the next time.
    let version = store.path(&choice).as_deref().and_then(FileVersion::of);
    let known = known.filter(|known| version.is_some() && known.version == version);
    let trained = match known.filter(|known| known.choice == choice) {
        Some(known) => Ok(known),
        None => (store.model(&choice, begins, progress))
            .map(|model| Arc::new(TrainedModel::new(choice, model, version))),
    };
    reading.begin("Listing the models");
    let stored = store.names();
    reading.end();
    RecognitionEvent::Prepared(Box::new(Prepared {
        number,
        stored,
        trained,
    }))
}
